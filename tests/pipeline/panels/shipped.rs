//! Scripts on the shipped panels and boards.

use ademan::document::Document;

use crate::rig::Rig;

fn rig(name: &str) -> Rig {
    let document = Document::shipped(name).expect("a shipped layout");
    Rig::new(&document.text)
}

#[test]
fn the_shipped_touchpad_moves_clicks_scrolls_and_has_two_buttons() {
    let mut rig = rig("touch-pad");
    rig.run("index Pad 0 0 up; index Pad 0 0 1; index Pad 0 0 up");
    rig.run("index Pad 20 0 up; wait 400; index Pad 20 0 1; index Pad 30 0 1; index Pad 30 0 up; wait 400");
    rig.run(
        "index Pad 0 0 up & middle Pad 15 0 up; index Pad 0 0 1 & middle Pad 15 0 1; index Pad 0 \
             12 1 & middle Pad 15 12 1",
    );
    rig.run("index Pad 0 0 up & middle Pad 15 0 up; thumb MouseRight tap; thumb MouseLeft tap");
    let events = rig.events();
    let kinds: Vec<&str> = events.split(' ').map(|event| &event[..2]).collect();
    assert_eq!(
        kinds,
        ["dn", "up", "mo", "sc", "dn", "up", "dn", "up"],
        "{events}"
    );
    assert!(events.ends_with("dn:MouseRight up:MouseRight dn:MouseLeft up:MouseLeft"));
}
