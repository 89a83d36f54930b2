use super::super::PressRateLimit;
use super::*;
use crate::contact::TargetId;
use crate::device::{Axis, OutputEvent};

/// Parses an event: `down KEY`, `up KEY` or `write CHARACTER`.
fn event(milliseconds: u64, line: &str) -> OutputEvent {
    let (verb, name) = line.split_once(' ').unwrap();
    let kind = match verb {
        "down" => EventKind::KeyDown(name.parse().unwrap()),
        "up" => EventKind::KeyUp(name.parse().unwrap()),
        "write" => EventKind::Character(name.chars().next().unwrap()),
        _ => panic!("{verb}"),
    };
    OutputEvent {
        time: Timestamp(milliseconds * 1_000),
        kind,
    }
}

fn filter(gate: &mut OutputGate, milliseconds: u64, lines: &[&str]) -> (bool, Vec<String>) {
    let mut events: Events = lines.iter().map(|line| event(milliseconds, line)).collect();
    let [is_within_limit, _] = gate.filter(|_| 0, 0, 0, &mut events);
    let words = events.iter().map(|event| match event.kind {
        EventKind::KeyDown(key) => format!("down {key}"),
        EventKind::KeyUp(key) => format!("up {key}"),
        EventKind::Character(character) => format!("write {character}"),
        _ => panic!("{event:?}"),
    });
    (is_within_limit, words.collect())
}

fn permissions(role: SourceRole, per_second: u32) -> SourcePermissions {
    SourcePermissions {
        role,
        rate_limit: PressRateLimit { per_second },
    }
}

fn gate(per_second: u32) -> OutputGate {
    OutputGate::new(permissions(SourceRole::Both, per_second), false)
}

#[test]
fn a_burst_of_half_a_second_passes_and_then_the_sustained_rate() {
    let mut gate = gate(20);
    let taps = |tested: &mut OutputGate, milliseconds, count: usize| {
        (0..count)
            .map(|_| filter(tested, milliseconds, &["down A", "up A"]))
            .filter(|(is_within_limit, _)| *is_within_limit)
            .count()
    };
    assert_eq!(taps(&mut gate, 1_000, 12), 10);
    assert_eq!(taps(&mut gate, 1_049, 1), 0);
    assert_eq!(taps(&mut gate, 1_050, 2), 1);
    assert_eq!(taps(&mut gate, 60_000, 12), 10);
    assert_eq!(gate.suppressed().rate_limited, 2 + 1 + 1 + 2);
}

#[test]
fn the_release_of_a_suppressed_press_is_suppressed_and_no_other() {
    let mut gate = gate(2);
    let (is_within_limit, passed) = filter(&mut gate, 1, &["down A", "down B", "down C"]);
    assert_eq!(
        (is_within_limit, passed),
        (false, vec!["down A".to_owned()])
    );
    let (is_allowed, releases) = filter(&mut gate, 1, &["up C", "up B", "up A", "up A"]);
    assert_eq!((is_allowed, releases), (true, vec!["up A".to_owned()]));
}

#[test]
fn a_key_that_is_down_is_not_pressed_again() {
    let mut gate = gate(4);
    assert_eq!(filter(&mut gate, 1, &["down A", "down A"]).1, ["down A"]);
    // A filter taps a key that a control holds.
    assert_eq!(filter(&mut gate, 2, &["down A", "up A"]).1, ["up A"]);
    assert_eq!(filter(&mut gate, 3, &["up A", "down A"]).1, ["down A"]);
    assert_eq!(gate.suppressed().rate_limited, 0);
}

#[test]
fn the_text_of_one_key_counts_as_one_press() {
    let mut gate = gate(4);
    let hello: Vec<_> = "hello".chars().map(|c| format!("write {c}")).collect();
    let hello: Vec<_> = hello.iter().map(String::as_str).collect();
    assert_eq!(filter(&mut gate, 1, &hello).1.len(), 5);
    assert_eq!(filter(&mut gate, 2, &hello).1.len(), 5);
    let (is_within_limit, passed) = filter(&mut gate, 3, &hello);
    assert_eq!((is_within_limit, passed.len()), (false, 0));
}

#[test]
fn system_keys_are_suppressed_unless_they_are_allowed() {
    let mut gate = gate(60);
    assert_eq!(filter(&mut gate, 1, &["down MetaLeft"]).1.len(), 0);
    assert_eq!(filter(&mut gate, 1, &["up MetaLeft"]).1.len(), 0);
    let chord = ["down ControlRight", "down F2", "up F2", "down AltLeft"];
    assert_eq!(filter(&mut gate, 1, &chord).1, chord);
    for key in ["F2", "Delete", "Backspace"] {
        let press = format!("down {key}");
        assert_eq!(filter(&mut gate, 1, &[&press]).1.len(), 0, "{key}");
    }
    assert_eq!(filter(&mut gate, 1, &["down A"]).1, ["down A"]);
    assert_eq!(gate.suppressed().system_keys, 4);
    let mut permissive = OutputGate::new(SourcePermissions::LOCAL, true);
    assert_eq!(
        filter(&mut permissive, 1, &["down MetaLeft"]).1,
        ["down MetaLeft"]
    );
}

