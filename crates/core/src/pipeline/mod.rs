//! Stages 2 to 5 for one reading: estimation, kinematics, contact and devices, and the output gate.

mod arming;
mod auto_recenter;
mod bends;
mod board_move;
mod body_points;
mod command_error;
mod commands;
mod hand_pipeline;
mod hand_watch;
mod layout_instance;
mod learning;
mod other_hand;
mod output_gate;
mod permissions;
pub mod press_filter;
mod rate_limit;
mod release_order;
mod run_devices;
mod settings;
mod stalls;
mod start;
mod state;
mod text;
mod unreached;
mod zero;

pub use command_error::CommandError;
pub use layout_instance::LayoutInstance;
pub use permissions::{SourcePermissions, SourceRole};
pub use press_filter::{PressFilter, TextState};
pub use rate_limit::PressRateLimit;
pub use settings::PipelineSettings;
pub use stalls::HandLoss;
pub use state::{PipelineState, Suppressed};
pub use unreached::{NearestControl, Unreached};

use std::time::Duration;

use self::hand_pipeline::HandPipeline;
use self::output_gate::OutputGate;
use self::press_filter::PressFilters;
use self::zero::ZeroRequest;
use crate::capture::Reading;
use crate::command::{CommandOrigin, ProfileName};
use crate::contact::board_pose::BoardPose;
use crate::contact::{Presses, TargetNames, Touches};
use crate::device::{Events, TimedCommands};
use crate::estimate::{Estimate, FingerBends, HandEstimator, Rejection};
use crate::kinematics::{ArmModel, HandPose};
use crate::time::Timestamp;

/// The name of the first profile, whose layout is active at the start.
pub const MAIN_PROFILE: &str = "main";

/// The results of all stages for one reading.
#[derive(Clone, Debug)]
pub struct StepOutput {
    /// The result of the estimator.
    pub estimate: Estimate,
    /// The result of forward kinematics.
    pub pose: HandPose,
    /// The bends of the fingers; none if the layout does not depend on them.
    pub bends: FingerBends,
    /// The result of contact tracking.
    pub touches: Touches,
    /// The presses among the touches, with their evidence.
    pub presses: Presses,
    /// The commands of the devices. The pipeline has executed those that it [handles](Pipeline::handles); the others are
    /// left to the caller.
    pub commands: TimedCommands,
}

/// The pipeline from readings to events.
///
/// [`step`](Self::step) does not allocate, block, fail or read a clock: the same readings produce the
/// same events.
///
/// A straight hand arms the output, and a nod of its index finger presses the key below it:
///
/// ```
/// use ademan_core::capture::{Reading, Sample};
/// use ademan_core::device::{EventKind, Events, KeyCode};
/// use ademan_core::document::Document;
/// use ademan_core::estimate::{Estimator, EstimatorSettings};
/// use ademan_core::hand::{Dof, JointAngles};
/// use ademan_core::kinematics::ArmModel;
/// use ademan_core::layout::Layout;
/// use ademan_core::pipeline::{LayoutInstance, Pipeline, PipelineSettings};
/// use ademan_core::time::Timestamp;
///
/// let text = r#"Layout(name: "One key", boards: [(
///     pose: (anchor: wrist, forward_mm: 120, height_mm: -70), size_mm: Box(60, 60), travel_mm: 20,
///     keys: [(code: "Space", name: "big", at_mm: (0, 0))],
/// )])"#;
/// let layout = Layout::parse(text, "one-key.ron")?;
/// let mut pipeline = Pipeline::new(
///     Estimator::new(EstimatorSettings::default()),
///     ArmModel::parse(&Document::shipped("unam")?)?,
///     LayoutInstance::from_layout(&layout),
///     PipelineSettings::default(),
/// );
/// let mut events = Events::new();
/// let mut keys = Vec::new();
/// for hundredths in 0..150 {
///     let mut angles = JointAngles::default();
///     let nod = f64::from(hundredths.max(50) - 50) / 100.0;
///     angles.set(Dof::IndexMcpFlexion, 0.6 - 0.6 * (std::f64::consts::TAU * nod).cos());
///     let time = Timestamp::from_seconds(f64::from(hundredths) / 100.0);
///     // `step` appends to the events.
///     events.clear();
///     let output = pipeline.step(&Reading::new(time, None, Sample::Angles { angles }), &mut events)?;
///     for press in &output.presses {
///         assert_eq!(layout.target_names().get(press.target).to_string(), "big");
///     }
///     keys.extend(events.iter().map(|event| event.kind));
/// }
/// let space: KeyCode = "Space".parse()?;
/// assert_eq!(keys, [EventKind::KeyDown(space), EventKind::KeyUp(space)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Pipeline {
    /// The hands, one or two.
    hands: Vec<HandPipeline>,
    /// The profiles, at least one.
    profiles: Vec<Profile>,
    active_profile: usize,
    /// `true` if the text before the cursor may end inside a word, as far as the profiles before the active one know.
    is_inside_word: Option<bool>,
    settings: PipelineSettings,
    filters: PressFilters,
    gate: OutputGate,
    /// The state without a requested pause.
    state: PipelineState,
    /// The latest time of an accepted reading.
    time: Timestamp,
    /// The origin of a requested pause. `state` may change during the pause, but not to `Running`.
    paused_by: Option<CommandOrigin>,
    clear_since: Option<Timestamp>,
    /// A hand that is zeroed once it rests, because it has asked for it with the layout.
    zero_request: Option<ZeroRequest>,
    accepted: u64,
    rejected: [u64; Rejection::COUNT],
    stalls: u64,
}

