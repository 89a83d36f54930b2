//! Whole readings beside their references, in one interleaved run: what disturbs the machine disturbs all rows alike.

use std::hint::black_box;
use std::time::{Duration, Instant};

use ademan::capture::Reading;
use ademan::capture::hc11::{Framing, Hc11Decoder};
use ademan::capture::protocol::Decoder;
use ademan::device::{Capabilities, Events};
use ademan::output;
use ademan::pipeline::Pipeline;
use ademan::session::with_loop_step;
use ademan::snapshot::StepView;
use ademan::time::Timestamp;

use super::plain_hand::PlainHand;
use super::{Board, READINGS, Readings, SilentSource, interleaved, two_hands, typing};

/// Passes of each row over all readings; the fastest one counts.
const ROUNDS: usize = 100;

/// The names of the rows, in the order in which [`measure`] returns their times.
const ROWS: [&str; 5] = [
    "21 joints of a plain tree with glam",
    "bytes to events",
    "step",
    "step of one of two hands",
    "step in the loop of a session",
];

/// Index of the row of the step.
const STEP: usize = 2;

/// Prints the time of a reading in each row, and its ratios to the plain tree and to the step.
pub fn print() {
    let rounds = if interleaved::is_measuring() {
        ROUNDS
    } else {
        1
    };
    let times = measure(rounds);
    println!("\n| a reading | time | relative to the tree | relative to the step |");
    println!("|---|---|---|---|");
    for (name, time) in ROWS.iter().zip(&times) {
        let seconds = time.as_secs_f64();
        println!(
            "| {name} | {:.0} ns | {:.2} | {:.2} |",
            seconds * 1e9 / READINGS as f64,
            seconds / times[0].as_secs_f64(),
            seconds / times[STEP].as_secs_f64()
        );
    }
}

/// Returns the time of a pass of each row.
fn measure(rounds: usize) -> Vec<Duration> {
    let hand = PlainHand::new(&typing().anthropometric_arm());
    let pipeline = || Board::Flat(100).pipeline();
    let (mut fed, mut stepped, mut looped) = (pipeline(), pipeline(), pipeline());
    let (mut readings, mut loop_readings) = (Readings::new(), Readings::new());
    let (mut hand_readings, mut hands) = two_hands();
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    let mut time = Timestamp(0);
    let mut sink = output::open("none", &Capabilities::default()).expect("the output `none`");
    let mut look = |step: &StepView, _: Instant, _: &Pipeline| _ = black_box(step.events);
    let mut times = Vec::new();
    let body = |loop_step: &mut dyn FnMut(&Reading)| {
        times = interleaved::fastest(
            rounds,
            &mut [
                &mut || {
                    for estimate in &typing().estimates {
                        black_box(hand.fingertips(&black_box(estimate).angles));
                    }
                },
                &mut || {
                    let mut events = Events::new();
                    for packet in &typing().packets {
                        decoder.push(black_box(packet), &mut |decoded| {
                            time.0 += 5_729;
                            events.clear();
                            let reading = Reading::new(time, None, decoded.sample);
                            let _ = black_box(&fed.step(&reading, &mut events));
                            black_box(&events);
                        });
                    }
                },
                &mut || step_all(&mut stepped, &mut readings),
                &mut || step_all(&mut hands, &mut hand_readings),
                &mut || {
                    for _ in 0..READINGS {
                        loop_step(loop_readings.next());
                    }
                },
            ],
        );
    };
    with_loop_step(SilentSource, &mut looped, &mut *sink, &mut look, body).expect("a loop");
    times
}

/// Passes all readings through a pipeline.
fn step_all(pipeline: &mut Pipeline, readings: &mut Readings) {
    let mut events = Events::new();
    for _ in 0..READINGS {
        events.clear();
        let _ = black_box(&pipeline.step(readings.next(), &mut events));
        black_box(&events);
    }
}
