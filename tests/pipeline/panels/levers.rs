//! Levers.

use super::assert_events;

const LIFT: &str = r#"levers: [(name: "Lift", at_mm: (0, 0), length_mm: 80, springs_back: true,
    output: Axis("MoveZ"))]"#;
const RATCHET: &str = r#"levers: [(name: "Jack", at_mm: (0, 0), length_mm: 80, springs_back: true,
    output: ScrollY(10))]"#;
const GEAR: &str = r#"levers: [(name: "Gear", at_mm: (0, 0), length_mm: 80, detents: 2, rest: 0)]"#;

#[test]
fn a_lever_springs_back_however_its_press_ends() {
    for end in [
        "index Lift 40 0 up",
        "hide index",
        "doubt index",
        "index Lift 200 0 down",
        "release",
    ] {
        assert_events(
            LIFT,
            &format!("index Lift up; index Lift down; index Lift 40 0 down; {end}; wait 50"),
            "value:Lift=1.000 axis:MoveZ=+1.000 axis:MoveZ=+0.000 value:Lift=0.500",
        );
    }
}

#[test]
fn a_lever_stops_at_its_ends() {
    assert_events(
        &LIFT.replace("springs", "throw_deg: 120, springs"),
        "index Lift up; index Lift down; index Lift -60 0 down; index Lift 60 0 down",
        "value:Lift=0.000 axis:MoveZ=-1.000 value:Lift=1.000 axis:MoveZ=+1.000",
    );
}

#[test]
fn the_value_of_a_lever_is_its_angle_not_its_position() {
    // Half the angle to one side, 30°, is a little more than half the track.
    assert_events(
        &LIFT.replace(
            "springs_back: true,\n    output: Axis(\"MoveZ\")",
            "throw_deg: 120",
        ),
        "index Lift up; index Lift down; index Lift 23.1 0 down",
        "value:Lift=0.750",
    );
}

#[test]
fn a_lever_that_springs_back_scrolls_like_a_ratchet() {
    assert_events(
        RATCHET,
        "index Jack up; index Jack down; index Jack 40 0 down; index Jack 40 0 up; index Jack up; \
         index Jack down; index Jack 40 0 down",
        "value:Jack=1.000 scroll=+0,+600 value:Jack=0.500 value:Jack=1.000 scroll=+0,+600",
    );
}

#[test]
fn a_lever_with_notches_snaps_and_stays() {
    assert_events(
        GEAR,
        "index Gear -20 0 up; index Gear -20 0 down; index Gear 18 0 down; index Gear 20 0 down; \
         index Gear 20 0 up; release; index Gear -20 0 up; index Gear -20 0 down; index Gear 16 0 \
         down",
        "value:Gear=0.500 value:Gear=1.000",
    );
}
