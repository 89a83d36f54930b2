//! Reach and capabilities of the shipped panels.

use ademan::files::Load;
use ademan::layout::Layout;
use ademan::setup::{ArmSetup, LoadedSetup, OtherHand, Setup};

use crate::rig::Rig;
use crate::support::wearer::{load_layout, shipped_setup};

#[test]
fn the_default_hand_reaches_everything_on_every_shipped_layout() {
    for (name, _) in Layout::shipped().unwrap() {
        let loaded = shipped_setup(name);
        let out_of_reach = loaded.out_of_reach();
        assert!(out_of_reach.is_empty(), "{name}: {out_of_reach:?}");
    }
}

#[test]
fn both_ends_of_a_track_have_to_be_within_reach() {
    let workshop = Layout::load("workshop").unwrap().text;
    let long = workshop.replacen("length_mm: 70", "length_mm: 300", 1);
    assert_ne!(long, workshop);
    let loaded = load_layout(&long, Setup::default());
    let out_of_reach = loaded.out_of_reach();
    let names: Vec<&str> = out_of_reach.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["Lift"]);
}

#[test]
fn the_capabilities_of_a_layout_include_those_of_all_controls() {
    let codes = |name| Layout::load(name).unwrap().required_capabilities().keys;
    for code in [
        "AudioVolumeUp",
        "AudioVolumeDown",
        "AudioVolumeMute",
        "ArrowLeft",
    ] {
        assert!(codes("media").contains(&code.parse().unwrap()), "{code}");
    }
    assert!(codes("game").contains(&"PadL3".parse().unwrap()));
}

#[test]
fn the_shipped_media_panel_changes_the_volume_and_seeks() {
    let media = Layout::load("media").unwrap().text;
    assert_eq!(
        Rig::new(&media)
            .run(
                "index Volume 15 0 up; index Volume 15 0 down; index Volume 14 -6 down; index Volume 14 \
             -6 up; index Seek up; index Seek down; index Seek -6 0 down"
            )
            .events(),
        "value:Volume=0.600 dn:AudioVolumeUp up:AudioVolumeUp dn:AudioVolumeUp up:AudioVolumeUp \
             value:Seek=0.445 dn:ArrowLeft up:ArrowLeft"
    );
}

#[test]
fn a_target_in_space_beyond_every_fingertip_is_out_of_reach() {
    let space = Layout::load("space").unwrap().text;
    let far = space.replacen("(120, 0, -300)", "(120, 0, -900)", 1);
    assert_ne!(far, space);
    let loaded = load_layout(&far, Setup::default());
    let out_of_reach = loaded.out_of_reach();
    assert_eq!(out_of_reach.len(), 1, "{out_of_reach:?}");
    let (name, metres) = out_of_reach[0];
    assert!(
        name == "Moon" && (0.5..0.7).contains(&metres),
        "{name} {metres}"
    );
}

/// Returns the text of the default layout with another field of the pose of its board.
fn layout_with(field: &str) -> String {
    let text = Layout::load("qwerty-flat").unwrap().text;
    text.replace("height_mm: -45", &format!("height_mm: -45, {field}"))
}

fn report(loaded: &LoadedSetup) -> Option<String> {
    let report = loaded.reach_report(&loaded.layout);
    report.map(|it| it.to_string())
}

#[test]
fn the_measured_hand_of_the_readme_does_not_reach_space_on_a_board_without_fit() {
    let setup = Setup {
        arm: ArmSetup::Measured {
            hand_length_mm: 189.0,
            forearm_length_mm: 262.0,
        },
        ..Setup::default()
    };
    let loaded = load_layout(&layout_with("fit: Off"), setup.clone());
    let out_of_reach = loaded.out_of_reach();
    assert!(
        out_of_reach.iter().any(|(name, _)| *name == "Space"),
        "{out_of_reach:?}"
    );
    let fitted = setup.load_files().unwrap();
    assert_eq!(report(&fitted), None);
}

#[test]
fn a_board_that_is_too_large_is_to_be_scaled() {
    let loaded = load_layout(&layout_with("scale: 1.5"), Setup::default());
    let found = report(&loaded).expect("keys out of reach");
    assert!(
        found.contains(" controls out of reach, nearest first: `"),
        "{found}"
    );
    assert!(found.contains("; try `ademan ctl scale 0."), "{found}");
}

#[test]
fn a_hand_without_a_glove_reaches_the_default_layout() {
    let setup = Setup {
        source: Some("file:angles?protocol=text-line".parse().unwrap()),
        ..Setup::default()
    };
    let loaded = setup.load_files().unwrap();
    assert!(loaded.glove.is_none());
    assert!(
        loaded.out_of_reach().is_empty(),
        "{:?}",
        loaded.out_of_reach()
    );
}

#[test]
fn a_glove_without_an_arm_reaches_what_the_arm_source_of_its_own_hand_reaches() {
    let of_other = |arm_source: Option<&str>| OtherHand {
        source: "udp:127.0.0.1:9001?protocol=lucidgloves".parse().ok(),
        arm_source: arm_source.map(|uri| uri.parse().unwrap()),
        ..OtherHand::default()
    };
    let camera = "udp:127.0.0.1:9002?protocol=body-landmarks";
    for (arm_source, is_reached) in [(Some(camera), true), (None, false)] {
        let setup = Setup {
            source: "udp:127.0.0.1:9000?protocol=hand-landmarks".parse().ok(),
            other_hand: Some(of_other(arm_source)),
            layout: "qwerty-two-flat".into(),
            ..Setup::default()
        };
        let loaded = setup.load_files().unwrap();
        let found = report(&loaded);
        assert_eq!(found.is_none(), is_reached, "{arm_source:?}: {found:?}");
    }
}
