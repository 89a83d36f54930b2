//! `ademan layout check`: errors in layout files, keys out of reach, and keys that the simulated hand cannot press.

use std::io::{self, Write};

use ademan::document::{DocumentError, DocumentFault};
use ademan::files::Load;
use ademan::layout::{BoardOverlap, Layout};
use ademan::message::escape;
use ademan::pipeline::MAIN_PROFILE;
use ademan::session::counted;
use ademan::setup::{ArmSetup, ProfileSetup, Setup, SetupError};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::list::print_json;
use crate::setup_args::number_in;

/// The largest number of controls that the simulated hand cannot press with a warning each.
const MAX_UNPRESSABLE: usize = 12;

/// Checks every file, even after an invalid one.
pub fn check(
    files: &[String],
    hand: Option<ArmSetup>,
    person: Option<String>,
    setup: Option<&str>,
    as_json: bool,
) -> Result<(), Failure> {
    let has_setup = setup.is_some();
    let mut setup = match setup {
        Some(path) => Setup::load(path)?,
        None => Setup::default(),
    };
    setup.arm = hand.unwrap_or(setup.arm);
    setup.person = person.or(setup.person);
    let mut invalid = 0;
    let mut checked = Vec::new();
    for file in files {
        let outcome = check_one(file, &setup, has_setup)?;
        invalid += usize::from(outcome.is_err());
        if as_json {
            checked.push(json_of(file, &outcome))
        } else {
            print(file, &outcome)?
        }
    }
    if as_json {
        print_json(&checked)?;
    }
    match invalid {
        0 => Ok(()),
        _ => Err(Failure::wrong_use(format!(
            "{invalid} of {} cannot be used",
            counted(files.len() as u64, "file")
        ))),
    }
}

/// A valid layout and the warnings about it.
type Checked = (Layout, Vec<String>);

/// Checks a layout and its fit to the hands of a setup. An error of the setup itself is a failure. Without a setup, the profiles that
/// the layout names are assumed.
fn check_one(
    file: &str,
    setup: &Setup,
    has_setup: bool,
) -> Result<Result<Checked, DocumentError>, Failure> {
    let layout = match Layout::load(file) {
        Ok(layout) => layout,
        Err(error) => return Ok(Err(error)),
    };
    let mut assumed = setup.clone();
    let mut notes = Vec::new();
    if !has_setup {
        for name in assume_profiles(&mut assumed, &layout) {
            notes.push(format!(
                "it names the profile `{}`, which the setup must have; check it with `--setup`",
                escape(&name)
            ));
        }
    }
    let mut keys = layout.required_capabilities().keys.into_iter();
    if let Some(code) = keys.find(|code| code.is_system_key())
        && !setup.allow_system_keys
    {
        notes.push(format!(
            "the key `{code}` acts on the system, so a run needs `allow_system_keys: true` in its setup"
        ));
    }
    Ok(match warnings(&layout, &assumed) {
        Ok(warnings) => Ok((layout, [notes, warnings].concat())),
        // The layout does not fit the hand.
        Err(SetupError::File(error)) if error.file() == layout.file => Err(error),
        Err(error) => return Err(error.into()),
    })
}

/// Adds the profiles that a layout names and a setup lacks, each with the layout itself, and returns their names.
pub fn assume_profiles(setup: &mut Setup, layout: &Layout) -> Vec<String> {
    let is_missing = |name: &&String| {
        let mut others = setup.profiles.iter();
        *name != MAIN_PROFILE && others.all(|profile| profile.name != **name)
    };
    let missing: Vec<String> = layout.profiles.iter().filter(is_missing).cloned().collect();
    for name in &missing {
        setup.profiles.push(ProfileSetup {
            name: name.clone(),
            layout: layout.file.clone(),
            text: None,
        });
    }
    missing
}

fn print(file: &str, outcome: &Result<Checked, DocumentError>) -> Result<(), Failure> {
    let (layout, warnings) = match outcome {
        Ok(checked) => checked,
        Err(error) => {
            complain!("error: {error}");
            return Ok(());
        }
    };
    let file = escape(file);
    writeln!(io::stdout(), "{file}: valid, {}", parts(layout))?;
    for (name, steps) in layout.sequence_rows() {
        // A person sees what each one types before they use the layout of somebody else.
        let name = if name.is_empty() {
            name
        } else {
            format!("sequence `{name}`: ")
        };
        writeln!(io::stdout(), "  {name}{steps}")?;
    }
    if let Some(mode) = layout.text_mode {
        writeln!(io::stdout(), "  text decoder: {mode}")?;
    }
    for warning in warnings {
        complain!("warning: {file}: {warning}");
    }
    Ok(())
}

