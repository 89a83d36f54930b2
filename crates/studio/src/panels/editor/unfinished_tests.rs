//! Drags, taps and values that are typed, in a window without a display: one change each, and none is lost.

use std::fs;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, Pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use super::tests::{TWO_KEYS, Window};
use super::*;
use crate::canvas::gesture::moved;
use crate::canvas::snap::SnapSettings;
use ademan_runtime::files::create_private_folder;

/// Height of a window that shows the whole form of a key or board, in points.
const TALL: f32 = 1800.0;

/// A file that is dropped on the window.
#[derive(Debug)]
struct DroppedPath(PathBuf);

impl egui::DroppedFile for DroppedPath {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        fs::read(&self.0).map_err(|error| error.to_string())
    }
}

impl Window {
    /// Opens the options that have their defaults.
    fn show_defaults(&mut self) {
        self.click_button(text("editor-optional"));
        self.harness.run_steps(20);
    }

    fn number_at(&self, name: &str) -> Pos2 {
        let field = self.harness.get_by_role_and_label(Role::SpinButton, name);
        field.rect().center()
    }

    fn number(&self, name: &str) -> f64 {
        let field = self.harness.get_by_role_and_label(Role::SpinButton, name);
        let number = field.accesskit_node().numeric_value();
        number.expect("a number")
    }

    /// Presses the button of the mouse, and moves it to the right without a release.
    fn begin_drag(&mut self, from: Pos2, by: f32) {
        self.event(Event::PointerMoved(from));
        self.button(from, true);
        for step in 1..=6_u8 {
            let to = from + vec2(by * f32::from(step) / 6.0, 0.0);
            self.event(Event::PointerMoved(to));
        }
    }

    fn drag(&mut self, from: Pos2, by: f32) {
        self.begin_drag(from, by);
        self.button(from + vec2(by, 0.0), false);
        self.harness.run_steps(3);
    }

    /// Waits until the recovery file has these words, and returns what an editor offers after the end of this one.
    fn wait_for_work(&mut self, words: &str) -> String {
        let deadline = Instant::now() + Duration::from_secs(60);
        let copy = self.path.with_file_name("copied-work");
        create_private_folder(&copy).expect("a folder");
        loop {
            assert!(Instant::now() < deadline, "{words} is not kept");
            self.harness.run_steps(2);
            thread::sleep(Duration::from_millis(5));
            for entry in fs::read_dir(self.work()).expect("a folder") {
                let path = entry.expect("a file").path();
                let is_kept = path.extension().is_some_and(|it| it == "ron");
                if is_kept && fs::read_to_string(&path).is_ok_and(|it| it.contains(words)) {
                    let name = path.file_name().expect("a name");
                    fs::copy(&path, copy.join(name)).expect("a copy");
                    let own = self.path.to_str().expect("a readable path");
                    let next = EditorPanel::open(own, Fit::default(), Some(&copy));
                    let next = next.expect("a layout");
                    let work = next.editor.found_work().expect("unsaved work");
                    return work.text.clone();
                }
            }
        }
    }
}

#[test]
fn a_drag_of_a_number_that_is_not_written_changes_one_field_in_one_step() {
    for (part, name, field) in [
        (None, "travel", "travel_mm"),
        (Some(Part::Board(0)), "pose · right", "right_mm"),
    ] {
        let mut window = Window::on_text(TWO_KEYS, TALL);
        match part {
            None => window.click_board(0.0),
            Some(part) => window.panel().show_part(part),
        }
        window.harness.run_steps(3);
        window.show_defaults();
        let from = window.number_at(name);
        window.drag(from, 18.0);
        let dragged = window.text();
        let (before, rest) = dragged.split_once(field).expect(name);
        assert!(rest.starts_with(": "), "{dragged}");
        let end = rest.find([',', ')']).expect("an end");
        let without = format!("{}{}", before.trim_end_matches(", "), &rest[end..]);
        assert_eq!(without, TWO_KEYS, "{dragged}");
        window.press(Modifiers::COMMAND, Key::Z);
        assert_eq!(window.text(), TWO_KEYS);
    }
}

#[test]
fn a_field_that_a_part_must_have_is_not_emptied() {
    let triggers = "    ],\n    triggers: [(name: \"T\", when: Shake())],\n)\n";
    let before = TWO_KEYS.replace("    ],\n)\n", triggers);
    let mut window = Window::on_text(&before, TALL);
    window.panel().show_part(Part::Trigger(0));
    window.harness.run_steps(3);
    window.click_field(Role::TextInput, "when");
    window.press(Modifiers::COMMAND, Key::A);
    window.press(Modifiers::NONE, Key::Backspace);
    window.press(Modifiers::NONE, Key::Enter);
    assert_eq!(window.text(), before);
    assert!(matches!(window.panel().message, Some(Err(_))));
}

