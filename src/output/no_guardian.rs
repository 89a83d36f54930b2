//! A stand-in for guardians where there are none yet: on systems other than Linux.

use std::convert::Infallible;

use crossbeam_channel::Receiver;
use enigo::Direction;

use crate::device::KeyCode;

pub(super) use super::launch::BEAT;
pub use super::launch::Launch;

/// What a guardian would do.
pub fn watch(_: impl Fn(&str)) -> Result<(), String> {
    Err("guardians are there on Linux only".into())
}

/// Nothing is handed to anybody.
#[derive(Default)]
pub(super) struct Means;

/// There is none.
pub(super) struct Guard(Infallible);

/// The guardian is gone.
pub(super) struct Lost;

impl Guard {
    pub fn start(_: &Launch, _: Means) -> Result<Self, String> {
        watch(|_| {}).and(Err(String::new()))
    }

    pub fn note(&self, _: KeyCode, _: Direction) -> Result<(), Lost> {
        match self.0 {}
    }

    pub fn note_writing(&self, _: bool) -> Result<(), Lost> {
        match self.0 {}
    }

    pub fn beat(&self) -> Result<(), Lost> {
        match self.0 {}
    }

    pub fn gone(&self) -> &Receiver<()> {
        match self.0 {}
    }

    pub fn replace(&mut self) -> Result<(), String> {
        match self.0 {}
    }
}
