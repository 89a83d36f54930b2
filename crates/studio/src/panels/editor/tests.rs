//! The editor in a window without a display: what is typed is neither lost nor given to another part.

use std::fs;
use std::path::PathBuf;

use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, ViewportEvent, ViewportId, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tempfile::TempDir;

use super::*;

pub(super) const TWO_KEYS: &str = "Layout(
    name: \"Two keys\",
    boards: [
        (
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
            keys: [
                (code: \"A\", at_mm: (0, 0)),
                (code: \"B\", at_mm: (40, 0)),
            ],
        ),
    ],
)
";

/// Points of the canvas per millimetre: the largest zoom at which a whole board is shown.
const SCALE: f32 = 5.0;

/// The editor on a file of its own.
pub(super) struct Window {
    pub harness: Harness<'static, EditorPanel>,
    pub path: PathBuf,
    #[allow(dead_code, reason = "keeps the folder")]
    folder: TempDir,
}

/// Draws the editor as the window does, without the picture of the board.
fn show(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    capture_key(ui, panel, true);
    guard_close(ui, panel);
    keep_unfinished(ui, panel);
    handle_keys(ui, panel, &mut RecentFiles::default());
    egui::Panel::top("bar").show(ui, |inner| {
        bar::show(inner, panel);
        outside::show(inner, panel);
    });
    egui::Panel::right("form")
        .default_size(320.0)
        .show(ui, |inner| form::show(inner, panel));
    egui::CentralPanel::default()
        .frame(egui::Frame::NONE)
        .show(ui, |inner| {
            panel.update_items();
            canvas::operate(inner, panel);
        });
}

impl Window {
    pub fn open() -> Self {
        Self::on_text(TWO_KEYS, 700.0)
    }

    /// Opens the editor on a text, in a window of a height that has room for the whole form.
    pub fn on_text(text: &str, height: f32) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two-keys.ron");
        fs::write(&path, text).unwrap();
        let work = folder.path().join("work");
        let name = path.to_str().unwrap();
        let panel = EditorPanel::open(name, Fit::default(), Some(&work)).unwrap();
        let builder = Harness::builder().with_size(vec2(1200.0, height));
        let mut harness = builder.build_ui_state(show, panel);
        harness.ctx.set_fonts(crate::fonts::fonts());
        harness.run_steps(3);
        Self {
            harness,
            path,
            folder,
        }
    }

    pub fn panel(&mut self) -> &mut EditorPanel {
        self.harness.state_mut()
    }

    /// Returns the folder with unsaved work.
    pub fn work(&self) -> PathBuf {
        self.folder.path().join("work")
    }

    pub fn text(&mut self) -> String {
        self.panel().editor.text().to_owned()
    }

    pub fn saved(&self) -> String {
        fs::read_to_string(&self.path).unwrap()
    }

    pub fn event(&mut self, event: Event) {
        self.harness.event(event);
        self.harness.run_steps(2);
    }

    pub fn button(&mut self, pos: Pos2, pressed: bool) {
        self.event(Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }

    pub fn click(&mut self, at: Pos2) {
        self.event(Event::PointerMoved(at));
        self.button(at, true);
        self.button(at, false);
    }

    pub fn click_field(&mut self, role: Role, name: &str) {
        let field = self.harness.get_by_role_and_label(role, name);
        let at = field.rect().center();
        self.click(at);
    }

    pub fn click_button(&mut self, name: &str) {
        let at = self.harness.get_by_label(name).rect().center();
        self.click(at);
    }

    /// Clicks on a point of the row of both keys, whose middle is in the middle of the canvas.
    pub fn click_board(&mut self, x: f32) {
        let at = self.at(x, 0.0);
        self.click(at);
    }

    pub fn at(&self, x: f32, y: f32) -> Pos2 {
        let canvas = self.harness.get_by_role(Role::Canvas).rect();
        canvas.center() + vec2(x - 20.0, -y) * SCALE
    }

    pub fn write(&mut self, words: &str) {
        self.event(Event::Text(words.to_owned()));
    }

    pub fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.harness.run_steps(2);
    }

    pub fn save(&mut self) {
        self.press(Modifiers::COMMAND, Key::S);
    }

    /// Asks the window to close, as the desktop does.
    pub fn close(&mut self) {
        for is_asked in [true, false] {
            let viewports = &mut self.harness.input_mut().viewports;
            let viewport = viewports.entry(ViewportId::ROOT).or_default();
            viewport.events.clear();
            viewport
                .events
                .extend(is_asked.then_some(ViewportEvent::Close));
            self.harness.run_steps(1);
        }
        self.harness.run_steps(1);
    }

    pub fn awaits_key(&self) -> bool {
        let mut found = self.harness.query_all_by_label(text("editor-pressing"));
        found.next().is_some()
    }

    pub fn field(&self, name: &str) -> Option<String> {
        let field = self.harness.get_by_role_and_label(Role::TextInput, name);
        field.value()
    }
}

