//! Deletes parts, and what mentions them.

use std::collections::{BTreeMap, BTreeSet};

use super::draft::Draft;
use super::error::EditError;
use super::geometry::{unsupported, without_children};
use super::names::{Mention, chord_lists, mentions, name_of, signal_names, targets_in};
use super::part::Part;
use super::rows::SourceRow;
use crate::document::{Node, quoted_content};

/// Deletes parts. Returns no parts.
pub(super) fn delete(draft: &mut Draft, parts: &[Part]) -> Result<Vec<Part>, EditError> {
    let groups = whole_groups(draft, &without_children(parts));
    let parts = without_children(&[parts, &groups[..]].concat());
    let deleted = targets_in(draft, &parts);
    delete_mentions(draft, &key_names(draft, &deleted))?;
    if draft.field(Part::Layout, "signals").is_some() {
        delete_signals(draft, &signal_names(draft, &deleted));
    }
    let mut rows: BTreeMap<(usize, usize), BTreeSet<usize>> = BTreeMap::new();
    for &part in &parts {
        match part {
            Part::Layout => return Err(unsupported(part, "deleted", "; delete its file")),
            Part::Pointer => draft.unset(Part::Layout, "pointer")?,
            Part::RowKey { board, row, column } => {
                rows.entry((board, row)).or_default().insert(column);
            }
            _ => {
                forget_initial(draft, part)?;
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

/// Removes `initial` from a radio group if it names the option that is deleted. An option that does not exist would be an error.
fn forget_initial(draft: &mut Draft, part: Part) -> Result<(), EditError> {
    let Part::RadioOption { .. } = part else {
        return Ok(());
    };
    let group = part.parent().ok_or(EditError::NoPart("radio option"))?;
    let own = name_of(draft.text(), draft.tree(), part);
    let initial = draft.field(group, "initial");
    let is_initial = initial.is_some_and(|it| it.string(draft.text()) == own.as_deref());
    if own.is_some() && is_initial {
        draft.unset(group, "initial")?;
    }
    Ok(())
}

/// Returns the names of the keys among targets.
fn key_names(draft: &Draft, deleted: &[Part]) -> BTreeSet<String> {
    let keys = deleted.iter().filter(|part| part.is_key());
    keys.filter_map(|part| name_of(draft.text(), draft.tree(), *part))
        .collect()
}

/// Deletes the signals with these names. A signal without its control would be an error.
fn delete_signals(draft: &mut Draft, names: &BTreeSet<String>) {
    let Some(signals) = draft.field(Part::Layout, "signals").cloned() else {
        return;
    };
    for (index, item) in signals.items().iter().enumerate() {
        let quoted = item.key.clone();
        let name = quoted.and_then(|key| quoted_content(&draft.text()[key]));
        if name.is_some_and(|name| names.contains(name)) {
            draft.remove(&signals, index);
        }
    }
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
    use crate::document::Document;
    use crate::editing::ControlKind;
    use crate::layout::Layout;

    #[test]
    fn a_control_is_deleted_with_its_signals() {
        let text = Document::shipped("mixer").unwrap().text;
        let first = |kind| Part::control(0, kind, 0);
        let without = |before: &str, parts: &[Part]| {
            let mut draft = Draft::new(before).unwrap();
            delete(&mut draft, parts).unwrap();
            let after = draft.text().to_owned();
            Layout::parse(&after, "a.ron").unwrap_or_else(|error| panic!("{error}"));
            after
        };
        let fader = first(ControlKind::Slider);
        let three = without(&text, &[fader, first(ControlKind::Toggle)]);
        assert!(!three.contains("\"Fader 1\"") && !three.contains("\"Mute 1\""));
        assert!(three.contains("\"Balance 1\": (control: 10"), "{three}");
        let pads = Document::shipped("xy-pad").unwrap().text;
        let one = without(&pads, &[first(ControlKind::XyPad)]);
        assert!(!one.contains("\"Filter x\": (") && one.contains("\"Bend x\": ("));
        let switch = without(&one, &[first(ControlKind::XyPad)]);
        assert!(switch.contains("\"Effect\": (control: 80"), "{switch}");
    }

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

    #[test]
    fn a_radio_group_whose_initial_option_is_deleted_has_none() {
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), radios: [(name: \"R\", initial: \"two\", options: [
            (name: \"one\", at_mm: (0, 0)),
            (name: \"two\", at_mm: (40, 0)),
            (name: \"three\", at_mm: (80, 0)),
        ])])])";
        for (option, deleted) in [(0, "one"), (1, "two")] {
            let part = Part::RadioOption {
                board: 0,
                radio: 0,
                option,
            };
            let mut draft = Draft::new(text).unwrap();
            delete(&mut draft, &[part]).unwrap();
            let after = draft.text();
            Layout::parse(after, "a.ron").unwrap_or_else(|error| panic!("{error}"));
            assert!(!after.contains(&format!("name: \"{deleted}\"")), "{after}");
            assert_eq!(after.contains("initial: \"two\""), option == 0, "{after}");
        }
    }
}
