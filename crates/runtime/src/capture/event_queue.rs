//! The bounded queue between a source and its consumer.

use std::collections::VecDeque;

use arrayvec::ArrayVec;
use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::event::CaptureEvent;
use super::{CaptureError, Reading};
use ademan_core::hand::{HandPart, Side};

/// Most readings of one hand, or of a part of it, in the queue of a live source: a pause of 90 ms at 115 200 baud. Older ones no
/// longer show the hand as it is.
pub(super) const QUEUE_CAPACITY: usize = 16;

/// Events that the queue of a live source has room for: the readings of the arms and the fingers of both hands.
pub(super) const LIVE_CAPACITY: usize = QUEUE_CAPACITY * Side::COUNT * HandPart::COUNT;

/// Most losses of different things: of each hand or both, of each part or all of it, and of the whole source.
const MAX_LOSSES: usize = (Side::COUNT + 1) * (HandPart::COUNT + 1) + 1;

/// Events in order.
pub(super) trait EventBuffer {
    /// Returns the number of events.
    fn count(&self) -> usize;

    /// Removes the oldest event.
    fn pop(&mut self) -> Option<CaptureEvent>;

    /// Adds an event. Returns it if there is no room.
    fn push(&mut self, event: CaptureEvent) -> Option<CaptureEvent>;
}

/// Events for another thread. The queue is the only sender, so room that it has made stays free.
pub(super) struct EventChannel {
    sender: Sender<CaptureEvent>,
    /// Receiver of the same channel, which removes the oldest events.
    receiver: Receiver<CaptureEvent>,
}

