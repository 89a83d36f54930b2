//! Tables of the fields of a file, read from the declarations of its schema.
//!
//! A structure or enumeration in [`schema!`](crate::schema) has a table. The doc comment of a field is its meaning; its last
//! sentence may be `Default: ….`, for a default that the type of the field does not have.

mod json;
mod schema_macro;
mod shape;
mod types;

pub use json::{json_form, json_schema};
pub use shape::Shape;

use serde::Serialize;

/// The fields of a structure, or the values of an enumeration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// Name of the structure or enumeration in a RON text.
    pub name: &'static str,
    /// Description, a sentence.
    pub meaning: String,
    /// Rows in the order of the declaration.
    pub rows: Vec<Row>,
    /// `true` if the rows are values, and fields of values.
    #[serde(skip)]
    pub is_enumeration: bool,
}

/// A field of a structure, a value of an enumeration, or a field of such a value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name; for the field of a value with the name of the value, such as `Arc(radius_mm)`.
    pub name: String,
    /// Value of a field that is left out, or `required`. Empty for the value of an enumeration.
    pub default: String,
    /// Valid values, or the name of the table that has them.
    pub values: String,
    /// Description, a sentence.
    pub meaning: String,
    /// The valid values of a field, or the contents of the value of an enumeration in its parentheses.
    #[serde(skip)]
    pub shapes: Vec<Shape>,
    /// `true` if the field must be written.
    #[serde(skip)]
    pub is_required: bool,
}

/// A type of the fields of a file. [`schema!`](crate::schema) implements it for structures and enumerations.
pub trait FieldType {
    /// Returns the valid values.
    fn shape() -> Shape;

    /// Returns `true` if a field of the type may be left out without a default.
    fn is_optional() -> bool {
        false
    }

    /// Returns the value of a field that is left out, if it may be left out.
    fn default_text() -> String {
        "none".into()
    }

    /// Returns what the values mean, if the meaning of a field has to state it.
    fn explanation() -> String {
        String::new()
    }

    /// Adds the tables of the type and of its fields, each table once.
    fn collect_tables(_: &mut Vec<Table>) {}
}

/// The attributes of a declaration.
#[doc(hidden)]
pub struct Attributes {
    /// Lines of its doc comment.
    pub lines: &'static [&'static str],
    /// All of them as text.
    pub texts: &'static [&'static str],
}

impl Attributes {
    /// Returns the name that serde uses, or else `name`.
    pub fn name(&self, name: &'static str) -> &'static str {
        let renamed = self.texts.iter().find_map(|text| {
            let (_, after) = text.split_once("rename = \"")?;
            after.split('"').next()
        });
        renamed.unwrap_or(name)
    }

    /// Returns `true` if serde reads the names of values in lower case.
    pub fn has_lower_case_values(&self) -> bool {
        self.has("rename_all = \"lowercase\"")
    }

    /// Returns `true` for the value that `Default` returns.
    pub fn is_of_default_value(&self) -> bool {
        self.texts.contains(&"default")
    }

    /// Returns `true` if every field of the structure has a default.
    pub fn has_defaults(&self) -> bool {
        self.has("default,") || self.has(", default)")
    }

    fn has(&self, part: &str) -> bool {
        let mut serde = self.texts.iter().filter(|text| text.starts_with("serde"));
        serde.any(|text| text.contains(part))
    }

    /// Returns the doc comment in one line, without the default and the full stop.
    pub fn meaning(&self) -> String {
        let text = self.text();
        let meaning = text.split("Default: ").next().unwrap_or_default();
        meaning.trim_end().trim_end_matches('.').to_owned()
    }

    fn text(&self) -> String {
        let lines: Vec<&str> = self.lines.iter().map(|line| line.trim()).collect();
        lines.join(" ").trim().to_owned()
    }

    /// Returns the default in the doc comment.
    fn stated_default(&self) -> Option<String> {
        let text = self.text();
        let (_, default) = text.split_once("Default: ")?;
        Some(default.trim_end_matches('.').to_owned())
    }
}

impl Row {
    /// Describes a field of type `T`.
    #[doc(hidden)]
    pub fn field<T: FieldType>(name: String, attributes: &Attributes, is_optional: bool) -> Self {
        let field = Description {
            shape: T::shape,
            is_optional: is_optional || T::is_optional(),
            default_text: T::default_text,
            explanation: T::explanation,
            collect_tables: T::collect_tables,
        };
        field.row(name, attributes)
    }

