//! Files of results.

use std::path::Path;

use ademan::document::Document;
use ademan::files::{self, FileError};
use ademan::layout::Layout;
use ademan::measures::LabResult;
use ademan::message::escape_path;
use ademan::phrases::Corpus;
use ademan::report::{to_csv, to_html};

use super::OutputArgs;
use crate::failure::Failure;

/// The largest text and result that is read, in MiB.
const MAX_MIB: u64 = 256;

/// Reads a file as text. The error has no path.
pub fn read_text(path: &Path) -> Result<String, String> {
    files::read_regular_text(path, MAX_MIB).map_err(|error| error.to_string())
}

/// Reads the bytes of a file. The error has no path.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    files::read_regular(path, MAX_MIB).map_err(|error| error.to_string())
}

/// Reads the phrases of a file.
pub fn read_corpus(path: &Path) -> Result<Corpus, Failure> {
    let cannot =
        |error: String| Failure::wrong_use(format!("cannot use {}: {error}", escape_path(path)));
    let text = read_text(path).map_err(cannot)?;
    let name = path.to_string_lossy();
    Corpus::from_text(&name, &text).map_err(|error| cannot(error.to_string()))
}

/// Writes the files that the arguments name. One that cannot be written does not cost the others.
pub fn write(args: &OutputArgs, results: &[LabResult]) -> Result<(), Failure> {
    let json = args.json.as_ref().map(|path| write_json(path, results));
    let csv = args
        .csv
        .as_ref()
        .map(|path| write_text(path, &to_csv(results)));
    let html = args.html.as_ref().map(|path| write_html(path, results));
    [json, csv, html].into_iter().flatten().collect()
}

/// Writes the result file. It holds what was typed, so only its owner can read it.
fn write_json(path: &Path, results: &[LabResult]) -> Result<(), Failure> {
    let texts: Vec<String> = results.iter().map(LabResult::to_json).collect();
    let text = match texts.as_slice() {
        [one] => one.clone(),
        _ => format!("[\n{}]\n", texts.join(",\n")),
    };
    write_private(path, &text)
}

fn write_html(path: &Path, results: &[LabResult]) -> Result<(), Failure> {
    let layouts = results.iter().map(|result| {
        let document = Document::new(result.layout_file.as_str(), result.layout.as_str());
        Layout::from_document(document)
    });
    let layouts = layouts.collect::<Result<Vec<_>, _>>()?;
    let text = to_html(results, &layouts).map_err(|error| Failure::job(error.to_string()))?;
    write_text(path, &text)
}

/// Creates a folder that only its owner can read, unless it exists.
pub fn create_folder(path: &Path) -> Result<(), Failure> {
    files::create_private_folder(path).map_err(|error| {
        let folder = escape_path(path);
        Failure::wrong_use(format!("cannot use the folder {folder}: {error}"))
    })
}

/// Writes a file that only its owner can read.
pub fn write_private(path: &Path, text: &str) -> Result<(), Failure> {
    files::replace_private_text(path, text).map_err(|error| cannot_write(path, &error))
}

/// Writes a file that others may read.
fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    files::replace_public_text(path, text).map_err(|error| cannot_write(path, &error))
}

/// Returns the failure of a result that cannot be written.
pub fn cannot_write(path: &Path, error: &FileError) -> Failure {
    Failure::job(format!("cannot write {}: {error}", escape_path(path)))
}
