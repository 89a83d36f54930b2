//! Tables of the fields of a file, read from the declarations of its schema.
//!
//! A structure or enumeration in [`schema!`] has a table. The doc comment of a field is its meaning; its last sentence may be
//! `Default: ….`, for a default that the type of the field does not have.

use serde::Serialize;

/// The fields of a structure, or the values of an enumeration.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Table {
    /// Name of the structure or enumeration in a RON text.
    pub name: &'static str,
    /// Description, a sentence.
    pub meaning: String,
    /// Rows in the order of the declaration.
    pub rows: Vec<Row>,
}

/// A field of a structure, a value of an enumeration, or a field of such a value.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Row {
    /// Name; for the field of a value with the name of the value, such as `Arc(radius_mm)`.
    pub name: String,
    /// Value of a field that is left out, or `required`. Empty for the value of an enumeration.
    pub default: String,
    /// Valid values, or the name of the table that has them.
    pub values: String,
    /// Description, a sentence.
    pub meaning: String,
}

/// A type of the fields of a file.
pub(crate) trait FieldType {
    /// Returns the valid values, or the name of the table that has them.
    fn values() -> String;

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

/// The attributes of a declaration: lines of its doc comment, and all of them as text.
pub(crate) struct Attributes {
    pub lines: &'static [&'static str],
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
    pub(crate) fn field<T: FieldType>(name: String, attributes: &Attributes) -> Self {
        let default = match attributes.stated_default() {
            Some(default) => default,
            None if attributes.has("default") => T::default_text(),
            None => "required".into(),
        };
        let mut meaning = attributes.meaning();
        if meaning.is_empty() {
            meaning = meaning_of_table::<T>();
        }
        let explanation = T::explanation();
        if !explanation.is_empty() {
            meaning = format!("{meaning}. {explanation}");
        }
        Self {
            name,
            default,
            values: T::values(),
            meaning,
        }
    }

    /// Describes a value of an enumeration with these contents.
    pub(crate) fn value(name: String, contents: &[String], attributes: &Attributes) -> Self {
        Self {
            name,
            default: String::new(),
            values: joined(contents),
            meaning: attributes.meaning(),
        }
    }
}

/// Returns `true` for the valid values of a number.
fn is_number(values: &str) -> bool {
    values.starts_with(|first: char| first == '-' || first.is_ascii_digit())
}

/// The values of an enumeration.
#[derive(Default)]
pub(crate) struct Values {
    /// A row for each value, and for each of its fields.
    pub rows: Vec<Row>,
    /// A value has contents, so that the enumeration has a table.
    pub has_contents: bool,
    /// Name of the default value.
    pub default: Option<String>,
}

impl Values {
    /// Returns the names of values without contents.
    pub fn names(&self) -> String {
        let names: Vec<String> = self
            .rows
            .iter()
            .map(|row| format!("`{}`", row.name))
            .collect();
        names.join(", ")
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

/// Returns the meaning of the first table of a type.
fn meaning_of_table<T: FieldType>() -> String {
    let mut tables = Vec::new();
    T::collect_tables(&mut tables);
    let first = tables.into_iter().next();
    first.map_or(String::new(), |table| table.meaning)
}

/// Adds a table, and returns `false` if it was there before.
pub(crate) fn add_table(
    tables: &mut Vec<Table>,
    name: &'static str,
    attributes: &Attributes,
    rows: Vec<Row>,
) -> bool {
    let is_new = tables.iter().all(|table| table.name != name);
    if is_new {
        let meaning = attributes.meaning();
        tables.push(Table {
            name,
            meaning,
            rows,
        });
    }
    is_new
}

/// Returns the valid values of the parts of a tuple.
fn joined(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [only] => only.clone(),
        [first, rest @ ..] if is_number(first) && rest.iter().all(|part| part == first) => {
            format!("{} numbers, each {first}", parts.len())
        }
        _ => format!("({})", parts.join(", ")),
    }
}

fn uncapitalized(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().into_iter();
    let lower = first.flat_map(char::to_lowercase);
    lower.chain(characters).collect()
}

impl FieldType for bool {
    fn values() -> String {
        "`true`, `false`".into()
    }

    fn default_text() -> String {
        "`false`".into()
    }
}

impl<T: FieldType> FieldType for Option<T> {
    fn values() -> String {
        T::values()
    }

    fn default_text() -> String {
        T::default_text()
    }

    fn explanation() -> String {
        T::explanation()
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        T::collect_tables(tables);
    }
}

impl<T: FieldType> FieldType for Vec<T> {
    fn values() -> String {
        format!("list of {}", T::values())
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        T::collect_tables(tables);
    }
}

impl<A: FieldType, B: FieldType> FieldType for (A, B) {
    fn values() -> String {
        joined(&[A::values(), B::values()])
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        A::collect_tables(tables);
        B::collect_tables(tables);
    }
}

impl<A: FieldType, B: FieldType, C: FieldType> FieldType for (A, B, C) {
    fn values() -> String {
        joined(&[A::values(), B::values(), C::values()])
    }

    fn default_text() -> String {
        let defaults = [A::default_text(), B::default_text(), C::default_text()];
        format!("({})", defaults.join(", "))
    }
}

impl FieldType for super::Spanned<'_> {
    fn values() -> String {
        "text".into()
    }
}

