//! Files as JSON: the JSON Schema of a format, and the JSON form of a RON text.
//!
//! serde reads this JSON form:
//!
//! | RON | JSON |
//! |---|---|
//! | `(pitch_mm: 19)`, `Board(pitch_mm: 19)` | `{"pitch_mm": 19}` |
//! | `Touchpad` | `"Touchpad"` |
//! | `Key("A")` | `{"Key": "A"}` |
//! | `Box(17, 20)` | `{"Box": [17, 20]}` |
//! | `Arc(radius_mm: 60)` | `{"Arc": {"radius_mm": 60}}` |
//! | `(0, 19)` | `[0, 19]` |
//! | `{"Q": "A"}`, `{7: 40}` | `{"Q": "A"}`, `{"7": 40}` |
//! | `Some(4)` | `4` |
//! | a field that is `None` | no field |

use serde_json::{Map, Value, json};

use super::{Row, Shape, Table};
use crate::document::{Item, Node, read_tree};

/// The version of JSON Schema.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Returns the JSON Schema (draft 2020-12) of the JSON form of a file; see [`json_form`].
///
/// `tables` describe the format, beginning with the file itself. The unit of a number stands in the annotation `unit`; `quoted` marks
/// names that RON writes in quotes, such as `"index"`, beside words such as `elbow`.
pub fn json_schema(tables: &[Table]) -> Value {
    let definitions = tables
        .iter()
        .map(|table| (table.name.to_owned(), definition(table)));
    let definitions: Map<String, Value> = definitions.collect();
    let root = tables.first().map_or("", |table| table.name);
    json!({
        "$schema": DIALECT,
        "title": root,
        "$ref": reference(root),
        "$defs": definitions,
    })
}

fn reference(table: &str) -> String {
    format!("#/$defs/{table}")
}

fn definition(table: &Table) -> Value {
    let mut definition = if table.is_enumeration {
        json!({ "oneOf": values(table) })
    } else {
        object(table.rows.iter().map(|row| (row.name.as_str(), row)))
    };
    definition["description"] = sentence(&table.meaning).into();
    definition
}

/// Returns the schema of an object with these fields.
fn object<'r>(fields: impl Iterator<Item = (&'r str, &'r Row)>) -> Value {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for (name, row) in fields {
        properties.insert(name.to_owned(), property(row));
        if row.is_required {
            required.push(name);
        }
    }
    json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

/// Returns the schemas of the values of an enumeration.
fn values(table: &Table) -> Vec<Value> {
    let fields = table.rows.iter().filter_map(|row| {
        let (value, field) = row.name.strip_suffix(')')?.split_once('(')?;
        Some((value, field, row))
    });
    let fields: Vec<(&str, &str, &Row)> = fields.collect();
    let values = table.rows.iter().filter(|row| !row.name.ends_with(')'));
    values
        .map(|row| {
            let own = fields.iter().filter(|(value, ..)| *value == row.name);
            let own: Vec<(&str, &Row)> = own
                .map(|(_, field, field_row)| (*field, *field_row))
                .collect();
            let content = match row.shapes.as_slice() {
                [] if own.is_empty() => None,
                [] => Some(object(own.into_iter())),
                [only] => Some(schema_of(only)),
                several => Some(schema_of(&Shape::Tuple(several.to_vec()))),
            };
            let name = row.name.as_str();
            let mut value = content.map_or(json!({ "const": name }), |content| {
                json!({
                    "type": "object",
                    "properties": { name: content },
                    "required": [name],
                    "additionalProperties": false,
                })
            });
            value["description"] = sentence(&row.meaning).into();
            value
        })
        .collect()
}

/// Returns the schema of a field, with its default.
fn property(row: &Row) -> Value {
    let mut property = row.shapes.first().map_or(json!({}), schema_of);
    let mut description = sentence(&row.meaning);
    if !row.is_required {
        match default_value(&row.default) {
            Some(default) => property["default"] = default,
            None if row.default == "none" => {}
            None => description += &format!(" Default: {}.", row.default),
        }
    }
    property["description"] = description.into();
    property
}

fn sentence(meaning: &str) -> String {
    format!("{meaning}.")
}

/// Returns the default as a value, if it is a number, a `bool` or a word.
fn default_value(text: &str) -> Option<Value> {
    let written = text.strip_prefix('`').and_then(|it| it.strip_suffix('`'));
    let written = written.unwrap_or(text);
    if let Ok(number) = written.parse::<f64>() {
        return Some(number_value(number));
    }
    match written {
        "true" | "false" => Some((written == "true").into()),
        _ => {
            let is_word = text != written && written.chars().all(char::is_alphanumeric);
            is_word.then(|| written.into())
        }
    }
}

