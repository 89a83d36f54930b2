//! The wearer of the glove: what the hand does, and what the program is to make of it.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::Instant;

use ademan::capture::hc11::{BODY_BYTES, Framing, channels, encode};
use ademan::capture::{Hc11Format, Reading, Sample};
use ademan::device::{EventKind, Events};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::SimulatedTypist;
use ademan::time::Timestamp;
use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, unbounded};

type Posture = [u8; BODY_BYTES];

/// Something that a hand does, from off all keys to off all keys.
pub struct Deed {
    postures: Vec<Posture>,
    /// What comes of it, and at which posture.
    actions: Vec<(usize, EventKind)>,
}

impl Deed {
    /// Types a text on a layout.
    pub fn typing(layout: &str, text: &str) -> Self {
        let assembly = on(layout);
        let typist = assembly.typist(text, &Hc11Format::default(), 0.0, 0);
        Self::of(&assembly, typist.expect("the hand can type it"))
    }

    /// Plays a script on a layout.
    pub fn playing(layout: &str, script: &str) -> Self {
        let assembly = on(layout);
        let typist = assembly.scripted(script, &Hc11Format::default(), 0.0, 0);
        let typist = typist.unwrap_or_else(|error| panic!("{error}"));
        Self::of(&assembly, typist)
    }

    fn of(assembly: &LoadedSetup, typist: SimulatedTypist) -> Self {
        let postures = postures(typist);
        let mut pipeline = assembly.pipeline();
        let mut actions = Vec::new();
        for (place, posture) in postures.iter().enumerate() {
            let reading = Reading {
                time: Timestamp(0) + Hc11Format::default().packet_period() * place as u32,
                side: None,
                sample: Sample::Channels(channels(posture)),
            };
            let mut events = Events::new();
            pipeline.step(&reading, &mut events).expect("an able hand");
            actions.extend(events.iter().map(|event| (place, event.kind)));
        }
        Self { postures, actions }
    }

    /// The keys that go down (`true`) and come up, by their codes in the kernel.
    pub fn keys(&self) -> Vec<(u16, bool)> {
        let key = |(_, action): &(usize, EventKind)| match action {
            EventKind::KeyDown(key) => Some((key.event_code(), true)),
            EventKind::KeyUp(key) => Some((key.event_code(), false)),
            _ => None,
        };
        self.actions.iter().filter_map(key).collect()
    }

    /// The hand off all keys.
    pub fn off(&self) -> Vec<Posture> {
        vec![self.postures[0]]
    }

    /// All of it.
    pub fn whole(&self) -> Vec<Posture> {
        self.postures.clone()
    }

    /// Up to where the last key is at the bottom.
    pub fn until_held(&self) -> Vec<Posture> {
        let last = |is_it: fn(&EventKind) -> bool| {
            let found = self.actions.iter().rfind(|(_, action)| is_it(action));
            found.expect("a key goes down and comes up").0
        };
        let down = last(|action| matches!(action, EventKind::KeyDown(_)));
        let up = last(|action| matches!(action, EventKind::KeyUp(_)));
        self.postures[..down.midpoint(up)].to_vec()
    }
}

fn on(layout: &str) -> LoadedSetup {
    let setup = Setup {
        layout: layout.to_owned(),
        arm_immediately: true,
        ..Setup::default()
    };
    setup.load_files().expect("a setup")
}

fn postures(mut typist: SimulatedTypist) -> Vec<Posture> {
    let mut postures = Vec::new();
    while let Some(counts) = typist.next_counts() {
        let mut posture = [0; BODY_BYTES];
        for (byte, count) in posture.iter_mut().zip(counts) {
            *byte = u8::try_from(count).expect("the glove has 8 bits");
        }
        postures.push(posture);
    }
    postures
}

/// A glove that sends packets at the pace of its line, the last posture again and again.
pub struct Glove(Sender<Vec<Posture>>);

impl Glove {
    /// On this line; silent until something is played.
    pub fn on(line: UnixStream) -> Self {
        let (orders, received) = unbounded();
        thread::spawn(move || play(line, &received));
        Self(orders)
    }

    /// Takes these postures, one after the other, and stays in the last one.
    pub fn play(&self, postures: Vec<Posture>) {
        self.0.send(postures).expect("the player is there");
    }

    /// Sends nothing more: what is sent while the cable is out would wait for the next one.
    pub fn stop_sending(&self) {
        self.play(Vec::new());
    }
}

fn play(mut line: UnixStream, orders: &Receiver<Vec<Posture>>) {
    let period = Hc11Format::default().packet_period();
    let mut playing = Vec::new();
    let mut place = 0;
    let mut due = Instant::now();
    loop {
        match orders.recv_deadline(due) {
            Ok(postures) => (playing, place) = (postures, 0),
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                if let Some(posture) = playing.get(place) {
                    // A machine that has ended does not listen.
                    let _ = line.write_all(&encode(Framing::Double06, posture));
                    place = (place + 1).min(playing.len() - 1);
                }
                due = Instant::now() + period;
            }
        }
    }
}
