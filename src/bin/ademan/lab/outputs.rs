//! Files of results.

use std::io::{Read, Write};
use std::path::Path;

use ademan::document::Document;
use ademan::files::{self, FileError};
use ademan::layout::Layout;
use ademan::measures::LabResult;
use ademan::message::escape_path;
use ademan::report::{to_csv, to_html};

use super::OutputArgs;
use crate::failure::Failure;

/// The largest text and result that is read, in bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Reads a file as text. The error has no path.
pub fn read_text(path: &Path) -> Result<String, String> {
    let file = files::open_regular(path).map_err(|error| error.to_string())?;
    let mut text = String::new();
    let read = file.take(MAX_BYTES).read_to_string(&mut text);
    match read {
        Ok(bytes) if bytes as u64 == MAX_BYTES => {
            Err(format!("it has more than {} MB", MAX_BYTES >> 20))
        }
        Ok(_) => Ok(text),
        Err(error) => Err(error.to_string()),
    }
}

/// Writes the files that the arguments name. The result file holds what was typed, so only its owner can read it.
pub fn write(args: &OutputArgs, results: &[LabResult]) -> Result<(), Failure> {
    if let Some(path) = &args.json {
        let texts: Vec<String> = results.iter().map(LabResult::to_json).collect();
        let text = match texts.as_slice() {
            [one] => one.clone(),
            _ => format!("[\n{}]\n", texts.join(",\n")),
        };
        files::replace_private_text(path, &text).map_err(|error| cannot_write(path, &error))?;
    }
    if let Some(path) = &args.csv {
        let text = to_csv(results);
        write_text(path, &text)?;
    }
    if let Some(path) = &args.html {
        let layouts = results.iter().map(|result| {
            let document = Document::new(result.layout_file.as_str(), result.layout.as_str());
            Layout::from_document(document)
        });
        let layouts = layouts.collect::<Result<Vec<_>, _>>()?;
        let text = to_html(results, &layouts).map_err(|error| Failure::job(error.to_string()))?;
        write_text(path, &text)?;
    }
    Ok(())
}

/// Writes a file that others may read.
fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    let written = files::replace(path).and_then(|mut file| Ok(file.write_all(text.as_bytes())?));
    written.map_err(|error| cannot_write(path, &error))
}

fn cannot_write(path: &Path, error: &FileError) -> Failure {
    Failure::job(format!("cannot write {}: {error}", escape_path(path)))
}
