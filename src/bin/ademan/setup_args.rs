//! Flags that override fields of a setup, shared by several subcommands.

use ademan::capture::SourceUri;
use ademan::pipeline::SourceRole;
use ademan::setup::Setup;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::failure::Failure;
use crate::source_value::{self, SourceValue};

/// Flags that override a setup file.
#[derive(Clone, clap::Args)]
pub struct SetupArgs {
    #[arg(long, value_name = "URI", value_parser = SourceValue, help = "Source of readings", long_help = source_value::help())]
    source: Option<SourceUri>,
    /// Source of the arm, if another one than that of the fingers: a camera beside a glove
    #[arg(long, value_name = "URI", value_parser = SourceValue)]
    arm_source: Option<SourceUri>,
    /// Events that the source may cause: pointer, keys or both. The default is both, and pointer for a source on the
    /// network
    #[arg(long, value_parser = role())]
    role: Option<SourceRole>,
    /// Events that the source of the arm may cause. The hand causes only those that both of its sources may
    #[arg(long, value_parser = role())]
    arm_role: Option<SourceRole>,
    /// Glove: the name of one that comes with the program, or a file
    #[arg(long)]
    glove: Option<String>,
    /// Layout: the name of one that comes with the program (see `ademan layout list`), or a file
    #[arg(long)]
    layout: Option<String>,
}

impl SetupArgs {
    /// Reads a setup file, or takes the default setup, and applies the flags.
    pub fn read_setup(self, file: Option<&str>) -> Result<Setup, Failure> {
        let mut setup = match file {
            Some(path) => Setup::load(path)?,
            None => Setup::default(),
        };
        setup.source = self.source.or(setup.source);
        setup.arm_source = self.arm_source.or(setup.arm_source);
        setup.arm_role = self.arm_role.or(setup.arm_role);
        setup.role = self.role.or(setup.role);
        setup.glove = self.glove.or(setup.glove);
        setup.layout = self.layout.unwrap_or(setup.layout);
        Ok(setup)
    }
}

fn role() -> impl TypedValueParser<Value = SourceRole> {
    PossibleValuesParser::new(SourceRole::ALL.map(SourceRole::name)).map(|name| {
        let role = SourceRole::ALL.into_iter().find(|role| role.name() == name);
        role.expect("the parser accepts only names of roles")
    })
}

/// Parses a number in a closed range.
pub fn number_in(text: &str, min: f64, max: f64, unit: &str) -> Result<f64, String> {
    let number: f64 = text
        .parse()
        .map_err(|_| format!("`{text}` is not a number"))?;
    if (min..=max).contains(&number) {
        return Ok(number);
    }
    Err(format!("it is {min} to {max} {unit}"))
}