/// One of the layouts of a setup.
struct Profile {
    name: ProfileName,
    layout: LayoutInstance,
}

impl Pipeline {
    /// Creates a pipeline for one hand, with the profile [`MAIN_PROFILE`].
    pub fn new(
        estimator: impl Into<HandEstimator>,
        arm: ArmModel,
        layout: LayoutInstance,
        settings: PipelineSettings,
    ) -> Self {
        let name = ProfileName::from(MAIN_PROFILE).expect("the name is short");
        Self {
            hands: vec![HandPipeline::new(estimator, arm)],
            profiles: vec![Profile { name, layout }],
            active_profile: 0,
            is_inside_word: None,
            settings,
            filters: PressFilters::default(),
            gate: OutputGate::new(settings.permissions, settings.allow_system_keys),
            state: PipelineState::Starting,
            time: Timestamp::default(),
            paused_by: None,
            clear_since: None,
            zero_request: None,
            accepted: 0,
            rejected: [0; Rejection::COUNT],
            stalls: 0,
        }
    }

    /// Adds the second hand. A reading belongs to the hand with its [side](Reading::side), or to the first
    /// hand if the reading has no side or no hand has it.
    #[must_use]
    pub fn with_second_hand(mut self, estimator: impl Into<HandEstimator>, arm: ArmModel) -> Self {
        self.hands.truncate(1);
        self.hands.push(HandPipeline::new(estimator, arm));
        self
    }

    /// Adds a source of its own for the second hand, with these permissions.
    #[must_use]
    pub fn with_second_source(mut self, permissions: SourcePermissions) -> Self {
        self.gate.add_source(permissions);
        self
    }

    /// Adds a filter of presses after the others.
    #[must_use]
    pub fn with_filter(mut self, filter: Box<dyn PressFilter>) -> Self {
        self.filters.add(filter);
        self
    }

    /// Adds profiles. One profile is active at a time, at first [`MAIN_PROFILE`] with index 0.
    #[must_use]
    pub fn with_profiles(
        mut self,
        profiles: impl IntoIterator<Item = (ProfileName, LayoutInstance)>,
    ) -> Self {
        let profiles = profiles.into_iter();
        self.profiles
            .extend(profiles.map(|(name, layout)| Profile { name, layout }));
        self
    }

