//! A phone pad with a thumb arc, made from an empty file with mouse and keyboard, saved, and typed on.

use std::collections::BTreeSet;

use ademan::sim::HandTask;
use ademan::studio::simulated::simulate;
use ademan::studio::texts::text;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::editor::{EditedFile, canvas, press};
use crate::picture;
use crate::window::{Opening, StudioWindow};

/// Distance between two keys on the canvas, in points: 19 mm at the largest zoom at which a whole board is shown.
const PITCH: f32 = 95.0;

/// The keys of the pad, row by row.
const KEYS: [egui::Key; 12] = {
    use egui::Key::*;
    [
        Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9, Minus, Num0, Period,
    ]
};

/// A person with a mouse and a keyboard.
struct Person {
    window: StudioWindow,
}

impl Person {
    fn click_at(&mut self, at: egui::Pos2) {
        self.window.harness.event(egui::Event::PointerMoved(at));
        self.window.draw(2);
        for pressed in [true, false] {
            self.window.harness.event(egui::Event::PointerButton {
                pos: at,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            });
            self.window.draw(2);
        }
    }

    fn click(&mut self, name: &str) {
        let area = self.window.rect_of(name);
        self.click_at(area.center());
    }

    fn click_field(&mut self, role: Role, name: &str) {
        let area = self.window.harness.get_by_role_and_label(role, name).rect();
        self.click_at(area.center());
    }

    /// Writes a number into a field.
    fn fill(&mut self, name: &str, number: &str) {
        self.click_field(Role::SpinButton, name);
        self.write(number);
        self.key(egui::Key::Enter);
    }

    /// Chooses another value in the list that shows one.
    fn choose(&mut self, shown: &str, other: &str) {
        let list = self.window.harness.query_all_by_role(Role::ComboBox);
        let list: Vec<_> = list
            .filter(|it| it.value().as_deref() == Some(shown))
            .map(|it| it.rect())
            .collect();
        let area = list.last().expect("a list");
        self.click_at(area.center());
        self.click(other);
    }

    fn write(&mut self, words: &str) {
        let event = egui::Event::Text(words.to_owned());
        self.window.harness.event(event);
        self.window.draw(3);
    }

    fn key(&mut self, key: egui::Key) {
        self.window.press_key(key);
    }

    fn command(&mut self, key: egui::Key) {
        press(&mut self.window, egui::Modifiers::COMMAND, key);
    }

    /// Binds the key at a point of the canvas to a key of the keyboard.
    fn bind(&mut self, at: egui::Pos2, key: egui::Key) {
        self.click_at(at);
        self.click(text("editor-press-key"));
        self.key(key);
    }

    /// Repeats the selected key, and shows all.
    fn repeat(&mut self, columns: &str, rows: &str) {
        self.click(text("editor-repeat"));
        self.fill(text("editor-columns"), columns);
        self.fill(text("editor-rows"), rows);
        self.click(text("editor-repeat-now"));
        self.click(text("editor-fit"));
    }

    /// Adds a board with one key.
    fn add_board(&mut self) {
        self.click(text("editor-add"));
        self.click(text("editor-new-board"));
    }
}

const PAD: &str = "Layout(
    name: \"Phone pad\",
    boards: [
        (
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
            keys: [
                (code: \"1\", at_mm: (0, 0)),
                (code: \"2\", at_mm: (19, 0)),
                (code: \"3\", at_mm: (38, 0)),
                (code: \"4\", at_mm: (0, -19)),
                (code: \"5\", at_mm: (19, -19)),
                (code: \"6\", at_mm: (38, -19)),
                (code: \"7\", at_mm: (0, -38)),
                (code: \"8\", at_mm: (19, -38)),
                (code: \"9\", at_mm: (38, -38)),
                (code: \"Minus\", at_mm: (0, -57)),
                (code: \"0\", at_mm: (19, -57)),
                (code: \"Period\", at_mm: (38, -57)),
            ],
        ),
        (
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 190, height_mm: -45, right_mm: -10),
            keys: [
                (code: \"Space\", at_mm: (0, 0)),
                (code: \"Backspace\", at_mm: (19, 0)),
                (code: \"Enter\", at_mm: (38, 0)),
            ],
            shape: Arc(radius_mm: 90),
        ),
    ],
)
";

#[test]
fn a_phone_pad_with_a_thumb_arc_is_made_from_an_empty_file_and_types() {
    let file = EditedFile::new("phone-pad.ron", "");
    let path = file.0.to_str().expect("a readable path").to_owned();
    let mut person = Person {
        window: Opening::on_layout("arrows").open(),
    };
    person.click(text("workspace-layout"));
    person.command(egui::Key::O);
    person.click_field(Role::TextInput, text("editor-open-name"));
    person.write(&path);
    person.key(egui::Key::Enter);
    person.add_board();
    person.bind(canvas(&person.window).center(), egui::Key::Num1);
    person.repeat("3", "4");
    let middle = canvas(&person.window).center();
    for (index, key) in KEYS.into_iter().enumerate() {
        let [column, row] = [index % 3, index / 3].map(|it| it as f32);
        let place = egui::vec2(PITCH * (column - 1.0), PITCH * (row - 1.5));
        person.bind(middle + place, key);
    }
    person.add_board();
    person.click(text("editor-optional"));
    person.choose("Flat", "Arc");
    for (name, number) in [
        ("shape · radius", "90"),
        ("pose · right", "-10"),
        ("pose · forward", "190"),
    ] {
        person.fill(name, number);
    }
    person.bind(canvas(&person.window).center(), egui::Key::Space);
    person.repeat("3", "1");
    let middle = canvas(&person.window).center();
    person.bind(middle, egui::Key::Backspace);
    person.bind(middle + egui::vec2(PITCH, 0.0), egui::Key::Enter);
    picture::draw(&mut person.window, "editor-phone-pad");
    person.command(egui::Key::S);
    assert_eq!(file.text(), PAD);
    drop(person);
    types_on(&path);
}

/// Uses each control of a layout in a session of its own.
fn types_on(layout: &str) {
    let opening = Opening {
        speed: Some(4.0),
        ..Opening::on_layout(layout)
    };
    let setup = opening.setup.clone().load_files().expect("a setup");
    let tour = HandTask::Fitting(HandTask::tour);
    let (hand, control) = simulate(&setup, tour).expect("a hand");
    let mut window = opening.open_with(Box::new(hand), |app| app.with_hand(control));
    let expected = [
        "1",
        "2",
        "3",
        "4",
        "5",
        "6",
        "7",
        "8",
        "9",
        "Minus",
        "0",
        "Period",
        "Space",
        "Backspace",
        "Enter",
    ];
    window.wait_for("a press of each key", |model| {
        let presses = model.history.events().filter(|event| event.is_press);
        let pressed: BTreeSet<String> = presses.map(|event| event.key.to_string()).collect();
        expected.iter().all(|key| pressed.contains(*key))
    });
}
