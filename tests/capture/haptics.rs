//! Feedback to a glove when the loop of a session panics.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use ademan::capture::Haptics;
use ademan::device::OutputEvent;
use ademan::output::{OutputError, Sink};
use ademan::session::{Session, SessionOptions};
use ademan::setup::Setup;

use crate::support::lucidgloves::{PRESSED, curls, taps};
use crate::support::run::{TIMEOUT, accept};
use ademan::hand::Finger;

/// A sink that panics when it is told to.
struct PanickingSink(Arc<AtomicBool>);

impl Sink for PanickingSink {
    fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
        assert!(!self.0.load(Ordering::Relaxed), "meant to happen");
        Ok(())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}

#[test]
fn a_panic_of_the_session_frees_all_fingers() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let setup = Setup {
        source: Some(
            format!("tcp:{address}?protocol=lucidgloves")
                .parse()
                .expect("a source"),
        ),
        layout: "chords-bend".into(),
        arm_immediately: true,
        stall_timeout_ms: 10_000,
        ..Setup::default()
    };
    let panics = Arc::new(AtomicBool::new(false));
    let options = SessionOptions {
        output: Some(Box::new(PanickingSink(panics.clone()))),
        haptics: Haptics::Force,
        ..SessionOptions::default()
    };
    let session = Session::start(setup.load_files().expect("a valid setup"), options);
    let session = session.expect("it starts");
    let mut glove = accept(&listener);
    glove.set_read_timeout(Some(TIMEOUT)).expect("a time-out");
    let feedback = BufReader::new(glove.try_clone().expect("a descriptor"));
    thread::spawn(move || {
        let mut held = [0.0; Finger::COUNT];
        held[Finger::Ring.index()] = PRESSED;
        let press = taps(&[&[Finger::Ring]]).into_iter().take(62);
        for fields in press.chain(std::iter::repeat(curls(held))) {
            if glove.write_all(fields.encode().as_bytes()).is_err() {
                return;
            }
            thread::sleep(Duration::from_millis(10));
        }
    });
    let mut lines = feedback.lines().map(|line| line.expect("a line"));
    assert_eq!(lines.next().as_deref(), Some("A0B0C0D0E0"));
    let held = lines.next().expect("a line");
    assert!(
        held.starts_with("A0B0C0D") && held != "A0B0C0D0E0",
        "{held}"
    );
    panics.store(true, Ordering::Relaxed);
    assert_eq!(lines.next().as_deref(), Some("A0B0C0D0E0"));
    drop(session);
}
