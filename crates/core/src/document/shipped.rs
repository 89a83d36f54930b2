//! The files under `layouts/`, compiled into the program.

use std::path::is_separator;

use ademan_layouts::{FILES, MESHES};

use super::{Document, DocumentError};
use crate::message::escape;
use crate::names;

/// The kind of a file that a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A layout.
    Layout,
    /// A glove.
    Glove,
    /// An arm model.
    Arm,
    /// A person.
    Person,
    /// A setup; none is shipped.
    Setup,
    /// The taps and words of a person as the text decoder has learned them; none is shipped.
    Learned,
}

impl FileKind {
    /// Returns the kind of the files in a folder under `layouts/`. Layouts have several folders.
    fn of_folder(folder: &str) -> Self {
        match folder {
            "gloves" => Self::Glove,
            "arms" => Self::Arm,
            "persons" => Self::Person,
            _ => Self::Layout,
        }
    }

    /// Returns the end of the error for a name that resembles no other: the command that lists the names, or writes a file.
    fn remedy(self) -> &'static str {
        match self {
            Self::Layout => "; `ademan layouts` lists the names",
            Self::Glove => "; `ademan gloves` lists the names",
            Self::Person => "; `ademan person list` lists the names",
            Self::Setup => "; `ademan setup new NAME` writes a setup to start from",
            Self::Arm | Self::Learned => "",
        }
    }

    /// Returns the names of the shipped files of this kind, without folder and `.ron`.
    pub fn shipped(self) -> impl Iterator<Item = &'static str> {
        FILES.iter().filter_map(move |(path, _)| {
            let (folder, name) = path.split_once('/')?;
            (Self::of_folder(folder) == self).then_some(name)
        })
    }
}

/// Returns the names of the shipped layouts, without folder and `.ron`. Gloves, arms and persons are excluded.
pub fn shipped_layouts() -> impl Iterator<Item = &'static str> {
    FileKind::Layout.shipped()
}

/// Returns the names of the shipped gloves, without folder and `.ron`.
pub fn shipped_gloves() -> impl Iterator<Item = &'static str> {
    FileKind::Glove.shipped()
}

/// Returns the names of the shipped persons, without folder and `.ron`.
pub fn shipped_persons() -> impl Iterator<Item = &'static str> {
    FileKind::Person.shipped()
}

/// Returns the mesh that a shipped layout with this text names, in OBJ.
pub fn shipped_mesh(layout: &str, name: &str) -> Option<&'static str> {
    let mut files = FILES.iter();
    let is_shipped = files.any(|(_, text)| *text == layout);
    let mut meshes = MESHES.iter().filter(|_| is_shipped);
    meshes
        .find(|(file, _)| *file == name)
        .map(|(_, text)| *text)
}

/// Returns the shipped file with that name; the folder and `.ron` are optional.
pub(super) fn find(name: &str) -> Option<Document> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    let name = name.strip_prefix("layouts/").unwrap_or(name);
    FILES
        .iter()
        .find(|(path, _)| *path == name || file_name(path) == name)
        .map(|(path, text)| Document::new(format!("layouts/{path}.ron"), *text))
}

/// Returns the names of all shipped files, without folder and `.ron`.
fn names<'a>() -> impl Iterator<Item = &'a str> {
    FILES.iter().map(|(path, _)| file_name(path))
}

fn file_name(path: &str) -> &str {
    path.rsplit_once(is_separator)
        .map_or(path, |(_, name)| name)
}

impl DocumentError {
    /// Returns the error for a name that stands for no file. Its suggestion is the nearest of the shipped names of a kind, or of
    /// all, and of `own`; without one it names the command that lists them.
    pub fn no_such_file(name: &str, kind: Option<FileKind>, own: &[String]) -> Self {
        let of_kind: Vec<&str> =
            kind.map_or_else(|| names().collect(), |it| it.shipped().collect());
        let candidates = of_kind.into_iter().chain(own.iter().map(String::as_str));
        let stem = file_name(name.strip_suffix(".ron").unwrap_or(name));
        let nearest = names::nearest(stem, candidates);
        let advice = match nearest {
            Some(nearest) => format!(", did you mean `{}`?", escape(nearest)),
            None => kind.map_or_else(String::new, |it| it.remedy().to_owned()),
        };
        let shipped = match kind {
            Some(FileKind::Setup | FileKind::Learned) => "",
            _ => ", and no shipped one of that name",
        };
        Self::for_file(name, format!("there is no such file{shipped}{advice}"))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    use super::*;

    #[test]
    fn every_file_under_layouts_is_shipped_under_a_unique_name() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../layouts");
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
        let shipped: BTreeSet<String> = FILES.iter().map(|(path, _)| (*path).into()).collect();
        assert_eq!(on_disk, shipped);
        let names: BTreeSet<&str> = FILES.iter().map(|(path, _)| file_name(path)).collect();
        assert_eq!(names.len(), FILES.len());
    }

    #[test]
    fn an_unknown_name_suggests_the_nearest_shipped_file() {
        let error = Document::shipped("qwerty-falt").unwrap_err();
        assert_eq!(
            error.to_string(),
            "qwerty-falt: there is no such file, and no shipped one of that name, did you mean `qwerty-flat`?"
        );
    }

    #[test]
    fn the_folder_and_the_extension_of_a_shipped_file_are_optional() {
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
}
