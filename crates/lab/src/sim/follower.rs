//! A simulated hand that follows the layout: it lifts before a change, and learns what is active then.

use std::sync::Arc;

use super::layout_feed::{LayoutFeed, LayoutFollower, LayoutNews};
use super::task::HandTask;
use crate::layout::Layout;

/// Number of packets for which a lifted hand keeps still before it reports that it has lifted: earlier packets have arrived by then.
const SETTLING_PACKETS: u32 = 4;

/// The task of a hand, and the changes of its layout.
pub(super) struct Follower {
    follower: LayoutFollower,
    task: HandTask,
    /// The layout that the hand was made for.
    first_layout: Arc<Layout>,
    /// The layout that the hand uses.
    layout: Arc<Layout>,
    state: State,
}

/// The state of a hand between two layouts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    /// The hand performs its task.
    Busy,
    /// The hand lifts.
    Lifting,
    /// The hand has been clear of all targets for this number of packets, at most [`SETTLING_PACKETS`].
    Lifted(u32),
}

impl Follower {
    pub(super) fn new(task: HandTask, layout: Arc<Layout>, feed: &LayoutFeed) -> Self {
        Self {
            follower: feed.follow(),
            task,
            first_layout: Arc::clone(&layout),
            layout,
            state: State::Busy,
        }
    }

    pub(super) fn task(&self) -> &HandTask {
        &self.task
    }

    pub(super) fn first_layout(&self) -> &Layout {
        &self.first_layout
    }

    /// Returns `true` if the hand keeps still.
    pub(super) fn is_lifted(&self) -> bool {
        matches!(self.state, State::Lifted(_))
    }

    /// Passes a message to the user.
    pub(super) fn say(&self, message: String) {
        self.follower.say(message);
    }

    /// Handles a change of the layout before each packet; `is_down` is `true` while a fingertip presses. After a change, returns the
    /// layout on which the hand continues.
    pub(super) fn update(&mut self, is_down: bool) -> Option<Arc<Layout>> {
        match self.follower.news() {
            Some(LayoutNews::Changing) => self.state = State::Lifting,
            Some(LayoutNews::Active(layout)) => {
                self.state = State::Busy;
                self.layout = layout.unwrap_or(Arc::clone(&self.layout));
                return Some(Arc::clone(&self.layout));
            }
            None => {}
        }
        self.state = match self.state {
            State::Lifting if !is_down => State::Lifted(0),
            State::Lifted(packets) if packets < SETTLING_PACKETS => {
                if packets + 1 == SETTLING_PACKETS {
                    self.follower.report_lifted();
                }
                State::Lifted(packets + 1)
            }
            state => state,
        };
        None
    }
}
