//! Commands to a running session: one type for layout keys, gestures, the control socket, the command line and the
//! library.
//!
//! As JSON a command is an object with its name and its fields, such as `{"command":"tilt","deg":-2.5}`. [`SPECS`] lists
//! all commands with the ranges of their fields; help texts and error messages are made from it.

mod origin;
mod spec;
mod text_mode;

use std::fmt;
use std::str::FromStr;

use arrayvec::ArrayString;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::message::{escape, escape_line};
use crate::names::UnknownName;

pub use origin::CommandOrigin;
pub use spec::{CommandSpec, FieldKind, FieldSpec, SPECS};
pub use text_mode::TextMode;

/// The name of one of the layouts of a setup, at most 64 bytes long.
pub type ProfileName = ArrayString<64>;

/// A command to a running session.
///
/// Lengths are in millimetres along the world axes, angles in degrees. Values outside the ranges of [`SPECS`] are refused
/// by [`check`](Self::check), which every entry point calls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "command", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Command {
    /// Reports the state, the active profile and the statistics.
    State,
    /// Releases everything and suppresses all events until `Resume`.
    Pause,
    /// Ends a pause, if its [origin](CommandOrigin) permits it. Output is armed again once the hand has been clear of every
    /// control.
    Resume,
    /// Pauses a running session and resumes a paused one.
    TogglePause,
    /// Activates the layout with this name in the setup.
    Profile {
        /// Name of the profile.
        name: ProfileName,
    },
    /// Activates the next layout of the setup, and the first one after the last.
    NextProfile,
    /// Moves the boards below the index fingertip of the hand seen last.
    Recenter,
    /// Moves the boards along the world axes.
    Nudge {
        /// Distance to the right.
        x_mm: f32,
        /// Distance up.
        y_mm: f32,
        /// Distance towards the wearer.
        z_mm: f32,
    },
    /// Rotates each board about its rows, through its origin.
    Tilt {
        /// Angle; positive raises the far edge.
        deg: f32,
    },
    /// Changes the size of the boards about their origins.
    Scale {
        /// Ratio of the new size to the present one.
        factor: f32,
    },
    /// Makes the present angles of the resting hand its rest pose, until the end of the session. A request of the layout
    /// waits until the hand rests.
    Zero,
    /// Removes what `Zero` has changed.
    UndoZero,
    /// Returns to the calibrated ranges of the sensors.
    UndoLearning,
    /// Changes how much the text decoder of the active layout changes.
    Text {
        /// The mode.
        mode: TextMode,
    },
    /// Replaces the word that is being typed by a candidate of the text decoder and a space.
    Candidate {
        /// The position, 1 to 3, the most probable one first.
        #[serde(deserialize_with = "whole_number")]
        number: u8,
    },
    /// Forgets what the text decoder has learned about the person.
    ForgetLearned,
    /// Writes what the text decoder has learned about the person to its file.
    SaveLearned,
    /// Allows all sources of the session to press keys, including sources on the network. A layout cannot issue it.
    AllowKeys,
    /// Allows the sources of the session only to point.
    ForbidKeys,
    /// Writes the poses and the size of the boards to the layout file.
    Save,
    /// Reads the layout files again.
    Reload,
    /// Releases everything and ends the session.
    Stop,
}

/// Reason why a text or a value is not a command.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InvalidCommand {
    /// The text is not a JSON object, or a field occurs twice.
    #[error("{}", escape_line(.0))]
    Syntax(String),
    /// The object has no field `command`.
    #[error(r#"the field `command` is missing; write a command such as {{"command":"state"}}"#)]
    NoCommand,
    /// A command or a field has an unknown name.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// A required field is missing.
    #[error("`{command}` needs the field `{field}`")]
    MissingField {
        /// Name of the command.
        command: &'static str,
        /// Name of the field.
        field: &'static str,
    },
    /// The command has no such field.
    #[error("`{command}` has no field `{}`", escape(.field))]
    ExtraField {
        /// Name of the command.
        command: &'static str,
        /// Name of the field.
        field: String,
    },
    /// The value of a field has the wrong type or is out of range.
    #[error("`{field}` is {expected}, not {}", escape(.value))]
    Value {
        /// Name of the field.
        field: &'static str,
        /// Accepted values.
        expected: String,
        /// The value, as JSON.
        value: String,
    },
}

