//! Keys that write a text.

use super::{assert_events, simulate};
use crate::rig::Rig;

fn type_text(text: &str, script: &str) -> String {
    let key = format!("keys: [(action: Text(\"{text}\"), name: \"T\", at_mm: (0, 0))]");
    simulate(&key, script)
}

#[test]
fn a_text_is_typed_once_per_press() {
    assert_eq!(
        type_text("ñ", "index T up; index T down; wait 2000"),
        "write:ñ"
    );
    assert_eq!(
        type_text("né", "index T tap; wait 50; index T tap"),
        "write:n write:é write:n write:é"
    );
    assert_eq!(type_text("ñ", "index T up; index T 1; index T up"), "");
}

#[test]
fn every_unicode_character_can_be_typed() {
    for character in ['ß', 'Ω', 'я', '字', '€', '🙂', '–'] {
        assert_eq!(
            type_text(&character.to_string(), "index T tap"),
            format!("write:{character}")
        );
    }
}

#[test]
fn a_text_of_32_characters_is_typed_completely_and_in_order() {
    let text = "abcdefghijklmnopqrstuvwxyzäöüßñ.";
    assert_eq!(text.chars().count(), 32);
    let written: Vec<String> = text
        .chars()
        .map(|character| format!("write:{character}"))
        .collect();
    assert_eq!(type_text(text, "index T tap"), written.join(" "));
}

#[test]
fn a_text_that_does_not_fit_is_dropped_as_a_whole() {
    let key = |number: i32| {
        let text: String = (0..32).map(|_| char::from(b'a' + number as u8)).collect();
        format!(
            "(action: Text(\"{text}\"), name: \"K{number}\", at_mm: ({}, 0))",
            number * 20
        )
    };
    let keys: Vec<String> = (0..10).map(key).collect();
    let mut rig = Rig::on_board(&format!("keys: [{}]", keys.join(", ")));
    let fingers = ["thumb", "index", "middle", "ring", "little"];
    let all = |position: &str| {
        let each = |(number, finger): (usize, &&str)| format!("{finger} K{number} {position}");
        let orders: Vec<String> = fingers.iter().enumerate().map(each).collect();
        orders.join(" & ")
    };
    rig.run(&format!("{}; {}", all("up"), all("down")));
    let written = rig.events().matches("write").count();
    assert_eq!(written % 32, 0, "{written}");
    assert_eq!(written, 5 * 32, "five texts fit into a step");
}

#[test]
fn a_layer_can_replace_a_text() {
    let controls = "keys: [(action: Text(\"é\"), name: \"T\", at_mm: (0, 0)), \
                    (layer: \"x\", name: \"L\", at_mm: (30, 0))]";
    let layers = "layers: [(name: \"x\", keys: {\"T\": \"A\"})]";
    assert_eq!(
        super::simulate_layout(
            controls,
            layers,
            "thumb L up; index T tap; thumb L down; wait 50; index T tap; thumb L up; wait 50; index T tap"
        ),
        "write:é dn:A up:A write:é"
    );
}

#[test]
fn a_text_can_fire_on_release() {
    let key = "keys: [(action: Text(\"é\"), name: \"T\", activate_on: Release, at_mm: (0, 0)), \
               (code: \"A\", at_mm: (40, 0))]";
    assert_events(key, "index T up; index T down; wait 50", "");
    assert_events(key, "index T tap", "write:é");
    assert_events(key, "index T up; index T down; index A down", "");
}
