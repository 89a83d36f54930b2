//! The layout editor: a person moves a key, binds another, undoes and saves, and the program accepts the file.

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use ademan::files::Load;
use ademan::layout::Layout;
use ademan::studio::model::StudioModel;
use ademan::studio::texts::{text, text_with};
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use tempfile::TempDir;

use crate::picture;
use crate::window::{Opening, StudioWindow};

/// A file with a layout of its own in a folder of the test.
pub struct EditedFile(
    pub PathBuf,
    #[allow(dead_code, reason = "keeps the folder")] TempDir,
);

impl EditedFile {
    pub fn new(name: &str, content: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder for the test");
        let path = folder.path().join(name);
        fs::write(&path, content).expect("the file can be written");
        Self(path, folder)
    }

    pub fn open(&self) -> StudioWindow {
        let mut window = Opening::on_layout(self.0.to_str().expect("a readable path")).open();
        window.click(text("workspace-layout"));
        window.draw(3);
        window
    }

    pub fn text(&self) -> String {
        fs::read_to_string(&self.0).expect("the file can be read")
    }
}

/// Returns the middle of the canvas: the point that a layout with one key shows it at.
pub fn canvas(window: &StudioWindow) -> egui::Rect {
    window
        .harness
        .get_by_role(egui::accesskit::Role::Canvas)
        .rect()
}

pub fn drag(window: &mut StudioWindow, from: egui::Pos2, by: egui::Vec2) {
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    let mut event = |event| {
        window.harness.event(event);
        window.draw(2);
    };
    event(egui::Event::PointerMoved(from));
    event(button(from, true));
    for step in 1..=5_u8 {
        let at = from + by * (f32::from(step) / 5.0);
        event(egui::Event::PointerMoved(at));
    }
    event(button(from + by, false));
}

pub fn press(window: &mut StudioWindow, modifiers: egui::Modifiers, key: egui::Key) {
    window.harness.key_press_modifiers(modifiers, key);
    window.draw(3);
}

const ONE_KEY: &str = "// mine
Layout(
    name: \"One key\", // named
    boards: [
        (
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
            // a comment
            keys: [(code: \"A\", /* here */ at_mm: (0, 0))],
        ),
    ],
)
";

#[test]
fn a_key_is_moved_bound_undone_and_saved_with_its_comments() {
    let file = EditedFile::new("one-key.ron", ONE_KEY);
    let mut window = file.open();
    let center = canvas(&window).center();
    // The largest zoom of one key: 5 points per millimetre.
    drag(&mut window, center, egui::vec2(50.0, 0.0));
    press(&mut window, egui::Modifiers::NONE, egui::Key::ArrowUp);
    window.click(text("editor-press-key"));
    window.press_key(egui::Key::B);
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::S);
    let moved = ONE_KEY
        .replace("(0, 0)", "(10, 1)")
        .replace("\"A\"", "\"B\"");
    assert_eq!(file.text(), moved);
    Layout::load(file.0.to_str().unwrap()).expect("`ademan layout check` accepts the file");
    for _ in 0..3 {
        press(&mut window, egui::Modifiers::COMMAND, egui::Key::Z);
    }
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::S);
    assert_eq!(file.text(), ONE_KEY, "every edit is undone");
}

#[test]
fn an_edit_is_tried_in_the_session_before_it_is_saved() {
    let file = EditedFile::new("tried.ron", ONE_KEY);
    let mut window = file.open();
    let center = canvas(&window).center();
    drag(&mut window, center, egui::vec2(50.0, 0.0));
    let moved = ONE_KEY.replace("(0, 0)", "(10, 0)");
    let uses = |text: &str| {
        let text = text.to_owned();
        move |model: &StudioModel| model.view.layout.text == text
    };
    window.wait_for("the edit in the session", uses(&moved));
    assert_eq!(file.text(), ONE_KEY, "nothing is saved");
    window.toggle(text("editor-try"));
    window.wait_for("the saved text in the session", uses(ONE_KEY));
    window.toggle(text("editor-try"));
    window.wait_for("the edit in the session again", uses(&moved));
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::Z);
    window.wait_for("the undone edit in the session", uses(ONE_KEY));
}

