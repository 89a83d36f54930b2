//! `ademan run --learn-ranges`: what is learned is shown, undone, recorded and replayed.

use std::io::Write;
use std::thread;
use std::time::Duration;

use ademan::device::Events;
use ademan::document::Document;
use ademan::files::OpenDocument;
use ademan::hand::Dof;
use ademan::layout::Glove;
use ademan::setup::Setup;
use ademan::time::Timestamp;
use tempfile::NamedTempFile;

use crate::control::{ctl, events_of};
use crate::support::press::{Posture, reading};
use crate::support::run::{ARMED, MOVE_TIME, Run, postures, without_time};
use crate::{run, run_in};

/// The time for which a finger is stretched.
const STRETCH_TIME: Duration = Duration::from_millis(1_000);

/// The most stretches that a test makes.
const MOST: usize = 8;

/// Returns the lowest posture on the way to the key H in which the finger presses nothing.
fn above_the_key() -> Posture {
    let (over, down) = postures();
    let part = |number: i32| -> Posture {
        std::array::from_fn(|channel| {
            let (from, to) = (i32::from(over[channel]), i32::from(down[channel]));
            (from + (to - from) * number / 40) as u8
        })
    };
    let lowest = (0..=40)
        .rev()
        .map(part)
        .find(|posture| !presses(&over, posture));
    lowest.expect("the hand over the key presses nothing")
}

/// Returns `true` if a hand that moves from a clear posture to another one presses a key.
fn presses(clear: &Posture, posture: &Posture) -> bool {
    let mut pipeline = Setup::default()
        .load_files()
        .expect("the default setup")
        .pipeline();
    let mut events = Events::new();
    for number in 1..=400 {
        let posture = if number <= 200 { clear } else { posture };
        let reading = reading(Timestamp(5_729 * number), posture);
        let _ = pipeline.step(&reading, &mut events);
    }
    !events.is_empty()
}

/// Returns a glove in which the range of the sensor of the index finger begins a little below its count in a posture, and the
/// channel of that sensor.
fn glove(posture: &Posture) -> (NamedTempFile, usize) {
    let shipped = Document::open("unam-hc11").expect("a shipped glove");
    let map = Glove::parse(&shipped).expect("a glove").map;
    let mut rows = map.rows().iter();
    let row = rows.find(|row| row.dof == Dof::IndexMcpFlexion);
    let channel = row.expect("a sensor of the finger").channel;
    let low = posture[channel] - 3;
    let range = format!(
        "full_scale_counts: 255, range_counts: {{{channel}: ({low}, {})}},",
        low + 80
    );
    let text = shipped.text.replace("full_scale_counts: 255,", &range);
    let mut file = tempfile::Builder::new()
        .suffix(".ron")
        .tempfile()
        .expect("a file");
    file.write_all(text.as_bytes()).expect("it is written");
    (file, channel)
}

#[test]
fn a_learned_range_is_shown_undone_recorded_and_replayed() {
    let near = above_the_key();
    let (glove, channel) = glove(&near);
    let fields = format!(
        "role: Both, stall_timeout_ms: 10000, glove: {:?}",
        glove.path()
    );
    let arguments = [
        "--learn-ranges",
        "--control",
        "c.sock",
        "--record",
        "hand.mcap",
    ];
    let run = Run::with_setup(&fields, &arguments);
    run.wait_for_message(ARMED);
    run.take(near);
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "the finger is above the key");
    let refused = ctl(&run, &["undo-learning"]).exited(1);
    refused.reported("no range of a sensor was learned");

    let mut stretched = near;
    stretched[channel] -= 13;
    let mut stretches = 0;
    while run.events.is_empty() {
        assert!(stretches < MOST, "nothing is learned");
        stretches += 1;
        run.take(stretched);
        thread::sleep(STRETCH_TIME);
        run.take(near);
        thread::sleep(MOVE_TIME);
    }
    let mut seen = vec![run.next_event()];
    let state = ctl(&run, &["state"]).done();
    println!("{}", state.out);
    state.printed("learned    1 range of sensors, at most");
    state.printed("(index-mcp-flexion); `ademan ctl undo-learning` undoes it");
    run.lift();
    seen.push(run.next_event());

    let undo = ctl(&run, &["undo-learning"]).done();
    println!("$ ademan ctl undo-learning\n{}{}", undo.out, undo.err);
    run.wait_for_message(ARMED);
    let undone = ctl(&run, &["state"]).done().out;
    assert!(!undone.contains("learned"), "{undone}");
    run.take(near);
    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "the finger is above the key again");
    ctl(&run, &["stop"]).done();
    assert_eq!(seen, ["down H", "up H"]);

    let replay = || run_in(run.folder.path(), ["replay", "hand.mcap"]).out;
    let first = replay();
    let events = events_of(&first).into_iter().map(without_time);
    let replayed: Vec<String> = events.collect();
    assert_eq!(replayed, seen, "a replay learns the same");
    assert_eq!(replay(), first);
}

#[test]
fn learning_needs_a_calibrated_glove() {
    let ended = run(["run", "--source", "typist:a", "--learn-ranges"]);
    assert_ne!(ended.code, Some(0), "{}", ended.err);
    ended.reported("`learn_ranges` needs a glove with `range_counts`");
}
