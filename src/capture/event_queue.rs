//! The bounded queue between a source and its consumer.

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::event::CaptureEvent;

/// Capacity of the queue: a pause of 90 ms at 115 200 baud. Older readings no longer show the hand as it is.
pub(super) const QUEUE_CAPACITY: usize = 16;

/// Sending end of the queue. Nothing else sends, so room that was made stays.
pub(super) struct EventQueue {
    sender: Sender<CaptureEvent>,
    /// Receiver of the same channel, which removes the oldest events.
    events: Receiver<CaptureEvent>,
    is_live: bool,
    dropped: u64,
}

impl EventQueue {
    /// Creates an empty queue. That of a live source drops its oldest readings when it is full and counts them in
    /// [`SourceStats::dropped`](super::SourceStats::dropped).
    pub fn new(is_live: bool) -> Self {
        let (sender, events) = bounded(QUEUE_CAPACITY);
        Self {
            sender,
            events,
            is_live,
            dropped: 0,
        }
    }

    /// Returns the receiving end.
    pub fn events(&self) -> &Receiver<CaptureEvent> {
        &self.events
    }

    /// Returns the sending end, to wait for room.
    pub fn sender(&self) -> &Sender<CaptureEvent> {
        &self.sender
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
        match self.sender.try_send(event) {
            Err(TrySendError::Full(event)) => Some(event),
            // A queue without a consumer is about to be dropped.
            Ok(()) | Err(TrySendError::Disconnected(_)) => None,
        }
    }

    fn make_room(&mut self) {
        while self.sender.is_full() {
            match self.events.try_recv() {
                Ok(CaptureEvent::Reading { .. }) => self.dropped += 1,
                Ok(CaptureEvent::Readings { readings, .. }) => {
                    self.dropped += readings.len() as u64;
                }
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
        while let Ok(event) = self.events.try_recv() {
            match event {
                CaptureEvent::Reading { .. } => self.dropped += 1,
                CaptureEvent::Readings { readings, .. } => self.dropped += readings.len() as u64,
                CaptureEvent::Noise(_) | CaptureEvent::Elapsed(_) => {}
                later => loss = later,
            }
        }
        // There is room: the channel was empty a moment ago and nothing else sends.
        let _ = self.sender.try_send(loss);
    }
}
