//! Enums with one spelling per value in files, messages and output, and suggestions for misspelled names.

use crate::message::escape;

/// Declares a field-less enum whose values have one name in files, messages and output.
///
/// Generates `ALL`, `NAMES`, `COUNT`, `name`, `index`, `Display`, `FromStr` (whose error suggests the closest valid name or lists
/// them) and serde support by name.
#[macro_export]
macro_rules! named_enum {
    ($(#[$meta:meta])* $vis:vis enum $enum:ident ($kind:literal) {
        $($(#[$variant_meta:meta])* $variant:ident = $name:literal,)+
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        $vis enum $enum { $($(#[$variant_meta])* $variant,)+ }

        impl $enum {
            /// All values, in declaration order.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];
            /// The names of all values, in declaration order.
            pub const NAMES: &'static [&'static str] = &[$($name),+];
            /// The number of values.
            pub const COUNT: usize = Self::ALL.len();

            /// Returns the name used in files, messages and output.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)+ }
            }

            /// Returns the index in [`Self::ALL`].
            pub const fn index(self) -> usize {
                self as usize
            }
        }

        impl std::fmt::Display for $enum {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $enum {
            type Err = $crate::names::UnknownName;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                Self::ALL
                    .iter()
                    .copied()
                    .find(|value| value.name() == text)
                    .ok_or_else(|| {
                        $crate::names::UnknownName::one_of($kind, text, Self::ALL.iter().map(|value| value.name()))
                    })
            }
        }

        impl serde::Serialize for $enum {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }

        impl<'de> serde::Deserialize<'de> for $enum {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = <String as serde::Deserialize>::deserialize(deserializer)?;
                text.parse().map_err(serde::de::Error::custom)
            }
        }
    };
}
pub use named_enum;

/// A name that is not one of the valid names.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {kind} `{}`{}", escape(.text), suggestion(.nearest, .expected))]
pub struct UnknownName {
    /// The kind of thing that the name stands for, such as "joint" or "key".
    pub kind: &'static str,
    /// The name as written.
    pub text: String,
    /// The most similar valid name, if one is similar enough to suggest.
    pub nearest: Option<String>,
    /// The valid names, if they are to be listed because none is similar.
    pub expected: Vec<String>,
}

impl UnknownName {
    /// Creates the error for `text` and searches `valid` for a name to suggest.
    pub fn new<'a>(
        kind: &'static str,
        text: &str,
        valid: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        Self::among(kind, text, valid.into_iter().collect())
    }

    fn among(kind: &'static str, text: &str, valid: Vec<&str>) -> Self {
        let usual = OTHER_WORDS.into_iter().find_map(|(word, name)| {
            let is_meant = text.eq_ignore_ascii_case(word) && valid.contains(&name);
            is_meant.then_some(name)
        });
        Self {
            kind,
            text: text.to_owned(),
            nearest: usual.or_else(|| nearest(text, valid)).map(str::to_owned),
            expected: Vec::new(),
        }
    }

    /// Creates the error for `text`, which suggests a similar name in `valid`. Without one it lists them, unless they are more than 32.
    pub fn one_of<'a>(
        kind: &'static str,
        text: &str,
        valid: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let valid: Vec<&str> = valid.into_iter().collect();
        let error = Self::new(kind, text, valid.iter().copied());
        if error.nearest.is_some() || valid.len() > MAX_EXPECTED {
            return error;
        }
        Self {
            expected: valid.into_iter().map(str::to_owned).collect(),
            ..error
        }
    }
}

/// Usual words for a thing whose name is spelled in no similar way, and that name.
const OTHER_WORDS: [(&str, &str); 2] = [("pinky", "little"), ("pinkie", "little")];

/// The largest number of valid names that an error lists.
const MAX_EXPECTED: usize = 32;

fn suggestion(nearest: &Option<String>, expected: &[String]) -> String {
    match nearest {
        Some(name) => format!(", did you mean `{}`?", escape(name)),
        None if expected.is_empty() => String::new(),
        None => {
            let names: Vec<_> = expected.iter().map(|name| escape(name)).collect();
            format!(", expected one of: {}", names.join(", "))
        }
    }
}

/// The longest text, in bytes, for which a similar name is searched. The time and memory of a comparison grow with
/// the product of both lengths.
const MAX_COMPARED_LEN: usize = 128;

/// The lowest similarity, 0..=1, of a name that is suggested: half of its letters. Less suggests `Minus` for `Win`.
const MIN_SIMILARITY: f64 = 0.5;

/// Returns the name in `valid` that is spelled most like `text`, or `None` if none is similar or `text` is longer
/// than 128 bytes. Ignores case. Of equally similar names, it is the one whose wrong letters are nearest on a keyboard, then the
/// first.
pub fn nearest<'a>(text: &str, valid: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if text.len() > MAX_COMPARED_LEN {
        return None;
    }
    let wanted = text.to_lowercase();
    valid
        .into_iter()
        .filter(|name| name.len() <= MAX_COMPARED_LEN)
        .map(|name| {
            let lower = name.to_lowercase();
            let similarity = strsim::normalized_damerau_levenshtein(&wanted, &lower);
            (similarity, key_distance(&wanted, &lower), name)
        })
        .filter(|(similarity, ..)| *similarity >= MIN_SIMILARITY)
        .min_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)))
        .map(|(.., name)| name)
}

