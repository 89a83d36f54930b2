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
    let groups = whole_groups(draft, &without_children(parts));
    let parts = without_children(&[parts, &groups[..]].concat());
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

/// Returns the radio groups of which all options are among the parts. A group without options would be an error, and the board would
/// not show it.
fn whole_groups(draft: &Draft, parts: &[Part]) -> Vec<Part> {
    let options = parts
        .iter()
        .filter(|part| matches!(part, Part::RadioOption { .. }));
    let groups: BTreeSet<Part> = options.clone().filter_map(|part| part.parent()).collect();
    let is_whole = |group: &Part| {
        let own = options.clone().filter(|part| part.parent() == Some(*group));
        own.count() == draft.count(*group, "options")
    };
    groups.into_iter().filter(is_whole).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_radio_group_is_deleted_with_all_of_its_options() {
        let text = "(boards: [(
            radios: [(name: \"R\", options: [(name: \"one\", at_mm: (0, 0)), (name: \"two\", at_mm: (40, 0))])],
            keys: [(code: \"A\", at_mm: (80, 0))],
        )])";
        let options = [0, 1].map(|option| Part::RadioOption {
            board: 0,
            radio: 0,
            option,
        });
        let left = |parts: &[Part]| {
            let mut draft = Draft::new(text).unwrap();
            delete(&mut draft, parts).unwrap();
            draft.text().to_owned()
        };
        let without = left(&options);
        assert!(!without.contains("options"), "{without}");
        assert!(without.contains("code: \"A\""), "{without}");
        let one = left(&options[1..]);
        assert!(one.contains("\"one\"") && !one.contains("\"two\""), "{one}");
    }
}