/// The keys of the longest system chords, and what passes if each is pressed in a step of its own.
const CHORDS: [([&str; 3], &[&str]); 6] = [
    (
        ["Delete", "ControlLeft", "AltLeft"],
        &[
            "down Delete",
            "down ControlLeft",
            "up Delete",
            "down AltLeft",
        ],
    ),
    (
        ["AltRight", "F7", "ControlRight"],
        &["down AltRight", "down F7", "up F7", "down ControlRight"],
    ),
    (
        ["Backspace", "AltLeft", "ControlRight"],
        &[
            "down Backspace",
            "down AltLeft",
            "up Backspace",
            "down ControlRight",
        ],
    ),
    (
        ["ControlLeft", "NumpadDecimal", "AltRight"],
        &[
            "down ControlLeft",
            "down NumpadDecimal",
            "up NumpadDecimal",
            "down AltRight",
        ],
    ),
    (
        ["ControlRight", "AltLeft", "F12"],
        &["down ControlRight", "down AltLeft"],
    ),
    (
        ["AltRight", "ControlLeft", "Delete"],
        &["down AltRight", "down ControlLeft"],
    ),
];

#[test]
fn a_system_chord_is_never_down_in_any_order_of_its_keys() {
    for (keys, expected) in CHORDS {
        let presses = keys.map(|key| format!("down {key}"));
        let mut gate = OutputGate::new(SourcePermissions::LOCAL, false);
        let mut passed = Vec::new();
        for press in &presses {
            passed.extend(filter(&mut gate, 1, &[press]).1);
        }
        assert_eq!(passed, expected, "one by one");
        assert_eq!(gate.suppressed().system_keys, 1);
        let mut fresh = OutputGate::new(SourcePermissions::LOCAL, false);
        let presses = presses.each_ref().map(String::as_str);
        assert_eq!(filter(&mut fresh, 1, &presses).1, expected, "in one step");
        let mut permissive = OutputGate::new(SourcePermissions::LOCAL, true);
        assert_eq!(filter(&mut permissive, 1, &presses).1, presses, "allowed");
    }
}

#[test]
fn keys_released_early_are_released_once_and_before_all_presses_of_the_step() {
    let mut gate = OutputGate::new(SourcePermissions::LOCAL, false);
    filter(&mut gate, 1, &["down F2", "down Delete"]);
    let modifiers = ["down ControlLeft", "down AltLeft"];
    let passed = filter(&mut gate, 2, &modifiers).1;
    assert_eq!(
        passed,
        ["up Delete", "up F2", "down ControlLeft", "down AltLeft"]
    );
    assert_eq!(gate.suppressed().system_keys, 2);
    let late = ["up F2", "up Delete", "up AltLeft", "up ControlLeft"];
    assert_eq!(
        filter(&mut gate, 3, &late).1,
        ["up AltLeft", "up ControlLeft"]
    );
    assert_eq!(filter(&mut gate, 4, &["down F2"]).1, ["down F2"]);
}

#[test]
fn without_room_for_an_early_release_the_modifier_is_suppressed() {
    let mut gate = OutputGate::new(SourcePermissions::LOCAL, false);
    filter(&mut gate, 1, &["down Delete", "down ControlLeft"]);
    let other = OutputEvent {
        time: Timestamp(2),
        kind: EventKind::MoveBy(1, 1),
    };
    let mut events: Events = std::iter::repeat_n(other, Events::new().capacity() - 1).collect();
    events.push(event(2, "down AltLeft"));
    assert_eq!(gate.filter(|_| 0, 0, 0, &mut events), [true; 2]);
    assert_eq!(events.len(), Events::new().capacity() - 1);
    assert_eq!(gate.suppressed().system_keys, 1);
    assert_eq!(filter(&mut gate, 3, &["up Delete"]).1, ["up Delete"]);
}

#[test]
fn a_modifier_that_a_role_suppresses_releases_nothing() {
    let mut gate = OutputGate::new(SourcePermissions::LOCAL, false);
    gate.add_source(SourcePermissions::NETWORK);
    filter(&mut gate, 1, &["down Delete", "down ControlLeft"]);
    let mut events: Events = [event(2, "down AltLeft")].into_iter().collect();
    gate.filter(|_| 1, 0, 0, &mut events);
    assert!(events.is_empty());
    assert_eq!(gate.suppressed().system_keys, 0);
}

