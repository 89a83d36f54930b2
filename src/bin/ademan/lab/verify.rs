//! `ademan lab verify`: a result is run again.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;

use ademan::document::Document;
use ademan::measures::{LabResult, ReadError, compare, summarize};
use ademan::message::{escape, escape_path};

use super::conditions::Prepared;
use super::{outputs, table};
use crate::failure::Failure;

/// Runs the results of a file again, and compares each figure exactly.
pub fn run(path: &Path, jobs: Option<NonZeroUsize>) -> Result<(), Failure> {
    let file = escape_path(path).to_string();
    let results = read_results(path)?;
    for (number, result) in results.iter().enumerate() {
        let document = Document::new(result.layout_file.as_str(), result.layout.as_str());
        let prepared = Prepared::again(result, jobs)?.with_people_of(&result.scores);
        let scores = prepared.scores(&document)?;
        let different = scores.iter().zip(&result.scores).position(|(a, b)| a != b);
        if scores.len() != result.scores.len() || different.is_some() {
            let who = different.map_or(String::new(), |index| format!(", first of person {index}"));
            return Err(Failure::job(format!(
                "{file}: the figures differ{who}; the file was changed, or another kind of processor or build made it"
            )));
        }
        if summarize(&scores) != result.summary {
            return Err(Failure::job(format!(
                "{file}: the people are the same, and the figures of all of them differ; the file was changed"
            )));
        }
        if prepared.participants != result.participants {
            return Err(Failure::job(format!(
                "{file}: the parameters of the people differ; the file was changed"
            )));
        }
        // The first result is compared with nothing.
        let first = results[..number].first();
        let comparison = first.and_then(|first| {
            let compared = compare(
                (&first.layout_file, &first.scores),
                (&result.layout_file, &scores),
            );
            compared.ok()
        });
        if comparison != result.comparison {
            return Err(Failure::job(format!(
                "{file}: the comparison of {} differs; the file was changed",
                escape(&result.layout_file)
            )));
        }
        writeln!(
            io::stdout(),
            "{file}: {}: the same figures for {} {}",
            escape(&result.layout_file),
            scores.len(),
            table::people(scores.len())
        )?;
    }
    Ok(())
}

/// Reads the results of a file.
pub fn read_results(path: &Path) -> Result<Vec<LabResult>, Failure> {
    let cannot =
        |error: String| Failure::wrong_use(format!("cannot use {}: {error}", escape_path(path)));
    let text = outputs::read_text(path).map_err(cannot)?;
    read(&text).map_err(|error| cannot(error.to_string()))
}

/// Reads one result, or the list of a comparison.
fn read(text: &str) -> Result<Vec<LabResult>, ReadError> {
    let own = env!("CARGO_PKG_VERSION");
    if !text.trim_start().starts_with('[') {
        return Ok(vec![LabResult::from_json(text, own)?]);
    }
    let parts: Vec<serde_json::Value> =
        serde_json::from_str(text).map_err(|error| ReadError::NoResult(error.to_string()))?;
    if parts.is_empty() {
        return Err(ReadError::NoResult("its list is empty".to_owned()));
    }
    let parts = parts.iter();
    parts
        .map(|part| LabResult::from_json(&part.to_string(), own))
        .collect()
}
