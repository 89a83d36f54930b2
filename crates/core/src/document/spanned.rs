//! Quoted texts with their position.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};

/// A quoted text together with its position in the document.
///
/// The borrowed slice gives the position, so the text must be written without escapes. It is not empty and contains no
/// control characters other than line breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spanned<'a> {
    /// The text between the quotes, a slice of [`Document::text`](super::Document::text).
    pub text: &'a str,
}

impl<'de: 'a, 'a> Deserialize<'de> for Spanned<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct BorrowedText;

        impl<'de> Visitor<'de> for BorrowedText {
            type Value = &'de str;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a text in quotes without `\\`")
            }

            fn visit_borrowed_str<E: Error>(self, text: &'de str) -> Result<Self::Value, E> {
                if text.trim().is_empty() {
                    return Err(E::custom("the text is empty"));
                }
                if text.chars().any(|c| c.is_control() && c != '\n') {
                    return Err(E::custom("the text contains a control character"));
                }
                Ok(text)
            }

            fn visit_str<E: Error>(self, _: &str) -> Result<Self::Value, E> {
                Err(E::custom("this text must be written without `\\`"))
            }
        }

        let text = deserializer.deserialize_str(BorrowedText)?;
        Ok(Self { text })
    }
}
