//! Stages 2 to 5 for one frame: a reading in, events out.

mod layout_instance;
mod auto_recenter;
mod output_gate;
mod hand_pipeline;
mod board_move;
mod permissions;

pub use board_move::CommandError;
pub use layout_instance::LayoutInstance;
pub use output_gate::PressRateLimit;
pub use permissions::{SourcePermissions, SourceRole};

use std::time::Duration;

use parry3d::math::Vec3;

use self::board_move::Move;
use self::hand_pipeline::Hand;
use self::output_gate::Gate;
use crate::capture::Reading;
use crate::command::Command;
use crate::contact::board_pose::BoardPose;
use crate::contact::{TargetNames, Touches};
use crate::device::{Events, TimedCommands};
use crate::estimate::{Estimate, Estimator, Rejection};
use crate::hand::Side;
use crate::kinematics::{ArmModel, HandPose};
use crate::snapshot::{PipelineState, Suppressed};
use crate::time::Timestamp;

/// When the engine lets events out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PipelineSettings {
    /// Whether the first reading arms, instead of a hand that is seen off all controls.
    pub arm_immediately: bool,
    /// How long the hand has to be seen off all controls.
    pub arm_delay: Duration,
    /// How long readings may stay away before everything is let go.
    pub stall_timeout: Duration,
    /// What the source may do, that of the first hand where each has its own; after too many presses everything
    /// is let go of, and the engine pauses.
    pub permissions: SourcePermissions,
    /// Whether keys that act on the system may go out, see [`KeyCode::is_of_system`](crate::device::KeyCode).
    pub allow_system_keys: bool,
}

impl Default for PipelineSettings {
    /// Off all controls for 300 ms; a stall after 200 ms; a local source; no keys of the system.
    fn default() -> Self {
        Self {
            arm_immediately: false,
            arm_delay: Duration::from_millis(300),
            stall_timeout: Duration::from_millis(200),
            permissions: SourcePermissions::LOCAL,
            allow_system_keys: false,
        }
    }
}

/// What each stage made of one reading.
#[derive(Clone, Debug)]
pub struct StepOutput {
    /// The angles.
    pub estimate: Estimate,
    /// Where they put the hand.
    pub pose: HandPose,
    /// What the fingertips did.
    pub touches: Touches,
    /// The commands of the devices, whether the pipeline executed them or left them to the session.
    pub commands: TimedCommands,
}

/// The way from a reading to events.
///
/// [`step`](Self::step) does not allocate, block, fail or read a clock: the same readings in give the
/// same events out.
pub struct Pipeline {
    /// One or two.
    hands: Vec<Hand>,
    /// The controls of each layout of the setup; at least one.
    profiles: Vec<LayoutInstance>,
    /// The place of the controls in force.
    profile: usize,
    arming: PipelineSettings,
    gate: Gate,
    state: PipelineState,
    /// The latest time that a hand was seen.
    time: Timestamp,
    /// Whether a pause was asked for; the state below it goes on, but never to `Running`.
    is_paused: bool,
    clear_since: Option<Timestamp>,
    accepted: u64,
    rejected: [u64; Rejection::COUNT],
    stalls: u64,
}

impl Pipeline {
    /// A pipeline for one hand that has seen nothing yet.
    pub fn new(
        estimator: Estimator,
        arm: ArmModel,
        controls: LayoutInstance,
        arming: PipelineSettings,
    ) -> Self {
        Self {
            hands: vec![Hand::new(estimator, arm)],
            profiles: vec![controls],
            profile: 0,
            arming,
            gate: Gate::new(arming.permissions, arming.allow_system_keys),
            state: PipelineState::Starting,
            time: Timestamp::default(),
            is_paused: false,
            clear_since: None,
            accepted: 0,
            rejected: [0; Rejection::COUNT],
            stalls: 0,
        }
    }

    /// The same for the other hand too. A reading goes to the hand of its [side](Reading::side); one
    /// without, and one of a side that no hand has, to the first.
    #[must_use]
    pub fn with_second_hand(mut self, estimator: Estimator, arm: ArmModel) -> Self {
        self.hands.truncate(1);
        self.hands.push(Hand::new(estimator, arm));
        self
    }

    /// The same where the readings of the other hand come from a source of their own.
    #[must_use]
    pub fn with_second_source(mut self, rights: SourcePermissions) -> Self {
        self.gate.add_source(rights);
        self
    }

