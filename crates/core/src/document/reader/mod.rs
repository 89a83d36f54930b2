//! A reader of RON whose code is compiled once, and not for each type that is read.
//!
//! serde compiles a deserializer again for each type, and RON's is a large one. The types of files are read through a
//! [`Reader`](types::Reader) instead, which passes their visitors and seeds to RON's as trait objects:
//!
//! | side | sees | passes on |
//! |---|---|---|
//! | [`types`]: code that serde derives for a type | a deserializer that is a [`Source`] | its visitor as a [`Visit`], its seeds as [`Seed`]s |
//! | [`parser`]: RON's deserializer | a visitor that is a [`Visit`], seeds that are [`Seed`]s | itself as a [`Source`], its lists as [`Elements`] … |
//!
//! Errors of the parser keep their kinds: each waits beside the part of the parser that returned it, and is returned to it
//! when the types are done.

mod fault;
mod parser;
mod types;

use std::fmt;
use std::marker::PhantomData;

use ron::error::SpannedError;
use serde::de::Deserialize;

use super::ron_options;
use fault::Fault;
use types::{ElementsReader, EntriesReader, Planted, Reader, VariantsReader};

/// Reads a RON text, from which the value may borrow.
pub(super) fn read<'de, T: Deserialize<'de>>(text: &'de str) -> Result<T, SpannedError> {
    let mut planted = Planted::new(PhantomData::<T>);
    grow(text, &mut planted)?;
    Ok(planted.into_value())
}

fn grow<'de>(text: &'de str, seed: &mut dyn Seed<'de>) -> Result<(), SpannedError> {
    ron_options().from_str_seed(text, parser::Passed(seed))
}

/// The type that is asked for.
#[derive(Clone, Copy)]
enum Kind {
    Any,
    Bool,
    Signed(u32),
    Unsigned(u32),
    Float(u32),
    Char,
    Text,
    Option,
    Unit,
    UnitStruct(&'static str),
    NewtypeStruct(&'static str),
    List,
    Tuple(usize),
    TupleStruct(&'static str, usize),
    Map,
    Struct(&'static str, Names),
    Enum(&'static str, Names),
    Identifier,
    Ignored,
}

/// Names of fields or values.
type Names = &'static [&'static str];

/// The content of a value.
enum Content<'c, 'de> {
    Bool(bool),
    Signed(i64),
    Unsigned(u64),
    Float(f64),
    Char(char),
    Text(&'c str),
    Borrowed(&'de str),
    None,
    Unit,
    Some(Reader<'c, 'de>),
    Newtype(Reader<'c, 'de>),
    List(ElementsReader<'c, 'de>),
    Map(EntriesReader<'c, 'de>),
    Enum(VariantsReader<'c, 'de>),
}

/// A value in the text, which is read once.
trait Source<'de> {
    fn read(&mut self, kind: Kind, visit: &mut dyn Visit<'de>) -> Result<(), Fault>;
}

/// The visitor of a type, which takes one content.
trait Visit<'de> {
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result;
    fn visit(&mut self, content: Content<'_, 'de>) -> Result<(), Fault>;
}

/// The seed of a type, which grows from one value.
trait Seed<'de> {
    fn grow(&mut self, value: Reader<'_, 'de>) -> Result<(), Fault>;
}

/// The elements of a list. `next` returns `false` at its end.
trait Elements<'de> {
    fn next(&mut self, seed: &mut dyn Seed<'de>) -> Result<bool, Fault>;
}

/// The entries of a map, or the fields of a structure. `key` returns `false` at their end.
trait Entries<'de> {
    fn key(&mut self, seed: &mut dyn Seed<'de>) -> Result<bool, Fault>;
    fn value(&mut self, seed: &mut dyn Seed<'de>) -> Result<(), Fault>;
}

/// The name of a value of an enumeration, and then its contents.
trait Variants<'de> {
    fn name(&mut self, seed: &mut dyn Seed<'de>) -> Result<(), Fault>;
    fn unit(&mut self) -> Result<(), Fault>;
    fn newtype(&mut self, seed: &mut dyn Seed<'de>) -> Result<(), Fault>;
    fn tuple(&mut self, length: usize, visit: &mut dyn Visit<'de>) -> Result<(), Fault>;
    fn fields(&mut self, names: Names, visit: &mut dyn Visit<'de>) -> Result<(), Fault>;
}

#[cfg(test)]
mod tests;
