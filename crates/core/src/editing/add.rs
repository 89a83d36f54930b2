//! New parts with default settings.

use super::bind::{Binding, free_code};
use super::draft::{Draft, written};
use super::error::EditError;
use super::fields::field_row;
use super::geometry::default_size;
use super::names::{name_of, taken, unique};
use super::part::{ControlKind, Part};
use crate::document::quote;

/// A part that is added.
#[derive(Clone, Debug, PartialEq)]
pub enum NewPart {
    /// A control on a board. A layout without boards gets one with it.
    Control {
        /// Index of the board.
        board: usize,
        /// Kind.
        kind: ControlKind,
        /// Center.
        at_mm: [f64; 2],
        /// Action of a key or toggle switch. A key without one gets a key code that the layout does not have.
        binding: Option<Binding>,
    },
    /// A row of keys.
    Row {
        /// Index of the board.
        board: usize,
        /// Center of the first key.
        at_mm: [f64; 2],
        /// Key codes, separated by blanks.
        keys: String,
    },
    /// A board with one key, at a distance to the right of the usual position of a board.
    Board {
        /// Distance.
        right_mm: f64,
    },
    /// A pinch of the index finger.
    Trigger,
    /// A pointer that follows the index fingertip in a box.
    Pointer,
    /// A space with one target.
    Space,
    /// A target in space: to the right, up, towards the wearer.
    SpaceTarget {
        /// Index of the space.
        space: usize,
        /// Center.
        at_mm: [f64; 3],
    },
    /// A layer without keys.
    Layer,
    /// A sequence of one step.
    Sequence,
    /// A chord.
    Chord {
        /// Names of the keys.
        keys: Vec<String>,
        /// Action.
        binding: Binding,
    },
}

/// Smallest distance between the centers of the options of a new radio group, in millimetres.
const OPTION_PITCH_MM: f64 = 19.0;

/// Smallest gap between the options of a new radio group, in millimetres.
const OPTION_GAP_MM: f64 = 1.0;

/// Distance of a new target in space from the one at its left, in millimetres.
const TARGET_DISTANCE_MM: f64 = 120.0;

/// Returns the position of a new target in space: to the right of all others.
pub fn beside(targets: &[[f64; 3]]) -> [f64; 3] {
    let last = targets.iter().max_by(|a, b| a[0].total_cmp(&b[0]));
    last.map_or([0.0; 3], |[x, y, z]| [x + TARGET_DISTANCE_MM, *y, *z])
}

/// Adds a part. Returns it.
pub(super) fn add(draft: &mut Draft, new: &NewPart) -> Result<Vec<Part>, EditError> {
    let mut names = taken(draft);
    let mut name = |name: &str| quote(&unique(&mut names, name));
    let (parent, list, text) = match new {
        NewPart::Control {
            board,
            kind,
            at_mm,
            binding,
        } => {
            let text = control(draft, (*board, *kind), *at_mm, binding.as_ref())?;
            (Part::Board(*board), kind.list(), text)
        }
        NewPart::Row { board, at_mm, keys } => {
            let text = format!("(at_mm: {}, keys: {})", point(at_mm), quote(keys));
            (Part::Board(*board), "rows", text)
        }
        NewPart::Board { right_mm } => {
            let key = key(&mut taken(draft), [0.0; 2], None)?;
            let text = board_with(*right_mm, ControlKind::Key, &key);
            (Part::Layout, "boards", text)
        }
        NewPart::Trigger => {
            let text = format!("(name: {}, when: Pinch(finger: \"index\"))", name("Pinch"));
            (Part::Layout, "triggers", text)
        }
        NewPart::Space => {
            let target = target(&name("Target"), &[0.0, 0.0, 0.0]);
            let pose = "(anchor: elbow, bearing_deg: 35, forward_mm: 300)";
            (
                Part::Layout,
                "spaces",
                format!("(\n    pose: {pose},\n    targets: [\n        {target},\n    ],\n)"),
            )
        }
        NewPart::SpaceTarget { space, at_mm } => {
            let text = target(&name("Target"), at_mm);
            (Part::Space(*space), "targets", text)
        }
        NewPart::Layer => {
            let layer = free_name(draft, "layers", Part::Layer, "layer");
            let text = format!("(name: {}, keys: {{}})", quote(&layer));
            (Part::Layout, "layers", text)
        }
        NewPart::Chord { keys, binding } => {
            let action = binding.to_ron();
            let text = format!("(keys: {}, action: {action})", quote(&keys.join(" ")));
            (Part::Layout, "chords", text)
        }
        NewPart::Sequence => return add_sequence(draft),
        NewPart::Pointer => return add_pointer(draft),
    };
    let index = draft.count(parent, list);
    match new {
        NewPart::Control { board: 0, kind, .. } if draft.count(Part::Layout, "boards") == 0 => {
            draft.push(Part::Layout, "boards", &[board_with(0.0, *kind, &text)])?;
        }
        _ => draft.push(parent, list, &[text])?,
    }
    draft.commit()?;
    Ok(vec![added(new, index)])
}

