//! Messages in JSON, as recordings of format 1 have them.

use serde_json::Value;

use ademan_core::capture::Reading;
use ademan_core::command::Command;

use super::EXTERNAL_ORIGIN;

/// Decodes a reading.
pub(super) fn decode_reading(data: &[u8]) -> Result<Reading, serde_json::Error> {
    serde_json::from_slice(data)
}

/// Returns a recorded command that no reading repeats, or `None`: commands of the layout are issued again, and commands of a
/// later version are not known.
pub(super) fn decode_external_command(data: &[u8]) -> Option<Command> {
    let mut fields: serde_json::Map<String, Value> = serde_json::from_slice(data).ok()?;
    fields.remove("time_us");
    let origin = fields.remove("origin")?;
    let command: Command = serde_json::from_value(Value::Object(fields)).ok()?;
    (origin == EXTERNAL_ORIGIN && command.check().is_ok()).then_some(command)
}
