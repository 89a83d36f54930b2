//! Keys: modifiers, layers, one-shots, depth and release.

use ademan::contact::{Phase, TargetId, Touch};
use ademan::device::{EventKind, Events};
use ademan::hand::{Finger, Side};
use ademan::time::Timestamp;
use parry3d::math::Vec2;

use super::{assert_events, assert_transcript, simulate_keys};
use crate::rig::Rig;

const BOARD: &str = "q|1 w|2 e r / shift *shift#S ctrl *ctrl#C / layer1 *layer1#L";

fn keys(script: &str) -> String {
    simulate_keys(BOARD, script)
}

#[test]
fn a_held_shift_is_down_while_it_is_pressed() {
    assert_eq!(
        keys(
            "thumb shift up; thumb shift down; index q tap; index w tap; thumb shift up; index e tap"
        ),
        "dn:ShiftLeft dn:Q up:Q dn:W up:W up:ShiftLeft dn:E up:E"
    );
}

#[test]
fn a_one_shot_shift_applies_to_the_next_key_only() {
    assert_eq!(
        keys("thumb S tap; wait 50"),
        "",
        "a tap alone sends nothing"
    );
    assert_eq!(
        keys("thumb S tap; index q tap; index w tap"),
        "dn:ShiftLeft dn:Q up:Q up:ShiftLeft dn:W up:W"
    );
}

#[test]
fn a_one_shot_shift_ends_when_another_key_is_pressed() {
    assert_eq!(
        keys(
            "thumb S tap; index q up & middle w up; index q down; middle w down; index q up; middle w up"
        ),
        "dn:ShiftLeft dn:Q up:ShiftLeft dn:W up:Q up:W"
    );
}

#[test]
fn a_one_shot_shift_that_stays_pressed_is_momentary() {
    assert_eq!(
        keys("thumb S up; thumb S down; index q tap; index w tap; thumb S up; index e tap"),
        "dn:ShiftLeft dn:Q up:Q dn:W up:W up:ShiftLeft dn:E up:E"
    );
}

#[test]
fn a_second_tap_cancels_a_one_shot() {
    assert_eq!(keys("thumb S tap; thumb S tap; index q tap"), "dn:Q up:Q");
    assert_eq!(
        keys("thumb S tap; thumb S tap; thumb S tap; index q tap"),
        "dn:ShiftLeft dn:Q up:Q up:ShiftLeft"
    );
}

#[test]
fn several_one_shots_add_up() {
    assert_eq!(
        keys("thumb S tap; thumb C tap; index q tap; index w tap"),
        "dn:ShiftLeft dn:ControlLeft dn:Q up:Q up:ControlLeft up:ShiftLeft dn:W up:W"
    );
    assert_eq!(
        keys("thumb S tap; thumb C tap; thumb S tap; index q tap"),
        "dn:ControlLeft dn:Q up:Q up:ControlLeft",
        "cancelling one leaves the other armed"
    );
}

#[test]
fn two_capitals_in_rollover_keep_shift_down_between_them() {
    assert_eq!(
        keys(
            "thumb S tap; index q up & middle w up; index q down; thumb S tap; middle w down; index q \
             up; middle w up"
        ),
        "dn:ShiftLeft dn:Q dn:W up:Q up:W up:ShiftLeft"
    );
}

#[test]
fn a_one_shot_does_not_arm_when_the_finger_slides_off() {
    assert_eq!(
        keys("thumb S up; thumb S down; thumb ctrl down; index q tap"),
        "dn:Q up:Q"
    );
}

#[test]
fn a_layer_changes_the_actions_of_keys_while_it_is_held() {
    assert_eq!(
        keys(
            "thumb layer1 up; thumb layer1 down; index q tap; index e tap; thumb layer1 up; index q tap"
        ),
        "dn:1 up:1 dn:E up:E dn:Q up:Q",
        "a key without an action in the layer has the action of the base layer"
    );
}

#[test]
fn the_layer_pressed_last_is_active() {
    let script = "thumb layer1 up & index layer2 up & ring q up; thumb layer1 down; index layer2 down; \
             ring q tap; index layer2 up; ring q tap; thumb layer1 up; ring q tap";
    assert_events(
        "q|1|2 layer1 layer2",
        script,
        "dn:2 up:2 dn:1 up:1 dn:Q up:Q",
    );
}

#[test]
fn a_key_releases_the_action_it_has_pressed() {
    assert_eq!(
        keys(
            "thumb layer1 up & index q up; thumb layer1 down; index q down; thumb layer1 up; index q up"
        ),
        "dn:1 up:1"
    );
    assert_eq!(
        keys("thumb layer1 up & index q up; index q down; thumb layer1 down; index q up"),
        "dn:Q up:Q"
    );
}

#[test]
fn a_one_shot_layer_ends_with_the_next_key() {
    assert_eq!(
        keys("thumb L tap; index q tap; index q tap"),
        "dn:1 up:1 dn:Q up:Q"
    );
    assert_eq!(keys("thumb L tap; thumb L tap; index q tap"), "dn:Q up:Q");
    assert_eq!(
        keys("thumb L tap; thumb S tap; index w tap; index w tap"),
        "dn:ShiftLeft dn:2 up:2 up:ShiftLeft dn:W up:W",
        "a modifier is not the next key"
    );
    assert_eq!(
        keys("thumb L up; thumb L down; index q tap; index w tap; thumb L up; index q tap"),
        "dn:1 up:1 dn:2 up:2 dn:Q up:Q",
        "a held one-shot layer is momentary"
    );
}

