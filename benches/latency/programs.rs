//! The compared programs, and their measurement.

use std::fs::File;
use std::io::{PipeWriter, Read, Write, pipe};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::hc11::{BODY_BYTES, Framing, encode};
use ademan::capture::{Hc11Format, Loopback, open, open_loopback};
use ademan::device::OutputEvent;
use ademan::output::{OutputError, Sink};
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::setup::Setup;
use ademan::sim::SimulatedTypist;
use ademan::snapshot::StepView;
use crossbeam_channel::{Receiver, Sender, bounded};
use serialport::{DataBits, FlowControl, Parity, SerialPort, StopBits, TTYPort};

use super::desktop;
use super::load::Load;

/// Bytes per packet: a body, and the two marks after it that confirm it.
const PACKET_BYTES: usize = BODY_BYTES + 2;

/// Size of one key event and its `SYN_REPORT`.
const EVENT_BYTES: usize = 48;

/// Time after which a packet counts as lost.
const TIMEOUT: Duration = Duration::from_secs(2);

/// The name of the library in the table.
const OURS: &str = "ours";

/// Starts a program with this writer and returns the line that it reads.
type Start = fn(Box<dyn Writer>) -> Loopback;

/// A receiver of events.
pub trait Writer: Send + 'static {
    /// Writes the event of the next packet.
    fn write(&mut self);
}

/// A kind of output with its writers.
pub struct Output {
    pub name: &'static str,
    /// One writer per program, in the order of the programs. Programs without a writer are omitted.
    pub writers: Vec<Box<dyn Writer>>,
    /// The times at which events arrived.
    pub arrivals: Receiver<Instant>,
}

pub fn main() {
    let is_test = !std::env::args().any(|argument| argument == "--bench");
    let (packets, warm_up) = if is_test { (20, 5) } else { (4_000, 200) };
    println!(
        "{:24} {:>8}  {:16} {:>8} {:>8}   p50 of null (goal 1.1)   p99 of null (goal 1.2)",
        "packet to event", "packet", "", "p50", "p99"
    );
    let millisecond = Duration::from_millis(1);
    for pace in [millisecond, Hc11Format::default().packet_period()] {
        measure(to_pipe(), pace, packets, warm_up);
        match desktop::output() {
            Some(output) => measure(output, pace, packets, warm_up),
            None => println!("X server: SKIPPED, see above"),
        }
    }
}

