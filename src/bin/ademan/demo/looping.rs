//! A simulated hand that does what suits the layout, again and again.

use ademan::capture::Hc11Format;
use ademan::layout::Layout;
use ademan::setup::{LoadedSetup, SetupError};
use ademan::sim::{HandTask, Script, SimulatedTypist};

use super::script;
use super::text::{self, TextChoice};

/// Returns a hand that plays the script that comes with the layout, types a text, or tours the controls, without end. It leaves out
/// what is beyond its reach, says so, and follows the layout.
pub fn hand(setup: &LoadedSetup, format: &Hc11Format) -> Result<SimulatedTypist, SetupError> {
    let task = match script::for_layout(&setup.setup.layout) {
        Some(script) => HandTask::Script(Script::from_text(script, &setup.layout.target_names())?),
        None => HandTask::Fitting(fitting_task),
    };
    setup.live_hand(task, format)
}

fn fitting_task(layout: &Layout) -> HandTask {
    match text::choose(TextChoice::Default, layout) {
        Ok(text) => HandTask::Text(text),
        Err(_) => HandTask::tour(layout),
    }
}