impl EventChannel {
    /// Creates a channel for a live source, or for one that waits for its consumer.
    pub fn new(is_live: bool) -> Self {
        let capacity = if is_live {
            LIVE_CAPACITY
        } else {
            QUEUE_CAPACITY
        };
        let (sender, receiver) = bounded(capacity);
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
    fn count(&self) -> usize {
        self.receiver.len()
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
    fn count(&self) -> usize {
        self.len()
    }

    fn pop(&mut self) -> Option<CaptureEvent> {
        let event = self.pop_front();
        if self.is_empty() {
            // The next event is written to the same memory, which is in the processor's cache.
            self.clear();
        }
        event
    }

    fn push(&mut self, event: CaptureEvent) -> Option<CaptureEvent> {
        if self.len() >= LIVE_CAPACITY {
            return Some(event);
        }
        self.push_back(event);
        None
    }
}

/// The hand and the part of a reading; `None` for other events.
type Origin = Option<(Option<Side>, Option<HandPart>)>;

/// A bounded queue that drops the oldest readings of a live source.
///
/// Each hand, and each part of it, has a quota of [`QUEUE_CAPACITY`] readings: a source that floods the queue displaces no
/// reading of another hand or part.
pub(super) struct EventQueue<B> {
    /// The queued events.
    pub buffer: B,
    is_live: bool,
    dropped: u64,
    /// Origins of the latest events that were queued, a ring whose oldest entry is at `next_origin`. The newest ones are the origins of
    /// the events that are still in the queue.
    origins: [Origin; LIVE_CAPACITY],
    next_origin: usize,
}

impl<B: EventBuffer> EventQueue<B> {
    /// Creates a queue from an empty buffer. The queue of a live source drops its oldest readings when it is full and counts
    /// them in [`SourceStats::dropped`](super::SourceStats::dropped).
    pub fn new(buffer: B, is_live: bool) -> Self {
        Self {
            buffer,
            is_live,
            dropped: 0,
            origins: [None; LIVE_CAPACITY],
            next_origin: 0,
        }
    }

    /// Queues an event. Returns it if the queue of a source that is not live is full.
    pub fn push(&mut self, mut event: CaptureEvent) -> Option<CaptureEvent> {
        let origin = origin(&event);
        if self.is_live && !self.make_room_for(origin) {
            self.dropped += reading_count(&event);
            return None;
        }
        if let CaptureEvent::Reading { stats, .. }
        | CaptureEvent::Readings { stats, .. }
        | CaptureEvent::Noise(stats)
        | CaptureEvent::End(stats) = &mut event
        {
            stats.dropped += self.dropped;
        }
        self.record_origin(origin);
        self.buffer.push(event)
    }

    /// Records the origin of an event that is queued.
    fn record_origin(&mut self, origin: Origin) {
        self.origins[self.next_origin] = origin;
        self.next_origin = (self.next_origin + 1) % LIVE_CAPACITY;
    }

    /// Returns the origins of the last `count` events, the oldest first.
    fn latest_origins(&self, count: usize) -> impl Iterator<Item = Origin> {
        let first = self.next_origin + LIVE_CAPACITY - count;
        (first..first + count).map(|index| self.origins[index % LIVE_CAPACITY])
    }

    /// Drops the oldest events until there is room for an event of this origin. Returns `false` if there is none: the origin has
    /// used its quota, and the oldest reading has another origin.
    fn make_room_for(&mut self, origin: Origin) -> bool {
        loop {
            let count = self.buffer.count();
            if count < QUEUE_CAPACITY {
                return true;
            }
            let is_own = |other: &Origin| origin.is_some() && *other == origin;
            let own = self.latest_origins(count).filter(is_own).count();
            if own < QUEUE_CAPACITY && count < LIVE_CAPACITY {
                return true;
            }
            let oldest = self.latest_origins(count).next().flatten();
            if own >= QUEUE_CAPACITY && oldest.is_some() && oldest != origin {
                return false;
            }
            self.drop_oldest();
        }
    }

    fn drop_oldest(&mut self) {
        match self.buffer.pop() {
            // The statistics of later events include these.
            Some(CaptureEvent::Noise(_) | CaptureEvent::Elapsed(_)) => {}
            Some(event) if reading_count(&event) > 0 => self.dropped += reading_count(&event),
            Some(loss) => self.keep_losses(loss),
            // The consumer was faster.
            None => {}
        }
    }

    /// Drops all queued events except losses, which must precede the readings that follow them. Of several losses of one part, or of
    /// the whole source, keeps the last.
    fn keep_losses(&mut self, first: CaptureEvent) {
        let mut losses = ArrayVec::<CaptureEvent, MAX_LOSSES>::new();
        let mut next = Some(first);
        while let Some(event) = next {
            match event {
                CaptureEvent::Noise(_) | CaptureEvent::Elapsed(_) => {}
                event if reading_count(&event) > 0 => self.dropped += reading_count(&event),
                loss => {
                    losses.retain(|earlier| lost_part(earlier) != lost_part(&loss));
                    losses.push(loss);
                }
            }
            next = self.buffer.pop();
        }
        for loss in losses {
            self.record_origin(None);
            // There is room: the buffer was emptied above, and nothing else sends.
            let _ = self.buffer.push(loss);
        }
    }
}

fn origin(event: &CaptureEvent) -> Origin {
    let origin = |reading: &Reading| (reading.side, reading.part);
    match event {
        CaptureEvent::Reading { reading, .. } => Some(origin(reading)),
        CaptureEvent::Readings { readings, .. } => readings.first().map(origin),
        _ => None,
    }
}

/// Returns the hand and the part that a loss concerns; `None` for a loss of the whole source, and for any other event.
fn lost_part(event: &CaptureEvent) -> Origin {
    match event {
        CaptureEvent::Lost(CaptureError::PartLost { side, part, .. }) => Some((*side, *part)),
        _ => None,
    }
}

/// Returns the number of readings in an event.
fn reading_count(event: &CaptureEvent) -> u64 {
    match event {
        CaptureEvent::Reading { .. } => 1,
        CaptureEvent::Readings { readings, .. } => readings.len() as u64,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::capture::{Sample, SourceStats};
    use ademan_core::time::Timestamp;

    fn reading(side: Side, time: u64) -> CaptureEvent {
        let angles = Default::default();
        CaptureEvent::Reading {
            reading: Reading::new(Timestamp(time), Some(side), Sample::Angles { angles }),
            received_at: Instant::now(),
            stats: SourceStats::default(),
        }
    }

    /// Removes all events. Returns the sides and times of the readings, in order.
    fn take_all(buffer: &mut impl EventBuffer) -> Vec<(Side, u64)> {
        let events = std::iter::from_fn(|| buffer.pop());
        let readings = events.filter_map(|event| match event {
            CaptureEvent::Reading { reading, .. } => Some((reading.side?, reading.time.0)),
            _ => None,
        });
        readings.collect()
    }

    fn times(readings: &[(Side, u64)], side: Side) -> Vec<u64> {
        let readings = readings.iter().filter(|(other, _)| *other == side);
        readings.map(|(_, time)| *time).collect()
    }

    /// Floods a queue with 1000 readings of the right hand between 4 of the left one, again and again.
    fn check_flood(buffer: impl EventBuffer) {
        let mut queue = EventQueue::new(buffer, true);
        for start in (0..50).map(|round| round * 1000) {
            for time in start..start + 1000 {
                let is_left = time % 250 == 7;
                let side = if is_left { Side::Left } else { Side::Right };
                assert!(queue.push(reading(side, time)).is_none());
            }
            let readings = take_all(&mut queue.buffer);
            assert!(readings.is_sorted_by_key(|(_, time)| *time), "{readings:?}");
            let left = [7, 257, 507, 757].map(|time| start + time);
            assert_eq!(times(&readings, Side::Left), left);
            let right = times(&readings, Side::Right);
            assert_eq!(right.len(), QUEUE_CAPACITY, "{right:?}");
        }
        assert_eq!(queue.dropped, 50 * (1000 - 4 - QUEUE_CAPACITY as u64));
    }

    #[test]
    fn a_hand_that_floods_the_queue_displaces_no_reading_of_the_other() {
        check_flood(VecDeque::with_capacity(LIVE_CAPACITY));
        check_flood(EventChannel::new(true));
    }

    #[test]
    fn of_two_hands_that_flood_the_queue_the_newest_readings_of_both_stay() {
        let mut queue = EventQueue::new(VecDeque::with_capacity(LIVE_CAPACITY), true);
        for time in 0..1000 {
            for side in [Side::Left, Side::Right] {
                queue.push(reading(side, time));
            }
        }
        let readings = take_all(&mut queue.buffer);
        let newest: Vec<_> = (1000 - QUEUE_CAPACITY as u64..1000).collect();
        for side in [Side::Left, Side::Right] {
            assert_eq!(times(&readings, side), newest, "{side}");
        }
    }

    #[test]
    fn a_flood_after_a_loss_keeps_the_loss_before_the_readings() {
        let mut queue = EventQueue::new(VecDeque::with_capacity(LIVE_CAPACITY), true);
        let lost = CaptureError::Interrupted {
            source_name: "glove".into(),
            reason: "a test".into(),
        };
        queue.push(CaptureEvent::Lost(lost));
        for time in 0..1000 {
            queue.push(reading(Side::Right, time));
        }
        queue.push(reading(Side::Left, 1000));
        let first = queue.buffer.pop();
        assert!(matches!(first, Some(CaptureEvent::Lost(_))), "{first:?}");
        let readings = take_all(&mut queue.buffer);
        assert_eq!(readings.last(), Some(&(Side::Left, 1000)), "{readings:?}");
        assert_eq!(times(&readings, Side::Right).last(), Some(&999));
    }

    #[test]
    fn a_flood_after_the_losses_of_both_hands_keeps_the_last_loss_of_each() {
        let mut queue = EventQueue::new(VecDeque::with_capacity(LIVE_CAPACITY), true);
        let named = |name: &str| CaptureError::Interrupted {
            source_name: name.into(),
            reason: "a test".into(),
        };
        for (side, name) in [
            (Side::Left, "first"),
            (Side::Right, "second"),
            (Side::Left, "third"),
        ] {
            queue.push(CaptureEvent::Lost(CaptureError::PartLost {
                side: Some(side),
                part: None,
                error: Box::new(named(name)),
            }));
        }
        for time in 0..1000 {
            queue.push(reading(Side::Right, time));
        }
        let losses = std::iter::from_fn(|| match queue.buffer.pop() {
            Some(CaptureEvent::Lost(CaptureError::PartLost { side, error, .. })) => {
                Some((side, error.source_name().to_owned()))
            }
            _ => None,
        });
        let losses: Vec<_> = losses.collect();
        let expected = [(Side::Right, "second"), (Side::Left, "third")];
        assert_eq!(
            losses,
            expected.map(|(side, name)| (Some(side), name.to_owned()))
        );
    }
}
