//! `ademan man`: manual pages.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use ademan::files;
use clap::{Command, CommandFactory};
use clap_mangen::Man;

use crate::Cli;
use crate::failure::Failure;
use ademan::message::escape_path;

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
        let message = format!("{} is a file; name a folder", escape_path(&folder));
        return Err(Failure::wrong_use(message));
    }
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    fs::create_dir_all(&folder).map_err(|error| Failure::cannot_write(&folder, error))?;
    write_pages(&command, &folder)
}

/// Writes the pages and replaces pages of another version.
fn write_pages(command: &Command, folder: &Path) -> Result<(), Failure> {
    let subcommands = command.get_subcommands();
    for subcommand in subcommands.filter(|subcommand| !subcommand.is_hide_set()) {
        write_pages(subcommand, folder)?;
    }
    let man = Man::new(command.clone());
    let mut page = Vec::new();
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    if command
        .get_arguments()
        .any(|argument| !argument.is_hide_set())
    {
        man.render_options_section(&mut page)?;
    }
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    if let Some(help) = command.get_after_help() {
        write_examples(&help.to_string(), &mut page)?;
    }
    man.render_version_section(&mut page)?;
    let path = folder.join(man.get_filename());
    files::replace(&path, &page).map_err(|error| Failure::cannot_write(&path, error))
}

/// Writes the end of the help. Examples are indented lines, or follow `Example: `.
fn write_examples(help: &str, page: &mut impl Write) -> std::io::Result<()> {
    writeln!(page, ".SH EXAMPLES")?;
    for line in help.lines() {
        let example = line.strip_prefix("  ").or(line.strip_prefix("Example: "));
        match (example, line) {
            (Some(example), _) => writeln!(page, ".nf\n    {}\n.fi", escaped(example))?,
            (None, "" | "Examples:") => {}
            (None, text) => writeln!(page, ".PP\n{}", escaped(text))?,
        }
    }
    Ok(())
}

/// Escapes a line for roff, where a dot or an apostrophe at its start begins a request.
fn escaped(line: &str) -> String {
    let line = line.trim().replace('\\', r"\e").replace('-', r"\-");
    if line.starts_with(['.', '\'']) {
        format!(r"\&{line}")
    } else {
        line
    }
}
