//! The layout editor on layouts with faults, and under quick input: nothing locks, nothing jumps, no tap is lost.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ademan::layout::Layout;
use ademan::studio::texts::{text, text_with};
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::editor::{EditedFile, canvas, drag, press};
use crate::picture;
use crate::window::{Opening, PICTURES, StudioWindow};

const TWO_KEYS: &str = "Layout(
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

/// Returns the point of the canvas at a position of the two keys, whose middle is at (20, 0).
fn at(window: &StudioWindow, x: f32, y: f32) -> egui::Pos2 {
    canvas(window).center() + egui::vec2(x - 20.0, -y) * SCALE
}

fn number(window: &StudioWindow, name: &str) -> f64 {
    let field = window.harness.get_by_role_and_label(Role::SpinButton, name);
    let number = field.accesskit_node().numeric_value();
    number.expect("a field with a number")
}

#[test]
fn an_overlap_locks_nothing_and_is_saved_on_request() {
    let file = EditedFile::new("two-keys.ron", TWO_KEYS);
    let mut window = file.open();
    let before = canvas(&window);
    let key = at(&window, 0.0, 0.0);
    drag(&mut window, key, egui::vec2(30.0 * SCALE, 0.0));
    assert!(window.has_words("overlaps the key `A` of line 7 by 7 mm"));
    assert_eq!(canvas(&window), before, "the board does not jump");
    picture::draw(&mut window, "editor-overlap");
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::S);
    assert_eq!(file.text(), TWO_KEYS, "it asks first");
    assert!(window.has(text("editor-cannot-run")));
    window.click(text("editor-save-anyway"));
    let overlapping = TWO_KEYS.replace("(0, 0)", "(30, 0)");
    assert_eq!(file.text(), overlapping);
    assert!(Layout::parse(&overlapping, "two-keys.ron").is_err());
    window.open_in_editor(file.0.to_str().expect("a readable path"));
    window.draw(5);
    assert!(window.has_words("overlaps the key"), "it opens again");
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::A);
    for name in ["editor-duplicate", "editor-delete"] {
        window.click(text(name));
    }
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::A);
    press(&mut window, egui::Modifiers::NONE, egui::Key::Escape);
    let middle = canvas(&window).center();
    // The board is zoomed to both keys: the right edge is of `B` alone.
    drag(
        &mut window,
        middle + egui::vec2(12.0 * SCALE, 0.0),
        egui::vec2(20.0 * SCALE, 0.0),
    );
    assert!(window.has(text("editor-no-problems")));
}

#[test]
fn problems_are_those_of_a_drag_while_it_lasts() {
    let file = EditedFile::new("live.ron", TWO_KEYS);
    let mut window = file.open();
    let key = at(&window, 0.0, 0.0);
    let move_to = |moved: &mut StudioWindow, x: f32| {
        let pos = key + egui::vec2(x * SCALE, 0.0);
        moved.harness.event(egui::Event::PointerMoved(pos));
        moved.draw(3);
    };
    move_to(&mut window, 0.0);
    window.harness.event(egui::Event::PointerButton {
        pos: key,
        button: egui::PointerButton::Primary,
        pressed: true,
        modifiers: egui::Modifiers::NONE,
    });
    window.draw(2);
    for (x, overlaps) in [(10.0, false), (30.0, true), (12.0, false), (30.0, true)] {
        move_to(&mut window, x);
        assert_eq!(window.has_words("overlaps the key"), overlaps, "{x} mm");
    }
    press(&mut window, egui::Modifiers::NONE, egui::Key::Escape);
    assert!(window.has(text("editor-no-problems")));
    assert_eq!(file.text(), TWO_KEYS);
}

#[test]
fn ten_quick_taps_are_ten_steps_of_the_grid() {
    let file = EditedFile::new("taps.ron", TWO_KEYS);
    let mut window = file.open();
    let key = at(&window, 0.0, 0.0);
    drag(&mut window, key, egui::Vec2::ZERO);
    for _ in 0..10 {
        for pressed in [true, false] {
            window.harness.input_mut().events.push(egui::Event::Key {
                key: egui::Key::ArrowUp,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: egui::Modifiers::NONE,
            });
        }
    }
    window.draw(3);
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::S);
    assert_eq!(file.text(), TWO_KEYS.replace("(0, 0)", "(0, 10)"));
}

#[test]
fn the_form_follows_a_drag_and_shows_what_differs() {
    let file = EditedFile::new("form.ron", TWO_KEYS);
    let mut window = file.open();
    let key = at(&window, 0.0, 0.0);
    let mut event = |event| {
        window.harness.event(event);
        window.draw(2);
    };
    event(egui::Event::PointerMoved(key));
    event(egui::Event::PointerButton {
        pos: key,
        button: egui::PointerButton::Primary,
        pressed: true,
        modifiers: egui::Modifiers::NONE,
    });
    for step in 1..=6_u8 {
        let way = egui::vec2(0.0, -f32::from(step) * 5.0 * SCALE);
        event(egui::Event::PointerMoved(key + way));
    }
    assert!(
        (number(&window, "Y") - 30.0).abs() < 0.01,
        "during the drag"
    );
    window.harness.event(egui::Event::PointerButton {
        pos: key - egui::vec2(0.0, 30.0 * SCALE),
        button: egui::PointerButton::Primary,
        pressed: false,
        modifiers: egui::Modifiers::NONE,
    });
    window.draw(3);
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::A);
    assert!(window.has_words(text("editor-mixed")));
    picture::draw(&mut window, "editor-several");
    window.set_number(Role::SpinButton, "Y", 12.0);
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::S);
    let level = TWO_KEYS
        .replace("(0, 0)", "(0, 12)")
        .replace("(40, 0)", "(40, 12)");
    assert_eq!(file.text(), level);
}

