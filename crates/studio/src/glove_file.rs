//! The file that an edited glove is saved to.

use std::fs;
use std::path::{Path, PathBuf};

use ademan_core::message::escape_path;
use ademan_runtime::files;

/// The file of a glove, and its text as far as Studio knows it.
#[derive(Clone, Debug)]
pub struct GloveFile {
    path: PathBuf,
    /// The text that Studio has written; `None` before.
    written: Option<String>,
}

/// Reason why a glove was not saved.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// There is a file that Studio has not written, or that has changed since.
    #[error("{} exists", escape_path(.0))]
    Exists(PathBuf),
    /// There is no folder for files of this person.
    #[error(
        "the glove is not saved: this system has no configuration folder; start with `--glove FILE`"
    )]
    NoFolder,
    /// The operating system refuses.
    #[error("the glove is not saved: cannot write {path}: {error}")]
    File {
        /// The path.
        path: String,
        /// The reason.
        error: files::FileError,
    },
}

impl GloveFile {
    /// Returns the file of a glove: its own, or for one that comes with the program, or with a recording, a copy in the folder
    /// `gloves` of the configuration folder.
    pub fn new(
        own: Option<&str>,
        name: &str,
        config_folder: Option<&Path>,
    ) -> Result<Self, SaveError> {
        let path = match own {
            Some(path) => PathBuf::from(path),
            None => {
                let stem = Path::new(name).file_stem().unwrap_or_default();
                let folder = config_folder.ok_or(SaveError::NoFolder)?.join("gloves");
                folder.join(stem).with_extension("ron")
            }
        };
        Ok(Self {
            path,
            written: None,
        })
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns `true` if Studio has written this text last.
    pub fn has_written(&self, text: &str) -> bool {
        self.written.as_deref() == Some(text)
    }

    /// Returns the path of the copy of a replaced file.
    pub fn backup(&self) -> PathBuf {
        self.path.with_added_extension("bak")
    }

    /// Saves a text. A file that Studio has not written stays, unless `may_replace` is set; then it is kept as
    /// [`backup`](Self::backup).
    pub fn save(&mut self, text: &str, may_replace: bool) -> Result<(), SaveError> {
        let failure = |path: &Path, error: files::FileError| SaveError::File {
            path: escape_path(path),
            error,
        };
        let existing = match fs::read_to_string(&self.path) {
            Ok(existing) => Some(existing),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(error) => return Err(failure(&self.path, error.into())),
        };
        if existing.is_some() && existing != self.written {
            if !may_replace {
                return Err(SaveError::Exists(self.path.clone()));
            }
            let backup = self.backup();
            fs::copy(&self.path, &backup).map_err(|error| failure(&backup, error.into()))?;
        }
        let written = match existing {
            Some(_) => files::replace_text(&self.path, text),
            None => self.create(text),
        };
        written.map_err(|error| failure(&self.path, error))?;
        self.written = Some(text.to_owned());
        Ok(())
    }

    fn create(&self, text: &str) -> Result<(), files::FileError> {
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder)?;
        }
        files::write_new_private(&self.path, text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shipped_glove_is_copied_and_an_existing_copy_is_replaced_only_on_request() {
        let folder = tempfile::tempdir().unwrap();
        let new = || GloveFile::new(None, "gloves/unam-hc11.ron", Some(folder.path())).unwrap();
        let mut file = new();
        assert_eq!(file.path(), folder.path().join("gloves/unam-hc11.ron"));
        file.save("one", false).unwrap();
        file.save("two", false).unwrap();
        let mut later = new();
        assert!(matches!(
            later.save("three", false),
            Err(SaveError::Exists(_))
        ));
        assert_eq!(fs::read_to_string(file.path()).unwrap(), "two");
        later.save("three", true).unwrap();
        assert_eq!(fs::read_to_string(file.path()).unwrap(), "three");
        assert_eq!(fs::read_to_string(later.backup()).unwrap(), "two");
        // Another program has changed the file since.
        assert!(matches!(
            file.save("four", false),
            Err(SaveError::Exists(_))
        ));
    }

    #[test]
    fn an_own_file_that_cannot_be_written_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.ron");
        fs::write(&path, "one").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        let own = path.to_str();
        let mut file = GloveFile::new(own, "mine", None).unwrap();
        let error = file.save("two", true).unwrap_err().to_string();
        assert!(error.contains("read-only"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "one");
        assert!(matches!(
            GloveFile::new(None, "mine", None),
            Err(SaveError::NoFolder)
        ));
    }
}
