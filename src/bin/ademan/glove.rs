//! `ademan glove`: creates glove files.

use std::path::PathBuf;

use ademan::document::{Document, FileKind};
use ademan::files::OpenDocument;
use ademan::layout::Glove;

use crate::failure::Failure;
use crate::{complete, gloves, new_file};

/// Create glove files
#[derive(clap::Subcommand)]
#[command(after_help = "Example: ademan glove new mine --from unam-hc11")]
pub enum Args {
    /// Create a glove file as a copy of another one
    #[command(after_help = "Example: ademan glove new mine --from unam-hc11-left")]
    New {
        /// File to create (.ron is added), or `-` for the standard output; an existing file is not overwritten
        file: PathBuf,
        /// Glove to copy: the name of one that comes with the program (see `ademan gloves`), or a file
        #[arg(long, default_value = "unam-hc11", add = complete::glove())]
        from: String,
    },
}

pub fn run(args: Args) -> Result<(), Failure> {
    let Args::New { file, from } = args;
    let path = new_file::with_extension(&file, "ron");
    let document = Document::open_kind(FileKind::Glove, &from)?;
    let glove = Glove::parse(&document)?;
    let text = new_file::renamed(&document.text, &glove.name, &path);
    let next = format!(
        "ademan run --source {} --glove FILE",
        gloves::source(&glove)
    );
    let origin = format!("a copy of {}", document.file);
    new_file::create(&path, &text, &origin, &next)
}
