//! Reading a RON file, shipped or from a path.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

use ron::extensions::Extensions;
use serde::Deserialize;

use super::error::DocumentError;
use super::ron_error;
use crate::names;

/// The largest file that is read, in bytes: 1 MiB.
pub const MAX_BYTES: u64 = 1 << 20;

/// What is wrong with a directory.
const IS_DIRECTORY: &str = "this is a directory, name a file in it";

/// What some editors put in front of a text in UTF-8.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// Names the files under `layouts/` that go into the program.
macro_rules! shipped {
    ($($name:literal)+) => {
        &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/layouts/", $name, ".ron")))),+]
    };
}

/// Every file under `layouts/`: its path there without `.ron`, and its text.
const SHIPPED: &[(&str, &str)] = shipped! {
    "arms/unam"
    "gloves/unam-hc11"
    "gloves/unam-hc11-left"
    "keyboards/arrows"
    "keyboards/azerty-flat"
    "keyboards/chords-five"
    "keyboards/colemak-flat"
    "keyboards/dvorak-flat"
    "keyboards/numpad"
    "keyboards/qwerty-arc"
    "keyboards/qwerty-flat"
    "keyboards/qwerty-flat-22"
    "keyboards/qwerty-two-arc"
    "keyboards/qwerty-two-flat"
    "keyboards/qwertz-flat"
    "keyboards/spanish-flat"
    "panels/game"
    "panels/media"
    "panels/switches"
    "panels/touch-pad"
    "panels/workshop"
    "pointers/direct"
    "pointers/joint"
    "pointers/rate"
    "pointers/ray"
    "pointers/space"
};

/// A file as it was read; errors about it know its name and show its lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// The file as its user named it; a shipped one as `layouts/keyboards/arrows.ron`.
    pub file: String,
    /// What is in it.
    pub text: String,
}

impl Document {
    /// Reads the file at the path `name`, or the shipped file of that name.
    ///
    /// A file that is there goes first. A shipped file is named with or without its folder and with
    /// or without `.ron`: `arrows`, `keyboards/arrows.ron`. Files over [`MAX_BYTES`] are refused
    /// without being read to their end.
    pub fn open(name: &str) -> Result<Self, DocumentError> {
        Self::open_relative_to(Path::new(""), name)
    }

    /// As [`open`](Self::open), with paths that begin in `folder`: a file that names another one
    /// means it as seen from itself.
    pub fn open_relative_to(folder: &Path, name: &str) -> Result<Self, DocumentError> {
        let of_file = |message: String| DocumentError::for_file(name, message);
        let path = folder.join(name);
        let kind = fs::metadata(&path).map(|metadata| metadata.is_dir());
        match (kind, shipped_document(name)) {
            (Ok(false), _) => Self::read(&path, name),
            (_, Some(document)) => Ok(document),
            (Ok(true), None) => Err(of_file(IS_DIRECTORY.into())),
            (Err(error), None) if is_absence(&error) => Err(of_file(not_found(name))),
            (Err(error), None) => Err(of_file(format!("cannot read the file: {error}"))),
        }
    }

    /// Reads the regular file at this path; no shipped one takes its place when it is not there.
    pub fn from_path(path: &str) -> Result<Self, DocumentError> {
        let of_file = |message: String| DocumentError::for_file(path, message);
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => Err(of_file(IS_DIRECTORY.into())),
            Ok(metadata) if !metadata.is_file() => {
                Err(of_file("this is not a regular file".into()))
            }
            Ok(_) => Self::read(Path::new(path), path),
            Err(error) if is_absence(&error) => Err(of_file("there is no such file".into())),
            Err(error) => Err(of_file(format!("cannot read the file: {error}"))),
        }
    }

    /// Reads the shipped file of that name, whatever is on the disk.
    pub fn shipped(name: &str) -> Result<Self, DocumentError> {
        shipped_document(name).ok_or_else(|| DocumentError::for_file(name, not_found(name)))
    }

    /// Makes a document of a text that is already there; `file` names it in errors. A byte order mark
    /// at the start is dropped.
    pub fn new(file: impl Into<String>, text: impl Into<String>) -> Self {
        let mut text = text.into();
        if text.starts_with(BYTE_ORDER_MARK) {
            text.drain(..BYTE_ORDER_MARK.len_utf8());
        }
        Self {
            file: file.into(),
            text,
        }
    }

    fn read(path: &Path, name: &str) -> Result<Self, DocumentError> {
        let of_file = |message: String| DocumentError::for_file(name, message);
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes))
            .map_err(|error| of_file(format!("cannot read the file: {error}")))?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(of_file("the file is larger than 1 MiB".into()));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self::new(name, text)),
            Err(error) => {
                let place = error.utf8_error().valid_up_to();
                let text = String::from_utf8_lossy(error.as_bytes());
                let message = "the file is not in UTF-8, save it in that encoding";
                Err(DocumentError::at(name, &text, place..place + 1, message))
            }
        }
    }

    /// What is in the file, as a `T`; see [`parse`].
    pub fn parse<'a, T: Deserialize<'a>>(&'a self) -> Result<T, DocumentError> {
        parse_ron(&self.text, &self.file)
    }

    /// An error at `part`, a piece of [`text`](Self::text), such as the text of a [`Word`](super::Word).
    pub fn error_at(&self, part: &str, message: impl std::fmt::Display) -> DocumentError {
        DocumentError::at_slice(&self.file, &self.text, part, message)
    }
}

