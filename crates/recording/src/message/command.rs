//! The message of a command.

use serde_json::{Map, Value};

use super::wire::{
    Fields, WireError, float, integer, put_bytes, put_integer, put_nonzero_float, text,
};
use ademan_core::command::{Command, CommandSpec};
use ademan_core::time::Timestamp;

/// Names of the fields of commands that are numbers, and their numbers in the schema.
const NUMBERS: [(&str, u32); 5] = [
    ("x_mm", 5),
    ("y_mm", 6),
    ("z_mm", 7),
    ("deg", 8),
    ("factor", 9),
];

/// Appends the message of a command. An external one comes from outside the layout.
pub fn encode_command(time: Timestamp, command: &Command, is_external: bool, out: &mut Vec<u8>) {
    put_integer(out, 1, time.0);
    put_bytes(out, 2, command.name().as_bytes());
    put_integer(out, 3, is_external.into());
    match command {
        Command::Profile { name } => put_bytes(out, 4, name.as_bytes()),
        Command::Nudge { x_mm, y_mm, z_mm } => {
            for (field, value) in [(5, *x_mm), (6, *y_mm), (7, *z_mm)] {
                put_nonzero_float(out, field, value);
            }
        }
        Command::Tilt { deg } => put_nonzero_float(out, 8, *deg),
        Command::Scale { factor } => put_nonzero_float(out, 9, *factor),
        Command::Text { mode } => put_bytes(out, 10, mode.name().as_bytes()),
        Command::Candidate { number } => put_integer(out, 11, (*number).into()),
        _ => {}
    }
}

/// Decodes the message of a command. Returns `None` for one of the layout, which the readings repeat, and for one that this
/// version does not know.
pub fn decode_external_command(data: &[u8]) -> Result<Option<Command>, WireError> {
    let (mut command, mut is_external) = ("", false);
    let (mut profile, mut mode, mut candidate) = ("", "", 0);
    let mut numbers = NUMBERS.map(|(name, _)| (name, 0.0));
    for field in Fields::new(data) {
        let field = field?;
        match field.0 {
            2 => command = text(field)?,
            3 => is_external = integer(field)? != 0,
            4 => profile = text(field)?,
            10 => mode = text(field)?,
            11 => candidate = integer(field)?,
            number => {
                let index = NUMBERS.iter().position(|entry| entry.1 == number);
                if let Some(index) = index {
                    numbers[index].1 = float(field)?;
                }
            }
        }
    }
    let Ok(spec) = CommandSpec::find(command) else {
        return Ok(None);
    };
    let mut fields = Map::from_iter([("command".to_owned(), command.into())]);
    for field in spec.fields {
        let value = match field.name {
            "name" => Value::from(profile),
            "mode" => Value::from(mode),
            "number" => Value::from(candidate),
            other => {
                let number = numbers.iter().find(|(name, _)| *name == other);
                number.map_or(Value::Null, |(_, number)| Value::from(*number))
            }
        };
        fields.insert(field.name.to_owned(), value);
    }
    let known = serde_json::from_value(Value::Object(fields)).ok();
    Ok(known.filter(|found: &Command| is_external && found.check().is_ok()))
}