#[test]
fn new_copied_and_pasted_controls_go_to_free_room() {
    let file = EditedFile::new("free.ron", TWO_KEYS);
    let mut window = file.open();
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::A);
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::D);
    let pasted = "(keys: [(code: \"Z\", at_mm: (0, 0))], knobs: [(name: \"Knob\", at_mm: (500, 0), diameter_mm: 40)])";
    window.harness.event(egui::Event::Paste(pasted.to_owned()));
    window.draw(3);
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::K);
    assert!(window.has(text("editor-palette-hint")), "the palette");
    picture::draw(&mut window, "editor-palette");
    window.harness.event(egui::Event::Text("slider".to_owned()));
    window.draw(3);
    window.press_key(egui::Key::Enter);
    window.click(text("editor-fit"));
    picture::draw(&mut window, "editor-free");
    assert!(!window.has_words("overlaps"), "no room was free");
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::S);
    let layout = Layout::parse(&file.text(), "free.ron").expect("a valid layout");
    assert_eq!((layout.keys.len(), layout.controls.len()), (5, 2));
}

#[test]
fn a_file_with_an_overlap_opens_in_the_editor_of_another_layout() {
    let overlapping = TWO_KEYS.replace("(40, 0)", "(10, 0)");
    let file = EditedFile::new("faulty.ron", &overlapping);
    let mut window = Opening::on_layout("qwerty-flat").open();
    window.open_in_editor(file.0.to_str().expect("a readable path"));
    window.draw(3);
    assert!(window.has_words("overlaps the key"));
    assert_eq!(fs::read_to_string(&file.0).expect("the file"), overlapping);
}

#[test]
fn another_layout_is_opened_in_the_window_with_its_handles() {
    let file = EditedFile::new("first.ron", TWO_KEYS);
    let mut window = file.open();
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::O);
    assert!(window.has(text("editor-open-title")));
    window.enter(text("editor-open-name"), "media");
    picture::draw(&mut window, "editor-open");
    window.click("media");
    window.draw(3);
    assert!(!window.has(text("editor-open-title")));
    let canvas = window
        .harness
        .get_by_role_and_label(Role::Canvas, text("editor-canvas"));
    assert!(canvas.rect().width() > 100.0);
    picture::draw(&mut window, "editor-media");
    window.wait_for("the opened layout in the session", |model| {
        model.view.layout.text.contains("volume knob")
    });
    assert_eq!(file.text(), TWO_KEYS, "the first file is as it was");
}

#[test]
fn a_question_keeps_the_keys_of_the_window() {
    let file = EditedFile::new("first.ron", TWO_KEYS);
    let mut window = file.open();
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::O);
    let name = text("editor-open-name");
    let field = window.harness.get_by_role_and_label(Role::TextInput, name);
    assert!(field.is_focused(), "letters are a part of a name");
    window.press_key(egui::Key::F1);
    assert!(!window.has(text("keys-orbit")), "the list of keys");
    window.press_key(egui::Key::Escape);
    assert!(!window.has(text("editor-open-title")));
    window.press_key(egui::Key::F1);
    assert!(window.has(text("keys-orbit")));
}

#[test]
fn escape_closes_the_list_of_keys_and_leaves_what_is_selected() {
    let file = EditedFile::new("selected.ron", TWO_KEYS);
    let mut window = file.open();
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::A);
    window.press_key(egui::Key::F1);
    assert!(window.has(text("keys-orbit")));
    window.press_key(egui::Key::Escape);
    assert!(!window.has(text("keys-orbit")));
    assert!(window.is_enabled(text("editor-delete")), "it is selected");
    window.press_key(egui::Key::Escape);
    assert!(!window.is_enabled(text("editor-delete")));
}

#[test]
fn a_layout_whose_file_is_missing_is_opened_once_it_is_there() {
    let file = EditedFile::new("missing.ron", TWO_KEYS);
    let name = file.0.to_str().expect("a readable path");
    let mut window = Opening::on_layout(name).open();
    fs::remove_file(&file.0).expect("the file");
    window.click(text("workspace-layout"));
    assert!(window.has(text("editor-cannot-open")));
    fs::write(&file.0, TWO_KEYS).expect("a write");
    window.draw_until("the layout", |shown| shown.has(text("editor-save")));
    assert!(!window.has(text("editor-cannot-open")));
}

