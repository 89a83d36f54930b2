//! The window of the devices: source, glove, person, outputs and profile, each chosen while the session runs.

use std::fs;
use std::path::Path;

use ademan::capture::SourceUri;
use ademan::setup::{ProfileSetup, Setup};
use ademan::studio::settings::{HandSettings, Settings};
use ademan::studio::settings_file::SettingsFile;
use ademan::studio::texts::text;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::changing_window::ChangingWindow;

/// Opens the window of the devices beside the simulated hand.
fn open() -> (ChangingWindow, tempfile::TempDir) {
    open_on("numpad")
}

fn open_on(layout: &str) -> (ChangingWindow, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = ChangingWindow::open(layout, &folder.path().join("studio.ron"));
    window.harness.key_press(egui::Key::F9);
    window.draw();
    (window, folder)
}

/// Chooses a name in a list.
fn choose(window: &mut ChangingWindow, list: &str, name: &str) {
    let label = {
        let mut lists = window.harness.query_all_by_role(Role::ComboBox);
        let labels = lists
            .by_ref()
            .filter_map(|node| node.accesskit_node().label());
        let mut own = labels.filter(|label| label.starts_with(list));
        own.next().expect("a list")
    };
    window.click(&label);
    // The list is drawn above others, which may show the same name.
    let entry = window.harness.query_all_by_label(name).last();
    entry.expect("an entry").click();
    window.draw();
}

#[test]
fn another_source_is_used_at_once_and_the_simulated_hand_returns() {
    let (mut window, _folder) = open();
    window.picture("studio-devices");
    let source = window.app().model().view.state.source.clone();
    window.enter(text("devices-uri"), "typist:8462");
    assert_eq!(window.setup().source, "typist:8462".parse().ok());
    let typist = window.app().model().view.state.source.clone();
    assert!(typist.contains("typist"), "{typist}");
    window.click(text("first-simulated"));
    assert_eq!(window.setup().source, None);
    assert_eq!(window.app().model().view.state.source, source);
    window.wait_for("a press of the hand", |app| {
        app.model().history.events().any(|event| event.is_press)
    });
}

#[test]
fn a_source_or_file_that_cannot_be_used_leaves_the_session_and_says_why() {
    let (mut window, _folder) = open();
    let before = window.setup();
    window.wait_for("readings", |app| app.model().stats.accepted > 100);
    for (field, words, reason) in [
        ("devices-uri", "serail:/dev/ttyUSB0", "kind of source"),
        ("devices-glove", "no/such/glove.ron", "no/such/glove.ron"),
        ("devices-person", "no/such/person.ron", "no/such/person.ron"),
        ("devices-arm", "no/such/arm.ron", "no/such/arm.ron"),
        ("devices-output", "paper", "paper"),
        ("devices-setup", "no/such/setup.ron", "no/such/setup.ron"),
    ] {
        window.enter(text(field), words);
        assert!(window.has("×"), "{field}");
        assert!(window.has(reason), "{field}: {reason}");
        assert_eq!(window.setup(), before, "{field}");
    }
    window.picture("devices-error");
    let accepted = window.app().model().stats.accepted;
    window.wait_for("more readings", |app| app.model().stats.accepted > accepted);
}

#[test]
fn gloves_persons_and_outputs_are_chosen_from_lists() {
    let (mut window, _folder) = open();
    choose(&mut window, text("devices-glove"), "lucidgloves");
    choose(&mut window, text("devices-person"), "adult");
    assert_eq!(window.setup().glove.as_deref(), Some("lucidgloves"));
    assert_eq!(window.setup().person.as_deref(), Some("adult"));
    let glove = format!("{}: lucidgloves", text("devices-glove"));
    assert!(window.has(&glove), "the list shows the choice");
    choose(
        &mut window,
        text("devices-glove"),
        text("devices-glove-own"),
    );
    assert_eq!(window.setup().glove, None);
    window.click("transcript");
    assert_eq!(window.setup().output, "transcript");
    let state = window.app().model().view.state.clone();
    assert!(state.paused_by.is_none(), "nothing else receives it");
}

/// Writes settings with a person of the simulated hand.
fn save_person(path: &Path, person: Option<String>) {
    let hand = HandSettings {
        person,
        ..HandSettings::default()
    };
    let saved = Settings {
        hand,
        ..Settings::default()
    };
    let (mut file, ..) = SettingsFile::open(path.to_owned());
    file.save(&saved).expect("a write");
}

#[test]
fn a_person_of_the_settings_who_has_other_hands_stays_in_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = folder.path().join("studio.ron");
    save_person(&settings, Some("left-small".to_owned()));
    let mut window = ChangingWindow::open("numpad", &settings);
    assert!(window.has("types with the left hand"));
    assert_eq!(window.app().settings().hand.person, None);
    // Another session begins with the settings of the file.
    window.choose_layout("arrows");
    assert_eq!(window.setup().layout, "arrows");
    let (_, kept, _) = SettingsFile::open(settings);
    assert_eq!(kept.hand.person.as_deref(), Some("left-small"));
}

#[test]
fn a_person_of_the_settings_who_has_other_hands_can_be_dismissed() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = folder.path().join("studio.ron");
    save_person(&settings, Some("left-small".to_owned()));
    let mut window = ChangingWindow::open("numpad", &settings);
    // The tour of the window.
    window.harness.key_press(egui::Key::Escape);
    window.draw();
    window.click(text("menu-hand"));
    window.click(text("hand-person-own"));
    window.harness.key_press(egui::Key::Escape);
    window.draw();
    // Another session begins with the settings of the file.
    window.choose_layout("arrows");
    assert_eq!(window.setup().layout, "arrows");
    assert!(!window.has("types with the left hand"));
    let (_, kept, _) = SettingsFile::open(settings);
    assert_eq!(kept.hand.person, None);
}

