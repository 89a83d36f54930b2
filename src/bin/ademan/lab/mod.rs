//! `ademan lab`: simulated people use a layout, and what came of it.

mod conditions;
mod decoder;
mod import;
mod improve;
mod kinds;
mod outputs;
mod replay;
mod shards;
mod study;
mod table;
mod verify;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::document::{Document, FileKind};
use ademan::files::OpenDocument;
use ademan::measures::{LabResult, NotComparable, compare};

pub use self::verify::read_results;

use self::conditions::{ConditionArgs, Prepared};
use crate::failure::Failure;
use crate::{complete, result_files};

/// Score, compare and check layouts with simulated people, through the whole program
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan lab score qwerty-flat\n  ademan lab score my-board.ron --person me.ron --html report.html\n  ademan lab compare qwerty-flat qwerty-arc --people 50\n  ademan lab verify result.json\n\nAll figures are simulated: docs/lab.md says what the people are made of, and where they differ from real ones."
)]
pub enum Args {
    /// Let simulated people type on a layout, or use its controls, and print speed, errors and effort with their intervals
    #[command(
        after_help = "Examples:\n  ademan lab score qwerty-flat --tier T1\n  ademan lab score chords-bend --source glove --json result.json\n  ademan lab score workshop          (a layout that does not type: tasks)"
    )]
    Score {
        /// Layout: the name of one that comes with the program, or a file
        #[arg(add = complete::layout())]
        layout: String,
        #[command(flatten)]
        conditions: ConditionArgs,
        #[command(flatten)]
        outputs: OutputArgs,
    },
    /// Let the same people type the same phrases on two or more layouts, and print the differences with their intervals
    #[command(
        after_help = "Example: ademan lab compare qwerty-flat qwerty-arc --phrases en --people 50 --html compare.html"
    )]
    Compare {
        /// Layouts: the others are compared with the first one
        #[arg(required = true, num_args = 2.., value_name = "LAYOUT", add = complete::layout())]
        layouts: Vec<String>,
        #[command(flatten)]
        conditions: ConditionArgs,
        #[command(flatten)]
        outputs: OutputArgs,
    },
    /// Change a layout until simulated people do better on it, and keep the change if other people do better, too
    #[command(
        after_help = "Examples:\n  ademan lab improve qwerty-flat --move assignment --objective speed\n  ademan lab improve my-board.ron --move positions,sizes --objective errors --tier T1 --margin 20 --keep Space\n  ademan lab improve workshop --move positions --objective errors\n\nPeople and phrases of the search never judge the result: half of the phrases and other people do. Ctrl-C writes the best layout so far."
    )]
    Improve(improve::Args),
    /// Pass a recorded hand over other layouts: the keys on its path, its presses and near misses
    #[command(
        after_help = "Examples:\n  ademan lab replay session.mcap qwerty-flat qwerty-arc\n  ademan lab replay session.mcap my-board.ron --json found.json\n\n`ademan replay --layout` prints the events instead."
    )]
    Replay(replay::Args),
    /// Create a layout from one of the keyboard-layout community: a .dof file or a text grid
    #[command(
        after_help = "Examples:\n  ademan lab import canary.dof\n  ademan lab import grid.txt --hands one --output my-board.ron"
    )]
    Import(import::Args),
    /// Divide a run into independent parts, for many machines or for a long run
    #[command(
        after_help = "Example:\n  ademan lab plan qwerty-flat qwerty-arc --people 1000 --shards 64 --to sweep\n  parallel ademan lab run sweep --jobs 1 ::: {0..63}\n  ademan lab merge sweep --json result.json\n\nexamples/lab/ has scripts for Slurm, Kubernetes and GNU parallel."
    )]
    Plan(shards::PlanArgs),
    /// Do parts of a plan; what was done before is left as it is
    #[command(
        after_help = "Examples:\n  ademan lab run sweep 17\n  ademan lab run sweep      (all that are missing)"
    )]
    Run(shards::RunArgs),
    /// Put the scores of the parts of a plan together, as `score` and `compare` print them
    #[command(after_help = "Example: ademan lab merge sweep --json result.json --html report.html")]
    Merge(shards::MergeArgs),
    /// Measure real people with the same tasks
    #[command(
        after_help = "Examples:\n  ademan lab study new two-boards qwerty-flat qwerty-arc\n  ademan lab study add two-boards --participant P01\n  ademan lab study report two-boards --csv trials.csv"
    )]
    Study {
        #[command(subcommand)]
        action: study::StudyAction,
    },
    /// Run a result again, and compare each figure exactly
    #[command(after_help = "Example: ademan lab verify result.json")]
    Verify {
        /// Result file of `score` or `compare`
        result: PathBuf,
        /// Threads; by default one for each processor
        #[arg(long, value_parser = conditions::jobs())]
        jobs: Option<std::num::NonZeroUsize>,
    },
}

