//! The fields of a setup file, and its JSON Schema.

use std::ops::RangeInclusive;

use ademan_core::document::{FieldType, Shape, Table, json_schema, tables_of};
use serde_json::Value;

use super::Setup;
use super::check::{PRESSES_PER_SECOND, STALL_TIMEOUTS_MS};
use crate::capture::SourceUri;
use crate::share::ShareTarget;
use crate::text::TextSetup;

/// Types that are written as a text.
macro_rules! texts {
    ($($name:ident)+) => {$(
        impl FieldType for $name {
            fn shape() -> Shape {
                Shape::Text {
                    min_length: 1,
                    max_length: None,
                }
            }
        }
    )+};
}
texts!(SourceUri ShareTarget);

/// Returns the tables of the fields of a setup file.
pub fn setup_field_tables() -> Vec<Table> {
    tables_of::<Setup>()
}

/// Returns the JSON Schema of the JSON form of a setup file; see [`json_schema`].
pub fn setup_json_schema() -> Value {
    let mut schema = json_schema(&setup_field_tables());
    set_defaults(&mut schema, "Setup", serde_json::to_value(Setup::default()));
    set_defaults(
        &mut schema,
        "Text",
        serde_json::to_value(TextSetup::default()),
    );
    set_range(&mut schema, "stall_timeout_ms", STALL_TIMEOUTS_MS);
    set_range(&mut schema, "max_presses_per_second", PRESSES_PER_SECOND);
    schema
}

/// Sets the defaults of the fields of a structure to the fields of a value.
fn set_defaults(schema: &mut Value, table: &str, defaults: serde_json::Result<Value>) {
    let properties = &mut schema["$defs"][table]["properties"];
    let Ok(Value::Object(defaults)) = defaults else {
        return;
    };
    for (name, default) in defaults {
        if !default.is_null() && properties[&name].is_object() {
            properties[&name]["default"] = default;
        }
    }
}

/// Sets the range of a whole number of the setup.
fn set_range(schema: &mut Value, name: &str, range: RangeInclusive<u32>) {
    let number = &mut schema["$defs"]["Setup"]["properties"][name];
    let (min, max) = range.into_inner();
    number["minimum"] = min.into();
    number["maximum"] = max.into();
}