/// Feeds all programs in turn and prints their latencies.
fn measure(output: Output, pace: Duration, packets: usize, warm_up: usize) {
    let Output {
        name,
        writers,
        arrivals,
    } = output;
    let programs: [(&str, Start); 4] = [
        ("null", |writer| start(null, writer)),
        ("null with a hop", |writer| start(null_with_a_hop, writer)),
        (OURS, |writer| start_ours(writer, None)),
        ("ours, loaded", |writer| {
            start_ours(writer, Some(Load::start()))
        }),
    ];
    let begin = |((name, start), writer): ((&'static str, Start), Box<dyn Writer>)| {
        (name, start(writer), Vec::with_capacity(packets))
    };
    let mut programs: Vec<_> = programs.into_iter().zip(writers).map(begin).collect();
    let bodies = bodies();
    let mut due = Instant::now();
    let step = pace / programs.len() as u32;
    for number in 0..packets + warm_up {
        for (_, loopback, times) in &mut programs {
            due = (due + step).max(Instant::now());
            thread::sleep(due.saturating_duration_since(Instant::now()));
            // Events of lost packets.
            while arrivals.try_recv().is_ok() {}
            let begun = Instant::now();
            let body = &bodies[number % bodies.len()];
            loopback.writer.write_all(body).expect("the line is open");
            if let Ok(end) = arrivals.recv_timeout(TIMEOUT)
                && number >= warm_up
            {
                times.push(end.saturating_duration_since(begun));
            }
        }
    }
    let (mut of_null, mut of_ours) = (None, None);
    for (program, _, times) in &mut programs {
        let lost = packets - times.len();
        let found = (percentile(times, 50), percentile(times, 99));
        let (p50, p99) = *of_null.get_or_insert(found);
        let added =
            of_ours.map(|p99: f64| format!("   p99 +{:.2} ms (goal 2)", (found.1 - p99) / 1e3));
        if *program == OURS {
            of_ours = Some(found.1);
        }
        println!(
            "{name:24} {:5.2} ms  {program:16} {:5.1} µs {:5.1} µs   {:22.2}   {:22.2}{}{}",
            pace.as_secs_f64() * 1e3,
            found.0,
            found.1,
            found.0 / p50,
            found.1 / p99,
            added.unwrap_or_default(),
            if lost > 0 {
                format!("   {lost} lost")
            } else {
                String::new()
            }
        );
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
    let setup = Setup::default().load_files().expect("the default setup");
    let typist = setup.typist("hello world", &Hc11Format::default(), 0.5, 1);
    let mut typist: SimulatedTypist = typist.expect("the hand can type the text");
    std::iter::from_fn(|| typist.next_counts())
        .map(|counts| {
            let body: [u8; BODY_BYTES] = std::array::from_fn(|channel| counts[channel] as u8);
            let mut packet = encode(Framing::Double06, &body);
            packet.rotate_left(PACKET_BYTES - BODY_BYTES);
            packet
        })
        .collect()
}

/// Returns writers to pipes.
fn to_pipe() -> Output {
    let (done, arrivals) = bounded(16);
    let writer = || -> Box<dyn Writer> {
        let (mut reader, pipe) = pipe().expect("a pipe");
        thread::spawn(move || while reader.read(&mut [0; 4096]).is_ok_and(|length| length > 0) {});
        let done = done.clone();
        Box::new(ToPipe { pipe, done })
    };
    Output {
        name: "a pipe",
        writers: (0..4).map(|_| writer()).collect(),
        arrivals,
    }
}

struct ToPipe {
    pipe: PipeWriter,
    done: Sender<Instant>,
}

impl Writer for ToPipe {
    fn write(&mut self) {
        self.pipe
            .write_all(&[1; EVENT_BYTES])
            .expect("the pipe is open");
        let _ = self.done.try_send(Instant::now());
    }
}

/// Starts a program without the library.
fn start(program: fn(File, Box<dyn Writer>), writer: Box<dyn Writer>) -> Loopback {
    let loopback = open_loopback(Hc11Format::default()).expect("a pseudo terminal");
    let port = loopback.uri.serial_port().expect("a serial port");
    let settings = TTYPort::open(
        &serialport::new(port, Hc11Format::default().baud.get())
            .data_bits(DataBits::Eight)
            .parity(Parity::None)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::None)
            .exclusive(false),
    );
    let settings = settings.expect("the port opens");
    assert_eq!(
        settings.baud_rate().ok(),
        Some(Hc11Format::default().baud.get())
    );
    let file = File::open(port).expect("the port opens");
    thread::spawn(move || {
        program(file, writer);
        drop(settings);
    });
    loopback
}

fn null(mut line: File, mut writer: Box<dyn Writer>) {
    let mut packet = [0; PACKET_BYTES];
    while line.read_exact(&mut packet).is_ok() {
        writer.write();
    }
}

fn null_with_a_hop(mut line: File, mut writer: Box<dyn Writer>) {
    let (sender, packets) = bounded::<[u8; PACKET_BYTES]>(16);
    thread::spawn(move || {
        for _ in packets {
            writer.write();
        }
    });
    let mut packet = [0; PACKET_BYTES];
    while line.read_exact(&mut packet).is_ok() && sender.send(packet).is_ok() {}
}

/// Starts the library, optionally with load on its control socket.
fn start_ours(writer: Box<dyn Writer>, mut load: Option<Load>) -> Loopback {
    let mut loopback = open_loopback(Hc11Format::default()).expect("a pseudo terminal");
    let source = open(&loopback.uri).expect("the line opens");
    let setup = Setup::default().load_files().expect("the default setup");
    thread::spawn(move || {
        let mut pipeline = setup.pipeline();
        let mut sink = ForEachStep(writer);
        let mut notifier = load.as_ref().map(|load| load.notifier.clone());
        let commands = load.as_mut().and_then(|load| load.commands.take());
        let commands = commands.unwrap_or_else(CommandReceiver::disconnected);
        let observe = &mut |step: &StepView| {
            if let Some(notifier) = &mut notifier {
                notifier.notify_step(step);
            }
        };
        // It runs until the benchmark exits.
        let _ = run_pipeline(source, &mut pipeline, &mut sink, &commands, observe);
    });
    let marks = &encode(Framing::Double06, &[0; BODY_BYTES])[..PACKET_BYTES - BODY_BYTES];
    loopback.writer.write_all(marks).expect("the line is open");
    loopback
}

/// A sink that writes one event per step, whichever events it has.
struct ForEachStep(Box<dyn Writer>);

impl Sink for ForEachStep {
    fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
        self.0.write();
        Ok(())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}
