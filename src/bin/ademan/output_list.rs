//! The value of `--output`.

use std::ffi::OsStr;

use ademan::output::{BACKENDS, Backend};
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};

/// The parser of a list of outputs, separated by commas. Help lists the backends; opening the outputs
/// checks the names.
#[derive(Clone)]
pub struct OutputList;

impl TypedValueParser for OutputList {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let value = |backend: &&Backend| PossibleValue::new(backend.name).help(backend.summary);
        Some(Box::new(BACKENDS.iter().map(value)))
    }
}
