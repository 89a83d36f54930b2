//! `ademan man`: manual pages.

use std::fs;
use std::path::PathBuf;

use clap::CommandFactory;

use crate::Cli;
use crate::failure::Failure;

/// Write the manual pages to a folder
#[derive(clap::Args)]
#[command(after_help = "Example: ademan man ~/.local/share/man/man1")]
pub struct Args {
    /// The folder; it is created if it does not exist
    folder: PathBuf,
}

/// Writes a page for the command and each of its subcommands.
pub fn run(args: Args) -> Result<(), Failure> {
    let folder = args.folder;
    if folder.is_file() {
        let message = format!("{} is a file; name a folder", folder.display());
        return Err(Failure::wrong_use(message));
    }
    fs::create_dir_all(&folder)
        .and_then(|()| clap_mangen::generate_to(Cli::command(), &folder))
        .map_err(|error| {
            Failure::wrong_use(format!(
                "cannot write manual pages to {}: {error}",
                folder.display()
            ))
        })
}