#[test]
fn each_source_has_its_own_rate_limit() {
    let mut gate = gate(2);
    gate.add_source(permissions(SourceRole::Both, 4));
    let mut tap = |source| {
        let mut events: Events = ["down A", "up A"]
            .map(|line| event(1, line))
            .into_iter()
            .collect();
        gate.filter(|_| source, 0, 0, &mut events)[source]
    };
    let outcomes = [0, 0, 1, 1, 1].map(&mut tap);
    assert_eq!(outcomes, [true, false, true, true, false]);
}

/// Returns the events that pass for a source with this role, and the suppressed ones.
fn filter_for(role: SourceRole, kinds: &[EventKind]) -> (Vec<EventKind>, Suppressed) {
    let permissions = SourcePermissions {
        role,
        ..SourcePermissions::LOCAL
    };
    let mut gate = OutputGate::new(permissions, false);
    let event = |&kind| OutputEvent {
        time: Timestamp(1),
        kind,
    };
    let mut events: Events = kinds.iter().map(event).collect();
    let [is_within_limit, _] = gate.filter(|_| 0, 0, 0, &mut events);
    assert!(is_within_limit, "the role does not affect the rate limit");
    let passed = events.iter().map(|it| it.kind).collect();
    (passed, gate.suppressed())
}

#[test]
fn a_pointer_source_presses_no_keys_and_a_key_source_does_not_point() {
    let code = |name: &str| name.parse().unwrap();
    let keys = [
        EventKind::KeyDown(code("A")),
        EventKind::KeyDown(code("ShiftLeft")),
        EventKind::Character('ñ'),
    ];
    let pointing = [
        EventKind::KeyDown(code("MouseLeft")),
        EventKind::KeyDown(code("PadSouth")),
        EventKind::MoveBy(3, -4),
        EventKind::MoveTo(0.5, 0.5),
        EventKind::Scroll(0, 120),
        EventKind::Axis(Axis::LeftX, 0.4),
    ];
    let all = [&keys[..], &pointing].concat();
    let suppressed = |keys_by_role, pointing_by_role| Suppressed {
        keys_by_role,
        pointing_by_role,
        ..Suppressed::default()
    };
    let (passed, count) = filter_for(SourceRole::Pointer, &all);
    assert_eq!((&passed[..], count), (&pointing[..], suppressed(3, 0)));
    let (key_events, key_count) = filter_for(SourceRole::Keys, &all);
    assert_eq!((&key_events[..], key_count), (&keys[..], suppressed(0, 6)));
    assert_eq!(filter_for(SourceRole::Both, &all), (all, suppressed(0, 0)));
}

#[test]
fn reports_and_returns_to_zero_pass_for_every_role() {
    let target = TargetId(0);
    let kinds = [
        EventKind::Axis(Axis::MoveZ, 0.0),
        EventKind::Axis(Axis::MoveZ, -0.0),
        EventKind::Depth(target, 1.0),
        EventKind::Value(target, 1.0),
        EventKind::Select(target),
        EventKind::Unselect(target),
    ];
    for role in SourceRole::ALL {
        let none = Suppressed::default();
        assert_eq!(filter_for(role, &kinds), (kinds.to_vec(), none));
    }
}

#[test]
fn each_source_has_its_own_role_and_releases_need_none() {
    let mut gate = OutputGate::new(permissions(SourceRole::Keys, 60), false);
    gate.add_source(permissions(SourceRole::Pointer, 60));
    let mut passed = |source, lines: &[&str]| {
        let mut events: Events = lines.iter().map(|line| event(1, line)).collect();
        gate.filter(|_| source, 0, 0, &mut events);
        events.len()
    };
    assert_eq!(passed(0, &["down A", "down MouseLeft"]), 1);
    assert_eq!(passed(1, &["down B", "down MouseLeft"]), 1);
    assert_eq!(passed(0, &["up MouseLeft"]), 1);
    assert_eq!(passed(1, &["up B", "up A"]), 1);
    assert_eq!(gate.suppressed().keys_by_role, 1);
    assert_eq!(gate.suppressed().pointing_by_role, 1);
}

#[test]
fn a_press_is_judged_by_the_source_of_its_hand() {
    let mut gate = OutputGate::new(permissions(SourceRole::Pointer, 2), false);
    gate.add_source(permissions(SourceRole::Both, 2));
    let of_second = EventKind::KeyDown("A".parse().unwrap());
    let mut step = |lines: &[&str]| {
        let mut events: Events = lines.iter().map(|line| event(1, line)).collect();
        let hand_of = |kind| usize::from(kind == of_second);
        let is_within_limit = gate.filter(hand_of, 0, 0, &mut events);
        (
            is_within_limit,
            events.len(),
            gate.suppressed_keys().count(),
        )
    };
    assert_eq!(
        step(&["down A", "down B", "down MouseLeft"]),
        ([true; 2], 2, 1)
    );
    // The second hand is beyond its limit, the first one is not.
    let both = ["up A", "down A", "up MouseLeft"];
    assert_eq!(step(&both), ([true, false], 2, 1));
    assert_eq!(step(&[]), ([true; 2], 0, 0));
}

