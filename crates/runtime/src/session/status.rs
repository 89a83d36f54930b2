//! Notices that follow from changes of the state of a session.

use std::time::Instant;

use super::notice::{ImplausibleParts, NearestTarget, Notice};
use super::notice_thread::NoticeSender;
use super::observer::Observer;
use crate::message_limits::MessageLimits;
use ademan_core::command::CommandOrigin;
use ademan_core::estimate::{Implausible, Rejection};
use ademan_core::hand::{FingerSet, Side};
use ademan_core::pipeline::{HandLoss, Pipeline, PipelineState, Unreached};
use ademan_core::snapshot::{Stats, StepView};

/// Notices per 10 s that a person waits for: the pause that was asked for, and the start of typing, which must never
/// be a surprise.
const AWAITED: u32 = 10;

/// Derives notices from steps: one for each change of state and each loss, but at most one per kind and source in
/// 10 s, as a peer can cause them. Only those that a person waits for may come more often.
#[derive(Default)]
struct StatusLog {
    /// `true` if the outputs reach other programs.
    has_effect: bool,
    /// `true` if `ademan ctl` can reach the session.
    has_control_socket: bool,
    limits: MessageLimits<Topic, Notice>,
    state: Option<(PipelineState, Option<CommandOrigin>)>,
    rejected: [u64; Rejection::COUNT],
    dropped: u64,
    dropped_presses: u64,
    output_stalls: u64,
    system_keys: u64,
    keys_by_role: u64,
    pointing_by_role: u64,
    /// Fingers that were reported as bent.
    bent: FingerSet,
    /// `true` if the wait for an open hand was reported.
    is_awaiting: bool,
    /// `true` if a hand that reaches nothing was reported.
    is_unreached: bool,
    /// The fingers that are not trusted, by side.
    untrusted: [FingerSet; Side::COUNT],
    /// The parts that were reported as implausible, by side.
    implausible: [Implausible; Side::COUNT],
    /// `true` if the hand was reported as lost, by side.
    lost_hands: [bool; Side::COUNT],
}

/// The kind and the source of a notice.
#[derive(Debug, PartialEq)]
enum Topic {
    Rejected(Rejection),
    Dropped,
    DroppedPresses,
    OutputStalled,
    SystemKeys,
    KeysByRole,
    PointingByRole,
    Untrusted(Side),
    Implausible(Side),
    HandLost(Side),
    HandFound(Side),
    /// The name of the source.
    Lost(String),
    Paused,
    Disarmed,
    Bent,
    Awaiting,
    Armed,
    Stalled,
}

/// The state of the pipeline after a step that a person has to react to: what the layout waits for, and hands that touch nothing.
#[derive(Clone, Copy, Debug)]
struct Hints {
    /// Fingers that must be straightened before the output is armed.
    bent: FingerSet,
    /// `true` if the layout waits for an open hand.
    awaits_start: bool,
    unreached: Option<Unreached>,
    /// The parts whose readings are implausible, by side.
    implausible: [Implausible; Side::COUNT],
    losses: [Option<HandLoss>; Side::COUNT],
}

impl Hints {
    pub fn from_pipeline(pipeline: &Pipeline) -> Self {
        let implausible = pipeline.implausible();
        let mut losses = pipeline.hand_losses();
        for (loss, parts) in losses.iter_mut().zip(&implausible) {
            // The notice of those parts says why.
            loss.take_if(|loss| *loss == HandLoss::NotSeen && parts.concerns_hand());
        }
        Self {
            bent: match pipeline.state() {
                PipelineState::Paused => pipeline.bent_fingers(),
                _ => FingerSet::NONE,
            },
            awaits_start: pipeline.awaits_start(),
            unreached: pipeline.unreached(),
            implausible,
            losses,
        }
    }
}

/// Sends the notices of a [`StatusLog`].
pub(super) struct StatusNotices {
    log: StatusLog,
    notices: NoticeSender,
}

impl StatusNotices {
    /// Creates the notices of a session. `has_effect` is `true` if its outputs reach other programs, `has_control_socket` if `ademan ctl`
    /// can reach it.
    pub fn new(has_effect: bool, has_control_socket: bool, notices: NoticeSender) -> Self {
        Self {
            log: StatusLog {
                has_effect,
                has_control_socket,
                ..StatusLog::default()
            },
            notices,
        }
    }
}

