//! Errors on their way through trait objects.

use std::fmt;

use serde::de::{Error, Expected, Unexpected};

use super::Names;

/// An error that a type found, or the mark of one that the parser found.
#[derive(Debug)]
pub(super) enum Fault {
    /// The error waits at the part of the parser that returned it.
    Waits,
    Message(String),
    InvalidText {
        found: String,
        expected: String,
    },
    InvalidValue {
        found: String,
        expected: String,
    },
    InvalidLength {
        found: usize,
        expected: String,
    },
    UnknownValue(String, Names),
    UnknownField(String, Names),
    MissingField(&'static str),
    DuplicateField(&'static str),
}

impl Fault {
    /// Returns the error as the parser's own: the one that `waits`, if this is its mark.
    pub(super) fn into_error<E: Error>(self, waits: Option<E>) -> E {
        match self {
            Self::Waits => waits.unwrap_or_else(|| E::custom(&self)),
            Self::Message(message) => E::custom(message),
            Self::InvalidText { found, expected } => {
                E::invalid_value(Unexpected::Str(&found), &expected.as_str())
            }
            Self::InvalidValue { found, expected } => {
                E::invalid_value(Unexpected::Other(&found), &expected.as_str())
            }
            Self::InvalidLength { found, expected } => E::invalid_length(found, &expected.as_str()),
            Self::UnknownValue(found, expected) => E::unknown_variant(&found, expected),
            Self::UnknownField(found, expected) => E::unknown_field(&found, expected),
            Self::MissingField(name) => E::missing_field(name),
            Self::DuplicateField(name) => E::duplicate_field(name),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Waits => f.write_str("invalid RON"),
            Self::Message(message) => f.write_str(message),
            Self::InvalidText { found, expected } | Self::InvalidValue { found, expected } => {
                write!(f, "invalid value: {found}, expected {expected}")
            }
            Self::InvalidLength { found, expected } => {
                write!(f, "invalid length {found}, expected {expected}")
            }
            Self::UnknownValue(found, _) => write!(f, "unknown value `{found}`"),
            Self::UnknownField(found, _) => write!(f, "unknown field `{found}`"),
            Self::MissingField(name) => write!(f, "missing field `{name}`"),
            Self::DuplicateField(name) => write!(f, "duplicate field `{name}`"),
        }
    }
}

impl std::error::Error for Fault {}

impl Error for Fault {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::Message(message.to_string())
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_value(found, expected)
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let expected = expected.to_string();
        match found {
            Unexpected::Str(text) => Self::InvalidText {
                found: text.to_owned(),
                expected,
            },
            found => Self::InvalidValue {
                found: found.to_string(),
                expected,
            },
        }
    }

    fn invalid_length(found: usize, expected: &dyn Expected) -> Self {
        Self::InvalidLength {
            found,
            expected: expected.to_string(),
        }
    }

    fn unknown_variant(found: &str, expected: Names) -> Self {
        Self::UnknownValue(found.to_owned(), expected)
    }

    fn unknown_field(found: &str, expected: Names) -> Self {
        Self::UnknownField(found.to_owned(), expected)
    }

    fn missing_field(name: &'static str) -> Self {
        Self::MissingField(name)
    }

    fn duplicate_field(name: &'static str) -> Self {
        Self::DuplicateField(name)
    }
}
