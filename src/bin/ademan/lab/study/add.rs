//! `ademan lab study add`: a participant does the tasks that remain, or practice sessions are added.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::contact::TargetId;
use ademan::document::Document;
use ademan::files;
use ademan::layout::{ControlKind, Handle, Layout};
use ademan::message::escape;
use ademan::session::counted;
use ademan::study::{Study, StudyLayout, Task, Trial, TrialKind, check_pseudonym};

use super::outputs;
use super::task::StudyTask;
use super::trials::Trials;
use crate::failure::Failure;
use crate::practice::{self, Exercise, SessionResult, SimulatedTask};
use crate::root_args::RootArgs;
use crate::setup_args::SetupArgs;
use crate::signals;

/// The folder of the layouts, in the folder of the study.
const LAYOUTS: &str = "layouts";

/// The arguments of `lab study add`.
#[derive(clap::Args)]
pub struct AddArgs {
    /// Folder of the study
    folder: PathBuf,
    /// Pseudonym of the participant: letters, digits, `-` and `_`. Keep the list of names elsewhere
    #[arg(long, value_name = "NAME")]
    participant: String,
    /// Most tasks of this session; by default all that remain
    #[arg(long, value_name = "N")]
    tasks: Option<usize>,
    /// Add the practice sessions of this account on the layouts of the study instead
    #[arg(long)]
    practice: bool,
    /// Do not record the readings
    #[arg(long)]
    no_recording: bool,
    /// Let a simulated hand do the tasks, to try a study. Its trials are marked
    #[arg(long)]
    simulated: bool,
    #[command(flatten)]
    flags: SetupArgs,
    #[command(flatten)]
    root: RootArgs,
}

pub fn run(args: AddArgs) -> Result<(), Failure> {
    check_pseudonym(&args.participant).map_err(|error| Failure::wrong_use(error.to_string()))?;
    let study = super::read(&args.folder)?;
    let mut trials = Trials::read(&args.folder)?;
    if args.practice {
        return add_practice(&args, &study, &mut trials);
    }
    args.root.check(false)?;
    if args.flags.names_layout() {
        return Err(Failure::wrong_use(
            "the study says which layouts are used; leave out --layout",
        ));
    }
    let remaining = trials.remaining(&study, &args.participant);
    let count = args.tasks.unwrap_or(usize::MAX).min(remaining.len());
    let mut out = io::stdout();
    for (number, &(layout, task)) in remaining.iter().take(count).enumerate() {
        let layout = &study.layouts[layout];
        say!(
            "task {} of {count} on {}: {}",
            number + 1,
            escape(&layout.name),
            words(&layout.tasks[task])
        );
        let Some(trial) = do_task(&args, (layout, task), &trials)? else {
            break;
        };
        let result = in_words(&trial);
        // A reader that ends early must not cost the trial.
        trials.keep(trial)?;
        writeln!(out, "{result}")?;
    }
    match trials.remaining(&study, &args.participant).len() {
        0 => writeln!(out, "{} has done all tasks", escape(&args.participant))?,
        left => {
            let left = counted(left as u64, "task");
            writeln!(out, "{}: {left} to go", escape(&args.participant))?;
        }
    }
    Ok(())
}

/// Does one task; `None` if it was ended before it was complete.
fn do_task(
    args: &AddArgs,
    (layout, index): (&StudyLayout, usize),
    trials: &Trials,
) -> Result<Option<Trial>, Failure> {
    let order = trials.next_order(&args.participant);
    let path = layout_file(&args.folder, layout)?;
    let recording = trials.recording(&args.participant, order);
    let mut exercise = Exercise {
        flags: args.flags.clone().with_layout(path),
        is_simulated: args.simulated,
        record_to: (!args.no_recording).then(|| recording.clone()),
        simulated: SimulatedTask::Ring,
    };
    let mut task = match &layout.tasks[index] {
        Task::Phrase(text) => {
            exercise.simulated = SimulatedTask::Text(text.clone());
            StudyTask::phrase(text)
        }
        Task::Targets => StudyTask::Targets(Box::new(practice::PointingTask::new())),
        Task::Value { control, goal } => {
            let document = Document::new(layout.name.as_str(), layout.text.as_str());
            let design = Layout::from_document(document)?;
            let target = design.target_names().find(control);
            let target = target.ok_or_else(|| {
                let control = escape(control);
                Failure::wrong_use(format!(
                    "the layout has no control `{control}`; the study was changed"
                ))
            })?;
            let script = script_for(&design, target, control, *goal);
            exercise.simulated = SimulatedTask::Script(script);
            StudyTask::value(target, control, *goal)
        }
    };
    // A recording that was left by a session without an end.
    if recording.symlink_metadata().is_ok() {
        fs::remove_file(&recording)?;
    }
    let is_complete = practice::perform(&exercise, &mut task)?;
    if !is_complete {
        let _ = fs::remove_file(&recording);
        return if signals::is_stop_requested() {
            Ok(None)
        } else {
            Err(Failure::job(
                "the source ended before the task was complete; the trials before it are kept; run the command again to repeat it",
            ))
        };
    }
    let name = recording
        .file_name()
        .map(|name| name.to_string_lossy().into_owned());
    let mut trial = empty(args, &layout.name, order);
    trial.kind = match &layout.tasks[index] {
        Task::Phrase(_) => TrialKind::Phrase,
        Task::Targets => TrialKind::Targets,
        Task::Value { .. } => TrialKind::Value,
    };
    trial.task = Some(index);
    trial.recording = name.filter(|_| recording.exists());
    task.measure(&mut trial);
    Ok(Some(trial))
}

