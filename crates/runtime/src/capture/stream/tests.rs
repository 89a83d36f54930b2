//! Tests of a stream over a scripted connection.

use std::collections::VecDeque;
use std::io::{Read, Result as IoResult};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use super::*;
use crate::capture::Sample;
use crate::capture::connection::{ByteStream, ConnectError};
use crate::capture::hc11::{BODY_BYTES, Framing, Hc11Format, encode};

const TIMEOUT: Duration = Duration::from_secs(60);

/// Connector and connection that give the results of `reads` in turn, then the end of the stream.
#[derive(Clone, Default)]
struct ScriptedReads {
    reads: Arc<Mutex<VecDeque<IoResult<Vec<u8>>>>>,
    read_count: Arc<Mutex<usize>>,
}

impl ScriptedReads {
    fn new(reads: impl IntoIterator<Item = IoResult<Vec<u8>>>) -> Self {
        Self {
            reads: Arc::new(Mutex::new(reads.into_iter().collect())),
            read_count: Arc::default(),
        }
    }
}

impl Read for ScriptedReads {
    fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
        *self.read_count.lock().unwrap() += 1;
        let bytes = self
            .reads
            .lock()
            .unwrap()
            .pop_front()
            .unwrap_or(Ok(Vec::new()))?;
        buffer[..bytes.len()].copy_from_slice(&bytes);
        Ok(bytes.len())
    }
}

impl ByteStream for ScriptedReads {}

impl Connector for ScriptedReads {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        Ok(Connection {
            bytes: Box::new(self.clone()),
            readiness: None,
            endpoint: "script".to_owned(),
        })
    }
}

fn open(reads: ScriptedReads) -> StreamSource<ScriptedReads> {
    StreamSource::open("script".to_owned(), Hc11Format::default().into(), reads).unwrap()
}

fn packets(count: u8) -> Vec<u8> {
    (0..count)
        .flat_map(|number| encode(Framing::Double06, &[100 + number; BODY_BYTES]))
        .collect()
}

/// Returns the events up to the second loss as text; a reading is its first count.
fn events_until_two_losses(source: &mut StreamSource<ScriptedReads>) -> Vec<String> {
    let mut events = Vec::new();
    let start = Instant::now();
    while source.losses < 2 && start.elapsed() < TIMEOUT {
        match source.next() {
            Ok(SourceEvent::Idle | SourceEvent::Command(_)) => {}
            Ok(SourceEvent::End) => events.push("end".to_owned()),
            Ok(SourceEvent::Reading(reading)) => match reading.sample {
                Sample::Channels(channels) => events.push(channels.counts[0].to_string()),
                other => panic!("not channels: {other:?}"),
            },
            Err(error) => events.push(error.to_string()),
        }
    }
    events
}

#[test]
fn interrupted_reads_and_timeouts_lose_nothing() {
    let mut stream = packets(2);
    stream.extend([6, 6]);
    let kinds = [
        ErrorKind::Interrupted,
        ErrorKind::WouldBlock,
        ErrorKind::TimedOut,
    ];
    let errors = (0..300).map(|index| Err(Error::from(kinds[index % 3])));
    let (head, tail) = stream.split_at(40);
    let reads = [Ok(head.to_vec())]
        .into_iter()
        .chain(errors)
        .chain([Ok(tail.to_vec())]);
    let mut source = open(ScriptedReads::new(reads));
    let events: Vec<SourceEvent> = (0..303).map(|_| source.next().unwrap()).collect();
    let readings = events.iter().filter(|event| **event != SourceEvent::Idle);
    assert_eq!(readings.count(), 2);
    assert_eq!(source.stats().losses, 0);
}

