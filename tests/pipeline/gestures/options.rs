//! Options of keys: locks, activation on release, debounce, tap-hold.

use ademan::contact::{Phase, TargetId, Touch};
use ademan::device::Events;
use ademan::hand::{Finger, Side};
use ademan::time::Timestamp;
use parry3d::math::Vec2;

use super::{assert_events, assert_transcript, simulate, simulate_keys};
use crate::rig::Rig;

const LOCKS: &str = "q|1 w|2 e r / shift !shift#S *ctrl#C / layer1 !layer1#L !layer0#B *layer2#M";

fn locks(script: &str) -> String {
    simulate_keys(LOCKS, script)
}

#[test]
fn a_locked_modifier_is_down_from_one_tap_to_the_next() {
    assert_eq!(locks("thumb S tap; wait 50"), "dn:ShiftLeft");
    assert_eq!(
        locks("thumb S tap; index q tap; index w tap; thumb S tap; index e tap"),
        "dn:ShiftLeft dn:Q up:Q dn:W up:W up:ShiftLeft dn:E up:E"
    );
}

#[test]
fn a_lock_is_momentary_if_another_key_is_pressed_meanwhile() {
    assert_eq!(
        locks("thumb S up; thumb S down; index q tap; thumb S up; index e tap"),
        "dn:ShiftLeft dn:Q up:Q up:ShiftLeft dn:E up:E"
    );
}

#[test]
fn a_finger_that_slides_off_a_lock_does_not_lock_it() {
    let slide = "thumb S up; thumb S down; thumb C down; thumb C up";
    assert_eq!(locks(slide), "dn:ShiftLeft up:ShiftLeft");
    assert_eq!(
        locks(&format!("thumb S tap; {slide}; index q tap")),
        "dn:ShiftLeft up:ShiftLeft dn:Q up:Q"
    );
}

#[test]
fn a_one_shot_does_not_change_a_lock() {
    assert_eq!(
        locks("thumb S tap; thumb C tap; index q tap; index w tap"),
        "dn:ShiftLeft dn:ControlLeft dn:Q up:Q up:ControlLeft dn:W up:W"
    );
}

#[test]
fn a_momentary_modifier_does_not_end_a_lock_of_the_same_key() {
    assert_eq!(
        locks("thumb S tap; middle shift tap; index q tap"),
        "dn:ShiftLeft dn:Q up:Q"
    );
}

#[test]
fn a_locked_layer_stays_until_its_key_is_tapped_again() {
    assert_eq!(
        locks("thumb L tap; index q tap; index w tap; index e tap; thumb L tap; index q tap"),
        "dn:1 up:1 dn:2 up:2 dn:E up:E dn:Q up:Q"
    );
    assert_eq!(
        locks("thumb L tap; thumb B tap; index q tap"),
        "dn:Q up:Q",
        "the layer locked last is active"
    );
}

#[test]
fn a_one_shot_layer_precedes_a_locked_one() {
    assert_events(
        "q|1|2 !layer1#L *layer2#M",
        "thumb L tap; thumb M tap; index q tap; index q tap",
        "dn:2 up:2 dn:1 up:1",
    );
}

#[test]
fn release_all_unlocks() {
    assert_eq!(
        locks("thumb S tap; thumb L tap; release-devices; index q tap"),
        "dn:ShiftLeft up:ShiftLeft dn:Q up:Q"
    );
    assert_eq!(
        locks("thumb S tap; release-devices; thumb S tap"),
        "dn:ShiftLeft up:ShiftLeft dn:ShiftLeft",
        "the next tap locks it again"
    );
}

const RELEASE: &str = "^q|1 w ^e / shift *shift#S layer1 *layer1#L";

fn release(script: &str) -> String {
    simulate_keys(RELEASE, script)
}

#[test]
fn a_key_that_fires_on_release_is_tapped_at_the_release() {
    // 1 mm deep 3 ms into the step up.
    assert_transcript(
        RELEASE,
        "index q up; index q down; wait 80; index q up",
        "t:103ms dn:Q up:Q",
    );
    assert_eq!(release("index q up; index q down; wait 500"), "");
    assert_eq!(
        release("index q up; index q 3; index q 0.5; index q 3; index q 0.5"),
        "dn:Q up:Q dn:Q up:Q",
        "the finger does not have to leave the key"
    );
}

#[test]
fn a_cancelled_press_does_not_fire_on_release() {
    let press = "index q up; index q down";
    for end in [
        "index w down; index w up",
        "hide index; wait 20; index q up",
        "doubt index; wait 20; trust index & index q up",
        "reacquire & index q down; index q up",
        "reset; index q up",
        "release-devices; index q up",
        "index q NaN; wait 20; index q up",
    ] {
        assert_eq!(release(&format!("{press}; {end}; wait 50")), "", "{end}");
    }
}

#[test]
fn the_action_fired_on_release_is_chosen_at_the_press() {
    assert_eq!(
        release(
            "thumb layer1 up & index q up; thumb layer1 down; index q down; thumb layer1 up; index q up"
        ),
        "dn:1 up:1"
    );
}

