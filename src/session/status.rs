//! Notices that follow from changes of the state of a session.

use std::time::{Duration, Instant};

use super::notice::Notice;
use crate::command::CommandOrigin;
use crate::estimate::Rejection;
use crate::hand::{FingerSet, Side};
use crate::pipeline::PipelineState;
use crate::snapshot::{Snapshot, Stats};

/// Shortest time between two notices of the same kind of loss.
const REPEAT_INTERVAL: Duration = Duration::from_secs(10);

/// Derives notices from snapshots: one for each change of state, and one per kind of loss in 10 s.
#[derive(Default)]
pub(super) struct StatusLog {
    state: Option<(PipelineState, Option<CommandOrigin>)>,
    rejected: [RateLimited<u64>; Rejection::COUNT],
    dropped: RateLimited<u64>,
    system_keys: RateLimited<u64>,
    keys_by_role: RateLimited<u64>,
    pointing_by_role: RateLimited<u64>,
    /// By side.
    untrusted: [RateLimited<FingerSet>; Side::COUNT],
}

/// A value that is reported when it changes, but at most once per [`REPEAT_INTERVAL`].
#[derive(Clone, Copy, Default)]
struct RateLimited<T> {
    reported: T,
    reported_at: Option<Instant>,
}

impl<T: Copy + PartialEq> RateLimited<T> {
    /// Returns the value reported before, if the new one is due.
    fn update(&mut self, value: T) -> Option<T> {
        let is_recent = |at: Instant| at.elapsed() < REPEAT_INTERVAL;
        if value == self.reported || self.reported_at.is_some_and(is_recent) {
            return None;
        }
        self.reported_at = Some(Instant::now());
        Some(std::mem::replace(&mut self.reported, value))
    }
}

impl RateLimited<u64> {
    /// Returns the increase since the last report, if one is due.
    fn increase(&mut self, count: u64) -> Option<u64> {
        self.update(count).map(|before| count - before)
    }
}

impl StatusLog {
    /// Reports the changes since the last snapshot.
    pub fn update(&mut self, snapshot: &Snapshot, report: &mut impl FnMut(Notice)) {
        // At the end the readings that were not processed count as dropped.
        if snapshot.state != PipelineState::Stopped {
            self.report_losses(&snapshot.stats, report);
        }
        if let Some(pose) = &snapshot.pose
            && let untrusted = &mut self.untrusted[pose.side.index()]
            && untrusted.update(pose.untrusted).is_some()
        {
            report(Notice::UntrustedFingers(pose.untrusted));
        }
        if let Some(error) = &snapshot.source_error {
            report(Notice::SourceLost(error.to_string()));
        }
        self.report_state(snapshot, report);
    }

    fn report_losses(&mut self, stats: &Stats, report: &mut impl FnMut(Notice)) {
        let rejected = self.rejected.iter_mut().zip(stats.rejected);
        for (&reason, (limited, count)) in Rejection::ALL.iter().zip(rejected) {
            if let Some(more) = limited.increase(count) {
                report(Notice::Rejected(more, reason));
            }
        }
        let suppressed = &stats.suppressed;
        if let Some(more) = self.dropped.increase(stats.source.dropped) {
            report(Notice::Dropped(more));
        }
        if let Some(more) = self.system_keys.increase(suppressed.system_keys) {
            report(Notice::SystemKeysSuppressed(more));
        }
        if let Some(more) = self.keys_by_role.increase(suppressed.keys_by_role) {
            report(Notice::KeysSuppressed(more));
        }
        if let Some(more) = self.pointing_by_role.increase(suppressed.pointing_by_role) {
            report(Notice::PointingSuppressed(more));
        }
    }

    fn report_state(&mut self, snapshot: &Snapshot, report: &mut impl FnMut(Notice)) {
        let state = (snapshot.state, snapshot.paused_by);
        if self.state.replace(state) == Some(state) {
            return;
        }
        match state {
            (PipelineState::Starting | PipelineState::Stopped, _) => {}
            (PipelineState::Paused, Some(origin)) => report(Notice::Paused(origin)),
            (PipelineState::Paused, None) => report(Notice::Disarmed),
            (PipelineState::Running, _) => report(Notice::Armed),
            (PipelineState::Stalled, _) => report(Notice::Stalled),
        }
    }
}
