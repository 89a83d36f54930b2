//! The side of the types that are read.

use std::fmt;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};

use super::fault::Fault;
use super::{Content, Elements, Entries, Kind, Names, Seed, Source, Variants, Visit};

/// A value in the text.
pub(super) struct Reader<'r, 'de>(pub &'r mut dyn Source<'de>);

/// The elements of a list.
pub(super) struct ElementsReader<'r, 'de>(pub &'r mut dyn Elements<'de>);

/// The entries of a map, or the fields of a structure.
pub(super) struct EntriesReader<'r, 'de>(pub &'r mut dyn Entries<'de>);

/// A value of an enumeration.
pub(super) struct VariantsReader<'r, 'de>(pub &'r mut dyn Variants<'de>);

/// A seed, and what grew from it.
pub(super) struct Planted<'de, S: DeserializeSeed<'de>> {
    seed: Option<S>,
    value: Option<S::Value>,
}

impl<'de, S: DeserializeSeed<'de>> Planted<'de, S> {
    pub(super) fn new(seed: S) -> Self {
        Self {
            seed: Some(seed),
            value: None,
        }
    }

    /// Returns what grew.
    ///
    /// # Panics
    ///
    /// Panics if nothing was read.
    pub(super) fn into_value(self) -> S::Value {
        self.value.expect("a parser that succeeds has read a value")
    }
}

impl<'de, S: DeserializeSeed<'de>> Seed<'de> for Planted<'de, S> {
    fn grow(&mut self, value: Reader<'_, 'de>) -> Result<(), Fault> {
        if let Some(seed) = self.seed.take() {
            self.value = Some(seed.deserialize(value)?);
        }
        Ok(())
    }
}

/// A visitor, what it does with a content, and what it returned.
struct Waiting<'de, V: Visitor<'de>> {
    visitor: Option<V>,
    accept: Accept<'de, V>,
    value: Option<V::Value>,
}

/// Passes a content to a visitor.
type Accept<'de, V> = fn(V, Content<'_, 'de>) -> Result<<V as Visitor<'de>>::Value, Fault>;

impl<'de, V: Visitor<'de>> Waiting<'de, V> {
    fn new(visitor: V, accept: Accept<'de, V>) -> Self {
        Self {
            visitor: Some(visitor),
            accept,
            value: None,
        }
    }

    fn into_value(self) -> V::Value {
        self.value.expect("a parser that succeeds has visited")
    }
}

impl<'de, V: Visitor<'de>> Visit<'de> for Waiting<'de, V> {
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.visitor {
            Some(visitor) => visitor.expecting(f),
            None => f.write_str("a value"),
        }
    }

    fn visit(&mut self, content: Content<'_, 'de>) -> Result<(), Fault> {
        if let Some(visitor) = self.visitor.take() {
            self.value = Some((self.accept)(visitor, content)?);
        }
        Ok(())
    }
}

impl Content<'_, '_> {
    fn unexpected(&self) -> Unexpected<'_> {
        match self {
            Self::Bool(value) => Unexpected::Bool(*value),
            Self::Signed(value) => Unexpected::Signed(*value),
            Self::Unsigned(value) => Unexpected::Unsigned(*value),
            Self::Float(value) => Unexpected::Float(*value),
            Self::Char(value) => Unexpected::Char(*value),
            Self::Text(value) | Self::Borrowed(value) => Unexpected::Str(value),
            Self::None | Self::Some(_) => Unexpected::Option,
            Self::Unit => Unexpected::Unit,
            Self::Newtype(_) => Unexpected::NewtypeStruct,
            Self::List(_) => Unexpected::Seq,
            Self::Map(_) => Unexpected::Map,
            Self::Enum(_) => Unexpected::Enum,
        }
    }

    fn not_for<T>(&self, visitor: &dyn serde::de::Expected) -> Result<T, Fault> {
        Err(Fault::invalid_type(self.unexpected(), visitor))
    }
}

/// Declares functions that pass the contents which a parser may have there to a visitor.
macro_rules! accept {
    ($($name:ident { $($content:ident $(($value:ident))? => $visit:ident,)+ })+) => {$(
        fn $name<'de, V: Visitor<'de>>(
            visitor: V,
            content: Content<'_, 'de>,
        ) -> Result<V::Value, Fault> {
            match content {
                $(Content::$content $(($value))? => visitor.$visit($($value)?),)+
                #[allow(unreachable_patterns)]
                other => other.not_for(&visitor),
            }
        }
    )+};
}

