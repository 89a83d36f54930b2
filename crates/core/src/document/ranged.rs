//! Numbers with a valid range. A number out of range, NaN and infinity are rejected at their position.

/// Declares newtypes over `f64` that deserialise only within a range, some with a default.
///
/// `Name = "a noun", MIN ..= MAX, "unit", or DEFAULT;` or, for numbers without a fraction, `Name = "a noun", whole MIN ..= …`.
macro_rules! ranged_numbers {
    ($($(#[$meta:meta])*
       $name:ident = $noun:literal, $($whole:ident)? $min:literal ..= $max:literal, $unit:literal $(, or $default:literal)?;)+) => {$(
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// The valid values.
            pub const RANGE: std::ops::RangeInclusive<f64> = $min..=$max;

            /// `true` if a fraction is refused.
            const IS_WHOLE: bool = {
                let words: &[&str] = &[$(stringify!($whole))?];
                words.len() == 1
            };

            /// Returns the value in the unit of the file.
            pub const fn get(self) -> f64 {
                self.0
            }
        }

        $(
            impl Default for $name {
                fn default() -> Self {
                    Self($default)
                }
            }
        )?

        impl $crate::document::FieldType for $name {
            fn shape() -> $crate::document::Shape {
                let default: &[f64] = &[$($default)?];
                $crate::document::Shape::Number {
                    min: $min,
                    max: $max,
                    unit: $unit,
                    is_whole: Self::IS_WHOLE,
                    default: default.first().copied(),
                }
            }

            fn default_text() -> String {
                let default: &[f64] = &[$($default)?];
                default.first().map_or("none".into(), f64::to_string)
            }
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let value = <f64 as serde::Deserialize>::deserialize(deserializer)?;
                if Self::RANGE.contains(&value) {
                    if Self::IS_WHOLE && value.fract() != 0.0 {
                        let message = format!("{value} is not a whole number");
                        return Err(serde::de::Error::custom(message));
                    }
                    return Ok(Self(value));
                }
                Err(serde::de::Error::custom(format!(
                    concat!("{} is out of range: ", $noun, " is {} to {}", $unit),
                    $crate::document::format_number(value),
                    Self::RANGE.start(),
                    Self::RANGE.end(),
                )))
            }
        }
    )+};
}
pub(crate) use ranged_numbers;

/// Formats a number; large and tiny ones in scientific notation, because `Display` writes 1e308 and 1e-308 with 308 zeros.
pub(crate) fn format_number(value: f64) -> String {
    let size = value.abs();
    if value.is_finite() && (size >= 1e9 || (size > 0.0 && size < 1e-6)) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}