#[test]
fn escape_in_a_number_discards_it_and_the_next_click_moves_nothing() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_field(Role::SpinButton, "X");
    window.write("-40");
    window.press(Modifiers::NONE, Key::Escape);
    assert_eq!(window.panel().preview, Preview::default());
    assert_eq!(window.panel().selected.single(), Some(0), "still selected");
    window.click_board(40.0);
    assert_eq!(window.panel().selected.single(), Some(1));
    assert_eq!(window.text(), TWO_KEYS);
    window.press(Modifiers::NONE, Key::Escape);
    assert_eq!(window.panel().selected.single(), None);
}

#[test]
fn escape_in_a_text_or_in_a_number_of_a_board_discards_it() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_field(Role::TextInput, "name");
    window.write("Foo");
    window.press(Modifiers::NONE, Key::Escape);
    window.click_field(Role::TextInput, "name");
    assert_eq!(window.field("name").as_deref(), Some(""));
    window.panel().show_part(Part::Board(0));
    window.harness.run_steps(3);
    let bearing = "pose · bearing";
    window.click_field(Role::SpinButton, bearing);
    window.write("90");
    window.press(Modifiers::NONE, Key::Escape);
    assert_eq!(window.panel().editor.selection(), [Part::Board(0)]);
    assert_eq!(window.text(), TWO_KEYS);
    window.click_field(Role::SpinButton, bearing);
    window.write("90");
    window.press(Modifiers::NONE, Key::Enter);
    let turned = TWO_KEYS.replace("bearing_deg: 35", "bearing_deg: 90");
    assert_eq!(window.text(), turned);
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), TWO_KEYS, "one step of undo");
}

#[test]
fn a_save_includes_the_value_that_is_being_typed() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_field(Role::TextInput, "name");
    window.write("Foo");
    assert!(window.panel().is_unsaved());
    window.save();
    let named = TWO_KEYS.replace("(0, 0))", "(0, 0), name: \"Foo\")");
    assert_eq!(window.saved(), named);
    assert!(!window.panel().is_unsaved());
    window.write("d");
    window.save();
    let named = named.replace("Foo", "Food");
    assert_eq!(window.saved(), named, "the field is still typed into");
    window.click_field(Role::SpinButton, "Y");
    window.write("30");
    window.save();
    let moved = named.replace("(0, 0)", "(0, 30)");
    assert_eq!(window.saved(), moved);
    window.press(Modifiers::COMMAND, Key::A);
    window.write("50");
    // Both events come with one frame, so that the button is drawn before the field loses the focus.
    let at = window.harness.get_by_label(text("editor-save"));
    let pos = at.rect().center();
    window.event(Event::PointerMoved(pos));
    for pressed in [true, false] {
        window
            .harness
            .input_mut()
            .events
            .push(Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            });
    }
    window.harness.run_steps(2);
    assert_eq!(window.saved(), moved.replace("(0, 30)", "(0, 50)"));
}

#[test]
fn a_window_with_a_typed_value_asks_before_it_closes() {
    let mut window = Window::open();
    window.close();
    assert!(!window.panel().is_close_asked);
    window.click_board(0.0);
    window.click_field(Role::SpinButton, "X");
    window.write("-40");
    window.close();
    assert!(window.panel().is_close_asked);
    assert_eq!(window.text(), TWO_KEYS.replace("(0, 0)", "(-40, 0)"));
}

