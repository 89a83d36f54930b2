//! A line of bytes as a source: decoding, time stamps and loss, the same for serial ports, TCP and files.

use std::io::ErrorKind;
use std::time::{Duration, Instant};

use arrayvec::ArrayVec;

use super::cancel::CancelToken;
use super::garbage::GarbageDetector;
use super::hc11::{self, BODY_BYTES, Hc11Decoder, PACKET_BYTES};
use super::packet_clock::PacketClock;
use super::reconnect::{BackOff, Reconnect, ReconnectEvent};
use super::transport::{Connection, Connector, READ_TIMEOUT};
use super::uri::StreamOptions;
use super::{CaptureError, Reading, Sample, Source, SourceEvent, SourceStats};
use crate::time::Timestamp;

/// Bytes that one read takes at most.
const READ_BYTES: usize = 512;
/// With the 67 bytes that may wait in the decoder, one read completes no more frames.
const FRAMES_PER_READ: usize = (READ_BYTES + 67) / PACKET_BYTES + 1;

/// The source that decodes what a line brings.
pub(super) struct StreamSource<C> {
    name: String,
    settings: StreamOptions,
    connector: C,
    interrupt: Option<CancelToken>,
    state: State,
    decoder: Hc11Decoder,
    buffer: [u8; READ_BYTES],
    pending: ArrayVec<Reading, FRAMES_PER_READ>,
    clock: PacketClock,
    garbage: GarbageDetector,
    heard: Instant,
    /// Starts over only when a frame has come in: a device that comes and goes is asked less and less often.
    back_off: BackOff,
    losses: u64,
}

enum State {
    Connected(Connection),
    Searching(Reconnect),
    Ended,
}

impl<C: Connector> StreamSource<C> {
    /// Opens the line for the first time.
    pub fn open(
        name: String,
        settings: StreamOptions,
        mut connector: C,
    ) -> Result<Self, CaptureError> {
        let connection = match connector.connect() {
            Ok(connection) => connection,
            Err(refusal) => {
                return Err(CaptureError::Open {
                    source_name: name,
                    reason: refusal.into_reason(),
                });
            }
        };
        Ok(Self {
            name,
            settings,
            connector,
            interrupt: None,
            state: State::Connected(connection),
            decoder: Hc11Decoder::new(settings.framing),
            buffer: [0; READ_BYTES],
            pending: ArrayVec::new(),
            clock: PacketClock::new(C::IS_LIVE),
            garbage: GarbageDetector::default(),
            heard: Instant::now(),
            back_off: BackOff::default(),
            losses: 0,
        })
    }

    fn listen(&mut self) -> Result<SourceEvent, CaptureError> {
        let patience = self.patience();
        let State::Connected(connection) = &mut self.state else {
            return Ok(SourceEvent::End);
        };
        let interrupt = self.interrupt.as_ref();
        match connection.read(&mut self.buffer, interrupt, patience) {
            Ok(0) => self.over(),
            Ok(length) => self.take(length),
            Err(error) if is_quiet(error.kind()) => self.be_patient(),
            Err(error) if C::IS_LIVE => Err(self.lose(error.to_string())),
            Err(error) => {
                self.state = State::Ended;
                Err(CaptureError::Malformed {
                    source_name: self.name.clone(),
                    reason: format!(
                        "reading stopped after {} bytes: {error}",
                        self.decoder.stats().bytes
                    ),
                })
            }
        }
    }

    /// How long one read may wait; `None`: until it is interrupted.
    fn patience(&self) -> Option<Duration> {
        match self.interrupt {
            None => Some(READ_TIMEOUT),
            Some(_) => C::IDLE_TIMEOUT.map(|limit| limit.saturating_sub(self.heard.elapsed())),
        }
    }

