//! Views of a session whose source is silent, and of the headsets that come and go.

use std::iter;
use std::thread;
use std::time::Duration;

use ademan::capture::{CaptureError, Headset, HeadsetList, Source, SourceEvent};
use ademan::command::Command;
use ademan::session::view::{View, Viewer};
use ademan::session::{Session, SessionHandle, SessionOptions};
use ademan::setup::Setup;

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// A source without readings, and the headsets that it waits for, if any.
#[derive(Default)]
struct SilentSource {
    headsets: Option<HeadsetList>,
}

impl Source for SilentSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        thread::sleep(Duration::from_millis(20));
        Ok(SourceEvent::Idle)
    }

    fn headsets(&self) -> Option<HeadsetList> {
        self.headsets.clone()
    }

    fn name(&self) -> &str {
        "silent"
    }
}

/// Waits for a view of a session that is paused or not.
fn shows_pause(viewer: &Viewer, is_paused: bool) -> bool {
    let next = || viewer.views().recv_timeout(TIMEOUT).ok();
    iter::from_fn(next).any(|view| view.state.paused_by.is_some() == is_paused)
}

/// Starts a session with a source.
fn start(source: SilentSource) -> SessionHandle {
    let setup = Setup {
        output: "none".into(),
        ..Setup::default()
    };
    let options = SessionOptions {
        source: Some(Box::new(source)),
        ..SessionOptions::default()
    };
    let session = Session::start(setup.load_files().unwrap(), options).unwrap();
    session.wait_until_started();
    session
}

#[test]
fn the_end_of_a_pause_is_shown_without_another_reading() {
    let session = start(SilentSource::default());
    let viewer = session.add_viewer();
    for _ in 0..3 {
        session.commands().send(Command::Pause).unwrap();
        assert!(shows_pause(&viewer, true));
        session.commands().send(Command::Resume).unwrap();
        assert!(shows_pause(&viewer, false));
    }
}

#[test]
fn a_viewer_that_comes_while_no_readings_come_sees_the_present_state() {
    let session = start(SilentSource::default());
    session.commands().request(Command::Pause).unwrap();
    assert!(shows_pause(&session.add_viewer(), true));
}

/// Waits for a view that says this of the headset.
fn shows_headset(viewer: &Viewer, words: Option<&str>) -> bool {
    let next = || viewer.views().recv_timeout(TIMEOUT).ok();
    let shown = |view: &View| view.state.headset.as_ref().map(ToString::to_string);
    iter::from_fn(next).any(|view| shown(&view).as_deref() == words)
}

#[test]
fn the_headset_that_is_connected_is_shown_without_a_reading_and_stays_when_the_state_changes() {
    let headsets = HeadsetList::default();
    let session = start(SilentSource {
        headsets: Some(headsets.clone()),
    });
    let viewer = session.add_viewer();
    assert!(shows_headset(&viewer, Some("no headset connected")));
    let address = [192, 168, 1, 9].into();
    let connected = headsets.add(Headset::new("Quest 3", address));
    let words = Some("headset Quest 3 at 192.168.1.9");
    assert!(shows_headset(&viewer, words));
    session.commands().send(Command::Pause).unwrap();
    assert!(shows_pause(&viewer, true));
    // The present view, which follows from the pause.
    assert!(shows_headset(&session.add_viewer(), words));
    drop(connected);
    assert!(shows_headset(&viewer, Some("no headset connected")));
}

#[test]
fn a_source_that_waits_for_no_headset_has_none() {
    let session = start(SilentSource::default());
    assert!(shows_headset(&session.add_viewer(), None));
}
