//! The file of an edited layout: saving, and changes that other programs make to it.

use std::fs;
use std::io;
use std::mem;
use std::path::{Path, PathBuf};

use super::{Edited, LayoutEditor, Part};
use ademan_core::document::{Document, DocumentError, read_tree};
use ademan_core::editing::{self, Patch};
use ademan_core::message::escape_path;
use ademan_runtime::files::{self, FileError, OpenDocument};

/// The file of a layout as it was last read or written.
pub(super) struct EditedFile {
    name: String,
    path: Option<PathBuf>,
    /// The text of the file, or of the layout that an unsaved copy was made of.
    saved: String,
    stamp: Option<Stamp>,
    /// The file is gone or cannot be read any more: the text in the editor is the only one.
    is_lost: bool,
    conflict: Option<Conflict>,
}

/// The properties of a file, of which time and length change when it is written. Times are compared for equality only.
struct Stamp(fs::Metadata);

impl PartialEq for Stamp {
    fn eq(&self, other: &Self) -> bool {
        let times = [&self.0, &other.0].map(|metadata| metadata.modified().ok());
        times[0] == times[1] && self.0.len() == other.0.len()
    }
}

/// Changes of another program that overlap with those that are not saved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// The text of the file now.
    pub theirs: String,
}

/// The answer to a [`Conflict`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// The next save replaces the changes of the other program.
    KeepMine,
    /// The text of the file replaces the edited one; undo restores that.
    TakeTheirs,
}

/// A change of the file by another program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// There was nothing unsaved: the editor has the text of the file.
    Reloaded,
    /// Both changes are in the text.
    Merged,
    /// The changes overlap: [`LayoutEditor::resolve`] decides.
    Conflict,
    /// The file cannot be read any more, for this reason. The text stays, and saving writes it again.
    Unreadable(DocumentError),
}

/// The state of the text and its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileState {
    /// The file has the text.
    Saved,
    /// The text differs from the file, or there is no such file any more.
    Modified,
    /// There is no file yet.
    Unsaved,
}

/// Reason why a layout is not saved. Nothing is lost: the text stays, and so does the old file.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// An unsaved copy of a layout that comes with the program.
    #[error("this copy has no file yet; save it under a name of your own")]
    NoFile,
    /// There is such a file.
    #[error("{} exists already; choose another name, or replace it", escape_path(.0))]
    Exists(PathBuf),
    /// Another program has changed the file in the same places.
    #[error(
        "{0}: not saved, as another program has changed the same lines; keep yours or take theirs, then save again"
    )]
    Conflict(String),
    /// Another program has changed the file in other places.
    #[error(
        "{0}: not saved yet, as another program has changed the file; both changes are in the text now: look at them, then save again"
    )]
    Merged(String),
    /// The operating system refuses.
    #[error(
        "{name}: cannot save: {error}; the text stays here unsaved: make room or permit writing, or save under another name"
    )]
    File {
        /// The file.
        name: String,
        /// The reason.
        error: FileError,
    },
}

impl EditedFile {
    /// Returns the file from which a document was read. A layout that comes with the program has none, even in the folder of its
    /// sources, where a file has the name that messages give it.
    pub fn open(document: &Document) -> Self {
        let path = document.path.as_deref();
        Self {
            stamp: path.and_then(stamp),
            path: path.map(Path::to_owned),
            ..Self::unsaved(&document.file).with_text(&document.text)
        }
    }

