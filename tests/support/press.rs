//! One key press of a simulated hand, as postures of the glove.

use std::num::NonZeroU32;

use ademan::capture::hc11::{BODY_BYTES, channels};
use ademan::capture::{Hc11Format, Reading, Sample};
use ademan::device::{EventKind, Events, KeyCode};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::SimulatedTypist;
use ademan::time::Timestamp;

/// The channel values of one packet.
pub type Posture = [u8; BODY_BYTES];

/// Returns the format of the packets, which determines their period.
pub fn glove_format() -> Hc11Format {
    Hc11Format::default()
}

/// Returns this format at a baud rate.
pub fn glove_format_at(baud: u32) -> Hc11Format {
    Hc11Format {
        baud: NonZeroU32::new(baud).expect("a baud rate"),
        ..glove_format()
    }
}

/// The movement of a simulated hand that types a text, split where its last key is at the end of its travel.
pub struct Press {
    /// From the hand clear of all keys to the finger on the last key.
    pub approach: Vec<Posture>,
    /// From there to the hand clear of all keys.
    pub lift: Vec<Posture>,
}

impl Press {
    /// Returns the press of the last character of `text` on the default layout.
    pub fn for_text(text: &str) -> Self {
        let setup = Setup {
            arm_immediately: true,
            ..Setup::default()
        };
        let setup = setup.load_files().expect("the default setup");
        let typist = setup.typist(text, &glove_format(), 0.0, 0);
        let postures = postures(typist.expect("the hand can type the text"));
        let (down, up) = last_press(&setup, &postures);
        let (approach, lift) = postures.split_at((down + up) / 2);
        Self {
            approach: approach.to_vec(),
            lift: lift.to_vec(),
        }
    }

    /// Returns the posture in which the key is pressed.
    pub fn pressed(&self) -> Posture {
        *self.approach.last().expect("the approach reaches the key")
    }

    /// Returns a posture in which the hand is clear of all keys.
    pub fn clear(&self) -> Posture {
        self.approach[0]
    }
}

/// Returns the movement of a hand that types a text on the default layout.
pub fn typing(text: &str) -> Vec<Posture> {
    let setup = Setup::default().load_files().expect("the default setup");
    let typist = setup.typist(text, &glove_format(), 0.0, 0);
    postures(typist.expect("the hand can type the text"))
}

/// Returns the X11 key code of a key.
pub fn x11_code(name: &str) -> u16 {
    let key: KeyCode = name.parse().expect("the name of a key");
    key.x11_code()
}

/// Returns the reading of a posture.
pub fn reading(time: Timestamp, posture: &Posture) -> Reading {
    Reading::new(time, None, Sample::Channels(channels(posture)))
}

/// Returns the readings of these postures, one packet period apart.
pub fn readings(postures: &[Posture]) -> Vec<Reading> {
    let mut time = Timestamp(0);
    let next = |posture| {
        time = time + glove_format().packet_period();
        reading(time, posture)
    };
    postures.iter().map(next).collect()
}

/// Returns the postures of a simulated hand, one for each packet.
pub fn postures(mut typist: SimulatedTypist) -> Vec<Posture> {
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

/// Returns the indices of the postures at which the last key is pressed and released.
fn last_press(setup: &LoadedSetup, postures: &[Posture]) -> (usize, usize) {
    let mut pipeline = setup.pipeline();
    let (mut down, mut up) = (0, 0);
    for (index, posture) in postures.iter().enumerate() {
        let time = Timestamp(0) + glove_format().packet_period() * index as u32;
        let mut events = Events::new();
        pipeline
            .step(&reading(time, posture), &mut events)
            .expect("a reading with all channels");
        for event in &events {
            match event.kind {
                EventKind::KeyDown(_) => down = index,
                EventKind::KeyUp(_) => up = index,
                _ => {}
            }
        }
    }
    assert!(0 < down && down < up, "a key is pressed and released");
    (down, up)
}
