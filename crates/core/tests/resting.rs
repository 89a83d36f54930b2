//! Fingers that rest close above keys in the noise of a source without a filter, while others tap.

mod motion;
mod row;

use ademan_core::contact::Phase;
use ademan_core::hand::Finger;
use motion::{minimum_jerk, normal};
use parry3d::math::Vec3;
use row::{Row, at};

/// A hand whose fingers rest above keys of their own, in the white noise of a source.
struct Hand {
    row: Row,
    random: fastrand::Rng,
    /// The standard deviation of each measured coordinate, in millimetres.
    noise: f32,
}

impl Hand {
    /// Creates a hand; `rate` is in readings per second.
    fn new(is_struck: bool, noise: f32, rate: u64) -> Self {
        let mut row = Row::new(is_struck);
        row.period = 1_000_000 / rate;
        Self {
            row,
            random: fastrand::Rng::with_seed(17),
            noise,
        }
    }

    /// Shows fingers at heights in millimetres for the next reading, and returns the measured heights.
    fn show(&mut self, heights: [f32; Finger::COUNT]) -> [f32; Finger::COUNT] {
        let pads: [(Finger, Vec3); Finger::COUNT] = std::array::from_fn(|index| {
            let mut coordinate = || normal(&mut self.random);
            let shake = Vec3::new(coordinate(), coordinate(), coordinate()) * self.noise;
            let pad = at(index as u32, shake.x, heights[index] + shake.z);
            (Finger::ALL[index], pad + Vec3::Y * shake.y * 1e-3)
        });
        self.row.touches.clear();
        self.row.show(&pads, 0.0);
        pads.map(|(_, pad)| pad.z * 1e3)
    }

    fn pressed(&self) -> impl Iterator<Item = Finger> {
        let touches = self.row.touches.iter();
        let presses = touches.filter(|touch| touch.phase == Phase::Pressed);
        presses.map(|press| press.finger)
    }
}

/// A tap of a finger that rests, in millimetres and milliseconds.
struct Tap {
    /// The height at which it rests, above the keys.
    rest: f32,
    /// The height from which it goes down, above its rest.
    lift: f32,
    depth: f32,
    /// The time at the lowest point.
    dwell: f32,
}

impl Tap {
    /// The time at which it goes down: 80 ms after the start if it is lifted.
    fn down_at(&self) -> f32 {
        if self.lift > 0.0 { 80.0 } else { 0.0 }
    }

    /// The time at which it is back: it goes down and up in 60 ms each.
    fn end(&self) -> f32 {
        self.down_at() + 120.0 + self.dwell
    }

    /// The height at a time since the start.
    fn height(&self, ms: f32) -> f32 {
        let part = |from: f32, time: f32| minimum_jerk((ms - from) / time);
        self.rest + self.lift * part(0.0, 80.0)
            - (self.rest + self.lift + self.depth) * part(self.down_at(), 60.0)
            + (self.rest + self.depth) * part(self.end() - 60.0, 60.0)
    }
}

/// The result of taps.
#[derive(Debug, Default)]
struct Counted {
    /// Presses by fingers that rest.
    unintended: usize,
    /// Taps without a press.
    missed: usize,
}

/// Taps of fingers that rest at a height and are lifted, in millimetres: by one finger of five every 400 ms, 3 to 7 mm deep and for
/// 40 to 120 ms.
fn tap_from_rest(hand: &mut Hand, [rest, lift]: [f32; 2], taps: usize) -> Counted {
    let mut counted = Counted::default();
    for number in 0..taps + 3 {
        // The noise is not known at once.
        let is_counted = number >= 3;
        let own = Finger::ALL[hand.random.usize(..Finger::COUNT)];
        let tap = Tap {
            rest,
            lift,
            depth: 3.0 + 4.0 * hand.random.f32(),
            dwell: 40.0 + 80.0 * hand.random.f32(),
        };
        let start = hand.row.time;
        let mut has_pressed = false;
        while hand.row.time < start + 400_000 {
            let ms = (hand.row.time + hand.row.period - start) as f32 * 1e-3;
            let mut heights = [rest; Finger::COUNT];
            heights[own.index()] = tap.height(ms);
            hand.show(heights);
            let is_down = tap.down_at() < ms && ms < tap.end();
            let (meant, others): (Vec<_>, Vec<_>) =
                hand.pressed().partition(|finger| *finger == own && is_down);
            has_pressed |= !meant.is_empty();
            counted.unintended += if is_counted { others.len() } else { 0 };
        }
        counted.missed += usize::from(is_counted && !has_pressed);
    }
    counted
}