    /// Returns a file that does not exist.
    pub fn unsaved(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            path: None,
            saved: String::new(),
            stamp: None,
            is_lost: false,
            conflict: None,
        }
    }

    /// Sets the text that counts as saved.
    pub fn with_text(mut self, text: &str) -> Self {
        text.clone_into(&mut self.saved);
        self
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    pub fn saved_text(&self) -> &str {
        &self.saved
    }

    /// Returns the text of the file if it was changed since it was read or written.
    fn changed_text(&mut self) -> Option<Result<String, DocumentError>> {
        let path = self.path.as_ref()?;
        let stamp = stamp(path);
        if stamp == self.stamp {
            return None;
        }
        self.stamp = stamp;
        let document = Document::from_path(&self.name);
        self.is_lost = document.is_err();
        match document {
            Ok(document) if document.text == self.saved => {
                // The other program has taken its changes back.
                self.conflict = None;
                None
            }
            Ok(document) => Some(Ok(document.text)),
            Err(error) => Some(Err(error)),
        }
    }

    /// Returns `true` if another program has written or removed the file since it was read or written.
    fn has_changed(&self) -> bool {
        self.path
            .as_deref()
            .is_some_and(|path| stamp(path) != self.stamp)
    }

    fn note_saved(&mut self, path: &Path, text: &str) {
        self.name = path.to_string_lossy().into_owned();
        self.path = Some(path.to_owned());
        self.stamp = stamp(path);
        self.is_lost = false;
        self.conflict = None;
        text.clone_into(&mut self.saved);
    }
}

fn stamp(path: &Path) -> Option<Stamp> {
    fs::metadata(path).ok().map(Stamp)
}

impl LayoutEditor {
    /// Returns `true` if [`poll`](Self::poll) will read the file again.
    pub fn has_changed_outside(&self) -> bool {
        self.file.has_changed()
    }

    /// Returns `true` if the text differs from the text that was opened or saved last, or the file has been lost since.
    pub fn is_modified(&self) -> bool {
        self.file.is_lost || self.text != self.file.saved_text()
    }

    /// The text that was opened or saved last.
    pub fn saved_text(&self) -> &str {
        self.file.saved_text()
    }

    /// The state of the text and its file.
    pub fn file_state(&self) -> FileState {
        match (self.file.path(), self.is_modified()) {
            (None, _) => FileState::Unsaved,
            (Some(_), true) => FileState::Modified,
            (Some(_), false) => FileState::Saved,
        }
    }

    /// Changes of another program that wait for a decision.
    pub fn conflict(&self) -> Option<&Conflict> {
        self.file.conflict.as_ref()
    }

    /// Reads the file if another program has changed it. Costs one look at its properties if not.
    pub fn poll(&mut self) -> Option<Change> {
        let was_lost = self.file.is_lost;
        let changed = self.file.changed_text();
        if self.file.is_lost != was_lost {
            self.update_recovery();
        }
        let theirs = match changed? {
            Ok(theirs) => theirs,
            Err(error) => return Some(Change::Unreadable(error)),
        };
        if theirs == self.text {
            self.file.saved = theirs;
            self.file.conflict = None;
            self.update_recovery();
            return None;
        }
        if !self.is_modified() {
            self.replace_text(&theirs);
            self.file.saved = theirs;
            // The edits of an earlier one were undone.
            self.file.conflict = None;
            self.update_recovery();
            return Some(Change::Reloaded);
        }
        let merged = diffy::merge(&self.file.saved, &self.text, &theirs).ok();
        Some(
            match merged.filter(|merged| self.can_adopt(merged, &theirs)) {
                Some(merged) if self.file.conflict.is_none() => {
                    self.replace_text(&merged);
                    self.file.saved = theirs;
                    self.update_recovery();
                    Change::Merged
                }
                _ => {
                    self.file.conflict = Some(Conflict { theirs });
                    Change::Conflict
                }
            },
        )
    }

    /// Returns `false` if two valid layouts became an invalid one, such as two keys at one place.
    fn can_adopt(&self, merged: &str, theirs: &str) -> bool {
        let is_valid = |text: &str| ademan_core::layout::Layout::parse(text, self.name()).is_ok();
        !(self.is_valid() && is_valid(theirs)) || is_valid(merged)
    }

