//! A byte stream as a source: decoding, time stamps and reconnection, common to all transports.

mod bit_rate;
mod feedback_line;
mod low_counts;
mod pending;
pub(super) mod unknown_bytes;
mod warnings;

use std::io::{Error, ErrorKind};
use std::time::{Duration, Instant};

use super::active_sender::SenderCount;
use super::cancel::CancelToken;
use super::connection::{
    Connection, Connector, READ_TIMEOUT, UNKNOWN_SENDER, close_on_thread, is_idle,
};
use super::event::NOISE_INTERVAL;
use super::feedback::FeedbackDevice;
use super::protocol::{Decoder, StreamFormat};
use super::reconnect::{BackOff, Reconnect, ReconnectEvent};
use super::sender_clock::{DEFAULT_MAX_AGE, SenderClock};
use super::{CaptureError, HeadsetList, Source, SourceEvent, SourceStats, SourceWait};
use ademan_core::hand::Side;
use feedback_line::FeedbackLine;
use pending::PendingReadings;
use unknown_bytes::UnknownBytes;

/// Source that decodes the bytes of a connection.
pub(super) struct StreamSource<C> {
    name: String,
    format: StreamFormat,
    connector: C,
    cancel: Option<CancelToken>,
    /// `true` if the caller waits for bytes; reads do not.
    is_polled: bool,
    /// `true` if the latest read may have left bytes behind.
    may_have_more: bool,
    /// Writes to the same connection, once it was [taken](Source::take_feedback_device).
    feedback: FeedbackLine,
    state: State,
    decoder: Box<dyn Decoder>,
    /// Reason why the rest of the stream cannot be decoded. Reported after the pending readings.
    format_error: Option<String>,
    buffer: Vec<u8>,
    pending: PendingReadings,
    unknown: UnknownBytes,
    /// `true` if a byte has arrived, or the person was warned that none does.
    has_first_byte: bool,
    last_received: Instant,
    /// Restarts only after a packet: a device that comes and goes is opened less and less often.
    back_off: BackOff,
    losses: u64,
    senders: SenderCount,
    /// Time at which a call returns although no reading is complete, so that the statistics since the last reading are reported.
    report_at: Option<Instant>,
}

enum State {
    Connected(Connection),
    Reconnecting(Reconnect),
    Ended,
}

impl<C: Connector> StreamSource<C> {
    /// Opens the connection for the first time. `name` is the source URI.
    pub fn open(
        name: String,
        format: StreamFormat,
        mut connector: C,
    ) -> Result<Self, CaptureError> {
        let connection = match connector.connect() {
            Ok(connection) => connection,
            Err(error) => {
                return Err(CaptureError::Open {
                    source_name: name,
                    reason: error.into_reason(),
                });
            }
        };
        let decoder = C::decoder(&format);
        // A packet that was pending may be complete with the first byte of a read.
        let max_packets = C::READ_BYTES / format.protocol.min_packet_bytes + 2;
        Ok(Self {
            name,
            connector,
            cancel: None,
            is_polled: false,
            may_have_more: false,
            feedback: FeedbackLine::default(),
            state: State::Connected(connection),
            decoder,
            format_error: None,
            buffer: vec![0; C::READ_BYTES],
            pending: PendingReadings::new(max_packets, C::IS_LIVE, &format),
            format,
            unknown: UnknownBytes::new(C::IS_DATAGRAM),
            has_first_byte: false,
            last_received: Instant::now(),
            back_off: BackOff::default(),
            losses: 0,
            senders: SenderCount::default(),
            report_at: None,
        })
    }

    /// Drops readings that were sent too long ago, if they state their time.
    pub fn drop_old_readings(mut self) -> Self {
        self.pending.sender = Some(SenderClock::new(DEFAULT_MAX_AGE));
        self
    }

