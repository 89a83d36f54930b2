//! The simulated hand that is the source of a session: its menu, its tour, a pause, and an edit of its layout.

use std::path::Path;

use ademan::setup::Setup;
use ademan::sim::HandTask;
use ademan::studio::settings::HAND_NOISES;
use ademan::studio::simulated::simulate;
use ademan::studio::texts::text;
use egui::accesskit::Role;
use tempfile::TempDir;

use crate::picture;
use crate::window::{Opening, StudioWindow};

/// A layout of two keys, and one with other keys.
const TWO_KEYS: &str = r#"Layout(name: "Two keys", boards: [(
    pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
    rows: [(at_mm: (-19, 0), keys: "Y N")],
)])"#;

/// Opens the window on a layout of two keys in a folder, which the hand tours faster than in its own time.
fn open(folder: &Path) -> StudioWindow {
    let layout = folder.join("two-keys.ron");
    std::fs::write(&layout, TWO_KEYS).expect("a write");
    let opening = Opening {
        setup: Setup {
            layout: layout.to_string_lossy().into_owned(),
            output: "none".into(),
            ..Setup::default()
        },
        speed: Some(4.0),
        settings: Some(folder.join("studio.ron")),
        ..Opening::default()
    };
    let setup = opening.setup.clone().load_files().expect("a setup");
    let tour = HandTask::Fitting(HandTask::tour);
    let (hand, control) = simulate(&setup, tour).expect("a hand");
    let mut window = opening.open_with(Box::new(hand), |app| app.with_hand(control));
    // The tour of the window.
    window.press_key(egui::Key::Escape);
    window
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Returns the number of presses of a key in the last seconds.
fn presses(window: &StudioWindow, key: &str) -> usize {
    let events = window.model().history.events();
    let own = events.filter(|event| event.is_press && event.key.to_string() == key);
    own.count()
}

#[test]
fn the_tour_is_repeated_and_goes_on_with_an_edited_layout() {
    let folder = folder();
    let mut window = open(folder.path());
    window.draw_until("two tours", |window| {
        presses(window, "Y") > 1 && presses(window, "N") > 1
    });
    window.change_layout(&TWO_KEYS.replace("Y N", "Q W"));
    window.draw_until("a tour of the edited layout", |window| {
        presses(window, "Q") > 1 && presses(window, "W") > 1
    });
}

#[test]
fn a_pause_stays_although_the_hand_goes_on() {
    let folder = folder();
    let mut window = open(folder.path());
    window.draw_until("a press", |window| presses(window, "Y") > 0);
    window.click(text("button-pause"));
    window.wait_for("a pause", |model| model.view.state.paused_by.is_some());
    let before = window.model().stats.accepted;
    window.change_layout(&TWO_KEYS.replace("Y N", "Q W"));
    // Some tours.
    window.wait_for("readings", |model| model.stats.accepted > before + 1500);
    assert!(window.model().view.state.paused_by.is_some());
    assert_eq!(presses(&window, "Q"), 0);
    window.click(text("button-resume"));
    window.draw_until("a press", |window| presses(window, "Q") > 0);
}

#[test]
fn speed_noise_and_person_are_chosen_in_the_menu_and_kept() {
    let folder = folder();
    let person = folder.path().join("slow.ron");
    std::fs::write(&person, r#"Person(name: "slow", speed: 0.5)"#).expect("a write");
    let person = person.to_string_lossy().into_owned();
    let mut window = open(folder.path());
    window.click(text("menu-hand"));
    let first = window.rect_of(text("hand-speed"));
    let mut menu = first.union(window.rect_of(text("hand-person-open")));
    // The first word is above its slider.
    menu.min.y -= 18.0;
    picture::compare(&mut window, "studio-hand", menu.expand(6.0));
    window.set_number(Role::Slider, text("hand-speed"), 2.0);
    window.set_number(Role::Slider, text("hand-noise"), 1.5);
    window.enter(text("hand-person-file"), &person);
    window.click(text("hand-person-open"));
    assert!(window.has(&person), "the file is among the people");
    let hand = window.harness.state_mut().settings().hand.clone();
    assert_eq!((hand.speed, hand.noise), (2.0, 1.5));
    assert_eq!(hand.person.as_ref(), Some(&person));
    window.press_key(egui::Key::Escape);
    // The number of presses in the last seconds need not grow.
    let events = window.model().history.events();
    let last = events.map(|event| event.time).max();
    window.draw_until("two presses of another person", |window| {
        let later = window.model().history.events();
        let later = later.filter(|event| event.is_press && Some(event.time) > last);
        later.filter(|event| event.key.to_string() == "Y").count() > 1
    });
}

#[test]
fn a_person_who_has_other_hands_is_refused_with_the_reason() {
    let folder = folder();
    let mut window = open(folder.path());
    window.click(text("menu-hand"));
    window.click("adult");
    window.click("left-small");
    let hand = window.harness.state_mut().settings().hand.clone();
    assert_eq!(hand.person.as_deref(), Some("adult"));
    window.press_key(egui::Key::Escape);
    assert!(window.has_words("types with the left hand"));
    window.click(text("menu-hand"));
    window.enter(text("hand-person-file"), "no-such-person.ron");
    window.click(text("hand-person-open"));
    let hand = window.harness.state_mut().settings().hand.clone();
    assert_eq!(hand.person.as_deref(), Some("adult"));
    assert!(window.has_words("no-such-person.ron"));
}

#[test]
fn a_session_with_another_source_has_no_menu_of_the_hand() {
    let window = Opening::default().open();
    assert!(!window.has(text("menu-hand")));
}

#[test]
fn the_largest_noise_leaves_most_readings_usable() {
    let folder = folder();
    let mut window = open(folder.path());
    window.click(text("menu-hand"));
    let most = f64::from(HAND_NOISES.1);
    window.set_number(Role::Slider, text("hand-noise"), most);
    window.press_key(egui::Key::Escape);
    let counts = |window: &StudioWindow| {
        let stats = window.model().stats;
        (stats.source.readings, stats.accepted)
    };
    let (first, _) = counts(&window);
    window.wait_for("the noise", |model| {
        model.stats.source.readings > first + 500
    });
    let (received, accepted) = counts(&window);
    window.wait_for("readings", |model| {
        model.stats.source.readings > received + 2000
    });
    let (all, used) = counts(&window);
    let (all, used) = (all - received, used - accepted);
    assert!(2 * used > all, "{used} of {all}");
}

#[test]
fn a_simulated_hand_cannot_be_calibrated() {
    let folder = folder();
    let mut window = open(folder.path());
    window.click(text("workspace-calibration"));
    assert!(!window.is_enabled(text("calibration-start")));
    assert!(window.has(text("calibration-simulated")));
    window.click(text("calibration-demo"));
    assert!(!window.has(text("calibration-demo")), "it starts");
}
