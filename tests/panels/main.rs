//! Controls other than keys over a board: script in, transcript out; layout file, contact stage and
//! devices together.

mod chords;
mod dwells;
mod errors;
mod radios;
mod rig;
mod shipped;
mod texts;
mod toggles;
mod touch_surfaces;
mod triggers;
