//! The value of `--source`.

use std::ffi::OsStr;
use std::str::FromStr;

use ademan::capture::SourceUri;
use ademan::capture::protocol::{PROTOCOLS, Protocol};
use ademan::capture::transport::Scheme;
use ademan::capture::uri::schemes;
use clap::builder::{PossibleValue, TypedValueParser};

/// The parser of a source URI. Help lists the kinds of source.
#[derive(Clone)]
pub struct SourceValue;

impl TypedValueParser for SourceValue {
    type Value = SourceUri;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<SourceUri, clap::Error> {
        SourceUri::from_str.parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        // Help writes a colon after each.
        let syntax = |scheme: Scheme| scheme.syntax.trim_end_matches(':');
        let value = move |scheme| PossibleValue::new(syntax(scheme)).help(scheme.summary);
        Some(Box::new(schemes().map(value)))
    }
}

/// Returns the help of a flag for a source: the protocols of streams with their options and defaults.
pub fn help() -> String {
    let protocols: Vec<String> = PROTOCOLS
        .iter()
        .map(|protocol| describe(protocol))
        .collect();
    format!(
        "Source of readings. Streams of bytes take options, such as ?protocol={}&baud=115200.\n\nProtocols, the first is \
         the default:\n{}",
        PROTOCOLS[0].name,
        protocols.join("\n")
    )
}

fn describe(protocol: &Protocol) -> String {
    let options = protocol.options.iter().map(|option| {
        let (name, default, summary) = (option.name, option.default, option.summary);
        format!("\n    {name}={default}: {summary}")
    });
    let options: String = options.collect();
    format!("- {}: {}{options}", protocol.name, protocol.summary)
}