#[test]
fn a_key_that_is_down_after_all_is_not_suppressed() {
    let mut gate = gate(60);
    let suppressed = |tested: &OutputGate| {
        let keys = tested.suppressed_keys().map(|key| key.to_string());
        keys.collect::<Vec<_>>()
    };
    filter(
        &mut gate,
        1,
        &["down Delete", "down ControlLeft", "down AltLeft"],
    );
    assert_eq!(suppressed(&gate), ["Delete"], "it was released early");
    filter(&mut gate, 2, &["down MetaLeft"]);
    assert_eq!(suppressed(&gate), ["MetaLeft"]);
    filter(&mut gate, 3, &["down ControlLeft"]);
    assert_eq!(suppressed(&gate), [""; 0], "it is down");
}

#[test]
fn each_source_returns_to_its_configured_role() {
    let mut gate = OutputGate::new(permissions(SourceRole::Keys, 60), false);
    gate.add_source(permissions(SourceRole::Pointer, 60));
    assert!(!gate.exceeds_configured_roles());
    gate.set_role(SourceRole::Pointer);
    assert!(!gate.exceeds_configured_roles(), "it permits less");
    gate.set_role(SourceRole::Both);
    assert!(gate.exceeds_configured_roles());
    gate.restore_roles();
    assert!(!gate.exceeds_configured_roles());
    assert_eq!([0, 1].map(|source| gate.allows_keys(source)), [true, false]);
}

#[test]
fn events_suppressed_by_role_do_not_count_as_presses() {
    let mut gate = OutputGate::new(permissions(SourceRole::Pointer, 2), false);
    let keys = ["down A", "write b", "down C"];
    assert_eq!(filter(&mut gate, 1, &keys), (true, vec![]));
    assert_eq!(
        filter(&mut gate, 1, &["down MouseLeft"]),
        (true, vec!["down MouseLeft".to_owned()])
    );
    assert_eq!(gate.suppressed().rate_limited, 0);
}

#[test]
fn events_before_the_first_index_are_not_filtered() {
    let mut gate = gate(60);
    let mut events: Events = ["up Q", "up Q"]
        .map(|line| event(1, line))
        .into_iter()
        .collect();
    gate.filter(|_| 0, 1, 0, &mut events);
    assert_eq!(events.len(), 1);
}

#[test]
fn presses_that_a_filter_added_do_not_count_against_the_rate_limit() {
    let mut gate = gate(4);
    for step in 0..20 {
        // Every step has one press of its own, and twelve of a filter before it.
        let mut events: Events = (0..12)
            .flat_map(|_| {
                [
                    event(step * 500, "down Backspace"),
                    event(step * 500, "up Backspace"),
                ]
            })
            .chain([event(step * 500, "down A"), event(step * 500, "up A")])
            .collect();
        assert_eq!(
            gate.filter(|_| 0, 0, 12, &mut events),
            [true; 2],
            "step {step}"
        );
        assert_eq!(events.len(), 26);
    }
    let burst = |tested: &mut OutputGate, added| {
        let write = [event(10_001, "write a"), event(10_001, "write b")];
        let mut events: Events = write.into_iter().cycle().take(6).collect();
        let [is_within_limit, _] = tested.filter(|_| 0, 0, added, &mut events);
        (is_within_limit, events.len())
    };
    // The characters of one key count as one press even after the characters of a filter.
    assert_eq!(burst(&mut gate, 4), (true, 6));
    assert_eq!(burst(&mut gate, 4), (true, 6));
    assert_eq!(burst(&mut gate, 4), (false, 4));
}

#[test]
fn a_release_without_room_follows_as_soon_as_there_is_some() {
    let mut gate = gate(20);
    filter(&mut gate, 1_000, &["down ShiftLeft", "down A"]);
    let movement = OutputEvent {
        time: Timestamp(2_000_000),
        kind: EventKind::MoveBy(1, 0),
    };
    let mut full = Events::new();
    while full.try_push(movement).is_ok() {}
    let mut events = full.clone();
    gate.release_all(Timestamp(2_000_000), &mut events);
    assert_eq!(events, full);
    let mut later = Events::new();
    gate.release_overdue(Timestamp(2_100_000), &mut later);
    let expected = [event(2_100, "up A"), event(2_100, "up ShiftLeft")];
    assert_eq!(later.as_slice(), expected);
    assert_eq!(filter(&mut gate, 2_200, &["up A"]), (true, vec![]));
    gate.release_overdue(Timestamp(2_300_000), &mut later);
    assert_eq!(later.len(), 2);
}
