//! Actions of parts.

use std::collections::BTreeSet;

use super::draft::Draft;
use super::error::EditError;
use super::geometry::unsupported;
use super::names::{canonical, name_of, rename_mentions, taken};
use super::part::{ControlKind, Part, words};
use super::rows::take_out;
use crate::device::KeyCode;
use crate::document::{quote, quoted_content};

/// An action as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Binding {
    /// Presses a key or button, by the name of its code.
    Key(String),
    /// Activates a layer.
    Layer(String),
    /// Types a text.
    Text(String),
    /// Starts a sequence.
    Sequence(String),
    /// Issues a command.
    Command(String),
    /// Holds the pointer still.
    Clutch,
    /// Slows the pointer down.
    Precision,
    /// No action of its own, for keys of chords.
    NoOp,
}

/// The action of a part that is set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Slot {
    /// The action of a key.
    Base,
    /// The key code of a key in a layer, by the index of the layer in the file.
    Layer(usize),
    /// The action of a key that is held.
    Hold,
    /// A field with an action: `hold` and `tap` of switches, `push_action` and `direction_keys.up` of joysticks, `action` of
    /// triggers, chords and targets in space.
    Field(String),
}

impl Binding {
    /// Returns the action as RON text.
    pub fn to_ron(&self) -> String {
        match self {
            Self::Key(code) => format!("Key({})", quote(code)),
            Self::Layer(name) => format!("Layer({})", quote(name)),
            Self::Text(text) => format!("Text({})", quote(text)),
            Self::Sequence(name) => format!("Sequence({})", quote(name)),
            Self::Command(command) => format!("Command({})", quote(command)),
            Self::Clutch => "Clutch".into(),
            Self::Precision => "Precision".into(),
            Self::NoOp => "NoOp".into(),
        }
    }

    /// Returns the field of a key that has this action.
    pub(super) fn to_field(&self) -> (&'static str, String) {
        match self {
            Self::Key(code) => ("code", quote(code)),
            Self::Layer(name) => ("layer", quote(name)),
            other => ("action", other.to_ron()),
        }
    }

    /// Returns the name of a key with this action and without a name of its own.
    pub(super) fn implied_name(&self) -> Option<String> {
        match self {
            Self::Key(code) => Some(canonical(code)),
            Self::Layer(text) | Self::Text(text) | Self::Sequence(text) | Self::Command(text) => {
                Some(text.clone())
            }
            Self::Clutch | Self::Precision | Self::NoOp => None,
        }
    }

    fn can_latch(&self) -> bool {
        match self {
            Self::Key(code) => code.parse().is_ok_and(KeyCode::is_modifier),
            Self::Layer(_) => true,
            _ => false,
        }
    }
}

/// Sets or removes an action.
pub(super) fn bind(
    draft: &mut Draft,
    part: Part,
    slot: &Slot,
    binding: Option<&Binding>,
) -> Result<Vec<Part>, EditError> {
    match (slot, binding) {
        (Slot::Layer(layer), _) => bind_in_layer(draft, part, *layer, binding),
        (Slot::Field(field), Some(binding)) => {
            let parts = take_out(draft, &[part], false)?;
            draft.set(parts[0], field, &binding.to_ron())?;
            Ok(parts)
        }
        (Slot::Field(field), None) => {
            draft.unset(part, field)?;
            Ok(vec![part])
        }
        (Slot::Hold, _) => bind_hold(draft, part, binding),
        (Slot::Base, None) => bind_base(draft, part, &Binding::NoOp),
        (Slot::Base, Some(binding)) => bind_base(draft, part, binding),
    }
}

fn bind_hold(
    draft: &mut Draft,
    part: Part,
    binding: Option<&Binding>,
) -> Result<Vec<Part>, EditError> {
    let parts = take_out(draft, &[part], false)?;
    let key_part = require_key(parts[0])?;
    match binding {
        None => {
            draft.unset(key_part, "hold")?;
            draft.unset(key_part, "hold_after_ms")?;
        }
        Some(binding @ (Binding::Key(_) | Binding::Layer(_))) => {
            let (field, value) = binding.to_field();
            draft.set(key_part, "hold", &format!("({field}: {value})"))?;
        }
        Some(_) => {
            let message = "a held key presses a key or activates a layer; choose one of them";
            return Err(EditError::Selection(message));
        }
    }
    draft.commit()?;
    Ok(parts)
}

