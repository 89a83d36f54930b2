//! `ademan lab study report`: the figures of a study, and its trials as a table.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::message::escape;
use ademan::session::counted;
use ademan::study::{LayoutFigures, Study, figures, study_to_html, trials_to_csv};

use super::super::table::row;
use super::outputs::write_private;
use super::trials::{self, Trials};
use crate::failure::Failure;
use crate::result_files;

/// The arguments of `lab study report`.
#[derive(clap::Args)]
pub struct ReportArgs {
    /// Folder of the study
    folder: PathBuf,
    /// Table to write: a line for each trial, without texts
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Report to write: figures, and curves from trial to trial, without texts and pseudonyms
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Count practice sessions in the figures; the table always has them
    #[arg(long)]
    with_practice: bool,
}

pub fn run(args: &ReportArgs) -> Result<(), Failure> {
    let written: Vec<&Path> = [&args.csv, &args.html]
        .into_iter()
        .flatten()
        .map(PathBuf::as_path)
        .collect();
    let mut read = vec![args.folder.join(super::STUDY)];
    read.extend(trials::paths(&args.folder));
    result_files::check(&written, &read)?;
    let study = super::read(&args.folder)?;
    let trials = Trials::read(&args.folder)?;
    // The files come first: a reader of the text that ends early must not cost them.
    let csv = args.csv.as_ref();
    let csv = csv.map(|path| write_private(path, &trials_to_csv(&trials.all)));
    let html = args.html.as_ref();
    let html =
        html.map(|path| write_private(path, &study_to_html(&trials.all, args.with_practice)));
    let printed = print(args, &study, &trials);
    [csv, html]
        .into_iter()
        .flatten()
        .collect::<Result<(), _>>()?;
    Ok(printed?)
}

fn print(args: &ReportArgs, study: &Study, trials: &Trials) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let all = figures(&trials.all, args.with_practice);
    if all.is_empty() {
        writeln!(
            out,
            "no trials yet; `ademan lab study add` makes the first one"
        )?;
    }
    let planned = study.order(0).len();
    for layout in &all {
        write_layout(layout, &mut out)?;
    }
    let mut names: Vec<&str> = trials
        .all
        .iter()
        .map(|it| it.participant.as_str())
        .collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        let done = planned - trials.remaining(study, name).len();
        if done < planned {
            writeln!(out, "{} has done {done} of {planned} tasks", escape(name))?;
        }
    }
    Ok(())
}

fn write_layout(figures: &LayoutFigures, out: &mut impl Write) -> io::Result<()> {
    let simulated = match figures.simulated {
        0 => String::new(),
        count => format!(", {count} of them by simulated hands"),
    };
    writeln!(
        out,
        "{}: {}, {}{simulated}",
        escape(&figures.layout),
        counted(figures.participants as u64, "participant"),
        counted(figures.trials as u64, "trial"),
    )?;
    for (name, interval, factor, digits) in figures.rows() {
        row(out, name, &interval, factor, digits)?;
    }
    Ok(())
}
