//! Valves.

use super::simulate;

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
    assert_eq!(
        simulate(
            WATER,
            "index Water 20 0 up; index Water 20 0 down; index Water 0 -20 down; index Water 0 -20 \
             up; index Water 20 0 up; index Water 20 0 down; index Water 0 -20 down"
        ),
        "value:Water=0.083 value:Water=0.167"
    );
}

#[test]
fn a_valve_can_be_turned_by_a_pinch() {
    assert_eq!(
        simulate(
            WATER,
            "tip thumb -30 20 0 & tip index 30 20 0; tip thumb -10 20 0 & tip index 10 20 0; palm 0 -54 0"
        ),
        "value:Water=0.050"
    );
}