impl Observer for StatusNotices {
    fn observe(&mut self, step: &StepView, now: Instant, pipeline: &Pipeline) {
        let hints = Hints::from_pipeline(pipeline);
        let mut report = |notice| self.notices.send(notice);
        (self.log).report_implausible(pipeline, &hints, now, &mut report);
        (self.log).update(step, &hints, now, &mut report);
    }
}

impl StatusLog {
    /// Reports the changes since the last step.
    pub fn update(
        &mut self,
        step: &StepView,
        hints: &Hints,
        now: Instant,
        report: &mut impl FnMut(Notice),
    ) {
        // At the end the readings that were not processed count as dropped.
        if step.state != PipelineState::Stopped {
            if let Some(notice) = self.output_stall(step.stats, now) {
                report(notice);
            }
            self.report_losses(step.stats, now, report);
        }
        self.report_untrusted(step, hints, now, report);
        self.report_hands(hints, now, report);
        if let Some(error) = step.source_error {
            let topic = Topic::Lost(error.source_name().to_owned());
            let notice = Notice::SourceLost(error.to_string());
            if let Some(notice) = self.limits.admit(topic, 1, notice, now) {
                report(notice);
            }
        }
        self.report_state(step, now, report);
        self.report_bent(step, hints.bent, now, report);
        self.report_place(step, hints, now, report);
        self.report_held_back(step.state == PipelineState::Stopped, now, report);
    }

    /// Reports changes of the fingers that are not trusted, unless another notice explains them.
    fn report_untrusted(
        &mut self,
        step: &StepView,
        hints: &Hints,
        now: Instant,
        report: &mut impl FnMut(Notice),
    ) {
        let Some(pose) = step.pose else {
            return;
        };
        // Their notices say why no finger is trusted.
        let explains_all = |loss: HandLoss| matches!(loss, HandLoss::Stuck | HandLoss::TooFast);
        if hints.losses[pose.side.index()].is_some_and(explains_all) {
            return;
        }
        let explained = hints.implausible[pose.side.index()].fingers();
        let untrusted = pose.untrusted.difference(explained);
        let reported = &mut self.untrusted[pose.side.index()];
        if *reported != untrusted && self.limits.admits(Topic::Untrusted(pose.side), now) {
            *reported = untrusted;
            report(Notice::UntrustedFingers(untrusted));
        }
    }

    /// Reports the notices that were held back in intervals that are over; at the end, all of them.
    fn report_held_back(&mut self, is_end: bool, now: Instant, report: &mut impl FnMut(Notice)) {
        loop {
            let next = if is_end {
                self.limits.take_any(now)
            } else {
                self.limits.take_due(now)
            };
            let Some(held_back) = next else {
                return;
            };
            report(Notice::HeldBack(Box::new(held_back)));
        }
    }

    /// Reports the parts of a hand whose readings have become implausible or plausible again.
    fn report_implausible(
        &mut self,
        pipeline: &Pipeline,
        hints: &Hints,
        now: Instant,
        report: &mut impl FnMut(Notice),
    ) {
        for &side in Side::ALL {
            let found = hints.implausible[side.index()];
            let reported = &mut self.implausible[side.index()];
            if *reported == found || !self.limits.admits(Topic::Implausible(side), now) {
                continue;
            }
            *reported = found;
            report(if found == Implausible::default() {
                Notice::Plausible(side)
            } else {
                let angles = found.angles.iter();
                let with_channel = |dof| (dof, pipeline.channel_of(side, dof));
                Notice::Implausible(
                    side,
                    ImplausibleParts {
                        angles: angles.map(with_channel).collect(),
                        is_hand: found.is_hand,
                    },
                )
            });
        }
    }

    /// Returns `true` if every counter has been reported, as in nearly all steps.
    fn has_reported(&self, stats: &Stats) -> bool {
        self.rejected == stats.rejected
            && self.dropped == stats.source.dropped
            && self.dropped_presses == stats.dropped_presses
            && self.system_keys == stats.suppressed.system_keys
            && self.keys_by_role == stats.suppressed.keys_by_role
            && self.pointing_by_role == stats.suppressed.pointing_by_role
    }

