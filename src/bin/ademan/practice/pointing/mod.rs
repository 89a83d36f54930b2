//! Pointing lessons: targets to point at and to click on with the pointer of the layout.

mod hand;
mod task;

use std::io::{self, Write};

use ademan::capture::Hc11Format;
use ademan::layout::Layout;
use ademan::measures::PointingResult;
use ademan::message::escape;
use ademan::setup::LoadedSetup;
use serde_json::json;

pub use self::hand::script;
pub use self::task::PointingTask;
use super::history::{History, Progress, SessionResult, rounded};
use super::report::now;
use super::{Args, PracticeTask, is_by_simulation, is_drawn, run_task};
use crate::failure::Failure;
use crate::signals;

/// The name in the history.
const LESSON: &str = "pointing";

/// The layout of the simulated hand, if none is named.
pub const SIMULATED_LAYOUT: &str = "direct";

/// Runs a pointing lesson.
pub fn run(
    args: &Args,
    setup: LoadedSetup,
    is_simulated: bool,
    history: History,
) -> Result<(), Failure> {
    let layout = setup.layout.clone();
    if layout.pointer.is_none() {
        return Err(Failure::wrong_use(format!(
            "`{}` has no pointer; choose a layout such as `direct`, `rate` or `webcam-mouse`",
            escape(&layout.name)
        )));
    }
    let is_by_simulation = is_by_simulation(&setup, is_simulated);
    let hand = if is_simulated {
        let script = script(&layout)?;
        Some(setup.scripted(&script, &Hc11Format::default(), args.noise, args.seed)?)
    } else {
        None
    };
    let mut task = PointingTask::new();
    run_task(args, setup, hand, &mut task)?;
    let is_complete = task.is_complete();
    let session = session(&layout, is_by_simulation, &task);
    let is_kept = is_complete && !args.no_history;
    let progress = if is_kept {
        history.add(session.clone())
    } else {
        None
    };
    print(args, &session, is_complete, progress)?;
    if is_complete || signals::is_stop_requested() {
        Ok(())
    } else {
        Err(Failure::job(
            "the source ended before all targets were clicked on",
        ))
    }
}

/// Returns the result for the history.
fn session(layout: &Layout, is_simulated: bool, task: &PointingTask) -> SessionResult {
    let result = task.result();
    SessionResult {
        time: now(),
        lesson: LESSON.to_owned(),
        layout: layout.name.clone(),
        is_simulated,
        seconds: rounded(result.movement_s * result.targets as f64, 10.0),
        pointing: Some(PointingResult {
            movement_s: rounded(result.movement_s, 1e3),
            path_efficiency: rounded(result.path_efficiency, 1e3),
            axis_deviation_px: rounded(result.axis_deviation_px, 10.0),
            reentries: rounded(result.reentries, 1e3),
            throughput: rounded(result.throughput, 1e2),
            ..result
        }),
        ..SessionResult::default()
    }
}

fn print(
    args: &Args,
    session: &SessionResult,
    is_complete: bool,
    progress: Option<Progress>,
) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let result = session.pointing.unwrap_or_default();
    if args.json {
        let json = json!({
            "lesson": session.lesson,
            "layout": session.layout,
            "is_complete": is_complete,
            "is_simulated": session.is_simulated,
            "targets": result.targets,
            "misses": result.misses,
            "movement_s": result.movement_s,
            "path_efficiency": result.path_efficiency,
            "throughput_bits_per_s": result.throughput,
            "axis_deviation_px": result.axis_deviation_px,
            "target_reentries": result.reentries,
        });
        return Ok(writeln!(out, "{json}")?);
    }
    if !is_drawn(args) {
        writeln!(out, "lesson     pointing")?;
    }
    let is_simulated = if session.is_simulated {
        " (a simulated hand)"
    } else {
        ""
    };
    writeln!(
        out,
        "targets    {}, {} missed ({:.0} %){is_simulated}",
        result.targets,
        result.misses,
        result.miss_rate() * 100.0
    )?;
    writeln!(
        out,
        "movement   {:.2} s from click to click",
        result.movement_s
    )?;
    writeln!(
        out,
        "way        {:.0} % straight",
        result.path_efficiency * 100.0
    )?;
    writeln!(
        out,
        "throughput {:.2} bit/s, effective (ISO/TS 9241-411)",
        result.throughput
    )?;
    match progress {
        Some(progress) => Ok(write!(out, "{progress}")?),
        None if !is_complete => Ok(writeln!(
            out,
            "kept       no: not all targets were clicked on"
        )?),
        None => Ok(()),
    }
}
