//! Valves.

use super::{assert_events, simulate};

const WATER: &str = r#"valves: [(name: "Water", at_mm: (0, 0), diameter_mm: 60, turns: 3)]"#;
const TURN: &str =
    "index Water 0 -20 down; index Water -20 0 down; index Water 0 20 down; index Water 20 0 down";

#[test]
fn a_valve_turns_several_times_up_to_its_end() {
    let turns = |count| {
        let turns = vec![TURN; count].join("; ");
        let events = simulate(
            WATER,
            &format!("index Water 20 0 up; index Water 20 0 down; {turns}; index Water 0 20 down"),
        );
        let values: Vec<String> = events.split(' ').map(str::to_owned).collect();
        values[values.len() - 2..].join(" ")
    };
    assert_eq!(turns(1), "value:Water=0.333 value:Water=0.250");
    assert_eq!(turns(2), "value:Water=0.667 value:Water=0.583");
    assert_eq!(turns(3), "value:Water=1.000 value:Water=0.917");
    assert_eq!(
        turns(4),
        "value:Water=1.000 value:Water=0.917",
        "it stops at its end"
    );
}

#[test]
fn a_valve_continues_from_its_last_value() {
    assert_events(
        WATER,
        "index Water 20 0 up; index Water 20 0 down; index Water 0 -20 down; index Water 0 -20 \
         up; index Water 20 0 up; index Water 20 0 down; index Water 0 -20 down",
        "value:Water=0.083 value:Water=0.167",
    );
}

#[test]
fn a_valve_can_be_turned_by_a_pinch() {
    assert_events(
        WATER,
        "tip thumb -30 20 0 & tip index 30 20 0; tip thumb -10 20 0 & tip index 10 20 0; palm 0 -54 0",
        "value:Water=0.050",
    );
}

const WHEEL: &str = r#"valves: [(name: "Wheel", at_mm: (0, 0), diameter_mm: 60, turns: 2.5, initial: 0.5,
    springs_back: true, twist_gain: 5, output: Axis("Wheel"))]"#;

#[test]
fn a_wheel_turns_to_both_sides_and_springs_back_however_its_press_ends() {
    for end in [
        "index Wheel 0 20 up",
        "hide index",
        "doubt index",
        "index Wheel 200 0 down",
        "release",
    ] {
        assert_events(
            WHEEL,
            &format!(
                "index Wheel 20 0 up; index Wheel 20 0 down; index Wheel 0 -20 down; index Wheel 20 0 down; \
                 index Wheel 0 20 down; {end}; wait 50"
            ),
            "value:Wheel=0.600 axis:Wheel=+0.200 value:Wheel=0.500 axis:Wheel=+0.000 \
             value:Wheel=0.400 axis:Wheel=-0.200 axis:Wheel=+0.000 value:Wheel=0.500",
        );
    }
}

#[test]
fn a_wheel_reaches_its_lock_after_more_than_a_turn() {
    let events = simulate(
        WHEEL,
        &format!(
            "index Wheel 20 0 up; index Wheel 20 0 down; {}; {}",
            TURN.replace("Water", "Wheel"),
            TURN.replace("Water", "Wheel")
        ),
    );
    assert!(
        events.ends_with("value:Wheel=0.900 axis:Wheel=+0.800 value:Wheel=1.000 axis:Wheel=+1.000"),
        "{events}"
    );
}

#[test]
fn a_wheel_follows_the_twist_of_a_hand_with_its_gain_and_springs_back_when_the_fingers_open_or_are_lost()
 {
    let open = "tip thumb -30 20 0 & tip index 30 20 0";
    for end in [open, "hide thumb", "doubt index", "release-devices"] {
        assert_events(
            WHEEL,
            &format!(
                "{open}; tip thumb -10 20 0 & tip index 10 20 0; palm 0 -36 0; palm 0 36 0; {end}; wait 50"
            ),
            "value:Wheel=0.700 axis:Wheel=+0.400 value:Wheel=0.300 axis:Wheel=-0.400 \
             axis:Wheel=+0.000 value:Wheel=0.500",
        );
    }
}

#[test]
fn a_pinch_takes_a_wheel_over_from_a_finger_on_the_rim_without_a_return() {
    let events = simulate(
        WHEEL,
        "tip thumb -30 20 0; index Wheel 20 0 up; index Wheel 20 0 down; index Wheel 0 -20 down; \
         tip thumb 0 0 22; palm 0 -36 0",
    );
    assert_eq!(
        events,
        "value:Wheel=0.600 axis:Wheel=+0.200 value:Wheel=0.800 axis:Wheel=+0.600"
    );
}
