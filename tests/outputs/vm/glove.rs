//! The glove, its movements, and the events that they must cause.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::Instant;

use ademan::capture::Hc11Format;
use ademan::capture::hc11::{Framing, encode};
use ademan::device::{EventKind, Events};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::SimulatedTypist;
use ademan::time::Timestamp;
use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, unbounded};

use crate::support::press::{Posture, postures, reading};

/// A movement of the hand, which starts and ends clear of all keys.
pub struct HandMotion {
    postures: Vec<Posture>,
    /// The events, each with the index of its posture.
    events: Vec<(usize, EventKind)>,
}

impl HandMotion {
    /// Returns the movement that types a text on a layout.
    pub fn typing(layout: &str, text: &str) -> Self {
        let setup = load_setup(layout);
        let typist = setup.typist(text, &Hc11Format::default(), 0.0, 0);
        Self::new(&setup, typist.expect("the hand can type the text"))
    }

    /// Returns the movement of a script on a layout.
    pub fn scripted(layout: &str, script: &str) -> Self {
        let setup = load_setup(layout);
        let typist = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
        let typist = typist.unwrap_or_else(|error| panic!("{error}"));
        Self::new(&setup, typist)
    }

    fn new(setup: &LoadedSetup, typist: SimulatedTypist) -> Self {
        let postures = postures(typist);
        let mut pipeline = setup.pipeline();
        let mut all_events = Vec::new();
        for (index, posture) in postures.iter().enumerate() {
            let time = Timestamp(0) + Hc11Format::default().packet_period() * index as u32;
            let mut events = Events::new();
            pipeline
                .step(&reading(time, posture), &mut events)
                .expect("a reading with all channels");
            all_events.extend(events.iter().map(|event| (index, event.kind)));
        }
        Self {
            postures,
            events: all_events,
        }
    }

    /// Returns the keys that are pressed (`true`) and released, as event codes.
    pub fn keys(&self) -> Vec<(u16, bool)> {
        let key = |(_, event): &(usize, EventKind)| match event {
            EventKind::KeyDown(key) => Some((key.event_code(), true)),
            EventKind::KeyUp(key) => Some((key.event_code(), false)),
            _ => None,
        };
        self.events.iter().filter_map(key).collect()
    }

    /// Returns the posture in which the hand is clear of all keys.
    pub fn clear(&self) -> Vec<Posture> {
        vec![self.postures[0]]
    }

    /// Returns all postures.
    pub fn all(&self) -> Vec<Posture> {
        self.postures.clone()
    }

    /// Returns the postures up to the middle of the last press.
    pub fn until_pressed(&self) -> Vec<Posture> {
        let last = |is_it: fn(&EventKind) -> bool| {
            let found = self.events.iter().rfind(|(_, event)| is_it(event));
            found.expect("a key is pressed and released").0
        };
        let down = last(|event| matches!(event, EventKind::KeyDown(_)));
        let up = last(|event| matches!(event, EventKind::KeyUp(_)));
        self.postures[..down.midpoint(up)].to_vec()
    }
}

fn load_setup(layout: &str) -> LoadedSetup {
    let setup = Setup {
        layout: layout.to_owned(),
        arm_immediately: true,
        ..Setup::default()
    };
    setup.load_files().expect("a valid setup")
}

/// A glove that sends packets at the rate of its line and repeats its last posture.
pub struct Glove(Sender<Vec<Posture>>);

impl Glove {
    /// Creates a glove on this line. It sends nothing until a movement is played.
    pub fn new(line: UnixStream) -> Self {
        let (messages, received) = unbounded();
        thread::spawn(move || play(line, &received));
        Self(messages)
    }

    /// Sends these postures, one per packet, and repeats the last.
    pub fn play(&self, postures: Vec<Posture>) {
        self.0.send(postures).expect("the player runs");
    }

    /// Stops sending: bytes sent while the cable is unplugged would arrive after it is plugged in.
    pub fn stop_sending(&self) {
        self.play(Vec::new());
    }
}

fn play(mut line: UnixStream, messages: &Receiver<Vec<Posture>>) {
    let period = Hc11Format::default().packet_period();
    let mut postures = Vec::new();
    let mut index = 0;
    let mut due = Instant::now();
    loop {
        match messages.recv_deadline(due) {
            Ok(new) => (postures, index) = (new, 0),
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                if let Some(posture) = postures.get(index) {
                    // A machine that has exited does not read.
                    let _ = line.write_all(&encode(Framing::Double06, posture));
                    index = (index + 1).min(postures.len() - 1);
                }
                due = Instant::now() + period;
            }
        }
    }
}