impl Command {
    /// Parses a JSON object and checks it.
    pub fn from_json(text: &str) -> Result<Self, InvalidCommand> {
        let syntax = |error: serde_json::Error| {
            let example = r#"{"command":"state"}"#;
            InvalidCommand::Syntax(format!(
                "not a command: {error}; write a JSON object such as {example}"
            ))
        };
        let fields: Map<String, Value> = serde_json::from_str(text).map_err(syntax)?;
        let name = fields.get("command").ok_or_else(|| no_command(&fields))?;
        let name = name.as_str().ok_or(InvalidCommand::NoCommand)?;
        CommandSpec::find(name)?.check(&fields)?;
        // A map keeps the last of two fields with the same name; the derived code refuses them.
        serde_json::from_str(text).map_err(syntax)
    }

    /// Checks the ranges of all fields.
    pub fn check(&self) -> Result<(), InvalidCommand> {
        let syntax = |error: serde_json::Error| InvalidCommand::Syntax(error.to_string());
        // Text keeps the decimal fraction of a 32-bit number, which an error message then shows.
        let text = serde_json::to_string(self).map_err(syntax)?;
        self.spec()
            .check(&serde_json::from_str(&text).map_err(syntax)?)
    }

    /// Returns the name in JSON and on the command line.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::State => "state",
            Self::Pause => "pause",
            Self::Resume => "resume",
            Self::TogglePause => "toggle-pause",
            Self::Profile { .. } => "profile",
            Self::NextProfile => "next-profile",
            Self::Recenter => "recenter",
            Self::Nudge { .. } => "nudge",
            Self::Tilt { .. } => "tilt",
            Self::Scale { .. } => "scale",
            Self::Zero => "zero",
            Self::UndoZero => "undo-zero",
            Self::UndoLearning => "undo-learning",
            Self::Text { .. } => "text",
            Self::Candidate { .. } => "candidate",
            Self::ForgetLearned => "forget-learned",
            Self::SaveLearned => "save-learned",
            Self::Save => "save",
            Self::Reload => "reload",
            Self::Stop => "stop",
            Self::AllowKeys => "allow-keys",
            Self::ForbidKeys => "forbid-keys",
        }
    }

    /// Returns `true` if a replay repeats the command: it changes what readings mean. A replay has its own pauses, and the
    /// layout files of its own session.
    pub const fn is_replayed(&self) -> bool {
        matches!(
            self,
            Self::Zero
                | Self::UndoZero
                | Self::UndoLearning
                | Self::Text { .. }
                | Self::Candidate { .. }
                | Self::ForgetLearned
                | Self::Recenter
                | Self::Nudge { .. }
                | Self::Tilt { .. }
                | Self::Profile { .. }
                | Self::NextProfile
        )
    }

    /// Returns `true` if the command changes whether sources may press keys.
    pub const fn is_permission(&self) -> bool {
        matches!(self, Self::AllowKeys | Self::ForbidKeys)
    }

    /// Returns `true` if a key or gesture of a layout may issue the command. The others have no effect there.
    pub const fn is_allowed_in_layouts(&self) -> bool {
        !matches!(self, Self::State) && !self.is_permission()
    }

    /// Returns `true` if the command types, or changes what keys type: a source that may only point does not cause it.
    pub const fn is_typing(&self) -> bool {
        matches!(
            self,
            Self::Text { .. } | Self::Candidate { .. } | Self::ForgetLearned
        )
    }

    /// Returns the name, the fields and the description.
    pub fn spec(&self) -> &'static CommandSpec {
        let spec = SPECS.iter().find(|spec| spec.name == self.name());
        spec.expect("every command is listed, as a test shows")
    }
}

/// Parses the name and the values of the fields, separated by blanks: `nudge 0 -1.5 2`. The inverse of [`Display`](fmt::Display).
impl FromStr for Command {
    type Err = InvalidCommand;

    fn from_str(text: &str) -> Result<Self, InvalidCommand> {
        let (name, mut values) = split_word(text);
        let spec = CommandSpec::find(name)?;
        let mut fields = Map::new();
        fields.insert("command".into(), name.into());
        for field in spec.fields {
            let value;
            (value, values) = match field.kind {
                FieldKind::Number { .. } | FieldKind::Whole { .. } | FieldKind::OneOf(_) => {
                    split_word(values)
                }
                // The only field of its command; it may contain blanks.
                FieldKind::Name => (values, ""),
            };
            if value.is_empty() {
                return Err(InvalidCommand::MissingField {
                    command: spec.name,
                    field: field.name,
                });
            }
            let number = || value.parse::<f64>().ok().map(Value::from);
            let value = match field.kind {
                FieldKind::Number { .. } | FieldKind::Whole { .. } => {
                    number().unwrap_or_else(|| value.into())
                }
                FieldKind::Name | FieldKind::OneOf(_) => value.into(),
            };
            fields.insert(field.name.into(), value);
        }
        if !values.is_empty() {
            return Err(InvalidCommand::Syntax(format!(
                "`{}` has no argument `{}`",
                spec.name,
                escape(values)
            )));
        }
        spec.check(&fields)?;
        serde_json::from_value(Value::Object(fields))
            .map_err(|error| InvalidCommand::Syntax(error.to_string()))
    }
}

