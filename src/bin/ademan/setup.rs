//! `ademan setup`: creates setup files.

use std::path::PathBuf;

use crate::failure::Failure;
use crate::new_file;

/// The setup with all fields and a comment for each.
const EXAMPLE: &str = include_str!("../../../examples/setup.ron");

/// Create setup files
#[derive(clap::Subcommand)]
#[command(after_help = "Example: ademan setup new my-setup")]
pub enum Args {
    /// Create a setup file with all fields and their defaults
    #[command(
        after_help = "Examples:\n  ademan setup new my-setup\n  ademan setup new ~/.config/ademan/setup.ron    (found by every run that names no setup; on Windows %APPDATA%\\ademan\\setup.ron)"
    )]
    New {
        /// File to create (.ron is added), or `-` for the standard output; an existing file is not overwritten
        file: PathBuf,
    },
}

pub fn run(args: Args) -> Result<(), Failure> {
    let Args::New { file } = args;
    let path = new_file::with_extension(&file, "ron");
    let next = "ademan doctor FILE && ademan run FILE";
    new_file::create(&path, EXAMPLE, "a copy of examples/setup.ron", next)
}