#[test]
fn each_end_of_a_live_stream_is_one_loss_and_reconnection_backs_off() {
    let reads = ScriptedReads::default();
    let read_count = reads.read_count.clone();
    let mut source = open(reads);
    let start = Instant::now();
    let mut losses = 0;
    // A busy machine may try again late.
    let is_late = |so_far: usize| so_far < 2 && start.elapsed() < TIMEOUT;
    while start.elapsed() < Duration::from_secs(1) || is_late(losses) {
        match source.next() {
            Ok(event) => assert_eq!(event, SourceEvent::Idle),
            Err(error) => {
                losses += 1;
                assert!(error.is_recoverable());
            }
        }
    }
    let count = *read_count.lock().unwrap();
    // At 0, 0.1, 0.3 and 0.7 s, because no packet arrives in between.
    assert!((2..=4).contains(&count), "{count}");
    assert_eq!((losses, source.stats().losses), (count, count as u64));
}

#[test]
fn halves_of_a_packet_around_a_loss_are_not_joined() {
    let mut stream = packets(3);
    stream.extend([6, 6]);
    let reads = [
        Ok(stream[..90].to_vec()),
        Err(Error::from(ErrorKind::BrokenPipe)),
        Ok(stream[90..].to_vec()),
    ];
    let mut source = open(ScriptedReads::new(reads));
    let events = events_until_two_losses(&mut source);
    assert_eq!(
        events,
        [
            "100",
            "lost script: broken pipe; reconnecting",
            "102",
            "lost script: the device has closed the connection; reconnecting",
        ]
    );
    let stats = source.stats();
    assert_eq!(stats.bytes, 200);
    assert_eq!(stats.bytes, 66 * stats.readings + stats.skipped_bytes);
}

#[test]
fn readings_of_one_read_are_a_packet_period_apart() {
    let mut stream = packets(4);
    stream.extend([6, 6]);
    let mut source = open(ScriptedReads::new([Ok(stream)]));
    let period = Hc11Format::default().packet_period();
    std::thread::sleep(period * 6);
    let mut times = Vec::new();
    for _ in 0..4 {
        if let SourceEvent::Reading(reading) = source.next().unwrap() {
            times.push(reading.time.0);
        }
    }
    let gaps: Vec<u64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert_eq!(gaps.len(), 3);
    assert!(
        gaps.iter()
            .all(|&gap| gap.abs_diff(period.as_micros() as u64) <= 1),
        "{gaps:?}"
    );
}

/// The closing of a port.
#[derive(Default)]
struct Closing {
    may_end: AtomicBool,
    has_ended: AtomicBool,
}

/// Port of an absent device, whose reads fail and whose closing blocks until it may end.
struct BlockingPort(Arc<Closing>);

impl ByteStream for BlockingPort {}

impl Read for BlockingPort {
    fn read(&mut self, _: &mut [u8]) -> IoResult<usize> {
        Err(Error::from(ErrorKind::BrokenPipe))
    }
}

impl Drop for BlockingPort {
    fn drop(&mut self) {
        let start = Instant::now();
        while !self.0.may_end.load(Ordering::Relaxed) && start.elapsed() < TIMEOUT {
            std::thread::sleep(Duration::from_millis(1));
        }
        self.0.has_ended.store(true, Ordering::Relaxed);
    }
}

#[derive(Clone, Default)]
struct BlockingConnector(Arc<Closing>);

impl Connector for BlockingConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        Ok(Connection {
            bytes: Box::new(BlockingPort(self.0.clone())),
            readiness: None,
            endpoint: "port".to_owned(),
        })
    }
}

#[test]
fn a_port_that_blocks_while_closing_does_not_block_the_source() {
    let format = Hc11Format::default().into();
    let connector = BlockingConnector::default();
    let closing = connector.0.clone();
    let mut source = StreamSource::open("port".to_owned(), format, connector).unwrap();
    assert!(source.next().is_err());
    assert_eq!(source.next().unwrap(), SourceEvent::Idle);
    assert!(!closing.has_ended.load(Ordering::Relaxed), "it has waited");
    closing.may_end.store(true, Ordering::Relaxed);
}
