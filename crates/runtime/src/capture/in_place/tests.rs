//! Tests of the events of a source that is read in place, over a pipe.

use std::fs::File;
use std::io::{PipeWriter, Write, pipe};
use std::os::fd::OwnedFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use super::*;
use crate::capture::connection::{ByteStream, ConnectError, Connection, Connector};
use crate::capture::event_queue::QUEUE_CAPACITY;
use crate::capture::hc11::{BODY_BYTES, Framing, Hc11Format, encode};
use crate::capture::stream::StreamSource;
use crate::capture::{CaptureError, Readiness, Sample, SourceEvent};

const TIMEOUT: Duration = Duration::from_secs(60);

/// Connector to a new pipe at each call, whose writing end it keeps. Reads block, as on any pipe, so that a read
/// without bytes would end no test.
#[derive(Clone, Default)]
struct PipeConnector {
    writer: Arc<Mutex<Option<PipeWriter>>>,
}

impl PipeConnector {
    fn write(&self, bytes: &[u8]) {
        let mut writer = self.writer.lock().unwrap();
        writer
            .as_mut()
            .expect("it is connected")
            .write_all(bytes)
            .unwrap();
    }

    fn unplug(&self) {
        *self.writer.lock().unwrap() = None;
    }
}

impl Connector for PipeConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let (reader, writer) = pipe().unwrap();
        rustix::io::ioctl_fionbio(&reader, true).unwrap();
        *self.writer.lock().unwrap() = Some(writer);
        let file = File::from(OwnedFd::from(reader));
        Ok(Connection {
            readiness: Readiness::new(&file),
            bytes: Box::new(file),
            endpoint: "pipe".to_owned(),
        })
    }
}

fn start() -> (PipeConnector, InPlaceCapture) {
    let connector = PipeConnector::default();
    let format = Hc11Format::default().into();
    let source = StreamSource::open("pipe".to_owned(), format, connector.clone()).unwrap();
    let capture = InPlaceCapture::new(Box::new(source));
    let capture = capture.unwrap_or_else(|_| panic!("a pipe can be polled"));
    (connector, capture)
}

/// Encodes packets whose counts are all the number of the packet, and the marks that confirm the last one.
fn packets(numbers: impl Iterator<Item = u8>) -> Vec<u8> {
    let packet = |number| encode(Framing::Double06, &[number; BODY_BYTES]);
    let mut bytes: Vec<u8> = numbers.flat_map(packet).collect();
    bytes.extend([6, 6]);
    bytes
}

/// Formats an event; a reading is its first count and the readings dropped before it.
fn brief(event: CaptureEvent) -> String {
    match event {
        CaptureEvent::Reading { reading, stats, .. } => match reading.sample {
            Sample::Channels(channels) => format!("{}({})", channels.counts[0], stats.dropped),
            other => panic!("not channels: {other:?}"),
        },
        CaptureEvent::Lost(error) => error.to_string(),
        other => format!("{other:?}"),
    }
}

fn queued(capture: &mut InPlaceCapture) -> Vec<String> {
    std::iter::from_fn(|| capture.next_event())
        .map(brief)
        .collect()
}

/// Waits until there are events.
fn next(capture: &mut InPlaceCapture) -> Vec<String> {
    let start = Instant::now();
    while !capture.has_events() && start.elapsed() < TIMEOUT {
        capture.wait(TIMEOUT);
    }
    queued(capture)
}

#[test]
fn a_packet_is_read_by_the_thread_that_waits_for_it() {
    let (glove, mut capture) = start();
    capture.wait(Duration::ZERO);
    assert!(queued(&mut capture).is_empty());
    glove.write(&packets(7..8));
    capture.wait(TIMEOUT);
    assert_eq!(queued(&mut capture), ["7(0)"]);
}

#[test]
fn a_wake_up_ends_a_wait_without_bytes() {
    let (_glove, mut capture) = start();
    let wake_up = capture.wake_up().clone();
    let start = Instant::now();
    let other = thread::spawn(move || wake_up.wake());
    capture.wait(2 * TIMEOUT);
    assert!(start.elapsed() < TIMEOUT);
    assert!(queued(&mut capture).is_empty());
    other.join().unwrap();
}

#[test]
fn of_a_backlog_the_newest_readings_are_kept_and_the_others_counted() {
    let (glove, mut capture) = start();
    glove.write(&packets(100..200));
    capture.wait(TIMEOUT);
    let readings = queued(&mut capture);
    assert_eq!(readings.len(), QUEUE_CAPACITY, "{readings:?}");
    assert_eq!(readings[0], "184(69)");
    assert_eq!(readings[15], "199(84)");
    capture.wait(Duration::ZERO);
    assert!(queued(&mut capture).is_empty());
}

