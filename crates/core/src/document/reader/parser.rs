//! The side of RON's deserializer.

use std::fmt;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, MapAccess, SeqAccess, VariantAccess, Visitor,
};

use super::fault::Fault;
use super::types::{ElementsReader, EntriesReader, Reader, VariantsReader};
use super::{Content, Elements, Entries, Kind, Names, Seed, Source, Variants, Visit};

/// A visitor or a seed of a type, passed to the parser.
pub(super) struct Passed<'p, P: ?Sized>(pub &'p mut P);

/// A part of the parser, passed to a type, and the error that it returned.
struct Held<P, E> {
    /// `None` after a use that consumes it.
    part: Option<P>,
    error: Option<E>,
}

impl<P, E: Error> Held<P, E> {
    fn new(part: P) -> Self {
        Self {
            part: Some(part),
            error: None,
        }
    }

    fn take(&mut self) -> Result<P, Fault> {
        self.part.take().ok_or_else(used)
    }

    fn part(&mut self) -> Result<&mut P, Fault> {
        self.part.as_mut().ok_or_else(used)
    }

    /// Keeps an error of the parser, and marks that one waits.
    fn keep<T>(&mut self, result: Result<T, E>) -> Result<T, Fault> {
        result.map_err(|error| {
            self.error = Some(error);
            Fault::Waits
        })
    }

    /// Returns the error of the type, or the one that waits, to the parser.
    fn give_back(self, result: Result<(), Fault>) -> Result<(), E> {
        result.map_err(|fault| fault.into_error(self.error))
    }
}

fn used() -> Fault {
    Fault::custom("this part of the text was read before")
}

impl<'de> DeserializeSeed<'de> for Passed<'_, dyn Seed<'de> + '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, value: D) -> Result<(), D::Error> {
        let mut held = Held::new(value);
        let grown = self.0.grow(Reader(&mut held));
        held.give_back(grown)
    }
}

impl<'de> Passed<'_, dyn Visit<'de> + '_> {
    fn visit<E: Error>(self, content: Content<'_, 'de>) -> Result<(), E> {
        let visited = self.0.visit(content);
        visited.map_err(|fault| fault.into_error(None))
    }
}