accept! {
    bool { Bool(value) => visit_bool, }
    number {
        Signed(value) => visit_i64,
        Unsigned(value) => visit_u64,
        Float(value) => visit_f64,
    }
    char { Char(value) => visit_char, }
    text {
        Text(value) => visit_str,
        Borrowed(value) => visit_borrowed_str,
    }
    option {
        None => visit_none,
        Unit => visit_unit,
        Some(value) => visit_some,
    }
    unit { Unit => visit_unit, }
    newtype { Newtype(value) => visit_newtype_struct, }
    list { List(elements) => visit_seq, }
    map { Map(entries) => visit_map, }
    variant { Enum(value) => visit_enum, }
    any {
        Bool(value) => visit_bool,
        Signed(value) => visit_i64,
        Unsigned(value) => visit_u64,
        Float(value) => visit_f64,
        Char(value) => visit_char,
        Text(value) => visit_str,
        Borrowed(value) => visit_borrowed_str,
        None => visit_none,
        Unit => visit_unit,
        Some(value) => visit_some,
        Newtype(value) => visit_newtype_struct,
        List(elements) => visit_seq,
        Map(entries) => visit_map,
        Enum(value) => visit_enum,
    }
}

impl<'de> Reader<'_, 'de> {
    fn read<V: Visitor<'de>>(
        self,
        kind: Kind,
        visitor: V,
        accept: Accept<'de, V>,
    ) -> Result<V::Value, Fault> {
        let mut waiting = Waiting::new(visitor, accept);
        self.0.read(kind, &mut waiting)?;
        Ok(waiting.into_value())
    }
}

/// Declares methods of a deserializer: the method, the parameters before the visitor, the kind, and the accepted contents.
macro_rules! deserialize {
    ($($method:ident($($parameter:ident: $type:ty),*) $kind:expr, $accept:ident;)+) => {$(
        fn $method<V: Visitor<'de>>(
            self,
            $($parameter: $type,)*
            visitor: V,
        ) -> Result<V::Value, Fault> {
            self.read($kind, visitor, $accept)
        }
    )+};
}

impl<'de> Deserializer<'de> for Reader<'_, 'de> {
    type Error = Fault;

    deserialize! {
        deserialize_any() Kind::Any, any;
        deserialize_bool() Kind::Bool, bool;
        deserialize_i8() Kind::Signed(8), number;
        deserialize_i16() Kind::Signed(16), number;
        deserialize_i32() Kind::Signed(32), number;
        deserialize_i64() Kind::Signed(64), number;
        deserialize_u8() Kind::Unsigned(8), number;
        deserialize_u16() Kind::Unsigned(16), number;
        deserialize_u32() Kind::Unsigned(32), number;
        deserialize_u64() Kind::Unsigned(64), number;
        deserialize_f32() Kind::Float(32), number;
        deserialize_f64() Kind::Float(64), number;
        deserialize_char() Kind::Char, char;
        deserialize_str() Kind::Text, text;
        deserialize_string() Kind::Text, text;
        deserialize_bytes() Kind::Any, any;
        deserialize_byte_buf() Kind::Any, any;
        deserialize_option() Kind::Option, option;
        deserialize_unit() Kind::Unit, unit;
        deserialize_unit_struct(name: &'static str) Kind::UnitStruct(name), unit;
        deserialize_newtype_struct(name: &'static str) Kind::NewtypeStruct(name), newtype;
        deserialize_seq() Kind::List, list;
        deserialize_tuple(length: usize) Kind::Tuple(length), list;
        deserialize_tuple_struct(name: &'static str, length: usize) Kind::TupleStruct(name, length), list;
        deserialize_map() Kind::Map, map;
        deserialize_struct(name: &'static str, fields: Names) Kind::Struct(name, fields), map;
        deserialize_enum(name: &'static str, values: Names) Kind::Enum(name, values), variant;
        deserialize_identifier() Kind::Identifier, text;
        deserialize_ignored_any() Kind::Ignored, any;
    }
}

impl<'de> SeqAccess<'de> for ElementsReader<'_, 'de> {
    type Error = Fault;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Fault> {
        let mut planted = Planted::new(seed);
        self.0.next(&mut planted)?;
        Ok(planted.value)
    }
}

impl<'de> MapAccess<'de> for EntriesReader<'_, 'de> {
    type Error = Fault;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Fault> {
        let mut planted = Planted::new(seed);
        self.0.key(&mut planted)?;
        Ok(planted.value)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Fault> {
        let mut planted = Planted::new(seed);
        self.0.value(&mut planted)?;
        Ok(planted.into_value())
    }
}

impl<'de> EnumAccess<'de> for VariantsReader<'_, 'de> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<(S::Value, Self), Fault> {
        let mut planted = Planted::new(seed);
        self.0.name(&mut planted)?;
        Ok((planted.into_value(), self))
    }
}

impl<'de> VariantAccess<'de> for VariantsReader<'_, 'de> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        self.0.unit()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, Fault> {
        let mut planted = Planted::new(seed);
        self.0.newtype(&mut planted)?;
        Ok(planted.into_value())
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Fault> {
        let mut waiting = Waiting::new(visitor, list);
        self.0.tuple(length, &mut waiting)?;
        Ok(waiting.into_value())
    }

    fn struct_variant<V: Visitor<'de>>(self, names: Names, visitor: V) -> Result<V::Value, Fault> {
        let mut waiting = Waiting::new(visitor, map);
        self.0.fields(names, &mut waiting)?;
        Ok(waiting.into_value())
    }
}
