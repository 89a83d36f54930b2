//! The glove file that a calibration writes. An existing file is replaced only after a question, and kept beside the new one.

use std::fs;
use std::io::{self, BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};

use ademan::document::Document;
use ademan::files::{self, FileError};
use ademan::message::{escape_path, shell_word};

use crate::failure::Failure;
use crate::new_file;

/// A file to write.
pub struct Destination {
    path: PathBuf,
    is_forced: bool,
}

impl Destination {
    /// Chooses the file: `out`, or else the file from which `glove` was read, or a new one in the working folder for a glove that
    /// comes with the program or in a recording.
    ///
    /// # Errors
    /// Fails if the file cannot be written, or exists and the question whether to replace it cannot be asked.
    pub fn new(out: Option<PathBuf>, glove: &Document, is_forced: bool) -> Result<Self, Failure> {
        let path = match (out, &glove.path) {
            (Some(path), _) => new_file::with_extension(&path, "ron"),
            (None, Some(own)) => own.to_owned(),
            (None, None) => PathBuf::from(format!("my-{}.ron", glove_name(&glove.file))),
        };
        let destination = Self { path, is_forced };
        destination.check()?;
        if destination.exists() && !is_forced && !can_ask() {
            return Err(Failure::wrong_use(format!(
                "{} exists, and there is no terminal to ask in; --force replaces it and keeps the old file as {}",
                destination.shown(),
                escape_path(&destination.backup())
            )));
        }
        Ok(destination)
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the text and prints the report of its result, after a question if the file exists. Returns `true` if it was written.
    ///
    /// The report precedes a question. Otherwise it follows the file, which a closed or full standard output does not prevent.
    pub fn write(&self, text: &str, report: &str) -> Result<bool, Failure> {
        let shown = self.shown();
        let existed = self.exists();
        let is_asked = existed && !self.is_forced;
        let mut out = io::stdout();
        if is_asked {
            out.write_all(report.as_bytes())?;
            if !ask(&format!("replace {shown}? [y/N] "))? {
                writeln!(out, "{shown} is unchanged")?;
                return Ok(false);
            }
        }
        let written = if existed {
            files::replace_text_and_keep(&self.path, &self.backup(), text)
        } else {
            files::write_new(&self.path, text.as_bytes())
        };
        written.map_err(|error| self.failure(&error))?;
        if !is_asked {
            out.write_all(report.as_bytes())?;
        }
        writeln!(out, "wrote {shown}")?;
        if existed {
            let [backup, path] = [&self.backup(), &self.path].map(|path| command_word(path));
            writeln!(out, "undo: mv {backup} {path}")?;
        } else {
            writeln!(out, "undo: remove {shown}")?;
        }
        Ok(true)
    }

    /// Returns a path beside the file for the recording, at which there is no file yet.
    pub fn free_recording(&self) -> PathBuf {
        new_file::first_free(|number| match number {
            1 => self.path.with_extension("mcap"),
            _ => self.path.with_extension(format!("{number}.mcap")),
        })
    }

    /// Fails if the file could not be written after a session of a minute.
    fn check(&self) -> Result<(), Failure> {
        match files::check_destination(&self.path) {
            Err(FileError::Io(error)) if error.kind() == io::ErrorKind::NotFound => {
                let folder = escape_path(files::folder_of(&self.path));
                Err(Failure::wrong_use(format!(
                    "cannot write {}: there is no folder {folder}; create it, or name another file with --out",
                    self.shown()
                )))
            }
            checked => checked.map_err(|error| self.failure(&error)),
        }
    }

    /// Returns `true` if there is anything at the path, also a link that leads nowhere.
    fn exists(&self) -> bool {
        fs::symlink_metadata(&self.path).is_ok()
    }

    fn backup(&self) -> PathBuf {
        self.path.with_added_extension("bak")
    }

    /// Returns the path as a word of a command.
    pub fn as_word(&self) -> String {
        command_word(&self.path)
    }

    fn shown(&self) -> String {
        escape_path(&self.path)
    }

    fn failure(&self, error: &FileError) -> Failure {
        Failure::wrong_use(format!(
            "cannot write {}: {error}; name another file with --out",
            self.shown()
        ))
    }
}

fn command_word(path: &Path) -> String {
    shell_word(&path.to_string_lossy()).into_owned()
}

fn glove_name(file: &str) -> String {
    let stem = Path::new(file).file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// Returns `true` if a person at a terminal can see a question and answer it.
fn can_ask() -> bool {
    let is_seen = io::stdout().is_terminal() || io::stderr().is_terminal();
    is_seen && io::stdin().is_terminal()
}

/// Asks a question on the terminal. Anything but a yes is a no.
fn ask(question: &str) -> Result<bool, Failure> {
    // The report may go to a file, in which the question is not seen.
    let mut screen: Box<dyn Write> = if io::stdout().is_terminal() {
        Box::new(io::stdout())
    } else {
        Box::new(io::stderr())
    };
    write!(screen, "{question}")?;
    screen.flush()?;
    let mut answer = String::new();
    io::stdin().lock().read_line(&mut answer)?;
    Ok(matches!(answer.trim(), "y" | "Y" | "yes"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan::files::OpenDocument;

    #[test]
    fn only_a_glove_that_was_read_from_a_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("victim.ron");
        fs::write(&path, "Glove()").unwrap();
        let file = path.to_str().unwrap();
        let destination = |glove: &Document| Destination::new(None, glove, true).unwrap().path;
        assert_eq!(destination(&Document::from_path(file).unwrap()), path);
        // As a recording names it.
        let recorded = Document::new(file, "Glove()");
        assert_eq!(destination(&recorded), Path::new("my-victim.ron"));
        // In the folder of the sources there is a file with the path of the shipped one.
        let shipped = Document::shipped("unam-hc11").unwrap();
        assert_eq!(destination(&shipped), Path::new("my-unam-hc11.ron"));
    }
}
