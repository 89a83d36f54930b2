//! Learning of the ranges of sensors through the whole pipeline.

use ademan::command::CommandOrigin;
use ademan::device::Events;
use ademan::estimate::LearnedRange;
use ademan::hand::Dof;
use ademan::pipeline::{CommandError, PipelineState};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::{UsTextField, error_rate, taps_for_text};
use ademan::time::Timestamp;

use crate::calibration::{calibrate, load, person};
use crate::key_words::push_key_words;
use crate::sighted_typist::SightedTypist;
use crate::support::checked::CheckedPipeline;
use crate::support::press::{Posture, Press, reading};

/// The text that is typed between two stretches.
const TEXT: &str = "the quick brown fox, ";

/// The number of times that it is typed. The sensors drift from 0 to 10 % in the first three quarters.
const TEXTS: usize = 24;

/// The corrections of a person for each key: none, as without a look at the screen.
const CORRECTIONS: usize = 0;

/// Returns the error rates of a text typed again and again, while the sensors become 10 % more sensitive and the person stretches
/// the hand after each text: in the first and in the last quarter, in percent.
fn type_while_drifting(seed: u64, learn_ranges: bool) -> [f64; 2] {
    let mut wearer = person(seed);
    let map = calibrate(&mut wearer).expect("a calibration").map;
    let setup = load(&mut wearer, &map, learn_ranges);
    let loaded_map = setup.glove.as_ref().expect("a glove").map.clone();
    let taps = taps_for_text(TEXT, &setup.layout, false).expect("a text");
    let mut pipeline = setup.pipeline();
    let mut errors = Vec::new();
    for number in 0..TEXTS {
        let part = number as f64 / (TEXTS * 3 / 4) as f64;
        wearer.set_drift(0.1 * part.min(1.0));
        let learned: Vec<LearnedRange> = pipeline.learned_ranges().collect();
        let seen = loaded_map.clone().with_learned_ranges(&learned);
        let typist = SightedTypist::new(
            &mut wearer,
            &setup.layout.scene,
            &seen,
            &setup.arm,
            CORRECTIONS,
        );
        let mut readings = typist.tap_all(&taps);
        readings.extend(wearer.stretch());
        let (mut field, mut events) = (UsTextField::new(), Events::new());
        for reading in &readings {
            events.clear();
            let _ = pipeline.step(reading, &mut events);
            events.iter().for_each(|event| field.handle(event));
        }
        errors.push(100.0 * error_rate(TEXT, field.text()));
    }
    let learned: Vec<LearnedRange> = pipeline.learned_ranges().collect();
    println!("person {seed}, learning {learn_ranges}: {errors:.0?}");
    for range in &learned {
        println!("  {} {:.2} {:.2}", range.dof, range.below, range.above);
    }
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let quarter = TEXTS / 4;
    [mean(&errors[..quarter]), mean(&errors[TEXTS - quarter..])]
}

#[test]
fn people_whose_sensors_drift_by_a_tenth_type_better_with_learning() {
    let mut totals = [0.0; 2];
    for seed in [0, 4, 7] {
        for (total, learn_ranges) in totals.iter_mut().zip([false, true]) {
            let [first, last] = type_while_drifting(seed, learn_ranges);
            println!("  first quarter {first:.1} %, last quarter {last:.1} %");
            *total += last / 3.0;
        }
    }
    let [without, with] = totals;
    println!("errors after the drift: {without:.1} % without learning, {with:.1} % with it");
    assert!(with < without / 2.0, "{with} {without}");
}

/// A hand whose glove learns the range of one channel.
struct Learning {
    loaded: LoadedSetup,
    pipeline: CheckedPipeline,
    time: Timestamp,
    press: Press,
    channel: usize,
    keys: Vec<String>,
}

impl Learning {
    /// Returns an armed hand above the key H. The calibrated range of the channel of `dof` begins and ends the given counts
    /// below and above the clear hand.
    fn new(dof: Dof, (below, above): (f64, f64)) -> Self {
        let mut loaded = Setup::default().load_files().expect("a setup");
        loaded.setup.learn_ranges = true;
        let press = Press::for_text("h");
        let glove = loaded.glove.as_mut().expect("a glove");
        let mut rows = glove.map.rows().iter();
        let channel = rows.find(|row| row.dof == dof).expect("a sensor").channel;
        let count = f64::from(press.clear()[channel]);
        let range = (channel, (count - below, count + above));
        glove.map = glove.map.clone().with_ranges(vec![range]);
        let mut hand = Self {
            pipeline: CheckedPipeline::new(&loaded),
            loaded,
            time: Timestamp(0),
            press,
            channel,
            keys: Vec::new(),
        };
        hand.hold(&hand.press.clear(), 180);
        assert_eq!(hand.pipeline.state(), PipelineState::Running);
        hand
    }

    /// Holds a posture for a number of readings.
    fn hold(&mut self, posture: &Posture, readings: usize) {
        for _ in 0..readings {
            self.time.0 += 5_729;
            let mut events = Events::new();
            let _ = self
                .pipeline
                .step(&reading(self.time, posture), &mut events);
            push_key_words(&events, &mut self.keys);
        }
    }

    /// Returns a posture with another count of the channel.
    fn with(&self, posture: Posture, counts: i16) -> Posture {
        let mut changed = posture;
        let count = i16::from(posture[self.channel]) + counts;
        changed[self.channel] = u8::try_from(count).expect("8 bits");
        changed
    }

    /// Bends the joint beyond its range for a second, and returns to the clear hand.
    fn stretch(&mut self, counts: i16) {
        let clear = self.press.clear();
        self.hold(&self.with(clear, counts), 180);
        self.hold(&clear, 20);
    }