#[test]
fn a_field_that_a_part_must_have_has_no_button_that_removes_it() {
    // The anchor and the radius have none; bearing, distance, height and shape have one.
    let arc = TWO_KEYS.replace("-45),", "-45),\n            shape: Arc(radius_mm: 320),");
    for (layout, removable) in [(TWO_KEYS, 3), (&arc, 4)] {
        let mut window = Window::on_text(layout, TALL);
        window.panel().show_part(Part::Board(0));
        window.harness.run_steps(3);
        let removes = window
            .harness
            .query_all_by_label(text("editor-remove-field"));
        assert_eq!(removes.count(), removable, "{layout}");
    }
}

#[test]
fn a_number_that_is_not_written_is_shown_as_the_board_has_it() {
    let mut window = Window::on_text(TWO_KEYS, TALL);
    window.click_board(0.0);
    window.show_defaults();
    let defaults = ["travel", "press at", "debounce"].map(|name| window.number(name));
    assert_eq!(defaults, [4.0, 0.5, 40.0]);
    let from = window.number_at("travel");
    window.drag(from, 12.0);
    assert!(window.number("travel") > 4.0);
    let board = "pose: (";
    let deep = format!("travel_mm: 10, release_at: 0.3, reports_depth: true, {board}");
    let mut other = Window::on_text(&TWO_KEYS.replace(board, &deep), TALL);
    other.click_board(0.0);
    other.show_defaults();
    let of_board = ["travel", "release at"].map(|name| other.number(name));
    assert_eq!(of_board, [10.0, 0.3]);
    let depth = other
        .harness
        .get_by_role_and_label(Role::CheckBox, "reports depth");
    let is_on = depth.accesskit_node().toggled();
    assert_eq!(is_on, Some(eframe::egui::accesskit::Toggled::True));
}

#[test]
fn a_number_that_is_typed_in_place_of_words_is_written_also_if_it_is_the_first_one_of_them() {
    for (number, key) in [
        ("0.25", Key::Enter),
        ("0.4", Key::Enter),
        ("0.25", Key::Tab),
    ] {
        let mut window = Window::on_text(TWO_KEYS, TALL);
        window.click_board(0.0);
        window.show_defaults();
        window.click_field(Role::SpinButton, "release at");
        window.write(number);
        window.press(Modifiers::NONE, key);
        let written = format!("(0, 0), release_at: {number})");
        assert_eq!(window.text(), TWO_KEYS.replace("(0, 0))", &written));
    }
    let mut window = Window::on_text(TWO_KEYS, TALL);
    window.click_board(0.0);
    window.show_defaults();
    for is_typed in [false, true] {
        window.click_field(Role::SpinButton, "release at");
        if is_typed {
            window.write("0.25");
        }
        window.press(Modifiers::NONE, Key::Escape);
        assert_eq!(window.text(), TWO_KEYS);
        window.click_board(0.0);
    }
}

#[test]
fn a_change_of_the_file_during_a_drag_keeps_both() {
    let mut window = Window::open();
    let key = window.at(0.0, 0.0);
    window.begin_drag(key, -50.0);
    let other = |text: &str| text.replace("\"Two keys\"", "\"Other name\"");
    fs::write(&window.path, other(TWO_KEYS)).unwrap();
    for is_finished in [false, true] {
        window.panel().next_poll = 0.0;
        window.harness.run_steps(3);
        if !is_finished {
            assert_ne!(
                window.panel().preview,
                Preview::default(),
                "it is dragged on"
            );
            window.button(key - vec2(50.0, 0.0), false);
        }
    }
    let moved = TWO_KEYS.replace("(0, 0)", "(-10, 0)");
    assert_eq!(window.text(), other(&moved));
}

#[test]
fn what_is_typed_or_dragged_is_offered_after_the_end_of_the_program() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_field(Role::TextInput, "name");
    window.write("Foo");
    let named = TWO_KEYS.replace("(0, 0))", "(0, 0), name: \"Foo\")");
    assert_eq!(window.wait_for_work("Foo"), named);
    assert_eq!(window.text(), TWO_KEYS, "it is not entered yet");
    window.press(Modifiers::NONE, Key::Enter);
    let other = window.at(40.0, 0.0);
    window.begin_drag(other, 50.0);
    let dragged = named.replace("(40, 0)", "(50, 0)");
    assert_eq!(window.wait_for_work("(50, 0)"), dragged);
    assert_eq!(window.text(), named, "it is not dropped yet");
}

#[test]
fn a_file_that_is_dropped_is_opened_and_asks_before_unsaved_work_is_left() {
    let mut window = Window::open();
    let other = window.path.with_file_name("other.ron");
    fs::write(&other, TWO_KEYS.replace("Two keys", "Dropped")).unwrap();
    let drop_file = |dropping: &mut Window| {
        let file = Arc::new(DroppedPath(other.clone()));
        dropping.harness.input_mut().dropped_files.push(file);
        dropping.harness.run_steps(1);
        dropping.harness.input_mut().dropped_files.clear();
        dropping.harness.run_steps(2);
    };
    window.click_board(0.0);
    window.tap(Key::ArrowLeft);
    let moved = window.text();
    drop_file(&mut window);
    assert_eq!(window.text(), moved, "it asks");
    assert!(window.panel().open_question.is_some());
    window.press(Modifiers::NONE, Key::Escape);
    window.press(Modifiers::COMMAND, Key::Z);
    drop_file(&mut window);
    assert!(window.text().contains("Dropped"));
}

