//! A source that its consumer reads itself, without a thread in between.

use std::collections::VecDeque;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{RecvTimeoutError, bounded};

use super::event::{CaptureEvent, EventSource};
use super::event_queue::{EventBuffer, EventQueue, LIVE_CAPACITY};
use super::wake_up::WakeUp;
use super::{Source, SourceWait};

/// Most calls of the source in one wait: more than the packets that a terminal holds. The consumer of a sender without pauses
/// gets its turn after them.
const MAX_CALLS: usize = 512;

/// Longest time that dropping an [`InPlaceCapture`] waits until its source is closed.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// A source that is read by the thread that consumes its events.
///
/// A reading needs no second thread and no wake-up of one. When the consumer is late, the bytes wait in the kernel; then
/// everything that waits is read at once, and of the readings in it the queue keeps the newest.
pub(crate) struct InPlaceCapture {
    /// The source; `None` once it is closed.
    source: Option<EventSource<Box<dyn Source>>>,
    queue: EventQueue<VecDeque<CaptureEvent>>,
    wake_up: WakeUp,
}

impl InPlaceCapture {
    /// Prepares a source to be read in place. Returns the source if it has to block, or if the process is out of file
    /// descriptors.
    pub fn new(mut source: Box<dyn Source>) -> Result<Self, Box<dyn Source>> {
        match WakeUp::new() {
            Some(wake_up) if source.set_polled() => Ok(Self {
                queue: EventQueue::new(VecDeque::with_capacity(LIVE_CAPACITY), source.is_live()),
                source: Some(EventSource::new(source)),
                wake_up,
            }),
            _ => Err(source),
        }
    }

    /// Removes the oldest event. Only [`wait`](Self::wait) adds events.
    pub fn next_event(&mut self) -> Option<CaptureEvent> {
        self.queue.buffer.pop()
    }

    /// Returns `true` if there is an event.
    pub fn has_events(&self) -> bool {
        !self.queue.buffer.is_empty()
    }

    /// Stops reading. If packets were refused since the latest statistics, queues a last event with the new statistics.
    pub fn stop(&mut self) {
        let source = self.source.as_mut();
        if let Some(stats) = source.and_then(EventSource::stop) {
            let _ = self.queue.push(CaptureEvent::Noise(stats));
        }
    }

    /// Returns the handle that ends a [`wait`](Self::wait), from any thread.
    pub fn wake_up(&self) -> &WakeUp {
        &self.wake_up
    }

    /// Waits until bytes arrive, a wake-up or `timeout`, and queues what has arrived.
    pub fn wait(&mut self, timeout: Duration) {
        let Some(source) = &mut self.source else {
            return;
        };
        if !is_due(&source.source, &self.wake_up, timeout) {
            return;
        }
        let queue = &mut self.queue;
        let mut emit = |event| {
            // The queue of a live source has room for every event.
            let _ = queue.push(event);
        };
        for _ in 0..MAX_CALLS {
            if !source.next(&mut emit) || source.source.wait().is_some() {
                return;
            }
        }
    }
}

/// Waits for a source, a wake-up or `timeout`. Returns `true` if the source has something to read or to do.
fn is_due(source: &dyn Source, wake_up: &WakeUp, timeout: Duration) -> bool {
    let Some(SourceWait {
        readiness,
        deadline,
    }) = source.wait()
    else {
        return true;
    };
    let Some(deadline) = deadline else {
        return wake_up.wait(readiness, timeout);
    };
    let left = deadline.saturating_duration_since(Instant::now());
    wake_up.wait(readiness, timeout.min(left)) || Instant::now() >= deadline
}

impl Drop for InPlaceCapture {
    /// Closes the source on its own thread: closing the port of an absent device can block for seconds.
    fn drop(&mut self) {
        let Some(source) = self.source.take() else {
            return;
        };
        let name = source.source.name().to_owned();
        let (end, ended) = bounded::<()>(0);
        let close = move || {
            drop(source);
            drop(end);
        };
        if let Err(error) = thread::Builder::new().name("close".to_owned()).spawn(close) {
            tracing::debug!("cannot start a thread, {name} was closed in place: {error}");
        }
        if ended.recv_timeout(CLOSE_TIMEOUT) == Err(RecvTimeoutError::Timeout) {
            tracing::warn!(
                source = name,
                "{name} does not close, its thread is left behind"
            );
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests;
