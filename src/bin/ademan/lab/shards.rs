//! `ademan lab plan`, `run` and `merge`: a run in parts, for many machines or for a run that may be interrupted.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use ademan::document::Document;
use ademan::files;
use ademan::layout::Layout;
use ademan::measures::LabResult;
use ademan::message::{escape_line, escape_path, shell_word};
use ademan::session::counted;
use ademan::shards::{Plan, ShardError, ShardScores};

use super::conditions::{self, ConditionArgs, Prepared};
use super::{OutputArgs, kinds, outputs, present};
use crate::failure::Failure;
use crate::result_files;

/// The name of the plan in its folder.
const PLAN: &str = "plan.json";
/// Missing shards that a message names.
const NAMED: usize = 8;

/// The arguments of `lab plan`.
#[derive(clap::Args)]
pub struct PlanArgs {
    /// Layouts: shipped names, or files. Several are compared with the first one
    #[arg(required = true, num_args = 1.., value_name = "LAYOUT", add = crate::complete::layout())]
    layouts: Vec<String>,
    /// Folder for the plan and for the scores of its shards
    #[arg(long, value_name = "FOLDER")]
    to: PathBuf,
    /// Number of parts, at most one for each person
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    shards: u16,
    #[command(flatten)]
    conditions: ConditionArgs,
}

/// The arguments of `lab run`.
#[derive(clap::Args)]
pub struct RunArgs {
    /// Folder of the plan
    folder: PathBuf,
    /// Indices of shards, from 0; without one, all that have no scores yet
    shards: Vec<usize>,
    /// Threads; by default one for each processor
    #[arg(long, value_name = "N", value_parser = conditions::jobs())]
    jobs: Option<NonZeroUsize>,
}

/// The arguments of `lab merge`.
#[derive(clap::Args)]
pub struct MergeArgs {
    /// Folder of the plan
    folder: PathBuf,
    /// Accept missing shards: the results are of the people of the others, and say so
    #[arg(long)]
    partial: bool,
    #[command(flatten)]
    outputs: OutputArgs,
}

/// Writes the plan of a run.
pub fn plan(args: &PlanArgs) -> Result<(), Failure> {
    let prepared = Prepared::new(&args.conditions)?;
    let mut runs = Vec::new();
    for layout in &args.layouts {
        let run = prepared.unscored(layout)?;
        // Errors of a layout come now, and not on each machine.
        Layout::from_document(document_of(&run))?;
        runs.push(run);
    }
    let layouts: Vec<Document> = runs.iter().map(document_of).collect();
    kinds::check(&prepared, &layouts)?;
    let people = prepared.people();
    let own = env!("CARGO_PKG_VERSION");
    let plan = Plan::new(runs, people, usize::from(args.shards), own);
    let path = args.to.join(PLAN);
    let shown = escape_path(&path);
    outputs::create_folder(&args.to)?;
    if path.symlink_metadata().is_ok() {
        let is_same = read_plan(&args.to).is_ok_and(|old| old.hash() == plan.hash());
        if !is_same {
            return Err(Failure::wrong_use(format!(
                "{shown} is another plan; choose another folder, or remove this one"
            )));
        }
    } else {
        outputs::write_private(&path, &plan.to_json())?;
    }
    let folder = shell_word(&args.to.to_string_lossy()).to_string();
    let shards = counted(plan.shards as u64, "shard");
    writeln!(
        io::stdout(),
        "{shown}: {shards} of {people} people, plan {}\neach shard: ademan lab run {folder} INDEX, with INDEX from 0 to {}\nthen:       ademan lab merge {folder}",
        plan.hash(),
        plan.shards - 1
    )?;
    Ok(())
}

/// Does shards of a plan. Those with scores are left as they are.
pub fn run(args: &RunArgs) -> Result<(), Failure> {
    let plan = read_plan(&args.folder)?;
    let chosen = if args.shards.is_empty() {
        (0..plan.shards).collect()
    } else {
        args.shards.clone()
    };
    if let Some(beyond) = chosen.iter().find(|&&shard| shard >= plan.shards) {
        return Err(Failure::wrong_use(format!(
            "there is no shard {beyond}: the plan has shards 0 to {}",
            plan.shards - 1
        )));
    }
    for shard in chosen {
        run_shard(args, &plan, shard)?;
    }
    Ok(())
}

