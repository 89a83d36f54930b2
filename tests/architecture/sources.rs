//! The sources of the crates, as far as they are shipped.

use std::fs;
use std::sync::LazyLock;

/// The path of each source file in its order, and the code: without comments, unit tests and white space.
pub static SHIPPED: LazyLock<Vec<(String, String)>> = LazyLock::new(|| {
    let mut found = Vec::new();
    add_files("src", &mut found);
    add_files("crates", &mut found);
    assert!(found.len() > 1000, "only {} files were found", found.len());
    found.sort();
    found
});

fn add_files(folder: &str, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let name = format!("{folder}/{}", entry.file_name().to_string_lossy());
        let unshipped = ["/benches", "/examples", "/tests", "tests.rs"];
        if unshipped.iter().any(|end| name.ends_with(end)) {
            continue;
        }
        if entry.path().is_dir() {
            add_files(&name, found);
        } else if name.ends_with(".rs") {
            let text = fs::read_to_string(&name).expect("a text file");
            found.push((name, without_tests(&text)));
        }
    }
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
