//! Layouts from links, which other people made.

use std::io::Read;
use std::path::{Path, PathBuf};

use ademan::document::{Document, FileKind};
use ademan::files::{self, OpenDocument};
use ademan::layout::Layout;
use ademan::layout_link::{is_layout_link, layout_in_link, share_layout};
use ademan::message::{escape, escape_path};

use crate::failure::Failure;

/// The folder of the layouts from links, in the state folder of the program.
const FOLDER: &str = "links";

/// Returns the name of a layout that is only looked at or played without an output: for a link, the file to which its layout is
/// written.
pub fn looked_at(name: String) -> Result<String, Failure> {
    if is_layout_link(&name) {
        store(&name)
    } else {
        Ok(name)
    }
}

/// Returns the name of a layout for a session. A link is refused unless it is trusted: a layout decides what is typed, and
/// may have keys that type a shell command.
pub fn trusted(name: String, is_trusted: bool) -> Result<String, Failure> {
    if is_layout_link(&name) && !is_trusted {
        return Err(Failure::wrong_use(
            "the layout comes from a link, and decides what is typed; look at it with `ademan layout show LINK` or `ademan demo --layout LINK`, then add --trust",
        ));
    }
    looked_at(name)
}

/// Writes the layout of a link to a file that only this user can access, and returns its path.
fn store(link: &str) -> Result<String, Failure> {
    let text = layout_in_link(link).map_err(|error| Failure::wrong_use(error.to_string()))?;
    let layout = Layout::from_document(Document::new("link.ron", text.as_str()))?;
    let state = files::state_folder();
    let folder = state.ok_or_else(|| {
        Failure::job("cannot keep the layout of the link: there is no home folder; set HOME")
    })?;
    let folder = folder.join(FOLDER);
    let failed = |error: String| {
        let path = escape_path(&folder);
        Failure::job(format!(
            "cannot keep the layout of the link in {path}: {error}"
        ))
    };
    if let Some(parent) = folder.parent() {
        std::fs::create_dir_all(parent).map_err(|error| failed(error.to_string()))?;
    }
    files::create_private_folder(&folder).map_err(|error| failed(error.to_string()))?;
    let path = free_path(&folder, &text);
    files::replace_private_text(&path, &text).map_err(|error| failed(error.to_string()))?;
    say!(
        "the layout of the link, `{}`, is in {}",
        escape(&layout.name),
        escape_path(&path)
    );
    Ok(path.to_string_lossy().into_owned())
}

/// Returns the path for a layout in the folder: one file for each layout, however often its link is used. A file that a person has
/// changed since, in Studio for example, stays.
fn free_path(folder: &Path, text: &str) -> PathBuf {
    let sum = checksum(text);
    let mut path = folder.join(format!("{sum:08x}.ron"));
    let mut number = 1;
    while has_other_text(&path, text) {
        number += 1;
        path = folder.join(format!("{sum:08x}-{number}.ron"));
    }
    path
}

/// Returns `true` if there is a file with another text.
fn has_other_text(path: &Path, text: &str) -> bool {
    let Ok(file) = files::open_regular(path) else {
        return false;
    };
    let mut kept = Vec::new();
    let read = file.take(text.len() as u64 + 1).read_to_end(&mut kept);
    read.is_ok() && kept != text.as_bytes()
}

/// Returns the FNV-1a hash of a text.
fn checksum(text: &str) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, step)
}

/// Prints the link to a layout.
pub fn print(file: &str, page: &str) -> Result<(), Failure> {
    use std::io::Write;
    let link = share_layout(page, Document::open_kind(FileKind::Layout, file)?)?;
    writeln!(std::io::stdout(), "{link}")?;
    Ok(())
}