#[test]
fn the_person_of_the_settings_returns_after_one_of_the_setup() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = folder.path().join("studio.ron");
    let slow = folder.path().join("slow.ron");
    fs::write(&slow, r#"Person(name: "slow", speed: 0.5)"#).expect("a write");
    let chosen = Some(slow.to_string_lossy().into_owned());
    save_person(&settings, chosen.clone());
    let mut window = ChangingWindow::open("numpad", &settings);
    window.harness.key_press(egui::Key::F9);
    window.draw();
    let person = |shown: &mut ChangingWindow| shown.app().settings().hand.person.clone();
    assert_eq!(person(&mut window), chosen);
    choose(&mut window, text("devices-person"), "adult");
    assert_eq!(person(&mut window), None);
    let none = text("devices-person-none");
    choose(&mut window, text("devices-person"), none);
    assert_eq!(window.setup().person, None);
    assert_eq!(person(&mut window), chosen);
}

#[test]
fn a_session_that_waits_for_a_permission_can_be_cancelled() {
    let (mut window, _folder) = open();
    let before = window.setup();
    window.is_held.set(true);
    choose(&mut window, text("devices-person"), "adult");
    assert!(window.has(text("devices-waiting")));
    assert_eq!(window.setup(), before);
    window.click(text("editor-cancel"));
    assert!(!window.has(text("devices-waiting")));
    assert_eq!(window.setup(), before);
    window.wait_for("readings", |app| app.model().stats.accepted > 100);
    choose(&mut window, text("devices-person"), "adult");
    assert!(window.has(text("devices-waiting")));
    window.harness.key_press(egui::Key::P);
    window.draw();
    assert!(window.has(text("devices-waiting")));
    window.is_held.set(false);
    window.draw();
    assert!(!window.has(text("devices-waiting")));
    assert_eq!(window.setup().person.as_deref(), Some("adult"));
    window.wait_for("a pause", |app| app.model().view.state.paused_by.is_some());
}

#[test]
fn escape_cancels_a_session_that_waits_and_leaves_the_devices_open() {
    let (mut window, _folder) = open();
    let before = window.setup();
    window.is_held.set(true);
    choose(&mut window, text("devices-person"), "adult");
    assert!(window.has(text("devices-waiting")));
    window.harness.key_press(egui::Key::Escape);
    window.draw();
    assert!(!window.has(text("devices-waiting")));
    assert_eq!(window.setup(), before);
    assert!(window.has(text("devices-words")));
}

#[test]
fn an_output_into_other_programs_waits_for_the_person() {
    let (mut window, _folder) = open_on("piano");
    window.enter(text("devices-output"), "osc:127.0.0.1:9");
    window.wait_for("a pause", |app| app.model().view.state.paused_by.is_some());
    assert!(window.has(text("devices-output-paused")));
    window.wait_for("readings", |app| app.model().stats.accepted > 2000);
    assert_eq!(window.app().model().history.events().count(), 0);
    window.click(text("button-resume"));
    window.wait_for("a session that goes on", |app| {
        app.model().view.state.paused_by.is_none()
    });
}

#[test]
fn a_profile_of_the_setup_is_chosen_by_its_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let profile = |name: &str, layout: &str| ProfileSetup {
        name: name.to_owned(),
        layout: layout.to_owned(),
        text: None,
    };
    let setup = Setup {
        layout: "arrows".to_owned(),
        output: "none".to_owned(),
        profiles: vec![profile("numbers", "numpad")],
        ..Setup::default()
    };
    let mut window = ChangingWindow::on_setup(setup, &folder.path().join("studio.ron"));
    window.click(text("menu-devices"));
    window.click("numbers");
    window.wait_for("the profile", |app| {
        app.model().view.state.profile == "numbers"
    });
    window.picture("devices-profiles");
}

#[test]
fn recordings_beside_one_that_was_played_are_chosen_like_ports() {
    let recordings = tempfile::tempdir().expect("a folder");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../recordings");
    for name in ["hc11.mcap", "hc11-hash.mcap"] {
        fs::copy(shipped.join(name), recordings.path().join(name)).expect("a copy");
    }
    let path = |name: &str| recordings.path().join(name);
    let (mut window, _folder) = open_on("qwerty-flat");
    assert!(!window.has("hc11-hash.mcap"));
    let first = path("hc11.mcap");
    window.enter(
        text("devices-recording"),
        first.to_str().expect("a readable path"),
    );
    let source = |path| Some(SourceUri::Recording { path });
    assert_eq!(window.setup().source, source(first.clone()));
    window.wait_for_words("hc11-hash.mcap");
    window.picture("devices-recordings");
    window.click("hc11-hash.mcap");
    assert_eq!(window.setup().source, source(path("hc11-hash.mcap")));
    let used = window.app().settings().recent_recordings.clone();
    let names: Vec<&str> = used.iter().collect();
    assert_eq!(names.len(), 2, "{names:?}");
    assert!(names[0].ends_with("hc11-hash.mcap"));
    fs::copy(path("hc11.mcap"), path("later.mcap")).expect("a copy");
    window.draw();
    assert!(!window.has("later.mcap"), "no folder is read for a picture");
    window.click(text("devices-search"));
    window.wait_for_words("later.mcap");
    window.click("later.mcap");
    assert_eq!(window.setup().source, source(path("later.mcap")));
}
