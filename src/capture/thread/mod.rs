//! Source on its own thread, behind a bounded channel.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{JoinHandle, Thread};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded, select};

use super::cancel::{CancelHandle, cancel_token};
use super::suspend::SuspendDetector;
use super::{CancelToken, CaptureError, Reading, Source, SourceEvent, SourceStats};
use crate::advice;
use crate::command::Command;
use crate::time::Timestamp;

/// Message of a capture thread.
///
/// After [`Failed`](Self::Failed) or [`End`](Self::End) the channel is disconnected. A thread that is stopped by
/// dropping its [`CaptureThread`] sends neither.
#[expect(
    clippy::large_enum_variant,
    reason = "a reading is passed on without an allocation"
)]
#[derive(Clone, Debug)]
pub enum CaptureEvent {
    /// A reading.
    Reading {
        /// The sensor values.
        reading: Reading,
        /// Time at which the capture thread received it.
        received_at: Instant,
        /// Statistics up to and including this reading.
        stats: SourceStats,
    },
    /// A command that a recorded session executed between two readings.
    Command(Command),
    /// The [clock](Source::clock) of a source that waits: no reading precedes this time.
    Elapsed(Timestamp),
    /// Bytes arrive, but none of them belongs to a reading. Sent at most twice a second.
    Noise(SourceStats),
    /// The device was lost and the source reconnects, or the readings were interrupted. Never dropped, and always
    /// before the readings that follow it.
    Lost(CaptureError),
    /// The source failed permanently or panicked.
    Failed(CaptureError),
    /// End of the readings.
    End(SourceStats),
}

/// Capacity of the channel: a pause of 90 ms at 115 200 baud. Older readings no longer show the hand as it is.
const QUEUE_CAPACITY: usize = 16;

/// Shortest time between two [`CaptureEvent::Noise`].
const NOISE_INTERVAL: Duration = Duration::from_millis(500);

/// Longest time that dropping a [`CaptureThread`] waits for its thread. A source that blocks longer is left behind.
const JOIN_TIMEOUT: Duration = Duration::from_secs(1);

/// A source that runs on its own thread.
///
/// Dropping it stops the thread: at once if the source uses its [cancel token](Source::set_cancel_token), otherwise
/// within [`MAX_BLOCK`](super::MAX_BLOCK). It waits for at most one second.
#[derive(Debug)]
pub struct CaptureThread {
    events: Receiver<CaptureEvent>,
    name: String,
    packet_period: Option<Duration>,
    is_live: bool,
    /// Cancels the source when it is dropped.
    cancel: Option<CancelHandle>,
    /// Disconnected when the thread has ended.
    ended: Receiver<()>,
    thread: Option<JoinHandle<()>>,
}

/// Runs `source` on its own thread.
///
/// If the consumer is slow, a [live](Source::is_live) source drops its oldest readings and counts them in
/// [`SourceStats::dropped`]; any other source waits.
pub fn spawn(mut source: impl Source + 'static) -> Result<CaptureThread, CaptureError> {
    let name = source.name().to_owned();
    let packet_period = source.packet_period();
    let is_live = source.is_live();
    let open_error = |reason: String| CaptureError::Open {
        source_name: name.clone(),
        reason,
    };
    let no_pipe = |error| format!("no pipe for it: {error}; close other programs");
    let (cancel, token) = cancel_token().map_err(|error| open_error(no_pipe(error)))?;
    source.set_cancel_token(&token);
    let (sender, events) = bounded(QUEUE_CAPACITY);
    let (end_of_thread, ended) = bounded(0);
    let mut sender = EventSender {
        sender,
        queue: events.clone(),
        is_live,
        cancel: token,
        dropped: 0,
        consumer: ConsumerThread(std::thread::current()),
    };
    let source_name = name.clone();
    let run = move || {
        let _disconnects_at_the_end: Sender<()> = end_of_thread;
        capture(source, source_name, &mut sender);
    };
    let thread = std::thread::Builder::new()
        .name("capture".to_owned())
        .spawn(run);
    let thread = thread.map_err(|error| open_error(advice::no_thread(&error).to_string()))?;
    Ok(CaptureThread {
        events,
        name,
        packet_period,
        is_live,
        cancel: Some(cancel),
        ended,
        thread: Some(thread),
    })
}

impl CaptureThread {
    /// Returns the channel of events. With each event, and at the end, the thread that called [`spawn`] is
    /// [unparked](std::thread::Thread::unpark), so that it may wait by parking.
    pub fn events(&self) -> &Receiver<CaptureEvent> {
        &self.events
    }

    /// Returns the [name](Source::name) of the source.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the [shortest time between two readings](Source::packet_period).
    pub fn packet_period(&self) -> Option<Duration> {
        self.packet_period
    }

    /// Returns `true` if the source is [live](Source::is_live).
    pub fn is_live(&self) -> bool {
        self.is_live
    }
}

impl Drop for CaptureThread {
    fn drop(&mut self) {
        self.cancel = None;
        if self.ended.recv_timeout(JOIN_TIMEOUT) == Err(RecvTimeoutError::Timeout) {
            let name = &self.name;
            tracing::warn!(
                source = name,
                "{name} does not stop, its thread is left behind"
            );
            return;
        }
        if let Some(thread) = self.thread.take() {
            // The thread catches the panics of its source, so the result holds nothing.
            let _ = thread.join();
        }
    }
}

