//! Reach and capabilities of the shipped panels.

use ademan::layout::Layout;
use ademan::setup::Setup;

use crate::rig::Rig;

#[test]
fn the_default_hand_reaches_everything_on_every_shipped_layout() {
    for (name, _) in Layout::shipped().unwrap() {
        let setup = Setup {
            layout: name.into(),
            ..Setup::default()
        };
        let loaded = setup.load_files().unwrap();
        let out_of_reach = loaded.out_of_reach();
        assert!(out_of_reach.is_empty(), "{name}: {out_of_reach:?}");
    }
}

#[test]
fn both_ends_of_a_track_have_to_be_within_reach() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.ron");
    let workshop = Layout::load("workshop").unwrap().text;
    let long = workshop.replacen("length_mm: 70", "length_mm: 300", 1);
    assert_ne!(long, workshop);
    std::fs::write(&path, long).unwrap();
    let setup = Setup {
        layout: path.to_str().unwrap().into(),
        ..Setup::default()
    };
    let loaded = setup.load_files().unwrap();
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
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.ron");
    let space = Layout::load("space").unwrap().text;
    let far = space.replacen("(120, 0, -300)", "(120, 0, -900)", 1);
    assert_ne!(far, space);
    std::fs::write(&path, far).unwrap();
    let setup = Setup {
        layout: path.to_str().unwrap().into(),
        ..Setup::default()
    };
    let loaded = setup.load_files().unwrap();
    let out_of_reach = loaded.out_of_reach();
    assert_eq!(out_of_reach.len(), 1, "{out_of_reach:?}");
    let (name, metres) = out_of_reach[0];
    assert!(
        name == "Moon" && (0.5..0.7).contains(&metres),
        "{name} {metres}"
    );
}