    /// Returns the notice of an output that has stalled, unless the notice about dropped keystrokes explains it.
    fn output_stall(&mut self, stats: &Stats, now: Instant) -> Option<Notice> {
        let is_explained = self.dropped_presses != stats.dropped_presses;
        let reported = std::mem::replace(&mut self.output_stalls, stats.output_stalls);
        if reported == stats.output_stalls || is_explained {
            return None;
        }
        let (topic, notice) = (Topic::OutputStalled, Notice::OutputStalled);
        self.limits.admit(topic, 1, notice, now)
    }

    /// Reports counters that have increased, each with the increase since its last notice.
    fn report_losses(&mut self, stats: &Stats, now: Instant, report: &mut impl FnMut(Notice)) {
        if self.has_reported(stats) {
            return;
        }
        let limits = &mut self.limits;
        let mut update = |topic, reported: &mut u64, count, notice: &dyn Fn(u64) -> Notice| {
            if count != *reported && limits.admits(topic, now) {
                report(notice(count - std::mem::replace(reported, count)));
            }
        };
        let rejected = self.rejected.iter_mut().zip(stats.rejected);
        for (&reason, (reported, count)) in Rejection::ALL.iter().zip(rejected) {
            let notice = |more| Notice::Rejected(more, reason);
            update(Topic::Rejected(reason), reported, count, &notice);
        }
        update(
            Topic::Dropped,
            &mut self.dropped,
            stats.source.dropped,
            &Notice::Dropped,
        );
        update(
            Topic::DroppedPresses,
            &mut self.dropped_presses,
            stats.dropped_presses,
            &Notice::DroppedPresses,
        );
        let suppressed = &stats.suppressed;
        update(
            Topic::SystemKeys,
            &mut self.system_keys,
            suppressed.system_keys,
            &Notice::SystemKeysSuppressed,
        );
        let has_control_socket = self.has_control_socket;
        let keys_by_role = |count| Notice::KeysSuppressed {
            count,
            has_control_socket,
        };
        update(
            Topic::KeysByRole,
            &mut self.keys_by_role,
            suppressed.keys_by_role,
            &keys_by_role,
        );
        update(
            Topic::PointingByRole,
            &mut self.pointing_by_role,
            suppressed.pointing_by_role,
            &Notice::PointingSuppressed,
        );
    }

    /// Reports hands that are lost or found, by side. A loss does not delay the report that the hand is back.
    fn report_hands(&mut self, hints: &Hints, now: Instant, report: &mut impl FnMut(Notice)) {
        for (&side, (loss, reported)) in
            (Side::ALL.iter()).zip(hints.losses.iter().zip(&mut self.lost_hands))
        {
            // The notice of the implausible parts explains the loss, which lasts as long as they are implausible.
            let is_explained = hints.implausible[side.index()].concerns_hand();
            if *reported == loss.is_some() || is_explained && loss.is_none() {
                continue;
            }
            let (topic, notice) = match *loss {
                Some(loss) => (Topic::HandLost(side), Notice::HandLost(side, loss)),
                None => (Topic::HandFound(side), Notice::HandFound(side)),
            };
            if self.limits.admits(topic, now) {
                *reported = loss.is_some();
                report(notice);
            }
        }
    }

    fn report_bent(
        &mut self,
        step: &StepView,
        bent: FingerSet,
        now: Instant,
        report: &mut impl FnMut(Notice),
    ) {
        let is_disarmed = step.state == PipelineState::Paused && step.paused_by.is_none();
        if !is_disarmed || bent.is_empty() {
            self.bent = FingerSet::NONE;
        } else if self.bent != bent && self.limits.admits(Topic::Bent, now) {
            self.bent = bent;
            report(Notice::BentFingers(bent));
        }
    }

    /// Reports that the layout waits for an open hand, and, once, that a hand reaches none of its controls.
    fn report_place(
        &mut self,
        step: &StepView,
        hints: &Hints,
        now: Instant,
        report: &mut impl FnMut(Notice),
    ) {
        if !hints.awaits_start {
            self.is_awaiting = false;
        } else if !self.is_awaiting && self.limits.admits(Topic::Awaiting, now) {
            self.is_awaiting = true;
            report(Notice::AwaitingHand);
        }
        if let Some(Unreached { side, nearest }) = hints.unreached
            && !self.is_unreached
        {
            self.is_unreached = true;
            let nearest = nearest.map(|nearest| NearestTarget {
                name: nearest
                    .target
                    .map(|id| step.target_names.get(id).to_string()),
                way: nearest.way,
                is_on_board: nearest.is_on_board,
            });
            report(Notice::Unreached(side, nearest));
        }
    }

