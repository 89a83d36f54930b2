//! Controls other than keys over a board: script in, transcript out; layout file, contact stage and
//! devices together.

mod rig;
mod toggles;
