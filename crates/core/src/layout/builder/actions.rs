//! Actions of presses: resolves key codes, layers, texts and commands.

use super::LayoutBuilder;
use crate::command::{Command, InvalidCommand};
use crate::device::{KeyAction, KeyCode, Latch, Multitap, MultitapId, SequenceId, TextId};
use crate::document::{DocumentError, Spanned};
use crate::layout::model::action_label;
use crate::layout::multitap::build_multitap;
use crate::layout::schema::{Action, LatchSchema};
use crate::names::UnknownName;

/// The maximum length of a text that a key types, in characters.
const MAX_TEXT_LENGTH: usize = 32;

/// The maximum number of letters that are taken for a row of keys without blanks between them.
const MAX_KEYS_WITHOUT_BLANKS: usize = 16;

impl<'a> LayoutBuilder<'a> {
    /// Returns the action of a press. `latch` is allowed for modifiers and layers only.
    pub fn action(
        &mut self,
        action: Action<'a>,
        latch: Option<LatchSchema>,
    ) -> Result<KeyAction, DocumentError> {
        let source = action.argument().unwrap_or(self.name).text;
        let action = match action {
            Action::Key(code) => return self.key_action(code, latch),
            Action::Layer(layer) => return self.layer_action(layer, latch),
            Action::Text(text) => KeyAction::Text(self.text_id(text)?),
            Action::Multitap(letters) => KeyAction::Multitap(build_multitap(self, letters)?),
            Action::Sequence(name) => KeyAction::Sequence(self.named_sequence(name)?),
            Action::Command(command) => KeyAction::Command(self.command(command)?),
            Action::Clutch => KeyAction::Clutch,
            Action::Precision => KeyAction::Precision,
            Action::NoOp => {
                let message = "only a key that takes part in a chord can have the action `NoOp`";
                return Err(self.error(source, message));
            }
        };
        match latch {
            None => Ok(action),
            Some(_) => Err(self.error(source, "only modifiers and layers can have a latch")),
        }
    }

    /// Returns the action of a key code.
    pub fn key_action(
        &self,
        code: Spanned<'a>,
        latch: Option<LatchSchema>,
    ) -> Result<KeyAction, DocumentError> {
        let source = code.text;
        let code = self.key_code(code)?;
        match latch {
            _ if code.is_modifier() => Ok(KeyAction::Modifier(code, checked_latch(latch))),
            None => Ok(KeyAction::Key(code)),
            Some(_) => {
                let message =
                    format!("`{code}` cannot have a latch, only modifiers and layers can");
                Err(self.error(source, message))
            }
        }
    }

    /// Parses a key code.
    pub fn key_code(&self, code: Spanned) -> Result<KeyCode, DocumentError> {
        let code = code.text;
        code.parse().map_err(|error: UnknownName| {
            let has_comma = code.len() > 1 && code.contains(',');
            if has_comma {
                let message =
                    format!("`{code}` is not a key: keys are separated by blanks, not by commas");
                self.error(code, message)
            } else if let Some(keys) = combination(code) {
                let meant = joined_name(code)
                    .map(|key| format!("; the key is called `{key}`"))
                    .unwrap_or_default();
                let message = format!(
                    "`{code}` is a combination of keys, not a key: \
                     `sequences: {{\"NAME\": [Tap(\"{keys}\")]}}` presses it, \
                     and a key with `action: Sequence(\"NAME\")` starts it{meant}"
                );
                self.error(code, message)
            } else if error.nearest.is_none() {
                let meant = meant_text(code).unwrap_or_default();
                let message = format!("{error}{meant}; `ademan layout keys` lists all keys");
                self.error(code, message)
            } else {
                self.error(code, error)
            }
        })
    }

    /// Returns the default label of a key: the label of its action, or its name if it has no action.
    pub fn default_label(&self, action: Option<KeyAction>, name: &str) -> String {
        let label = action.map_or(name, |action| {
            let (sequences, multitaps) = (&self.sequences, &self.multitaps);
            action_label(action, &self.layers, &self.texts, sequences, multitaps)
        });
        label.to_owned()
    }

    fn layer_action(
        &mut self,
        name: Spanned<'a>,
        latch: Option<LatchSchema>,
    ) -> Result<KeyAction, DocumentError> {
        let name = name.text;
        let Some(layer) = self.layers.iter().position(|layer| layer == name) else {
            let names = self.layers.iter().map(String::as_str);
            return Err(self.error(name, UnknownName::new("layer", name, names)));
        };
        self.activated_layers.insert(layer);
        Ok(KeyAction::Layer(layer, checked_latch(latch)))
    }