#[test]
fn a_window_that_stays_open_asks_again() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.press(Modifiers::NONE, Key::ArrowUp);
    window.panel().permit_close();
    window.panel().stay_open();
    window.close();
    assert!(window.panel().is_close_asked);
}

#[test]
fn a_window_whose_file_was_deleted_asks_before_it_closes() {
    let mut window = Window::open();
    fs::remove_file(&window.path).unwrap();
    window.close();
    assert!(window.panel().is_close_asked);
    window.click_button(text("editor-close-save"));
    assert_eq!(window.saved(), TWO_KEYS);
}

#[test]
fn a_save_before_the_close_that_needs_a_name_shows_the_editor() {
    let new = LayoutEditor::empty(Fit::default());
    let mut edited = EditorPanel::of(new, None);
    edited.apply(&Edit::Add(crate::editor::NewPart::Layer));
    let show_question = |ui: &mut egui::Ui, (panel, is_shown): &mut (EditorPanel, bool)| {
        *is_shown |= guard_close(ui, panel);
    };
    let builder = Harness::builder().with_size(vec2(600.0, 400.0));
    let mut harness = builder.build_ui_state(show_question, (edited, false));
    for is_asked in [true, false] {
        let viewports = &mut harness.input_mut().viewports;
        let viewport = viewports.entry(ViewportId::ROOT).or_default();
        viewport.events.clear();
        let event = is_asked.then_some(ViewportEvent::Close);
        viewport.events.extend(event);
        harness.run_steps(2);
    }
    assert!(!harness.state().1, "the question is shown everywhere");
    harness.get_by_label(text("editor-close-save")).click();
    harness.run_steps(2);
    let (asked, is_shown) = harness.state();
    assert!(*is_shown && asked.save_as.is_some());
}

#[test]
fn a_value_belongs_to_the_part_for_which_it_was_typed() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_field(Role::TextInput, "name");
    window.write("Foo");
    window.click_board(40.0);
    let named = TWO_KEYS.replace("(0, 0))", "(0, 0), name: \"Foo\")");
    assert_eq!(window.text(), named);
    assert_eq!(window.panel().selected.single(), Some(1));
    window.click_field(Role::SpinButton, "Y");
    window.write("30");
    window.panel().show_part(Part::Layout);
    window.harness.run_steps(2);
    assert_eq!(window.text(), named.replace("(40, 0)", "(40, 30)"));
    assert_eq!(window.panel().editor.selection(), [Part::Layout]);
}

#[test]
fn keys_do_not_act_behind_a_question_and_escape_closes_it() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.press(Modifiers::NONE, Key::ArrowUp);
    let moved = window.text();
    window.close();
    window.press(Modifiers::COMMAND, Key::A);
    window.press(Modifiers::NONE, Key::Delete);
    assert_eq!(window.text(), moved);
    window.press(Modifiers::NONE, Key::Escape);
    assert!(!window.panel().is_close_asked);
    assert_eq!(window.panel().selected.single(), Some(0));
    for _ in 0..30 {
        window.press(Modifiers::NONE, Key::ArrowRight);
    }
    window.save();
    assert!(window.panel().save_question.is_some());
    window.press(Modifiers::NONE, Key::Delete);
    window.press(Modifiers::NONE, Key::Escape);
    assert!(window.panel().save_question.is_none());
    assert!(window.text().contains("(30, 1)"));
}

#[test]
fn a_key_is_awaited_for_the_selected_part_in_the_tab_of_the_editor_only() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_button(text("editor-press-key"));
    assert!(window.awaits_key());
    window.click_board(40.0);
    assert!(!window.awaits_key());
    window.press(Modifiers::NONE, Key::Z);
    assert_eq!(window.text(), TWO_KEYS);
    window.click_button(text("editor-press-key"));
    let context = window.harness.ctx.clone();
    let _ = context.run_ui(egui::RawInput::default(), |ui| {
        capture_key(ui, window.panel(), false);
    });
    window.press(Modifiers::NONE, Key::Z);
    assert_eq!(window.text(), TWO_KEYS);
    window.click_button(text("editor-press-key"));
    window.press(Modifiers::NONE, Key::Z);
    assert_eq!(window.text(), TWO_KEYS.replace("\"B\"", "\"Z\""));
}

