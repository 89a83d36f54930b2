//! A source on its own thread, behind a bounded channel.

use std::thread::{JoinHandle, Thread};
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded, select};

use super::cancel::{CancelHandle, cancel_token};
use super::event::{CaptureEvent, EventSource};
use super::event_queue::{EventChannel, EventQueue};
use super::{CancelToken, CaptureError, Source};
use crate::advice;

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
/// [`SourceStats::dropped`](super::SourceStats::dropped); any other source waits.
pub fn spawn(source: impl Source + 'static) -> Result<CaptureThread, CaptureError> {
    start(source, false)
}

/// Runs `source` as [`spawn`] does, and sends readings that are [ready](Source::is_ready) together in one event: one event and
/// one wake-up per reading would take longer than a step of the pipeline.
pub fn spawn_batched(source: impl Source + 'static) -> Result<CaptureThread, CaptureError> {
    start(source, true)
}

fn start(
    mut source: impl Source + 'static,
    is_batched: bool,
) -> Result<CaptureThread, CaptureError> {
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
    let queue = EventQueue::new(EventChannel::new(is_live), is_live);
    let events = queue.buffer.receiver().clone();
    let (end_of_thread, ended) = bounded(0);
    let mut sender = EventSender {
        queue,
        cancel: token,
        consumer: ConsumerThread(std::thread::current()),
    };
    let run = move || {
        let _disconnects_at_the_end: Sender<()> = end_of_thread;
        let source = EventSource::new(source);
        if is_batched {
            capture(source.with_batches(), &mut sender)
        } else {
            capture(source, &mut sender)
        }
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
    /// Returns the channel of events, which is disconnected after the last one. With each event, and at the end, the thread
    /// that called [`spawn`] is [unparked](std::thread::Thread::unpark), so that it may wait by parking.
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

    /// Stops the source and waits for the end of its thread, as dropping does. If packets of a live source were refused
    /// since the latest statistics, its last event has them.
    pub fn stop(&mut self) {
        if self.cancel.take().is_some() {
            let _ = self.ended.recv_timeout(JOIN_TIMEOUT);
        }
    }
}

impl Drop for CaptureThread {
    fn drop(&mut self) {
        self.stop();
        if self.ended.try_recv() == Err(TryRecvError::Empty) {
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

fn capture(mut source: EventSource<impl Source>, sender: &mut EventSender) {
    while !sender.cancel.is_cancelled() {
        if !source.next(&mut |event| sender.send(event)) {
            return;
        }
    }
    // The queue of a live source has room for every event.
    if source.source.is_live()
        && let Some(stats) = source.stop()
    {
        sender.send(CaptureEvent::Noise(stats));
    }
}

/// Sending end of the channel.
struct EventSender {
    queue: EventQueue<EventChannel>,
    cancel: CancelToken,
    // Declared after `queue`: the consumer is woken when the channel is already disconnected.
    consumer: ConsumerThread,
}

/// Thread of the consumer, which may be parked. Unparking takes no lock; a wake-up through the channel would hold a lock that the
/// consumer needs as soon as it wakes up.
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
    /// Queues an event. For a source that is not live it waits for room until cancellation.
    fn send(&mut self, event: CaptureEvent) {
        if let Some(event) = self.queue.push(event) {
            select! {
                send(self.queue.buffer.sender(), event) -> _ => {}
                recv(self.cancel.channel()) -> _ => {}
            }
        }
        self.consumer.unpark();
    }
}

#[cfg(test)]
mod tests;
