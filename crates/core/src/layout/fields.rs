//! The tables of fields of a layout file.

use std::collections::BTreeMap;

use super::load::LayoutSchema;
use crate::device::trigger::{CircleDirection, CirclePoint, HandShape, SwipeDirection};
use crate::document::{FieldType, Shape, Table, tables_of};
use crate::hand::{Dof, Finger, Input, Joint, Side};

/// Returns the tables of the fields of a layout file: the file itself first, each structure after the one that contains it.
pub fn field_tables() -> Vec<Table> {
    tables_of::<LayoutSchema>()
}

/// Types whose values have a name in quotes. The text names their kind in tables; an empty one lists the names there.
macro_rules! quoted_names {
    ($($name:ident = $kind:literal,)+) => {$(
        impl FieldType for $name {
            fn shape() -> Shape {
                Shape::Names($name::ALL.iter().map(|value| value.name()).collect(), $kind)
            }
        }
    )+};
}
quoted_names! {
    Finger = "",
    Input = "",
    HandShape = "",
    SwipeDirection = "",
    CirclePoint = "",
    CircleDirection = "",
    Side = "",
    Joint = "joint",
    Dof = "degree of freedom",
}

impl<V: FieldType> FieldType for BTreeMap<Dof, V> {
    fn shape() -> Shape {
        let names = Dof::ALL.iter().map(|dof| dof.name()).collect();
        Shape::NamedMap(names, "degree of freedom", Box::new(V::shape()))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use serde_json::Value;

    use super::*;
    use crate::document::{Document, json_form, json_schema, shipped_layouts};
    use crate::layout::load::structures;

    /// Returns the JSON form of each shipped layout, with its name.
    fn forms() -> Vec<(&'static str, Value)> {
        let tables = field_tables();
        let form = |name| {
            let text = Document::shipped(name).unwrap().text;
            (name, json_form(&text, &tables).unwrap())
        };
        shipped_layouts().map(form).collect()
    }

    /// Returns the words of a text in alphabetical order: the entries of a map have no order in JSON.
    fn words(text: &str) -> Vec<&str> {
        let is_separator = |c: char| c.is_whitespace() || "()[]{},".contains(c);
        let mut words: Vec<&str> = text.split(is_separator).collect();
        words.sort_unstable();
        words
    }

    /// Adds a field to each object of a value, one after the other, and passes the result to `check`.
    fn with_a_wrong_field(value: &Value, check: &mut dyn FnMut(Value)) {
        match value {
            Value::Object(fields) => {
                let mut wrong = fields.clone();
                wrong.insert(
                    "no_such_field".into(),
                    Value::Array(vec![Value::Array(Vec::new())]),
                );
                check(Value::Object(wrong));
                for (name, field) in fields {
                    with_a_wrong_field(field, &mut |wrong_field| {
                        let mut fields = fields.clone();
                        fields.insert(name.clone(), wrong_field);
                        check(Value::Object(fields));
                    });
                }
            }
            Value::Array(items) => {
                for (index, item) in items.iter().enumerate() {
                    with_a_wrong_field(item, &mut |wrong_field| {
                        let mut items = items.clone();
                        items[index] = wrong_field;
                        check(Value::Array(items));
                    });
                }
            }
            _ => {}
        }
    }

    #[test]
    fn the_json_form_is_what_serde_reads_and_has_no_unknown_fields() {
        for (name, form) in forms() {
            let document = Document::shipped(name).unwrap();
            let written: LayoutSchema = document.parse().unwrap();
            let json = form.to_string();
            let read: LayoutSchema = serde_json::from_str(&json).unwrap();
            assert_eq!(
                words(&format!("{read:?}")),
                words(&format!("{written:?}")),
                "{name}"
            );
            let mut count = 0;
            with_a_wrong_field(&form, &mut |wrong| {
                let wrong_json = wrong.to_string();
                assert!(
                    serde_json::from_str::<LayoutSchema>(&wrong_json).is_err(),
                    "{wrong_json}"
                );
                count += 1;
            });
            assert!(count > 2, "{name}");
        }
    }

    #[test]
    fn the_schema_has_the_fields_that_serde_reads() {
        let schema = json_schema(&field_tables());
        for structure in structures() {
            let properties = schema["$defs"][structure.name]["properties"].as_object();
            let Some(properties) = properties else {
                panic!("no definition of {}", structure.name);
            };
            let described: BTreeSet<&str> = properties.keys().map(String::as_str).collect();
            let read: BTreeSet<&str> = structure.fields.iter().copied().collect();
            assert_eq!(described, read, "{}", structure.name);
        }
    }
}
