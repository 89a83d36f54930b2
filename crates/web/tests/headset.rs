//! The hands of a headset in the session of the page.

use std::time::Duration;

use ademan_core::document::Document;
use ademan_web::{HandState, PageSession};
use serde_json::{Value, json};

const PERIOD: Duration = Duration::from_millis(10);

/// The fingers of WebXR, and their joints.
const FINGERS: [&str; 5] = [
    "thumb",
    "index-finger",
    "middle-finger",
    "ring-finger",
    "pinky-finger",
];
const JOINTS: [&str; 5] = [
    "metacarpal",
    "phalanx-proximal",
    "phalanx-intermediate",
    "phalanx-distal",
    "tip",
];

fn session() -> PageSession {
    let layout = Document::shipped("qwerty-flat").expect("a shipped file");
    let mut session = PageSession::new(&layout.text).expect("a valid layout");
    // Hands at rest, whose elbows are known, are seen first.
    session.advance(PERIOD);
    session
}

fn of_kind(lines: &str, kind: &str) -> Vec<Value> {
    let object = |line| serde_json::from_str::<Value>(line).expect("an object");
    let objects = lines.lines().map(object);
    objects.filter(|it| it["kind"] == kind).collect()
}

/// Returns the line of a headset for poses of hands: without shoulders and elbows.
fn line(time_us: u64, poses: &[Value]) -> String {
    let hand = |pose: &Value| {
        let names = FINGERS.iter().flat_map(|finger| {
            let own = JOINTS
                .iter()
                .filter(move |joint| !(*finger == "thumb" && **joint == "phalanx-intermediate"));
            own.map(move |joint| format!("{finger}-{joint}"))
        });
        let names = std::iter::once("wrist".to_owned()).chain(names);
        let joints: Vec<&Value> = names.map(|name| &pose["positions"][name]).collect();
        assert_eq!(joints.len(), 25);
        json!({"label": pose["side"], "joints": joints})
    };
    let hands: Vec<Value> = poses.iter().map(hand).collect();
    format!("{}\n", json!({"time_us": time_us, "hands": hands}))
}

/// Passes the poses of a person who types on to a session, until `is_done`.
fn follow(session: &mut PageSession, text: &str, is_done: impl Fn(&[Value]) -> bool) -> u64 {
    let mut person = self::session();
    assert_eq!(person.type_text(text), []);
    let (mut time_us, mut events) = (0, Vec::new());
    while person.hand_state() != HandState::Resting && !is_done(&events) {
        let poses = of_kind(&person.advance(PERIOD), "pose");
        session
            .push("webxr", line(time_us, &poses).as_bytes())
            .expect("the protocol is known");
        time_us += 10_000;
        events.extend(of_kind(&session.advance(PERIOD), "events"));
    }
    time_us
}

#[test]
fn the_hand_of_a_headset_types_what_it_presses() {
    let mut session = session();
    follow(&mut session, "hi", |_| false);
    assert_eq!(session.text(), "hi");
    assert_eq!(session.hand_state(), HandState::Followed);
}

#[test]
fn a_second_run_of_a_sender_in_a_file_is_played_after_the_first_one() {
    let mut person = session();
    assert_eq!(person.type_text("hola"), []);
    let (mut run, mut time_us) = (String::new(), 0);
    while person.hand_state() != HandState::Resting {
        let poses = of_kind(&person.advance(PERIOD), "pose");
        run.push_str(&line(time_us, &poses));
        time_us += 10_000;
    }
    let mut player = session();
    let played = player.play_file("webxr", run.repeat(2).as_bytes());
    assert!(played.is_ok(), "{played:?}");
    let mut presses = Vec::new();
    for _ in 0..2 * time_us / 10_000 + 200 {
        let events = of_kind(&player.advance(PERIOD), "events");
        let downs = events.iter().filter(|it| it["event"] == "key-down");
        presses.extend(downs.map(|it| it["time_us"].as_u64().expect("a time")));
    }
    assert_eq!(player.text(), "holahola");
    // The same letter of both runs.
    assert!(presses[4] - presses[0] > time_us, "{presses:?}");
}

#[test]
fn a_gap_of_an_hour_in_a_file_is_played_in_two_seconds() {
    const HOUR_US: u64 = 3_600_000_000;
    let mut person = session();
    assert_eq!(person.type_text("hi"), []);
    let (mut parts, mut time_us) = ([String::new(), String::new()], 0);
    while person.hand_state() != HandState::Resting {
        let poses = of_kind(&person.advance(PERIOD), "pose");
        for (part, start_us) in parts.iter_mut().zip([0, HOUR_US]) {
            part.push_str(&line(start_us + time_us, &poses));
        }
        time_us += 10_000;
    }
    let mut player = session();
    let played = player.play_file("webxr", parts.concat().as_bytes());
    assert!(played.is_ok(), "{played:?}");
    for _ in 0..2 * time_us / 10_000 + 300 {
        player.advance(PERIOD);
    }
    assert_eq!(player.text(), "hihi");
}

#[test]
fn a_file_that_ends_while_a_key_is_down_releases_it() {
    let (mut person, mut probe) = (session(), session());
    assert_eq!(person.type_text("h"), []);
    let (mut run, mut time_us) = (String::new(), 0);
    loop {
        let poses = of_kind(&person.advance(PERIOD), "pose");
        let text = line(time_us, &poses);
        probe.push("webxr", text.as_bytes()).expect("a line");
        run.push_str(&text);
        let events = of_kind(&probe.advance(PERIOD), "events");
        if events.iter().any(|it| it["event"] == "key-down") {
            break;
        }
        time_us += 10_000;
        assert!(time_us < 10_000_000, "{run}");
    }
    let mut player = session();
    player
        .play_file("webxr", run.as_bytes())
        .expect("its readings");
    let mut events = Vec::new();
    for _ in 0..time_us / 10_000 + 100 {
        events.extend(of_kind(&player.advance(PERIOD), "events"));
    }
    let last = events.last().expect("a press");
    assert_eq!(last["event"], "key-up", "{events:?}");
}

#[test]
fn a_hand_that_the_headset_loses_releases_its_key() {
    let mut session = session();
    let is_down = |events: &[Value]| events.iter().any(|it| it["event"] == "key-down");
    let mut time_us = follow(&mut session, "h", is_down);
    let mut steps = 0;
    let up = loop {
        let empty = json!({"time_us": time_us, "hands": []}).to_string() + "\n";
        session.push("webxr", empty.as_bytes()).expect("a line");
        time_us += 10_000;
        let events = of_kind(&session.advance(PERIOD), "events");
        if let Some(event) = events.first() {
            break event.clone();
        }
        steps += 1;
        assert!(steps < 25, "the key is down for 250 ms");
    };
    assert_eq!((&up["event"], &up["key"]), (&json!("key-up"), &json!("H")));
    println!("released after {} ms", 10 * steps);
}

#[test]
fn the_page_clicks_at_the_phases_in_which_a_key_goes_down_and_comes_up() {
    let script = include_str!("../../../web/page/headset.js");
    let mut session = session();
    assert_eq!(session.type_text("h"), []);
    let mut phases = Vec::new();
    while session.hand_state() != HandState::Resting {
        let touches = of_kind(&session.advance(PERIOD), "touches");
        phases.extend(touches.into_iter().map(|touch| touch["phase"].clone()));
    }
    for phase in ["pressed", "released"] {
        assert!(phases.contains(&json!(phase)), "{phases:?}");
        assert!(script.contains(&format!("\"{phase}\"")), "{phase}");
    }
}