/// Returns a board with one control, at a distance to the right of the usual position of a board.
fn board_with(right_mm: f64, kind: ControlKind, control: &str) -> String {
    let (pose, list) = (board_pose(right_mm), kind.list());
    format!("(\n    pose: {pose},\n    {list}: [\n        {control},\n    ],\n)")
}

fn board_pose(right_mm: f64) -> String {
    let right = if right_mm == 0.0 {
        String::new()
    } else {
        format!(", right_mm: {}", written(right_mm))
    };
    format!("(anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45{right})")
}

/// Adds a board without controls to a layout that has no board.
pub(super) fn add_first_board(draft: &mut Draft) -> Result<(), EditError> {
    if draft.count(Part::Layout, "boards") > 0 {
        return Ok(());
    }
    let board = format!("(\n    pose: {},\n)", board_pose(0.0));
    draft.push(Part::Layout, "boards", &[board])?;
    draft.commit()
}

/// Returns a name that no part of a list has.
fn free_name(draft: &Draft, list: &str, part: fn(usize) -> Part, name: &str) -> String {
    let names = (0..draft.count(Part::Layout, list))
        .filter_map(|index| name_of(draft.text(), draft.tree(), part(index)));
    unique(&mut names.collect(), name)
}

fn add_sequence(draft: &mut Draft) -> Result<Vec<Part>, EditError> {
    let name = free_name(draft, "sequences", Part::Sequence, "sequence");
    let entry = format!("{}: [Tap(\"Enter\")]", quote(&name));
    let map = draft.field(Part::Layout, "sequences").cloned();
    match &map {
        Some(map) => draft.push_entry(map, &entry),
        None => draft.set(Part::Layout, "sequences", &format!("{{{entry}}}"))?,
    }
    draft.commit()?;
    let index = map.map_or(0, |map| map.items().len());
    Ok(vec![Part::Sequence(index)])
}

fn add_pointer(draft: &mut Draft) -> Result<Vec<Part>, EditError> {
    if draft.field(Part::Layout, "pointer").is_some() {
        let message = "the layout has a pointer, and there can be only one; edit that one";
        return Err(EditError::Selection(message));
    }
    draft.set(Part::Layout, "pointer", "(mode: Direct(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 330), size_mm: (200, 120, 160)))")?;
    draft.commit()?;
    Ok(vec![Part::Pointer])
}

/// Returns the part at an index of the list that it was added to.
fn added(new: &NewPart, index: usize) -> Part {
    match *new {
        NewPart::Control { board, kind, .. } => Part::Control { board, kind, index },
        NewPart::Row { board, .. } => Part::Row { board, row: index },
        NewPart::Board { .. } => Part::Board(index),
        NewPart::Trigger => Part::Trigger(index),
        NewPart::Pointer => Part::Pointer,
        NewPart::Space => Part::Space(index),
        NewPart::SpaceTarget { space, .. } => Part::SpaceTarget { space, index },
        NewPart::Layer => Part::Layer(index),
        NewPart::Sequence => Part::Sequence(index),
        NewPart::Chord { .. } => Part::Chord(index),
    }
}

