//! The outputs of a setup file: transcripts are new files in a folder of their own.
//!
//! A setup may come from another person. The path of a transcript in it would choose a file on this machine, and the names of its
//! layouts a part of the content. So a setup names a file, and the program the folder.

use std::path::{Path, PathBuf};

use super::SetupError;
use crate::files;
use crate::output::{self, transcript};
use ademan_core::device::Capabilities;
use ademan_core::message::escape_path;

/// Most transcripts of one name.
const MAX_FILES: usize = 10_000;

/// Returns the outputs of a setup file with the path of a new file for each transcript: `transcript:today.txt` becomes `today.txt` in the
/// [`transcript_folder`](files::transcript_folder), or `today.2.txt` if that exists. A name that is not an output is an error.
pub(super) fn with_new_transcripts(outputs: &str) -> Result<String, SetupError> {
    output::check(outputs, &Capabilities::default())
        .map_err(|error| SetupError::Value(format!("`output`: {error}")))?;
    let prefix = format!("{}:", transcript::BACKEND.name);
    let with_path = |output: &str| match output.trim().strip_prefix(&prefix) {
        Some(name) => Ok(format!("{prefix}{}", new_file(name)?.to_string_lossy())),
        None => Ok(output.to_owned()),
    };
    let outputs: Result<Vec<_>, SetupError> = outputs.split(',').map(with_path).collect();
    Ok(outputs?.join(","))
}

/// Returns the outputs of a session that follows one with the outputs `before` in the same program: a transcript that the first one has
/// written gets the next free number, as `today.2.txt` after `today.txt`. A file that was not written by it stays as it is, and cannot be
/// opened.
pub fn continued_outputs(outputs: &str, before: &str) -> String {
    let prefix = format!("{}:", transcript::BACKEND.name);
    let is_written = |output: &str| before.split(',').any(|other| other.trim() == output);
    let continued = |output: &str| {
        let output = output.trim();
        let path = output.strip_prefix(&prefix).map(Path::new);
        let path = path.filter(|_| is_written(output));
        let next = path.and_then(|path| free_name(path.parent()?, path.file_name()?.to_str()?));
        next.map_or(output.to_owned(), |next| {
            format!("{prefix}{}", next.to_string_lossy())
        })
    };
    let outputs: Vec<_> = outputs.split(',').map(continued).collect();
    outputs.join(",")
}

fn new_file(name: &str) -> Result<PathBuf, SetupError> {
    if !is_plain(name) {
        let message = "`output`: a setup names a transcript by letters, digits, `-`, `_` and `.`, without a folder, such as \
                       `transcript:today.txt`; the option --output names a file elsewhere";
        return Err(SetupError::Value(message.into()));
    }
    let folder = files::transcript_folder().ok_or_else(|| {
        let message = "`output`: this system has no folder for the transcripts of setups; name a file with --output";
        SetupError::Value(message.into())
    })?;
    free_name(&folder, name).ok_or_else(|| {
        let message = format!(
            "`output`: there are {MAX_FILES} transcripts of this name in {}; remove some",
            escape_path(&folder)
        );
        SetupError::Value(message)
    })
}

/// Returns `true` for the name of a file that is neither hidden nor an option of another program.
fn is_plain(name: &str) -> bool {
    let is_plain = |character: char| character.is_alphanumeric() || "-_.".contains(character);
    name.starts_with(char::is_alphanumeric) && name.chars().all(is_plain) && name.len() <= 100
}

/// Returns the path of a file that does not exist.
fn free_name(folder: &Path, name: &str) -> Option<PathBuf> {
    let (stem, extension) = match name.rsplit_once('.') {
        Some((stem, extension)) => (stem, format!(".{extension}")),
        None => (name, String::new()),
    };
    let numbered = (2..=MAX_FILES).map(|number| format!("{stem}.{number}{extension}"));
    let mut paths = std::iter::once(name.to_owned())
        .chain(numbered)
        .map(|name| folder.join(name));
    paths.find(|path| path.symlink_metadata().is_err())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transcript_that_the_session_before_wrote_gets_a_number() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| format!("transcript:{}", folder.path().join(name).display());
        let (own, other) = (file("own.txt"), file("other.txt"));
        let before = format!("desktop, {own}");
        assert_eq!(continued_outputs(&own, &before), own, "nothing is written");
        for name in ["own.txt", "other.txt"] {
            std::fs::write(folder.path().join(name), "").expect("a write");
        }
        let outputs = format!("none,{own},{other},transcript");
        let expected = format!("none,{},{other},transcript", file("own.2.txt"));
        assert_eq!(continued_outputs(&outputs, &before), expected);
    }

    #[test]
    fn the_name_of_a_transcript_is_plain_and_has_no_folder() {
        for name in ["today.txt", "día-2_b", "a.b.c"] {
            assert!(is_plain(name), "{name}");
        }
        for name in [
            "",
            ".",
            "..",
            ".bashrc",
            "-rf",
            "a/b",
            "../a",
            "/etc/motd",
            "a\\b",
            "a b",
            "a;b",
            "$(a)",
            "a\nb",
        ] {
            assert!(!is_plain(name), "{name}");
            let outputs = format!("desktop,transcript:{name}");
            assert!(with_new_transcripts(&outputs).is_err(), "{name}");
        }
    }

    #[test]
    fn outputs_that_are_no_files_stay_as_they_are() {
        for outputs in ["transcript", "desktop,uinput", "spacenav:/tmp/a", "none"] {
            assert_eq!(with_new_transcripts(outputs).unwrap(), outputs);
        }
    }

    #[test]
    fn a_name_that_exists_is_numbered() {
        let folder = tempfile::tempdir().unwrap();
        let free = |name: &str| {
            let path = free_name(folder.path(), name).unwrap();
            std::fs::write(&path, "").unwrap();
            path.file_name().unwrap().to_str().unwrap().to_owned()
        };
        let names = ["a.txt", "a.txt", "a.txt", "b", "b"].map(free);
        assert_eq!(names, ["a.txt", "a.2.txt", "a.3.txt", "b", "b.2"]);
    }
}
