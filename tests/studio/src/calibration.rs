//! The guided calibration of a person in a glove.

use std::fs;

use ademan::calibrate::{self, CalibrationPose, Procedure, ProcedureState};
use ademan::document::Document;
use ademan::files::Load;
use ademan::layout::{Glove, write_calibration};
use ademan::studio::texts::{self, Language, text};
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use std::time::Duration;

use crate::picture;
use crate::posing_hand::{Person, PosingHand};
use crate::window::{Opening, StudioWindow};

/// Readings between two looks of the person at the window: shorter than a pose is held.
const READINGS: usize = 80;

/// Size of the window, in points.
const SIZE: [f32; 2] = [1000.0, 800.0];

/// The countdown of the guided calibration.
const COUNTDOWN: Duration = Duration::from_secs(3);

fn shipped() -> Document {
    Document::shipped("unam-hc11").expect("a glove")
}

/// Opens the tab, for a person in the glove of a file.
fn open(person: &Person, path: &str) -> StudioWindow {
    let glove = Glove::load(path).expect("a glove");
    let hand = PosingHand::new(person, &glove);
    let mut opening = Opening {
        size: SIZE,
        ..Opening::default()
    };
    opening.setup.glove = Some(path.to_owned());
    let mut window = opening.open_with(Box::new(hand), |app| app);
    window.click(text("workspace-calibration"));
    window
}

/// Returns the words of the window for a pose.
fn words(pose: CalibrationPose) -> String {
    let (first, rest) = pose.instruction().split_at(1);
    format!("{}{rest}", first.to_uppercase())
}

/// Returns the pose that the window asks for.
fn wanted(window: &StudioWindow) -> Option<CalibrationPose> {
    let mut poses = CalibrationPose::ALL.iter().copied();
    poses.find(|pose| window.has(&words(*pose)))
}

/// Lets the person do what the window says for some readings. Returns the pose, or `None` at the end.
fn follow(window: &mut StudioWindow, person: &Person) -> Option<CalibrationPose> {
    let pose = wanted(window)?;
    let total = person.take(pose, READINGS);
    window.wait_for_readings(total);
    Some(pose)
}

/// Returns the file that `ademan calibrate` writes after the same readings.
fn file_of_command(person: &Person) -> String {
    let document = shipped();
    let map = Glove::parse(&document).expect("a glove").map;
    let mut procedure = Procedure::for_glove(&map, COUNTDOWN);
    let states = person.sent().into_iter();
    let mut states = states.map(|(time, channels)| procedure.push(time, &channels));
    states.find(|state| *state == ProcedureState::Finished);
    let observations = procedure.observations();
    let fit = calibrate::fit(observations, &map).expect("enough poses");
    let rest = calibrate::rest_pose(observations, &fit.map);
    write_calibration(&document, &fit.map, &rest).expect("a text")
}

#[test]
fn a_person_who_follows_the_window_gets_the_file_of_the_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.ron");
    fs::write(&path, shipped().text).expect("the file can be written");
    let person = Person::default();
    let mut window = open(&person, path.to_str().expect("a readable path"));
    window.click(text("calibration-start"));
    window.wait_for("a paused session", |model| {
        model.view.state.paused_by.is_some()
    });
    let mut is_drawn = false;
    while let Some(pose) = follow(&mut window, &person) {
        if !is_drawn && pose == CalibrationPose::Fist && window.has(text("calibration-holding")) {
            let panel = window.workspace();
            picture::compare(&mut window, "studio-calibration", panel);
            is_drawn = true;
        }
    }
    assert!(is_drawn, "a fist is held");
    let panel = window.workspace();
    picture::compare(&mut window, "studio-calibration-result", panel);

    window.click(text("calibration-use"));
    window.click(text("button-replace"));
    let saved = fs::read_to_string(&path).expect("the file can be read");
    assert_eq!(saved, file_of_command(&person));
    assert_ne!(saved, shipped().text);
    window.wait_for("a session that goes on", |model| {
        model.view.state.paused_by.is_none()
    });
}

#[test]
fn a_calibration_that_is_quit_changes_nothing_and_ends_its_pause() {
    let person = Person::default();
    let mut window = open(&person, "unam-hc11");
    window.click(text("calibration-start"));
    window.wait_for("a paused session", |model| {
        model.view.state.paused_by.is_some()
    });
    let first = follow(&mut window, &person);
    window.press_key(egui::Key::S);
    assert_ne!(wanted(&window), first, "skipped");
    window.press_key(egui::Key::R);
    assert_eq!(wanted(&window), first, "taken again");
    let keys = egui::Modifiers::CTRL | egui::Modifiers::COMMAND;
    window.harness.key_press_modifiers(keys, egui::Key::S);
    window.draw(3);
    assert_eq!(wanted(&window), first, "Ctrl-S skips nothing");
    window.press_key(egui::Key::Q);
    assert!(window.has(text("calibration-start")));
    window.wait_for("a session that goes on", |model| {
        model.view.state.paused_by.is_none()
    });
    window.click(text("workspace-hand"));
    assert!(!window.is_enabled(text("glove-undo")), "no change");
}

#[test]
fn a_session_that_was_paused_before_a_calibration_is_paused_after_it() {
    let person = Person::default();
    let mut window = open(&person, "unam-hc11");
    window.press_key(egui::Key::P);
    window.wait_for("a paused session", |model| {
        model.view.state.paused_by.is_some()
    });
    window.click(text("calibration-start"));
    assert!(follow(&mut window, &person).is_some());
    window.press_key(egui::Key::Q);
    assert!(window.has(text("calibration-start")));
    for _ in 0..3 {
        let total = person.take(CalibrationPose::Rest, READINGS);
        window.wait_for_readings(total);
    }
    assert!(window.model().view.state.paused_by.is_some());
}

#[test]
fn a_calibration_keeps_its_letters_from_the_window_only_in_its_tab() {
    let person = Person::default();
    let mut window = open(&person, "unam-hc11");
    window.click(text("calibration-start"));
    window.wait_for("a paused session", |model| {
        model.view.state.paused_by.is_some()
    });
    window.press_key(egui::Key::F1);
    assert!(window.has(text("keys-orbit")), "the list of keys");
    window.press_key(egui::Key::Escape);
    window.press_key(egui::Key::P);
    assert!(window.model().view.state.paused_by.is_some());
    window.click(text("workspace-lab"));
    window.press_key(egui::Key::P);
    window.wait_for("a session that goes on", |model| {
        model.view.state.paused_by.is_none()
    });
}

#[test]
fn the_picture_of_a_pose_has_its_name_in_the_language_of_the_window() {
    let person = Person::default();
    let mut window = open(&person, "unam-hc11");
    for language in [Language::Spanish, Language::English] {
        window.harness.state_mut().settings().language = Some(language);
        window.draw(3);
        assert_eq!(texts::language(), language);
        let name = text("pose-flat");
        let pictures = window
            .harness
            .query_all_by_role_and_label(Role::Image, name);
        assert_eq!(pictures.count(), 1, "{name}");
    }
}
