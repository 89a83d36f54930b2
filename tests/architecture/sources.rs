//! The sources of the crates, as far as they are shipped.

use std::fs;
use std::path::Path;

use crate::security::{files, root};

/// The folders of the program and of the crates that may wait, and what stands before the names of their files.
const PROGRAM: [(&str, &str); 3] = [
    ("src", ""),
    ("crates/runtime/src", ""),
    ("crates/studio/src", "studio/"),
];

/// The folder of the stages.
pub const CORE: &str = "crates/core/src";

/// Returns the modules that the library in a folder declares, in their order.
pub fn modules(folder: &str) -> Vec<String> {
    let library = fs::read_to_string(root().join(folder).join("lib.rs")).expect("a library");
    let lines = library.lines();
    lines
        .filter_map(|line| Some(line.strip_prefix("pub mod ")?.strip_suffix(';')?.to_owned()))
        .collect()
}

/// Returns the path below a folder and the code of each source file: without comments, unit tests and white space.
pub fn shipped(folder: &str) -> Vec<(String, String)> {
    let folder = root().join(folder);
    let found = files(&folder, ".rs");
    assert!(found.len() > 100, "only {} files were found", found.len());
    found
        .into_iter()
        .map(|(path, text)| (name(&folder, &path), without_tests(&text)))
        .filter(|(name, _)| !name.ends_with("tests.rs") && !name.contains("/tests/"))
        .collect()
}

/// Returns the same for all files of the program, without the core and the lab: `bin/…`, `session/…`, `studio/…`.
pub fn program() -> Vec<(String, String)> {
    let files = PROGRAM.into_iter().flat_map(|(folder, prefix)| {
        let named = move |(name, code)| (format!("{prefix}{name}"), code);
        shipped(folder).into_iter().map(named)
    });
    files.collect()
}

fn name(folder: &Path, path: &Path) -> String {
    let path = path.strip_prefix(folder).expect("a path below the folder");
    path.to_string_lossy().into_owned()
}

/// Unit tests stand at the end of a file.
fn without_tests(text: &str) -> String {
    let mut lines = text.lines().peekable();
    let mut code = String::new();
    while let Some(line) = lines.next() {
        let is_module = |next: &&str| next.contains("mod ") && next.ends_with('{');
        if line == "#[cfg(test)]" && lines.peek().is_some_and(is_module) {
            break;
        }
        if !line.trim_start().starts_with("//") {
            code.extend(line.split_whitespace());
        }
    }
    code
}

#[test]
fn comments_and_unit_tests_are_not_shipped() {
    let text = "/// use crate::a;\nuse crate::b;\nlock\n    .lock()\n    .unwrap()\n#[cfg(test)]\npub(super) mod tests {\n    use crate::c;\n}\n";
    assert_eq!(without_tests(text), "usecrate::b;lock.lock().unwrap()");
}