    fn learned(&self) -> Vec<LearnedRange> {
        self.pipeline.learned_ranges().collect()
    }
}

/// Returns `true` if a hand that moves from the clear posture to `posture` presses a key with what was learned.
fn presses(hand: &Learning, posture: &Posture) -> bool {
    let mut loaded = hand.loaded.clone();
    loaded.setup.learn_ranges = false;
    let glove = loaded.glove.as_mut().expect("a glove");
    glove.map = glove.map.clone().with_learned_ranges(&hand.learned());
    let mut pipeline = CheckedPipeline::new(&loaded);
    let mut events = Events::new();
    for number in 1..=300 {
        let posture = if number <= 180 {
            hand.press.clear()
        } else {
            *posture
        };
        let _ = pipeline.step(&reading(Timestamp(5_729 * number), &posture), &mut events);
    }
    !events.is_empty()
}

#[test]
fn a_stretch_widens_the_range_and_undoing_it_returns_to_the_calibration() {
    let mut hand = Learning::new(Dof::RingMcpFlexion, (40.0, 2.0));
    hand.stretch(6);
    let learned = hand.learned();
    assert_eq!(learned.len(), 1);
    assert_eq!(learned[0].dof, Dof::RingMcpFlexion);
    assert!((learned[0].above - 0.01).abs() < 1e-9, "{learned:?}");
    assert_eq!(learned[0].below, 0.0);
    assert_eq!(hand.pipeline.state(), PipelineState::Running);

    let mut events = Events::new();
    assert_eq!(hand.pipeline.undo_learning(&mut events), Ok(()));
    assert_eq!(hand.pipeline.state(), PipelineState::Paused);
    assert!(hand.learned().is_empty());
    let refused = hand.pipeline.undo_learning(&mut events);
    assert_eq!(refused, Err(CommandError::NothingLearned));
    hand.hold(&hand.press.clear(), 180);
    assert_eq!(hand.pipeline.state(), PipelineState::Running);
    assert!(hand.keys.is_empty(), "{:?}", hand.keys);
}

#[test]
fn a_wider_range_does_not_press_the_key_below_a_hovering_finger() {
    let any = Learning::new(Dof::IndexMcpFlexion, (40.0, 40.0));
    let (clear, pressed) = (any.press.clear(), any.press.pressed());
    let part = |number: i32| -> Posture {
        std::array::from_fn(|channel| {
            let (from, to) = (i32::from(clear[channel]), i32::from(pressed[channel]));
            (from + (to - from) * number / 40) as u8
        })
    };
    let hover = (0..=40)
        .rev()
        .map(part)
        .find(|posture| !presses(&any, posture));
    let hover = hover.expect("a posture above the key");
    let bend = f64::from(hover[any.channel]) - f64::from(any.press.clear()[any.channel]);
    let mut hand = Learning::new(Dof::IndexMcpFlexion, (3.0 - bend, 77.0 + bend));
    for _ in 0..12 {
        hand.hold(&hand.with(hover, -14), 180);
        hand.hold(&hover, 60);
        assert!(hand.keys.is_empty(), "{:?}", hand.keys);
        if presses(&hand, &hover) {
            hand.hold(&hover, 180);
            assert!(hand.keys.is_empty(), "{:?}", hand.keys);
            return;
        }
    }
    panic!(
        "the finger was never moved into the key: {:?}",
        hand.learned()
    );
}

#[test]
fn nothing_is_learned_while_a_key_is_held() {
    let mut hand = Learning::new(Dof::RingMcpFlexion, (40.0, 2.0));
    let pressed = hand.press.pressed();
    let stretched = hand.with(pressed, 6);
    hand.hold(&pressed, 40);
    hand.hold(&stretched, 180);
    hand.hold(&pressed, 40);
    assert_eq!(hand.keys.join(" "), "+H");
    assert!(hand.learned().is_empty(), "the key is held");
    hand.hold(&hand.press.clear(), 40);
    assert_eq!(hand.keys.join(" "), "+H -H");
    assert_eq!(hand.learned().len(), 1);
}

#[test]
fn nothing_is_learned_of_a_pause_a_broken_wire_or_without_the_option() {
    let range = (40.0, 2.0);
    let mut paused = Learning::new(Dof::RingMcpFlexion, range);
    paused
        .pipeline
        .pause(CommandOrigin::Client, &mut Events::new());
    paused.stretch(6);
    paused.pipeline.resume(CommandOrigin::Client);
    paused.hold(&paused.press.clear(), 180);
    assert!(paused.learned().is_empty(), "paused");

    let mut broken = Learning::new(Dof::RingMcpFlexion, range);
    let mut at_rail = broken.press.clear();
    at_rail[broken.channel] = 255;
    broken.hold(&at_rail, 400);
    broken.hold(&broken.press.clear(), 180);
    broken.stretch(6);
    assert!(broken.learned().is_empty(), "broken");

    let mut off = Learning::new(Dof::RingMcpFlexion, range);
    off.loaded.setup.learn_ranges = false;
    off.pipeline = CheckedPipeline::new(&off.loaded);
    off.hold(&off.press.clear(), 180);
    off.stretch(6);
    assert!(off.learned().is_empty(), "off");
}

#[test]
fn a_glove_without_ranges_cannot_learn_them() {
    let setup = Setup {
        learn_ranges: true,
        ..Setup::default()
    };
    let error = setup.load_files().unwrap_err().to_string();
    assert!(error.contains("`range_counts`"), "{error}");
    assert!(error.contains("ademan calibrate"), "{error}");
}
