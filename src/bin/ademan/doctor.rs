//! `ademan doctor`: checks of this machine against a setup.

use std::io::{self, Write};

use ademan::doctor::{self, CheckStatus, Finding, Requirements};
use ademan::files;
use ademan::message::{escape, escape_json, escape_line};
use ademan::output::{self, Backend, OutputError};
use ademan::setup::LoadedSetup;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output_list::OutputList;
use crate::setup_args::SetupArgs;
use crate::{complete, messages, result_files};

/// Check what a setup needs of this machine, and print commands that add what is missing
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan doctor --source serial:/dev/ttyUSB0 --output uinput\n  ademan doctor my-setup.ron --json\n  ademan doctor --test desktop\n\nThe exit code is 0 if everything that the setup needs is present, and 1 otherwise."
)]
pub struct Args {
    /// Setup file; the flags override it. The default is setup.ron in the configuration folder, if it exists
    #[arg(add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
    /// Outputs, as for `ademan run`
    #[arg(long, value_name = "OUTPUTS", add = complete::outputs(), value_parser = OutputList)]
    output: Option<String>,
    /// Use an output for 1 s without a visible effect
    #[arg(long, value_name = "OUTPUT", value_parser = testable_output())]
    test: Vec<&'static Backend>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// An output and the outcome of its test.
type TestResult = (&'static Backend, Result<String, String>);

pub fn run(args: Args) -> Result<(), Failure> {
    let mut setup = args.flags.read_setup(args.setup.as_deref())?;
    setup.output = args.output.unwrap_or(setup.output);
    let requirements = Requirements::from_setup(&setup);
    let setup = setup.load_files()?;
    let mut findings = doctor::check(&doctor::gather_facts(&requirements), &requirements);
    findings.extend(
        setup
            .named_sources()
            .filter_map(|it| doctor::check_source(&setup, &it)),
    );
    findings.extend(doctor::check_headset(&setup.setup));
    findings.extend(doctor::check_panic_keys(&setup.setup));
    findings.extend(doctor::check_focus(&setup.setup));
    findings.extend(doctor::check_share(&setup));
    findings.push(check_outputs(&setup)?);
    let test = |backend: &&'static Backend| {
        let check = backend.check?;
        Some((*backend, check().map_err(|error| error.to_string())))
    };
    let tests: Vec<TestResult> = args.test.iter().filter_map(test).collect();
    let is_ok = findings.iter().all(Finding::is_satisfied)
        && tests.iter().all(|(_, outcome)| outcome.is_ok());
    if args.json {
        let json = as_json(&findings, &tests, is_ok).to_string();
        writeln!(io::stdout(), "{}", escape_json(&json))?;
    } else {
        let columns = messages::output_columns().unwrap_or_default();
        let text = as_text(&findings, &tests, columns);
        io::stdout().write_all(text.as_bytes())?;
    }
    if is_ok {
        Ok(())
    } else {
        Err(Failure::job(
            "something that the setup needs is missing or does not work",
        ))
    }
}

/// Checks that the outputs can send what the layouts require, and that this build and this machine have them. A name that is not an
/// output is an error.
fn check_outputs(setup: &LoadedSetup) -> Result<Finding, Failure> {
    let outputs = &setup.setup.output;
    let checked = output::check(outputs, &setup.required_capabilities());
    let can_send = match checked.and_then(|()| output::check_presence(outputs)) {
        Ok(()) => match check_transcripts(outputs) {
            Ok(()) => Ok(format!(
                "{} can send everything that the layouts require",
                escape(outputs)
            )),
            Err(failure) => Err(failure.to_string()),
        },
        Err(OutputError::Open { reason, .. }) => Err(reason),
        Err(error) => return Err(error.into()),
    };
    Ok(Finding::from_result("outputs", true, can_send))
}

/// Checks that the folders of transcripts exist, except the folder for the transcripts of setups, which a run creates.
fn check_transcripts(outputs: &str) -> Result<(), Failure> {
    let own = files::transcript_folder();
    let paths = output::transcript_files(outputs);
    for path in paths.filter(|path| path.parent() != own.as_deref()) {
        result_files::check_folder(path)?;
    }
    Ok(())
}

fn testable_output() -> impl TypedValueParser<Value = &'static Backend> {
    let testable = output::BACKENDS
        .iter()
        .filter(|backend| backend.check.is_some());
    PossibleValuesParser::new(testable.map(|backend| backend.name))
        .map(|name| output::find_backend(&name).expect("the parser accepts only names of backends"))
}

fn as_json(findings: &[Finding], tests: &[TestResult], is_ok: bool) -> Value {
    let tests: Vec<_> = tests
        .iter()
        .map(|(backend, outcome)| {
            let text = outcome.as_ref().unwrap_or_else(|reason| reason);
            json!({"output": backend.name, "ok": outcome.is_ok(), "text": text})
        })
        .collect();
    json!({"ok": is_ok, "checks": findings, "tests": tests})
}

/// Returns a row for each check and test, then the commands that add what is missing, for a terminal of this width.
fn as_text(findings: &[Finding], tests: &[TestResult], columns: usize) -> String {
    let mut text = String::new();
    for finding in findings {
        let needed = if finding.needed { "needed" } else { "" };
        let first = format!(
            "{:12} {:12} {needed:7} ",
            finding.status.name(),
            finding.check
        );
        text += &messages::row(&first, &escape_line(&finding.text), columns);
        text.push('\n');
    }
    for (backend, outcome) in tests {
        let (state, result) = match outcome {
            Ok(result) => ("works", result),
            Err(reason) => ("fails", reason),
        };
        let first = format!("{state:12} {:12} {:7} ", backend.name, "tested");
        text += &messages::row(&first, &escape_line(result), columns);
        text.push('\n');
    }
    for finding in findings {
        text += &remedy(finding, columns);
    }
    text
}

/// Commands to copy, which stay whole, and words about them; empty if there is nothing to do.
fn remedy(finding: &Finding, columns: usize) -> String {
    if finding.commands.is_empty() && finding.next_step.is_empty() {
        return String::new();
    }
    let relevance = match (finding.needed, finding.status) {
        (true, CheckStatus::Missing) => ", which is needed",
        (false, CheckStatus::Missing) => ", if you want it",
        _ => "",
    };
    let mut text = format!("\n# {}{relevance}\n", finding.check);
    for line in &finding.commands {
        text += &format!("{}\n", escape_line(line));
    }
    if !finding.next_step.is_empty() {
        let words = messages::row("# ", &escape_line(&finding.next_step), columns);
        text += &words.replace("\n  ", "\n# ");
        text.push('\n');
    }
    text
}