/// Reads a RON text as a `T`, which may borrow from it; `file` names the text in errors.
///
/// Optional fields go without `Some`. Errors have a place, say what was expected there, and name
/// the valid name that is nearest to a wrong one. Nesting deeper than 128 is an error.
pub fn parse_ron<'a, T: Deserialize<'a>>(text: &'a str, file: &str) -> Result<T, DocumentError> {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .from_str(text)
        .map_err(|error| {
            let range = ron_error::range(text, &error);
            DocumentError::at(file, text, range, ron_error::message(&error.code))
        })
}

/// The names of the shipped layouts, without folders and `.ron`: everything but gloves and arms.
pub fn shipped_layouts() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().filter_map(|(name, _)| {
        let (folder, short) = name.split_once('/')?;
        (!matches!(folder, "arms" | "gloves")).then_some(short)
    })
}

fn shipped_document(name: &str) -> Option<Document> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    let name = name.strip_prefix("layouts/").unwrap_or(name);
    SHIPPED
        .iter()
        .find(|(long, _)| *long == name || short(long) == name)
        .map(|(long, text)| Document::new(format!("layouts/{long}.ron"), *text))
}

fn short(name: &str) -> &str {
    name.rsplit_once('/').map_or(name, |(_, short)| short)
}

fn is_absence(error: &std::io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::NotFound | ErrorKind::NotADirectory | ErrorKind::InvalidInput
    )
}

fn not_found(name: &str) -> String {
    let stem = short(name.strip_suffix(".ron").unwrap_or(name));
    let nearest = names::nearest(stem, SHIPPED.iter().map(|(long, _)| short(long)));
    let hint = nearest.map_or(String::new(), |nearest| {
        format!(", did you mean `{nearest}`?")
    });
    format!("there is no such file, and no shipped one of that name{hint}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_file_under_layouts_is_shipped_under_a_short_name_of_its_own() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("layouts");
        let mut on_disk = BTreeSet::new();
        for folder in fs::read_dir(root).unwrap().flatten() {
            let Ok(files) = fs::read_dir(folder.path()) else {
                continue;
            };
            for file in files.flatten() {
                let path = file.path();
                if path.extension().is_some_and(|extension| extension == "ron") {
                    let folder = folder.file_name().into_string().unwrap();
                    on_disk.insert(format!("{folder}/{}", path.file_stem().unwrap().display()));
                }
            }
        }
        let shipped: BTreeSet<String> = SHIPPED.iter().map(|(name, _)| (*name).into()).collect();
        assert_eq!(on_disk, shipped);
        let short: BTreeSet<&str> = SHIPPED.iter().map(|(name, _)| short(name)).collect();
        assert_eq!(short.len(), SHIPPED.len());
    }

    #[test]
    fn a_shipped_file_answers_to_each_of_its_names() {
        for name in [
            "arrows",
            "arrows.ron",
            "keyboards/arrows",
            "keyboards/arrows.ron",
            "layouts/keyboards/arrows.ron",
        ] {
            let document = Document::shipped(name).unwrap();
            assert_eq!(document.file, "layouts/keyboards/arrows.ron");
        }
    }

    #[test]
    fn an_unknown_name_says_what_was_tried_and_what_may_have_been_meant() {
        let error = Document::open("qwerty-falt").unwrap_err();
        assert_eq!(
            error.to_string(),
            "qwerty-falt: there is no such file, and no shipped one of that name, did you mean `qwerty-flat`?"
        );
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_text() {
        let read = |text: &str| Document::new("a.ron", text).parse::<u8>();
        assert_eq!(read("\u{feff}7"), Ok(7));
        let error = read("\u{feff}x").unwrap_err();
        assert_eq!((error.line(), error.column()), (Some(1), Some(1)));
    }
}