    /// Adds the letters of a multitap key, which are written at `source`.
    pub fn add_multitap(
        &mut self,
        multitap: Multitap,
        source: &str,
    ) -> Result<MultitapId, DocumentError> {
        let index = self.multitaps.len();
        let index = self.checked_index(index, source, "multitap keys in all layers")?;
        self.multitaps.push(multitap);
        Ok(MultitapId(index))
    }

    /// Returns an index as the actions of keys keep it.
    fn checked_index(&self, index: usize, source: &str, what: &str) -> Result<u16, DocumentError> {
        index.try_into().map_err(|_| {
            let count = usize::from(u16::MAX) + 1;
            self.error(source, format!("a layout has at most {count} {what}"))
        })
    }

    /// Returns the sequence with this name.
    pub fn sequence_id(&self, name: &str) -> Option<SequenceId> {
        let index = self.sequences.iter().position(|it| it.name == name)?;
        Some(SequenceId(index as u16))
    }

    fn named_sequence(&self, name: Spanned<'a>) -> Result<SequenceId, DocumentError> {
        self.sequence_id(name.text).ok_or_else(|| {
            let names = self.sequences.iter().map(|sequence| sequence.name.as_str());
            self.error(name.text, UnknownName::new("sequence", name.text, names))
        })
    }

    /// Returns the id of a text that a key or a sequence types.
    pub fn text_id(&mut self, text: Spanned<'a>) -> Result<TextId, DocumentError> {
        let text = text.text;
        let length = text.chars().count();
        if length > MAX_TEXT_LENGTH {
            let message = format!("a key types at most {MAX_TEXT_LENGTH} characters, not {length}");
            return Err(self.error(text, message));
        }
        let index = index_of_or_push(&mut self.texts, text);
        let index = self.checked_index(index, text, "different texts")?;
        Ok(TextId(index))
    }

    /// Parses a command. Records the name of a profile, because only the setup knows if it exists, and a command of the text decoder,
    /// because the setup adds one for it. Fails for a command that has no effect from a layout.
    fn command(&mut self, command: Spanned<'a>) -> Result<Command, DocumentError> {
        let parsed = command.text.parse::<Command>();
        let parsed = parsed.map_err(|error: InvalidCommand| self.error(command.text, error))?;
        if !parsed.is_allowed_in_layouts() {
            let name = parsed.name();
            let message = format!("a layout cannot issue `{name}`, only `ademan ctl {name}` does");
            return Err(self.error(command.text, message));
        }
        if let Command::Profile { name } = &parsed {
            index_of_or_push(&mut self.profiles, name);
        }
        self.has_text_commands |=
            matches!(parsed, Command::Text { .. } | Command::Candidate { .. });
        Ok(parsed)
    }
}

/// Returns the index of `text` in the list, to which it is appended if it is new.
fn index_of_or_push(list: &mut Vec<String>, text: &str) -> usize {
    let index = list.iter().position(|other| other == text);
    index.unwrap_or_else(|| {
        list.push(text.to_owned());
        list.len() - 1
    })
}

/// Returns the keys of a combination such as `Ctrl+V`, separated by blanks. `None` if `text` is no combination of keys.
fn combination(text: &str) -> Option<String> {
    let parts = text.split(['+', '-', ' ']);
    let keys: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    let are_keys = keys.iter().all(|key| key.parse::<KeyCode>().is_ok());
    (keys.len() > 1 && are_keys).then(|| keys.join(" "))
}

/// Returns the key whose name is `text` without blanks and hyphens, such as `Shift-Left`.
fn joined_name(text: &str) -> Option<KeyCode> {
    text.replace([' ', '-'], "").parse().ok()
}

/// Returns what to write in place of a text that no key is called, if it is a character or consists of letters or digits.
fn meant_text(text: &str) -> Option<String> {
    let characters: Vec<String> = text.chars().map(String::from).collect();
    if characters.len() == 1 {
        return Some(format!("; `action: Text(\"{text}\")` types this character"));
    }
    let kinds: [fn(&char) -> bool; 3] = [
        char::is_ascii_uppercase,
        char::is_ascii_lowercase,
        char::is_ascii_digit,
    ];
    let are_keys = kinds
        .iter()
        .any(|is_of_kind| text.chars().all(|it| is_of_kind(&it)));
    (are_keys && characters.len() <= MAX_KEYS_WITHOUT_BLANKS).then(|| {
        let keys = characters.join(" ");
        format!("; keys are separated by blanks, as in `{keys}`")
    })
}

fn checked_latch(latch: Option<LatchSchema>) -> Latch {
    match latch {
        None | Some(LatchSchema::Momentary) => Latch::Momentary,
        Some(LatchSchema::OneShot) => Latch::OneShot,
        Some(LatchSchema::Lock) => Latch::Lock,
    }
}
