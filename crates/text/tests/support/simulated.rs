//! A simulated person who taps: made for the tests, and different from what the decoder assumes.
//!
//! Scatter has heavier tails than a normal distribution (a third of a normal one with 1.5 times the width, scaled to the given standard
//! deviation) and is correlated with the scatter of the tap before (0.3); each key has its own offset of 1 mm; spurious taps land near
//! the tap before, not anywhere; a missed tap is any one but the first.

use ademan_text::{Key, Keyboard, Tap};
use fastrand::Rng;

use super::session::Phrase;

/// The distance between two keys in mm.
pub const PITCH: f32 = 19.05;

/// The taps of a simulated person: their scatter and faults.
#[derive(Clone, Copy)]
pub struct Tier {
    pub name: &'static str,
    /// The standard deviation of taps in mm.
    pub scatter: f32,
    /// The share of taps with a spurious one after them.
    pub spurious: f32,
    /// The share of taps that are missed.
    pub missed: f32,
    /// A constant offset in mm, in a direction of the person.
    pub offset: f32,
    /// The standard deviation of the drift with each tap in mm.
    pub drift: f32,
    /// The most wrong characters in percent of the small test: the upper end of the 95 % interval of what was measured.
    pub limit: f64,
}

const fn tier(name: &'static str, scatter: f32, spurious: f32, missed: f32, limit: f64) -> Tier {
    Tier {
        name,
        scatter,
        spurious,
        missed,
        offset: 0.0,
        drift: 0.0,
        limit,
    }
}

pub const TIERS: [Tier; 6] = [
    tier("T0", 3.0, 0.0, 0.0, 0.3),
    tier("T1", 5.0, 0.0, 0.0, 1.2),
    tier("T2", 6.0, 0.02, 0.02, 2.9),
    tier("T3", 8.0, 0.02, 0.02, 5.2),
    tier("T4", 10.0, 0.03, 0.03, 11.8),
    Tier {
        offset: 8.0,
        drift: 0.4,
        ..tier("Toff", 4.0, 0.0, 0.0, 0.75)
    },
];

/// Returns a keyboard with three rows of letters, digits, some punctuation and a space bar.
pub fn keyboard() -> Keyboard {
    let rows = [
        ("1234567890-", -0.5),
        ("qwertyuiop", 0.0),
        ("asdfghjkl'", 0.25),
        ("zxcvbnm,.?", 0.75),
    ];
    let mut keys = Vec::new();
    for (row, (characters, shift)) in rows.into_iter().enumerate() {
        for (column, character) in characters.chars().enumerate() {
            keys.push(Key {
                character,
                center: [(column as f32 + shift) * PITCH, row as f32 * PITCH],
                size: [PITCH; 2],
                hand: u8::from(column > 4),
            });
        }
    }
    keys.push(Key {
        character: ' ',
        center: [4.5 * PITCH, 4.0 * PITCH],
        size: [6.25 * PITCH, PITCH],
        hand: 1,
    });
    Keyboard::new(keys)
}

/// Returns a keyboard with the signs of a US keymap, and the opening marks of Spanish. What is typed with Shift is away from the rest.
pub fn full_keyboard() -> Keyboard {
    let rows = [
        ("1234567890-=", "!@#$%^&*()_+", -0.5),
        ("qwertyuiop[]", "          {}", 0.0),
        ("asdfghjkl;'", "         :\"", 0.25),
        ("zxcvbnm,./", "       <>?", 0.75),
    ];
    let mut keys = Vec::new();
    for (row, (characters, shifted, indent)) in rows.into_iter().enumerate() {
        let places = characters.chars().zip(shifted.chars()).enumerate();
        for (column, (character, above)) in places {
            let [x, y] = [(column as f32 + indent) * PITCH, row as f32 * PITCH];
            let key = Key {
                character,
                center: [x, y],
                size: [PITCH; 2],
                hand: u8::from(column > 4),
            };
            keys.push(key);
            keys.extend((above != ' ').then_some(Key {
                character: above,
                center: [x + 40_000.0, y],
                ..key
            }));
        }
    }
    let space = keyboard().keys().last().copied().expect("a space bar");
    let elsewhere = "¿¡".chars().zip([20_000.0, 20_100.0]);
    let elsewhere = elsewhere.map(|(character, x)| Key {
        character,
        center: [x, 20_000.0],
        ..keys[0]
    });
    let elsewhere: Vec<Key> = elsewhere.collect();
    Keyboard::new(keys.into_iter().chain([space]).chain(elsewhere))
}

pub fn normal(random: &mut Rng) -> f32 {
    let radius = (-2.0 * (1.0 - random.f32()).ln()).sqrt();
    radius * (std::f32::consts::TAU * random.f32()).cos()
}

fn heavy(random: &mut Rng) -> f32 {
    // Variance 2/3 + 2.25/3.
    let width = if random.u32(0..3) == 0 { 1.5 } else { 1.0 };
    width * normal(random) / (2.0_f32 / 3.0 + 0.75).sqrt()
}

/// A simulated person.
#[derive(Clone)]
pub struct Person {
    random: Rng,
    tier: Tier,
    keyboard: Keyboard,
    offsets: Vec<[f32; 2]>,
    shift: [f32; 2],
    last: [f32; 2],
}

impl Person {
    pub fn new(tier: Tier, seed: u64) -> Self {
        let mut random = Rng::with_seed(seed);
        let keyboard = keyboard();
        let offsets = keyboard
            .keys()
            .iter()
            .map(|_| [normal(&mut random), normal(&mut random)])
            .collect();
        let direction = std::f32::consts::TAU * random.f32();
        Self {
            shift: [tier.offset * direction.cos(), tier.offset * direction.sin()],
            random,
            tier,
            keyboard,
            offsets,
            last: [0.0; 2],
        }
    }

    /// Returns the taps of a text.
    pub fn types(&mut self, text: &str) -> Phrase {
        let mut taps = Vec::new();
        for character in text.chars() {
            let tap = self.tap(character);
            if taps.is_empty() || self.random.f32() >= self.tier.missed {
                taps.push(tap);
            }
            if self.random.f32() < self.tier.spurious {
                let [x, y] = tap.position;
                let beside = |random: &mut Rng| (random.f32() - 0.5) * 3.0 * PITCH;
                taps.push(Tap::at(
                    x + beside(&mut self.random),
                    y + beside(&mut self.random),
                ));
            }
        }
        Phrase {
            meant: text.to_owned(),
            taps,
            // Of a person whose random numbers go on as if there were no such tap.
            space: Some(self.clone().tap(' ')),
        }
    }

    fn tap(&mut self, character: char) -> Tap {
        let index = self
            .keyboard
            .index(character)
            .expect("a key for each character");
        let key = self.keyboard.keys()[index];
        let position = std::array::from_fn(|axis| {
            self.shift[axis] += self.tier.drift * normal(&mut self.random);
            let fresh = heavy(&mut self.random);
            self.last[axis] = 0.3 * self.last[axis] + (1.0_f32 - 0.09).sqrt() * fresh;
            let along = if character == ' ' && axis == 0 {
                (self.random.f32() - 0.5) * 60.0
            } else {
                0.0
            };
            let noise = self.tier.scatter * self.last[axis];
            key.center[axis] + along + self.offsets[index][axis] + self.shift[axis] + noise
        });
        Tap {
            position,
            typed: None,
        }
    }
}
