//! Seeded random inputs for every parser and for the pipeline: 10 million bytes each, and a million steps.
//!
//! The targets are shared with `fuzz/`, which searches for inputs by coverage. More bytes and steps, or another seed:
//! `ADEMAN_FUZZ_SEED=7 ADEMAN_FUZZ_TIMES=100 cargo test --test fuzzing -- --nocapture`.

mod hostile;
mod inputs;
mod lines;
mod motion;
mod network;
mod packets;
mod pipeline;
mod recordings;
#[cfg(feature = "tls")]
mod secure;
mod seeds;
#[path = "../support/mod.rs"]
mod support;
mod texts;

use std::time::Instant;

use inputs::Inputs;
use pipeline::RunStats;

/// The number of bytes for each parser.
const BYTES: u64 = 10_000_000;

/// The number of steps for the pipeline.
const STEPS: u64 = 1_000_000;

/// A parser; returns `true` if it accepts the input.
type Parser = fn(&[u8]) -> bool;

fn number(name: &str, default: u64) -> u64 {
    let set = std::env::var(name).ok();
    set.map_or(default, |text| text.parse().expect("a whole number"))
}

fn seed() -> u64 {
    number("ADEMAN_FUZZ_SEED", 1)
}

fn times() -> u64 {
    number("ADEMAN_FUZZ_TIMES", 1)
}

/// Runs a parser on damaged seeds and noise.
fn run(name: &str, seeds: Vec<Vec<u8>>, parse: impl Fn(&[u8]) -> bool) {
    let start = Instant::now();
    let mut inputs = Inputs::new(seed(), seeds);
    let (mut bytes, mut accepted, mut refused) = (0, 0, 0);
    while bytes < BYTES * times() {
        let input = inputs.next();
        bytes += input.len() as u64;
        if run_on(name, &input, &parse) {
            accepted += 1
        } else {
            refused += 1
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("{name}: {bytes} bytes, {accepted} accepted, {refused} refused, {seconds:.1} s");
    assert!(accepted > 0, "no input was accepted");
    assert!(refused > 0, "no input was refused");
}

/// Runs a target on an input, and prints the input if the target panics.
fn run_on<T>(name: &str, input: &[u8], target: &impl Fn(&[u8]) -> T) -> T {
    struct PrintOnPanic<'a>(&'a str, &'a [u8]);

    impl Drop for PrintOnPanic<'_> {
        fn drop(&mut self) {
            if std::thread::panicking() {
                let Self(name, input) = self;
                println!("{name} failed on b\"{}\"", input.escape_ascii());
            }
        }
    }

    let _print = PrintOnPanic(name, input);
    target(input)
}

#[test]
fn packets_are_separated_from_noise() {
    run("packets", packets::seeds(), packets::packets);
}

#[test]
fn lines_are_separated_from_noise() {
    run("lines", lines::seeds(), lines::lines);
}

#[test]
fn motion_captures_are_separated_from_noise() {
    run("bvh", motion::bvh_seeds(), motion::bvh);
}

#[test]
fn markers_are_separated_from_noise() {
    run("markers", motion::marker_seeds(), motion::markers);
}

#[test]
fn layouts_are_read_or_refused() {
    run("layouts", seeds::layouts(), texts::layout);
}

#[test]
fn setups_are_read_or_refused() {
    run("setups", seeds::setups(), texts::setup);
}

#[test]
fn gloves_are_read_or_refused() {
    run("gloves", seeds::gloves(), texts::glove);
}

#[test]
fn marks_of_a_calibration_are_read_or_refused() {
    run("marks", seeds::marks(), texts::marks);
}

#[test]
fn arms_are_read_or_refused() {
    run("arms", seeds::arms(), texts::arm);
}

#[test]
fn persons_are_read_or_refused() {
    run("persons", seeds::persons(), texts::person);
}

#[test]
fn recordings_are_replayed_or_refused() {
    run("recordings", recordings::seeds(), recordings::recording);
}

#[test]
fn messages_of_recordings_are_decoded_or_refused() {
    run("messages", recordings::message_seeds(), recordings::message);
}

#[test]
fn requests_are_read_or_refused() {
    run("requests", seeds::requests(), texts::request);
}

#[test]
fn clients_of_a_shared_hand_are_answered_or_disconnected() {
    run("share", network::share_seeds(), network::share_client);
}

#[test]
fn messages_of_other_machines_are_separated_from_noise() {
    run("datagrams", network::message_seeds(), network::messages);
}

#[cfg(feature = "tls")]
#[test]
fn tokens_are_read_or_refused() {
    run("tokens", secure::token_seeds(), secure::token);
}

#[cfg(feature = "tls")]
#[test]
fn first_bytes_of_clients_of_tls_are_answered_or_refused() {
    run("handshake", secure::handshake_seeds(), secure::handshake);
}

#[test]
fn sources_are_read_or_refused() {
    run("sources", seeds::sources(), texts::source);
}

#[test]
fn scripts_are_read_or_refused() {
    run("scripts", seeds::scripts(), texts::script);
}

#[test]
fn layouts_in_links_are_read_or_refused() {
    run("links", seeds::links(), texts::layout_link);
}

#[test]
fn endless_nesting_is_refused_without_a_stack_overflow() {
    let parsers: [(&str, Parser); 6] = [
        ("layout", texts::layout),
        ("setup", texts::setup),
        ("glove", texts::glove),
        ("arm", texts::arm),
        ("request", texts::request),
        ("script", texts::script),
    ];
    let openings = [
        "(",
        "[",
        "{",
        "Some(",
        "{\"ask\":",
        "((",
        "[(",
        "(hand:",
        "(boards:[",
        "/*",
    ];
    for (name, parse) in parsers {
        for opening in openings {
            for times in [200, 100_000] {
                let text = opening.repeat(times);
                assert!(!parse(text.as_bytes()), "{name}: {times} times {opening}");
            }
        }
    }
}

#[test]
fn the_pipeline_keeps_its_invariants() {
    let start = Instant::now();
    let mut inputs = Inputs::new(seed(), seeds::pipeline());
    let mut all = RunStats::default();
    while all.steps < STEPS * times() {
        for input in [inputs.noise(400), inputs.next()] {
            all.add(run_on("pipeline", &input, &pipeline::pipeline));
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("pipeline: {all:?}, {seconds:.1} s");
    let enough = [
        (all.accepted, STEPS / 2),
        (all.presses, 1_000),
        (all.other_events, 1_000),
        (all.forced, 100),
        (all.armed, 500),
    ];
    for (count, least) in enough {
        assert!(count >= least, "too few events: {all:?}");
    }
    assert!(all.accepted < all.steps);
}