/// Returns a control that is valid as it is, unless it overlaps another one.
fn control(
    draft: &Draft,
    (board, kind): (usize, ControlKind),
    at_mm: [f64; 2],
    binding: Option<&Binding>,
) -> Result<String, EditError> {
    let mut names = taken(draft);
    if kind == ControlKind::Key {
        return key(&mut names, at_mm, binding);
    }
    let mut text = with_unique_names(kind.spec().new, &mut names);
    let [width, _] = default_size(draft, board)?;
    let pitch = OPTION_PITCH_MM.max(width + OPTION_GAP_MM);
    let second = [at_mm[0] + pitch, at_mm[1]];
    text = text.replace("AT_RIGHT", &point(&second));
    text = text.replace("AT", &point(&at_mm));
    if let Some(binding) = binding
        && field_row(kind.spec().table, "tap").is_some()
    {
        text.insert_str(text.len() - 1, &format!(", tap: {}", binding.to_ron()));
    }
    Ok(text)
}

/// Returns a new control with names that are free.
fn with_unique_names(new: &str, names: &mut std::collections::BTreeSet<String>) -> String {
    let mut parts = new.split("name: \"");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once('"').unwrap_or((part, ""));
        text += &format!("name: {}{rest}", quote(&unique(names, name)));
    }
    text
}

fn key(
    names: &mut std::collections::BTreeSet<String>,
    at_mm: [f64; 2],
    binding: Option<&Binding>,
) -> Result<String, EditError> {
    let free = free_code(names).map(|code| Binding::Key(code.to_owned()));
    let binding = binding.cloned().or(free);
    let message = "every key code is on the layout already; choose the key to add";
    let binding = binding.ok_or(EditError::Selection(message))?;
    let (field, value) = binding.to_field();
    let implied = binding
        .implied_name()
        .filter(|name| !name.trim().is_empty());
    let wanted = implied.clone().unwrap_or_else(|| binding.to_ron());
    let name = unique(names, &wanted);
    let name = if Some(&name) == implied.as_ref() {
        String::new()
    } else {
        format!(", name: {}", quote(&name))
    };
    Ok(format!(
        "({field}: {value}{name}, at_mm: {})",
        point(&at_mm)
    ))
}

fn target(name: &str, at_mm: &[f64; 3]) -> String {
    format!("(name: {name}, at_mm: {}, shape: Ball(50))", point(at_mm))
}

fn point(coordinates: &[f64]) -> String {
    let coordinates: Vec<String> = coordinates.iter().copied().map(written).collect();
    format!("({})", coordinates.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editing::{Edit, edit};
    use crate::layout::Layout;

    #[test]
    fn the_first_control_of_a_layout_comes_with_a_board() {
        for boards in ["boards: [],\n", ""] {
            let text = format!("Layout(\n    name: \"x\",\n    {boards})\n");
            for &kind in ControlKind::ALL {
                let add = Edit::Add(NewPart::Control {
                    board: 0,
                    kind,
                    at_mm: [0.0, 0.0],
                    binding: None,
                });
                let added = edit(&text, &add).unwrap();
                Layout::parse(&added.text, "x").unwrap_or_else(|error| panic!("{kind:?} {error}"));
                let control = Part::control(0, kind, 0);
                assert_eq!(added.parts, [control]);
            }
        }
    }

    #[test]
    fn the_options_of_a_new_radio_group_do_not_overlap() {
        for size in [
            "",
            "size_mm: Box(22, 18),",
            "size_mm: Disc(30),",
            "size_mm: Box(4, 4),",
        ] {
            let text = format!(
                "Layout(name: \"x\", boards: [(pose: (anchor: elbow), {size} keys: [(code: \"A\", at_mm: (0, 80))])])"
            );
            let add = Edit::Add(NewPart::Control {
                board: 0,
                kind: ControlKind::Radio,
                at_mm: [0.0, 0.0],
                binding: None,
            });
            let added = edit(&text, &add).unwrap().text;
            Layout::parse(&added, "x").unwrap_or_else(|error| panic!("{size} {error}"));
        }
    }
}