    fn read(&mut self) -> Result<SourceEvent, CaptureError> {
        let timeout = self.read_timeout();
        let State::Connected(connection) = &mut self.state else {
            return Ok(SourceEvent::End);
        };
        let result = if self.is_polled {
            connection.read_available(&mut self.buffer)
        } else {
            connection.read(&mut self.buffer, self.cancel.as_ref(), timeout)
        };
        if self.report_at.is_some_and(|at| Instant::now() >= at) {
            self.report_at = None;
        }
        self.may_have_more = match &result {
            Ok(length) => C::IS_DATAGRAM || *length == self.buffer.len(),
            Err(error) => error.kind() == UNKNOWN_SENDER,
        };
        match result {
            Ok(0) => self.end_of_stream(),
            Ok(length) => self.handle_bytes(length),
            Err(error) if is_idle(error.kind()) => self.handle_silence(),
            Err(error) if C::HAS_SENDERS && error.kind() == UNKNOWN_SENDER => {
                let now = Instant::now();
                if self.senders.refuse(now) {
                    warnings::several_senders(&self.name);
                }
                self.report_at = Some(now + NOISE_INTERVAL);
                Ok(SourceEvent::Idle)
            }
            Err(error) if C::RECONNECTS => Err(self.lose(error.to_string())),
            // The writer of a pipe has closed its end.
            Err(error) if error.kind() == ErrorKind::BrokenPipe => self.end_of_stream(),
            Err(error) => Err(self.fail(&error)),
        }
    }

    /// Returns the longest wait of one read. `None` waits until cancellation.
    fn read_timeout(&self) -> Option<Duration> {
        match self.cancel {
            None => Some(READ_TIMEOUT),
            Some(_) => self
                .deadline()
                .map(|deadline| deadline.saturating_duration_since(Instant::now())),
        }
    }

    /// Returns the time at which silence has a meaning: a pause confirms a packet, the connection counts as lost, or a report is
    /// due.
    fn deadline(&self) -> Option<Instant> {
        let is_awaited = self.decoder.awaits_pause();
        let pause = self.format.pause_time().filter(|_| is_awaited);
        let first_byte = C::FIRST_BYTE_TIMEOUT.filter(|_| !self.has_first_byte);
        let timeout = pause.or(first_byte).or(C::IDLE_TIMEOUT);
        let silence = timeout.map(|timeout| self.last_received + timeout);
        silence.into_iter().chain(self.report_at).min()
    }

    /// Returns `true` if, at `now`, no byte has come for longer than the line needs for one.
    fn has_paused(&self, now: Instant) -> bool {
        let silence = now.saturating_duration_since(self.last_received);
        self.format
            .pause_time()
            .is_some_and(|pause| silence >= pause)
    }

    fn handle_bytes(&mut self, length: usize) -> Result<SourceEvent, CaptureError> {
        let now = Instant::now();
        self.forget_other_sender();
        // The line has paused, but no wait has noticed it. The pause confirms no packet, because this thread may have been late.
        if !self.decoder.awaits_pause() && self.has_paused(now) {
            self.decoder.pause(&mut |_| {});
        }
        self.last_received = now;
        self.has_first_byte = true;
        let received = self.decoder.stats().bytes + length as u64;
        let (format, pending) = (&self.format, &mut self.pending);
        let mut has_packet = false;
        let mut emit = |packet| {
            has_packet = true;
            pending.push(packet, now, received, format);
        };
        self.decoder.push(&self.buffer[..length], &mut emit);
        if C::IS_DATAGRAM {
            self.decoder.finish(&mut emit);
        }
        self.format_error = self.decoder.take_error();
        self.feedback.note(self.decoder.feedback());
        self.judge_bytes(now, has_packet, length);
        match &mut self.state {
            State::Connected(connection) if has_packet => {
                self.senders.note(connection.bytes.accept_sender());
            }
            _ => {
                self.report_at = Some(now + NOISE_INTERVAL);
                self.pending.note_refused(now, self.decoder.stats().invalid);
            }
        }
        self.pending.warn(&self.name);
        if C::IS_LIVE && self.decoder.take_restart() {
            self.losses += 1;
            return Err(CaptureError::Interrupted {
                source_name: self.name.clone(),
                reason: "it sent text, as a board does that restarts".to_owned(),
            });
        }
        Ok(self.pending.pop().unwrap_or(SourceEvent::Idle))
    }

    /// Forgets what another sender has sent before the bytes that were just read: one packet never holds bytes of two.
    fn forget_other_sender(&mut self) {
        if let State::Connected(connection) = &mut self.state
            && connection.bytes.take_sender_change()
        {
            self.decoder.reset();
            if let Some(sender) = &mut self.pending.sender {
                sender.reset();
            }
        }
    }

