//! The sensors: values of a channel that act at once, and the glove file.

use std::fs;
use std::path::PathBuf;

use ademan::document::Document;
use ademan::hand::Dof;
use ademan::setup::SmoothingSetup;
use ademan::studio::texts::text;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use tempfile::TempDir;

use crate::window::{Opening, StudioWindow};
use crate::{lab, picture};

/// Channel of the elbow in the glove that comes with the program, and its values there.
const ELBOW: usize = 17;
const ELBOW_VALUES: &str = "channel: 17, offset_counts: -31.0, full_scale_rad: 2.5,";
const FULL_RANGE_RAD: f64 = 2.5;

/// A window on a session with a glove file of its own.
pub struct OwnGlove {
    /// The window.
    pub window: StudioWindow,
    path: PathBuf,
    _folder: TempDir,
}

impl OwnGlove {
    fn open() -> Self {
        Self::with_text(&shipped())
    }

    fn with_text(glove: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("mine.ron");
        fs::write(&path, glove).expect("the file can be written");
        let mut opening = Opening::default();
        opening.setup.glove = Some(path.display().to_string());
        Self {
            window: opening.open(),
            path,
            _folder: folder,
        }
    }

    fn file(&self) -> String {
        fs::read_to_string(&self.path).expect("the file can be read")
    }
}

fn shipped() -> String {
    Document::shipped("unam-hc11").expect("a glove").text
}

/// Returns the angle of the elbow in the session and its count, after a reading more.
fn elbow(window: &mut StudioWindow) -> (f64, f64) {
    window.play(1);
    let model = window.model();
    let mut rows = model.sensors.rows().iter();
    let row = rows.find(|row| row.channel == ELBOW).expect("a channel");
    let count = row.count.expect("a value");
    let angle = model.angles.expect("angles").get(Dof::ElbowFlexion);
    (angle.to_degrees(), f64::from(count))
}

fn expected(count: f64, zero: f64, full_range: f64) -> f64 {
    ((count - zero) * full_range / 255.0).to_degrees()
}

/// Checks that the session has the angle of a calibration, but for the filter against spikes, and that the table shows it.
fn check_elbow(window: &mut StudioWindow, zero: f64, full_range: f64) {
    let (angle, count) = elbow(window);
    let wanted = expected(count, zero, full_range);
    assert!((angle - wanted).abs() < 0.5, "{angle} instead of {wanted}");
    let shown = window.words_beside(text("joint-elbow"));
    let wanted = [format!("{count}"), format!("{angle:.0}°")];
    assert!(wanted.iter().all(|it| shown.contains(it)), "{shown:?}");
}

#[test]
fn another_offset_and_gain_change_the_angle_at_once_and_are_saved_with_the_comments() {
    let mut own = OwnGlove::open();
    let window = &mut own.window;
    // The angle then depends on the present count alone.
    window.click(text("filter-off"));
    window.click(text("joint-elbow"));
    check_elbow(window, 31.0, FULL_RANGE_RAD);
    window.set_number(Role::SpinButton, text("value-offset"), 40.0);
    check_elbow(window, 40.0, FULL_RANGE_RAD);
    window.set_number(Role::SpinButton, text("value-gain"), 180.0);
    check_elbow(window, 40.0, std::f64::consts::PI);
    window.click(text("glove-undo"));
    check_elbow(window, 40.0, FULL_RANGE_RAD);
    window.click(text("glove-undo"));
    check_elbow(window, 31.0, FULL_RANGE_RAD);
    window.click(text("glove-redo"));
    check_elbow(window, 40.0, FULL_RANGE_RAD);
    assert_eq!(own.file(), shipped(), "nothing is saved yet");

    let window = &mut own.window;
    window.click(text("glove-save"));
    assert!(
        window.has(text("button-replace")),
        "the file is not its own"
    );
    window.click(text("button-replace"));
    assert!(!window.is_enabled(text("glove-save")));
    let saved = ELBOW_VALUES.replace("-31.0", "-40");
    assert_eq!(own.file(), shipped().replace(ELBOW_VALUES, &saved));
    let backup = fs::read_to_string(format!("{}.bak", own.path.display()));
    assert_eq!(backup.expect("a copy"), shipped());
}

