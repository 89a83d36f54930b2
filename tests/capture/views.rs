//! Views of a session whose source is silent.

use std::iter;
use std::thread;
use std::time::Duration;

use ademan::capture::{CaptureError, Source, SourceEvent, SourceStats};
use ademan::command::Command;
use ademan::session::view::Viewer;
use ademan::session::{Session, SessionOptions};
use ademan::setup::Setup;

/// A source without readings.
struct SilentSource;

impl Source for SilentSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        thread::sleep(Duration::from_millis(20));
        Ok(SourceEvent::Idle)
    }

    fn name(&self) -> &str {
        "silent"
    }

    fn stats(&self) -> SourceStats {
        SourceStats::default()
    }
}

/// Waits for a view of a session that is paused or not.
fn shows_pause(viewer: &Viewer, is_paused: bool) -> bool {
    let next = || viewer.views().recv_timeout(Duration::from_secs(10)).ok();
    iter::from_fn(next).any(|view| view.state.paused_by.is_some() == is_paused)
}

#[test]
fn the_end_of_a_pause_is_shown_without_another_reading() {
    let setup = Setup {
        output: "none".into(),
        ..Setup::default()
    };
    let options = SessionOptions {
        source: Some(Box::new(SilentSource)),
        ..SessionOptions::default()
    };
    let session = Session::start(setup.load_files().unwrap(), options).unwrap();
    session.wait_until_started();
    let viewer = session.add_viewer();
    for _ in 0..3 {
        session.commands().send(Command::Pause).unwrap();
        assert!(shows_pause(&viewer, true));
        session.commands().send(Command::Resume).unwrap();
        assert!(shows_pause(&viewer, false));
    }
}
