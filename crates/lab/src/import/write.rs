//! Imported keys as the text of a layout.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::{Grid, ImportHands, Imported, ImportedKey, ImportedRow};
use crate::device::KeyCode;
use crate::document::quote;

/// The distance between keys, in millimetres.
const PITCH: f64 = 19.0;
/// The gap between keys, in millimetres.
const GAP: f64 = 2.0;
/// The shift of the physical rows, in keys: digits, and three rows of letters.
const STAGGER: [f64; 4] = [-0.5, 0.0, 0.25, 0.75];
/// The height of the row of digits, in keys.
const TOP: f64 = 2.0;
/// The letters of a row that the left hand types.
const LEFT: f64 = 5.0;
/// The width of a space bar, and of other keys for thumbs that are added, in millimetres.
const SPACE: f64 = 72.0;
const WIDE: f64 = 34.0;
const KEY: f64 = 17.0;
/// The inner end of the keys for thumbs, from the middle of the half, in millimetres.
const INNER: f64 = 59.0;
/// The most characters of a name.
const MAX_NAME: usize = 60;

/// A key on a board.
struct Placed {
    action: Action,
    at: [f64; 2],
    width: f64,
}

#[derive(Clone, PartialEq)]
enum Action {
    Code(String),
    Text(String),
}

/// A board that is written.
#[derive(Default)]
struct BoardText {
    keys: Vec<Placed>,
}

pub(super) fn write(grid: &Grid, hands: ImportHands) -> Imported {
    let mut notes = grid.notes.clone();
    let mut boards: Vec<BoardText> = match hands {
        ImportHands::Two => vec![BoardText::default(), BoardText::default()],
        ImportHands::One => vec![BoardText::default()],
    };
    for (index, row) in grid.rows.iter().take(STAGGER.len()).enumerate() {
        let stagger = if grid.is_ortho { 0.0 } else { STAGGER[index] };
        let y = (TOP - index as f64) * PITCH;
        for (place, key) in row.keys.iter().enumerate() {
            let Some(action) = action(key) else { continue };
            let column = place as f64 - row.leading as f64;
            let is_right = column >= LEFT;
            let (board, from) = match (hands, is_right) {
                (ImportHands::Two, false) => (0, 2.0),
                (ImportHands::Two, true) => (1, LEFT + 2.0),
                (ImportHands::One, _) => (0, LEFT - 0.5),
            };
            boards[board].keys.push(Placed {
                action,
                at: [(column - from + stagger) * PITCH, y],
                width: KEY,
            });
        }
    }
    let thumbs = thumb_keys(&grid.rows[4], &boards, hands, &mut notes);
    place_thumbs(thumbs, &mut boards, hands);
    let name = shortened(&grid.name);
    let mut text = format!(
        "// {}. Fingers are not imported: people choose them.\nLayout(\n    name: {},\n    description: {},\n    boards: [\n",
        one_line(&grid.origin),
        quote(&name),
        quote(&shortened(&grid.origin))
    );
    let mut names = BTreeSet::new();
    for (index, board) in boards.iter().enumerate() {
        let side = match (hands, index) {
            (ImportHands::One, _) => None,
            (_, 0) => Some("left"),
            _ => Some("right"),
        };
        text.push_str(&board.text(side, &mut names));
    }
    text.push_str("    ],\n)\n");
    Imported { name, text, notes }
}

/// Returns the keys of the left and the right thumb from left to right. Adds the keys that typing needs and that no board has.
fn thumb_keys(
    row: &ImportedRow,
    boards: &[BoardText],
    hands: ImportHands,
    notes: &mut Vec<String>,
) -> [Vec<Action>; 2] {
    let keys: Vec<Action> = row.keys.iter().filter_map(action).collect();
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for (index, key) in keys.iter().enumerate() {
        // The right hand has the innermost of an odd number.
        if index < keys.len() / 2 {
            left.push(key.clone())
        } else {
            right.push(key.clone())
        }
    }
    let code = |name: &str| Action::Code(name.to_owned());
    let space = code("Space");
    let on_boards = |name: &str| {
        let mut all = boards.iter().flat_map(|board| &board.keys);
        all.any(|key| key.action == code(name))
    };
    // Each hand has a space bar, as on a keyboard.
    let has_space = keys.contains(&space) || on_boards("Space");
    if hands == ImportHands::Two && !left.contains(&space) {
        left.push(space.clone());
    }
    if !right.contains(&space) && (hands == ImportHands::Two || !left.contains(&space)) {
        right.insert(0, space.clone());
    }
    let mut added: Vec<&str> = if has_space { Vec::new() } else { vec!["Space"] };
    for (name, is_left) in [("ShiftLeft", true), ("Backspace", false), ("Enter", false)] {
        let action = code(name);
        if keys.contains(&action) || on_boards(name) {
            continue;
        }
        added.push(name);
        if is_left {
            left.insert(0, action)
        } else {
            right.push(action)
        }
    }
    if !added.is_empty() {
        notes.push(format!("added below the letters: {}", added.join(", ")));
    }
    [left, right]
}