    /// Processes one reading and appends the resulting events to `events`.
    ///
    /// The time of every reading, even of a rejected one, ends hands whose readings have stopped. Otherwise a rejected reading is
    /// only counted. The third consecutive one releases everything, because the state of the hand is no longer known.
    pub fn step(
        &mut self,
        reading: &Reading,
        events: &mut Events,
    ) -> Result<&StepOutput, Rejection> {
        self.gate.release_overdue(self.time, events);
        let (index, first) = (self.hand_index(reading), events.len());
        self.detect_gaps(reading.time, events);
        let hand = &mut self.hands[index];
        let estimate = &mut hand.output.estimate;
        let updated = hand.estimator.update(reading);
        let updated = updated.map(|new| estimate.copy_from(new));
        if hand.count_rejection(updated.is_err()) && self.state() == PipelineState::Running {
            self.release_all(self.time, events);
        }
        updated.inspect_err(|&reason| self.rejected[reason.index()] += 1)?;
        self.accepted += 1;
        self.time = self.time.max(reading.time);
        self.hands[index].accept(reading.time);
        self.hands[index].note_room(&reading.sample);
        self.update_pose(index);
        self.arm_if_clear(index);
        self.update_devices(index, events);
        self.release_followers(index, events);
        self.watch_reach(index, events.len() > first);
        self.place_at_start(index, events);
        self.zero_if_at_rest(events);
        self.learn_ranges(index);
        Ok(&self.hands[index].output)
    }

    /// Returns the results for the latest accepted reading of the hand that `reading` belongs to.
    pub fn output_for(&self, reading: &Reading) -> &StepOutput {
        &self.hands[self.hand_index(reading)].output
    }

    /// Runs forward kinematics and contact for the present estimate of a hand.
    fn update_pose(&mut self, index: usize) {
        self.update_other_wrist(index);
        let is_other_late = self.is_other_wrist_late(index);
        if self.layout().follows_body() {
            self.hands[index].update_body_points();
        }
        let hand = &mut self.hands[index];
        let output = &mut hand.output;
        let earlier = output.pose.time;
        hand.arm.forward_into(&output.estimate, &mut output.pose);
        let misses_readings = output.pose.time.since(earlier) > self.settings.max_sweep();
        output.pose.is_after_gap |= is_other_late || misses_readings;
        output.pose.misses_bends |= misses_readings;
        output.commands.clear();
        let layout = &mut self.profiles[self.active_profile].layout;
        layout.track(output, hand.estimator.bend_ranges());
    }

    fn update_devices(&mut self, index: usize, events: &mut Events) {
        if self.state == PipelineState::Running {
            self.run_devices(index, events);
        } else if self.is_paused() {
            self.run_devices_paused(index);
        }
    }

    /// Releases everything and emits no events until [`resume`](Self::resume), whatever happens to the
    /// readings or the layouts until then. If the pipeline is paused already, the stronger origin applies.
    pub fn pause(&mut self, origin: CommandOrigin, events: &mut Events) {
        if self.state == PipelineState::Stopped {
            return;
        }
        if let Some(earlier) = &mut self.paused_by {
            *earlier = earlier.or_stronger(origin);
            return;
        }
        let state = match self.state {
            PipelineState::Stalled => PipelineState::Stalled,
            _ => PipelineState::Paused,
        };
        self.disarm(self.time, state, events);
        self.paused_by = Some(origin);
    }

    /// Ends a pause. Output is armed after the hand has been clear of every control, even with
    /// [`arm_immediately`](PipelineSettings::arm_immediately).
    ///
    /// Has no effect without a pause, or if `origin` [may not end](CommandOrigin::may_end_pause_of) it.
    pub fn resume(&mut self, origin: CommandOrigin) {
        self.end_suspensions(origin);
        if !self
            .paused_by
            .is_some_and(|pause| origin.may_end_pause_of(pause))
        {
            return;
        }
        self.paused_by = None;
        let time = self.time;
        self.active_layout().release_all(time, &mut Events::new());
        self.clear_since = None;
    }

    /// Returns `true` if a pause was requested and has not ended.
    pub fn is_paused(&self) -> bool {
        self.paused_by.is_some()
    }

    /// Returns the origin of a pause that was requested and has not ended.
    pub fn paused_by(&self) -> Option<CommandOrigin> {
        self.paused_by
    }

    /// Releases everything, for the end of a session. No event is emitted afterwards, except a release that found no room.
    pub fn stop(&mut self, events: &mut Events) {
        self.disarm(self.time, PipelineState::Stopped, events);
    }