#[test]
fn a_one_shot_applies_to_the_key_that_fires_first() {
    let rollover = "index q up & middle w up; index q down; middle w down; middle w up; index q up";
    assert_eq!(
        release(&format!("thumb S tap; {rollover}")),
        "dn:ShiftLeft dn:W up:W up:ShiftLeft dn:Q up:Q"
    );
    assert_eq!(
        release("thumb S tap; index q tap; index w tap"),
        "dn:ShiftLeft dn:Q up:Q up:ShiftLeft dn:W up:W"
    );
    assert_eq!(
        release("thumb S tap; index q up; index q down; index w down; index w up; index w tap"),
        "dn:ShiftLeft dn:W up:W up:ShiftLeft",
        "a cancelled press does not use up the one-shot"
    );
}

#[test]
fn earlier_presses_are_released_before_a_key_fires_on_release() {
    assert_eq!(
        release("index q up & middle w up; index q down; middle w down; index q up & middle w up"),
        "dn:W up:W dn:Q up:Q"
    );
    assert_eq!(
        release(
            "index q up & middle e up; index q down; middle e down; index q up & middle e up; index q up"
        ),
        "dn:Q up:Q dn:E up:E"
    );
}

const BOUNCE: &str = "q%50 w";

#[test]
fn a_bounce_within_the_debounce_time_is_ignored() {
    let bounce = "index q up; index q 3; index q 0.5; index q 3; index q 0.5; index q 3";
    assert_events(BOUNCE, bounce, "dn:Q up:Q");
    assert_events(
        BOUNCE,
        &bounce.replace('q', "w"),
        "dn:W up:W dn:W up:W dn:W",
    );
    // The end of a bounce restarts the debounce time.
    assert_events(
        BOUNCE,
        &format!("{bounce}; wait 50; index q up; index q 3"),
        "dn:Q up:Q",
    );
    assert_events(
        BOUNCE,
        &format!("{bounce}; index q up; wait 50; index q 3"),
        "dn:Q up:Q dn:Q",
    );
}

#[test]
fn the_debounce_time_runs_from_the_release_to_the_next_press() {
    // It is released at 28 ms and pressed 8 ms into the last step.
    for (pause, expected) in [(30, "dn:Q up:Q"), (40, "dn:Q up:Q dn:Q")] {
        let script = format!("index q up; index q down; index q up; wait {pause}; index q down");
        assert_eq!(simulate_keys(BOUNCE, &script), expected, "{pause} ms");
    }
}

#[test]
fn the_debounce_time_is_per_key_and_for_every_finger() {
    assert_events(
        BOUNCE,
        "middle q 3 0 up; index q tap; middle q 3 0 down",
        "dn:Q up:Q",
    );
    assert_events(
        "q%50 e%50",
        "index q tap; index e tap",
        "dn:Q up:Q dn:E up:E",
    );
    // `release_all` resets it.
    assert_events(
        BOUNCE,
        "index q tap; release-devices; index q tap",
        "dn:Q up:Q dn:Q up:Q",
    );
}

#[test]
fn the_debounce_time_runs_from_the_end_of_each_press_of_two_fingers() {
    // Both fingers bounce, and the first one stays down for longer than the debounce time.
    let bounces =
        "middle q 3 0 up; index q tap; index q down; middle q 3 0 down; middle q 3 0 up; wait 40";
    assert_events(
        BOUNCE,
        &format!("{bounces}; index q up; index q down"),
        "dn:Q up:Q",
    );
    assert_events(
        BOUNCE,
        &format!("{bounces}; index q up; wait 50; index q down"),
        "dn:Q up:Q dn:Q",
    );
}

const HOLD: &str = "q>shift w|2 e>layer1 r>x / ^t *shift#S u>ctrl";

fn hold(script: &str) -> String {
    simulate_keys(HOLD, script)
}

#[test]
fn an_early_release_of_a_tap_hold_key_taps() {
    // Pressed at 18 ms, released 185 ms later.
    assert_transcript(
        HOLD,
        "index q up; index q down; wait 180; index q up",
        "t:203ms dn:Q up:Q",
    );
    assert_eq!(hold("index q tap; index q tap"), "dn:Q up:Q dn:Q up:Q");
}

#[test]
fn a_long_press_of_a_tap_hold_key_holds_until_the_release() {
    // Pressed at 18 ms, held 200 ms later.
    assert_transcript(
        HOLD,
        "index q up; index q down; wait 300; index q up",
        "t:218ms dn:ShiftLeft t:105ms up:ShiftLeft",
    );
    assert_eq!(hold("index r up; index r down; wait 300"), "dn:X");
    // Regardless of its latch.
    assert_events(
        "q>*shift",
        "index q up; index q down; wait 300; index q up",
        "dn:ShiftLeft up:ShiftLeft",
    );
}

#[test]
fn a_tap_hold_key_does_not_hold_by_poses_of_the_other_hand() {
    let left = |end: &str| {
        let unseen = "index q up; index q down; wait 100; right; index w up; wait 150";
        hold(&format!("left; {unseen}; left & index q {end}"))
    };
    assert_eq!(left("up"), "dn:Q up:Q", "it may have lifted early");
    assert_eq!(left("down"), "dn:ShiftLeft", "it has stayed");
}

