//! Arguments of the program, and errors in them.

use std::borrow::Cow;

use ademan::message::escape;
use clap::Parser;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue};

use crate::Cli;

/// Parses the arguments. Prints help or an error and ends the program otherwise.
pub fn parse() -> Cli {
    Cli::try_parse().unwrap_or_else(|error| escaped(error).exit())
}

/// Returns an error in which the words of the command line are escaped.
fn escaped(mut error: clap::Error) -> clap::Error {
    let fields: Vec<_> = error
        .context()
        .filter_map(|(kind, value)| Some((kind, escaped_field(kind, value)?)))
        .collect();
    for (kind, value) in fields {
        error.insert(kind, value);
    }
    error
}

/// Returns the field of an error without characters that act on a terminal; `None` if it may stay as it is.
fn escaped_field(kind: ContextKind, value: &ContextValue) -> Option<ContextValue> {
    let one = |text: &String| escape(text).into_owned();
    match value {
        // It has lines, and names arguments of the program only.
        _ if kind == ContextKind::Usage => None,
        ContextValue::String(text) => Some(ContextValue::String(one(text))),
        ContextValue::Strings(texts) => {
            Some(ContextValue::Strings(texts.iter().map(one).collect()))
        }
        ContextValue::StyledStr(text) => Some(ContextValue::StyledStr(escaped_style(text))),
        ContextValue::StyledStrs(texts) => Some(ContextValue::StyledStrs(
            texts.iter().map(escaped_style).collect(),
        )),
        _ => None,
    }
}

/// Returns a styled text as it is, or without its style if something in it has to be escaped.
fn escaped_style(text: &StyledStr) -> StyledStr {
    match escape(&text.to_string()) {
        Cow::Borrowed(_) => text.clone(),
        Cow::Owned(text) => text.into(),
    }
}
