//! Copies of parts under new names.

use std::collections::BTreeSet;

use super::axes::TakenAxes;
use super::draft::{Draft, written};
use super::error::EditError;
use super::geometry::{unsupported, without_children};
use super::in_space;
use super::names::{Mention, canonical, mentions, name_of, taken, unique, value_names};
use super::part::{ControlKind, Part, targets};
use super::patch::Patch;
use super::rows::{SourceRow, take_out};
use crate::document::{Node, quote, read_tree};

/// The largest number of copies of one repetition: each reads the text.
pub(super) const MAX_COPIES: usize = 400;

/// The names and axes of a layout while parts are copied.
pub(super) struct Names {
    taken: BTreeSet<String>,
    /// The names of originals and of their copies.
    copies: Vec<[String; 2]>,
    axes: TakenAxes,
}

impl Names {
    pub fn new(draft: &Draft) -> Self {
        Self {
            taken: taken(draft),
            copies: Vec::new(),
            axes: TakenAxes::new(draft),
        }
    }

    /// Returns a free name for the copy of a part.
    fn of_copy(&mut self, name: &str) -> String {
        let new = unique(&mut self.taken, name);
        self.copies.push([name.to_owned(), new.clone()]);
        new
    }

    /// Returns the name of the copy of a part with a name, however it is spelled; `None` if none was copied.
    pub fn new_name(&self, name: &str) -> Option<&str> {
        let code = canonical(name);
        let mut copies = self.copies.iter();
        let found = copies.find(|[from, _]| from == name || *from == code);
        found.map(|[_, copy]| copy.as_str())
    }

    /// Adds the values of the part that was copied last, if it has several.
    fn add_values(&mut self, part: Part) {
        if let Some([name, new]) = self.copies.last() {
            let [old_values, new_values] = [name, new].map(|it| value_names(part, it));
            let pairs = old_values.into_iter().zip(new_values);
            self.copies.extend(pairs.map(|(from, to)| [from, to]));
        }
    }
}

