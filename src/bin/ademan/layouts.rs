//! `ademan layouts`: the layouts that can be named.

use crate::failure::Failure;
use crate::layout;
use crate::list::ListArgs;

/// List the layouts that come with the program, and the ones in the configuration folder
#[derive(clap::Args)]
#[command(after_help = "Example: ademan layouts --json")]
pub struct Args {
    #[command(flatten)]
    list: ListArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    layout::list(&args.list)
}