    /// Handles the first `length` bytes of the buffer, which arrived at `now`: warns if bytes have formed no packet for too long. A
    /// packet resets the back-off.
    fn judge_bytes(&mut self, now: Instant, has_packet: bool, length: usize) {
        if self.unknown.update(now, has_packet, &self.buffer[..length]) {
            let likely = self.unknown.likely_format(&self.format);
            warnings::garbage(&self.name, &*self.decoder, likely, &self.format);
        }
        if let Some(error) = self.decoder.last_error()
            && self.unknown.update_invalid(now, &self.decoder.stats())
        {
            warnings::nearly_all_invalid(&self.name, error);
        }
        if has_packet {
            self.back_off = BackOff::default();
        }
    }

    fn handle_silence(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.decoder.awaits_pause() && self.has_paused(Instant::now()) {
            let (format, pending) = (&self.format, &mut self.pending);
            let (now, received) = (self.last_received, self.decoder.stats().bytes);
            let mut has_packet = false;
            self.decoder.pause(&mut |packet| {
                has_packet = true;
                pending.push(packet, now, received, format);
            });
            self.judge_bytes(now, has_packet, 0);
            return Ok(self.pending.pop().unwrap_or(SourceEvent::Idle));
        }
        if let Some(timeout) = C::FIRST_BYTE_TIMEOUT
            && !self.has_first_byte
            && self.last_received.elapsed() >= timeout
        {
            self.has_first_byte = true;
            warnings::no_byte::<C>(&self.name, timeout);
        }
        match C::IDLE_TIMEOUT {
            Some(timeout) if self.last_received.elapsed() >= timeout => {
                Err(self.lose(format!("nothing was received for {} s", timeout.as_secs())))
            }
            _ => Ok(SourceEvent::Idle),
        }
    }

    fn end_of_stream(&mut self) -> Result<SourceEvent, CaptureError> {
        if C::RECONNECTS {
            return Err(self.lose("the device has closed the connection".to_owned()));
        }
        self.state = State::Ended;
        let received = self.decoder.stats().bytes;
        let (format, pending) = (&self.format, &mut self.pending);
        let now = Instant::now();
        let mut emit = |packet| pending.push(packet, now, received, format);
        if C::IS_LIVE {
            self.decoder.finish_cut(&mut emit)
        } else {
            self.decoder.finish(&mut emit)
        }
        self.format_error = self.decoder.take_error();
        if let Some(reading) = self.pending.pop() {
            return Ok(reading);
        }
        match self.format_error.take() {
            Some(reason) => Err(self.fail_to_decode(reason)),
            None => {
                self.warn_if_nothing_was_valid();
                Ok(SourceEvent::End)
            }
        }
    }

    fn warn_if_nothing_was_valid(&self) {
        if self.decoder.stats().readings > 0 {
            return;
        }
        let likely = self.unknown.likely_format(&self.format);
        if likely.is_some() || self.decoder.last_error().is_some() {
            warnings::nothing_valid(&self.name, self.decoder.last_error(), likely);
        }
    }

    /// Handles an error after which the stream cannot be decoded.
    fn fail_to_decode(&mut self, reason: String) -> CaptureError {
        if C::RECONNECTS {
            return self.lose(reason);
        }
        self.state = State::Ended;
        CaptureError::Malformed {
            source_name: self.name.clone(),
            reason,
        }
    }

    fn fail(&mut self, error: &Error) -> CaptureError {
        self.state = State::Ended;
        CaptureError::Malformed {
            source_name: self.name.clone(),
            reason: format!(
                "reading stopped after {} bytes: {error}",
                self.decoder.stats().bytes
            ),
        }
    }

    fn lose(&mut self, reason: String) -> CaptureError {
        self.losses += 1;
        self.decoder.reset();
        self.may_have_more = false;
        self.format_error = None;
        self.unknown.clear();
        if let Some(sender) = &mut self.pending.sender {
            sender.reset();
        }
        let reconnecting = State::Reconnecting(self.start_reconnect());
        let writer = self.feedback.device().map(FeedbackDevice::disconnect);
        if let State::Connected(lost) = std::mem::replace(&mut self.state, reconnecting) {
            close_on_thread((lost, writer));
        }
        CaptureError::Lost {
            source_name: self.name.clone(),
            reason,
        }
    }