    /// The same with further layouts, of which one at a time is in force; the first that the pipeline was
    /// made with is number 0.
    #[must_use]
    pub fn with_profiles(mut self, further: impl IntoIterator<Item = LayoutInstance>) -> Self {
        self.profiles.extend(further);
        self
    }

    /// Takes one reading and adds to `events` what goes out because of it.
    ///
    /// An error when the reading gives no angles; it is counted, and changes nothing else, but that the third
    /// in a row lets go of everything: what is held then is held by a hand of which nothing is known.
    pub fn step(
        &mut self,
        reading: &Reading,
        events: &mut Events,
    ) -> Result<&StepOutput, Rejection> {
        let place = self.hand_of(reading);
        self.notice_gaps(place, reading.time, events);
        let applied = self.hands[place].estimator.update(reading);
        if self.hands[place].was_refused(applied.is_err()) && self.state() == PipelineState::Running
        {
            self.release_all(self.time, events);
        }
        let applied = applied.inspect_err(|&reason| self.rejected[reason.index()] += 1)?;
        let (hand, controls) = (&mut self.hands[place], &mut self.profiles[self.profile]);
        let StepOutput {
            estimate,
            pose,
            touches,
            commands,
        } = &mut hand.frame;
        commands.clear();
        *estimate = applied;
        *pose = hand.arm.forward(estimate);
        controls.touch(pose, touches);
        self.accepted += 1;
        self.time = self.time.max(pose.time);
        hand.last_accepted = Some(pose.time);
        self.arm_when_clear(place);
        if self.state == PipelineState::Running {
            let first = events.len();
            let only_point = self.only_point();
            let controls = &mut self.profiles[self.profile];
            let dropped = controls.update(&mut self.hands[place].frame, only_point, events);
            self.gate.count_keys(dropped);
            controls.drift(&self.hands[place].frame.pose);
            if !self.gate.pass(place, first, events) {
                self.pause(events);
            }
            self.execute_commands(place, events);
        } else if self.is_paused {
            self.listen_for_the_end_of_the_pause(place);
        }
        Ok(&self.hands[place].frame)
    }

    /// Readings have stayed away for longer than they may: lets go of everything.
    ///
    /// The hand has to be seen off all controls before anything is pressed again.
    pub fn stall(&mut self, events: &mut Events) {
        if self.state == PipelineState::Stopped {
            return;
        }
        let last = self.hands.iter().filter_map(|hand| hand.last_accepted);
        let Some(last) = last.max() else {
            return;
        };
        for hand in &mut self.hands {
            hand.last_accepted = None;
        }
        self.stalls += 1;
        self.let_go(
            last + self.arming.stall_timeout,
            PipelineState::Stalled,
            events,
        );
    }

    /// Lets go of everything; nothing goes out until [`resume`](Self::resume), whatever happens to the
    /// readings or the controls meanwhile.
    pub fn pause(&mut self, events: &mut Events) {
        if self.is_paused || self.state == PipelineState::Stopped {
            return;
        }
        let below = match self.state {
            PipelineState::Stalled => PipelineState::Stalled,
            _ => PipelineState::Paused,
        };
        self.let_go(self.time, below, events);
        self.is_paused = true;
    }

    /// Ends a pause: from now on the hand has to be seen off all controls before anything is pressed
    /// again, also where the first reading would have armed. Without a pause it does nothing.
    pub fn resume(&mut self) {
        if !std::mem::take(&mut self.is_paused) {
            return;
        }
        self.profiles[self.profile].release_all(self.time, &mut Events::new());
        self.clear_since = None;
    }

    /// Whether a pause was asked for and has not been ended.
    pub fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// The end: lets go of everything, for good.
    pub fn stop(&mut self, events: &mut Events) {
        self.let_go(self.time, PipelineState::Stopped, events);
    }

    /// Lets go of everything and puts `controls` in the place of those of a layout of the setup; those
    /// that were, let go of, are in its place afterwards. A place that there is not changes nothing.
    ///
    /// An engine that is running stays so: a fingertip that is in one of the new controls has to come out
    /// first. One that waits for a hand off all controls waits for one that is off the new ones.
    pub fn replace_profile(
        &mut self,
        profile: usize,
        controls: &mut LayoutInstance,
        events: &mut Events,
    ) {
        if profile >= self.profiles.len() {
            return;
        }
        if profile == self.profile {
            self.release_all(self.time, events);
        }
        std::mem::swap(&mut self.profiles[profile], controls);
    }

