//! The bounded queue between a source and its consumer.

use std::collections::VecDeque;

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::event::CaptureEvent;

/// Capacity of the queue: a pause of 90 ms at 115 200 baud. Older readings no longer show the hand as it is.
pub(super) const QUEUE_CAPACITY: usize = 16;

/// Events in order, with room for [`QUEUE_CAPACITY`].
pub(super) trait EventBuffer {
    fn is_full(&self) -> bool;

    /// Removes the oldest event.
    fn pop(&mut self) -> Option<CaptureEvent>;

    /// Adds an event. Returns it if there is no room.
    fn push(&mut self, event: CaptureEvent) -> Option<CaptureEvent>;
}

/// Events for another thread. Nothing else sends, so room that was made stays.
pub(super) struct EventChannel {
    sender: Sender<CaptureEvent>,
    /// Receiver of the same channel, which removes the oldest events.
    receiver: Receiver<CaptureEvent>,
}

impl EventChannel {
    pub fn new() -> Self {
        let (sender, receiver) = bounded(QUEUE_CAPACITY);
        Self { sender, receiver }
    }

    /// Returns the receiving end.
    pub fn receiver(&self) -> &Receiver<CaptureEvent> {
        &self.receiver
    }

    /// Returns the sending end, to wait for room.
    pub fn sender(&self) -> &Sender<CaptureEvent> {
        &self.sender
    }
}

impl EventBuffer for EventChannel {
    fn is_full(&self) -> bool {
        self.sender.is_full()
    }

    fn pop(&mut self) -> Option<CaptureEvent> {
        self.receiver.try_recv().ok()
    }

    fn push(&mut self, event: CaptureEvent) -> Option<CaptureEvent> {
        match self.sender.try_send(event) {
            Err(TrySendError::Full(event)) => Some(event),
            // A queue without a consumer is about to be dropped.
            Ok(()) | Err(TrySendError::Disconnected(_)) => None,
        }
    }
}

/// Events for the thread that queues them itself, which needs none of the atomic operations of a channel.
impl EventBuffer for VecDeque<CaptureEvent> {
    fn is_full(&self) -> bool {
        self.len() >= QUEUE_CAPACITY
    }

    fn pop(&mut self) -> Option<CaptureEvent> {
        let event = self.pop_front();
        if self.is_empty() {
            // The next event takes the same memory, which is in the processor's cache.
            self.clear();
        }
        event
    }

    fn push(&mut self, event: CaptureEvent) -> Option<CaptureEvent> {
        if EventBuffer::is_full(self) {
            return Some(event);
        }
        self.push_back(event);
        None
    }
}

/// A bounded queue that drops the oldest readings of a live source.
pub(super) struct EventQueue<B> {
    /// The queued events.
    pub buffer: B,
    is_live: bool,
    dropped: u64,
}

impl<B: EventBuffer> EventQueue<B> {
    /// Creates a queue from an empty buffer. That of a live source drops its oldest readings when it is full and counts them
    /// in [`SourceStats::dropped`](super::SourceStats::dropped).
    pub fn new(buffer: B, is_live: bool) -> Self {
        Self {
            buffer,
            is_live,
            dropped: 0,
        }
    }

    /// Queues an event. Returns it if the queue of a source that is not live is full.
    pub fn push(&mut self, mut event: CaptureEvent) -> Option<CaptureEvent> {
        if self.is_live {
            self.make_room();
        }
        if let CaptureEvent::Reading { stats, .. }
        | CaptureEvent::Readings { stats, .. }
        | CaptureEvent::Noise(stats)
        | CaptureEvent::End(stats) = &mut event
        {
            stats.dropped += self.dropped;
        }
        self.buffer.push(event)
    }

    fn make_room(&mut self) {
        while self.buffer.is_full() {
            match self.buffer.pop() {
                Some(CaptureEvent::Reading { .. }) => self.dropped += 1,
                Some(CaptureEvent::Readings { readings, .. }) => {
                    self.dropped += readings.len() as u64;
                }
                // The statistics of later events include these.
                Some(CaptureEvent::Noise(_) | CaptureEvent::Elapsed(_)) => {}
                Some(loss) => self.keep_last_loss(loss),
                // The consumer was faster.
                None => {}
            }
        }
    }

    /// Drops all queued events except the last loss, which must stay before the readings that follow it.
    fn keep_last_loss(&mut self, mut loss: CaptureEvent) {
        while let Some(event) = self.buffer.pop() {
            match event {
                CaptureEvent::Reading { .. } => self.dropped += 1,
                CaptureEvent::Readings { readings, .. } => self.dropped += readings.len() as u64,
                CaptureEvent::Noise(_) | CaptureEvent::Elapsed(_) => {}
                later => loss = later,
            }
        }
        // There is room: the buffer was empty a moment ago and nothing else sends.
        let _ = self.buffer.push(loss);
    }
}
