//! The file of what the text decoder has learned about the person.

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

use crate::files::{self, FileError, OpenDocument};
use ademan_core::document::{Document, DocumentError};
use ademan_core::message::escape_path;
use ademan_text::filter::Learned;

/// The text of a file that is not there. One that was moved away or has nothing in it is written again.
const NOTHING: &str = "Learned()";

/// A file, and the text that was read from it or written to it last.
#[derive(Clone, Debug)]
pub struct LearnedFile {
    path: PathBuf,
    text: String,
}

impl LearnedFile {
    /// Notes the text of a file.
    pub fn new(path: &str, text: &str) -> Self {
        Self {
            path: path.into(),
            text: text.into(),
        }
    }

    /// Reads a file. One that is not there has learned nothing.
    pub fn read(path: &str) -> Result<Document, DocumentError> {
        match fs::metadata(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Document::new(path, NOTHING)),
            _ => Document::from_path(path),
        }
    }

    /// Writes the file, so that only its owner can read it, unless another program has changed it. Returns a sentence for the person.
    pub fn save(&mut self, learned: &Learned) -> Result<String, String> {
        let name = escape_path(&self.path);
        let target = match files::own_target(&self.path) {
            Ok(target) => target,
            Err(FileError::Io(error)) if error.kind() == ErrorKind::NotFound => self.path.clone(),
            Err(error) => return Err(format!("{name}: not saved: {error}")),
        };
        let text = learned.to_ron();
        let is_unchanged = || {
            let found = Self::read(&target.to_string_lossy());
            found.is_ok_and(|document| document.text == self.text || document.text == NOTHING)
        };
        let saved = files::replace_private_text_if(&target, &text, is_unchanged);
        saved.map_err(|error| match error {
            FileError::Changed => format!(
                "{name}: not saved, as another program has changed the file since it was read; move it away and save again, or start the run again to use it"
            ),
            other => format!("{name}: not saved: {other}"),
        })?;
        self.text = text;
        Ok(format!("{name}: saved"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learned(words: &[&str]) -> Learned {
        Learned {
            words: words.iter().map(|&word| word.to_owned()).collect(),
            ..Learned::default()
        }
    }

    #[test]
    fn a_file_is_written_for_its_owner_only_and_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("me.ron");
        let path = path.to_str().unwrap();
        let before = LearnedFile::read(path).unwrap();
        assert_eq!(Learned::parse(&before).unwrap(), Learned::default());
        let mut file = LearnedFile::new(path, &before.text);
        assert!(
            file.save(&learned(&["Nuria"]))
                .unwrap()
                .ends_with("me.ron: saved")
        );
        file.save(&learned(&["Nuria", "kubectl"])).unwrap();
        let after = LearnedFile::read(path).unwrap();
        assert_eq!(Learned::parse(&after).unwrap().words, ["Nuria", "kubectl"]);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = fs::metadata(path).unwrap().permissions().mode();
            assert_eq!(mode & 0o777, 0o600);
        }
    }

    #[test]
    fn a_file_that_another_program_has_changed_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("me.ron");
        let mut file = LearnedFile::new(path.to_str().unwrap(), NOTHING);
        fs::write(&path, "Learned(words: [\"Ana\"])").unwrap();
        let refused = file.save(&learned(&["Nuria"])).unwrap_err();
        assert!(
            refused.contains("another program has changed the file"),
            "{refused}"
        );
        assert_eq!(
            fs::read_to_string(&path).unwrap(),
            "Learned(words: [\"Ana\"])"
        );
        // As the message says.
        fs::remove_file(&path).unwrap();
        file.save(&learned(&["Nuria"])).unwrap();
        // A folder that is not there.
        let mut lost = LearnedFile::new(folder.path().join("a/me.ron").to_str().unwrap(), NOTHING);
        let error = lost.save(&learned(&[])).unwrap_err();
        assert!(error.contains("not saved"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let [path, target] = ["me.ron", "target.ron"].map(|name| folder.path().join(name));
        fs::write(&target, NOTHING).unwrap();
        std::os::unix::fs::symlink(&target, &path).unwrap();
        let mut file = LearnedFile::new(path.to_str().unwrap(), NOTHING);
        file.save(&learned(&["Nuria"])).unwrap();
        assert!(fs::symlink_metadata(&path).unwrap().is_symlink());
        assert!(fs::read_to_string(&target).unwrap().contains("Nuria"));
    }
}
