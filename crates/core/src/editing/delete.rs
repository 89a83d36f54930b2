//! Deletes parts, and what mentions them.

use std::collections::{BTreeMap, BTreeSet};

use super::draft::Draft;
use super::error::EditError;
use super::geometry::{unsupported, without_children};
use super::names::{Mention, chord_lists, mentions, name_of};
use super::part::{ControlKind, Part, targets};
use super::rows::SourceRow;
use crate::document::Node;

/// Deletes parts. Returns no parts.
pub(super) fn delete(draft: &mut Draft, parts: &[Part]) -> Result<Vec<Part>, EditError> {
    let parts = without_children(parts);
    delete_mentions(draft, &key_names(draft, &parts))?;
    let mut rows: BTreeMap<(usize, usize), BTreeSet<usize>> = BTreeMap::new();
    for &part in &parts {
        match part {
            Part::Layout => return Err(unsupported(part, "deleted", "; delete its file")),
            Part::Pointer => draft.unset(Part::Layout, "pointer")?,
            Part::RowKey { board, row, column } => {
                rows.entry((board, row)).or_default().insert(column);
            }
            _ => {
                let (parent, list, index) = part.place().ok_or(EditError::NoPart("part"))?;
                draft.node(part)?;
                let list = draft.field(parent, list).ok_or(EditError::NoPart("part"))?;
                let list = list.clone();
                draft.remove(&list, index);
            }
        }
    }
    for ((board, row), columns) in rows {
        SourceRow::read(draft, board, row)?.split(draft, &columns)?;
    }
    draft.commit()?;
    Ok(Vec::new())
}

/// Returns the names of the keys in parts.
fn key_names(draft: &Draft, parts: &[Part]) -> BTreeSet<String> {
    let (text, tree) = (draft.text(), draft.tree());
    let parts: BTreeSet<Part> = parts.iter().copied().collect();
    let is_key = |part: &Part| {
        matches!(
            part,
            Part::RowKey { .. }
                | Part::Control {
                    kind: ControlKind::Key,
                    ..
                }
        )
    };
    let is_deleted = |part: &Part| {
        std::iter::successors(Some(*part), |part| part.parent()).any(|part| parts.contains(&part))
    };
    let keys = targets(text, tree).into_iter().filter(is_key);
    keys.filter(is_deleted)
        .filter_map(|part| name_of(text, tree, part))
        .collect()
}

/// Deletes labels, entries of layers, and chords with these keys.
fn delete_mentions(draft: &mut Draft, names: &BTreeSet<String>) -> Result<(), EditError> {
    let mut chords = BTreeSet::new();
    for (_, mention) in mentions(draft, names) {
        match mention {
            Mention::Entry { map, index, .. } => draft.remove(&map, index),
            Mention::Chord { list, chord, .. } => _ = chords.insert((list, chord)),
        }
    }
    let lists: Vec<Node> = chord_lists(draft).into_iter().cloned().collect();
    for (list, chord) in chords {
        draft.remove(&lists[list], chord);
    }
    Ok(())
}