impl<V: FieldType> FieldType for super::Pairs<'_, V> {
    fn values() -> String {
        format!("map from text to {}", V::values())
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        V::collect_tables(tables);
    }
}

/// Returns the [`Attributes`] of a declaration.
macro_rules! attributes {
    ($([$($attribute:tt)*])*) => {
        $crate::document::Attributes {
            lines: &[$($crate::document::doc_line!($($attribute)*)),*],
            texts: &[$(stringify!($($attribute)*)),*],
        }
    };
}

/// Returns the text of a line of a doc comment, an empty text for another attribute.
macro_rules! doc_line {
    (doc = $line:literal) => {
        $line
    };
    ($($other:tt)*) => {
        ""
    };
}

/// Declares a structure or an enumeration of a file, with its [`Table`].
///
/// An enumeration of values without contents has no table: the fields of its type explain them.
macro_rules! schema {
    (
        $(#[$($attribute:tt)*])*
        $visibility:vis struct $name:ident $(<$lifetime:lifetime>)? {
            $(
                $(#[$($field_attribute:tt)*])*
                $field_visibility:vis $field:ident: $type:ty,
            )+
        }
    ) => {
        $(#[$($attribute)*])*
        $visibility struct $name $(<$lifetime>)? {
            $(
                $(#[$($field_attribute)*])*
                $field_visibility $field: $type,
            )+
        }

        impl$(<$lifetime>)? $crate::document::FieldType for $name$(<$lifetime>)? {
            fn values() -> String {
                let attributes = $crate::document::attributes!($([$($attribute)*])*);
                attributes.name(stringify!($name)).to_owned()
            }

            fn collect_tables(tables: &mut Vec<$crate::document::Table>) {
                let attributes = $crate::document::attributes!($([$($attribute)*])*);
                let rows = vec![$(
                    $crate::document::Row::field::<$type>(
                        stringify!($field).to_owned(),
                        &$crate::document::attributes!($([$($field_attribute)*])*),
                    )
                ),+];
                let name = attributes.name(stringify!($name));
                if $crate::document::add_table(tables, name, &attributes, rows) {
                    $(<$type as $crate::document::FieldType>::collect_tables(tables);)+
                }
            }
        }
    };
    (
        $(#[$($attribute:tt)*])*
        $visibility:vis enum $name:ident $(<$lifetime:lifetime>)? {
            $(
                $(#[$($value_attribute:tt)*])*
                $value:ident
                $(($($content:ty),+))?
                $({
                    $(
                        $(#[$($field_attribute:tt)*])*
                        $field:ident: $type:ty,
                    )+
                })?,
            )+
        }
    ) => {
        $(#[$($attribute)*])*
        $visibility enum $name $(<$lifetime>)? {
            $(
                $(#[$($value_attribute)*])*
                $value
                $(($($content),+))?
                $({
                    $(
                        $(#[$($field_attribute)*])*
                        $field: $type,
                    )+
                })?,
            )+
        }

        impl$(<$lifetime>)? $name$(<$lifetime>)? {
            /// Returns the values, and the fields of each.
            fn described_values() -> $crate::document::Values {
                let attributes = $crate::document::attributes!($([$($attribute)*])*);
                let mut values = $crate::document::Values::default();
                $(
                    let mut name = stringify!($value).to_owned();
                    if attributes.has_lower_case_values() {
                        name.make_ascii_lowercase();
                    }
                    let contents: &[String] =
                        &[$($(<$content as $crate::document::FieldType>::values()),+)?];
                    values.has_contents |= !contents.is_empty();
                    let value_attributes = $crate::document::attributes!($([$($value_attribute)*])*);
                    if value_attributes.is_of_default_value() {
                        values.default = Some(name.clone());
                    }
                    values.rows.push($crate::document::Row::value(name, contents, &value_attributes));
                    $($(
                        values.has_contents = true;
                        values.rows.push($crate::document::Row::field::<$type>(
                            concat!(stringify!($value), "(", stringify!($field), ")").to_owned(),
                            &$crate::document::attributes!($([$($field_attribute)*])*),
                        ));
                    )+)?
                )+
                values
            }
        }

        impl$(<$lifetime>)? $crate::document::FieldType for $name$(<$lifetime>)? {
            fn values() -> String {
                let values = Self::described_values();
                if values.has_contents {
                    let attributes = $crate::document::attributes!($([$($attribute)*])*);
                    return attributes.name(stringify!($name)).to_owned();
                }
                values.names()
            }

            fn default_text() -> String {
                Self::described_values().default_text()
            }

            fn explanation() -> String {
                let values = Self::described_values();
                if values.has_contents {
                    return String::new();
                }
                values.meanings()
            }

            fn collect_tables(tables: &mut Vec<$crate::document::Table>) {
                let values = Self::described_values();
                if !values.has_contents {
                    return;
                }
                let attributes = $crate::document::attributes!($([$($attribute)*])*);
                let name = attributes.name(stringify!($name));
                if $crate::document::add_table(tables, name, &attributes, values.rows) {
                    $(
                        $($(<$content as $crate::document::FieldType>::collect_tables(tables);)+)?
                        $($(<$type as $crate::document::FieldType>::collect_tables(tables);)+)?
                    )+
                }
            }
        }
    };
}
pub(crate) use {attributes, doc_line, schema};

#[cfg(test)]
mod tests;