#[test]
fn a_sender_that_pauses_needs_no_further_packet_to_confirm_its_last_one() {
    let (glove, mut capture) = start();
    let start = Instant::now();
    let mut events = Vec::new();
    // A busy machine may not see each of the pauses.
    while events.last() != Some(&"9(0)".to_owned()) && start.elapsed() < TIMEOUT {
        for _ in 0..10 {
            glove.write(&encode(Framing::Double06, &[7; BODY_BYTES]));
            capture.wait(TIMEOUT);
            capture.wait(Duration::from_millis(1));
        }
        glove.write(&encode(Framing::Double06, &[9; BODY_BYTES]));
        capture.wait(TIMEOUT);
        capture.wait(Duration::from_millis(1));
        events = queued(&mut capture);
    }
    assert_eq!(
        events.last().map(String::as_str),
        Some("9(0)"),
        "{events:?}"
    );
}

#[test]
fn a_lost_device_is_reported_and_read_in_place_again_once_it_is_back() {
    let (glove, mut capture) = start();
    glove.write(&packets(1..3));
    assert_eq!(next(&mut capture), ["1(0)", "2(0)"]);
    glove.unplug();
    assert_eq!(
        next(&mut capture),
        ["lost pipe: the device has closed the connection; reconnecting"]
    );
    let start = Instant::now();
    while glove.writer.lock().unwrap().is_none() && start.elapsed() < TIMEOUT {
        capture.wait(Duration::from_millis(10));
    }
    glove.write(&packets(8..10));
    assert_eq!(next(&mut capture), ["8(0)", "9(0)"]);
}

/// `true` once a source has closed that is slow to close.
static IS_CLOSED: AtomicBool = AtomicBool::new(false);

/// Source that always has something, and calls `step` for it.
struct BusySource {
    step: fn(u64) -> Result<SourceEvent, CaptureError>,
    calls: u64,
    is_slow_to_close: bool,
}

impl Source for BusySource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        self.calls += 1;
        (self.step)(self.calls)
    }

    fn set_polled(&mut self) -> bool {
        true
    }

    fn name(&self) -> &str {
        "busy"
    }
}

impl Drop for BusySource {
    fn drop(&mut self) {
        if self.is_slow_to_close {
            thread::sleep(Duration::from_secs(60));
            IS_CLOSED.store(true, Ordering::SeqCst);
        }
    }
}

fn start_busy(
    step: fn(u64) -> Result<SourceEvent, CaptureError>,
    is_slow_to_close: bool,
) -> InPlaceCapture {
    let source = BusySource {
        step,
        calls: 0,
        is_slow_to_close,
    };
    let capture = InPlaceCapture::new(Box::new(source));
    capture.unwrap_or_else(|_| panic!("it can be polled"))
}

#[test]
fn a_sender_without_pauses_does_not_keep_the_consumer() {
    let mut capture = start_busy(|_| Ok(SourceEvent::Idle), false);
    capture.wait(TIMEOUT);
    assert!(queued(&mut capture).is_empty());
}

#[test]
fn a_panic_of_the_source_is_a_failure() {
    let mut capture = start_busy(|_| panic!("bad count"), false);
    capture.wait(TIMEOUT);
    let events = queued(&mut capture);
    assert_eq!(events.len(), 1, "{events:?}");
    let text = "it panicked: bad count; please report this";
    assert!(events[0].contains(text), "{events:?}");
}

#[test]
fn a_port_that_blocks_while_closing_is_left_behind() {
    let capture = start_busy(|_| Ok(SourceEvent::Idle), true);
    drop(capture);
    assert!(!IS_CLOSED.load(Ordering::SeqCst));
}

/// File that is never at its end and whose reads may block.
struct SharedInput(File);

impl std::io::Read for SharedInput {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(buffer)
    }
}

impl ByteStream for SharedInput {
    fn may_block(&self) -> bool {
        true
    }
}

#[test]
fn a_stream_whose_reads_may_block_keeps_its_thread() {
    let (reader, _writer) = pipe().unwrap();
    let file = File::from(OwnedFd::from(reader));
    let connection = Connection {
        readiness: Readiness::new(&file),
        bytes: Box::new(SharedInput(file)),
        endpoint: "pipe".to_owned(),
    };
    assert!(!connection.can_be_polled());
}
