//! Names that people type: enums spelled one way everywhere, and the nearest valid name to a wrong one.

/// Declares a field-less enum whose variants are spelled the same in files, messages and output.
///
/// Gives `ALL`, `COUNT`, `name`, `index`, `Display`, `FromStr` (its error names the nearest valid
/// name) and serde by name.
macro_rules! named_enum {
    ($(#[$meta:meta])* $vis:vis enum $enum:ident ($what:literal) {
        $($(#[$variant_meta:meta])* $variant:ident = $name:literal,)+
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        $vis enum $enum { $($(#[$variant_meta])* $variant,)+ }

        impl $enum {
            /// All values, in order.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];
            /// How many there are.
            pub const COUNT: usize = Self::ALL.len();

            /// The name as written in files and output.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)+ }
            }

            /// The place in [`Self::ALL`].
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
                        $crate::names::UnknownName::new($what, text, Self::ALL.iter().map(|value| value.name()))
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
pub(crate) use named_enum;

/// A name that is not one of the valid ones.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {kind} `{text}`{}", suggestion(.nearest))]
pub struct UnknownName {
    /// What kind of thing was looked for: "joint", "key", ….
    pub kind: &'static str,
    /// The name as written.
    pub text: String,
    /// The valid name that is spelled most like it, when one is near enough to be meant.
    pub nearest: Option<String>,
}

impl UnknownName {
    /// Looks among `valid` for what `text` may have meant.
    pub fn new<'a>(
        what: &'static str,
        text: &str,
        valid: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        Self {
            kind: what,
            text: text.to_owned(),
            nearest: nearest(text, valid).map(str::to_owned),
        }
    }
}

fn suggestion(nearest: &Option<String>) -> String {
    match nearest {
        Some(name) => format!(", did you mean `{name}`?"),
        None => String::new(),
    }
}

/// Longer words than this, in bytes, are compared with nothing: that takes time and memory by the product of
/// both lengths, and nobody means a name by them.
const LONGEST: usize = 128;

/// The name among `valid` that is spelled most like `text`; `None` when nothing is close, or when it is
/// longer than any name.
pub fn nearest<'a>(text: &str, valid: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if text.len() > LONGEST {
        return None;
    }
    let wanted = text.to_lowercase();
    valid
        .into_iter()
        .filter(|name| name.len() <= LONGEST)
        .map(|name| {
            (
                strsim::normalized_damerau_levenshtein(&wanted, &name.to_lowercase()),
                name,
            )
        })
        .filter(|(likeness, _)| *likeness >= 0.4)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_ignores_case_and_swapped_letters() {
        let keys = ["ShiftLeft", "Space", "Semicolon"];
        assert_eq!(nearest("shfitleft", keys), Some("ShiftLeft"));
        assert_eq!(nearest("zzzz", keys), None);
    }

    #[test]
    fn words_without_end_are_compared_with_nothing() {
        let (endless, name) = ("a".repeat(5_000), "a".repeat(100));
        assert_eq!(nearest(&endless, [&*endless]), None);
        assert_eq!(nearest(&endless[..129], [&*name]), None);
        assert_eq!(nearest(&endless[..101], [&*endless, &*name]), Some(&*name));
    }

    #[test]
    fn an_unknown_name_says_what_may_have_been_meant() {
        let error = UnknownName::new("key", "Spcae", ["Space", "Tab"]);
        assert_eq!(
            error.to_string(),
            "unknown key `Spcae`, did you mean `Space`?"
        );
    }
}