/// Returns the schema of the values of a shape.
fn schema_of(shape: &Shape) -> Value {
    match shape {
        Shape::Bool => json!({ "type": "boolean" }),
        Shape::AnyNumber => json!({ "type": "number" }),
        Shape::Integer { min, max } => {
            json!({ "type": "integer", "minimum": min, "maximum": max })
        }
        Shape::Number {
            min,
            max,
            unit,
            is_whole,
            ..
        } => {
            let mut schema = json!({
                "type": if *is_whole { "integer" } else { "number" },
                "minimum": number_value(*min),
                "maximum": number_value(*max),
            });
            if !unit.is_empty() {
                schema["unit"] = unit.trim().into();
            }
            schema
        }
        Shape::Text {
            min_length,
            max_length,
        } => {
            let mut schema = json!({ "type": "string", "minLength": min_length });
            if let Some(length) = max_length {
                schema["maxLength"] = (*length).into();
            }
            schema
        }
        Shape::Words(words) => {
            let words: Vec<&str> = words.iter().map(|(word, _)| word.as_str()).collect();
            json!({ "enum": words })
        }
        Shape::Names(names, _) => json!({ "enum": names, "quoted": true }),
        Shape::List(item) => json!({ "type": "array", "items": schema_of(item) }),
        Shape::Map(value) => {
            json!({ "type": "object", "additionalProperties": schema_of(value) })
        }
        Shape::NamedMap(names, _, value) => json!({
            "type": "object",
            "propertyNames": { "enum": names },
            "additionalProperties": schema_of(value),
        }),
        Shape::NumberedMap(value) => json!({
            "type": "object",
            "propertyNames": { "pattern": "^[0-9]+$" },
            "additionalProperties": schema_of(value),
        }),
        Shape::Tuple(parts) => {
            let count = parts.len();
            let parts: Vec<Value> = parts.iter().map(schema_of).collect();
            json!({ "type": "array", "prefixItems": parts, "items": false, "minItems": count })
        }
        Shape::Table(name) => json!({ "$ref": reference(name) }),
    }
}

/// Returns a number, without a fraction if it has none.
fn number_value(number: f64) -> Value {
    if number.fract() == 0.0 && number.abs() < 1e15 {
        return (number as i64).into();
    }
    number.into()
}

/// Returns the JSON form of a RON text: numbers, texts and lists as they are, a structure as an object, and a value of an enumeration
/// as serde writes it, such as `{"Key": "A"}` or `"Touchpad"`.
///
/// `tables` are the tables of the format. A field or value that they do not list is converted by its spelling, so that a validator
/// reports it. `None` if brackets are not balanced.
pub fn json_form(text: &str, tables: &[Table]) -> Option<Value> {
    let root = tables.first().map(|table| Shape::Table(table.name));
    let reader = Reader { text, tables };
    Some(reader.value(&read_tree(text)?, root.as_ref()))
}

struct Reader<'t> {
    text: &'t str,
    tables: &'t [Table],
}

impl Reader<'_> {
    fn value(&self, node: &Node, shape: Option<&Shape>) -> Value {
        let node = node.in_some(self.text);
        let Some(group) = &node.group else {
            return scalar(node.text(self.text));
        };
        match (shape, group.bracket) {
            (Some(Shape::Table(name)), b'(') => self.structure(node, name),
            (Some(Shape::List(item)), b'[') => {
                let items = node.items().iter();
                items.map(|it| self.value(&it.value, Some(item))).collect()
            }
            (
                Some(Shape::Map(value) | Shape::NamedMap(_, _, value) | Shape::NumberedMap(value)),
                b'{',
            ) => self.fields(node, |_| Some(value.as_ref())),
            (Some(Shape::Tuple(parts)), b'(') => self.tuple(node, parts),
            _ if node.items().iter().any(|item| item.key.is_some()) => self.fields(node, |_| None),
            _ => self.tuple(node, &[]),
        }
    }

    /// Converts a structure, or a value of an enumeration with contents.
    fn structure(&self, node: &Node, table: &str) -> Value {
        let table = self.tables.iter().find(|other| other.name == table);
        let row = |name: &str| table?.rows.iter().find(|row| row.name == name);
        if table.is_none_or(|table| !table.is_enumeration) {
            return self.fields(node, |name| row(name)?.shapes.first());
        }
        let Some(name) = node.name(self.text) else {
            return self.tuple(node, &[]);
        };
        let contents = row(name).map_or(&[][..], |row| &row.shapes);
        let content = match (contents, node.items()) {
            ([only], [item]) if item.key.is_none() => self.value(&item.value, Some(only)),
            ([], items) if items.iter().all(|item| item.key.is_some()) => self
                .fields(node, |field| {
                    row(&format!("{name}({field})"))?.shapes.first()
                }),
            _ => self.tuple(node, contents),
        };
        json!({ name: content })
    }

    fn fields<'s>(&self, node: &Node, shape: impl Fn(&str) -> Option<&'s Shape>) -> Value {
        let fields = node.items().iter().filter_map(|Item { key, value, .. }| {
            let key = scalar(&self.text[key.clone()?]);
            let key = key.as_str().map_or(key.to_string(), str::to_owned);
            let value = self.value(value, shape(&key));
            (!value.is_null()).then_some((key, value))
        });
        Value::Object(fields.collect())
    }

    fn tuple(&self, node: &Node, parts: &[Shape]) -> Value {
        let items = node.items().iter().enumerate();
        items
            .map(|(index, item)| self.value(&item.value, parts.get(index)))
            .collect()
    }
}

/// Converts a text in quotes, a number or a word.
fn scalar(written: &str) -> Value {
    if written == "None" {
        return Value::Null;
    }
    if written.ends_with(['"', '#', '\'']) {
        let text = crate::document::parse_ron::<String>(written, "");
        return text.map_or(written.into(), Value::String);
    }
    if let Ok(is_true) = written.parse::<bool>() {
        return is_true.into();
    }
    let number = crate::document::parse_ron::<f64>(written, "");
    match number {
        Ok(number) if number.is_finite() => number_value(number),
        _ => written.into(),
    }
}