fn bind_base(draft: &mut Draft, part: Part, binding: &Binding) -> Result<Vec<Part>, EditError> {
    let old = name_of(draft.text(), draft.tree(), part).ok_or(EditError::NoPart("key"))?;
    let new = binding.implied_name();
    let is_free = |name: &String| *name == old || !taken(draft).contains(name);
    let is_key = matches!(binding, Binding::Key(_));
    let new = new.filter(|name| is_key && is_free(name));
    if let (Part::RowKey { column, .. }, Some(new), Binding::Key(code)) = (part, &new, binding) {
        let keys = draft.field(part, "keys").ok_or(EditError::NoPart("key"))?;
        let word = words(draft.text(), keys).get(column).cloned();
        draft.replace(word.ok_or(EditError::NoPart("key"))?, code.as_str());
        rename_mentions(draft, &old, new)?;
        draft.commit()?;
        return Ok(vec![part]);
    }
    let parts = take_out(draft, &[part], false)?;
    let key_part = require_key(parts[0])?;
    let is_numbered_copy = is_numbered_copy(draft, key_part, &old);
    set_action(draft, key_part, binding)?;
    let is_implied = draft.field(key_part, "name").is_none();
    if is_implied || is_numbered_copy {
        match new {
            Some(new) if !is_implied => {
                draft.unset(key_part, "name")?;
                rename_mentions(draft, &old, &new)?;
            }
            Some(new) if new == old => {}
            Some(new) => rename_mentions(draft, &old, &new)?,
            None if is_implied => draft.set(key_part, "name", &quote(&old))?,
            None => {}
        }
    }
    draft.commit()?;
    Ok(parts)
}

/// Returns `true` if the name of a key is one that a copy of another key got: the key code and a number.
fn is_numbered_copy(draft: &Draft, part: Part, name: &str) -> bool {
    let code = draft.field(part, "code").map(|code| code.range.clone());
    let code = code.and_then(|range| quoted_content(&draft.text()[range]));
    let number = code.and_then(|code| name.strip_prefix(&canonical(code))?.strip_prefix(' '));
    number.is_some_and(|number| number.parse::<u32>().is_ok())
}

/// Replaces the field with the action of a key.
fn set_action(draft: &mut Draft, part: Part, binding: &Binding) -> Result<(), EditError> {
    let (field, value) = binding.to_field();
    let text = draft.text();
    let fields = ["code", "layer", "action"];
    let items = draft.node(part)?.items().iter();
    let is_action = |item: &&crate::document::Item| {
        item.key
            .as_ref()
            .is_some_and(|key| fields.contains(&&text[key.clone()]))
    };
    let range = items.clone().find(is_action).map(|item| {
        let key = item
            .key
            .as_ref()
            .map_or(item.value.range.start, |key| key.start);
        key..item.value.range.end
    });
    match range {
        Some(range) => draft.replace(range, format!("{field}: {value}")),
        None => draft.set(part, field, &value)?,
    }
    if !binding.can_latch() {
        draft.unset(part, "latch")?;
    }
    Ok(())
}

fn bind_in_layer(
    draft: &mut Draft,
    part: Part,
    layer: usize,
    binding: Option<&Binding>,
) -> Result<Vec<Part>, EditError> {
    require_key(part)?;
    let name = name_of(draft.text(), draft.tree(), part).ok_or(EditError::NoPart("key"))?;
    let layer = Part::Layer(layer);
    let text = draft.text();
    let map = draft
        .field(layer, "keys")
        .ok_or(EditError::NoPart("layer"))?
        .clone();
    let entry = map.items().iter().position(|item| {
        let key = item
            .key
            .as_ref()
            .and_then(|key| quoted_content(&text[key.clone()]));
        key.is_some_and(|key| key == name || canonical(key) == name)
    });
    match (entry, binding) {
        (Some(index), Some(Binding::Key(code))) => {
            let range = map.items()[index].value.in_some(text).range.clone();
            draft.replace(range, quote(code));
        }
        (None, Some(Binding::Key(code))) => {
            let new_entry = format!("{}: {}", quote(&name), quote(code));
            draft.push_entry(&map, &new_entry);
        }
        (Some(index), None) => draft.remove(&map, index),
        (None, None) => {}
        (_, Some(_)) => {
            let message = "in a layer a key can only press another key; choose a key, or bind it in the base layer";
            return Err(EditError::Selection(message));
        }
    }
    draft.commit()?;
    Ok(vec![part])
}

fn require_key(part: Part) -> Result<Part, EditError> {
    match part {
        Part::RowKey { .. }
        | Part::Control {
            kind: ControlKind::Key,
            ..
        } => Ok(part),
        _ => Err(unsupported(
            part,
            "bound as a key is",
            "; set one of its fields",
        )),
    }
}

/// Returns the first key code that no target is named after.
pub(super) fn free_code(taken: &BTreeSet<String>) -> Option<&'static str> {
    KeyCode::all()
        .map(KeyCode::name)
        .find(|name| !taken.contains(*name))
}
