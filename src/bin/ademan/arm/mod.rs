//! `ademan arm`: attributes of both arms from landmarks of a body, landmarks from attributes, and movements between postures.

mod attributes;
mod between;
mod csv;
mod landmarks;
mod npy;
pub mod poses;
mod strip;
mod values;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use ademan::files;
use ademan::message::escape_path;

use crate::failure::Failure;
use crate::signals;

/// Attributes of both arms (directions, lengths, angles) from landmarks, and back, and movements between postures
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan arm attributes poses.jsonl > attributes.jsonl\n  ademan arm landmarks attributes.jsonl > poses.jsonl\n  ademan arm between rest.jsonl reach.jsonl --ms 800 --output movement.jsonl\n  ademan run --source 'file:movement.jsonl?protocol=body-landmarks&rate_hz=60'"
)]
pub enum Args {
    Attributes(attributes::Args),
    Landmarks(landmarks::Args),
    Between(between::Args),
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args {
        Args::Attributes(args) => attributes::run(&args),
        Args::Landmarks(args) => landmarks::run(&args),
        Args::Between(args) => between::run(&args),
    }
}

/// The destination of results.
#[derive(clap::Args)]
pub struct OutputArgs {
    /// File to create; standard output without it, and for `-`. An existing file is not overwritten
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl OutputArgs {
    /// Returns the file; `None` for the standard output.
    fn file(&self) -> Option<&Path> {
        let named = self.output.as_deref();
        named.filter(|path| path.as_os_str() != "-")
    }

    /// Opens the destination.
    fn open(&self) -> Result<Box<dyn Write>, Failure> {
        match self.file() {
            Some(path) => Ok(Box::new(BufWriter::new(NamedFile {
                file: files::create_new(path)
                    .map_err(|error| Failure::cannot_create(path, error))?,
                path: path.to_owned(),
            }))),
            None => Ok(Box::new(BufWriter::new(io::stdout().lock()))),
        }
    }

    /// Writes results by a function to the destination. A file that did not become complete is removed, also by a signal: a part of the
    /// results looks like all of them, and is in the way of the next try.
    pub fn write(
        &self,
        results: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        if self.file().is_some() {
            signals::install()?;
        }
        let mut out = self.open()?;
        if let Some(path) = self.file() {
            signals::remove_on_stop(path);
        }
        let written = match results(&mut out) {
            Ok(()) => self.finish(out),
            Err(failure) => {
                // Windows removes no open file.
                drop(out);
                Err(failure)
            }
        };
        if written.is_err()
            && let Some(path) = self.file()
        {
            let _ = fs::remove_file(path);
        }
        written
    }

    /// Writes the rest of the results, and says that the file is written. Says nothing of the standard output.
    fn finish(&self, mut out: impl Write) -> Result<(), Failure> {
        out.flush()?;
        if let Some(path) = self.file() {
            signals::end_at_once_on_stop();
            say!("wrote {}", escape_path(path));
        }
        Ok(())
    }
}

/// A file whose errors name it.
struct NamedFile {
    file: File,
    path: PathBuf,
}

impl NamedFile {
    fn name(&self, error: &io::Error) -> io::Error {
        io::Error::other(format!("cannot write {}: {error}", escape_path(&self.path)))
    }
}

impl Write for NamedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes).map_err(|error| self.name(&error))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush().map_err(|error| self.name(&error))
    }
}
