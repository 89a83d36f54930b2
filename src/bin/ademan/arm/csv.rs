//! Attributes as comma-separated values.

use std::io::{self, Write};

use serde_json::Value;

use super::values::{ArmValues, Line};

/// The attributes in the order of their columns.
const NAMES: [&str; 11] = [
    "shoulder_direction",
    "upper_arm_length",
    "shoulder_rotation",
    "elbow_angle",
    "forearm_length",
    "elbow_rotation",
    "wrist_rotation",
    "wrist_inclination",
    "little_vector",
    "index_vector",
    "thumb_vector",
];

/// Writes the names of the columns, in the order of [`write_line`].
pub fn write_header(out: &mut dyn Write) -> io::Result<()> {
    let names = columns(&ArmValues::default());
    write!(out, "time_us")?;
    for side in ["left", "right"] {
        for (name, _) in &names {
            write!(out, ",{side}_{name}")?;
        }
    }
    writeln!(out)
}

/// Writes the attributes of a pose. Those that are unknown are empty.
pub fn write_line(line: &Line, out: &mut dyn Write) -> io::Result<()> {
    if let Some(time_us) = line.time_us {
        write!(out, "{time_us}")?;
    }
    for arm in [&line.left, &line.right] {
        for (_, value) in columns(arm) {
            match value {
                Some(value) => write!(out, ",{value}")?,
                None => write!(out, ",")?,
            }
        }
    }
    writeln!(out)
}

/// Returns the columns of an arm: one for each number, three for each vector.
fn columns(arm: &ArmValues) -> Vec<(String, Option<f64>)> {
    let fields = serde_json::to_value(arm).unwrap_or_default();
    let mut columns = Vec::new();
    for name in NAMES {
        let value = &fields[name];
        if name.ends_with("_vector") || name.ends_with("_direction") {
            for (index, axis) in ["x", "y", "z"].iter().enumerate() {
                let number = value.get(index).and_then(Value::as_f64);
                columns.push((format!("{name}_{axis}"), number));
            }
        } else {
            columns.push((name.to_owned(), value.as_f64()));
        }
    }
    columns
}
