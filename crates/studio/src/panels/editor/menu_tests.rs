//! Menus and the palette of the editor in a window without a display, and what is added where it is not seen.

use eframe::egui::accesskit::Role;
use eframe::egui::{self, Event, Key, Modifiers, PointerButton, Pos2, ViewportCommand, ViewportId};
use egui_kittest::kittest::Queryable;

use super::tests::{TWO_KEYS, Window};
use super::*;
use crate::editor::NewPart;
use crate::texts::text_with;
use ademan_runtime::layout_link::{LOCAL_PAGE, layout_in_link};

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

    /// Taps a key, within one frame.
    pub(super) fn tap(&mut self, key: Key) {
        for pressed in [true, false] {
            self.harness.input_mut().events.push(Event::Key {
                key,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: Modifiers::NONE,
            });
        }
        self.harness.run_steps(1);
    }

    /// Returns `true` if the last frame has asked the desktop for the clipboard.
    fn has_asked_for_clipboard(&self) -> bool {
        let output = &self.harness.output().viewport_output;
        let commands = output.get(&ViewportId::ROOT).map(|root| &root.commands);
        commands.is_some_and(|commands| commands.contains(&ViewportCommand::RequestPaste))
    }

    /// Runs the command that copies the link, and returns what is put into the clipboard.
    fn copy_link(&mut self) -> Option<String> {
        self.press(Modifiers::COMMAND, Key::K);
        self.write(text("editor-copy-link"));
        self.tap(Key::Enter);
        let commands = &self.harness.output().platform_output.commands;
        let copied = commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(copied) => Some(copied.clone()),
            _ => None,
        });
        self.harness.run_steps(1);
        copied
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

    /// Returns `true` if the palette has a command with these words.
    fn offers(&mut self, words: &str) -> bool {
        let others = self.harness.query_all_by_label(words).count();
        self.press(Modifiers::COMMAND, Key::K);
        self.write(words);
        let count = self.harness.query_all_by_label(words).count();
        self.press(Modifiers::NONE, Key::Escape);
        count > others
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
fn the_first_number_of_repetitions_has_the_focus_after_the_command() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    window.run(text("editor-repeat"));
    window.harness.run_steps(3);
    window.write("2");
    window.press(Modifiers::NONE, Key::Enter);
    window.click_button(text("editor-repeat-now"));
    assert_eq!(window.panel().selected.len(), 4);
}

#[test]
fn escape_on_a_button_beside_the_name_of_a_copy_cancels_the_copy() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    window.panel().ask_for_path();
    window.harness.run_steps(2);
    window.press(Modifiers::NONE, Key::Tab);
    assert!(window.panel().save_as.is_some());
    window.press(Modifiers::NONE, Key::Escape);
    assert!(window.panel().save_as.is_none());
    assert_eq!(window.panel().selected.len(), 2, "the selection stays");
}

#[test]
fn the_keys_of_the_palette_close_it_again() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::K);
    window.write("a");
    assert!(window.panel().palette.is_open());
    window.press(Modifiers::COMMAND, Key::K);
    assert!(!window.panel().palette.is_open());
}

