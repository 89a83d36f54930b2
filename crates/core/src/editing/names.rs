//! The names of parts, and where a layout mentions them.

use std::collections::BTreeSet;
use std::ops::Range;

use super::draft::Draft;
use super::error::EditError;
use super::part::{ControlKind, Part, targets, words};
use crate::device::KeyCode;
use crate::document::{Node, quote, quoted_content};
use crate::layout::controls::xy_pad::DIRECTIONS;
use crate::layout::is_multitap;

/// Returns the name of a part, as the loader gives it.
pub fn name_of(text: &str, tree: &Node, part: Part) -> Option<String> {
    let node = part.node(text, tree)?;
    let string = |field: &str| node.field(text, field)?.string(text);
    match part {
        Part::RowKey { column, .. } => {
            let keys = node.field(text, "keys")?;
            let word = words(text, keys).get(column)?.clone();
            Some(canonical(&text[word]))
        }
        Part::Control {
            kind: ControlKind::Key,
            ..
        } => match string("name") {
            Some(name) => Some(name.to_owned()),
            None => implied_name(text, node),
        },
        Part::Row { .. } | Part::Chord(_) => string("keys").map(str::to_owned),
        Part::Sequence(index) => {
            let key = sequence_key(text, tree, index)?;
            quoted_content(&text[key]).map(str::to_owned)
        }
        _ => string("name").map(str::to_owned),
    }
}

/// Returns the names of the values of a part with this name, if it has several: a signal is for one of them.
pub(super) fn value_names(part: Part, name: &str) -> Vec<String> {
    let is_pad = matches!(
        part,
        Part::Control {
            kind: ControlKind::XyPad,
            ..
        }
    );
    let directions = DIRECTIONS.iter().filter(|_| is_pad);
    directions
        .map(|direction| format!("{name} {direction}"))
        .collect()
}

/// Returns the targets in parts.
pub(super) fn targets_in(draft: &Draft, parts: &[Part]) -> Vec<Part> {
    let parts: BTreeSet<Part> = parts.iter().copied().collect();
    let is_within = |part: &Part| {
        std::iter::successors(Some(*part), |part| part.parent()).any(|part| parts.contains(&part))
    };
    let all = targets(draft.text(), draft.tree()).into_iter();
    all.filter(is_within).collect()
}

/// Returns the names of targets, with the names that signals have for their values.
pub(super) fn signal_names(draft: &Draft, targets: &[Part]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for target in targets {
        if let Some(name) = name_of(draft.text(), draft.tree(), *target) {
            names.extend(value_names(*target, &name));
            names.insert(name);
        }
    }
    names
}

/// Returns the name that a key has without one of its own: that in its action.
pub(super) fn implied_name(text: &str, key: &Node) -> Option<String> {
    let string = |field: &str| key.field(text, field)?.string(text);
    if let Some(code) = string("code") {
        return Some(canonical(code));
    }
    if let Some(layer) = string("layer") {
        return Some(layer.to_owned());
    }
    let action = key.field(text, "action")?;
    let argument = action.items().first()?.value.string(text)?;
    let is_key = action.name(text) == Some("Key");
    Some(if is_key {
        canonical(argument)
    } else {
        argument.to_owned()
    })
}

/// Returns a name without the number at its end.
fn stem(name: &str) -> &str {
    let is_number = |word: &str| word.parse::<u32>().is_ok();
    match name.rsplit_once(' ') {
        Some((stem, number)) if is_number(number) => stem,
        _ => name,
    }
}

/// Returns `true` if [`unique`] makes a name of another one that is taken.
pub(super) fn is_numbered(name: &str, of: &str) -> bool {
    name != of && stem(name) != name && [of, stem(of)].contains(&stem(name))
}

/// Returns the range of the quoted name of a sequence.
pub(super) fn sequence_key(text: &str, tree: &Node, index: usize) -> Option<Range<usize>> {
    let sequences = tree.in_some(text).field(text, "sequences")?;
    sequences.items().get(index)?.key.clone()
}

/// Returns the name of a key code, however it is spelled, and any other name as it is.
pub(super) fn canonical(name: &str) -> String {
    let code = name.parse::<KeyCode>();
    code.map_or_else(|_| name.to_owned(), |code| code.name().to_owned())
}

/// Returns the names of all targets.
pub(super) fn taken(draft: &Draft) -> BTreeSet<String> {
    let (text, tree) = (draft.text(), draft.tree());
    let parts = targets(text, tree);
    parts
        .iter()
        .filter_map(|part| name_of(text, tree, *part))
        .collect()
}

/// Returns a name that is not taken, and takes it: `Slider`, `Slider 2`, `Slider 3`. The last digit of `A B C 2` is a letter of a
/// multitap key and no number, unless there is `A B C`.
pub(super) fn unique(taken: &mut BTreeSet<String>, name: &str) -> String {
    let is_letter = is_multitap(name) && !taken.contains(stem(name));
    let stem = if is_letter { name } else { stem(name) };
    let mut candidate = name.to_owned();
    let mut number = 2;
    while !taken.insert(candidate.clone()) {
        candidate = format!("{stem} {number}");
        number += 1;
    }
    candidate
}