    fn take(&mut self, length: usize) -> Result<SourceEvent, CaptureError> {
        let now = Instant::now();
        self.heard = now;
        let pending = &mut self.pending;
        self.decoder.push(&self.buffer[..length], &mut |body| {
            pending.push(reading(body))
        });
        self.stamp(now);
        if self.garbage.is_due(now, self.pending.is_empty()) {
            tracing::warn!(
                "no valid frame from {} for {} s, check baud and protocol",
                self.name,
                GarbageDetector::LIMIT.as_secs()
            );
        }
        if !self.pending.is_empty() {
            self.back_off = BackOff::default();
        }
        if C::IS_LIVE && self.decoder.take_text() {
            self.losses += 1;
            return Err(CaptureError::Interrupted {
                source_name: self.name.clone(),
                reason: "text came in between, as from a board that starts anew".to_owned(),
            });
        }
        Ok(self.next_pending().unwrap_or(SourceEvent::Idle))
    }

    /// Dates each frame back by what came after it.
    fn stamp(&mut self, now: Instant) {
        let frames = self.pending.len();
        for (index, reading) in self.pending.iter_mut().enumerate() {
            let bytes_after = (frames - 1 - index) * PACKET_BYTES + self.decoder.pending_bytes();
            reading.time = self.clock.stamp(now, bytes_after, &self.settings);
        }
    }

    fn next_pending(&mut self) -> Option<SourceEvent> {
        self.pending.pop_at(0).map(SourceEvent::Reading)
    }

    fn over(&mut self) -> Result<SourceEvent, CaptureError> {
        if C::IS_LIVE {
            return Err(self.lose("the device has closed the line".to_owned()));
        }
        self.state = State::Ended;
        let pending = &mut self.pending;
        self.decoder.finish(&mut |body| pending.push(reading(body)));
        self.stamp(Instant::now());
        Ok(self.next_pending().unwrap_or(SourceEvent::End))
    }

    fn be_patient(&mut self) -> Result<SourceEvent, CaptureError> {
        match C::IDLE_TIMEOUT {
            Some(limit) if self.heard.elapsed() >= limit => {
                Err(self.lose(format!("nothing came for {} s", limit.as_secs())))
            }
            _ => Ok(SourceEvent::Idle),
        }
    }

    fn lose(&mut self, reason: String) -> CaptureError {
        self.losses += 1;
        self.decoder.reset();
        self.garbage = GarbageDetector::default();
        let search = self.start_search();
        if let State::Connected(dead) = std::mem::replace(&mut self.state, State::Searching(search))
        {
            close_elsewhere(dead);
        }
        CaptureError::Lost {
            source_name: self.name.clone(),
            reason,
        }
    }

    fn start_search(&mut self) -> Reconnect {
        let back_off = self.back_off.clone();
        self.back_off.next_interval();
        Reconnect::start(self.connector.clone(), back_off)
    }

    fn look(&mut self) -> SourceEvent {
        let State::Searching(search) = &self.state else {
            return SourceEvent::Idle;
        };
        match search.wait(self.interrupt.as_ref()) {
            ReconnectEvent::Idle => {}
            ReconnectEvent::Refused(reason) => {
                tracing::warn!("cannot take up {} again: {reason}", self.name);
            }
            ReconnectEvent::Stopped => {
                let search = self.start_search();
                self.state = State::Searching(search);
            }
            ReconnectEvent::Connected(connection) => {
                tracing::info!("{} is back as {}", self.name, connection.endpoint);
                self.heard = Instant::now();
                self.state = State::Connected(connection);
            }
        }
        SourceEvent::Idle
    }
}

impl<C: Connector> Source for StreamSource<C> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if let Some(reading) = self.next_pending() {
            return Ok(reading);
        }
        match &self.state {
            State::Connected(_) => self.listen(),
            State::Searching(_) => Ok(self.look()),
            State::Ended => Ok(SourceEvent::End),
        }
    }

    fn set_cancel_token(&mut self, interrupt: &CancelToken) {
        self.interrupt = Some(interrupt.clone());
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn packet_period(&self) -> Option<Duration> {
        Some(self.settings.packet_period())
    }

    fn is_live(&self) -> bool {
        C::IS_LIVE
    }

    fn stats(&self) -> SourceStats {
        let decoded = self.decoder.stats();
        SourceStats {
            readings: decoded.readings - self.pending.len() as u64,
            losses: self.losses,
            ..decoded
        }
    }
}