#[test]
fn the_palette_tells_that_no_command_matches() {
    let mut window = Window::open();
    let words = text("editor-palette-none");
    for (query, expected) in [("a", 0), ("a xyzzy", 1)] {
        window.press(Modifiers::COMMAND, Key::K);
        window.write(query);
        let count = window.harness.query_all_by_label(words).count();
        assert_eq!(count, expected, "{query}");
        window.press(Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn the_palette_has_the_commands_that_can_be_used() {
    let mut window = Window::open();
    let board = text_with("editor-board", &[("number", 1.into())]);
    let on_selection = [
        "editor-copy",
        "editor-delete",
        "editor-align-left",
        "editor-repeat",
    ];
    for name in on_selection {
        assert!(!window.offers(text(name)), "{name}");
    }
    for name in ["editor-paste", "editor-snap", "view-side"] {
        assert!(window.offers(text(name)), "{name}");
    }
    assert!(window.offers(&board));
    assert!(!window.offers(text("editor-add-chord")));
    window.press(Modifiers::COMMAND, Key::A);
    for name in on_selection.into_iter().chain(["editor-add-chord"]) {
        assert!(window.offers(text(name)), "{name}");
    }
    let snaps = window.panel().snaps;
    window.run(text("editor-snap"));
    assert_eq!(window.panel().snaps, !snaps);
    window.run(text("editor-add-chord"));
    assert!(window.text().contains("chords"));
    window.press(Modifiers::COMMAND, Key::K);
    window.write(text("editor-paste"));
    window.tap(Key::Enter);
    assert!(window.has_asked_for_clipboard());
}

#[test]
fn the_palette_moves_what_is_selected_chooses_the_grid_and_binds_the_next_key() {
    let mut window = Window::open();
    let nudge = format!("{}: 0.1 mm", text("editor-nudge-left"));
    assert!(!window.offers(&nudge), "nothing is selected");
    window.click_board(0.0);
    window.run(&nudge);
    let moved = TWO_KEYS.replace("(0, 0)", "(-0.1, 0)");
    assert_eq!(window.text(), moved);
    window.run(&format!("{}: 2 mm", text("editor-grid")));
    window.run(&format!("{}: 2 mm", text("editor-nudge-up")));
    let moved = moved.replace("(-0.1, 0)", "(-0.1, 2)");
    assert_eq!(window.text(), moved);
    window.run(text("editor-press-key"));
    window.press(Modifiers::NONE, Key::C);
    assert_eq!(window.text(), moved.replace("\"A\"", "\"C\""));
}

#[test]
fn the_palette_pastes_what_comes_with_the_next_picture() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    let copied = window.panel().editor.copied().expect("controls");
    window.press(Modifiers::COMMAND, Key::K);
    window.write(text("editor-paste"));
    window.tap(Key::Enter);
    window.event(Event::Paste(copied));
    assert_eq!(window.panel().items.items.len(), 4);
}

#[test]
fn the_menu_of_the_free_canvas_pastes() {
    let mut window = Window::open();
    let free = window.at(20.0, 40.0);
    window.right_click(free);
    assert!(window.has_menu());
    let at = window.harness.get_by_label_contains(text("editor-paste"));
    let pos = at.rect().center();
    window.event(Event::PointerMoved(pos));
    window.button(pos, true);
    window.harness.event(Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed: false,
        modifiers: Modifiers::NONE,
    });
    window.harness.run_steps(1);
    assert!(window.has_asked_for_clipboard());
}

#[test]
fn the_link_has_the_layout_as_it_is_edited_and_a_faulty_layout_has_no_link() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    window.press(Modifiers::NONE, Key::ArrowRight);
    let edited = window.text();
    assert_ne!(edited, TWO_KEYS);
    let link = window.copy_link().expect("a link");
    assert!(link.starts_with(LOCAL_PAGE));
    assert_eq!(layout_in_link(&link), Ok(edited));
    assert_eq!(window.panel().message, Some(Ok(text("editor-link-copied"))));
    let faulty = TWO_KEYS.replace("\"B\"", "\"Bee\"");
    let mut faulty = Window::on_text(&faulty, 700.0);
    assert_eq!(faulty.copy_link(), None);
    let message = faulty.panel().message.clone();
    let Some(Err(reason)) = message else {
        panic!("{message:?}");
    };
    assert!(reason.contains("Bee"), "{reason}");
}

#[test]
fn what_is_pasted_is_shown() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    let copied = window.panel().editor.copied().expect("controls");
    // Free room near the middle of this part is outside it.
    let size = window.panel().canvas_size.expect("a picture");
    let bounds = Bounds::between(Vec2::new(-9.0, -9.0), Vec2::new(49.0, 9.0));
    let mut viewport = Viewport::fit(bounds, size);
    viewport.scale = size.x / 70.0;
    window.panel().viewport = AreaViewport::fixed(viewport);
    window.event(Event::Paste(copied));
    let panel = window.panel();
    let shapes = panel.selected.shapes(&panel.items.items);
    assert_eq!(shapes.len(), 2);
    let added = Bounds::around(shapes.iter().map(|(_, shape)| shape)).expect("keys");
    let seen = panel
        .viewport
        .update(None, size, panel.editor.revision(), false);
    let seen = seen.visible(size);
    assert!(seen.min.cmple(added.min).all() && seen.max.cmpge(added.max).all());
}

#[test]
fn a_cut_takes_controls_and_leaves_what_cannot_be_pasted() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.event(Event::Cut);
    let left = window.text();
    assert!(!left.contains("\"A\"") && left.contains("\"B\""), "{left}");
    window.panel().add(NewPart::Layer);
    assert_eq!(window.panel().editor.selection(), [Part::Layer(0)]);
    let layered = window.text();
    window.event(Event::Cut);
    assert_eq!(window.text(), layered);
    let message = window.panel().message.clone();
    assert_eq!(message, Some(Err(text("editor-not-copied").to_owned())));
}

#[test]
fn a_board_is_pasted_beside_the_others_and_in_the_place_from_which_it_was_cut() {
    let mut window = Window::open();
    window.panel().show_part(Part::Board(0));
    let copied = window.panel().editor.copied().expect("a board");
    window.event(Event::Paste(copied.clone()));
    let panel = window.panel();
    assert_eq!(panel.editor.count("boards"), 2);
    assert_eq!(panel.editor.selection(), [Part::Board(1)]);
    assert_eq!(panel.board, 1, "it is shown");
    let layout = panel.editor.layout().expect("a layout");
    assert!(layout.board_overlaps().is_empty());
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), TWO_KEYS, "one step");
    window.panel().show_part(Part::Board(0));
    window.event(Event::Cut);
    assert_eq!(window.panel().editor.count("boards"), 0);
    window.event(Event::Paste(copied));
    let pose = window.panel().editor.value(Part::Board(0), "pose");
    let expected = "(anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45)";
    assert_eq!(pose, Some(expected));
}

