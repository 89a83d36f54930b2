//! Changes names, and every mention of them.

use std::ops::Range;

use super::draft::Draft;
use super::error::EditError;
use super::geometry::unsupported;
use super::names::{name_of, rename_mentions, taken};
use super::part::{ControlKind, Part};
use super::rows::take_out;
use crate::document::{Node, quote, quoted_content};

/// Changes the name of a part.
pub(super) fn rename(draft: &mut Draft, part: Part, name: &str) -> Result<Vec<Part>, EditError> {
    let is_target = !matches!(part, Part::Layout | Part::Layer(_));
    let is_named = matches!(
        part,
        Part::Layout
            | Part::RowKey { .. }
            | Part::Control { .. }
            | Part::RadioOption { .. }
            | Part::Trigger(_)
            | Part::SpaceTarget { .. }
            | Part::Layer(_)
    );
    if !is_named {
        return Err(unsupported(part, "given a name", ""));
    }
    let old = name_of(draft.text(), draft.tree(), part);
    if old.as_deref() == Some(name) {
        return Ok(vec![part]);
    }
    let is_taken = is_target && taken(draft).contains(name);
    if name.trim().is_empty() || name.chars().any(char::is_control) || is_taken {
        return Err(EditError::Name(name.to_owned()));
    }
    let parts = take_out(draft, &[part], false)?;
    let taken = parts[0];
    if let Some(old) = old {
        match taken {
            Part::Control {
                kind: ControlKind::Key,
                ..
            } => rename_mentions(draft, &old, name)?,
            Part::Layer(_) => rename_found(draft, name, |node, text, found| {
                collect_layers(node, text, &old, found);
            }),
            Part::Trigger(_) => rename_found(draft, name, |node, text, found| {
                collect_steps(node, text, &old, found);
            }),
            Part::RadioOption { board, radio, .. } => {
                let group = Part::Control {
                    board,
                    kind: ControlKind::Radio,
                    index: radio,
                };
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
    use crate::editing::{Edit, edit};

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