#[test]
fn rulers_follow_the_pointer_on_board_and_plan_and_can_be_hidden() {
    let file = EditedFile::new("rulers.ron", ONE_KEY);
    let mut window = file.open();
    for plan in [false, true] {
        if plan {
            window.click(text("editor-plan"));
        }
        let area = canvas(&window);
        let top = egui::Rect::from_min_size(area.min, egui::vec2(area.width(), 18.0));
        let left = egui::Rect::from_min_size(
            area.min + egui::vec2(0.0, 18.0),
            egui::vec2(18.0, area.height() - 18.0),
        );
        let strips_with = |window: &mut StudioWindow, way: egui::Vec2| {
            window.harness.hover_at(area.center() + way);
            window.draw(2);
            let picture = picture::draw(window, &format!("editor-rulers-{plan}"))?;
            Some([top, left].map(|strip| picture::crop(&picture, strip)))
        };
        let Some(first) = strips_with(&mut window, egui::Vec2::ZERO) else {
            return;
        };
        let lower = strips_with(&mut window, egui::vec2(0.0, 60.0)).unwrap();
        assert!(first[0] == lower[0] && first[1] != lower[1], "plan {plan}");
        let right = strips_with(&mut window, egui::vec2(60.0, 60.0)).unwrap();
        assert!(lower[0] != right[0] && lower[1] == right[1], "plan {plan}");
        window.toggle(text("editor-rulers"));
        let hidden = strips_with(&mut window, egui::vec2(60.0, 60.0)).unwrap();
        assert!(
            hidden[0] != right[0] && hidden[1] != right[1],
            "plan {plan}"
        );
        window.toggle(text("editor-rulers"));
    }
}

#[test]
fn an_arc_is_unrolled_and_its_keys_are_shown() {
    let mut window = Opening::on_layout("qwerty-arc").open();
    window.click(text("workspace-layout"));
    window.draw(3);
    assert!(window.has(text("editor-no-problems")));
    let center = canvas(&window).center();
    drag(
        &mut window,
        center + egui::vec2(0.0, -10.0),
        egui::vec2(1.0, 0.0),
    );
    let panel = window.workspace();
    picture::compare(&mut window, "studio-editor", panel);
}

#[test]
fn ten_thousand_keys_are_drawn_and_dragged() {
    let keys = (0..10_000_u32).map(|index| {
        let (x, y) = (index % 100 * 2, index / 100 * 2);
        let code = char::from(b'A' + (index % 26) as u8);
        format!(
            "(code: \"{code}\", name: \"k{index}\", at_mm: ({x}, {y}), size_mm: Box(1.5, 1.5)),"
        )
    });
    let keys: String = keys.collect();
    let layout = ONE_KEY.replace("(code: \"A\", /* here */ at_mm: (0, 0))", &keys);
    let file = EditedFile::new("many.ron", &layout);
    let mut window = Opening::on_layout("qwerty-flat").open();
    let opened = Instant::now();
    window.open_in_editor(file.0.to_str().unwrap());
    window.click(text("workspace-layout"));
    println!("opened in {:?}", opened.elapsed());
    let started = Instant::now();
    window.draw(50);
    println!("50 pictures in {:?}", started.elapsed());
    let center = canvas(&window).center();
    let started = Instant::now();
    drag(&mut window, center, egui::vec2(40.0, 40.0));
    println!(
        "a drag of 14 pictures with its edit in {:?}",
        started.elapsed()
    );
    assert!(window.has(text("editor-undo")));
}

#[test]
fn a_sequence_is_added_renamed_extended_and_bound_in_the_form() {
    let file = EditedFile::new("sequence.ron", ONE_KEY);
    let mut window = file.open();
    window.click(&format!("{} (0)", text("editor-sequences")));
    let list = window.rect_of(&format!("{} (0)", text("editor-sequences")));
    let below = |node: &egui_kittest::Node| node.rect().min.y > list.max.y;
    {
        let mut adds = window.harness.get_all_by_label(text("editor-add"));
        adds.find(below).expect("the button of the list").click();
    }
    window.draw(3);
    let write = |window: &mut StudioWindow, field: &str, words: &str| {
        window
            .harness
            .get_by_role_and_label(Role::TextInput, field)
            .focus();
        window.draw(2);
        window.enter(field, words);
        press(window, egui::Modifiers::NONE, egui::Key::Enter);
    };
    write(&mut window, "name", "new line");
    write(&mut window, "Tap", "End");
    window.click(text("editor-add-step"));
    window.click(text("editor-step-earlier"));
    let center = canvas(&window).center();
    drag(&mut window, center, egui::Vec2::ZERO);
    window.enter(text("editor-search"), "new");
    window.click("Sequence new line");
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::S);
    let expected = ONE_KEY
        .replace("code: \"A\"", "action: Sequence(\"new line\")")
        .replace(
            "    ],\n)",
            "    ],\n    sequences: {\"new line\": [Tap(\"Enter\"), Tap(\"End\")]},\n)",
        );
    assert_eq!(file.text(), expected);
}

#[test]
fn an_empty_layout_is_opened_and_takes_a_first_board() {
    let mut window = Opening::on_layout("qwerty-flat").open();
    window.click(text("workspace-layout"));
    window.click(text("editor-open"));
    window.click(text("editor-open-empty"));
    assert!(!window.has(text("editor-open-title")));
    let has_board =
        |window: &StudioWindow| window.has(&text_with("editor-board", &[("number", 1.into())]));
    assert!(!has_board(&window));
    window.click(text("editor-add"));
    window
        .harness
        .get_by_role_and_label(Role::Button, text("editor-new-board"))
        .click();
    window.draw(3);
    assert!(has_board(&window));
}