/// Returns the numbers of keys and layers, and of everything else that the layout has.
fn parts(layout: &Layout) -> String {
    let others = [
        (layout.controls.len(), "other control"),
        (usize::from(layout.pointer.is_some()), "pointer"),
        (layout.triggers.len(), "trigger"),
    ];
    let others = others.into_iter().filter(|(count, _)| *count > 0);
    let others = others.map(|(count, noun)| counted(count as u64, noun));
    let targets: usize = layout.spaces.iter().map(|it| it.names.len()).sum();
    let targets = (targets > 0).then(|| format!("{} in space", counted(targets as u64, "target")));
    let keys = counted(layout.keys.len() as u64, "key");
    let layers = counted(layout.layers.len() as u64, "layer");
    let parts = [keys].into_iter().chain(others).chain(targets);
    parts.chain([layers]).collect::<Vec<_>>().join(", ")
}

fn json_of(file: &str, outcome: &Result<Checked, DocumentError>) -> Value {
    match outcome {
        Ok((layout, warnings)) => json!({
            "file": file,
            "valid": true,
            "keys": layout.keys.len(),
            "other_controls": layout.controls.len(),
            "layers": layout.layers.len(),
            "errors": [],
            "warnings": warnings,
        }),
        Err(error) => {
            let fault = |fault: &DocumentFault| json!({"line": fault.line(), "column": fault.column(), "message": fault.message()});
            let errors: Vec<Value> = error.errors().iter().map(fault).collect();
            json!({"file": file, "valid": false, "errors": errors, "warnings": []})
        }
    }
}

/// Returns one warning for all controls that no hand of the setup reaches, one for each control within reach that the simulated hand
/// cannot press, one for each pair of boards in one place, one for each layer that nothing activates, and one for a layout that follows
/// a hand or a point of the body which the setup does not measure. Such a layout is still valid.
fn warnings(layout: &Layout, setup: &Setup) -> Result<Vec<String>, SetupError> {
    let setup = Setup {
        layout: layout.file.clone(),
        // The permissions of the setup do not matter for the reach.
        allow_system_keys: true,
        ..setup.clone()
    };
    let setup = setup.load_files()?;
    let report = setup.reach_report(&setup.layout);
    let out_of_reach = report.map(|report| report.to_string());
    // The simulated hand wears the glove of the setup, not its camera or the arm of another source.
    let is_simulated = setup.setup.source.is_none() && setup.setup.arm_source.is_none();
    let unpressable = if is_simulated {
        let targets_out_of_reach = setup.hand_reach().on_boards(&setup.layout);
        setup.controls_without_press(&setup.layout, &targets_out_of_reach)
    } else {
        Vec::new()
    };
    let more = unpressable.len().saturating_sub(MAX_UNPRESSABLE);
    let more = (more > 0).then(|| {
        let controls = counted(more as u64, "more control");
        format!("the simulated hand cannot press {controls}")
    });
    let unpressable = unpressable.iter().take(MAX_UNPRESSABLE);
    let unpressable = unpressable.map(ToString::to_string).chain(more);
    let overlaps = setup.layout.board_overlaps();
    let overlaps = overlaps.iter().map(BoardOverlap::message);
    let idle_layers = setup.layout.idle_layers.iter().map(|name| {
        let name = escape(name);
        format!("nothing activates the layer `{name}`; add a key with `layer: \"{name}\"`")
    });
    let missing = setup.missing_other_hand(&setup.layout);
    let missing = missing.map(str::to_owned).into_iter();
    let unmeasured = setup.unmeasured_body_point(&setup.layout);
    let elbow = setup.unmeasured_elbow(&setup.layout);
    Ok(out_of_reach
        .into_iter()
        .chain(unpressable)
        .chain(overlaps)
        .chain(idle_layers)
        .chain(missing)
        .chain(unmeasured)
        .chain(elbow)
        .collect())
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