    fn report_state(&mut self, step: &StepView, now: Instant, report: &mut impl FnMut(Notice)) {
        let state = (step.state, step.paused_by);
        if self.state.replace(state) == Some(state) {
            return;
        }
        let (topic, limit, notice) = match state {
            (PipelineState::Starting | PipelineState::Stopped, _) => return,
            (PipelineState::Paused, Some(origin)) => {
                (Topic::Paused, AWAITED, Notice::Paused(origin))
            }
            (PipelineState::Paused, None) => (Topic::Disarmed, 1, Notice::Disarmed),
            (PipelineState::Running, _) => {
                let has_effect = self.has_effect;
                (Topic::Armed, AWAITED, Notice::Armed { has_effect })
            }
            (PipelineState::Stalled, _) => (Topic::Stalled, 1, Notice::Stalled),
        };
        let is_pause = topic == Topic::Paused;
        let Some(notice) = self.limits.admit(topic, limit, notice, now) else {
            return;
        };
        if is_pause {
            // The person who pauses waits for the notices that follow.
            self.limits.restart(|limited| {
                matches!(limited, Topic::Disarmed | Topic::Bent | Topic::Stalled)
            });
        }
        report(notice);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_return_of_a_hand_is_reported_although_its_loss_was_a_moment_ago() {
        let mut log = StatusLog::default();
        let start = Instant::now();
        let mut report_with = |seconds, loss, is_hand| {
            let mut notices = Vec::new();
            let now = start + Duration::from_secs(seconds);
            let mut implausible = [Implausible::default(); Side::COUNT];
            implausible[0].is_hand = is_hand;
            let hints = Hints {
                bent: FingerSet::NONE,
                awaits_start: false,
                unreached: None,
                implausible,
                losses: [loss, None],
            };
            log.report_hands(&hints, now, &mut |notice| notices.push(notice.to_string()));
            notices.concat()
        };
        let mut report = |seconds, loss| report_with(seconds, loss, false);
        let released = "what it held is released, and it touches nothing";
        assert_eq!(
            report(0, Some(HandLoss::NoReadings)),
            format!("no readings of the left hand: {released}")
        );
        assert_eq!(report(1, None), "the left hand is tracked again");
        // A contact that is loose does not fill the terminal.
        assert_eq!(report(2, Some(HandLoss::NoReadings)), "");
        assert_eq!(report(3, None), "");
        assert_eq!(
            report(11, Some(HandLoss::NotSeen)),
            format!("the left hand is not tracked: {released}")
        );
        // Another notice explains why the hand is still lost.
        assert_eq!(report_with(22, None, true), "");
        assert_eq!(
            report_with(23, None, false),
            "the left hand is tracked again"
        );
    }

    #[test]
    fn an_output_that_stalls_without_a_dropped_keystroke_gives_a_reason() {
        let mut log = StatusLog::default();
        let now = Instant::now();
        let mut report = |output_stalls, dropped_presses| {
            let stats = Stats {
                output_stalls,
                dropped_presses,
                ..Stats::default()
            };
            let mut notices = Vec::from_iter(log.output_stall(&stats, now));
            log.report_losses(&stats, now, &mut |notice| notices.push(notice));
            assert!(!notices.iter().any(Notice::is_routine), "{notices:?}");
            let texts: Vec<_> = notices.iter().map(ToString::to_string).collect();
            texts.join("; ")
        };
        assert_eq!(report(0, 0), "");
        let dropped = report(1, 2);
        assert!(dropped.starts_with("2 keystrokes dropped:"), "{dropped}");
        assert!(!dropped.contains("everything is released"), "{dropped}");
        assert_eq!(report(1, 2), "");
        let stalled = report(2, 2);
        assert!(
            stalled.starts_with("everything is released: this program or its output"),
            "{stalled}"
        );
        assert_eq!(report(2, 2), "");
    }

    #[test]
    fn suppressed_keys_name_a_command_only_if_it_can_reach_the_session() {
        for has_control_socket in [false, true] {
            let notice = Notice::KeysSuppressed {
                count: 2,
                has_control_socket,
            };
            let text = notice.to_string();
            assert!(text.starts_with("2 keys suppressed"), "{text}");
            assert!(text.contains("`--role both`"), "{text}");
            assert_eq!(text.contains("`ademan ctl"), has_control_socket, "{text}");
        }
    }
}
