//! Files that a person starts from: copies of those that come with the program.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::document::quote;
use ademan::files;
use ademan::message::{escape, escape_path, shell_word};

use crate::failure::Failure;

/// The name of the standard output in place of a file.
const STDOUT: &str = "-";

/// Returns the path with an extension after the name, unless the path has that extension or is the standard output, `-`.
pub fn with_extension(path: &Path, extension: &str) -> PathBuf {
    let has_extension = path.extension().is_some_and(|it| it == extension);
    if has_extension || path == Path::new(STDOUT) {
        path.to_owned()
    } else {
        path.with_added_extension(extension)
    }
}

/// Returns the name of a file without its extension, with blanks for control characters.
pub fn name_of(path: &Path) -> String {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    name.replace(char::is_control, " ")
}

/// Replaces the field `name` of a text by the name of the file. A text for the standard output keeps its name.
pub fn renamed(text: &str, old_name: &str, path: &Path) -> String {
    if path == Path::new(STDOUT) {
        return text.to_owned();
    }
    let field = |given: &str| format!("name: {}", quote(given));
    text.replacen(&field(old_name), &field(&name_of(path)), 1)
}

/// Creates a file, and prints its origin and the commands that use it, with the file in place of each word `FILE`. Fails if the file
/// exists. Writes only the text to the standard output, `-`.
pub fn create(path: &Path, text: &str, original: &str, next: &str) -> Result<(), Failure> {
    write(path, text)?;
    announce(path, original, next)
}

/// Fails if a file cannot be created at a path, before the work whose result it keeps. The standard output, `-`, is always accepted.
pub fn check(path: &Path) -> Result<(), Failure> {
    if path == Path::new(STDOUT) {
        return Ok(());
    }
    let checked = files::check_absent(path).and_then(|()| files::check_destination(path));
    checked.map_err(|error| Failure::cannot_write(path, error))
}

/// Returns the first path, by its number from 1, at which there is no file.
pub fn first_free(numbered: impl Fn(usize) -> PathBuf) -> PathBuf {
    let mut paths = (1..).map(numbered);
    let free = paths.find(|path| path.symlink_metadata().is_err());
    free.expect("there are more numbers than files")
}

/// Creates a file. Fails if it exists. Writes the text to the standard output, `-`.
pub fn write(path: &Path, text: &str) -> Result<(), Failure> {
    if path == Path::new(STDOUT) {
        return Ok(io::stdout().write_all(text.as_bytes())?);
    }
    files::write_new(path, text.as_bytes()).map_err(|error| Failure::cannot_write(path, error))
}

/// Reports a new file and the commands that use it. Reports nothing for the standard output, `-`.
pub fn announce(path: &Path, original: &str, next: &str) -> Result<(), Failure> {
    if path == Path::new(STDOUT) {
        return Ok(());
    }
    let mut out = io::stdout().lock();
    let shown = escape_path(path);
    writeln!(out, "wrote {shown}, {}", escape(original))?;
    let name = path.to_string_lossy();
    let file = shell_word(&name);
    // Only the whole word: another file that a command names may have it in its name.
    let words = next.split(' ');
    let words = words.map(|word| if word == "FILE" { &*file } else { word });
    let commands = words.collect::<Vec<_>>().join(" ");
    Ok(writeln!(out, "edit it, then: {commands}")?)
}