    /// Puts the boards of `controls` where those of a layout of the setup are, if they are as many.
    pub fn keep_board_poses(&self, profile: usize, controls: &mut LayoutInstance) {
        if let Some(others) = self.profiles.get(profile) {
            controls.put_as(others);
        }
    }

    /// Lets go of everything and puts another layout of the setup in force; a place that there is not
    /// changes nothing.
    pub fn switch_profile(&mut self, profile: usize, events: &mut Events) {
        if profile == self.profile || profile >= self.profiles.len() {
            return;
        }
        self.release_all(self.time, events);
        self.profile = profile;
        // What it remembers is of another time.
        self.release_all(self.time, events);
    }

    /// Lets go of everything and moves the boards in force by so many metres along the axes of the world.
    /// A fingertip that is in a control then has to come out before it touches anything.
    ///
    /// All boards stay where they are, and nothing is let go of, if one would be where no file can say.
    pub fn nudge(&mut self, by: Vec3, events: &mut Events) -> Result<(), CommandError> {
        self.profiles[self.profile].refuse(Move::Nudge(by))?;
        self.release_all(self.time, events);
        self.profiles[self.profile].shift(Move::Nudge(by));
        Ok(())
    }

    /// The same with a turn of each board about its own rows, through its (0, 0): by so many radians the
    /// far side rises.
    pub fn tilt(&mut self, by: f32, events: &mut Events) -> Result<(), CommandError> {
        self.profiles[self.profile].refuse(Move::Tilt(by))?;
        self.release_all(self.time, events);
        self.profiles[self.profile].shift(Move::Tilt(by));
        Ok(())
    }

    /// The same with the boards that are there for the hand seen last: they are shifted, all alike, so
    /// that the middle of the nearest one lies below the index fingertip. It is shifted in its own plane:
    /// the fingertip stays as far in front of its keys as it is. Needs a hand that has not stalled.
    pub fn recenter(&mut self, events: &mut Events) -> Result<(), CommandError> {
        let seen = |&place: &usize| {
            let last = self.hands[place].last_accepted?;
            (self.time.since(last) <= self.arming.stall_timeout).then_some(last)
        };
        let hands = (0..self.hands.len()).filter(|place| seen(place).is_some());
        let place = hands.max_by_key(seen).ok_or(CommandError::NoHand)?;
        let controls = &self.profiles[self.profile];
        let by = controls.way_to(&self.hands[place].frame.pose)?;
        controls.refuse(Move::Bring(by, &self.hands[place].frame.pose))?;
        self.release_all(self.time, events);
        let way = Move::Bring(by, &self.hands[place].frame.pose);
        self.profiles[self.profile].shift(way);
        Ok(())
    }

    /// Where the boards in force are.
    pub fn board_poses(&self) -> impl Iterator<Item = BoardPose> {
        self.profiles[self.profile].places()
    }

    /// How many layouts the setup has.
    pub fn profile_count(&self) -> usize {
        self.profiles.len()
    }

    /// The place of the layout in force.
    pub fn active_profile(&self) -> usize {
        self.profile
    }

    /// What the targets of the layout in force are called.
    pub fn target_names(&self) -> &TargetNames {
        self.profiles[self.profile].target_names()
    }

    /// What the engine is doing.
    pub fn state(&self) -> PipelineState {
        match self.is_paused && self.state != PipelineState::Stopped {
            true => PipelineState::Paused,
            false => self.state,
        }
    }

    /// Whether readings are expected: one came, and none has been missed since.
    pub fn expects_readings(&self) -> bool {
        self.hands.iter().any(|hand| hand.last_accepted.is_some())
    }

    /// How long readings may stay away.
    pub fn stall_timeout(&self) -> Duration {
        self.arming.stall_timeout
    }

    /// Sets how long readings may stay away.
    pub fn set_stall_timeout(&mut self, limit: Duration) {
        self.arming.stall_timeout = limit;
    }

    /// Readings that became a pose.
    pub fn accepted(&self) -> u64 {
        self.accepted
    }

    /// Readings that gave no angles, by reason, in the order of [`Rejection::ALL`].
    pub fn rejected(&self) -> [u64; Rejection::COUNT] {
        self.rejected
    }

    /// Times that readings stayed away for too long.
    pub fn stalls(&self) -> u64 {
        self.stalls
    }

    /// What did not go out.
    pub fn suppressed(&self) -> Suppressed {
        self.gate.withheld()
    }

    /// By side, the hands whose source presses no keys.
    fn only_point(&self) -> [bool; Side::COUNT] {
        let mut only_point = [false; Side::COUNT];
        for (place, hand) in self.hands.iter().enumerate() {
            only_point[hand.side().index()] = !self.gate.types(place);
        }
        only_point
    }

