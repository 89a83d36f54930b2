//! The measurement: packets to all programs in turn, and the times until their events.

use std::io::Write;
use std::num::NonZeroU32;
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::Hc11Format;
use ademan::capture::hc11::BODY_BYTES;
use crossbeam_channel::Receiver;

use super::desktop;
use super::load::Load;
use super::packets::packets;
use super::programs::{Output, PACKET_BYTES, PROGRAMS, Program, Running, Writer, to_pipe};
use super::uinput;

/// Time after which a packet counts as lost.
const TIMEOUT: Duration = Duration::from_secs(2);

/// Numbers of packets: those that are measured, and those before them.
#[derive(Clone, Copy)]
struct Packets {
    measured: usize,
    warm_up: usize,
}

pub fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    if let [mode, display] = &arguments[..]
        && mode == desktop::WATCHDOG
    {
        desktop::become_watchdog(display);
    }
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    let (measured, warm_up) = if has("--bench") {
        (4_000, 200)
    } else {
        (20, 5)
    };
    let number = arguments.iter().find_map(|argument| argument.parse().ok());
    let measured = number.unwrap_or(measured);
    let packets = Packets { measured, warm_up };
    println!(
        "{:24} {:>8}  {:16} {:>9} {:>9}   of null: p50    p99",
        "packet to event", "packet", "", "p50", "p99"
    );
    let paces = [
        Duration::from_millis(1),
        Hc11Format::default().packet_period(),
    ];
    if has("uinput") {
        for pace in paces {
            measure(uinput::output, pace, packets, false);
        }
        return;
    }
    for is_loaded in [false, true] {
        for pace in paces {
            measure(to_pipe, pace, packets, is_loaded);
            measure(desktop::output, pace, packets, is_loaded);
        }
    }
    println!();
    println!(
        "{:24} {:>8}  {:16} {:>9} {:>9}   of it the protocol's wait",
        "last byte to event", "baud", "", "p50", "p99"
    );
    for baud in [115_200, 9_600] {
        measure_line(NonZeroU32::new(baud).expect("not zero"), measured / 10);
    }
}

/// A program and the times of its events.
struct Fed {
    name: &'static str,
    running: Running,
    times: Vec<Duration>,
}

/// Starts all programs, each with room for the times of this number of packets.
fn start_all(writers: Vec<Box<dyn Writer>>, load: Option<&Load>, packets: usize) -> Vec<Fed> {
    let start = |(program, writer): (&Program, _)| Fed {
        name: program.name,
        running: (program.start)(writer, load),
        times: Vec::with_capacity(packets),
    };
    PROGRAMS.iter().zip(writers).map(start).collect()
}

/// Returns the programs in the order in which they are listed, after they have taken turns.
fn in_order(mut programs: Vec<Fed>) -> Vec<Fed> {
    programs.sort_by_key(|program| PROGRAMS.iter().position(|it| it.name == program.name));
    programs
}

/// Feeds all programs in turn and prints their latencies.
fn measure(
    output: impl FnOnce() -> Option<Output>,
    pace: Duration,
    packets: Packets,
    is_loaded: bool,
) {
    let Some(output) = output() else {
        return;
    };
    let load = is_loaded.then(Load::start);
    let mut programs = start_all(output.writers, load.as_ref(), packets.measured);
    let bodies = bodies();
    let mut due = Instant::now();
    let step = pace / programs.len() as u32;
    for number in 0..packets.measured + packets.warm_up {
        programs.rotate_left(1);
        for program in &mut programs {
            due = (due + step).max(Instant::now());
            thread::sleep(due.saturating_duration_since(Instant::now()));
            let body = &bodies[number % bodies.len()];
            let time = time_of(&output.arrivals, || {
                let begun = Instant::now();
                let written = program.running.line.writer.write_all(body);
                written.expect("the line is open");
                begun
            });
            if number >= packets.warm_up {
                program.times.extend(time);
            }
        }
    }
    let output_name = if is_loaded {
        format!("{}, load", output.name)
    } else {
        output.name.to_owned()
    };
    let mut of_null = None;
    for mut program in in_order(programs) {
        let found = (
            percentile(&mut program.times, 50),
            percentile(&mut program.times, 99),
        );
        let (p50, p99) = *of_null.get_or_insert(found);
        println!(
            "{output_name:24} {:5.2} ms  {:16} {:6.1} µs {:6.1} µs   {:12.2} {:6.2}{}",
            pace.as_secs_f64() * 1e3,
            program.name,
            found.0,
            found.1,
            found.0 / p50,
            found.1 / p99,
            lost(packets.measured - program.times.len()),
        );
        program.running.end();
    }
}

/// Feeds all programs in turn on lines with this bit rate, and prints the times from the last byte of a packet to its event.
fn measure_line(baud: NonZeroU32, packets: usize) {
    let format = Hc11Format {
        baud,
        ..Hc11Format::default()
    };
    let wait = format.transmission_time(PACKET_BYTES - BODY_BYTES);
    let output = to_pipe().expect("pipes");
    let mut programs = start_all(output.writers, None, packets);
    let bodies = bodies();
    for number in 0..packets {
        programs.rotate_left(1);
        let (body, marks) = bodies[number % bodies.len()].split_at(BODY_BYTES);
        for program in &mut programs {
            thread::sleep(Duration::from_millis(1));
            let writer = &mut program.running.line.writer;
            program.times.extend(time_of(&output.arrivals, || {
                writer.write_all(body).expect("the line is open");
                let complete = Instant::now();
                thread::sleep(wait);
                writer.write_all(marks).expect("the line is open");
                complete
            }));
        }
    }
    for mut program in in_order(programs) {
        println!(
            "{:24} {baud:8}  {:16} {:6.1} µs {:6.1} µs   {:6.1} µs{}",
            output.name,
            program.name,
            percentile(&mut program.times, 50),
            percentile(&mut program.times, 99),
            wait.as_secs_f64() * 1e6,
            lost(packets - program.times.len()),
        );
        program.running.end();
    }
}

/// Feeds a packet and returns the time from its last byte, which `feed` returns, to its event. `None` if there is no event.
fn time_of(arrivals: &Receiver<Instant>, feed: impl FnOnce() -> Instant) -> Option<Duration> {
    // Events of lost packets.
    while arrivals.try_recv().is_ok() {}
    let complete = feed();
    let arrival = arrivals.recv_timeout(TIMEOUT).ok()?;
    Some(arrival.saturating_duration_since(complete))
}

fn lost(packets: usize) -> String {
    match packets {
        0 => String::new(),
        packets => format!("   {packets} lost"),
    }
}

/// Returns a percentile in microseconds.
fn percentile(times: &mut [Duration], percent: usize) -> f64 {
    times.sort_unstable();
    let index = (times.len() * percent / 100).min(times.len().saturating_sub(1));
    times
        .get(index)
        .map_or(f64::NAN, |time| time.as_secs_f64() * 1e6)
}

/// Returns the bodies of packets of a typing hand, each with the marks of the next packet.
fn bodies() -> Vec<[u8; PACKET_BYTES]> {
    let mut bodies: Vec<_> = packets().collect();
    for packet in &mut bodies {
        packet.rotate_left(PACKET_BYTES - BODY_BYTES);
    }
    bodies
}