/// Copies parts. Returns the copies.
pub(super) fn duplicate(
    draft: &mut Draft,
    parts: &[Part],
    by_mm: [f64; 2],
) -> Result<Vec<Part>, EditError> {
    let mut names = Names::new(draft);
    let mut copies: Vec<(Part, &'static str, Vec<String>)> = Vec::new();
    let mut new_parts = Vec::new();
    for part in without_children(parts) {
        let (parent, list, texts) = match part {
            Part::RowKey { board, row, column } => {
                let key = row_key(draft, &mut names, [board, row, column], by_mm)?;
                (Part::Board(board), "keys", vec![key])
            }
            Part::Row { board, row } => {
                let columns = 0..SourceRow::read(draft, board, row)?.len();
                let keys: Result<Vec<String>, EditError> = columns
                    .map(|column| row_key(draft, &mut names, [board, row, column], by_mm))
                    .collect();
                (Part::Board(board), "keys", keys?)
            }
            Part::Control { .. }
            | Part::RadioOption { .. }
            | Part::Trigger(_)
            | Part::SpaceTarget { .. } => {
                let (parent, list, _) = part.place().ok_or(EditError::NoPart("part"))?;
                (parent, list, vec![copy(draft, &mut names, part, by_mm)?])
            }
            Part::Board(board) => {
                check_bent(draft, draft, board)?;
                let board = copied_board(draft, &mut names, board, by_mm)?;
                (Part::Layout, "boards", vec![board])
            }
            _ => return Err(unsupported(part, "duplicated", "; add one")),
        };
        let own = |it: &&mut (Part, &str, Vec<String>)| (it.0, it.1) == (parent, list);
        let first = draft.count(parent, list);
        let pushed = match copies.iter_mut().find(own) {
            Some((_, _, pushed)) => pushed,
            None => {
                copies.push((parent, list, Vec::new()));
                let Some((_, _, pushed)) = copies.last_mut() else {
                    continue;
                };
                pushed
            }
        };
        for text in texts {
            new_parts.push(in_list(part, first + pushed.len()));
            pushed.push(text);
        }
    }
    for (parent, list, texts) in copies {
        draft.push(parent, list, &texts)?;
    }
    copy_entries(draft, &names.copies);
    draft.commit()?;
    Ok(new_parts)
}

/// Copies the labels, the signals and the entries in layers of parts that are copied.
fn copy_entries(draft: &mut Draft, copies: &[[String; 2]]) {
    let originals = copies.iter().map(|[name, _]| name.clone()).collect();
    for (name, mention) in mentions(draft, &originals) {
        let Mention::Entry { map, index, .. } = mention else {
            continue;
        };
        let value = map.items()[index].value.text(draft.text()).to_owned();
        for [_, copy] in copies.iter().filter(|[original, _]| *original == name) {
            draft.push_entry(&map, &format!("{}: {value}", quote(copy)));
        }
    }
}

/// Copies parts in columns and rows. Returns the originals and the copies.
pub(super) fn repeat(
    draft: &mut Draft,
    parts: &[Part],
    [columns, rows]: [usize; 2],
    pitch_mm: [f64; 2],
) -> Result<Vec<Part>, EditError> {
    let copies = (columns * rows).saturating_sub(1) * parts.len();
    if copies == 0 || copies > MAX_COPIES {
        let message =
            "a repetition makes 1 to 400 copies; choose other numbers of columns and rows";
        return Err(EditError::Selection(message));
    }
    let mut all = parts.to_vec();
    for row in 0..rows {
        for column in 0..columns {
            if (column, row) == (0, 0) {
                continue;
            }
            let by_mm = [column as f64 * pitch_mm[0], row as f64 * pitch_mm[1]];
            all.extend(duplicate(draft, parts, by_mm)?);
        }
    }
    Ok(all)
}

/// Returns the part of the same kind at another index; a single key for a row or a key of one.
fn in_list(part: Part, index: usize) -> Part {
    match part {
        Part::Row { board, .. } | Part::RowKey { board, .. } => {
            Part::control(board, ControlKind::Key, index)
        }
        Part::Control { board, kind, .. } => Part::Control { board, kind, index },
        Part::RadioOption { board, radio, .. } => Part::RadioOption {
            board,
            radio,
            option: index,
        },
        Part::SpaceTarget { space, .. } => Part::SpaceTarget { space, index },
        Part::Trigger(_) => Part::Trigger(index),
        Part::Board(_) => Part::Board(index),
        other => other,
    }
}

/// The reason for which a board whose keys are pressed by bending has no copy, and the remedy.
const BENT_REMEDY: &str = " while its keys are pressed by bending: a finger presses one key; add a layer or chords for more keys";

/// Returns an error for a copy of a board of `source` whose keys are pressed by bending, if `draft` has such a board for the same
/// hand.
pub(super) fn check_bent(draft: &Draft, source: &Draft, board: usize) -> Result<(), EditError> {
    let field = |of: &Draft, index: usize, name: &str| {
        let node = of.field(Part::Board(index), name)?;
        Some(node.text(of.text()).to_owned())
    };
    let is_bent = |of: &Draft, index: usize| field(of, index, "contact").as_deref() == Some("Bend");
    let hand = field(source, board, "hand");
    let mut others = 0..draft.count(Part::Layout, "boards");
    let has_same = is_bent(source, board)
        && others.any(|index| is_bent(draft, index) && field(draft, index, "hand") == hand);
    if has_same {
        return Err(unsupported(Part::Board(board), "duplicated", BENT_REMEDY));
    }
    Ok(())
}

/// Returns the text of a board whose controls have new names and whose rows are single keys, at an offset along the axes of the
/// world.
pub(super) fn copied_board(
    draft: &Draft,
    names: &mut Names,
    board: usize,
    [right, forward]: [f64; 2],
) -> Result<String, EditError> {
    let text = draft.text_of(draft.node(Part::Board(board))?);
    let mut own = Draft::new(&format!("(boards: [{text}])"))?;
    let copy = Part::Board(0);
    let targets = targets(own.text(), own.tree());
    let is_in_row = |part: &Part| matches!(part, Part::RowKey { .. });
    let row_keys: Vec<Part> = targets.into_iter().filter(is_in_row).collect();
    take_out(&mut own, &row_keys, false)?;
    own.unset(copy, "rows")?;
    own.commit()?;
    for &kind in ControlKind::ALL {
        for index in 0..own.count(copy, kind.list()) {
            let part = Part::control(0, kind, index);
            let name = name_of(own.text(), own.tree(), part);
            let node = own.node(part)?;
            let control = renamed(node.text(own.text()), name.as_deref(), names, [0.0; 2])?;
            if name.is_some() {
                names.add_values(part);
            }
            own.replace(node.range.clone(), control);
        }
    }
    own.commit()?;
    in_space::shift(&mut own, &[copy], [right, forward, 0.0])?;
    Ok(own.node(copy)?.text(own.text()).to_owned())
}

fn row_key(
    draft: &Draft,
    names: &mut Names,
    [board, row, column]: [usize; 3],
    by_mm: [f64; 2],
) -> Result<String, EditError> {
    let row = SourceRow::read(draft, board, row)?;
    let code = row.code(column).ok_or(EditError::NoPart("key"))?;
    let name = names.of_copy(&canonical(code));
    let action = format!("code: {}, name: {}", quote(code), quote(&name));
    Ok(row.key_with(column, &action, by_mm))
}

/// Returns the text of a part with new names, at an offset.
pub(super) fn copy(
    draft: &Draft,
    names: &mut Names,
    part: Part,
    by_mm: [f64; 2],
) -> Result<String, EditError> {
    let text = draft.text_of(draft.node(part)?);
    let name = name_of(draft.text(), draft.tree(), part);
    let copied = renamed(&text, name.as_deref(), names, by_mm)?;
    if name.is_some() {
        names.add_values(part);
    }
    Ok(copied)
}

/// Returns the text of a part of this name with new names, at an offset.
fn renamed(
    text: &str,
    name: Option<&str>,
    names: &mut Names,
    by_mm: [f64; 2],
) -> Result<String, EditError> {
    let tree = read_tree(text).ok_or(EditError::Unreadable)?;
    let mut patch = Patch::default();
    set_name(&mut patch, text, &tree, name, names);
    shift_copy(&mut patch, text, &tree, by_mm);
    names.axes.replace(&mut patch, text, &tree)?;
    for option in tree.field(text, "options").map_or(&[][..], Node::items) {
        let option = option.value.in_some(text);
        let option_name = option
            .field(text, "name")
            .and_then(|node| node.string(text));
        let new = set_name(&mut patch, text, option, option_name, names);
        shift_copy(&mut patch, text, option, by_mm);
        let initial = tree.field(text, "initial");
        if let (Some(initial), Some(new)) = (initial, new)
            && initial.string(text) == option_name
        {
            patch.replace(initial.range.clone(), quote(&new));
        }
    }
    let (text, _) = patch.apply(text).ok_or(EditError::Overlap)?;
    Ok(text)
}

fn set_name(
    patch: &mut Patch,
    text: &str,
    node: &Node,
    name: Option<&str>,
    names: &mut Names,
) -> Option<String> {
    let name = name?;
    let new = names.of_copy(name);
    if new == name {
        return Some(new);
    }
    match (node.field(text, "name"), node.items().first()) {
        (Some(written_name), _) => patch.replace(written_name.range.clone(), quote(&new)),
        (None, Some(first)) => {
            let end = first.value.range.end;
            patch.replace(end..end, format!(", name: {}", quote(&new)));
        }
        (None, None) => {}
    }
    Some(new)
}

/// Moves a copy: to the right, and away from the wearer, which is the negative third axis of a target in space.
fn shift_copy(patch: &mut Patch, text: &str, node: &Node, [x, y]: [f64; 2]) {
    let Some(at) = node.field(text, "at_mm") else {
        return;
    };
    let by = match at.items().len() {
        3 => [x, 0.0, -y],
        _ => [x, y, 0.0],
    };
    for (item, shift) in at.items().iter().zip(by) {
        if let Some(old) = item.value.number(text)
            && shift != 0.0
        {
            patch.replace(item.value.in_some(text).range.clone(), written(old + shift));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Document, shipped_layouts};
    use crate::editing::duplicate_parts;
    use crate::layout::Layout;

    #[test]
    fn a_copied_board_has_names_of_its_own_and_is_at_the_offset() {
        let text = "Layout(
    name: \"a\",
    boards: [
        (
            // Before the elbow.
            pose: (anchor: elbow, bearing_deg: 90, forward_mm: 320),
            rows: [(at_mm: (0, 0), keys: \"A B\")],
            sliders: [
                (
                    name: \"Volume\",
                    at_mm: (0, 40), length_mm: 60,
                ),
            ],
            keys: [(layer: \"symbols\", at_mm: (0, -20))],
        ),
    ],
    layers: [(name: \"symbols\", keys: {\"A\": \"1\"})],
    chords: [(keys: \"A B\", action: Key(\"Tab\"))],
)
";
        let board = "        (
            // Before the elbow.
            pose: (anchor: elbow, bearing_deg: 90, forward_mm: 420),
            sliders: [
                (
                    name: \"Volume 2\",
                    at_mm: (0, 40), length_mm: 60,
                ),
            ],
            keys: [(layer: \"symbols\", name: \"symbols 2\", at_mm: (0, -20)), (code: \"A\", name: \"A 2\", at_mm: (0, 0)), (code: \"B\", name: \"B 2\", at_mm: (19, 0))],
        ),
";
        let edited = duplicate_parts(text, &[Part::Board(0)], [100.0, 0.0]).unwrap();
        assert_eq!(edited.parts, [Part::Board(1)]);
        let expected = text
            .replace("    ],\n    layers", &format!("{board}    ],\n    layers"))
            .replace("\"A\": \"1\"", "\"A\": \"1\", \"A 2\": \"1\"");
        assert_eq!(edited.text, expected);
        assert!(
            Layout::parse(&edited.text, "a.ron")
                .unwrap()
                .board_overlaps()
                .is_empty()
        );
    }

    #[test]
    fn a_copied_control_has_the_signals_of_its_values() {
        let text = Document::shipped("xy-pad").unwrap().text;
        let pad = Part::control(0, ControlKind::XyPad, 0);
        for (part, by_mm) in [(pad, [0.0, 120.0]), (Part::Board(0), [400.0, 0.0])] {
            let copied = duplicate_parts(&text, &[part], by_mm).unwrap().text;
            Layout::parse(&copied, "a.ron").unwrap_or_else(|error| panic!("{error}"));
            let signal = "\"Filter 2 y\": (control: 71, osc: \"/filter/resonance\")";
            assert!(copied.contains(signal), "{part:?}: {copied}");
        }
    }

    #[test]
    fn every_board_of_a_shipped_layout_can_be_copied_or_the_reason_is_named() {
        let mut refused = Vec::new();
        for name in shipped_layouts() {
            let text = Document::shipped(name).unwrap().text;
            let layout = Layout::parse(&text, name).unwrap();
            for index in 0..layout.boards.len() {
                let board = Part::Board(index);
                let edited = match duplicate_parts(&text, &[board], [1200.0, 0.0]) {
                    Ok(edited) => edited,
                    Err(error) => {
                        refused.push((name, index, error.to_string()));
                        continue;
                    }
                };
                let copied = Layout::parse(&edited.text, name);
                let copied = copied.unwrap_or_else(|error| panic!("{name}: {error}"));
                let fronts = |of: &Layout, number: usize| -> Vec<_> {
                    of.scene.surfaces()[number]
                        .targets()
                        .map(|(_, target)| target.shape)
                        .collect()
                };
                let copy = layout.boards.len();
                assert_eq!(
                    fronts(&copied, copy).len(),
                    fronts(&layout, index).len(),
                    "{name}"
                );
                assert_eq!(copied.board_overlaps(), [], "{name}");
            }
        }
        let reason = "this board cannot be duplicated while its keys are pressed by bending: a finger presses one key; add a layer or \
                      chords for more keys";
        assert_eq!(refused, [("chords-bend", 0, reason.to_owned())]);
    }
}
