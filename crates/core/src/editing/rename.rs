//! Changes names, and every mention of them.

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
    let part = parts[0];
    if let Some(old) = old {
        match part {
            Part::Control {
                kind: ControlKind::Key,
                ..
            } => rename_mentions(draft, &old, name)?,
            Part::Layer(_) => rename_layer(draft, &old, name),
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
    draft.set(part, "name", &quote(name))?;
    draft.commit()?;
    Ok(parts)
}

/// Renames a layer in `layer: "…"` of keys and holds, and in `Layer("…")` of other actions.
fn rename_layer(draft: &mut Draft, old: &str, new: &str) {
    let mut found = Vec::new();
    collect_layers(draft.tree(), draft.text(), old, &mut found);
    for range in found {
        draft.replace(range, quote(new));
    }
}

fn collect_layers(node: &Node, text: &str, name: &str, found: &mut Vec<std::ops::Range<usize>>) {
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
