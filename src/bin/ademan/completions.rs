//! `ademan completions`: completion scripts for shells.

use std::io::{self, Write};

use clap::CommandFactory;
use clap_complete::Shell;

use crate::Cli;
use crate::failure::Failure;

/// Print a completion script for a shell
#[derive(clap::Args)]
#[command(
    after_help = "Example: ademan completions bash > ~/.local/share/bash-completion/completions/ademan"
)]
pub struct Args {
    /// The shell
    shell: Shell,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "ademan", &mut script);
    io::stdout().write_all(&script)?;
    Ok(())
}
