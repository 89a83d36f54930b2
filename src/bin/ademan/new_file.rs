//! Files that a person starts from: copies of those that come with the program.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::message::{escape, escape_path, shell_word};

use crate::failure::Failure;

/// Returns the path with an extension, if it has none.
pub fn with_extension(path: &Path, extension: &str) -> PathBuf {
    match path.extension() {
        Some(_) => path.to_owned(),
        None => path.with_extension(extension),
    }
}

/// Replaces the field `name` of a text by the name of the file.
pub fn renamed(text: &str, old_name: &str, path: &Path) -> String {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let field = |name: &str| format!("name: {name:?}");
    text.replacen(&field(old_name), &field(&name), 1)
}

/// Creates a file, says of what it is a copy, and the commands that use it. Fails if it exists.
pub fn create(path: &Path, text: &str, original: &str, next: &str) -> Result<(), Failure> {
    let cannot_write = |error: io::Error| {
        let remedy = match error.kind() {
            io::ErrorKind::AlreadyExists => "; choose another name or remove it",
            _ => "",
        };
        let path = escape_path(path);
        Failure::wrong_use(format!("cannot write {path}: {error}{remedy}"))
    };
    let mut file = File::create_new(path).map_err(cannot_write)?;
    file.write_all(text.as_bytes()).map_err(cannot_write)?;
    let mut out = io::stdout().lock();
    let shown = escape_path(path);
    writeln!(out, "wrote {shown}, a copy of {}", escape(original))?;
    let next = next.replace("FILE", &shell_word(&path.to_string_lossy()));
    Ok(writeln!(out, "edit it, then: {next}")?)
}
