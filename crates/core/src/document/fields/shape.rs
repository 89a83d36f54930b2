//! The values that a field accepts, for tables, forms and JSON Schema.

/// The valid values of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// `true` or `false`.
    Bool,
    /// A number in a range.
    Number {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
        /// Unit as it is written after a number, with its blank, such as ` mm`; empty for a pure number.
        unit: &'static str,
        /// `true` if it has no fraction.
        is_whole: bool,
        /// Value of a field that is left out, if the type has one.
        default: Option<f64>,
    },
    /// Any finite number.
    AnyNumber,
    /// A whole number in a range.
    Integer {
        /// Smallest value.
        min: i64,
        /// Largest value.
        max: i64,
    },
    /// A text in quotes.
    Text {
        /// Smallest number of characters.
        min_length: usize,
        /// Largest number of characters, if it is limited.
        max_length: Option<usize>,
    },
    /// One of these words, without quotes, each with its meaning.
    Words(Vec<(String, String)>),
    /// One of these names, in quotes, and their kind, which stands for them in tables; empty to list the names.
    Names(Vec<&'static str>, &'static str),
    /// Values in square brackets.
    List(Box<Shape>),
    /// Values by text, in braces.
    Map(Box<Shape>),
    /// Values by one of these names, in braces; the text is the kind of the names.
    NamedMap(Vec<&'static str>, &'static str, Box<Shape>),
    /// Values by number, in braces.
    NumberedMap(Box<Shape>),
    /// A fixed number of values in parentheses.
    Tuple(Vec<Shape>),
    /// A structure or an enumeration: the name of its table.
    Table(&'static str),
}

impl Shape {
    /// Returns the valid values as a table shows them.
    pub fn words(&self) -> String {
        match self {
            Self::Bool => "`true`, `false`".into(),
            Self::Number { min, max, unit, .. } => format!("{min} to {max}{unit}"),
            Self::AnyNumber => "number".into(),
            Self::Integer { min, max } => format!("{min} to {max}"),
            Self::Text { .. } => "text".into(),
            Self::Words(words) => {
                let words = words.iter().map(|(word, _)| format!("`{word}`"));
                words.collect::<Vec<String>>().join(", ")
            }
            Self::Names(names, "") => {
                let names = names.iter().map(|name| format!("`\"{name}\"`"));
                names.collect::<Vec<String>>().join(", ")
            }
            Self::Names(_, kind) => (*kind).into(),
            Self::List(item) => format!("list of {}", item.words()),
            Self::Map(value) => format!("map from text to {}", value.words()),
            Self::NamedMap(_, kind, value) => format!("map from {kind} to {}", value.words()),
            Self::NumberedMap(value) => format!("map from number to {}", value.words()),
            Self::Tuple(parts) => {
                let parts: Vec<String> = parts.iter().map(Self::words).collect();
                joined(&parts)
            }
            Self::Table(name) => (*name).into(),
        }
    }
}

/// Returns the valid values of the parts of a tuple.
pub(super) fn joined(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [only] => only.clone(),
        [first, rest @ ..] if is_number(first) && rest.iter().all(|part| part == first) => {
            format!("{} numbers, each {first}", parts.len())
        }
        _ => format!("({})", parts.join(", ")),
    }
}

/// Returns `true` for the valid values of a number.
fn is_number(values: &str) -> bool {
    values.starts_with(|first: char| first == '-' || first.is_ascii_digit())
}
