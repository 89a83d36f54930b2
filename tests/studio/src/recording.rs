//! A recording of the typist: forwards, backwards, a part of it, and compared with another layout.

use std::path::{Path, PathBuf};

use ademan::capture::Hc11Format;
use ademan::recorder::Recorder;
use ademan::session::{command_channel, replay};
use ademan::setup::Setup;
use ademan::studio::texts::{text, text_with};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use image::RgbaImage;
use tempfile::TempDir;

use crate::picture;
use crate::window::{Opening, StudioWindow};

/// A window on a recording.
struct Recorded {
    window: StudioWindow,
    folder: TempDir,
}

impl Recorded {
    fn open() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = record(folder.path(), "hola mundo");
        let window = Opening::default().open_recording(&path);
        Self { window, folder }
    }

    /// Returns the index of the reading that is shown.
    fn position(&self) -> usize {
        self.window.number(text("recording-position")) as usize
    }

    /// Moves the slider.
    fn go_to(&mut self, index: usize) {
        let name = text("recording-position");
        self.window.set_number(Role::Slider, name, index as f64);
        self.leave();
    }

    /// Takes the focus from the slider or button, so that keys move the position.
    fn leave(&mut self) {
        let context = &self.window.harness.ctx;
        context.memory_mut(|memory| {
            if let Some(id) = memory.focused() {
                memory.surrender_focus(id);
            }
        });
        self.window.draw(2);
    }

    fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.window.harness.key_press_modifiers(modifiers, key);
        self.window.draw(3);
    }

    /// Draws all panels but the bar of the recording.
    fn panels(&mut self) -> Option<[RgbaImage; 3]> {
        let areas = ["panel-space", "panel-sensors", "panel-scope"].map(|panel| {
            let area = self.window.panel(text(panel));
            area.shrink(6.0)
        });
        let picture = picture::draw(&mut self.window, "recording")?;
        Some(areas.map(|area| picture::crop(&picture, area)))
    }
}

/// Records the typist.
fn record(folder: &Path, words: &str) -> PathBuf {
    let path = folder.join("typist.mcap");
    let setup = Setup {
        output: "none".into(),
        ..Setup::default()
    };
    let setup = setup.load_files().expect("a setup");
    let typist = setup.typist(words, &Hc11Format::default(), 0.0, 0);
    let recorded = setup.recorded_setup();
    let mut recorder = Recorder::create(&path, &recorded).expect("a file");
    let mut observe = |step: &ademan::snapshot::StepView, _: &_, _: Option<_>| {
        recorder.write(&step.to_snapshot()).expect("a write");
    };
    let commands = command_channel().1;
    replay(&setup, typist.expect("a typist"), &commands, &mut observe).expect("a session");
    recorder.finish().expect("a write");
    path
}

#[test]
fn scrubbing_shows_what_playing_shows() {
    let mut recorded = Recorded::open();
    recorded.leave();
    assert_eq!(recorded.position(), 0);
    recorded.press(Modifiers::NONE, Key::Space);
    recorded.window.draw(8);
    recorded.press(Modifiers::NONE, Key::Space);
    let index = recorded.position();
    assert!(index > 10, "{index}");
    let Some(played) = recorded.panels() else {
        return;
    };
    recorded.press(Modifiers::NONE, Key::End);
    let last = recorded.position();
    assert!(last > index + 10, "{index} of {last}");
    assert!(recorded.panels() != Some(played.clone()), "another picture");

    recorded.go_to(index);
    assert_eq!(recorded.position(), index);
    assert!(
        recorded.panels() == Some(played.clone()),
        "back by the slider"
    );
    recorded.go_to(3);
    for _ in 0..5 {
        recorded.press(Modifiers::NONE, Key::ArrowRight);
    }
    recorded.press(Modifiers::NONE, Key::ArrowLeft);
    assert_eq!(recorded.position(), 7);
    recorded.press(Modifiers::SHIFT, Key::ArrowRight);
    assert!(recorded.position() > 7, "a second on");
    recorded.press(Modifiers::SHIFT, Key::ArrowLeft);
    // The readings before a time that lies between two of them.
    assert!((6..=7).contains(&recorded.position()), "a second back");
    recorded.go_to(index - 1);
    recorded.press(Modifiers::NONE, Key::ArrowRight);
    assert!(recorded.panels() == Some(played), "on by a key");
}

#[test]
fn a_question_keeps_its_keys_from_the_recording() {
    let mut recorded = Recorded::open();
    recorded.go_to(5);
    recorded.window.click(text("workspace-layout"));
    recorded.press(Modifiers::COMMAND, Key::O);
    assert!(recorded.window.has(text("editor-open-title")));
    recorded.leave();
    let context = recorded.window.harness.ctx.clone();
    assert_eq!(context.memory(|memory| memory.focused()), None);
    recorded.press(Modifiers::NONE, Key::ArrowRight);
    assert_eq!(recorded.position(), 5);
    recorded.press(Modifiers::NONE, Key::Escape);
    assert!(!recorded.window.has(text("editor-open-title")));
    recorded.press(Modifiers::NONE, Key::ArrowRight);
    assert_eq!(recorded.position(), 6);
}

#[test]
fn a_part_is_exported_and_can_be_opened() {
    let mut recorded = Recorded::open();
    for (index, mark) in [(20, "recording-from"), (59, "recording-to")] {
        recorded.go_to(index);
        recorded.window.click(text(mark));
    }
    let path = recorded.folder.path().join("part.mcap");
    let name = path.display().to_string();
    recorded.window.enter(text("recording-file"), &name);
    recorded.window.click(text("recording-export"));
    let is_written = |window: &StudioWindow| {
        let values = [("count", "40".into()), ("file", name.clone().into())];
        window.has(&text_with("recording-exported", &values))
    };
    recorded.window.draw_until("an export", is_written);
    let part = Opening::default().open_recording(&path);
    assert!(part.has_words("40"), "the part has 40 readings");

    recorded.window.click(text("recording-export"));
    let asks = |window: &StudioWindow| window.has(text("recording-replace-yes"));
    recorded.window.draw_until("a question", asks);
    recorded.window.click(text("recording-replace-no"));
    assert!(!recorded.window.has(text("recording-replace-yes")));
}

#[test]
fn two_layouts_are_compared() {
    let mut recorded = Recorded::open();
    recorded
        .window
        .enter(text("recording-compare"), "dvorak-flat");
    recorded.window.click(text("recording-compare-go"));
    let rows = text("recording-rows");
    let is_done = |window: &StudioWindow| window.has(rows);
    recorded.window.draw_until("a comparison", is_done);
    for (index, mark) in [(40, "recording-from"), (90, "recording-to")] {
        recorded.go_to(index);
        recorded.window.click(text(mark));
    }
    // The default folder is a temporary one.
    let name = "greeting-part.mcap";
    recorded.window.enter(text("recording-file"), name);
    recorded.leave();
    let first = recorded.window.rect_of(text("recording-first"));
    let rows = recorded.window.rect_of(rows);
    let width = recorded.window.harness.ctx.content_rect().x_range();
    let bar = egui::Rect::from_x_y_ranges(width, first.min.y - 6.0..=rows.max.y + 6.0);
    let window = &mut recorded.window;
    picture::compare(window, "studio-recording", bar);

    recorded.window.click_at(rows, 0.75);
    let middle = recorded.position();
    assert!(middle > 90, "a click goes to its time: {middle}");
}