/// A mention of a key in another part of the layout.
pub(super) enum Mention {
    /// The key of an entry in a map: its labels, its signals, or a layer.
    Entry {
        /// The map.
        map: Node,
        /// Index of the entry.
        index: usize,
        /// The quoted name.
        key: Range<usize>,
    },
    /// A word of a chord.
    Chord {
        /// Index of its list in [`chord_lists`].
        list: usize,
        /// Index of the chord.
        chord: usize,
        /// The word.
        word: Range<usize>,
    },
}

/// Returns the mentions of keys whose names are among these.
pub(super) fn mentions(draft: &Draft, names: &BTreeSet<String>) -> Vec<(String, Mention)> {
    let text = draft.text();
    let mut mentions = Vec::new();
    let name_in = |name: &str| {
        let canonical = canonical(name);
        let own = [name.to_owned(), canonical];
        own.into_iter().find(|spelling| names.contains(spelling))
    };
    let maps = layers(draft)
        .flat_map(|layer| ["keys", "actions"].map(|map| layer.field(text, map)))
        .flatten()
        .chain(draft.field(Part::Layout, "labels"))
        .chain(draft.field(Part::Layout, "signals"));
    for map in maps {
        for (index, item) in map.items().iter().enumerate() {
            let Some(key) = &item.key else { continue };
            let name = quoted_content(&text[key.clone()]);
            if let Some(name) = name.and_then(name_in) {
                let (map, key) = (map.clone(), key.clone());
                mentions.push((name, Mention::Entry { map, index, key }));
            }
        }
    }
    for (list, chords) in chord_lists(draft).into_iter().enumerate() {
        for (chord, item) in chords.items().iter().enumerate() {
            let keys = item.value.in_some(text).field(text, "keys");
            for word in keys.map_or(Vec::new(), |keys| words(text, keys)) {
                if let Some(name) = name_in(&text[word.clone()]) {
                    mentions.push((name, Mention::Chord { list, chord, word }));
                }
            }
        }
    }
    mentions
}

fn layers(draft: &Draft) -> impl Iterator<Item = &Node> {
    let layers = draft.field(Part::Layout, "layers");
    let items = layers.map_or(&[][..], Node::items).iter();
    items.map(move |item| item.value.in_some(draft.text()))
}

/// Returns the lists of chords: the layout's own, and one for each layer that has chords.
pub(super) fn chord_lists(draft: &Draft) -> Vec<&Node> {
    let text = draft.text();
    let of_layers = layers(draft).filter_map(|layer| layer.field(text, "chords"));
    let of_layout = draft.field(Part::Layout, "chords").into_iter();
    of_layout.chain(of_layers).collect()
}

/// Returns `true` if a name can be a word of a chord, which has the names of its keys in plain quotes with blanks between them.
fn is_word_of_chord(name: &str) -> bool {
    !name.contains(|letter: char| letter.is_whitespace() || matches!(letter, '"' | '\\'))
}

/// Returns `false` if a chord mentions a key and cannot mention the new name.
pub(super) fn can_be_mentioned(draft: &Draft, old: &str, new: &str) -> bool {
    let mentions = mentions(draft, &BTreeSet::from([old.to_owned()]));
    let is_in_chord = |(_, mention): &(String, Mention)| matches!(mention, Mention::Chord { .. });
    is_word_of_chord(new) || !mentions.iter().any(is_in_chord)
}

/// Replaces all mentions of a key by a new name. A name with blanks, quotes or backslashes cannot be mentioned in chords.
pub(super) fn rename_mentions(draft: &mut Draft, old: &str, new: &str) -> Result<(), EditError> {
    for (_, mention) in mentions(draft, &BTreeSet::from([old.to_owned()])) {
        match mention {
            Mention::Entry { key, .. } => draft.replace(key, quote(new)),
            Mention::Chord { .. } if !is_word_of_chord(new) => {
                return Err(EditError::Name(new.to_owned()));
            }
            Mention::Chord { word, .. } => draft.replace(word, new),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_counts_from_its_name_and_not_from_the_letters_of_a_key() {
        for (taken, expected) in [
            (&["Slider"][..], "Slider 2"),
            (&["Slider", "Slider 2"][..], "Slider 3"),
            (&["A B C 2"][..], "A B C 2 2"),
            (&["A B C 2", "A B C 2 2"][..], "A B C 2 3"),
            (&["A", "A 2"][..], "A 3"),
        ] {
            let mut names = taken.iter().map(|name| (*name).to_owned()).collect();
            let last = taken[taken.len() - 1];
            let copy = unique(&mut names, last);
            assert_eq!(copy, expected, "{taken:?}");
            assert!(names.contains(expected) && is_numbered(&copy, taken[0]));
        }
        assert!(!is_numbered("A B C 2", "A B C 2") && !is_numbered("B 2", "A"));
    }
}