    /// Decides about a conflict. Does nothing without one.
    pub fn resolve(&mut self, resolution: Resolution) {
        let Some(Conflict { theirs }) = self.file.conflict.take() else {
            return;
        };
        if resolution == Resolution::TakeTheirs {
            self.replace_text(&theirs);
        }
        self.file.saved = theirs;
        self.update_recovery();
    }

    /// Writes the text to the file, whole or not at all.
    pub fn save(&mut self) -> Result<(), SaveError> {
        let Some(path) = self.file.path.clone() else {
            return Err(SaveError::NoFile);
        };
        // Some file systems count seconds: the stamp may equal the stamp of the last save.
        self.file.stamp = None;
        match self.poll() {
            Some(Change::Conflict) => return Err(SaveError::Conflict(self.file.name.clone())),
            Some(Change::Merged) => return Err(SaveError::Merged(self.file.name.clone())),
            Some(Change::Reloaded | Change::Unreadable(_)) | None => {}
        }
        if self.file.conflict.is_some() {
            return Err(SaveError::Conflict(self.file.name.clone()));
        }
        if path.exists() {
            self.write(&path, files::replace_text)
        } else {
            self.write(&path, files::replace_private_text)
        }
    }

    /// Writes the text to another file, which is the file of the layout from now on. Replaces an existing one only if
    /// `may_replace` is set.
    pub fn save_as(&mut self, path: &Path, may_replace: bool) -> Result<(), SaveError> {
        match (path.exists(), may_replace) {
            (true, false) => Err(SaveError::Exists(path.to_owned())),
            (true, true) => self.write(path, files::replace_text),
            (false, _) => self.write(path, files::replace_private_text),
        }
    }

    fn write(
        &mut self,
        path: &Path,
        write: fn(&Path, &str) -> Result<(), FileError>,
    ) -> Result<(), SaveError> {
        write(path, &self.text).map_err(|error| SaveError::File {
            name: path.to_string_lossy().into_owned(),
            error: explain(error),
        })?;
        self.file.note_saved(path, &self.text);
        self.update_recovery();
        self.move_recovery();
        Ok(())
    }

    /// Replaces the whole text as one edit.
    pub(super) fn replace_text(&mut self, new: &str) {
        let patch = Patch::between(&self.text, new);
        let parts = self.selection_in(new);
        let edited = Edited {
            patches: vec![patch],
            text: new.to_owned(),
            parts,
        };
        // A patch between two texts applies to the first.
        let _ = self.adopt(edited);
    }

    /// Returns the selection for another text. A part with a name is found by its name, as its index may differ there.
    fn selection_in(&self, other: &str) -> Vec<Part> {
        let Some(tree) = read_tree(other) else {
            return self.selection.clone();
        };
        let name_in_other = |part: Part| editing::name_of(other, &tree, part);
        // Read once: all of 10 000 keys may be selected.
        let targets = editing::targets(other, &tree).into_iter();
        let named: Vec<(Part, Option<String>)> = targets
            .map(|target| (target, name_in_other(target)))
            .collect();
        let moved = |part: Part| {
            let name = self.part_name(part);
            let is_same = name.is_none() || name_in_other(part) == name;
            if is_same || matches!(part, Part::Layout | Part::Pointer) {
                return Some(part);
            }
            let is_kind = |own: &Part| mem::discriminant(own) == mem::discriminant(&part);
            let mut own = named.iter().filter(|(target, _)| is_kind(target));
            let found = own.find(|(_, own_name)| *own_name == name);
            found.map(|(target, _)| *target)
        };
        let selected = self.selection.iter().copied();
        selected.filter_map(moved).collect()
    }
}

/// Replaces the words of the system for a full disk by plain ones.
fn explain(error: FileError) -> FileError {
    match error {
        FileError::Io(error) if error.kind() == io::ErrorKind::StorageFull => {
            io::Error::new(io::ErrorKind::StorageFull, "the disk is full").into()
        }
        error => error,
    }
}
