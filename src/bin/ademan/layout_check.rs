//! `ademan layout check`: errors in layout files, and keys out of reach.

use std::io::{self, Write};

use ademan::document::{DocumentError, DocumentFault};
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::message::{escape, escape_json};
use ademan::session::counted;
use ademan::setup::{ArmSetup, OtherHand, Setup};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::setup_args::number_in;

/// Checks every file, even after an invalid one.
pub fn check(
    files: &[String],
    hand: Option<ArmSetup>,
    setup: Option<&str>,
    as_json: bool,
) -> Result<(), Failure> {
    let mut setup = match setup {
        Some(path) => Setup::load(path)?,
        None => Setup::default(),
    };
    setup.arm = hand.unwrap_or(setup.arm);
    let mut invalid = 0;
    let mut checked = Vec::new();
    for file in files {
        let layout = Layout::load(file);
        invalid += usize::from(layout.is_err());
        match as_json {
            true => checked.push(json_of(file, &layout, &setup)?),
            false => print(file, &layout, &setup)?,
        }
    }
    if as_json {
        let text = serde_json::to_string_pretty(&checked).map_err(io::Error::from)?;
        writeln!(io::stdout(), "{}", escape_json(&text))?;
    }
    match invalid {
        0 => Ok(()),
        _ => Err(Failure::wrong_use(format!(
            "{invalid} of {} cannot be used",
            counted(files.len() as u64, "file")
        ))),
    }
}

fn print(file: &str, layout: &Result<Layout, DocumentError>, setup: &Setup) -> Result<(), Failure> {
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
    if let Some(warning) = reach_warning(layout, setup)? {
        complain!("warning: {file}: {warning}");
    }
    Ok(())
}

fn json_of(
    file: &str,
    layout: &Result<Layout, DocumentError>,
    setup: &Setup,
) -> Result<Value, Failure> {
    Ok(match layout {
        Ok(layout) => json!({
            "file": file,
            "valid": true,
            "keys": layout.keys.len(),
            "other_controls": layout.controls.len(),
            "layers": layout.layers.len(),
            "errors": [],
            "warnings": reach_warning(layout, setup)?.into_iter().collect::<Vec<_>>(),
        }),
        Err(error) => {
            let fault = |fault: &DocumentFault| json!({"line": fault.line(), "column": fault.column(), "message": fault.message()});
            let errors: Vec<Value> = error.errors().iter().map(fault).collect();
            json!({"file": file, "valid": false, "errors": errors, "warnings": []})
        }
    })
}

/// Returns one warning for all controls that no hand of the setup can press. Such a layout is still valid.
fn reach_warning(layout: &Layout, setup: &Setup) -> Result<Option<String>, Failure> {
    let needs_left = layout.has_board_for(Side::Left);
    let left_hand = || OtherHand {
        arm: setup.arm.clone(),
        ..OtherHand::default()
    };
    let other_hand = setup.other_hand.clone();
    let setup = Setup {
        layout: layout.file.clone(),
        other_hand: other_hand.or_else(|| needs_left.then(left_hand)),
        // The permissions of the setup do not matter for the reach.
        allow_system_keys: true,
        ..setup.clone()
    };
    let setup = setup.load_files()?;
    let report = setup.reach_report(&setup.layout);
    Ok(report.map(|report| report.to_string()))
}

/// Parses the hand and forearm length of a hand.
pub fn hand(text: &str) -> Result<ArmSetup, String> {
    let (hand, forearm) = text
        .split_once(',')
        .ok_or("two lengths in mm are needed, as in 189,262")?;
    Ok(ArmSetup::Measured {
        hand_length_mm: number_in(hand.trim(), 100.0, 300.0, "mm")?,
        forearm_length_mm: number_in(forearm.trim(), 100.0, 500.0, "mm")?,
    })
}
