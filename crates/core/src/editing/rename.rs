//! Changes names, and every mention of them.

use std::ops::Range;

use super::draft::Draft;
use super::error::EditError;
use super::geometry::unsupported;
use super::names::{name_of, rename_mentions, sequence_key, taken, value_names};
use super::part::{ControlKind, Part, targets};
use super::rows::take_out;
use crate::document::{Node, quote, quoted_content};
use crate::layout::BASE_LAYER;

/// Changes the name of a part.
pub(super) fn rename(draft: &mut Draft, part: Part, name: &str) -> Result<Vec<Part>, EditError> {
    let is_target = !matches!(
        part,
        Part::Layout | Part::Board(_) | Part::Layer(_) | Part::Sequence(_)
    );
    let is_named = matches!(
        part,
        Part::Layout
            | Part::Board(_)
            | Part::RowKey { .. }
            | Part::Control { .. }
            | Part::RadioOption { .. }
            | Part::Trigger(_)
            | Part::SpaceTarget { .. }
            | Part::Layer(_)
            | Part::Sequence(_)
    );
    if !is_named {
        return Err(unsupported(part, "given a name", ""));
    }
    let old = name_of(draft.text(), draft.tree(), part);
    if old.as_deref() == Some(name) {
        return Ok(vec![part]);
    }
    let is_taken = match part {
        Part::Layer(_) => name == BASE_LAYER || has_layer(draft, name),
        _ => is_target && taken(draft).contains(name),
    };
    if name.trim().is_empty() || name.chars().any(char::is_control) || is_taken {
        return Err(EditError::Name(name.to_owned()));
    }
    if let Part::Sequence(index) = part {
        rename_sequence(draft, index, name)?;
        return Ok(vec![part]);
    }
    let parts = take_out(draft, &[part], false)?;
    let taken = parts[0];
    if let Some(old) = old {
        if is_target {
            rename_mentions(draft, &old, name)?;
        }
        let values = value_names(taken, &old).into_iter();
        for (from, to) in values.zip(value_names(taken, name)) {
            rename_mentions(draft, &from, &to)?;
        }
        match taken {
            Part::Layer(_) => {
                rename_implied(draft, "Layer", &old, name)?;
                rename_found(draft, name, |node, text, found| {
                    collect_layers(node, text, &old, found);
                });
            }
            Part::Trigger(_) => rename_found(draft, name, |node, text, found| {
                collect_steps(node, text, &old, found);
            }),
            Part::RadioOption { board, radio, .. } => {
                let group = Part::control(board, ControlKind::Radio, radio);
                let initial = draft.field(group, "initial");
                if initial.and_then(|node| node.string(draft.text())) == Some(&old) {
                    draft.set(group, "initial", &quote(name))?;
                }
            }
            _ => {}
        }
    }
    draft.set(taken, "name", &quote(name))?;
    draft.commit()?;
    Ok(parts)
}

/// Returns `true` if a layer has this name.
fn has_layer(draft: &Draft, name: &str) -> bool {
    let mut layers = (0..draft.count(Part::Layout, "layers")).map(Part::Layer);
    layers.any(|layer| name_of(draft.text(), draft.tree(), layer).as_deref() == Some(name))
}

/// Returns `true` if a key without a name of its own is named after the layer or sequence in its action.
fn names_a_key(draft: &Draft, action: &str, name: &str) -> bool {
    let text = draft.text();
    let is_named = |target: Part| {
        let own = draft.field(target, "action");
        let has_action = own.is_some_and(|own| own.name(text) == Some(action))
            || action == "Layer" && draft.field(target, "layer").is_some();
        has_action
            && draft.field(target, "name").is_none()
            && name_of(text, draft.tree(), target).as_deref() == Some(name)
    };
    targets(text, draft.tree()).into_iter().any(is_named)
}

/// Replaces the mentions of a key that is named after the layer or sequence in its action. The key takes the new name, so that no other
/// target may have it.
fn rename_implied(draft: &mut Draft, action: &str, old: &str, new: &str) -> Result<(), EditError> {
    if !names_a_key(draft, action, old) {
        return Ok(());
    }
    if taken(draft).contains(new) {
        return Err(EditError::Name(new.to_owned()));
    }
    rename_mentions(draft, old, new)
}

/// Renames a sequence in the map, in the actions that start it, and where a key without a name of its own is mentioned by it.
fn rename_sequence(draft: &mut Draft, index: usize, name: &str) -> Result<(), EditError> {
    let key = sequence_key(draft.text(), draft.tree(), index);
    let key = key.ok_or(EditError::NoPart("sequence"))?;
    let sequences = draft.field(Part::Layout, "sequences");
    if sequences.is_some_and(|map| map.item(draft.text(), name).is_some()) {
        return Err(EditError::Name(name.to_owned()));
    }
    let part = Part::Sequence(index);
    if let Some(old) = name_of(draft.text(), draft.tree(), part) {
        rename_implied(draft, "Sequence", &old, name)?;
        rename_found(draft, name, |node, text, found| {
            collect_sequences(node, text, &old, found);
        });
    }
    draft.replace(key, quote(name));
    draft.commit()
}

