//! Lists of what is proved, and where: that the tests they name are there and run.

use std::fs;
use std::path::{Path, PathBuf};

/// What proves something: a file of this package, and a test in it or a line that the scenario in the virtual machine says.
pub type Witness = (&'static str, &'static str);

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Why the witness proves nothing, if so.
pub fn doubt((file, name): Witness) -> Option<String> {
    let Ok(text) = fs::read_to_string(root().join(file)) else {
        return Some(format!("there is no file {file}"));
    };
    if !is_compiled(Path::new(file)) {
        return Some(format!("{file} is in no test program"));
    }
    let is_there = match file.starts_with("tests/outputs/vm/") {
        true => text.contains(&format!("scene.tell(\"{name}\")")),
        false => is_test(&text, name),
    };
    (!is_there).then(|| format!("{file} has no test `{name}` that runs"))
}

/// Whether `text` has a function of this name that is a test and is not left out.
pub fn is_test(text: &str, name: &str) -> bool {
    let start = format!("fn {name}()");
    let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
    let Some(place) = lines.iter().position(|line| line.starts_with(&start)) else {
        return false;
    };
    let before = lines[..place].iter().rev();
    let attributes: Vec<_> = before.take_while(|line| line.starts_with("#[")).collect();
    let has = |attribute: &str| attributes.iter().any(|line| line.starts_with(attribute));
    has("#[test]") && !has("#[ignore")
}

/// Whether the file is one that some program is made of.
pub fn is_compiled(file: &Path) -> bool {
    let folder = file.parent().expect("a file is in a folder");
    let module = file.file_stem().expect("it has a name").to_string_lossy();
    if folder == Path::new("tests") || module == "main" || module == "mod" || module == "lib" {
        return true;
    }
    let parents = [
        folder.join("mod.rs"),
        folder.join("main.rs"),
        folder.join("lib.rs"),
        folder.with_extension("rs"),
    ];
    parents.iter().any(|parent| {
        let text = fs::read_to_string(root().join(parent)).unwrap_or_default();
        let declared = format!("mod {module};");
        text.lines().any(|line| line.trim().ends_with(&declared))
    })
}
