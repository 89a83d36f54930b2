//! Controls other than keys over a board: script in, transcript out; layout file, contact stage and
//! devices together.

mod bad_input;
mod chords;
mod dwells;
mod errors;
mod joysticks;
mod knobs;
mod levers;
mod no_room;
mod pointer;
mod pointer_clicks;
mod pointer_modes;
mod pointer_steps;
mod radios;
mod shipped;
mod shipped_handles;
mod sliders;
mod spaces;
mod texts;
mod toggles;
mod touch_surfaces;
mod triggers;
mod valves;
mod wrong_dials;
mod wrong_pointers;

use crate::rig::Rig;

/// Returns the events of a script on one flat board with these fields, such as `toggles: [(…)]`.
fn simulate(controls: &str, script: &str) -> String {
    Rig::on_board(controls).run(script).events()
}

/// Returns the events of a script on one flat board; `fields` are further fields of the layout, such as
/// `triggers: [(…)]`.
fn simulate_layout(controls: &str, fields: &str, script: &str) -> String {
    Rig::with_fields(controls, fields).run(script).events()
}
