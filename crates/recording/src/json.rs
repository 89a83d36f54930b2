//! Messages in JSON, as recordings of format 1 have them.

use serde_json::Value;

use ademan_core::capture::Reading;
use ademan_core::command::Command;

use super::EXTERNAL_ORIGIN;

/// Decodes a reading.
pub(super) fn decode_reading(data: &[u8]) -> Result<Reading, serde_json::Error> {
    serde_json::from_slice(data)
}

/// Decodes a recorded command. Returns `None` for one of the layout, which the readings issue again, and for one of a later version,
/// which is not known.
pub(super) fn decode_external_command(data: &[u8]) -> Result<Option<Command>, serde_json::Error> {
    let mut fields: serde_json::Map<String, Value> = serde_json::from_slice(data)?;
    fields.remove("time_us");
    let is_external = fields
        .remove("origin")
        .is_some_and(|origin| origin == EXTERNAL_ORIGIN);
    let command = serde_json::from_value(Value::Object(fields)).ok();
    Ok(command.filter(|known: &Command| is_external && known.check().is_ok()))
}
