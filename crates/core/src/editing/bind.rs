//! Actions of parts.

use std::collections::BTreeSet;

use super::draft::Draft;
use super::error::EditError;
use super::geometry::unsupported;
use super::names::{
    can_be_mentioned, canonical, implied_name, is_numbered, name_of, rename_mentions, taken, unique,
};
use super::part::{Part, words};
use super::rows::take_out;
use crate::device::KeyCode;
use crate::document::{quote, quoted_content};
use crate::layout::is_multitap;

/// An action as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Binding {
    /// Presses a key or button, by the name of its code.
    Key(String),
    /// Activates a layer.
    Layer(String),
    /// Types a text.
    Text(String),
    /// Types one of several letters, which blanks separate.
    Multitap(String),
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
    /// The action of a key in a layer, by the index of the layer in the file.
    Layer(usize),
    /// The action of a key that is held.
    Hold,
    /// A field with an action: `hold` and `tap` of switches, `push_action` and `direction_keys.up` of joysticks, `action` of
    /// triggers, chords and targets in space.
    Field(String),
}

impl Binding {
    /// Returns the multitap key with these letters, or `None` if they are not a list of letters.
    pub fn multitap(letters: &str) -> Option<Self> {
        is_multitap(letters).then(|| Self::Multitap(letters.to_owned()))
    }