/// The digits and letters of a QWERTY keyboard, and the offset of each row in keys.
const KEY_ROWS: [(&str, f32); 4] = [
    ("1234567890", 0.0),
    ("qwertyuiop", 0.5),
    ("asdfghjkl", 0.75),
    ("zxcvbnm", 1.25),
];

/// Returns the sum of the distances, in keys, of the characters in which two texts of one length differ. It is 10 for a pair with
/// another character, and 20 for texts of different lengths.
fn key_distance(one: &str, other: &str) -> f32 {
    const FAR: f32 = 10.0;
    let place = |letter: char| {
        let mut rows = KEY_ROWS.iter().zip([0.0_f32, 1.0, 2.0, 3.0]);
        rows.find_map(|((letters, offset), row)| {
            let column = letters.find(letter)?;
            Some((column as f32 + offset, row))
        })
    };
    if one.chars().count() != other.chars().count() {
        return 2.0 * FAR;
    }
    let differing = one.chars().zip(other.chars()).filter(|(a, b)| a != b);
    let distances = differing.map(|(a, b)| match (place(a), place(b)) {
        (Some(a), Some(b)) => (a.0 - b.0).hypot(a.1 - b.1),
        _ => FAR,
    });
    distances.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_ignores_case_and_swapped_letters() {
        let keys = ["ShiftLeft", "Space", "Semicolon"];
        assert_eq!(nearest("shfitleft", keys), Some("ShiftLeft"));
        assert_eq!(nearest("zzzz", keys), None);
        assert_eq!(nearest("Win", ["Minus", "Quote"]), None);
    }

    #[test]
    fn of_equally_similar_names_the_one_with_the_nearest_key_comes_first() {
        let layouts = ["azerty-flat", "qwerty-flat", "qwertz-flat"];
        assert_eq!(nearest("qwerti-flat", layouts), Some("qwerty-flat"));
        assert_eq!(nearest("qwertx-flat", layouts), Some("qwertz-flat"));
        assert_eq!(nearest("F13", ["F1", "F10", "F12"]), Some("F12"));
        let tied = ["qwerty-flat", "qwertz-flat"];
        let first = nearest("qwert!-flat", tied);
        assert_eq!(first, Some("qwerty-flat"), "both are as far away");
    }

    #[test]
    fn texts_over_128_bytes_are_not_compared() {
        let (long, name) = ("a".repeat(5_000), "a".repeat(100));
        assert_eq!(nearest(&long, [&*long]), None);
        assert_eq!(nearest(&long[..129], [&*name]), None);
        assert_eq!(nearest(&long[..101], [&*long, &*name]), Some(&*name));
    }

    #[test]
    fn an_unknown_name_suggests_the_nearest() {
        let error = UnknownName::new("key", "Spcae", ["Space", "Tab"]);
        assert_eq!(
            error.to_string(),
            "unknown key `Spcae`, did you mean `Space`?"
        );
    }

    #[test]
    fn names_are_listed_if_none_is_similar_and_they_are_few() {
        let fingers = ["ring", "little"];
        let error = |text: &str| UnknownName::one_of("finger", text, fingers).to_string();
        assert_eq!(
            error("pointer"),
            "unknown finger `pointer`, expected one of: ring, little"
        );
        assert_eq!(error("rnig"), "unknown finger `rnig`, did you mean `ring`?");
        let many = ["ring"; 33];
        let unlisted = UnknownName::one_of("finger", "pointer", many);
        assert_eq!(unlisted.to_string(), "unknown finger `pointer`");
    }

    #[test]
    fn another_word_for_a_thing_suggests_its_name() {
        let fingers = ["ring", "little"];
        for word in ["pinky", "Pinkie"] {
            let error = UnknownName::new("finger", word, fingers);
            assert_eq!(error.nearest.as_deref(), Some("little"), "{word}");
        }
        let error = UnknownName::new("key", "pinky", ["Space"]);
        assert_eq!(error.nearest, None, "no key is a finger");
    }
}
