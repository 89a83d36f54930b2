//! The names of the fields of a structure, asked of its own deserialiser.

use serde::de::value::Error;
use serde::de::{Deserialize, Deserializer, Error as _, Visitor};

/// A structure of a file, and the fields that it has.
#[derive(Clone, Copy, Debug)]
pub struct Structure {
    /// The name in the RON text, which is usually omitted.
    pub name: &'static str,
    /// The field that contains it, such as `rows`.
    pub place: &'static str,
    /// The names of its fields.
    pub fields: &'static [&'static str],
}

impl Structure {
    /// Returns the names of `T`, which is found in `place`.
    pub fn of<'de, T: Deserialize<'de>>(place: &'static str) -> Self {
        let mut structure = Self {
            name: "",
            place,
            fields: &[],
        };
        // The probe has no values: it fails as soon as it knows the names.
        let _ = T::deserialize(Probe(&mut structure));
        structure
    }
}

struct Probe<'s>(&'s mut Structure);

impl<'de> Deserializer<'de> for Probe<'_> {
    type Error = Error;

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Error> {
        (self.0.name, self.0.fields) = (name, fields);
        Err(Error::custom(""))
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(Error::custom(""))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_structure_tells_its_fields() {
        #[derive(serde::Deserialize)]
        #[serde(rename = "Point")]
        #[expect(dead_code, reason = "only its names are read")]
        struct Named {
            x: f32,
            y: f32,
        }
        let structure = Structure::of::<Named>("points");
        assert_eq!(
            (structure.name, structure.fields),
            ("Point", &["x", "y"][..])
        );
    }
}