/// The taps of each case; docs/typing-measured.md has figures of ten times as many.
const TAPS: usize = 1_000;

#[test]
fn fingers_that_rest_in_noise_press_hardly_anything_and_their_taps_press() {
    for (noise, rate, max_missed) in [
        (0.1, 60, 0),
        (0.1, 200, 0),
        (0.5, 60, 0),
        (0.5, 200, 0),
        (1.0, 60, 1),
        (1.0, 90, 1),
        (1.0, 200, 1),
    ] {
        for is_struck in [false, true] {
            for lift in [0.0, 5.0] {
                let mut hand = Hand::new(is_struck, noise, rate);
                let counted = tap_from_rest(&mut hand, [1.0, lift], TAPS);
                let press = if is_struck { "stroke" } else { "plane" };
                let case = format!(
                    "{press}, {noise} mm, {rate} readings a second, lifted {lift} mm: {counted:?}"
                );
                println!("{case}");
                assert!(counted.unintended * 1_000 <= TAPS, "{case}");
                assert!(counted.missed <= max_missed, "{case}");
            }
        }
    }
}

#[test]
fn a_finger_that_comes_down_to_its_rest_in_noise_presses_hardly_anything() {
    const TIMES: usize = 200;
    for is_struck in [false, true] {
        for rate in [60, 90, 200] {
            let mut hand = Hand::new(is_struck, 1.0, rate);
            let mut presses = 0;
            for _ in 0..TIMES {
                let start = hand.row.time;
                while hand.row.time < start + 900_000 {
                    let ms = (hand.row.time - start) as f32 * 1e-3;
                    let part = |from: f32| minimum_jerk((ms - from) / 80.0);
                    // 15 mm above the keys, 1 mm, and up again.
                    let height = 15.0 - 14.0 * (part(200.0) - part(800.0));
                    hand.show([height; Finger::COUNT]);
                    presses += hand.pressed().count();
                }
            }
            let case = format!("{presses} presses, {rate} readings a second, {is_struck}");
            println!("{case}");
            assert!(presses * 100 <= TIMES * Finger::COUNT, "{case}");
        }
    }
}

#[test]
fn a_finger_that_comes_from_above_presses_in_the_first_reading_at_the_press_depth() {
    for noise in [0.5, 1.0, 2.0] {
        for rate in [60, 90, 200] {
            let mut hand = Hand::new(false, noise, rate);
            let mut late = 0;
            for _ in 0..300 {
                let start = hand.row.time;
                let (mut is_deep, mut has_pressed) = (false, false);
                while hand.row.time < start + 500_000 && !is_deep {
                    let ms = (hand.row.time - start) as f32 * 1e-3;
                    let mut heights = [15.0; Finger::COUNT];
                    heights[1] -= 20.0 * minimum_jerk((ms - 300.0) / 80.0);
                    is_deep = hand.show(heights)[1] <= -2.0;
                    has_pressed |= hand.pressed().count() > 0;
                }
                late += usize::from(is_deep && !has_pressed);
            }
            assert_eq!(late, 0, "{noise} mm, {rate} a second");
        }
    }
}

#[test]
fn a_finger_that_taps_fast_presses_each_time() {
    for noise in [0.0, 0.3] {
        for rate in [60, 90, 200] {
            for frequency in [4, 6, 8] {
                for is_struck in [false, true] {
                    let mut hand = Hand::new(is_struck, noise, rate);
                    let mut presses = 0;
                    for step in 0..20 * rate {
                        let cycles = (step * frequency) as f32 / rate as f32;
                        let mut heights = [20.0; Finger::COUNT];
                        heights[1] = 4.0 * (std::f32::consts::TAU * cycles).cos();
                        hand.show(heights);
                        presses += hand.pressed().count() as u64;
                    }
                    let case = format!("{noise} mm, {rate} a second, {frequency} Hz, {is_struck}");
                    assert_eq!(presses, 20 * frequency, "{case}");
                }
            }
        }
    }
}
