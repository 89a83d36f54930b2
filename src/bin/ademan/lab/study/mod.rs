//! `ademan lab study`: a small study with real people.

mod add;
mod report;
mod task;
mod trials;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::document::{Document, FileKind};
use ademan::files::OpenDocument;
use ademan::message::{escape, escape_path, shell_word};
use ademan::people::{People, population};
use ademan::phrases::{Corpus, PhraseSet};
use ademan::session::counted;
use ademan::sim::fluent::SourceKind;
use ademan::study::{Counts, Study, StudyError, typable_by_all};
use ademan::trials::{Station, TrialError};

use self::add::AddArgs;
use self::report::ReportArgs;
use super::outputs;
use crate::complete;
use crate::failure::Failure;
use crate::setup_args::one_of;

/// The name of the study in its folder.
const STUDY: &str = "study.json";

/// The arguments of `lab study`.
#[derive(clap::Subcommand)]
pub enum StudyAction {
    /// Make a study: layouts, and the phrases, targets and values that each participant does on them
    #[command(
        after_help = "Example: ademan lab study new two-boards qwerty-flat qwerty-arc --count 10\n\nThe order of the layouts differs from participant to participant."
    )]
    New(NewArgs),
    /// Let a participant do the tasks that remain, or add practice sessions
    #[command(
        after_help = "Examples:\n  ademan lab study add two-boards --participant P01 --source serial:/dev/ttyUSB0\n  ademan lab study add two-boards --participant P01 --practice\n\nEach trial is kept when it ends, with its recording, in files that only you can read. Ctrl-C ends the session; run the command again to continue with the next task."
    )]
    Add(Box<AddArgs>),
    /// Print the figures of a study, and write its trials as a table
    #[command(
        after_help = "Example: ademan lab study report two-boards --csv trials.csv\n\nIn R: lme4::lmer(wpm ~ layout + order + (1 | participant) + (1 | task), trials)"
    )]
    Report(ReportArgs),
}

/// The arguments of `lab study new`.
#[derive(clap::Args)]
pub struct NewArgs {
    /// Folder to make for the study
    folder: PathBuf,
    /// Layouts: shipped names, or files
    #[arg(required = true, num_args = 1.., value_name = "LAYOUT", add = complete::layout())]
    layouts: Vec<String>,
    /// Phrases that come with the program
    #[arg(long, value_name = "SET", default_value = "en", value_parser = one_of::<PhraseSet>(PhraseSet::NAMES))]
    phrases: PhraseSet,
    /// Text to type instead: a file with one phrase on each line
    #[arg(long, value_name = "FILE", conflicts_with = "phrases")]
    text: Option<PathBuf>,
    /// Phrases on each layout that types
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..))]
    count: u16,
    /// Rings of targets on each layout that moves a cursor and does not type
    #[arg(long, value_name = "N", default_value_t = 3)]
    rings: u16,
    /// Values of each slider and knob on a layout that does not type
    #[arg(long, value_name = "N", default_value_t = 3)]
    values: u16,
    /// Seed of the phrases and values
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

pub fn run(action: StudyAction) -> Result<(), Failure> {
    match action {
        StudyAction::New(args) => new(&args),
        StudyAction::Add(args) => add::run(*args),
        StudyAction::Report(args) => report::run(&args),
    }
}

fn new(args: &NewArgs) -> Result<(), Failure> {
    let mut named = args.layouts.iter().enumerate();
    if let Some((_, twice)) = named.find(|(index, name)| args.layouts[..*index].contains(name)) {
        return Err(Failure::wrong_use(format!(
            "{} is named twice; name each layout of the study once",
            escape(twice)
        )));
    }
    check_folder(&args.folder)?;
    let corpus = match &args.text {
        None => Corpus::shipped(args.phrases),
        Some(path) => outputs::read_corpus(path)?,
    };
    let mut study = Study::new(args.seed, env!("CARGO_PKG_VERSION"));
    // A participant is assumed to reach what the general population reaches.
    let person = population(&People::Drawn(1), None, args.seed).remove(0);
    let counts = Counts {
        phrases: args.count.into(),
        rings: args.rings.into(),
        values: args.values.into(),
    };
    let (mut texts, mut stations) = (Vec::new(), Vec::new());
    for name in &args.layouts {
        let document = Document::open_kind(FileKind::Layout, name)?;
        let station = Station::new(&document, &person, SourceKind::Ideal);
        stations.push(station.map_err(|error| match error {
            TrialError::Document(error) => Failure::from(error),
            other => Failure::job(other.to_string()),
        })?);
        texts.push(document.text);
    }
    let (phrases, left_out) = typable_by_all(&mut stations, &corpus);
    let has_letters = |phrase: &String| phrase.contains(char::is_alphanumeric);
    if !left_out.is_empty() && !phrases.phrases.iter().any(has_letters) {
        return Err(Failure::wrong_use(
            "the layouts have no letter and no digit of the phrases in common; study them one by one, or use --text with characters that all of them type",
        ));
    }
    for ((name, text), station) in args.layouts.iter().zip(&texts).zip(&mut stations) {
        study
            .add_layout(name, text, station, &phrases, counts)
            .map_err(|error| Failure::wrong_use(format!("cannot study this layout: {error}")))?;
    }
    if !left_out.is_empty() {
        let characters = left_out.iter().map(|it| match it {
            ' ' => "Space".to_owned(),
            other => escape(&other.to_string()).to_string(),
        });
        say!(
            "not every layout can type these characters, which are left out of all phrases: {}",
            characters.collect::<Vec<_>>().join(" ")
        );
    }
    let path = args.folder.join(STUDY);
    let shown = escape_path(&path);
    outputs::create_folder(&args.folder)?;
    outputs::write_private(&path, &study.to_json())?;
    let folder = shell_word(&args.folder.to_string_lossy()).to_string();
    let tasks = counted(study.order(0).len() as u64, "task");
    writeln!(
        io::stdout(),
        "{shown}: {tasks} for each participant\neach one: ademan lab study add {folder} --participant P01 --source URI\nthen:     ademan lab study report {folder} --csv trials.csv"
    )?;
    Ok(())
}

/// Refuses a folder that has a study, or trials of one.
fn check_folder(folder: &Path) -> Result<(), Failure> {
    let path = folder.join(STUDY);
    if path.symlink_metadata().is_ok() {
        return Err(Failure::wrong_use(format!(
            "{} exists; choose another folder, so that no trial is lost",
            escape_path(&path)
        )));
    }
    let trials = folder.join(trials::FOLDER);
    let is_used = fs::read_dir(&trials).is_ok_and(|mut entries| entries.next().is_some());
    if is_used {
        return Err(Failure::wrong_use(format!(
            "{} has trials of another study; choose another folder, so that none is lost",
            escape_path(&trials)
        )));
    }
    Ok(())
}

/// Reads the study of a folder.
fn read(folder: &Path) -> Result<Study, Failure> {
    let path = folder.join(STUDY);
    let cannot = |error: String| {
        let path = escape_path(&path);
        Failure::wrong_use(format!(
            "cannot use the study {path}: {error}; `ademan lab study new` makes one"
        ))
    };
    let text = outputs::read_text(&path).map_err(cannot)?;
    Study::from_json(&text).map_err(|error: StudyError| cannot(error.to_string()))
}
