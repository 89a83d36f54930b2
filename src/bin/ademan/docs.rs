//! Completion scripts and manual pages, made from the arguments themselves.

use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::args::Args;
use crate::failure::Failure;

/// Prints a completion script.
pub fn completions(shell: Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Args::command(), "ademan", &mut script);
    std::io::Write::write_all(&mut std::io::stdout(), &script)?;
    Ok(())
}

/// Writes a manual page for the command and each of its subcommands.
pub fn man(folder: &Path) -> Result<(), Failure> {
    if folder.is_file() {
        let message = format!("{} is a file, name a folder", folder.display());
        return Err(Failure::wrong_use(message));
    }
    std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(Args::command(), folder))
        .map_err(|error| {
            Failure::wrong_use(format!(
                "cannot write manual pages into {}: {error}",
                folder.display()
            ))
        })
}
