//! `ademan lab import`: layouts of other programs.

use std::path::PathBuf;

use ademan::import::{ImportHands, import};
use ademan::message::escape_path;

use super::outputs;
use crate::failure::Failure;
use crate::new_file;
use crate::setup_args::one_of;

#[derive(clap::Args)]
pub struct Args {
    /// File to import: a .dof file, or a text grid with three rows of keys
    file: PathBuf,
    /// Boards: one for each hand, or one for the right hand
    #[arg(long, value_name = "HANDS", default_value = "two", value_parser = one_of::<ImportHands>(ImportHands::NAMES))]
    hands: ImportHands,
    /// Layout to create, or `-` for the standard output; NAME.ron in this folder by default. An existing file is not overwritten
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let cannot = |error: String| {
        Failure::wrong_use(format!(
            "cannot import {}: {error}",
            escape_path(&args.file)
        ))
    };
    let text = outputs::read_text(&args.file).map_err(cannot)?;
    let imported = import(&args.file.to_string_lossy(), &text, args.hands)
        .map_err(|error| cannot(error.to_string()))?;
    // A point in the name begins no extension: `canary.v2.dof` becomes `canary.v2.ron`.
    let stem = PathBuf::from(args.file.file_stem().unwrap_or_default()).with_added_extension("ron");
    let path = args.output.clone().unwrap_or(stem);
    let path = new_file::with_extension(&path, "ron");
    for note in &imported.notes {
        complain!("note: {note}");
    }
    let origin = format!("imported from {}", args.file.to_string_lossy());
    let next = "ademan layout check FILE && ademan lab score FILE";
    new_file::create(&path, &imported.text, &origin, next)
}
