//! The files that users write, and recordings.

mod layout_errors;
mod layouts;
mod pictures;
mod recordings;
