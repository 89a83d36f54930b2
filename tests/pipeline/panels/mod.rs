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
mod rig;
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