#[test]
fn the_panel_is_as_reviewed() {
    let mut window = Opening {
        size: [1280.0, 1180.0],
        // The picture shows the latency of a hand that moves in real time.
        speed: Some(1.0),
        ..Opening::default()
    }
    .open();
    window.click(text("joint-elbow"));
    // The lag is measured again every 30 frames.
    window.draw(30);
    let panel = window.panel(text("panel-sensors"));
    // Rate and latency differ in each run.
    let source = window.harness.get_by_label(text("stats-rate")).rect();
    let channels = window.harness.get_by_label(text("sensor-channels")).rect();
    let figures = egui::Rect::from_x_y_ranges(panel.x_range(), source.min.y..=channels.min.y - 4.0);
    picture::compare_except(&mut window, "studio-sensors", panel, &[figures]);
}

#[test]
fn a_number_that_is_left_as_it_was_does_not_change_the_file() {
    let mut own = OwnGlove::open();
    let window = &mut own.window;
    window.click(text("joint-elbow"));
    for field in ["value-gain", "value-offset"] {
        let number = window
            .harness
            .get_by_role_and_label(Role::SpinButton, text(field));
        // A click makes a text of the number, with the digits that are shown: 2.5 rad are 143.239°.
        number.click();
        window.draw(3);
        window.press_key(egui::Key::Enter);
        assert!(!window.is_enabled(text("glove-save")), "{field}");
        assert!(!window.is_enabled(text("glove-undo")), "{field}");
    }
}

#[test]
fn a_number_of_the_glove_beyond_its_field_is_shown_without_a_change() {
    let wide = ELBOW_VALUES.replace("full_scale_rad: 2.5", "full_scale_rad: 60.0");
    let glove = shipped().replace(ELBOW_VALUES, &wide);
    assert_ne!(glove, shipped());
    let mut own = OwnGlove::with_text(&glove);
    let window = &mut own.window;
    window.click(text("joint-elbow"));
    window.draw(3);
    assert!(window.has(text("value-gain")), "the values are shown");
    assert!(!window.is_enabled(text("glove-save")));
    assert!(!window.is_enabled(text("glove-undo")));
}

#[test]
fn a_filter_of_the_setup_is_shown_without_a_change() {
    let mut opening = Opening::default();
    opening.setup.smoothing = SmoothingSetup::OneEuro {
        min_cutoff_hz: 60.0,
        beta: 100.0625,
        derivative_cutoff_hz: 4.0,
    };
    let mut window = opening.open();
    window.draw(3);
    let setting = "smoothing: OneEuro(min_cutoff_hz: 60, beta: 100.0625, derivative_cutoff_hz: 4)";
    assert!(window.has(setting));
}

/// Asks the window to close, as the desktop does. Returns `true` if it does.
fn closes(window: &mut StudioWindow) -> bool {
    let root = egui::ViewportId::ROOT;
    let viewports = &mut window.harness.input_mut().viewports;
    let asked = viewports.entry(root).or_default();
    asked.events.push(egui::ViewportEvent::Close);
    window.draw(1);
    let output = window.harness.output().viewport_output.get(&root);
    let cancel = egui::ViewportCommand::CancelClose;
    let is_cancelled = output.is_some_and(|it| it.commands.contains(&cancel));
    if let Some(root_viewport) = window.harness.input_mut().viewports.get_mut(&root) {
        root_viewport.events.clear();
    }
    window.draw(2);
    !is_cancelled
}

#[test]
fn a_window_with_a_calibration_that_is_not_saved_asks_before_it_closes() {
    let mut own = OwnGlove::open();
    let window = &mut own.window;
    assert!(closes(window));
    window.click(text("joint-elbow"));
    window.set_number(Role::SpinButton, text("value-offset"), 40.0);
    assert!(!closes(window));
    assert!(window.has(text("glove-close-question")));
    window.click(text("editor-close-cancel"));
    assert!(!window.has(text("glove-close-question")));
    assert!(!closes(window), "it asks again");
    window.click(text("editor-close-discard"));
    assert!(closes(window));
    assert_eq!(own.file(), shipped());
}

#[test]
fn the_question_about_the_file_is_shown_also_while_a_person_of_the_lab_is_watched() {
    let mut own = OwnGlove::open();
    let window = &mut own.window;
    window.click(text("joint-elbow"));
    window.set_number(Role::SpinButton, text("value-offset"), 40.0);
    lab::run(window, 2.0);
    let bar = lab::worst(window);
    window.click(&bar);
    let is_watched = |shown: &StudioWindow| shown.has(text("lab-watch-back"));
    window.draw_until("the person in the 3D view", is_watched);
    assert!(!closes(window));
    window.click(text("editor-close-save"));
    window.click(text("button-replace"));
    assert_ne!(own.file(), shipped());
}
