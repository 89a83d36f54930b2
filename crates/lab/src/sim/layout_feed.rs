//! The layout that a session uses now, for the simulated hands that follow it.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::layout::Layout;

/// Longest time that a change waits for the hands to lift: a tap takes 0.2 s.
const LIFT_TIMEOUT: Duration = Duration::from_millis(500);

/// A function that receives messages for the user.
type MessageReceiver = Box<dyn Fn(String) + Send>;

/// The changes of the active layout of a session, for the simulated hands of its setup.
///
/// The layout manager [begins](Self::begin_change) a change and waits until the hands have lifted, so that no press is on its way
/// when the boards move. The hands look at a counter between two packets. The session loop takes no part.
#[derive(Clone, Default)]
pub struct LayoutFeed(Arc<Shared>);

#[derive(Default)]
struct Shared {
    /// The number of changes of `state`, so that a hand locks it only after one.
    version: AtomicU64,
    state: Mutex<FeedState>,
    lifted: Condvar,
    receiver: Mutex<Option<MessageReceiver>>,
}

#[derive(Default)]
struct FeedState {
    /// The hands that follow.
    hands: usize,
    /// The hands that have lifted for the present change.
    lifted: usize,
    is_changing: bool,
    /// The active layout, once it has changed.
    layout: Option<Arc<Layout>>,
}

/// A change of the layout. Dropping it without a layout leaves the active layout as it is.
#[must_use]
pub struct LayoutChange(LayoutFeed);

/// The change that a hand is notified of.
#[derive(Clone, Debug)]
pub(super) enum LayoutNews {
    /// The layout is about to change: the hand lifts.
    Changing,
    /// This layout is active; `None` if it is the first one.
    Active(Option<Arc<Layout>>),
}

/// A hand that follows the layout.
pub(super) struct LayoutFollower {
    feed: LayoutFeed,
    /// The last version that the hand has seen.
    seen: u64,
    /// `true` if the hand has lifted for the change that it has seen.
    has_lifted: bool,
}

impl LayoutFeed {
    /// Sets the function that receives the messages of the hands.
    pub fn set_receiver(&self, receiver: impl Fn(String) + Send + 'static) {
        *lock(&self.0.receiver) = Some(Box::new(receiver));
    }

    /// Announces a change and waits until every hand has lifted, for at most 0.5 s. Returns at once if no hand follows.
    pub fn begin_change(&self) -> LayoutChange {
        let mut state = lock(&self.0.state);
        state.is_changing = true;
        state.lifted = 0;
        self.0.version.fetch_add(1, Ordering::Release);
        let is_waiting = |feed: &mut FeedState| feed.lifted < feed.hands;
        let waited = self
            .0
            .lifted
            .wait_timeout_while(state, LIFT_TIMEOUT, is_waiting);
        drop(waited);
        LayoutChange(self.clone())
    }

    /// Returns `true` if a change was announced that has not ended.
    pub fn is_changing(&self) -> bool {
        lock(&self.0.state).is_changing
    }

    /// Adds a hand.
    pub(super) fn follow(&self) -> LayoutFollower {
        let mut state = lock(&self.0.state);
        state.hands += 1;
        LayoutFollower {
            feed: self.clone(),
            // So that the hand is notified of a layout that was activated before.
            seen: 0,
            has_lifted: false,
        }
    }

    fn end_change(&self, layout: Option<Arc<Layout>>) {
        let mut state = lock(&self.0.state);
        state.is_changing = false;
        state.layout = layout.or(state.layout.take());
        self.0.version.fetch_add(1, Ordering::Release);
    }
}

impl LayoutChange {
    /// Ends the change: this layout is active now.
    pub fn activate(self, layout: Arc<Layout>) {
        self.0.end_change(Some(layout));
    }
}

impl Drop for LayoutChange {
    fn drop(&mut self) {
        let is_changing = lock(&self.0.0.state).is_changing;
        if is_changing {
            self.0.end_change(None);
        }
    }
}

impl LayoutFollower {
    /// Returns what has changed since the last call.
    pub(super) fn news(&mut self) -> Option<LayoutNews> {
        let version = self.feed.0.version.load(Ordering::Acquire);
        if version == self.seen {
            return None;
        }
        let state = lock(&self.feed.0.state);
        self.seen = self.feed.0.version.load(Ordering::Acquire);
        self.has_lifted = false;
        Some(if state.is_changing {
            LayoutNews::Changing
        } else {
            LayoutNews::Active(state.layout.clone())
        })
    }

    /// Returns `true` if nothing has changed since the hand looked. While the state is locked, nothing does.
    fn is_current(&self) -> bool {
        self.seen == self.feed.0.version.load(Ordering::Acquire)
    }

    /// Reports that the hand has lifted for the present change.
    pub(super) fn report_lifted(&mut self) {
        let mut state = lock(&self.feed.0.state);
        if state.is_changing && self.is_current() && !self.has_lifted {
            self.has_lifted = true;
            state.lifted += 1;
            self.feed.0.lifted.notify_all();
        }
    }

    /// Passes a message for the user to the receiver, if there is one.
    pub(super) fn say(&self, message: String) {
        if let Some(receiver) = &*lock(&self.feed.0.receiver) {
            receiver(message);
        }
    }
}

impl Drop for LayoutFollower {
    fn drop(&mut self) {
        let mut state = lock(&self.feed.0.state);
        state.hands -= 1;
        if self.has_lifted && self.is_current() {
            state.lifted -= 1;
        }
        self.feed.0.lifted.notify_all();
    }
}

impl fmt::Debug for LayoutFeed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LayoutFeed").finish_non_exhaustive()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_that_goes_counts_only_for_the_change_that_it_has_seen() {
        let feed = LayoutFeed::default();
        let first = feed.begin_change();
        let mut late = feed.follow();
        assert!(matches!(late.news(), Some(LayoutNews::Changing)));
        late.report_lifted();
        drop(first);

        let second = feed.begin_change();
        let mut hand = feed.follow();
        assert!(matches!(hand.news(), Some(LayoutNews::Changing)));
        hand.report_lifted();
        drop(late);
        let count = || {
            let state = lock(&feed.0.state);
            (state.lifted, state.hands)
        };
        assert_eq!(count(), (1, 1), "the hand that is left has lifted");
        drop(hand);
        assert_eq!(count(), (0, 0), "it no longer counts");
        drop(second);
    }
}
