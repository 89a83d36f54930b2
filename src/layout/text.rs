//! Words and labels in a file: a word knows its place.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};

/// The longest label, in characters.
const MAX_LABEL_LENGTH: usize = 16;

/// A piece of the file between quotes, borrowed from it, so that its place is known.
///
/// It is written without escapes, and is never empty. What it stands for is checked by whoever uses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spanned<'a>(pub &'a str);

impl<'de: 'a, 'a> Deserialize<'de> for Spanned<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Borrowed;

        impl<'de> Visitor<'de> for Borrowed {
            type Value = &'de str;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a text in quotes without `\\`")
            }

            fn visit_borrowed_str<E: Error>(self, text: &'de str) -> Result<Self::Value, E> {
                if text.trim().is_empty() {
                    return Err(E::custom("the text is empty"));
                }
                if text.chars().any(|c| c.is_control() && c != '\n') {
                    return Err(E::custom("the text has a control character in it"));
                }
                Ok(text)
            }

            fn visit_str<E: Error>(self, _: &str) -> Result<Self::Value, E> {
                Err(E::custom("this text must be written without `\\`"))
            }
        }

        deserializer.deserialize_str(Borrowed).map(Spanned)
    }
}

/// What is drawn on a key: 1 to 16 characters, no control characters; may be written with escapes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label(pub String);

impl Label {
    /// What is drawn on a control with this label, or else with this name.
    pub fn or_name(label: &Option<Self>, name: Spanned) -> String {
        let label = label.as_ref().map(|label| label.0.clone());
        label.unwrap_or_else(|| name.0.to_owned())
    }
}

impl<'de> Deserialize<'de> for Label {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let length = text.chars().count();
        if length == 0 || length > MAX_LABEL_LENGTH {
            return Err(D::Error::custom(format!(
                "a label has 1 to {MAX_LABEL_LENGTH} characters, this one has {length}"
            )));
        }
        if text.chars().any(char::is_control) {
            return Err(D::Error::custom("the label has a control character in it"));
        }
        Ok(Self(text))
    }
}

/// Pairs in the order in which they stand in the file; unlike a map it keeps those written twice.
#[derive(Clone, Debug)]
pub struct Pairs<'a, V>(pub Vec<(Spanned<'a>, V)>);

impl<V> Default for Pairs<'_, V> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de: 'a, 'a, V: Deserialize<'de>> Deserialize<'de> for Pairs<'a, V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder<V>(PhantomData<V>);

        impl<'de, V: Deserialize<'de>> Visitor<'de> for InOrder<V> {
            type Value = Vec<(Spanned<'de>, V)>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a map such as {\"Q\": \"1\"}")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(pairs)
            }
        }

        deserializer
            .deserialize_map(InOrder(PhantomData))
            .map(Pairs)
    }
}
