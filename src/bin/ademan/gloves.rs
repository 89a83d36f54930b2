//! `ademan gloves`: the glove files that come with the program.

use ademan::document::Document;
use ademan::document::shipped_gloves;
use ademan::layout::Glove;

use crate::failure::Failure;
use crate::list::{ListArgs, Row};

/// List the gloves that come with the program
#[derive(clap::Args)]
#[command(after_help = "Example: ademan gloves")]
pub struct Args {
    #[command(flatten)]
    list: ListArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let rows = shipped_gloves().map(|name| {
        let glove = Glove::parse(&Document::shipped(name)?)?;
        Ok(Row {
            name: name.into(),
            summary: glove.name,
            example: Some(format!(
                "ademan run --source serial:/dev/ttyUSB0 --glove {name}"
            )),
        })
    });
    args.list.print(&rows.collect::<Result<Vec<_>, Failure>>()?)
}