#[test]
fn undo_acts_while_a_field_has_the_focus_in_which_nothing_is_typed() {
    let mut window = Window::open();
    for count in [1, 2] {
        window.press(Modifiers::NONE, Key::Escape);
        window.click_board(0.0);
        if count == 2 {
            window.press(Modifiers::COMMAND, Key::A);
        }
        window.click_field(Role::SpinButton, "Y");
        window.write("-40");
        window.press(Modifiers::NONE, Key::Tab);
        assert_ne!(window.text(), TWO_KEYS);
        window.press(Modifiers::COMMAND, Key::Z);
        assert_eq!(window.text(), TWO_KEYS);
        window.press(Modifiers::NONE, Key::Enter);
        assert_eq!(window.text(), TWO_KEYS, "the field has the value of before");
    }
}

#[test]
fn taps_of_one_arrow_key_are_one_step() {
    let mut window = Window::open();
    window.click_board(0.0);
    for _ in 0..10 {
        window.tap(Key::ArrowLeft);
    }
    let left = TWO_KEYS.replace("(0, 0)", "(-10, 0)");
    assert_eq!(window.text(), left);
    for _ in 0..3 {
        window.tap(Key::ArrowUp);
    }
    window.click_board(40.0);
    window.tap(Key::ArrowUp);
    let up = TWO_KEYS.replace("(0, 0)", "(-10, 3)");
    assert_eq!(window.text(), up.replace("(40, 0)", "(40, 1)"));
    for expected in [up.as_str(), &left, TWO_KEYS] {
        window.press(Modifiers::COMMAND, Key::Z);
        assert_eq!(window.text(), expected);
    }
}

#[test]
fn the_first_control_of_an_empty_layout_comes_with_a_board() {
    for kind in [ControlKind::Key, ControlKind::Knob] {
        let mut window = Window::on_text("", 700.0);
        window.panel().add_control(kind);
        window.harness.run_steps(3);
        assert_eq!(window.panel().message, None);
        assert_eq!(window.panel().selected.single(), Some(0));
        assert!(window.panel().editor.is_valid(), "{}", window.text());
        window.press(Modifiers::COMMAND, Key::Z);
        assert_eq!(window.panel().editor.count("boards"), 0, "one step");
    }
}

#[test]
fn a_drag_whose_end_the_canvas_has_not_seen_changes_nothing() {
    let mut window = Window::open();
    window.click_board(0.0);
    let panel = window.panel();
    let way = Vec2::new(15.0, 0.0);
    panel.preview = moved(&panel.items.items, &panel.selected, way, SnapSettings::OFF);
    panel.gesture = Some(Gesture::Move { from: Vec2::ZERO });
    let free = window.at(20.0, 40.0);
    window.event(Event::PointerMoved(free));
    assert_eq!(window.text(), TWO_KEYS);
    assert!(!window.panel().is_dragging_on_canvas());
    assert_eq!(window.panel().preview, Preview::default());
}

#[test]
fn a_drag_on_a_board_ends_when_all_boards_are_shown() {
    let mut window = Window::open();
    let panel = window.panel();
    panel.dragged_radius = Some(100.0);
    panel.open_plan();
    assert!(!panel.is_dragging_on_canvas());
}

#[test]
fn an_undo_while_a_number_is_dragged_leaves_the_edit_before() {
    let mut window = Window::on_text(TWO_KEYS, TALL);
    window.click_board(0.0);
    window.press(Modifiers::NONE, Key::ArrowUp);
    let moved = window.text();
    assert_ne!(moved, TWO_KEYS);
    window.harness.run_steps(3);
    window.show_defaults();
    let from = window.number_at("travel");
    window.begin_drag(from, 30.0);
    assert!(window.text().contains("travel_mm"));
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), moved);
    let to = from + vec2(60.0, 0.0);
    window.event(Event::PointerMoved(to));
    window.button(to, false);
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), moved);
}

#[test]
fn a_touch_that_is_cancelled_moves_nothing() {
    let mut window = Window::open();
    let key = window.at(0.0, 0.0);
    window.begin_drag(key, 50.0);
    assert!(window.panel().is_dragging_on_canvas());
    window.event(Event::Touch {
        device_id: egui::TouchDeviceId(0),
        id: egui::TouchId(0),
        phase: egui::TouchPhase::Cancel,
        pos: key,
        force: None,
    });
    window.event(Event::PointerGone);
    assert!(!window.panel().is_dragging_on_canvas());
    window.button(key + vec2(50.0, 0.0), false);
    assert_eq!(window.text(), TWO_KEYS);
}
