//! Menus and the palette of the editor in a window without a display, and what is added where it is not seen.

use eframe::egui::{self, Event, Key, Modifiers, PointerButton, Pos2};

use super::tests::{TWO_KEYS, Window};
use super::*;

impl Window {
    fn right_click(&mut self, pos: Pos2) {
        self.event(Event::PointerMoved(pos));
        for pressed in [true, false] {
            self.event(Event::PointerButton {
                pos,
                button: PointerButton::Secondary,
                pressed,
                modifiers: Modifiers::NONE,
            });
        }
    }

    fn has_menu(&self) -> bool {
        egui::Popup::is_any_open(&self.harness.ctx)
    }

    /// Runs the command that has these words.
    fn run(&mut self, words: &str) {
        self.press(Modifiers::COMMAND, Key::K);
        self.write(words);
        self.press(Modifiers::NONE, Key::Enter);
    }
}

#[test]
fn escape_closes_a_menu_and_keys_do_not_act_behind_it() {
    let mut window = Window::open();
    for is_context_menu in [true, false] {
        window.press(Modifiers::COMMAND, Key::A);
        if is_context_menu {
            let key = window.at(0.0, 0.0);
            window.right_click(key);
        } else {
            window.click_button(text("editor-add"));
        }
        assert!(window.has_menu());
        window.press(Modifiers::NONE, Key::Delete);
        assert_eq!(window.text(), TWO_KEYS);
        window.press(Modifiers::NONE, Key::Escape);
        assert!(!window.has_menu());
        assert_eq!(window.panel().selected.len(), 2);
        window.press(Modifiers::NONE, Key::Escape);
        assert_eq!(window.panel().selected.len(), 0);
    }
}

#[test]
fn the_command_that_repeats_asks_for_the_distances_that_suit_the_selection() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    window.run(text("editor-repeat"));
    assert!(window.has_menu());
    assert_eq!(window.text(), TWO_KEYS, "it asks first");
    // Two keys of 17 mm that are 40 mm apart, and the 2 mm between the keys of a row.
    assert_eq!(window.panel().repeat.pitch_mm, [59.0, -19.0]);
    window.click_button(text("editor-repeat-now"));
    assert!(window.panel().editor.is_valid());
    assert_eq!(window.panel().selected.len(), 6);
}

#[test]
fn a_layout_that_another_studio_edits_is_opened_with_a_message() {
    let window = Window::open();
    let work = window.path.with_file_name("work");
    let open = || {
        let name = window.path.to_str().expect("a readable path");
        EditorPanel::open(name, Fit::default(), Some(&work)).expect("a layout")
    };
    let first = open();
    assert_eq!(first.message, None);
    let second = open();
    assert_eq!(second.message, Some(Ok(text("editor-open-elsewhere"))));
}
