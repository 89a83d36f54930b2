//! A key that is held for a while.

use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Source, SourceEvent};
use ademan::output::{Desktop, Router, open};
use ademan::session::run_pipeline;
use ademan::setup::Setup;
use ademan::time::Timestamp;
use crossbeam_channel::never;

use crate::press::{Posture, Press, line, reading};
use crate::support::x11::{Typewriter, XServer};

/// A hand that presses a key, holds it and lets go, as a source.
pub struct Hand {
    approach: std::vec::IntoIter<Posture>,
    held: Posture,
    lift: std::vec::IntoIter<Posture>,
    hold: Duration,
    start: Instant,
    pressed: Option<Instant>,
}

impl Hand {
    /// The hand that holds the key of a press down for `hold`.
    pub fn that_holds(press: &Press, hold: Duration) -> Self {
        Self {
            approach: press.approach.clone().into_iter(),
            held: press.held(),
            lift: press.lift.clone().into_iter(),
            hold,
            start: Instant::now(),
            pressed: None,
        }
    }

    fn next_posture(&mut self) -> Option<Posture> {
        if let Some(posture) = self.approach.next() {
            return Some(posture);
        }
        let pressed = *self.pressed.get_or_insert_with(Instant::now);
        if pressed.elapsed() < self.hold {
            return Some(self.held);
        }
        self.lift.next()
    }
}

impl Source for Hand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        std::thread::sleep(line().packet_period());
        let time = Timestamp(0) + self.start.elapsed();
        let posture = self.next_posture();
        Ok(posture.map_or(SourceEvent::End, |posture| {
            SourceEvent::Reading(reading(time, &posture))
        }))
    }

    fn name(&self) -> &str {
        "a hand"
    }
}

#[test]
fn a_held_key_goes_down_once_and_it_is_the_receiver_that_repeats() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(typewriter) = Typewriter::start(&server) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("transcript");
    let assembly = Setup::default().load_files().expect("the default setup");
    let needs = assembly.required_capabilities();
    let mut sink = Router::new(vec![
        Box::new(Desktop::open(Some(server.display()), &needs).expect("the server is there")),
        open(&format!("transcript:{}", path.display()), &needs).expect("a new file"),
    ]);
    let hand = Hand::that_holds(&Press::of("h"), Duration::from_millis(1500));
    let mut pipeline = assembly.pipeline();
    run_pipeline(hand, &mut pipeline, &mut sink, &never(), &mut |_| {}).expect("a run to its end");

    let transcript = std::fs::read_to_string(&path).expect("the transcript");
    let events: Vec<_> = transcript.lines().map(|line| &line[13..]).collect();
    assert_eq!(events, ["down H", "up   H"]);
    assert_eq!(server.keys_down(), [0; 0]);
    let typed = typewriter.typed("h");
    println!(
        "held for 1.5 s: the terminal made {} characters of it",
        typed.len()
    );
    assert!(
        !typed.is_empty() && typed.chars().all(|character| character == 'h'),
        "{typed:?}"
    );
}