/// Runs the source and sends a panic as a failure.
fn capture(source: impl Source, name: String, sender: &mut EventSender) {
    let result = catch_unwind(AssertUnwindSafe(|| {
        run(source, &mut SuspendDetector::default(), sender);
    }));
    if let Err(panic) = result {
        sender.send(|_| {
            CaptureEvent::Failed(CaptureError::Malformed {
                source_name: name,
                reason: format!("it panicked: {}; please report this", panic_text(&*panic)),
            })
        });
    }
}

fn run(mut source: impl Source, suspend: &mut SuspendDetector, sender: &mut EventSender) {
    let mut suspends = 0;
    let (mut reported_at, mut reported_bytes) = (Instant::now(), 0);
    while !sender.cancel.is_cancelled() {
        let event = source.next();
        if sender.is_live && suspend.was_suspended() {
            // The clock of the readings stands still during a suspend, so no later stage can detect it.
            suspends += 1;
            sender.send_suspend(source.name());
        }
        if let (Ok(SourceEvent::Idle), Some(time)) = (&event, source.clock()) {
            sender.send(|_| CaptureEvent::Elapsed(time));
        }
        let stats = || {
            let stats = source.stats();
            SourceStats {
                losses: stats.losses + suspends,
                ..stats
            }
        };
        match event {
            Ok(SourceEvent::Idle) if reported_at.elapsed() < NOISE_INTERVAL => {}
            Ok(SourceEvent::Idle) => {
                reported_at = Instant::now();
                let stats = stats();
                if std::mem::replace(&mut reported_bytes, stats.bytes) < stats.bytes {
                    sender.send(|dropped| CaptureEvent::Noise(SourceStats { dropped, ..stats }));
                }
            }
            Ok(SourceEvent::Reading(reading)) => {
                let received_at = Instant::now();
                let stats = stats();
                (reported_at, reported_bytes) = (received_at, stats.bytes);
                sender.send(|dropped| CaptureEvent::Reading {
                    reading,
                    received_at,
                    stats: SourceStats { dropped, ..stats },
                });
            }
            Ok(SourceEvent::Command(command)) => sender.send(|_| CaptureEvent::Command(command)),
            Ok(SourceEvent::End) => {
                let stats = stats();
                sender.send(|dropped| CaptureEvent::End(SourceStats { dropped, ..stats }));
                return;
            }
            Err(error) if error.is_recoverable() => sender.send(|_| CaptureEvent::Lost(error)),
            Err(error) => {
                sender.send(|_| CaptureEvent::Failed(error));
                return;
            }
        }
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no text")
}

/// Sending end of the channel. No other thread sends, so room that was made stays.
struct EventSender {
    sender: Sender<CaptureEvent>,
    /// Receiver of the same channel, which removes the oldest events.
    queue: Receiver<CaptureEvent>,
    is_live: bool,
    cancel: CancelToken,
    dropped: u64,
    // Declared after `sender`: the consumer is woken when the channel is already disconnected.
    consumer: ConsumerThread,
}

/// Thread of the consumer, which may be parked. Unparking takes no lock; waking it through the channel would take
/// one that it needs itself at once.
struct ConsumerThread(Thread);

impl ConsumerThread {
    fn unpark(&self) {
        self.0.unpark();
    }
}

impl Drop for ConsumerThread {
    fn drop(&mut self) {
        self.unpark();
    }
}

impl EventSender {
    /// Sends the event that `event` creates from the number of dropped readings.
    fn send(&mut self, event: impl FnOnce(u64) -> CaptureEvent) {
        if self.is_live {
            self.make_room();
        }
        if let Err(TrySendError::Full(event)) = self.sender.try_send(event(self.dropped)) {
            select! {
                send(self.sender, event) -> _ => {}
                recv(self.cancel.channel()) -> _ => {}
            }
        }
        self.consumer.unpark();
    }

    fn send_suspend(&mut self, source_name: &str) {
        self.send(|_| {
            CaptureEvent::Lost(CaptureError::Interrupted {
                source_name: source_name.to_owned(),
                reason: "the system was suspended".to_owned(),
            })
        });
    }

    fn make_room(&mut self) {
        while self.sender.is_full() {
            match self.queue.try_recv() {
                Ok(CaptureEvent::Reading { .. }) => self.dropped += 1,
                // The statistics of later events include these.
                Ok(CaptureEvent::Noise(_) | CaptureEvent::Elapsed(_)) => {}
                Ok(loss) => self.keep_last_loss(loss),
                // The consumer was faster.
                Err(_) => {}
            }
        }
    }

    /// Drops all queued events except the last loss, which must stay before the readings that follow it.
    fn keep_last_loss(&mut self, mut loss: CaptureEvent) {
        while let Ok(event) = self.queue.try_recv() {
            match event {
                CaptureEvent::Reading { .. } => self.dropped += 1,
                CaptureEvent::Noise(_) | CaptureEvent::Elapsed(_) => {}
                later => loss = later,
            }
        }
        // There is room: the channel was empty a moment ago and no other thread sends.
        let _ = self.sender.try_send(loss);
    }
}

#[cfg(test)]
mod tests;
