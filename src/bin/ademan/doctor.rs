//! `ademan doctor`: what is there, what is missing, and what mends it.

use std::io::{self, Write};

use ademan::doctor::{self, CheckStatus, Finding, Requirements};
use ademan::output::{self, Backend};
use serde_json::{Value, json};

use crate::args::DoctorArgs;
use crate::failure::Failure;
use crate::setup;

/// An output and the result of its test.
type Tested = (&'static Backend, Result<String, String>);

pub fn run(args: DoctorArgs) -> Result<(), Failure> {
    let mut setup = setup::read(args.setup.as_deref(), args.parts)?;
    setup.output = args.output.unwrap_or(setup.output);
    let wants = Requirements::from_setup(&setup);
    let assembly = setup.load_files()?;
    output::check(&assembly.setup.output, &assembly.required_capabilities())?;
    let findings = doctor::check(&doctor::gather_facts(&wants), &wants);
    let test = |backend: &&'static Backend| {
        let check = backend.check?;
        Some((*backend, check().map_err(|error| error.to_string())))
    };
    let tests: Vec<Tested> = args.test.iter().filter_map(test).collect();
    let is_well = findings.iter().all(Finding::is_satisfied)
        && tests.iter().all(|(_, outcome)| outcome.is_ok());
    match args.json {
        true => writeln!(io::stdout(), "{}", as_json(&findings, &tests, is_well))?,
        false => io::stdout().write_all(as_text(&findings, &tests).as_bytes())?,
    }
    match is_well {
        true => Ok(()),
        false => Err(Failure::job(
            "something that is needed is not there, or does not work",
        )),
    }
}

fn as_json(findings: &[Finding], tests: &[Tested], is_well: bool) -> Value {
    let tests: Vec<_> = tests
        .iter()
        .map(|(backend, outcome)| {
            let text = outcome.as_ref().unwrap_or_else(|reason| reason);
            json!({"output": backend.name, "ok": outcome.is_ok(), "text": text})
        })
        .collect();
    json!({"ok": is_well, "checks": findings, "tests": tests})
}

/// A line for each check and trial, and after them what to do.
fn as_text(findings: &[Finding], tests: &[Tested]) -> String {
    let mut text = String::new();
    for finding in findings {
        let needed = if finding.needed { "needed" } else { "" };
        text += &format!(
            "{:12} {:12} {:7} {}\n",
            finding.state.name(),
            finding.check,
            needed,
            finding.text
        );
    }
    for (backend, outcome) in tests {
        let (state, told) = match outcome {
            Ok(told) => ("works", told),
            Err(reason) => ("fails", reason),
        };
        text += &format!("{state:12} {:12} {:7} {told}\n", backend.name, "tested");
    }
    for finding in findings {
        text += &remedy(finding);
    }
    text
}

/// What mends it, as lines to copy; empty where there is nothing to do.
fn remedy(finding: &Finding) -> String {
    if finding.fix.is_empty() && finding.then.is_empty() {
        return String::new();
    }
    let whether = match (finding.needed, finding.state) {
        (true, CheckStatus::Missing) => ", which is needed",
        (false, CheckStatus::Missing) => ", if you want it",
        _ => "",
    };
    let mut text = format!("\n# {}{whether}\n", finding.check);
    for line in &finding.fix {
        text += &format!("{line}\n");
    }
    if !finding.then.is_empty() {
        text += &format!("# {}\n", finding.then);
    }
    text
}