impl<'de> Visitor<'de> for Passed<'_, dyn Visit<'de> + '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(f)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<(), E> {
        self.visit(Content::Bool(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<(), E> {
        self.visit(Content::Signed(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<(), E> {
        self.visit(Content::Unsigned(value))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<(), E> {
        self.visit(Content::Float(value))
    }

    fn visit_char<E: Error>(self, value: char) -> Result<(), E> {
        self.visit(Content::Char(value))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<(), E> {
        self.visit(Content::Text(value))
    }

    fn visit_borrowed_str<E: Error>(self, value: &'de str) -> Result<(), E> {
        self.visit(Content::Borrowed(value))
    }

    fn visit_none<E: Error>(self) -> Result<(), E> {
        self.visit(Content::None)
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.visit(Content::Unit)
    }

    fn visit_some<D: Deserializer<'de>>(self, value: D) -> Result<(), D::Error> {
        let mut held = Held::new(value);
        let visited = self.0.visit(Content::Some(Reader(&mut held)));
        held.give_back(visited)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, value: D) -> Result<(), D::Error> {
        let mut held = Held::new(value);
        let visited = self.0.visit(Content::Newtype(Reader(&mut held)));
        held.give_back(visited)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<(), A::Error> {
        let mut held = Held::new(list);
        let visited = self.0.visit(Content::List(ElementsReader(&mut held)));
        held.give_back(visited)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<(), A::Error> {
        let mut held = Held::new(map);
        let visited = self.0.visit(Content::Map(EntriesReader(&mut held)));
        held.give_back(visited)
    }

    fn visit_enum<A: EnumAccess<'de>>(self, value: A) -> Result<(), A::Error> {
        let mut held = HeldEnum {
            name: Held::new(value),
            contents: None,
        };
        let visited = self.0.visit(Content::Enum(VariantsReader(&mut held)));
        held.name.give_back(visited)
    }
}

impl<'de, D: Deserializer<'de>> Source<'de> for Held<D, D::Error> {
    fn read(&mut self, kind: Kind, visit: &mut dyn Visit<'de>) -> Result<(), Fault> {
        let (value, visitor) = (self.take()?, Passed(visit));
        let read = match kind {
            Kind::Any => value.deserialize_any(visitor),
            Kind::Bool => value.deserialize_bool(visitor),
            Kind::Signed(8) => value.deserialize_i8(visitor),
            Kind::Signed(16) => value.deserialize_i16(visitor),
            Kind::Signed(32) => value.deserialize_i32(visitor),
            Kind::Signed(_) => value.deserialize_i64(visitor),
            Kind::Unsigned(8) => value.deserialize_u8(visitor),
            Kind::Unsigned(16) => value.deserialize_u16(visitor),
            Kind::Unsigned(32) => value.deserialize_u32(visitor),
            Kind::Unsigned(_) => value.deserialize_u64(visitor),
            Kind::Float(32) => value.deserialize_f32(visitor),
            Kind::Float(_) => value.deserialize_f64(visitor),
            Kind::Char => value.deserialize_char(visitor),
            Kind::Text => value.deserialize_str(visitor),
            Kind::Option => value.deserialize_option(visitor),
            Kind::Unit => value.deserialize_unit(visitor),
            Kind::UnitStruct(name) => value.deserialize_unit_struct(name, visitor),
            Kind::NewtypeStruct(name) => value.deserialize_newtype_struct(name, visitor),
            Kind::List => value.deserialize_seq(visitor),
            Kind::Tuple(length) => value.deserialize_tuple(length, visitor),
            Kind::TupleStruct(name, length) => {
                value.deserialize_tuple_struct(name, length, visitor)
            }
            Kind::Map => value.deserialize_map(visitor),
            Kind::Struct(name, fields) => value.deserialize_struct(name, fields, visitor),
            Kind::Enum(name, values) => value.deserialize_enum(name, values, visitor),
            Kind::Identifier => value.deserialize_identifier(visitor),
            Kind::Ignored => value.deserialize_ignored_any(visitor),
        };
        self.keep(read)
    }
}

impl<'de, A: SeqAccess<'de>> Elements<'de> for Held<A, A::Error> {
    fn next(&mut self, seed: &mut dyn Seed<'de>) -> Result<bool, Fault> {
        let next = self.part()?.next_element_seed(Passed(seed));
        self.keep(next).map(|element| element.is_some())
    }
}

impl<'de, A: MapAccess<'de>> Entries<'de> for Held<A, A::Error> {
    fn key(&mut self, seed: &mut dyn Seed<'de>) -> Result<bool, Fault> {
        let key = self.part()?.next_key_seed(Passed(seed));
        self.keep(key).map(|key| key.is_some())
    }

    fn value(&mut self, seed: &mut dyn Seed<'de>) -> Result<(), Fault> {
        let value = self.part()?.next_value_seed(Passed(seed));
        self.keep(value)
    }
}

/// A value of an enumeration: its name, and its contents after the name.
struct HeldEnum<'de, A: EnumAccess<'de>> {
    name: Held<A, A::Error>,
    contents: Option<A::Variant>,
}

impl<'de, A: EnumAccess<'de>> HeldEnum<'de, A> {
    fn contents(&mut self) -> Result<A::Variant, Fault> {
        self.contents.take().ok_or_else(used)
    }
}

impl<'de, A: EnumAccess<'de>> Variants<'de> for HeldEnum<'de, A> {
    fn name(&mut self, seed: &mut dyn Seed<'de>) -> Result<(), Fault> {
        let read = self.name.take()?.variant_seed(Passed(seed));
        let ((), contents) = self.name.keep(read)?;
        self.contents = Some(contents);
        Ok(())
    }

    fn unit(&mut self) -> Result<(), Fault> {
        let read = self.contents()?.unit_variant();
        self.name.keep(read)
    }

    fn newtype(&mut self, seed: &mut dyn Seed<'de>) -> Result<(), Fault> {
        let read = self.contents()?.newtype_variant_seed(Passed(seed));
        self.name.keep(read)
    }

    fn tuple(&mut self, length: usize, visit: &mut dyn Visit<'de>) -> Result<(), Fault> {
        let read = self.contents()?.tuple_variant(length, Passed(visit));
        self.name.keep(read)
    }

    fn fields(&mut self, names: Names, visit: &mut dyn Visit<'de>) -> Result<(), Fault> {
        let read = self.contents()?.struct_variant(names, Passed(visit));
        self.name.keep(read)
    }
}
