//! Taps of the simulated hand by name: each presses the key that it names and no other one, or is refused.

use crate::support::checked::CheckedPipeline;
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::contact::{Phase, TargetId};
use ademan::device::Events;
use ademan::document::shipped_layouts;
use ademan::files::Load;
use ademan::hand::{Finger, Side};
use ademan::layout::Layout;
use ademan::setup::{LoadedSetup, OtherHand, Setup};

fn load(name: &str) -> LoadedSetup {
    let layout = Layout::load(name).expect("the layout exists");
    let setup = Setup {
        layout: name.into(),
        other_hand: layout.uses_hand(Side::Left).then(OtherHand::default),
        ..Setup::default()
    };
    setup.load_files().expect("the layout is valid")
}

/// Returns the presses of a script, or the reason why it is refused.
fn presses(setup: &LoadedSetup, script: &str) -> Result<Vec<(Finger, TargetId)>, String> {
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.map_err(|error| error.to_string())?;
    let mut pipeline = CheckedPipeline::new(setup);
    let (mut presses, mut events) = (Vec::new(), Events::new());
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let step = pipeline.step(&reading, &mut events);
        let touches = &step.expect("an accepted reading").touches;
        let pressed = touches.iter().filter(|touch| touch.phase == Phase::Pressed);
        presses.extend(pressed.map(|touch| (touch.finger, touch.target)));
    }
    Ok(presses)
}

#[test]
fn a_tap_presses_the_key_that_it_names_and_no_other_one() {
    for name in shipped_layouts() {
        let setup = load(name);
        let mut refused = Vec::new();
        for key in &setup.layout.keys {
            let face = &key.face;
            match presses(&setup, &format!("tap \"{}\"", face.name.replace('"', ""))) {
                Ok(pressed) => {
                    let targets: Vec<TargetId> =
                        pressed.iter().map(|(_, target)| *target).collect();
                    assert_eq!(targets, [face.target], "{name}: {}", face.name);
                }
                Err(reason) => refused.push(format!("{}: {reason}", face.name)),
            }
        }
        println!(
            "{name}: {} of {} refused",
            refused.len(),
            setup.layout.keys.len()
        );
        for reason in &refused {
            println!("  {reason}");
        }
        assert!(
            refused.len() * 3 <= setup.layout.keys.len(),
            "{name}: {refused:?}"
        );
    }
}

#[test]
fn a_key_for_a_finger_is_tapped_with_that_finger() {
    let setup = load(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/scenarios/five-chords.ron"
    ));
    let fingers = ["T", "I", "M", "R", "L"].map(|key| {
        let pressed = presses(&setup, &format!("tap {key}")).expect("within reach");
        let target = setup.layout.key(key).expect("the key exists").face.target;
        assert_eq!(pressed.len(), 1, "{key}: {pressed:?}");
        assert_eq!(pressed[0].1, target, "{key}");
        pressed[0].0
    });
    assert_eq!(fingers, *Finger::ALL);
}

#[test]
fn space_on_an_arc_under_the_thumb_is_pressed_alone_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("thumb.ron");
    let text = r#"Layout(name: "Thumb", boards: [(
        pose: (anchor: wrist, bearing_deg: 35, forward_mm: 120, height_mm: -50),
        pitch_mm: 17, size_mm: Box(15, 15),
        keys: [
            (code: "Backspace", at_mm: (-37, -20)),
            (code: "Space", at_mm: (-20, -22)),
            (code: "Enter", at_mm: (-3, -28)),
        ],
    )])"#;
    std::fs::write(&path, text).unwrap();
    let setup = load(path.to_str().unwrap());
    for name in ["Backspace", "Space", "Enter"] {
        let target = setup.layout.key(name).expect("the key exists").face.target;
        match presses(&setup, &format!("tap {name}")) {
            Ok(pressed) => {
                assert_eq!(pressed.len(), 1, "{name}: {pressed:?}");
                assert_eq!(pressed[0].1, target, "{name}");
            }
            Err(reason) => assert!(name != "Space", "{reason}"),
        }
    }
}
