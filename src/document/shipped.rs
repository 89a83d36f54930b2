//! The files under `layouts/`, compiled into the program.

use super::Document;

/// Pairs each path below `layouts/` (without `.ron`) with the text of the file.
macro_rules! shipped_files {
    ($($name:literal)+) => {
        &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/layouts/", $name, ".ron")))),+]
    };
}

/// The path below `layouts/` without `.ron`, and the text, of each file.
const SHIPPED_FILES: &[(&str, &str)] = shipped_files! {
    "arms/unam"
    "gloves/lucidgloves"
    "gloves/lucidgloves-left"
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
    "pointers/arm-6dof"
    "pointers/arm-gamepad"
    "pointers/direct"
    "pointers/joint"
    "pointers/rate"
    "pointers/ray"
    "pointers/space"
};

/// Returns the names of the shipped layouts, without folder and `.ron`. Gloves and arms are excluded.
pub fn shipped_layouts() -> impl Iterator<Item = &'static str> {
    SHIPPED_FILES.iter().filter_map(|(path, _)| {
        let (folder, name) = path.split_once('/')?;
        (!matches!(folder, "arms" | "gloves")).then_some(name)
    })
}

/// Returns the names of the shipped gloves, without folder and `.ron`.
pub fn shipped_gloves() -> impl Iterator<Item = &'static str> {
    let paths = SHIPPED_FILES.iter();
    paths.filter_map(|(path, _)| path.strip_prefix("gloves/"))
}

/// Returns the shipped file with that name; the folder and `.ron` are optional.
pub(super) fn find(name: &str) -> Option<Document> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    let name = name.strip_prefix("layouts/").unwrap_or(name);
    SHIPPED_FILES
        .iter()
        .find(|(path, _)| *path == name || file_name(path) == name)
        .map(|(path, text)| Document::new(format!("layouts/{path}.ron"), *text))
}

/// Returns the names of all shipped files, without folder and `.ron`.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED_FILES.iter().map(|(path, _)| file_name(path))
}

pub(super) fn file_name(path: &str) -> &str {
    path.rsplit_once('/').map_or(path, |(_, name)| name)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    use super::*;

    #[test]
    fn every_file_under_layouts_is_shipped_under_a_unique_name() {
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
        let shipped: BTreeSet<String> = SHIPPED_FILES
            .iter()
            .map(|(path, _)| (*path).into())
            .collect();
        assert_eq!(on_disk, shipped);
        let names: BTreeSet<&str> = SHIPPED_FILES
            .iter()
            .map(|(path, _)| file_name(path))
            .collect();
        assert_eq!(names.len(), SHIPPED_FILES.len());
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
