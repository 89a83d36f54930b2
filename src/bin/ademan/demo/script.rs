//! The scripts of shipped layouts, which the demo plays on layouts that do not type.

use std::path::Path;

use ademan::document::{Document, FileKind};
use ademan::files::OpenDocument;
use ademan::layout::Layout;

/// Pairs the name of each layout with the text of `examples/scripts/NAME.txt`.
macro_rules! scripts {
    ($($name:literal)+) => {
        &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scripts/", $name, ".txt")))),+]
    };
}

const SCRIPTS: &[(&str, &str)] = scripts! {
    "arm-6dof"
    "arm-gamepad"
    "arrows"
    "claws"
    "direct"
    "drive"
    "drum-pads"
    "game"
    "gestures"
    "joint"
    "lucidgloves-controller"
    "media"
    "mixer"
    "number-entry"
    "phone-pad"
    "phone-words"
    "piano"
    "qwerty-swipe"
    "qwerty-words"
    "rate"
    "radial"
    "ray"
    "scroll-rings"
    "space"
    "steering-wheel"
    "switches"
    "touch-pad"
    "webcam-mouse"
    "workshop"
    "wrist-remote"
    "xy-pad"
};

/// Returns the script of a shipped layout.
fn text(layout: &str) -> Option<&'static str> {
    let script = SCRIPTS.iter().find(|(name, _)| *name == layout);
    script.map(|(_, text)| *text)
}

/// Returns the script for a layout that comes with the program, if it has one. A file of a person has none.
pub fn for_layout(layout: &str) -> Option<&'static str> {
    let document = Document::open_kind(FileKind::Layout, layout).ok()?;
    text(layout).filter(|_| document.path.is_none())
}

/// Returns the script for a layout as it comes with the program. One that was edited has none: the script does not know its controls.
pub fn for_unchanged(layout: &Layout) -> Option<&'static str> {
    let shipped = Document::shipped(&layout.file).ok()?;
    let name = Path::new(&shipped.file).file_stem()?.to_str()?;
    text(name).filter(|_| shipped.text == layout.text)
}

/// Returns the comment at the start of a script, which describes it, in one line.
pub fn title(script: &str) -> String {
    let comment = script.lines().map_while(|line| line.strip_prefix('#'));
    comment.map(str::trim).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;

    use ademan::document::shipped_layouts;

    use super::*;

    #[test]
    fn every_script_of_the_examples_belongs_to_a_shipped_layout_and_has_a_title() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scripts");
        let files = fs::read_dir(folder).unwrap().flatten();
        let paths = files.map(|file| file.path());
        let on_disk: BTreeSet<String> = paths
            .filter(|path| path.extension().is_some_and(|extension| extension == "txt"))
            .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        let shipped: BTreeSet<String> = SCRIPTS.iter().map(|(name, _)| (*name).into()).collect();
        assert_eq!(on_disk, shipped);
        for (name, text) in SCRIPTS {
            assert!(shipped_layouts().any(|layout| layout == *name), "{name}");
            assert!(!title(text).is_empty(), "{name}");
        }
        assert_eq!(for_layout("qwerty-flat"), None);
    }
}