#[test]
fn the_first_control_beside_targets_in_space_is_shown_on_its_board() {
    let target = "(name: \"Moon\", at_mm: (120, 0, -300), shape: Ball(50))";
    let spaces = format!("spaces: [(pose: (anchor: elbow), targets: [{target}])]");
    let mut window = Window::on_text(&format!("Layout(name: \"a\", {spaces})"), 700.0);
    assert!(window.panel().plan.is_open);
    window.panel().add_control(ControlKind::Key);
    let panel = window.panel();
    assert_eq!(panel.message, None);
    assert!(!panel.plan.is_open);
    assert_eq!(panel.selected.single(), Some(0));
}

#[test]
fn targets_in_space_are_not_pasted_over_themselves() {
    let spaces = "    ],
    spaces: [(pose: (anchor: elbow), targets: [(name: \"Moon\", at_mm: (120, 0, -300), shape: Ball(50))])],
)
";
    let mut window = Window::on_text(&TWO_KEYS.replace("    ],\n)\n", spaces), 700.0);
    let moon = Part::SpaceTarget { space: 0, index: 0 };
    window.panel().show_part(moon);
    let copied = window.panel().editor.copied().expect("a target");
    window.event(Event::Paste(copied));
    let panel = window.panel();
    assert_eq!(panel.editor.count("spaces"), 2);
    assert_ne!(panel.editor.targets_in(1), panel.editor.targets_in(0));
}

#[test]
fn a_board_of_a_text_that_cannot_be_read_is_duplicated() {
    let faulty = TWO_KEYS.replace("pose: (", "travel_mm: 4000, pose: (");
    let mut window = Window::on_text(&faulty, 700.0);
    assert!(window.panel().editor.layout().is_none());
    window.panel().show_part(Part::Board(0));
    window.panel().duplicate();
    assert_eq!(window.panel().message, None);
    assert_eq!(window.panel().editor.count("boards"), 2);
}

#[test]
fn a_layout_that_another_studio_edits_is_opened_with_a_message() {
    let window = Window::open();
    let work = window.path.with_file_name("other-work");
    let open = || {
        let name = window.path.to_str().expect("a readable path");
        EditorPanel::open(name, Fit::default(), Some(&work)).expect("a layout")
    };
    let first = open();
    assert_eq!(first.message, None);
    let second = open();
    assert_eq!(second.message, Some(Ok(text("editor-open-elsewhere"))));
}

#[test]
fn a_board_is_called_by_its_name_everywhere() {
    let mut window = Window::open();
    assert!(!window.offers("Pad"));
    let rename = Edit::Rename {
        part: Part::Board(0),
        name: "Pad".into(),
    };
    window.panel().apply(&rename);
    assert!(window.offers("Pad"));
    assert!(window.harness.query_all_by_label("Pad").count() >= 1);
    let number = text_with("editor-board", &[("number", 1.into())]);
    assert_eq!(window.harness.query_all_by_label(&number).count(), 0);
}

#[test]
fn a_mixed_number_that_is_passed_through_changes_nothing() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    window.click_field(Role::SpinButton, "X");
    window.press(Modifiers::NONE, Key::Tab);
    window.press(Modifiers::NONE, Key::Tab);
    window.panel().commit_drafts();
    assert_eq!(window.text(), TWO_KEYS);
    window.click_field(Role::SpinButton, "Y");
    window.write("7");
    window.press(Modifiers::NONE, Key::Tab);
    assert_eq!(window.text().matches(", 7)").count(), 2);
}

#[test]
fn a_step_that_is_undone_is_shown_on_its_board() {
    let second = "        (
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, right_mm: 200, height_mm: -45),
            keys: [(code: \"C\", at_mm: (0, 0))],
        ),
    ],
)
";
    let both = TWO_KEYS.replace("    ],\n)\n", second);
    let mut window = Window::on_text(&both, 700.0);
    window.click_board(0.0);
    window.press(Modifiers::NONE, Key::ArrowUp);
    let moved = window.text();
    assert_ne!(moved, both);
    window.panel().leave_plan(1);
    window.harness.run_steps(2);
    assert!(window.panel().editor.selection().is_empty());
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), both);
    assert_eq!(window.panel().board, 0);
    assert_eq!(window.panel().selected.single(), Some(0));
    window.press(Modifiers::COMMAND, Key::Y);
    assert_eq!(window.text(), moved);
    window.panel().open_plan();
    window.press(Modifiers::COMMAND, Key::Z);
    // Delete would remove a key that is not seen.
    assert_eq!(window.panel().editor.selection(), [Part::Board(0)]);
}