    /// The place of the hand that a reading is of.
    fn hand_of(&self, reading: &Reading) -> usize {
        let is_of = |hand: &Hand| Some(hand.side()) == reading.side;
        self.hands.iter().position(is_of).unwrap_or(0)
    }

    /// The readings' own times tell of a stall too, so that a recording of one repeats it. A hand that
    /// stays away while the other is seen is noticed by this as well.
    fn notice_gaps(&mut self, place: usize, time: Timestamp, events: &mut Events) {
        let limit = self.arming.stall_timeout;
        let is_late = |hand: &Hand| {
            hand.last_accepted
                .is_some_and(|last| time.since(last) > limit)
        };
        if !self.hands.iter().any(is_late) {
            return;
        }
        // The hand that is seen now is expected to be seen again.
        let now = self.hands[place].last_accepted;
        let was_late = is_late(&self.hands[place]);
        self.stall(events);
        if !was_late {
            self.hands[place].last_accepted = now;
        }
    }

    /// Lets go of everything; the hand has to be seen off all controls anew to arm.
    fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        let first = events.len();
        let controls = &mut self.profiles[self.profile];
        match self.is_paused {
            // What the controls are played for nothing in a pause never went down.
            true => controls.release_all(time, &mut Events::new()),
            false => controls.release_all(time, events),
        }
        self.gate.pass(0, first, events);
        self.clear_since = None;
    }

    fn let_go(&mut self, time: Timestamp, state: PipelineState, events: &mut Events) {
        self.release_all(time, events);
        self.state = state;
    }

    fn arm_when_clear(&mut self, place: usize) {
        if self.is_paused {
            return;
        }
        match self.state {
            PipelineState::Running | PipelineState::Stopped => return,
            PipelineState::Starting if self.arming.arm_immediately => {
                self.state = PipelineState::Running;
                return;
            }
            PipelineState::Starting => self.state = PipelineState::Paused,
            PipelineState::Paused | PipelineState::Stalled => {}
        }
        let hand = &mut self.hands[place];
        hand.is_clear = self.profiles[self.profile].is_clear(&hand.frame.pose);
        let is_in_the_way = |hand: &Hand| hand.last_accepted.is_some() && !hand.is_clear;
        if self.hands.iter().any(is_in_the_way) {
            self.clear_since = None;
            return;
        }
        let since = *self.clear_since.get_or_insert(self.time);
        if self.time.since(since) >= self.arming.arm_delay {
            self.state = PipelineState::Running;
        }
    }

    /// Executes the commands of a step that concern the pipeline; the session executes the others.
    fn execute_commands(&mut self, place: usize, events: &mut Events) {
        for issued in self.hands[place].frame.commands.clone() {
            match issued.command {
                Command::Profile { name } => {
                    if let Some(profile) = self.profiles[self.profile].profile(&name) {
                        self.switch_profile(profile, events);
                    }
                }
                Command::NextProfile => {
                    self.switch_profile((self.profile + 1) % self.profiles.len(), events);
                }
                // A step that executes commands is running, so the toggle pauses.
                Command::Pause | Command::TogglePause => self.pause(events),
                // A command that cannot be executed has no effect: nobody waits for a reply.
                Command::Recenter => {
                    let _ = self.recenter(events);
                }
                Command::Nudge { x_mm, y_mm, z_mm } => {
                    let _ = self.nudge(Vec3::new(x_mm, y_mm, z_mm) * 1e-3, events);
                }
                Command::Tilt { deg } => {
                    let _ = self.tilt(deg.to_radians(), events);
                }
                Command::Resume
                | Command::State
                | Command::Scale { .. }
                | Command::Save
                | Command::Reload
                | Command::Stop => {}
            }
        }
    }

    /// Updates the devices in a pause without emitting their events: only the command that ends the pause is
    /// executed.
    fn listen_for_the_end_of_the_pause(&mut self, place: usize) {
        let mut unheard = Events::new();
        let only_point = self.only_point();
        let controls = &mut self.profiles[self.profile];
        let frame = &mut self.hands[place].frame;
        controls.update(frame, only_point, &mut unheard);
        let mut commands = std::mem::take(&mut frame.commands).into_iter();
        let is_end = |command| matches!(command, Command::TogglePause | Command::Resume);
        if commands.any(|issued| is_end(issued.command)) {
            self.resume();
        }
    }
}
