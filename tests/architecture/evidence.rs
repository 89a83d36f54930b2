//! Evidence: the tests that a table names, checked to exist and to run.

use std::fs;
use std::path::{Path, PathBuf};

/// A file of this package, and a test in it. In `tests/outputs/vm/` it may also be a line that the scenario prints.
pub type Evidence = (&'static str, &'static str);

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the reason why a piece of evidence proves nothing, if there is one.
pub fn objection((file, name): Evidence) -> Option<String> {
    let Ok(text) = fs::read_to_string(root().join(file)) else {
        return Some(format!("there is no file {file} for `{name}`"));
    };
    if !is_compiled(Path::new(file)) {
        return Some(format!("{file} is part of no program"));
    }
    let is_line = || text.contains(&format!("scene.report(\"{name}\")"));
    let exists = is_test(&text, name) || file.starts_with("tests/outputs/vm/") && is_line();
    (!exists).then(|| format!("{file} has no test `{name}` that runs"))
}

/// Returns `true` if `text` has a test function of this name that is not ignored.
pub fn is_test(text: &str, name: &str) -> bool {
    let start = format!("fn {name}()");
    let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
    let Some(index) = lines.iter().position(|line| line.starts_with(&start)) else {
        return false;
    };
    let before = lines[..index].iter().rev();
    let attributes: Vec<_> = before.take_while(|line| line.starts_with("#[")).collect();
    let has = |attribute: &str| attributes.iter().any(|line| line.starts_with(attribute));
    has("#[test]") && !has("#[ignore")
}

/// Returns `true` if a program declares the file as a module.
pub fn is_compiled(file: &Path) -> bool {
    let folder = file.parent().expect("a file is in a folder");
    let stem = file.file_stem().expect("a file has a name");
    let module = stem.to_string_lossy();
    if folder == Path::new("tests") || module == "main" || module == "lib" {
        return true;
    }
    let (folder, module) = match module.as_ref() {
        "mod" => (
            folder.parent().expect("a module is in a folder"),
            folder
                .file_name()
                .expect("a folder has a name")
                .to_string_lossy(),
        ),
        _ => (folder, module),
    };
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