/// Finds the mentions of a sequence in `Sequence("…")`.
fn collect_sequences(node: &Node, text: &str, name: &str, found: &mut Vec<Range<usize>>) {
    let is_action = node.name(text) == Some("Sequence");
    for item in node.items() {
        let value = item.value.in_some(text);
        if is_action && item.key.is_none() && quoted_content(value.text(text)) == Some(name) {
            found.push(value.range.clone());
        }
        collect_sequences(&item.value, text, name, found);
    }
}

/// Replaces what a search finds in the layout by another name.
fn rename_found(
    draft: &mut Draft,
    new: &str,
    search: impl FnOnce(&Node, &str, &mut Vec<Range<usize>>),
) {
    let mut found = Vec::new();
    search(draft.tree(), draft.text(), &mut found);
    for range in found {
        draft.replace(range, quote(new));
    }
}

/// Finds the mentions of a trigger in the steps of sequences.
fn collect_steps(node: &Node, text: &str, name: &str, found: &mut Vec<Range<usize>>) {
    let triggers = node.field(text, "triggers").map_or(&[][..], Node::items);
    for trigger in triggers {
        let when = trigger.value.in_some(text).field(text, "when");
        let steps = when.and_then(|when| when.field(text, "steps"));
        for step in steps.map_or(&[][..], Node::items) {
            if quoted_content(step.value.text(text)) == Some(name) {
                found.push(step.value.range.clone());
            }
        }
    }
}