#[test]
fn a_file_that_was_opened_before_is_opened_again_or_leaves_the_list() {
    let file = EditedFile::new("first.ron", TWO_KEYS);
    let before = EditedFile::new("before.ron", TWO_KEYS);
    let mut window = file.open();
    let settings = window.harness.state_mut().settings();
    settings.recent_layouts.push(&before.0);
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::O);
    window.click("before.ron");
    assert!(!window.has(text("editor-open-title")));
    let path = before.0.to_str().expect("a readable path");
    assert!(window.has(path));
    fs::remove_file(&file.0).expect("the file");
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::O);
    window.click("first.ron");
    assert!(window.has(path), "it stays");
    let gone = file.0.to_str().expect("a readable path");
    let notice = text_with("layouts-missing", &[("file", gone.into())]);
    assert!(window.has_words(&notice));
    let recent = &window.harness.state_mut().settings().recent_layouts;
    assert_eq!(recent.iter().collect::<Vec<_>>(), [path]);
}

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

fn drop_file(window: &mut StudioWindow, path: &Path) {
    let file = Arc::new(DroppedPath(path.to_owned()));
    window.harness.input_mut().dropped_files.push(file);
    window.draw(1);
    window.harness.input_mut().dropped_files.clear();
    window.draw(3);
}

#[test]
fn a_file_that_is_dropped_is_opened_whatever_tab_is_shown() {
    let dropped = EditedFile::new("dropped.ron", TWO_KEYS);
    let name = dropped.0.to_str().expect("a readable path");
    // The first tab shows the hand.
    for tab in [None, Some("workspace-lab"), Some("workspace-calibration")] {
        let mut window = Opening::default().open();
        if let Some(tab_name) = tab {
            window.click(text(tab_name));
        }
        drop_file(&mut window, &dropped.0);
        assert!(window.has(name), "{tab:?}");
        assert!(window.has(text("editor-save")), "{tab:?}");
    }
}

#[test]
fn a_file_that_is_dropped_is_opened_in_place_of_one_that_is_missing() {
    let file = EditedFile::new("missing.ron", TWO_KEYS);
    let dropped = EditedFile::new("dropped.ron", TWO_KEYS);
    let name = file.0.to_str().expect("a readable path");
    let mut window = Opening::on_layout(name).open();
    fs::remove_file(&file.0).expect("the file");
    window.click(text("workspace-layout"));
    assert!(window.has(text("editor-cannot-open")));
    drop_file(&mut window, &dropped.0);
    assert!(window.has(dropped.0.to_str().expect("a readable path")));
}

#[test]
fn a_dropped_file_that_cannot_be_opened_stays_named_while_another_one_is_missing() {
    let file = EditedFile::new("missing.ron", TWO_KEYS);
    let name = file.0.to_str().expect("a readable path");
    let mut window = Opening::on_layout(name).open();
    fs::remove_file(&file.0).expect("the file");
    window.click(text("workspace-layout"));
    drop_file(&mut window, &file.0.with_file_name("absent.ron"));
    assert!(window.has(text("editor-cannot-open")));
    window.draw_until("another look at the first file", |shown| {
        shown.has_words("missing.ron")
    });
    assert!(window.has_words("absent.ron"));
}

/// Runs the command of the palette that these words find.
fn run_command(window: &mut StudioWindow, words: &str) {
    press(window, egui::Modifiers::COMMAND, egui::Key::K);
    window.harness.event(egui::Event::Text(words.to_owned()));
    window.draw(3);
    window.press_key(egui::Key::Enter);
}

#[test]
fn the_palette_has_the_commands_of_the_session() {
    let file = EditedFile::new("paused.ron", TWO_KEYS);
    let mut window = file.open();
    for (words, is_paused) in [("button-pause", true), ("button-resume", false)] {
        run_command(&mut window, text(words));
        window.wait_for(words, |model| {
            model.view.state.paused_by.is_some() == is_paused
        });
        window.draw(1);
    }
    assert_eq!(file.text(), TWO_KEYS);
}

#[test]
fn pictures_are_written_beside_the_layout_and_never_replaced() {
    let file = EditedFile::new("pictures.ron", TWO_KEYS);
    let mut window = file.open();
    run_command(&mut window, "SVG");
    assert!(window.has_words(text("editor-exported")));
    let svg = fs::read_to_string(file.0.with_extension("svg")).expect("a picture");
    assert!(svg.contains("<svg"), "{svg}");
    run_command(&mut window, "PDF");
    let page = fs::read(file.0.with_extension("pdf")).expect("a page");
    assert_eq!(Ok(page), (PICTURES.pdf)(&svg));
    run_command(&mut window, "PNG");
    let png = file.0.with_extension("png");
    let pixels = fs::read(&png).expect("a picture");
    assert_eq!(Ok(pixels), (PICTURES.png)(&svg));
    fs::write(&png, "another").expect("a write");
    run_command(&mut window, "PNG");
    assert!(window.has_words(text("editor-export-exists")));
    assert_eq!(fs::read(&png).expect("the picture"), b"another");
    for extension in ["svg", "png", "pdf"] {
        fs::remove_file(file.0.with_extension(extension)).expect("the picture");
    }
}
