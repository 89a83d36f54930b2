//! The compared programs.

use std::fs::File;
use std::io::{PipeWriter, Read, Write, pipe};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use ademan::capture::hc11::{BODY_BYTES, Framing, encode};
use ademan::capture::{
    CancelToken, CaptureError, Hc11Format, Loopback, Source, SourceEvent, SourceStats, open,
    open_loopback,
};
use ademan::command::Command;
use ademan::device::OutputEvent;
use ademan::output::{OutputError, Sink};
use ademan::session::{CommandSender, command_channel, run_pipeline};
use ademan::setup::Setup;
use ademan::snapshot::StepView;
use crossbeam_channel::{Receiver, Sender, bounded};
use serialport::{DataBits, FlowControl, Parity, SerialPort, StopBits, TTYPort};

use super::load::Load;

/// Bytes per packet: a body, and the two marks after it that confirm it.
pub const PACKET_BYTES: usize = BODY_BYTES + 2;

/// Size of one key event and its `SYN_REPORT`.
const EVENT_BYTES: usize = 48;

/// A program that turns packets into events.
pub struct Program {
    pub name: &'static str,
    /// Starts it with this writer.
    pub start: fn(Box<dyn Writer>, Option<&Load>) -> Running,
}

/// A running program.
pub struct Running {
    /// The line that it reads.
    pub line: Loopback,
    /// Stops a program that would wait for the line to be opened again.
    stop: Option<CommandSender>,
    thread: JoinHandle<()>,
}

impl Running {
    /// Ends the program, which would disturb the next ones, and drops its writer.
    pub fn end(self) {
        drop(self.line);
        if let Some(stop) = self.stop {
            let _ = stop.send(Command::Stop);
        }
        self.thread.join().expect("the program does not panic");
    }
}

/// All programs. The first one is the reference.
pub const PROGRAMS: &[Program] = &[
    Program {
        name: "null",
        start: |writer, _| start(null, writer),
    },
    Program {
        name: "null with a hop",
        start: |writer, _| start(null_with_a_hop, writer),
    },
    Program {
        name: "ours",
        start: |writer, load| start_ours(writer, load, |source| source),
    },
    Program {
        name: "ours with a hop",
        start: |writer, load| start_ours(writer, load, |source| Box::new(Blocking(source))),
    },
];

/// A receiver of events.
pub trait Writer: Send + 'static {
    /// Writes the event of the next packet.
    fn write(&mut self);
}

/// A kind of output with its writers.
pub struct Output {
    pub name: &'static str,
    /// One writer per program, in the order of [`PROGRAMS`].
    pub writers: Vec<Box<dyn Writer>>,
    /// The times at which events arrived.
    pub arrivals: Receiver<Instant>,
}

/// Returns writers to pipes.
pub fn to_pipe() -> Option<Output> {
    let (done, arrivals) = bounded(16);
    let writer = |_| -> Box<dyn Writer> {
        let (mut reader, pipe) = pipe().expect("a pipe");
        thread::spawn(move || while reader.read(&mut [0; 4096]).is_ok_and(|length| length > 0) {});
        let done = done.clone();
        Box::new(ToPipe { pipe, done })
    };
    Some(Output {
        name: "a pipe",
        writers: PROGRAMS.iter().map(writer).collect(),
        arrivals,
    })
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
fn start(program: fn(File, Box<dyn Writer>), writer: Box<dyn Writer>) -> Running {
    let line = open_loopback(Hc11Format::default()).expect("a pseudo terminal");
    let port = line.uri.serial_port().expect("a serial port");
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
    let thread = thread::spawn(move || {
        program(file, writer);
        drop(settings);
    });
    Running {
        line,
        stop: None,
        thread,
    }
}

fn null(mut line: File, mut writer: Box<dyn Writer>) {
    let mut packet = [0; PACKET_BYTES];
    while line.read_exact(&mut packet).is_ok() {
        writer.write();
    }
}

fn null_with_a_hop(mut line: File, mut writer: Box<dyn Writer>) {
    let (sender, packets) = bounded::<[u8; PACKET_BYTES]>(16);
    let writing = thread::spawn(move || {
        for _ in packets {
            writer.write();
        }
    });
    let mut packet = [0; PACKET_BYTES];
    while line.read_exact(&mut packet).is_ok() && sender.send(packet).is_ok() {}
    drop(sender);
    writing.join().expect("the thread does not panic");
}

/// Starts the library with a form of its source.
fn start_ours(
    writer: Box<dyn Writer>,
    load: Option<&Load>,
    form: fn(Box<dyn Source>) -> Box<dyn Source>,
) -> Running {
    let mut line = open_loopback(Hc11Format::default()).expect("a pseudo terminal");
    let source = form(open(&line.uri).expect("the line opens"));
    let setup = Setup::default().load_files().expect("the default setup");
    let mut notifier = load.map(|load| load.notifier.clone());
    let (stop, commands) = command_channel();
    let thread = thread::spawn(move || {
        let mut pipeline = setup.pipeline();
        let mut writer = writer;
        let observe = &mut |step: &StepView| {
            // One event per step, whatever events it has.
            if step.reading.is_some() {
                writer.write();
            }
            if let Some(notifier) = &mut notifier {
                notifier.notify_step(step);
            }
        };
        run_pipeline(source, &mut pipeline, &mut NoSink, &commands, observe)
            .expect("a run until it is stopped");
    });
    let marks = &encode(Framing::Double06, &[0; BODY_BYTES])[..PACKET_BYTES - BODY_BYTES];
    line.writer.write_all(marks).expect("the line is open");
    Running {
        line,
        stop: Some(stop),
        thread,
    }
}

/// A source that has to block, as a source without a descriptor does.
struct Blocking(Box<dyn Source>);

impl Source for Blocking {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        self.0.next()
    }

    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        self.0.set_cancel_token(cancel);
    }

    fn name(&self) -> &str {
        self.0.name()
    }

    fn packet_period(&self) -> Option<Duration> {
        self.0.packet_period()
    }

    fn stats(&self) -> SourceStats {
        self.0.stats()
    }
}

/// A sink for the events of the pipeline, which are not those that are measured.
struct NoSink;

impl Sink for NoSink {
    fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
        Ok(())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}