/// Returns the script of a simulated hand that sets a value, about.
fn script_for(layout: &Layout, target: TargetId, name: &str, goal: f64) -> String {
    let mut controls = layout.controls.iter();
    let control = controls.find(|it| it.faces.first().is_some_and(|face| face.target == target));
    let movement = match control.map(|it| &it.kind) {
        Some(kind @ ControlKind::Knob(knob)) => {
            let turns = match kind.handle() {
                Handle::Turn {
                    is_endless: false,
                    turns,
                    ..
                } => f64::from(turns) * (goal - f64::from(knob.initial)),
                _ => goal,
            };
            let rim = f64::from(knob.radius) * 800.0;
            format!("{rim:.1} 0; arc {:.0}", -360.0 * turns)
        }
        Some(ControlKind::Slider(slider)) => {
            let end = f64::from(slider.half_length) * 1e3;
            format!("0 0; slide {:.1} 0", (2.0 * goal - 1.0) * end)
        }
        _ => "0 0".to_owned(),
    };
    format!("press \"{name}\" {movement}; lift; wait 2500")
}

/// Returns a practice session without figures.
fn empty(args: &AddArgs, layout: &str, order: usize) -> Trial {
    Trial {
        participant: args.participant.clone(),
        order,
        layout: layout.to_owned(),
        time: practice::now(),
        is_simulated: args.simulated,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        ..Trial::default()
    }
}

/// Writes a layout of the study to a file, as sessions read layouts from files. Returns its path.
fn layout_file(folder: &Path, layout: &StudyLayout) -> Result<String, Failure> {
    let folder = folder.join(LAYOUTS);
    let stem: String = layout
        .name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    let path = folder.join(format!("{stem}.ron"));
    let written = files::create_private_folder(&folder)
        .and_then(|()| files::replace_private_text(&path, &layout.text));
    written.map_err(|error| outputs::cannot_write(&path, &error))?;
    // With a folder, it means a file.
    let path = fs::canonicalize(&path)?;
    Ok(path.to_string_lossy().into_owned())
}

/// Adds the practice sessions on the layouts of the study that were not added before.
fn add_practice(args: &AddArgs, study: &Study, trials: &mut Trials) -> Result<(), Failure> {
    let mut added = 0;
    for session in practice::sessions() {
        let layout = study.layouts.iter().find(|layout| {
            let document = Document::new(layout.name.as_str(), layout.text.as_str());
            Layout::from_document(document).is_ok_and(|it| it.name == session.layout)
        });
        let Some(layout) = layout else { continue };
        let is_known = trials
            .of(&args.participant)
            .any(|it| it.kind == TrialKind::Practice && it.time == session.time);
        if is_known {
            continue;
        }
        let order = trials.next_order(&args.participant);
        let trial = from_session(empty(args, &layout.name, order), &session);
        trials.keep(trial)?;
        added += 1;
    }
    let sessions = counted(added, "practice session");
    writeln!(
        io::stdout(),
        "added {sessions} of {}",
        escape(&args.participant)
    )?;
    Ok(())
}

fn from_session(trial: Trial, session: &SessionResult) -> Trial {
    let is_text = session.pointing.is_none();
    let typed = |value: usize| is_text.then_some(value);
    Trial {
        time: session.time.clone(),
        is_simulated: session.is_simulated,
        seconds: session.seconds,
        characters: typed(session.characters),
        substitutions: typed(session.substitutions),
        insertions: typed(session.insertions),
        deletions: typed(session.deletions),
        wpm: is_text.then_some(session.words_per_minute),
        pointing: session.pointing,
        ..trial
    }
}

fn words(task: &Task) -> String {
    match task {
        Task::Phrase(text) => format!("type \"{}\"", escape(text)),
        Task::Targets => "point at each target and click".to_owned(),
        Task::Value { control, goal } => format!("set `{}` to {goal:.2}", escape(control)),
    }
}

fn in_words(trial: &Trial) -> String {
    let figures = match (trial.wpm, trial.pointing, trial.value) {
        (Some(wpm), ..) => {
            let errors = 100.0 * trial.cer().unwrap_or_default();
            format!("{wpm:.1} words/min, {errors:.1} % wrong characters")
        }
        (_, Some(pointing), _) => {
            let misses = 100.0 * pointing.miss_rate();
            format!("{:.2} bit/s, {misses:.0} % misses", pointing.throughput)
        }
        (.., Some([goal, set])) => format!("{set:.2} for {goal:.2} in {:.1} s", trial.seconds),
        _ => "no figures".to_owned(),
    };
    format!(
        "{} on {}: {figures}",
        escape(&trial.participant),
        escape(&trial.layout)
    )
}