fn run_shard(args: &RunArgs, plan: &Plan, shard: usize) -> Result<(), Failure> {
    let path = path_of(&args.folder, shard);
    let shown = escape_path(&path);
    match read_shard(&path, plan, shard) {
        Ok(Some(_)) => {
            say!("{shown}: done before");
            return Ok(());
        }
        Ok(None) => {}
        // A shard that was cut off is made again.
        Err(ShardError::Unreadable(error)) => {
            say!("{shown}: {}; the shard runs again", escape_line(&error));
        }
        Err(error) => return Err(Failure::wrong_use(format!("cannot use {shown}: {error}"))),
    }
    let people = plan.people_of(shard);
    let mut scores = Vec::new();
    for run in &plan.runs {
        let prepared = Prepared::again(run, args.jobs)?.with_people(people.clone());
        scores.push(prepared.scores(&document_of(run))?);
    }
    let scores = ShardScores::new(plan, shard, scores);
    files::replace_private_text(&path, &scores.to_json()).map_err(|error| {
        let command = format!("ademan lab run {} {shard}", shell_word(&args.folder.to_string_lossy()));
        Failure::job(format!(
            "cannot write {shown}: {error}; other shards are not affected, run this one again: {command}"
        ))
    })?;
    let people = counted(people.len() as u64, "score");
    writeln!(io::stdout(), "{shown}: {people} on each layout")?;
    Ok(())
}

/// Merges the scores of all shards, and prints and writes the results as `lab score` and `lab compare` do.
pub fn merge(args: &MergeArgs) -> Result<(), Failure> {
    let plan = read_plan(&args.folder)?;
    let inputs: Vec<PathBuf> = (0..plan.shards)
        .map(|shard| path_of(&args.folder, shard))
        .chain([args.folder.join(PLAN)])
        .collect();
    result_files::check(&args.outputs.paths(), &inputs)?;
    let mut shards = Vec::with_capacity(plan.shards);
    for shard in 0..plan.shards {
        let path = path_of(&args.folder, shard);
        let scores = match read_shard(&path, &plan, shard) {
            Err(ShardError::Unreadable(error)) if args.partial => {
                let error = escape_line(&error);
                complain!("{}: {error}; left out", escape_path(&path));
                None
            }
            read => read.map_err(|error| {
                Failure::wrong_use(format!("cannot use {}: {error}", escape_path(&path)))
            })?,
        };
        shards.push(scores);
    }
    let missing: Vec<usize> = (0..plan.shards)
        .filter(|&shard| shards[shard].is_none())
        .collect();
    if missing.len() == plan.shards || (!missing.is_empty() && !args.partial) {
        let folder = shell_word(&args.folder.to_string_lossy()).to_string();
        let named: Vec<String> = missing.iter().take(NAMED).map(usize::to_string).collect();
        let more = if missing.len() > NAMED { " …" } else { "" };
        let instead = if missing.len() == plan.shards {
            ""
        } else {
            ", or merge what there is with --partial"
        };
        return Err(Failure::job(format!(
            "{} of {} have no scores yet: {}{more}; run them: ademan lab run {folder}{instead}",
            missing.len(),
            counted(plan.shards as u64, "shard"),
            named.join(" ")
        )));
    }
    let first = plan
        .runs
        .first()
        .ok_or_else(|| Failure::wrong_use("the plan is empty"))?;
    let prepared = Prepared::again(first, None)?;
    let mut results = plan.merge(&prepared.participants, &shards);
    for result in &results {
        prepared.check(&document_of(result), &result.scores)?;
    }
    present(&mut results, &args.outputs)
}

fn document_of(run: &LabResult) -> Document {
    Document::new(run.layout_file.as_str(), run.layout.as_str())
}

fn path_of(folder: &Path, shard: usize) -> PathBuf {
    folder.join(format!("shard-{shard:05}.json"))
}

fn read_plan(folder: &Path) -> Result<Plan, Failure> {
    let path = folder.join(PLAN);
    let cannot = |error: String| {
        Failure::wrong_use(format!(
            "cannot use the plan {}: {error}; `ademan lab plan` makes one",
            escape_path(&path)
        ))
    };
    let text = outputs::read_text(&path).map_err(cannot)?;
    Plan::from_json(&text, env!("CARGO_PKG_VERSION")).map_err(|error| cannot(error.to_string()))
}

/// Reads the scores of a shard; `None` if there is no file.
fn read_shard(path: &Path, plan: &Plan, shard: usize) -> Result<Option<ShardScores>, ShardError> {
    if path.symlink_metadata().is_err() {
        return Ok(None);
    }
    let text = outputs::read_text(path).map_err(ShardError::Unreadable)?;
    ShardScores::from_json(&text, plan, shard).map(Some)
}