/// Places the keys of the left and the right thumb below the letters.
fn place_thumbs([left, right]: [Vec<Action>; 2], boards: &mut [BoardText], hands: ImportHands) {
    let width = |action: &Action| match action {
        Action::Code(name) if name == "Space" => SPACE,
        Action::Code(name) if ["ShiftLeft", "Backspace", "Enter"].contains(&name.as_str()) => WIDE,
        _ => KEY,
    };
    let y = -2.0 * PITCH;
    let inner = match hands {
        ImportHands::Two => INNER,
        ImportHands::One => -GAP / 2.0,
    };
    // From the innermost key outwards.
    let outwards: Vec<Action> = left.into_iter().rev().collect();
    let last = boards.len() - 1;
    for (board, direction, keys) in [(0, -1.0, outwards), (last, 1.0, right)] {
        let mut edge = -direction * inner;
        for action in keys {
            let width = width(&action);
            boards[board].keys.push(Placed {
                at: [edge + direction * width / 2.0, y],
                action,
                width,
            });
            edge += direction * (width + GAP);
        }
    }
}

fn action(key: &ImportedKey) -> Option<Action> {
    match key {
        ImportedKey::Empty => None,
        ImportedKey::Code(name) => Some(Action::Code((*name).to_owned())),
        ImportedKey::Text(text) => Some(Action::Text(text.clone())),
        ImportedKey::Character(character) => {
            let mut codes = KeyCode::for_us_character(*character);
            let plain = codes.find(|(_, is_shifted)| !is_shifted);
            Some(match plain {
                Some((code, _)) => Action::Code(code.name().to_owned()),
                None => Action::Text(character.to_string()),
            })
        }
    }
}

impl BoardText {
    fn text(&self, side: Option<&str>, names: &mut BTreeSet<String>) -> String {
        let (hand, bearing) = match side {
            None => (String::new(), 35),
            Some("left") => ("            hand: \"left\",\n".to_owned(), -35),
            Some(_) => ("            hand: \"right\",\n".to_owned(), 35),
        };
        let mut text = format!(
            "        (\n{hand}            pose: (anchor: elbow, bearing_deg: {bearing}, forward_mm: 300, height_mm: -45),\n            pitch_mm: {PITCH},\n            size_mm: Box({KEY}, {KEY}),\n"
        );
        let (mut runs, mut singles) = (String::new(), String::new());
        let mut run: Vec<&Placed> = Vec::new();
        for key in &self.keys {
            let is_new = matches!(&key.action, Action::Code(name) if names.insert(name.clone()));
            let is_next = run.last().is_some_and(|last| {
                last.at[1] == key.at[1] && (key.at[0] - last.at[0] - PITCH).abs() < 1e-6
            });
            let is_plain = is_new && key.width == KEY && !is_shift(&key.action);
            if !is_next || !is_plain {
                write_run(&mut run, &mut runs);
            }
            if is_plain {
                run.push(key)
            } else {
                singles.push_str(&single(key, is_new, names))
            }
        }
        write_run(&mut run, &mut runs);
        for (list, lines) in [("rows", runs), ("keys", singles)] {
            if !lines.is_empty() {
                let _ = write!(text, "            {list}: [\n{lines}            ],\n");
            }
        }
        text.push_str("        ),\n");
        text
    }
}

fn is_shift(action: &Action) -> bool {
    matches!(action, Action::Code(name) if name == "ShiftLeft")
}

fn write_run(run: &mut Vec<&Placed>, runs: &mut String) {
    let Some(first) = run.first() else { return };
    let codes = run.iter().map(|key| match &key.action {
        Action::Code(name) | Action::Text(name) => name.as_str(),
    });
    let codes: Vec<&str> = codes.collect();
    let [x, y] = first.at;
    let _ = writeln!(
        runs,
        "                (at_mm: ({x}, {y}), keys: {}),",
        quote(&codes.join(" "))
    );
    run.clear();
}

/// Returns a key of its own. A key whose name is taken gets another one.
fn single(key: &Placed, is_new: bool, names: &mut BTreeSet<String>) -> String {
    let (field, wanted) = match &key.action {
        Action::Code(name) => (format!("code: {}", quote(name)), name),
        Action::Text(text) => (format!("action: Text({})", quote(text)), text),
    };
    let name = if is_new {
        String::new()
    } else {
        let numbered = (2..).map(|number| format!("{wanted} {number}"));
        let mut free = std::iter::once(wanted.clone()).chain(numbered);
        let name = free.find(|name| !names.contains(name));
        let name = name.unwrap_or_default();
        names.insert(name.clone());
        if matches!(&key.action, Action::Text(text) if *text == name) {
            String::new()
        } else {
            format!(", name: {}", quote(&name))
        }
    };
    let latch = if is_shift(&key.action) {
        ", latch: OneShot"
    } else {
        ""
    };
    let size = if key.width == KEY {
        String::new()
    } else {
        format!(", size_mm: Box({}, {KEY})", key.width)
    };
    let [x, y] = key.at;
    format!("                ({field}{name}{latch}, at_mm: ({x}, {y}){size}),\n")
}

/// Returns a text without line breaks and control characters, cut to the length of a name.
fn shortened(text: &str) -> String {
    let text = one_line(text);
    if text.trim().is_empty() {
        "imported".to_owned()
    } else {
        text.trim().chars().take(MAX_NAME).collect()
    }
}

fn one_line(text: &str) -> String {
    text.chars()
        .map(|it| if it.is_control() { ' ' } else { it })
        .collect()
}