    fn start_reconnect(&mut self) -> Reconnect {
        let back_off = self.back_off.clone();
        self.back_off.next_interval();
        Reconnect::start(self.connector.clone(), back_off)
    }

    fn wait_for_connection(&mut self) -> SourceEvent {
        let State::Reconnecting(reconnect) = &self.state else {
            return SourceEvent::Idle;
        };
        let event = if self.is_polled {
            reconnect.try_event()
        } else {
            reconnect.wait(self.cancel.as_ref())
        };
        match event {
            ReconnectEvent::Idle => {}
            ReconnectEvent::Unusable(reason) => {
                tracing::warn!(
                    source = self.name,
                    "cannot reconnect to {}: {reason}",
                    self.name
                );
            }
            ReconnectEvent::Stopped => {
                self.state = State::Reconnecting(self.start_reconnect());
            }
            ReconnectEvent::Connected(connection)
                if self.is_polled && !connection.can_be_polled() =>
            {
                tracing::warn!(source = self.name, "out of file descriptors; trying again");
                self.state = State::Reconnecting(self.start_reconnect());
            }
            ReconnectEvent::Connected(connection) => self.use_connection(connection),
        }
        SourceEvent::Idle
    }

    fn use_connection(&mut self, connection: Connection) {
        let (name, endpoint) = (&self.name, &connection.endpoint);
        tracing::info!(source = name, "reconnected to {name} at {endpoint}");
        self.last_received = Instant::now();
        if let Some(device) = self.feedback.device() {
            device.connect(connection.bytes.writer());
        }
        self.state = State::Connected(connection);
    }
}

impl<C: Connector> Source for StreamSource<C> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if let Some(reading) = self.pending.pop() {
            return Ok(reading);
        }
        if let Some(reason) = self.format_error.take() {
            return Err(self.fail_to_decode(reason));
        }
        match &self.state {
            State::Connected(_) => self.read(),
            State::Reconnecting(_) => Ok(self.wait_for_connection()),
            State::Ended => Ok(SourceEvent::End),
        }
    }

    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        self.cancel = Some(cancel.clone());
    }

    fn set_polled(&mut self) -> bool {
        let State::Connected(connection) = &self.state else {
            return false;
        };
        self.is_polled = C::IS_LIVE && connection.can_be_polled();
        self.is_polled
    }

    fn wait(&self) -> Option<SourceWait<'_>> {
        let has_event =
            self.may_have_more || self.format_error.is_some() || !self.pending.readings.is_empty();
        match &self.state {
            _ if has_event => None,
            State::Connected(connection) => Some(SourceWait {
                readiness: connection.readiness.as_ref(),
                deadline: self.deadline(),
            }),
            State::Reconnecting(reconnect) => Some(reconnect.source_wait()),
            State::Ended => None,
        }
    }

    fn take_feedback_device(&mut self, _side: Side) -> Option<FeedbackDevice> {
        let format = self.format.protocol.feedback?;
        let State::Connected(connection) = &self.state else {
            return None;
        };
        self.feedback.take(format, || connection.bytes.writer())
    }

    fn set_max_age(&mut self, age: Duration) {
        if let Some(sender) = &mut self.pending.sender {
            sender.set_max_age(age);
        }
    }

    fn headsets(&self) -> Option<HeadsetList> {
        self.connector.headsets()
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn packet_period(&self) -> Option<Duration> {
        self.format.packet_period()
    }

    fn is_live(&self) -> bool {
        C::IS_LIVE
    }

    fn stats(&self) -> SourceStats {
        let decoded = self.decoder.stats();
        // Bytes before the first packet that may be its start count as skipped: a stream without line ends has no other ones.
        let unfinished = if decoded.readings == 0 {
            self.decoder.pending_bytes() as u64
        } else {
            0
        };
        SourceStats {
            skipped_bytes: decoded.skipped_bytes + unfinished,
            readings: decoded.readings
                - self.pending.readings.len() as u64
                - self.pending.too_old.total(),
            losses: self.losses,
            sender_changes: self.senders.changes(),
            invalid: decoded.invalid + self.senders.refused() + self.pending.too_old,
            ..decoded
        }
    }
}

#[cfg(test)]
mod tests;