#[test]
fn tab_goes_to_the_next_number_and_keeps_both() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_field(Role::SpinButton, "Y");
    window.write("-40");
    window.press(Modifiers::NONE, Key::Tab);
    window.write("30");
    window.press(Modifiers::NONE, Key::Tab);
    window.press(Modifiers::NONE, Key::Escape);
    let both = window.text();
    assert!(
        both.contains("(0, -40)") && both.contains("Box(30"),
        "{both}"
    );
    window.panel().undo();
    assert_eq!(window.text(), TWO_KEYS.replace("(0, 0)", "(0, -40)"));
}

#[test]
fn a_refused_text_stays_in_its_field_until_it_is_corrected_or_discarded() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_field(Role::TextInput, "name");
    window.write("B");
    window.press(Modifiers::NONE, Key::Enter);
    assert_eq!(window.text(), TWO_KEYS, "the name is taken");
    assert!(matches!(window.panel().message, Some(Err(_))));
    assert_eq!(window.field("name").as_deref(), Some("B"));
    assert!(window.panel().is_unsaved());
    window.click_field(Role::TextInput, "name");
    window.write("2");
    window.press(Modifiers::NONE, Key::Enter);
    let named = TWO_KEYS.replace("(0, 0))", "(0, 0), name: \"B2\")");
    assert_eq!(window.text(), named);
}

#[test]
fn a_window_with_a_refused_text_closes_after_a_save() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_field(Role::TextInput, "name");
    window.write("B");
    window.press(Modifiers::NONE, Key::Enter);
    assert!(window.panel().is_unsaved(), "the name is taken");
    window.close();
    assert!(window.panel().is_close_asked);
    window.click_button(text("editor-close-save"));
    window.close();
    assert!(!window.panel().is_close_asked);
}

#[test]
fn a_change_of_the_file_leaves_a_typed_value_with_its_key() {
    let mut window = Window::open();
    window.click_board(40.0);
    window.click_field(Role::TextInput, "name");
    window.write("Foo");
    let first = "keys: [";
    let more = format!("{first}\n                (code: \"C\", at_mm: (0, 40)),");
    fs::write(&window.path, TWO_KEYS.replace(first, &more)).unwrap();
    window.panel().next_poll = 0.0;
    window.harness.run_steps(3);
    window.press(Modifiers::NONE, Key::Enter);
    let text = window.text();
    let named = text.lines().find(|line| line.contains("Foo"));
    assert!(named.is_some_and(|line| line.contains("\"B\"")), "{text}");
    assert!(text.contains("\"C\""), "{text}");
}

#[test]
fn the_name_of_a_copy_is_typed_at_once_and_escape_cancels_it() {
    let mut window = Window::open();
    window.click_board(0.0);
    window.click_button(text("editor-save-as"));
    window.press(Modifiers::NONE, Key::Escape);
    assert!(window.panel().save_as.is_none());
    assert_eq!(window.panel().selected.single(), Some(0));
    window.click_button(text("editor-save-as"));
    window.press(Modifiers::COMMAND, Key::A);
    window.press(Modifiers::NONE, Key::Delete);
    assert_eq!(window.text(), TWO_KEYS);
    let folder = window.folder.path().to_str().unwrap().to_owned();
    for name in ["", &folder] {
        window.write(name);
        window.press(Modifiers::NONE, Key::Enter);
        assert!(window.panel().save_as.is_some());
        assert_eq!(window.panel().message, None, "{name}");
        window.click_field(Role::TextInput, text("editor-save-path"));
    }
    window.press(Modifiers::NONE, Key::End);
    window.write("/copy.ron");
    window.press(Modifiers::NONE, Key::Enter);
    assert!(window.panel().save_as.is_none());
    assert!(window.folder.path().join("copy.ron").exists());
}

#[test]
fn a_save_while_the_name_of_a_copy_is_written_keeps_the_name() {
    let mut window = Window::open();
    let new = LayoutEditor::empty(Fit::default());
    *window.panel() = EditorPanel::of(new, None);
    window.save();
    window.press(Modifiers::COMMAND, Key::A);
    window.write("copy");
    window.save();
    let field = window.field(text("editor-save-path"));
    assert_eq!(field.as_deref(), Some("copy"));
}
