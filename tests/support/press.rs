//! One key that a simulated hand presses, as the postures of the glove.

use ademan::capture::hc11::BODY_BYTES;
use ademan::capture::{Channels, Hc11Format, Reading, Sample};
use ademan::device::{EventKind, Events, KeyCode};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::SimulatedTypist;
use ademan::time::Timestamp;

/// What the glove says in one packet.
pub type Posture = [u8; BODY_BYTES];

/// The pace at which postures follow each other.
pub fn line() -> Hc11Format {
    Hc11Format::default()
}

/// A simulated hand that types a text, cut where its last key is at the bottom.
pub struct Press {
    /// From the hand off all keys to the finger on the last key.
    pub approach: Vec<Posture>,
    /// From there to the hand off all keys.
    pub lift: Vec<Posture>,
}

impl Press {
    /// Of the last character of `text` on the default layout.
    pub fn of(text: &str) -> Self {
        let setup = Setup {
            arm_immediately: true,
            ..Setup::default()
        };
        let assembly = setup.load_files().expect("the default setup");
        let typist = assembly.typist(text, &line(), 0.0, 0);
        let postures = postures(typist.expect("the hand can type it"));
        let (down, up) = last_stroke(&assembly, &postures);
        let (approach, lift) = postures.split_at((down + up) / 2);
        Self {
            approach: approach.to_vec(),
            lift: lift.to_vec(),
        }
    }

    /// The finger on the key.
    pub fn held(&self) -> Posture {
        *self.approach.last().expect("the hand has come to the key")
    }

    /// The hand off all keys.
    pub fn off(&self) -> Posture {
        self.approach[0]
    }
}

/// The X11 code of a key.
pub fn code(name: &str) -> u16 {
    let key: KeyCode = name.parse().expect("the name of a key");
    key.x11_code()
}

/// What a source makes of a posture.
pub fn reading(time: Timestamp, posture: &Posture) -> Reading {
    Reading {
        time,
        side: None,
        sample: Sample::Channels(Channels {
            full_scale: 255,
            counts: posture.iter().copied().map(u16::from).collect(),
        }),
    }
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

/// At which postures the last key goes down and comes up.
fn last_stroke(assembly: &LoadedSetup, postures: &[Posture]) -> (usize, usize) {
    let mut pipeline = assembly.pipeline();
    let (mut down, mut up) = (0, 0);
    for (place, posture) in postures.iter().enumerate() {
        let time = Timestamp(0) + line().packet_period() * place as u32;
        let mut events = Events::new();
        pipeline
            .step(&reading(time, posture), &mut events)
            .expect("an able hand");
        for event in &events {
            match event.kind {
                EventKind::KeyDown(_) => down = place,
                EventKind::KeyUp(_) => up = place,
                _ => {}
            }
        }
    }
    assert!(0 < down && down < up, "the last key goes down and comes up");
    (down, up)
}
