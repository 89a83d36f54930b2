//! Access to the values of a reference vector file.

use serde_json::Value;

/// A check of one file: returns the number of cases, and panics at the first wrong number.
pub type Check = fn(&Value) -> usize;

pub fn list(value: &Value) -> &Vec<Value> {
    value.as_array().expect("a list")
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

pub fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(number).collect()
}

pub fn text(value: &Value) -> &str {
    value.as_str().expect("a string")
}

/// Returns the tolerance of a case, or else of the file: a number, or a table by quantity.
pub fn tolerance_of(case: &Value, file: &Value, quantity: &str) -> f64 {
    let own = &case["tolerance"];
    let tolerance = own.as_f64().or_else(|| own[quantity].as_f64());
    tolerance.unwrap_or_else(|| number(&file["tolerance"][quantity]))
}

pub fn bytes(hex: &Value) -> Vec<u8> {
    let hex = text(hex);
    (0..hex.len())
        .step_by(2)
        .map(|index| u8::from_str_radix(&hex[index..index + 2], 16).expect("hex"))
        .collect()
}

/// Panics unless `ours` is within `tolerance` of `theirs`.
pub fn assert_close(ours: f64, theirs: f64, tolerance: f64, what: &str) {
    let difference = (ours - theirs).abs();
    assert!(
        difference <= tolerance,
        "{what}: {ours} instead of {theirs}, difference {difference:e}"
    );
}
