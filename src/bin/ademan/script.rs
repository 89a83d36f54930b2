//! `ademan script`: creates scripts for a simulated hand.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;

use crate::demo::script;
use crate::failure::Failure;
use crate::new_file;

/// Create scripts for a simulated hand
#[derive(clap::Args)]
#[command(after_help = "Example: ademan script new mine --from media")]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(clap::Subcommand)]
enum Action {
    /// Create a script as a copy of the one that the demo plays on a layout
    #[command(after_help = "Example: ademan script new mine --from media")]
    New {
        /// File to create (.txt is added), or `-` for the standard output; an existing file is not overwritten
        file: PathBuf,
        /// Layout whose script is copied
        #[arg(long, value_name = "LAYOUT", value_parser = PossibleValuesParser::new(script::layouts()))]
        from: String,
    },
}

pub fn run(args: Args) -> Result<(), Failure> {
    let Action::New { file, from } = args.action;
    let path = new_file::with_extension(&file, "txt");
    let text = script::text(&from).expect("the parser accepts only layouts with a script");
    let original = format!("examples/scripts/{from}.txt");
    let next = format!("ademan demo --layout {from} --script FILE");
    new_file::create(&path, text, &original, &next)
}