/// Finds the mentions of a layer in `layer: "…"` of keys and holds, and in `Layer("…")` of other actions.
fn collect_layers(node: &Node, text: &str, name: &str, found: &mut Vec<Range<usize>>) {
    let is_layer_action = node.name(text) == Some("Layer");
    for item in node.items() {
        let key = item.key.as_ref().map(|key| &text[key.clone()]);
        let value = item.value.in_some(text);
        let is_mention = key == Some("layer") || (key.is_none() && is_layer_action);
        if is_mention && quoted_content(value.text(text)) == Some(name) {
            found.push(value.range.clone());
        }
        collect_layers(&item.value, text, name, found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editing::{Edit, NewPart, edit};
    use crate::layout::Layout;

    #[test]
    fn the_signals_of_a_control_follow_its_name() {
        let text = r#"Layout(
    name: "A",
    boards: [(
        pose: (anchor: elbow),
        sliders: [(name: "S", at_mm: (0, 60), length_mm: 40)],
        xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(60, 60))],
    )],
    signals: {"S": (control: 7), "P x": (control: 8), "P y": (control: 9)},
)"#;
        let renamed = |before: &str, kind: ControlKind, name: &str| {
            let rename = Edit::Rename {
                part: Part::control(0, kind, 0),
                name: name.into(),
            };
            edit(before, &rename).expect("a name that is free").text
        };
        let slider = renamed(text, ControlKind::Slider, "Level");
        let both = renamed(&slider, ControlKind::XyPad, "Filter");
        let expected = text
            .replace(r#""S""#, r#""Level""#)
            .replace(r#""P""#, r#""Filter""#)
            .replace(r#""P x""#, r#""Filter x""#)
            .replace(r#""P y""#, r#""Filter y""#);
        assert_eq!(both, expected);
        Layout::parse(&both, "a.ron").expect("its signals name controls");
    }

    #[test]
    fn a_board_gets_a_name_and_loses_it() {
        let text = r#"Layout(name: "A", boards: [(
    pose: (anchor: elbow),
    keys: [(code: "A", at_mm: (0, 0))],
)])"#;
        let named = |before: &str, name: &str| {
            let rename = Edit::Rename {
                part: Part::Board(0),
                name: name.into(),
            };
            edit(before, &rename).expect("a name").text
        };
        let pad = named(text, "A");
        let layout = Layout::parse(&pad, "a.ron").expect("a board with the name of its key");
        assert_eq!(layout.boards[0].name.as_deref(), Some("A"));
        assert_eq!(layout.keys[0].face.name, "A");
        let thumb = named(&pad, "Thumb");
        assert_eq!(
            thumb,
            pad.replace(
                r#"name: "A",
"#,
                r#"name: "Thumb",
"#
            )
            .replace(r#"Layout(name: "Thumb""#, r#"Layout(name: "A""#)
        );
        let removed = Edit::SetField {
            parts: vec![Part::Board(0)],
            field: "name".into(),
            value: None,
        };
        let unnamed = edit(&thumb, &removed).expect("no name is needed").text;
        assert_eq!(
            Layout::parse(&unnamed, "a.ron").unwrap().boards[0].name,
            None
        );
    }

    #[test]
    fn a_sequence_is_added_renamed_in_its_actions_and_its_steps_are_set() {
        let text = r#"Layout(
    name: "A",
    boards: [(pose: (anchor: elbow), keys: [
        (action: Sequence("copy"), at_mm: (0, 0)),
        (action: Text("copy"), name: "text", at_mm: (40, 0)),
    ])],
    labels: {"copy": "C"},
    sequences: {
        "copy": [Tap("Home"), Wait(500)], // mine
    },
)"#;
        let part = Part::Sequence(0);
        let rename = Edit::Rename {
            part,
            name: "new".into(),
        };
        let renamed = edit(text, &rename).expect("a name that is free").text;
        let expected = text
            .replace(r#"Sequence("copy")"#, r#"Sequence("new")"#)
            .replace(r#"{"copy": "C"}"#, r#"{"new": "C"}"#)
            .replace(r#""copy": ["#, r#""new": ["#);
        assert_eq!(renamed, expected);
        let with_step = |before: &str, field: &str, value: Option<&str>| {
            let set = Edit::SetField {
                parts: vec![part],
                field: field.into(),
                value: value.map(str::to_owned),
            };
            edit(before, &set).expect("a step").text
        };
        let added = with_step(&renamed, "2", Some(r#"Text("x")"#));
        assert_eq!(
            added,
            renamed.replace("Wait(500)", r#"Wait(500), Text("x")"#)
        );
        let removed = with_step(&added, "0", None);
        assert_eq!(removed, added.replace(r#"Tap("Home"), "#, ""));
        let replaced = with_step(&removed, "0", Some("Wait(20)"));
        assert_eq!(replaced, removed.replace("500", "20"));
        let two = edit(&replaced, &Edit::Add(NewPart::Sequence)).expect("a sequence");
        assert_eq!(two.parts, [Part::Sequence(1)]);
        Layout::parse(&two.text, "a.ron").unwrap();
        let taken = Edit::Rename {
            part: two.parts[0],
            name: "new".into(),
        };
        assert!(edit(&two.text, &taken).is_err());
        let without = text.replace("sequences", "// sequences");
        let without = without
            .replace("        \"copy\": [Tap", "// [Tap")
            .replace("    },\n)", ")");
        let one = edit(&without, &Edit::Add(NewPart::Sequence)).expect("a sequence");
        assert!(
            one.text
                .contains(r#"sequences: {"sequence": [Tap("Enter")]}"#),
            "{}",
            one.text
        );
    }

    #[test]
    fn a_layer_does_not_get_the_name_of_another_one() {
        let text = r#"Layout(
    name: "A",
    boards: [(pose: (anchor: elbow), keys: [
        (layer: "x", at_mm: (0, 0)),
        (layer: "y", at_mm: (40, 0)),
    ])],
    labels: {"x": "Symbols"},
    layers: [(name: "x", keys: {}), (name: "y", keys: {})],
)"#;
        let renamed = |name: &str| {
            let rename = Edit::Rename {
                part: Part::Layer(0),
                name: name.into(),
            };
            edit(text, &rename).map(|edited| edited.text)
        };
        for other in ["y", "base"] {
            assert_eq!(renamed(other), Err(EditError::Name(other.into())));
        }
        // A key without a name of its own is named after its layer, and its label mentions it by that name.
        let expected = text.replace("\"x\"", "\"z\"");
        Layout::parse(&expected, "a.ron").expect("a label of a key");
        assert_eq!(renamed("z"), Ok(expected));
    }

    #[test]
    fn a_layer_or_sequence_that_names_a_key_does_not_get_the_name_of_another_key() {
        let text = r#"Layout(
    name: "A",
    boards: [(pose: (anchor: elbow), keys: [
        (layer: "x", at_mm: (0, 0)),
        (action: Sequence("copy"), at_mm: (40, 0)),
        (code: "A", at_mm: (80, 0)),
    ])],
    layers: [(name: "x", keys: {})],
    sequences: {"copy": [Tap("Home")]},
)"#;
        for part in [Part::Layer(0), Part::Sequence(0)] {
            let renamed = |before: &str| {
                let rename = Edit::Rename {
                    part,
                    name: "A".into(),
                };
                edit(before, &rename).map(|edited| edited.text)
            };
            assert_eq!(renamed(text), Err(EditError::Name("A".into())));
            // A key with a name of its own does not take the new one.
            let named = text.replace(", at_mm: (0, 0)", r#", name: "L", at_mm: (0, 0)"#);
            let named = named.replace(", at_mm: (40, 0)", r#", name: "C", at_mm: (40, 0)"#);
            let after = renamed(&named).expect("a name that no key has");
            Layout::parse(&after, "a.ron").unwrap_or_else(|error| panic!("{error}"));
        }
    }

    #[test]
    fn the_steps_of_sequences_have_the_name_of_a_trigger_that_is_renamed() {
        let text = r#"Layout(name: "A", triggers: [
            (name: "A", when: Shake()),
            (name: "B", when: HandShape(name: "fist")),
            (name: "C", when: Sequence(steps: ["A", "B", "A"])),
        ])"#;
        let rename = Edit::Rename {
            part: Part::Trigger(0),
            name: "New".into(),
        };
        let renamed = edit(text, &rename).expect("a name that is free");
        let expected = text.replace(r#"name: "A", when"#, r#"name: "New", when"#);
        let expected = expected.replace(r#""A", "B", "A""#, r#""New", "B", "New""#);
        assert_eq!(renamed.text, expected);
    }
}