    /// Releases everything and exchanges the layout of a profile with `layout`; does nothing if there is no such
    /// profile.
    ///
    /// A running pipeline keeps running: a fingertip inside a new target must leave it before it can touch. A
    /// pipeline that is not armed waits for a hand that is clear of the new controls.
    pub fn replace_profile(
        &mut self,
        profile: usize,
        layout: &mut LayoutInstance,
        events: &mut Events,
    ) {
        if profile >= self.profiles.len() {
            return;
        }
        if profile == self.active_profile {
            self.release_all(self.time, events);
        }
        let active = &mut self.profiles[profile].layout;
        layout.take_over_text(active);
        std::mem::swap(active, layout);
    }

    /// Copies the board poses of a profile to `layout`, if both have the same number of boards.
    pub fn keep_board_poses(&self, profile: usize, layout: &mut LayoutInstance) {
        if let Some(other) = self.profiles.get(profile) {
            layout.copy_board_poses(&other.layout);
        }
    }

    /// Iterates over the board poses of the active layout.
    pub fn board_poses(&self) -> impl Iterator<Item = BoardPose> {
        self.profiles[self.active_profile].layout.board_poses()
    }

    /// Returns the names of the profiles, in order.
    pub fn profile_names(&self) -> impl Iterator<Item = &str> {
        self.profiles.iter().map(|profile| profile.name.as_str())
    }

    /// Returns the number of profiles.
    pub fn profile_count(&self) -> usize {
        self.profiles.len()
    }

    /// Returns the index of the active profile.
    pub fn active_profile(&self) -> usize {
        self.active_profile
    }

    /// Returns the active layout.
    pub fn layout(&self) -> &LayoutInstance {
        &self.profiles[self.active_profile].layout
    }

    /// Returns the names of the targets of the active layout.
    pub fn target_names(&self) -> &TargetNames {
        self.profiles[self.active_profile].layout.target_names()
    }

    /// Returns the state; `Paused` during a requested pause.
    pub fn state(&self) -> PipelineState {
        if self.is_paused() && self.state != PipelineState::Stopped {
            PipelineState::Paused
        } else {
            self.state
        }
    }

    /// Returns `true` if readings are expected: one was accepted, and no stall followed.
    pub fn expects_readings(&self) -> bool {
        self.hands.iter().any(|hand| hand.last_accepted.is_some())
    }

    /// Returns the longest gap between two readings.
    pub fn stall_timeout(&self) -> Duration {
        self.settings.stall_timeout
    }

    /// Sets the longest gap between two readings.
    pub fn set_stall_timeout(&mut self, timeout: Duration) {
        self.settings.stall_timeout = timeout;
        for hand in &mut self.hands {
            hand.estimator.set_timeout(timeout);
        }
    }

    /// Returns the latest time of an accepted reading.
    pub fn time(&self) -> Timestamp {
        self.time
    }

    /// Returns the number of accepted readings.
    pub fn accepted(&self) -> u64 {
        self.accepted
    }

    /// Returns the numbers of rejected readings by reason, in the order of [`Rejection::ALL`].
    pub fn rejected(&self) -> [u64; Rejection::COUNT] {
        self.rejected
    }

    /// Returns the number of stalls.
    pub fn stalls(&self) -> u64 {
        self.stalls
    }

    /// Returns the numbers of suppressed events.
    pub fn suppressed(&self) -> Suppressed {
        self.gate.suppressed()
    }

    fn active_layout(&mut self) -> &mut LayoutInstance {
        &mut self.profiles[self.active_profile].layout
    }

    /// Returns the index of the hand that a reading belongs to.
    fn hand_index(&self, reading: &Reading) -> usize {
        let is_hand = |hand: &HandPipeline| Some(hand.side()) == reading.side;
        self.hands.iter().position(is_hand).unwrap_or(0)
    }

    /// Releases everything. Before output is armed again, the hand must be clear of every control for the whole
    /// [`arm_delay`](PipelineSettings::arm_delay).
    fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        let first = events.len();
        let is_paused = self.is_paused();
        self.reset_filters();
        let layout = self.active_layout();
        if is_paused {
            // The presses of a pause were never emitted.
            layout.release_all(time, &mut Events::new());
        } else {
            layout.release_all(time, events);
        }
        self.gate.filter(|_| 0, first, 0, events);
        self.gate.release_all(time, events);
        self.clear_since = None;
    }
}
