//! `ademan layout check`: errors in layout files, and keys out of reach.

use std::io::{self, Write};

use ademan::document::{DocumentError, DocumentFault};
use ademan::layout::Layout;
use ademan::message::escape;
use ademan::session::counted;
use ademan::setup::Setup;
use serde_json::{Value, json};

use crate::failure::Failure;

/// The maximum number of names in a warning.
const MAX_NAMES: usize = 12;

/// Checks every file, even after an invalid one.
pub fn check(files: &[String], as_json: bool) -> Result<(), Failure> {
    let mut invalid = 0;
    let mut checked = Vec::new();
    for file in files {
        let layout = Layout::load(file);
        invalid += usize::from(layout.is_err());
        match as_json {
            true => checked.push(json_of(file, &layout)?),
            false => print(file, &layout)?,
        }
    }
    if as_json {
        let text = serde_json::to_string_pretty(&checked).map_err(io::Error::from)?;
        writeln!(io::stdout(), "{text}")?;
    }
    match invalid {
        0 => Ok(()),
        _ => Err(Failure::wrong_use(format!(
            "{invalid} of {} cannot be used",
            counted(files.len() as u64, "file")
        ))),
    }
}

fn print(file: &str, layout: &Result<Layout, DocumentError>) -> Result<(), Failure> {
    let layout = match layout {
        Ok(layout) => layout,
        Err(error) => {
            complain!("error: {error}");
            return Ok(());
        }
    };
    let keys = counted(layout.keys.len() as u64, "key");
    let layers = counted(layout.layers.len() as u64, "layer");
    let others = match layout.controls.len() as u64 {
        0 => String::new(),
        count => format!("{}, ", counted(count, "other control")),
    };
    let file = escape(file);
    writeln!(io::stdout(), "{file}: valid, {keys}, {others}{layers}")?;
    if let Some(warning) = reach_warning(layout)? {
        complain!("warning: {file}: {warning}");
    }
    Ok(())
}

fn json_of(file: &str, layout: &Result<Layout, DocumentError>) -> Result<Value, Failure> {
    Ok(match layout {
        Ok(layout) => json!({
            "file": file,
            "valid": true,
            "keys": layout.keys.len(),
            "other_controls": layout.controls.len(),
            "layers": layout.layers.len(),
            "errors": [],
            "warnings": reach_warning(layout)?.into_iter().collect::<Vec<_>>(),
        }),
        Err(error) => {
            let fault = |fault: &DocumentFault| json!({"line": fault.line(), "column": fault.column(), "message": fault.message()});
            let errors: Vec<Value> = error.errors().iter().map(fault).collect();
            json!({"file": file, "valid": false, "errors": errors, "warnings": []})
        }
    })
}

/// Returns one warning for all controls that the default hand cannot press. Such a layout is still valid.
fn reach_warning(layout: &Layout) -> Result<Option<String>, Failure> {
    let setup = Setup {
        layout: layout.file.clone(),
        ..Setup::default()
    };
    let setup = setup.load_files()?;
    let mut found = setup.out_of_reach();
    if found.is_empty() {
        return Ok(None);
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let described = found.iter().take(MAX_NAMES).map(|(name, metres)| {
        let distance = match metres.is_finite() {
            true => format!("{:.0} mm", metres * 1e3),
            false => "no position".into(),
        };
        format!("`{}` ({distance})", escape(name))
    });
    let mut names: Vec<String> = described.collect();
    if found.len() > MAX_NAMES {
        names.push(format!("and {} more", found.len() - MAX_NAMES));
    }
    Ok(Some(format!(
        "{} out of reach of the default hand, nearest first: {}; move the board nearer or make it smaller",
        counted(found.len() as u64, "control"),
        names.join(", ")
    )))
}
