//! The files that users write, and recordings.

mod guide;
mod layout_errors;
mod layout_mistakes;
mod layouts;
mod multitap;
mod pictures;
mod recordings;
mod schema;
mod sequences;
mod setups;