#[test]
fn keys_are_released_in_reverse_order_and_modifiers_last() {
    let press = "thumb ctrl up & index q up & middle e up; thumb S tap; index q down; thumb ctrl up; \
             thumb ctrl down; middle e down";
    let down = "dn:ShiftLeft dn:Q dn:ControlLeft up:ShiftLeft dn:E";
    assert_eq!(keys(press), down);
    assert_eq!(
        keys(&format!(
            "{press}; release-devices; index q up & middle e up & thumb ctrl up"
        )),
        format!("{down} up:E up:Q up:ControlLeft"),
        "the fingers release nothing a second time"
    );
}

#[test]
fn release_all_forgets_one_shots_and_layers() {
    assert_eq!(
        keys("thumb S tap; thumb L tap; release-devices; index q tap"),
        "dn:Q up:Q"
    );
}

#[test]
fn the_depth_of_an_analog_key_is_emitted_when_it_changes() {
    assert_transcript(
        "~q w",
        "index q up; index q 1; wait 50; index q 3; index q 9; wait 50; index q up",
        "t:20ms depth:q=0.250 t:55ms dn:Q t:5ms depth:q=0.750 t:10ms depth:q=1.000 \
         t:55.333ms up:Q t:0.667ms depth:q=0.000",
    );
    assert_events("~q w", "index w up; index w 3; index w up", "dn:W up:W");
}

#[test]
fn the_depth_of_an_old_press_is_not_emitted_after_release_all() {
    assert_events(
        "~q",
        "index q up; index q 1; release-devices; index q 1.5; index q 0.5; index q up",
        "depth:q=0.250 depth:q=0.000",
    );
}

#[test]
fn the_deepest_finger_on_an_analog_key_counts() {
    assert_events(
        "~q",
        "index q up & middle q 3 0 up; index q 1; middle q 3 0 3; index q 1.5; middle q 3 0 up; release-devices",
        "depth:q=0.250 dn:Q depth:q=0.750 up:Q depth:q=0.375 depth:q=0.000",
    );
    assert_events(
        "~q",
        "index q up & middle q 3 0 up; index q 1.5; middle q 3 0 1",
        "depth:q=0.375",
    );
}

fn touch(time: u64, finger: Finger, target: u32, phase: Phase) -> Touch {
    Touch {
        time: Timestamp(time),
        side: Side::Right,
        finger,
        target: TargetId(target),
        phase,
        depth: 0.5,
        position: Vec2::ZERO,
    }
}

#[test]
fn a_release_counts_only_from_the_finger_and_target_that_pressed() {
    let mut rig = Rig::with_keys("q w");
    let mut update = |touches: &[Touch]| {
        let mut events = Events::new();
        rig.update(&rig.pose(), touches, &mut events);
        events.iter().map(|event| event.kind).collect::<Vec<_>>()
    };
    let q = "Q".parse().unwrap();
    assert_eq!(
        update(&[touch(1, Finger::Index, 0, Phase::Pressed)]),
        [EventKind::KeyDown(q)]
    );
    for unrelated in [
        touch(2, Finger::Middle, 0, Phase::Released),
        touch(3, Finger::Index, 1, Phase::Cancelled),
        touch(4, Finger::Index, 77, Phase::Left),
    ] {
        assert_eq!(update(&[unrelated]), []);
    }
    assert_eq!(
        update(&[touch(5, Finger::Index, 0, Phase::Left)]),
        [EventKind::KeyUp(q)]
    );
}

#[test]
fn a_finger_that_presses_a_second_key_releases_the_first() {
    let mut rig = Rig::with_keys("q w");
    let mut events = Events::new();
    for target in [0, 1] {
        let touch = touch(1, Finger::Index, target, Phase::Pressed);
        rig.update(&rig.pose(), &[touch], &mut events);
    }
    let [q, w] = ["Q", "W"].map(|name| name.parse().unwrap());
    let actions: Vec<EventKind> = events.iter().map(|event| event.kind).collect();
    assert_eq!(
        actions,
        [
            EventKind::KeyDown(q),
            EventKind::KeyUp(q),
            EventKind::KeyDown(w)
        ]
    );
}

#[test]
fn a_full_event_list_drops_presses_but_not_releases() {
    let mut rig = Rig::with_keys("q w");
    let filler = ademan::device::OutputEvent {
        time: Timestamp(0),
        kind: EventKind::Depth(TargetId(9), 0.0),
    };
    let mut events_with_room = |touches: &[Touch], room: usize| {
        let mut events = Events::new();
        (room..events.capacity()).for_each(|_| events.push(filler));
        rig.update(&rig.pose(), touches, &mut events);
        let sent = events.iter().filter(|event| **event != filler);
        sent.map(|event| format!("{:?}", event.kind))
            .collect::<Vec<_>>()
            .join(" ")
    };
    let (q, w) = (0, 1);
    assert_eq!(
        events_with_room(&[touch(1, Finger::Index, q, Phase::Pressed)], 64),
        "KeyDown(KeyCode(16))"
    );
    assert_eq!(
        events_with_room(&[touch(2, Finger::Middle, w, Phase::Pressed)], 1),
        ""
    );
    assert_eq!(
        events_with_room(&[touch(3, Finger::Index, q, Phase::Released)], 0),
        ""
    );
    assert_eq!(
        events_with_room(&[], 1),
        "KeyUp(KeyCode(16))",
        "the release follows as soon as there is room"
    );
    assert_eq!(
        events_with_room(&[touch(4, Finger::Middle, w, Phase::Released)], 64),
        ""
    );
}
