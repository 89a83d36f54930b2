//! The time from the bytes of each kind of source to its events, as a share of one core at a high rate of such a sensor.
//!
//! Prints tables. Every packet is decoded and stepped through the pipeline of the default layout while a simulated hand
//! types. Without `--bench` (as in `cargo test --benches`) it measures one pass. `-- TEXT` measures the rows whose names
//! contain the text.

#[path = "sources/motion.rs"]
mod motion;
#[path = "sources/packets.rs"]
mod packets;

use std::cell::Cell;
use std::hint::black_box;
use std::time::{Duration, Instant};

use ademan::capture::protocol::Packet;
use ademan::capture::{Reading, Sample, SourceUri};
use ademan::device::Events;
use ademan::estimate::{Estimator, EstimatorSettings};
use ademan::hand::Side;
use ademan::time::Timestamp;

use packets::{Stream, both_hands, markers, typing};

/// Share of a core that a source may take, in percent.
const GOAL_PERCENT: f64 = 2.0;

/// Packets whose time is measured at once. The fastest of all passes counts: other programs on the machine only add to it.
const BLOCK: usize = 8;

/// The passes of a measurement take at least this long.
const LEAST: Duration = Duration::from_secs(2);

struct Options {
    is_test: bool,
    filter: Option<String>,
}

impl Options {
    fn selects(&self, name: &str) -> bool {
        self.filter.as_ref().is_none_or(|text| name.contains(text))
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let options = Options {
        is_test: !arguments.iter().any(|argument| argument == "--bench"),
        filter: arguments
            .into_iter()
            .find(|argument| !argument.starts_with('-')),
    };
    println!("| source | rate | bytes | time of a packet | share of a core | goal |");
    for row in ROWS.iter().filter(|row| options.selects(row.name)) {
        print(row, &options);
    }
    if options.selects("estimate") {
        let time = fastest(&options, &mut estimate_passes());
        println!(
            "\n| estimate of arm and hand | time | goal |\n| joint positions to a pose | {:.2} µs | 2 µs |",
            time * 1e6
        );
    }
    if options.selects("bvh") {
        motion::print(options.is_test);
    }
}

fn print(row: &Row, options: &Options) {
    let Row { name, rate_hz, .. } = row;
    let stream = (row.stream)();
    let packets = stream.packets.len();
    let time = fastest(options, || pass(&stream)) / packets as f64;
    let bytes = stream.packets.iter().map(Vec::len).sum::<usize>() / packets;
    println!(
        "| {name} | {rate_hz} Hz | {bytes} | {:.1} µs | {:.2} % | {GOAL_PERCENT} % |",
        time * 1e6,
        time * rate_hz * 100.0
    );
}

/// A source at the rate of a fast one.
struct Row {
    name: &'static str,
    rate_hz: f64,
    stream: fn() -> Stream,
}

const fn row(name: &'static str, rate_hz: f64, stream: fn() -> Stream) -> Row {
    Row {
        name,
        rate_hz,
        stream,
    }
}

const ROWS: [Row; 10] = [
    row("glove: `hc11`", 1000.0, || typing("hc11")),
    row("glove: `text-line`", 1000.0, || typing("text-line")),
    row("4 cameras × 40 markers, labelled", 250.0, || markers(4)),
    row("4 cameras × 40 markers, unlabelled", 250.0, || markers(1)),
    row("2 hands: `hand-landmarks`", 120.0, || {
        both_hands("hand-landmarks&camera=head")
    }),
    row("2 hands: `openxr`", 120.0, || both_hands("openxr")),
    row("2 hands: `webxr`", 120.0, || both_hands("webxr")),
    row("2 arms: `body-landmarks`", 120.0, || {
        both_hands("body-landmarks")
    }),
    row("2 arms: `vmc`", 120.0, || both_hands("vmc")),
    row("wrist: `opentrack`", 250.0, || typing("opentrack")),
];

/// Returns the sum of the times of the blocks of a pass, each the fastest of all passes, in seconds.
fn fastest(options: &Options, mut pass: impl FnMut() -> Vec<Duration>) -> f64 {
    let start = Instant::now();
    let mut fastest = pass();
    while !options.is_test && start.elapsed() < LEAST {
        for (best, time) in fastest.iter_mut().zip(pass()) {
            *best = time.min(*best);
        }
    }
    fastest.iter().sum::<Duration>().as_secs_f64()
}

/// Decodes and steps all packets of a stream. Returns the time of each block, without the set-up.
fn pass(stream: &Stream) -> Vec<Duration> {
    let setup = stream.setup.clone().load_files().expect("a valid setup");
    let Some(SourceUri::Stream(uri)) = &setup.setup.source else {
        panic!("a stream");
    };
    let mut decoder = uri.format.decoder();
    let mut pipeline = setup.pipeline();
    let mut events = Events::new();
    let shows_both = uri.format.protocol.sample.shows_both_arms();
    let (time, mut steps) = (Cell::new(Timestamp(0)), 0);
    let mut step = |packet: Packet| {
        let sides: &[Option<Side>] = if shows_both {
            &[Some(Side::Left), Some(Side::Right)]
        } else {
            &[packet.side]
        };
        for &side in sides {
            events.clear();
            let reading = Reading::new(time.get(), side, packet.sample.clone());
            steps += usize::from(black_box(&pipeline.step(&reading, &mut events)).is_ok());
            black_box(&events);
        }
    };
    let mut times = Vec::new();
    for block in stream.packets.chunks(BLOCK) {
        let start = Instant::now();
        for bytes in block {
            time.set(time.get() + stream.period);
            decoder.push(black_box(bytes), &mut step);
            if stream.is_datagram {
                decoder.finish(&mut step);
            }
        }
        times.push(start.elapsed());
    }
    assert!(
        steps + 1 >= stream.packets.len(),
        "{steps} steps: {:?}",
        decoder.last_error()
    );
    times
}

/// Returns a function that measures the estimate and the pose of one reading with the positions of all joints.
fn estimate_passes() -> impl FnMut() -> Vec<Duration> {
    const READINGS: u32 = 1000;
    let (setup, samples) = packets::positions();
    let samples: Vec<Sample> = samples
        .into_iter()
        .cycle()
        .take(READINGS as usize)
        .collect();
    let mut estimator = Estimator::new(EstimatorSettings::default());
    let mut time = Timestamp(0);
    move || {
        let readings: Vec<Reading> = samples
            .iter()
            .map(|sample| {
                time.0 += 8_333;
                Reading::new(time, Some(Side::Right), sample.clone())
            })
            .collect();
        let start = Instant::now();
        for reading in &readings {
            let estimate = estimator
                .update(black_box(reading))
                .expect("a plausible hand");
            black_box(setup.arm.forward(estimate));
        }
        vec![start.elapsed() / READINGS]
    }
}
