//! Recordings of readings that a test makes up.

use std::path::Path;
use std::vec;

use ademan::capture::{CaptureError, Reading, Source, SourceEvent};
use ademan::output;
use ademan::recorder::Recorder;
use ademan::session::{CommandReceiver, Summary, run_pipeline};
use ademan::setup::LoadedSetup;

/// Readings without delays.
pub struct Readings(vec::IntoIter<Reading>);

impl Readings {
    pub fn new(readings: Vec<Reading>) -> Self {
        Self(readings.into_iter())
    }
}

impl Source for Readings {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        Ok(self.0.next().map_or(SourceEvent::End, SourceEvent::Reading))
    }

    fn name(&self) -> &str {
        "readings"
    }

    fn is_live(&self) -> bool {
        false
    }
}

/// Records the readings of a source with a setup. Returns the summary of the run.
pub fn record_source(path: &Path, loaded: &LoadedSetup, source: impl Source + 'static) -> Summary {
    let recorder = Recorder::create(path, &loaded.recorded_setup());
    let mut recorder = recorder.expect("a file");
    let mut nowhere = output::open("none", &loaded.required_capabilities()).expect("nowhere");
    let run = run_pipeline(
        source,
        &mut loaded.pipeline(),
        &mut *nowhere,
        &CommandReceiver::disconnected(),
        &mut |step| {
            recorder
                .write(&step.to_snapshot())
                .expect("room on the disk")
        },
    );
    recorder.finish().expect("room on the disk");
    run.expect("a run")
}