fn reading(body: &[u8; BODY_BYTES]) -> Reading {
    Reading {
        time: Timestamp::default(),
        side: None,
        sample: Sample::Channels(hc11::channels(body)),
    }
}

fn is_quiet(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::Interrupted | ErrorKind::WouldBlock | ErrorKind::TimedOut
    )
}

/// Closes on a thread of its own: closing a port whose device is gone can block for long.
fn close_elsewhere(dead: Connection) {
    let closing = std::thread::Builder::new()
        .name("closing".to_owned())
        .spawn(move || drop(dead));
    if let Err(error) = closing {
        tracing::debug!("no thread for closing, closed in place: {error}");
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;
    use std::io::{Error, Read, Result as IoResult};
    use std::sync::{Arc, Mutex};

    use super::*;
    use crate::capture::hc11::{Framing, encode};
    use crate::capture::transport::ConnectError;

    const LIMIT: Duration = Duration::from_secs(20);

    /// What each read gives in turn; when all is read, the line is at its end.
    #[derive(Clone, Default)]
    struct Script {
        reads: Arc<Mutex<VecDeque<IoResult<Vec<u8>>>>>,
        asked: Arc<Mutex<usize>>,
    }

    impl Script {
        fn new(reads: impl IntoIterator<Item = IoResult<Vec<u8>>>) -> Self {
            Self {
                reads: Arc::new(Mutex::new(reads.into_iter().collect())),
                asked: Arc::default(),
            }
        }
    }

    impl Read for Script {
        fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
            *self.asked.lock().unwrap() += 1;
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

    impl Connector for Script {
        const IS_LIVE: bool = true;

        fn connect(&mut self) -> Result<Connection, ConnectError> {
            Ok(Connection {
                bytes: Box::new(self.clone()),
                readiness: None,
                endpoint: "script".to_owned(),
            })
        }
    }

    fn open(script: Script) -> StreamSource<Script> {
        StreamSource::open("script".to_owned(), StreamOptions::default(), script).unwrap()
    }

    fn frames(count: u8) -> Vec<u8> {
        (0..count)
            .flat_map(|number| encode(Framing::Double06, &[100 + number; BODY_BYTES]))
            .collect()
    }

    /// Asks until the script has been read to its end twice, and tells what came.
    fn hear(source: &mut StreamSource<Script>) -> Vec<String> {
        let mut heard = Vec::new();
        let start = Instant::now();
        while source.losses < 2 && start.elapsed() < LIMIT {
            match source.next() {
                Ok(SourceEvent::Idle) => {}
                Ok(SourceEvent::End) => heard.push("end".to_owned()),
                Ok(SourceEvent::Reading(reading)) => {
                    let Sample::Channels(channels) = reading.sample else {
                        panic!("the stream has channels");
                    };
                    heard.push(channels.counts[0].to_string());
                }
                Err(error) => heard.push(error.to_string()),
            }
        }
        heard
    }

    #[test]
    fn interruptions_and_timeouts_are_quiet_and_lose_nothing() {
        let mut stream = frames(2);
        stream.extend([6, 6]);
        let kinds = [
            ErrorKind::Interrupted,
            ErrorKind::WouldBlock,
            ErrorKind::TimedOut,
        ];
        let storm = (0..300).map(|turn| Err(Error::from(kinds[turn % 3])));
        let (head, tail) = stream.split_at(40);
        let reads = [Ok(head.to_vec())]
            .into_iter()
            .chain(storm)
            .chain([Ok(tail.to_vec())]);
        let mut source = open(Script::new(reads));
        let mut seen = Vec::new();
        for _ in 0..303 {
            seen.push(source.next().unwrap());
        }
        assert_eq!(
            seen.iter()
                .filter(|capture| **capture != SourceEvent::Idle)
                .count(),
            2
        );
        assert_eq!(source.stats().losses, 0);
    }

    #[test]
    fn the_end_of_a_live_line_is_a_loss_told_once_and_never_a_spin() {
        let script = Script::default();
        let asked = script.asked.clone();
        let mut source = open(script);
        let start = Instant::now();
        let mut losses = 0;
        while start.elapsed() < Duration::from_secs(1) {
            match source.next() {
                Ok(capture) => assert_eq!(capture, SourceEvent::Idle),
                Err(error) => {
                    losses += 1;
                    assert!(error.is_recoverable());
                }
            }
        }
        let reads = *asked.lock().unwrap();
        // At 0, 0.1, 0.3 and 0.7 s, for want of a frame in between.
        assert!((2..=4).contains(&reads), "{reads}");
        assert_eq!((losses, source.stats().losses), (reads, reads as u64));
    }

    #[test]
    fn every_other_error_is_a_loss_and_halves_around_it_are_not_joined() {
        let mut stream = frames(3);
        stream.extend([6, 6]);
        let reads = [
            Ok(stream[..90].to_vec()),
            Err(Error::from(ErrorKind::BrokenPipe)),
            Ok(stream[90..].to_vec()),
        ];
        let mut source = open(Script::new(reads));
        let heard = hear(&mut source);
        assert_eq!(heard[0], "100");
        assert_eq!(heard[1], "lost script: broken pipe; looking for it");
        assert_eq!(heard[2], "102");
        assert_eq!(
            heard[3],
            "lost script: the device has closed the line; looking for it"
        );
        let counts = source.stats();
        assert_eq!(counts.bytes, 200);
        assert_eq!(counts.bytes, 66 * counts.readings + counts.skipped_bytes);
    }

    #[test]
    fn a_burst_gives_readings_a_frame_apart() {
        let mut stream = frames(4);
        stream.extend([6, 6]);
        let mut source = open(Script::new([Ok(stream)]));
        std::thread::sleep(source.settings.packet_period() * 6);
        let mut times = Vec::new();
        for _ in 0..4 {
            if let SourceEvent::Reading(reading) = source.next().unwrap() {
                times.push(reading.time.0);
            }
        }
        let gaps: Vec<u64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let period = source.settings.packet_period().as_micros() as u64;
        assert_eq!(gaps.len(), 3);
        assert!(
            gaps.iter().all(|&gap| gap.abs_diff(period) <= 1),
            "{gaps:?}"
        );
    }

    /// A port whose device is gone, and that takes long to close.
    struct Sticky;

    impl Read for Sticky {
        fn read(&mut self, _: &mut [u8]) -> IoResult<usize> {
            Err(Error::from(ErrorKind::BrokenPipe))
        }
    }

    impl Drop for Sticky {
        fn drop(&mut self) {
            std::thread::sleep(Duration::from_secs(4));
        }
    }

    #[derive(Clone)]
    struct StickyPort;

    impl Connector for StickyPort {
        const IS_LIVE: bool = true;

        fn connect(&mut self) -> Result<Connection, ConnectError> {
            Ok(Connection {
                bytes: Box::new(Sticky),
                readiness: None,
                endpoint: "sticky".to_owned(),
            })
        }
    }

    #[test]
    fn a_dead_port_that_blocks_at_closing_keeps_nobody_waiting() {
        let settings = StreamOptions::default();
        let mut source = StreamSource::open("sticky".to_owned(), settings, StickyPort).unwrap();
        let start = Instant::now();
        assert!(source.next().is_err());
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
        assert!(
            start.elapsed() < Duration::from_secs(2),
            "{:?}",
            start.elapsed()
        );
    }
}
