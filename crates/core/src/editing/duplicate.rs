//! Copies of parts under new names.

use std::collections::{BTreeMap, BTreeSet};

use super::draft::{Draft, written};
use super::error::EditError;
use super::geometry::{unsupported, without_children};
use super::names::{name_of, taken, unique};
use super::part::{ControlKind, Part};
use super::patch::Patch;
use super::rows::SourceRow;
use crate::document::{Node, quote, read_tree};

/// The largest number of copies of one repetition: each reads the text.
const MAX_COPIES: usize = 400;

/// Copies parts. Returns the copies.
pub(super) fn duplicate(
    draft: &mut Draft,
    parts: &[Part],
    by_mm: [f64; 2],
) -> Result<Vec<Part>, EditError> {
    let mut names = taken(draft);
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
            _ => {
                let remedy = "; add one, and duplicate the controls on it";
                return Err(unsupported(part, "duplicated", remedy));
            }
        };
        let own = |it: &&mut (Part, &str, Vec<String>)| (it.0, it.1) == (parent, list);
        let first = draft
            .field(parent, list)
            .map_or(0, |list| list.items().len());
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
    draft.commit()?;
    Ok(new_parts)
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

/// Returns controls as the text of a board, `(keys: [..], sliders: [..])`, for `paste`. `None` without a control among the parts.
pub fn copied(text: &str, parts: &[Part]) -> Option<String> {
    let draft = &Draft::new(text).ok()?;
    let mut lists: BTreeMap<ControlKind, Vec<String>> = BTreeMap::new();
    for part in without_children(parts) {
        match part {
            Part::RowKey { board, row, column } => {
                let source = SourceRow::read(draft, board, row).ok()?;
                let action = format!("code: {}", quote(source.code(column)?));
                let key = source.key_with(column, &action, [0.0; 2]);
                lists.entry(ControlKind::Key).or_default().push(key);
            }
            Part::Control { kind, .. } => {
                let control_text = draft.node(part).ok()?.text(draft.text());
                lists.entry(kind).or_default().push(control_text.to_owned());
            }
            Part::RadioOption { board, radio, .. } => {
                let group = Part::Control {
                    board,
                    kind: ControlKind::Radio,
                    index: radio,
                };
                let group_text = draft.node(group).ok()?.text(draft.text()).to_owned();
                let groups = lists.entry(ControlKind::Radio).or_default();
                if !groups.contains(&group_text) {
                    groups.push(group_text);
                }
            }
            _ => {}
        }
    }
    let lists: Vec<String> = lists
        .into_iter()
        .map(|(kind, controls)| {
            let controls = controls.join(",\n        ");
            format!("    {}: [\n        {controls},\n    ],\n", kind.list())
        })
        .collect();
    (!lists.is_empty()).then(|| format!("(\n{})", lists.concat()))
}

/// Adds the controls of a text to a board, under names that are free. Returns them.
pub(super) fn paste(
    draft: &mut Draft,
    board: usize,
    text: &str,
    by_mm: [f64; 2],
) -> Result<Vec<Part>, EditError> {
    let message = "the clipboard has no controls of a layout; copy some first";
    let nothing = || EditError::Selection(message);
    if !text.trim_start().starts_with('(') {
        return Err(nothing());
    }
    let source = Draft::new(&format!("(boards: [{text}])")).map_err(|_| nothing())?;
    let mut names = taken(draft);
    let mut new_parts = Vec::new();
    for &kind in ControlKind::ALL {
        let count = |counted: &Draft, counted_board| {
            let list = counted.field(Part::Board(counted_board), kind.list());
            list.map_or(0, |list| list.items().len())
        };
        let first = count(draft, board);
        let mut texts = Vec::new();
        for index in 0..count(&source, 0) {
            let own = Part::Control {
                board: 0,
                kind,
                index,
            };
            texts.push(copy(&source, &mut names, own, by_mm)?);
            let index = first + index;
            new_parts.push(Part::Control { board, kind, index });
        }
        draft.push(Part::Board(board), kind.list(), &texts)?;
    }
    if new_parts.is_empty() {
        Err(nothing())
    } else {
        draft.commit().map(|()| new_parts)
    }
}

/// Returns the part of the same kind at another index; a single key for a row or a key of one.
fn in_list(part: Part, index: usize) -> Part {
    match part {
        Part::Row { board, .. } | Part::RowKey { board, .. } => Part::Control {
            board,
            kind: ControlKind::Key,
            index,
        },
        Part::Control { board, kind, .. } => Part::Control { board, kind, index },
        Part::RadioOption { board, radio, .. } => Part::RadioOption {
            board,
            radio,
            option: index,
        },
        Part::SpaceTarget { space, .. } => Part::SpaceTarget { space, index },
        Part::Trigger(_) => Part::Trigger(index),
        other => other,
    }
}

fn row_key(
    draft: &Draft,
    names: &mut BTreeSet<String>,
    [board, row, column]: [usize; 3],
    by_mm: [f64; 2],
) -> Result<String, EditError> {
    let row = SourceRow::read(draft, board, row)?;
    let code = row.code(column).ok_or(EditError::NoPart("key"))?;
    let name = unique(names, &super::names::canonical(code));
    let action = format!("code: {}, name: {}", quote(code), quote(&name));
    Ok(row.key_with(column, &action, by_mm))
}

/// Returns the text of a part with new names, at an offset.
fn copy(
    draft: &Draft,
    names: &mut BTreeSet<String>,
    part: Part,
    by_mm: [f64; 2],
) -> Result<String, EditError> {
    let text = draft.node(part)?.text(draft.text());
    let tree = read_tree(text).ok_or(EditError::Unreadable)?;
    let mut patch = Patch::default();
    let name = name_of(draft.text(), draft.tree(), part);
    set_name(&mut patch, text, &tree, name.as_deref(), names);
    shift_copy(&mut patch, text, &tree, by_mm);
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
    names: &mut BTreeSet<String>,
) -> Option<String> {
    let name = name?;
    let new = unique(names, name);
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