/// Files to write.
#[derive(Clone, clap::Args)]
pub struct OutputArgs {
    /// Result file to write: everything that the run needs, and what came of it. It holds the phrases
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Table to write: a line for each person
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Report to write: one HTML file with drawings
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

impl OutputArgs {
    /// Returns the paths of the files.
    fn paths(&self) -> Vec<&Path> {
        let all = [&self.json, &self.csv, &self.html];
        all.into_iter().flatten().map(PathBuf::as_path).collect()
    }
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args {
        Args::Score {
            layout,
            conditions,
            outputs,
        } => score(&[layout], &conditions, &outputs),
        Args::Compare {
            layouts,
            conditions,
            outputs,
        } => score(&layouts, &conditions, &outputs),
        Args::Import(args) => import::run(&args),
        Args::Improve(args) => improve::run(&args),
        Args::Replay(args) => replay::run(&args),
        Args::Plan(args) => shards::plan(&args),
        Args::Run(args) => shards::run(&args),
        Args::Merge(args) => shards::merge(&args),
        Args::Study { action } => study::run(action),
        Args::Verify { result, jobs } => verify::run(&result, jobs),
    }
}

/// Scores layouts with the same people, and compares all but the first with the first.
fn score(
    layouts: &[String],
    conditions: &ConditionArgs,
    outputs: &OutputArgs,
) -> Result<(), Failure> {
    let prepared = Prepared::new(conditions)?;
    let mut documents = Vec::new();
    for layout in layouts {
        documents.push(Document::open_kind(FileKind::Layout, layout)?);
    }
    let mut read = conditions.files()?;
    read.extend(documents.iter().filter_map(|it| it.path.clone()));
    result_files::check(&outputs.paths(), &read)?;
    kinds::check(&prepared, &documents)?;
    let mut results = Vec::new();
    for (layout, document) in layouts.iter().zip(documents) {
        results.push(prepared.score_document(layout, document)?);
    }
    present(&mut results, outputs)
}

/// Compares all results but the first with the first, writes their files and prints them. The files come first: a reader of the text that
/// ends early must not cost them. A file that cannot be written, and layouts that cannot be compared, must not cost the text.
fn present(results: &mut [LabResult], outputs: &OutputArgs) -> Result<(), Failure> {
    let mut compared = Ok(());
    if let Some((first, others)) = results.split_first_mut() {
        for second in others {
            let comparison = compare(
                (&first.layout_file, &first.scores),
                (&second.layout_file, &second.scores),
            );
            match comparison {
                Ok(comparison) => second.comparison = Some(comparison),
                Err(error) => compared = Err(not_comparable(&error)),
            }
        }
    }
    let written = outputs::write(outputs, results);
    let printed = print(results);
    written?;
    printed?;
    compared
}

fn not_comparable(error: &NotComparable) -> Failure {
    Failure::wrong_use(format!("cannot compare these layouts: {error}"))
}

fn print(results: &[LabResult]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    for (index, result) in results.iter().enumerate() {
        if index > 0 {
            writeln!(out)?;
        }
        table::print(result, &mut out)?;
    }
    for comparison in results.iter().filter_map(|it| it.comparison.as_ref()) {
        table::print_comparison(comparison, &mut out)?;
    }
    Ok(())
}
