//! `ademan lab`: simulated people use a layout, and what came of it.

mod conditions;
mod outputs;
mod table;
mod verify;

use std::io::{self, Write};
use std::path::PathBuf;

use ademan::measures::compare;

use self::conditions::{ConditionArgs, Prepared};
use crate::complete;
use crate::failure::Failure;

/// Score, compare and check layouts with simulated people, through the whole program
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan lab score qwerty-flat\n  ademan lab score my-board.ron --person me.ron --html report.html\n  ademan lab compare qwerty-flat qwerty-arc --people 50\n  ademan lab verify result.json\n\nAll figures are simulated: docs/lab.md says what the people are made of, and where they differ from real ones."
)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(clap::Subcommand)]
enum Action {
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
    /// Run a result again, and compare each figure exactly
    #[command(after_help = "Example: ademan lab verify result.json")]
    Verify {
        /// Result file of `score` or `compare`
        result: PathBuf,
        /// Threads; by default one for each processor
        #[arg(long)]
        jobs: Option<std::num::NonZeroUsize>,
    },
}

/// Files to write.
#[derive(Clone, clap::Args)]
struct OutputArgs {
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

pub fn run(args: Args) -> Result<(), Failure> {
    match args.action {
        Action::Score {
            layout,
            conditions,
            outputs,
        } => score(&[layout], &conditions, &outputs),
        Action::Compare {
            layouts,
            conditions,
            outputs,
        } => score(&layouts, &conditions, &outputs),
        Action::Verify { result, jobs } => verify::run(&result, jobs),
    }
}

/// Scores layouts with the same people, and compares all but the first with the first.
fn score(
    layouts: &[String],
    conditions: &ConditionArgs,
    outputs: &OutputArgs,
) -> Result<(), Failure> {
    let prepared = Prepared::new(conditions)?;
    let mut results = Vec::new();
    for layout in layouts {
        results.push(prepared.score(layout)?);
    }
    let mut out = io::stdout().lock();
    for index in 0..results.len() {
        if index > 0 {
            writeln!(out)?;
            let (first, second) = (&results[0], &results[index]);
            let comparison = compare(
                (&first.layout_file, &first.scores),
                (&second.layout_file, &second.scores),
            );
            let comparison = comparison.map_err(|error| {
                Failure::wrong_use(format!("cannot compare these layouts: {error}"))
            })?;
            results[index].comparison = Some(comparison);
        }
        table::print(&results[index], &mut out)?;
    }
    for comparison in results.iter().filter_map(|it| it.comparison.as_ref()) {
        table::print_comparison(comparison, &mut out)?;
    }
    outputs::write(outputs, &results)
}