    /// Returns the action as RON text.
    pub fn to_ron(&self) -> String {
        match self {
            Self::Key(code) => format!("Key({})", quote(code)),
            Self::Layer(name) => format!("Layer({})", quote(name)),
            Self::Text(text) => format!("Text({})", quote(text)),
            Self::Multitap(letters) => format!("Multitap({})", quote(letters)),
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
            Self::Layer(text)
            | Self::Text(text)
            | Self::Multitap(text)
            | Self::Sequence(text)
            | Self::Command(text) => Some(text.clone()),
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
        // It has no held action, for which it would have to leave its row.
        (Slot::Hold, None) if matches!(part, Part::RowKey { .. }) => Ok(vec![part]),
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
    let implied = new.clone();
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
    if !binding.can_latch() {
        draft.unset(key_part, "latch")?;
        // A name that is added at the end must not be within the lines of the latch.
        draft.commit()?;
    }
    let is_numbered_copy = is_numbered_copy(draft, key_part, &old);
    set_action(draft, key_part, binding)?;
    let is_implied = draft.field(key_part, "name").is_none();
    match new {
        _ if is_numbered_copy => name_after_action(draft, key_part, &old, implied)?,
        Some(new) if is_implied && new != old => rename_mentions(draft, &old, &new)?,
        None if is_implied && is_key => draft.set(key_part, "name", &quote(&old))?,
        None if is_implied => name_after_action(draft, key_part, &old, implied)?,
        _ => {}
    }
    draft.commit()?;
    Ok(parts)
}

/// Names a key after its new action, with a number if the name is taken. The key has the name of its old action or of a copy, and
/// keeps it if the new action has no name, or if chords mention the old name and cannot mention the new one.
fn name_after_action(
    draft: &mut Draft,
    key: Part,
    old: &str,
    implied: Option<String>,
) -> Result<(), EditError> {
    let implied = implied.filter(|name| !name.trim().is_empty());
    let mut names = taken(draft);
    names.remove(old);
    let new = implied.as_ref().map(|name| unique(&mut names, name));
    let is_usable = |name: &String| name == old || can_be_mentioned(draft, old, name);
    let new = new.filter(is_usable).unwrap_or_else(|| old.to_owned());
    if implied.as_ref() == Some(&new) {
        draft.unset(key, "name")?;
    } else {
        draft.set(key, "name", &quote(&new))?;
    }
    if new == old {
        return Ok(());
    }
    rename_mentions(draft, old, &new)
}

/// Returns `true` if the name of a key is one that a copy of another key got: the name in its action and a number.
fn is_numbered_copy(draft: &Draft, key: Part, name: &str) -> bool {
    let node = draft.node(key).ok();
    let implied = node.and_then(|node| implied_name(draft.text(), node));
    implied.is_some_and(|implied| is_numbered(name, &implied))
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
    draft.node(layer)?;
    let is_code = matches!(binding, Some(Binding::Key(_)));
    for (field, is_own) in [("keys", is_code), ("actions", !is_code)] {
        let value = binding.filter(|_| is_own).map(|binding| match binding {
            Binding::Key(code) => quote(code),
            other => other.to_ron(),
        });
        set_entry(draft, layer, field, &name, value)?;
    }
    draft.commit()?;
    Ok(vec![part])
}

/// Sets the value of a key in a map of a layer, or removes it.
fn set_entry(
    draft: &mut Draft,
    layer: Part,
    field: &str,
    name: &str,
    value: Option<String>,
) -> Result<(), EditError> {
    let text = draft.text();
    let Some(map) = draft.field(layer, field).cloned() else {
        let entry = value.map(|value| format!("{{{}: {value}}}", quote(name)));
        return entry.map_or(Ok(()), |entry| draft.set(layer, field, &entry));
    };
    let index = map.items().iter().position(|item| {
        let key = item.key.as_ref();
        let key = key.and_then(|key| quoted_content(&text[key.clone()]));
        key.is_some_and(|key| key == name || canonical(key) == name)
    });
    match (index, value) {
        (Some(index), Some(value)) => {
            let range = map.items()[index].value.in_some(text).range.clone();
            draft.replace(range, value);
        }
        (None, Some(value)) => draft.push_entry(&map, &format!("{}: {value}", quote(name))),
        (Some(index), None) => draft.remove(&map, index),
        (None, None) => {}
    }
    Ok(())
}

fn require_key(part: Part) -> Result<Part, EditError> {
    if part.is_key() {
        return Ok(part);
    }
    let advice = "; set one of its fields";
    Err(unsupported(part, "bound like a key", advice))
}

/// Returns the first key code that no target is named after.
pub(super) fn free_code(taken: &BTreeSet<String>) -> Option<&'static str> {
    KeyCode::all()
        .map(KeyCode::name)
        .find(|name| !taken.contains(*name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editing::{ControlKind, Edit, edit};
    use crate::layout::Layout;

    #[test]
    fn a_key_has_any_action_in_a_layer_in_one_of_its_maps() {
        let mut text = r#"Layout(
    name: "A",
    boards: [(pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: "Q W")])],
    layers: [(name: "x", keys: {"KeyQ": "1"})],
)"#
        .to_owned();
        let mut bind = |column: usize, binding: Option<Binding>| {
            let bound = edit(
                &text,
                &Edit::Bind {
                    part: Part::RowKey {
                        board: 0,
                        row: 0,
                        column,
                    },
                    slot: Slot::Layer(0),
                    binding,
                },
            );
            text = bound.expect("a key and a layer").text;
            Layout::parse(&text, "a.ron").expect("a layout");
            let layer = text.lines().find(|line| line.contains("layers")).unwrap();
            layer.trim().to_owned()
        };
        let multitap = || Binding::multitap("Period ñ 2");
        let steps = [
            (
                (0, multitap()),
                r#"keys: {}, actions: {"Q": Multitap("Period ñ 2")}"#,
            ),
            (
                (1, Some(Binding::Text("¿".into()))),
                r#"keys: {}, actions: {"Q": Multitap("Period ñ 2"), "W": Text("¿")}"#,
            ),
            (
                (1, multitap()),
                r#"keys: {}, actions: {"Q": Multitap("Period ñ 2"), "W": Multitap("Period ñ 2")}"#,
            ),
            (
                (0, Some(Binding::Key("2".into()))),
                r#"keys: {"Q": "2"}, actions: {"W": Multitap("Period ñ 2")}"#,
            ),
            ((1, None), r#"keys: {"Q": "2"}, actions: {}"#),
        ];
        for ((column, binding), expected) in steps {
            let layers = bind(column, binding);
            assert_eq!(layers, format!("layers: [(name: \"x\", {expected})],"));
        }
    }

    /// Copies the only key, binds the copy, and returns the keys.
    fn bound_copy(key: &str, binding: &Binding) -> String {
        let text = format!(
            "Layout(name: \"a\", boards: [(pose: (anchor: elbow), keys: [({key}, at_mm: (0, 0))])])"
        );
        let part = |index| Part::control(0, ControlKind::Key, index);
        let copied = edit(
            &text,
            &Edit::Duplicate {
                parts: vec![part(0)],
                by_mm: [40.0, 0.0],
            },
        );
        let bind = Edit::Bind {
            part: part(1),
            slot: Slot::Base,
            binding: Some(binding.clone()),
        };
        let bound = edit(&copied.unwrap().text, &bind).unwrap().text;
        Layout::parse(&bound, "a.ron").unwrap_or_else(|error| panic!("{bound}: {error}"));
        bound.rsplit_once("keys: [").unwrap().1.to_owned()
    }

    #[test]
    fn a_copy_that_is_bound_is_named_after_its_action() {
        let multitap = |letters: &str| Binding::multitap(letters).unwrap();
        for (key, binding, expected) in [
            ("code: \"Escape\"", multitap("A B C 2"), ""),
            ("code: \"Escape\"", Binding::Text("hello".into()), ""),
            ("code: \"Escape\"", Binding::Key("B".into()), ""),
            (
                "code: \"Escape\"",
                Binding::Key("Escape".into()),
                "Escape 2",
            ),
            ("code: \"Escape\"", Binding::Clutch, "Escape 2"),
            ("action: Multitap(\"A B C 2\")", multitap("D E F 3"), ""),
            (
                "action: Multitap(\"A B C 2\")",
                multitap("A B C 2"),
                "A B C 2 2",
            ),
            ("code: \"A\", name: \"B\"", Binding::Key("B".into()), "B 2"),
        ] {
            let keys = bound_copy(key, &binding);
            let (_, copy) = keys.split_once("), (").unwrap();
            let name = copy.split_once("name: \"").map(|(_, rest)| rest);
            let name = name.and_then(|rest| rest.split('"').next());
            assert_eq!(name.unwrap_or_default(), expected, "{binding:?}: {keys}");
        }
    }

    #[test]
    fn a_name_from_the_old_action_goes_with_it_and_one_of_its_own_stays() {
        let multitap = || Binding::multitap("Period Comma 1").unwrap();
        let typing = |typed: &str| Binding::Text(typed.into());
        for (key, chords, binding, expected) in [
            ("code: \"Escape\"", "", multitap(), None),
            ("code: \"Escape\"", "", typing("hi"), None),
            ("code: \"Escape\"", "", Binding::Clutch, Some("Escape")),
            ("code: \"Escape\"", "Escape B", multitap(), Some("Escape")),
            ("code: \"Escape\"", "Escape B", typing("\""), Some("Escape")),
            ("code: \"Escape\"", "Escape B", typing("\\"), Some("Escape")),
            (
                "code: \"Escape\"",
                "",
                Binding::Text("B".into()),
                Some("B 2"),
            ),
            ("code: \"Escape\", name: \"x\"", "", multitap(), Some("x")),
            ("action: Multitap(\"A C\")", "", multitap(), None),
        ] {
            let chord = match chords {
                "" => String::new(),
                keys => format!("(keys: \"{keys}\", action: Key(\"Tab\"))"),
            };
            let text = format!(
                "Layout(name: \"a\", boards: [(pose: (anchor: elbow), keys: [({key}, at_mm: (0, 0)), (code: \"B\", \
                 at_mm: (40, 0))])], chords: [{chord}])"
            );
            let part = Part::control(0, ControlKind::Key, 0);
            let bind = Edit::Bind {
                part,
                slot: Slot::Base,
                binding: Some(binding.clone()),
            };
            let bound = edit(&text, &bind).unwrap().text;
            Layout::parse(&bound, "a.ron").unwrap_or_else(|error| panic!("{bound}: {error}"));
            let name = bound.split_once("name: \"a\"").unwrap().1;
            let name = name.split_once("name: \"").map(|(_, rest)| rest);
            let name = name.and_then(|rest| rest.split('"').next());
            assert_eq!(name, expected, "{binding:?}: {bound}");
        }
    }

    #[test]
    fn letters_are_words_that_each_type_a_character() {
        for letters in ["A B C 2", "Period ñ ¿"] {
            let expected = Some(Binding::Multitap(letters.to_owned()));
            assert_eq!(Binding::multitap(letters), expected);
        }
        for letters in ["", "A", "hello you", "A Enter", "A B C D E F G H I J K L M"] {
            assert_eq!(Binding::multitap(letters), None, "{letters}");
        }
    }
}