#[test]
fn the_touch_times_decide_between_tap_and_hold_within_a_step() {
    // Pressed 8.081 ms into its step; 1 mm deep 8.056 or 8.169 ms into the twentieth step after it.
    for (depth, expected) in [
        ("0.3", "t:218.056ms dn:Q up:Q"),
        ("0.35", "t:218.081ms dn:ShiftLeft t:0.088ms up:ShiftLeft"),
    ] {
        let script = format!("index q up; index q 3.9; wait 190; index q {depth}");
        assert_eq!(simulate(HOLD, &script), expected);
    }
}

#[test]
fn another_key_turns_a_tap_hold_key_into_a_hold() {
    let around = |key: &str| {
        format!(
            "thumb {key} up & index w up; thumb {key} down; index w tap; thumb {key} up; index w tap"
        )
    };
    assert_eq!(
        hold(&around("q")),
        "dn:ShiftLeft dn:W up:W up:ShiftLeft dn:W up:W"
    );
    assert_eq!(hold(&around("e")), "dn:2 up:2 dn:W up:W");
    assert_eq!(hold(&around("r")), "dn:X dn:W up:W up:X dn:W up:W");
}

#[test]
fn two_holds_add_up_and_the_second_can_be_a_tap() {
    assert_eq!(
        hold(
            "thumb q up & ring u up; thumb q down; ring u down; index w tap; ring u up; thumb q up"
        ),
        "dn:ShiftLeft dn:ControlLeft dn:W up:W up:ControlLeft up:ShiftLeft"
    );
    assert_eq!(
        hold("thumb q up & ring u up; thumb q down; ring u down; ring u up; thumb q up"),
        "dn:ShiftLeft dn:U up:U up:ShiftLeft"
    );
}

#[test]
fn a_tap_hold_key_cancelled_while_pending_has_no_effect() {
    let press = "index q up; index q down";
    for end in [
        "index w down; index w up",
        "hide index; wait 20; index q up",
        "reacquire & index q down; index q up",
        "reset; index q up",
        "release-devices; index q up",
    ] {
        assert_eq!(hold(&format!("{press}; {end}; wait 300")), "", "{end}");
    }
}

#[test]
fn a_hold_is_released_however_it_ends() {
    let press = "index q up; index q down; wait 300";
    for end in ["index w down", "hide index", "reset", "release-devices"] {
        assert_eq!(
            hold(&format!("{press}; {end}; wait 300")),
            "dn:ShiftLeft up:ShiftLeft",
            "{end}"
        );
    }
}

#[test]
fn a_one_shot_applies_to_the_tap_of_a_tap_hold_key() {
    assert_eq!(
        hold("thumb S tap; index q tap; index w tap"),
        "dn:ShiftLeft dn:Q up:Q up:ShiftLeft dn:W up:W"
    );
    assert_eq!(
        hold("thumb S tap; index u up; index u down; wait 300; middle w tap"),
        "dn:ControlLeft dn:ShiftLeft dn:W up:W up:ShiftLeft",
        "a hold that is a modifier does not use up the one-shot"
    );
}

#[test]
fn a_full_event_list_fires_nothing_and_leaves_no_key_down() {
    let mut rig = Rig::with_keys("q>shift ^w");
    let touch = |time: u64, finger: Finger, target: u32, phase: Phase| Touch {
        time: Timestamp(time),
        side: Side::Right,
        finger,
        target: TargetId(target),
        phase,
        depth: 0.5,
        position: Vec2::ZERO,
    };
    let mut events_with_room = |now: u64, touches: &[Touch], room: usize| {
        let filler = ademan::device::OutputEvent {
            time: Timestamp(0),
            kind: ademan::device::EventKind::Depth(TargetId(9), 0.0),
        };
        let mut events = Events::new();
        (room..events.capacity()).for_each(|_| events.push(filler));
        let mut pose = rig.pose();
        pose.time = Timestamp(now);
        rig.update(&pose, touches, &mut events);
        events.iter().filter(|event| **event != filler).count()
    };
    let (index, middle) = (Finger::Index, Finger::Middle);
    let presses = [
        touch(1, index, 0, Phase::Pressed),
        touch(2, middle, 1, Phase::Pressed),
    ];
    assert_eq!(
        events_with_room(2, &presses, 64),
        1,
        "the second press turns the first into a hold"
    );
    assert_eq!(
        events_with_room(3, &[touch(3, index, 0, Phase::Left)], 64),
        1
    );
    assert_eq!(
        events_with_room(4, &[touch(4, index, 0, Phase::Pressed)], 64),
        0
    );
    assert_eq!(
        events_with_room(5, &[touch(5, middle, 1, Phase::Released)], 8),
        0
    );
    assert_eq!(
        events_with_room(300_000, &[], 8),
        0,
        "a hold waits until there is room"
    );
    assert_eq!(events_with_room(300_001, &[], 64), 1);
    assert_eq!(
        events_with_room(300_002, &[touch(300_002, index, 0, Phase::Left)], 64),
        1
    );
}