/// Returns the first word and the rest, both without surrounding blanks.
fn split_word(text: &str) -> (&str, &str) {
    let text = text.trim();
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim())
}

/// The name and the values of the fields: `nudge 0 -1.5 2`.
impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        match self {
            Self::Profile { name } => write!(f, " {name}"),
            Self::Nudge { x_mm, y_mm, z_mm } => write!(f, " {x_mm} {y_mm} {z_mm}"),
            Self::Tilt { deg } => write!(f, " {deg}"),
            Self::Scale { factor } => write!(f, " {factor}"),
            Self::Text { mode } => write!(f, " {mode}"),
            Self::Candidate { number } => write!(f, " {number}"),
            _ => Ok(()),
        }
    }
}

impl CommandSpec {
    /// Returns the command with this name.
    pub fn find(name: &str) -> Result<&'static Self, UnknownName> {
        SPECS
            .iter()
            .find(|spec| spec.name == name)
            .ok_or_else(|| UnknownName::new("command", name, SPECS.iter().map(|spec| spec.name)))
    }

    /// Checks that an object has the fields of this command and no others, with accepted values.
    fn check(&self, fields: &Map<String, Value>) -> Result<(), InvalidCommand> {
        for field in self.fields {
            let value = fields.get(field.name).ok_or(InvalidCommand::MissingField {
                command: self.name,
                field: field.name,
            })?;
            field.check(value)?;
        }
        let is_known =
            |name: &str| name == "command" || self.fields.iter().any(|field| field.name == name);
        match fields.keys().find(|name| !is_known(name)) {
            None => Ok(()),
            Some(field) => Err(InvalidCommand::ExtraField {
                command: self.name,
                field: field.clone(),
            }),
        }
    }
}

impl FieldSpec {
    fn check(&self, value: &Value) -> Result<(), InvalidCommand> {
        if self.kind.accepts(value) {
            return Ok(());
        }
        Err(InvalidCommand::Value {
            field: self.name,
            expected: self.kind.to_string(),
            value: plain_json(value),
        })
    }
}

/// Reads a whole number that may be written with a decimal point.
fn whole_number<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<u8, D::Error> {
    let number = f64::deserialize(deserializer)?;
    // Out of range it is refused by the check of its field.
    Ok(number as u8)
}

/// Formats a value as JSON, and a whole number without a decimal point.
fn plain_json(value: &Value) -> String {
    let json = value.to_string();
    json.strip_suffix(".0").map(str::to_owned).unwrap_or(json)
}

impl FieldKind {
    fn accepts(self, value: &Value) -> bool {
        match self {
            Self::Number { min, max } => value
                .as_f64()
                .is_some_and(|number| (f64::from(min)..=f64::from(max)).contains(&number)),
            Self::Whole { min, max } => value.as_f64().is_some_and(|number| {
                (f64::from(min)..=f64::from(max)).contains(&number) && number.fract() == 0.0
            }),
            Self::Name => value
                .as_str()
                .is_some_and(|name| ProfileName::from(name).is_ok()),
            Self::OneOf(words) => value.as_str().is_some_and(|word| words.contains(&word)),
        }
    }
}

impl fmt::Display for FieldKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number { min, max } => write!(f, "{min} to {max}"),
            Self::Whole { min, max } => write!(f, "a whole number, {min} to {max}"),
            Self::OneOf(words) => write!(f, "`{}`", words.join("`, `")),
            Self::Name => write!(
                f,
                "a name of at most {} bytes",
                ProfileName::new_const().capacity()
            ),
        }
    }
}

/// Returns the error of an object without the field `command`; a misspelled one is reported as such.
fn no_command(fields: &Map<String, Value>) -> InvalidCommand {
    let misspelled = fields
        .keys()
        .map(|name| UnknownName::new("field", name, ["command"]))
        .find(|unknown| unknown.nearest.is_some());
    misspelled.map_or(InvalidCommand::NoCommand, InvalidCommand::from)
}

#[cfg(test)]
mod tests;