    /// Describes a value of an enumeration with these contents.
    #[doc(hidden)]
    pub fn value(name: String, contents: Vec<Shape>, attributes: &Attributes) -> Self {
        let words: Vec<String> = contents.iter().map(Shape::words).collect();
        Self {
            name,
            default: String::new(),
            values: shape::joined(&words),
            meaning: attributes.meaning(),
            shapes: contents,
            is_required: false,
        }
    }
}

/// The functions of a [`FieldType`], so that the code that calls them is compiled once.
struct Description {
    shape: fn() -> Shape,
    is_optional: bool,
    default_text: fn() -> String,
    explanation: fn() -> String,
    collect_tables: fn(&mut Vec<Table>),
}

impl Description {
    fn row(&self, name: String, attributes: &Attributes) -> Row {
        let is_required = !self.is_optional && !attributes.has("default");
        let default = match attributes.stated_default() {
            Some(default) => default,
            None if is_required => "required".into(),
            None => (self.default_text)(),
        };
        let mut meaning = attributes.meaning();
        if meaning.is_empty() {
            meaning = self.meaning_of_table();
        }
        let explanation = (self.explanation)();
        if !explanation.is_empty() {
            meaning = format!("{meaning}. {explanation}");
        }
        let shape = (self.shape)();
        Row {
            name,
            default,
            values: shape.words(),
            meaning,
            shapes: vec![shape],
            is_required,
        }
    }

    /// Returns the meaning of the first table of the type.
    fn meaning_of_table(&self) -> String {
        let mut tables = Vec::new();
        (self.collect_tables)(&mut tables);
        let first = tables.into_iter().next();
        first.map_or(String::new(), |table| table.meaning)
    }
}

/// The values of an enumeration.
#[doc(hidden)]
#[derive(Default)]
pub struct Values {
    /// A row for each value, and for each of its fields.
    pub rows: Vec<Row>,
    /// `true` if a value has contents, so that the enumeration has a table.
    pub has_contents: bool,
    /// Name of the default value.
    pub default: Option<String>,
}

impl Values {
    /// Returns the values of an enumeration whose values have no contents.
    pub fn words(&self) -> Shape {
        let rows = self.rows.iter();
        Shape::Words(
            rows.map(|row| (row.name.clone(), row.meaning.clone()))
                .collect(),
        )
    }

    /// Returns the meanings of values without contents.
    pub fn meanings(&self) -> String {
        let meaning = |row: &Row| format!("`{}`: {}", row.name, uncapitalized(&row.meaning));
        let meanings: Vec<String> = self.rows.iter().map(meaning).collect();
        meanings.join("; ")
    }

    /// Returns the default as it is written in a file.
    pub fn default_text(&self) -> String {
        let name = self.default.as_ref();
        name.map_or("none".into(), |name| format!("`{name}`"))
    }
}

/// Adds a table, and returns `false` if it was there before.
#[doc(hidden)]
pub fn add_table(
    tables: &mut Vec<Table>,
    name: &'static str,
    attributes: &Attributes,
    rows: Vec<Row>,
    is_enumeration: bool,
) -> bool {
    let is_new = tables.iter().all(|table| table.name != name);
    if is_new {
        let meaning = attributes.meaning();
        tables.push(Table {
            name,
            meaning,
            rows,
            is_enumeration,
        });
    }
    is_new
}

/// Returns the tables of the fields of a file: the file itself first, each structure after the one that contains it.
pub fn tables_of<T: FieldType>() -> Vec<Table> {
    let mut tables = Vec::new();
    T::collect_tables(&mut tables);
    tables
}

fn uncapitalized(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().into_iter();
    let lower = first.flat_map(char::to_lowercase);
    lower.chain(characters).collect()
}

#[cfg(test)]
mod tests;
