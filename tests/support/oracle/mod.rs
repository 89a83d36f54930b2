//! A test oracle for the pipeline: checks after every step that the output keeps the safety invariants.
//!
//! - **I1** The pipeline emits only events that the active layout may emit. Without permission, the pressed keys never act
//!   on the system.
//! - **I2** A key is released before it is pressed again. In every state except
//!   [`Running`](PipelineState::Running), all keys are released and all axes are centered.
//! - **I3** Presses, motion and text come only from an accepted reading of the current time, with finite positions
//!   and with joint angles inside their limits.
//! - **I4** Releasing everything releases everything, and releases precede presses.
//! - **I5** The pointer stays on the screen and moves at most its maximum distance per step. Values are finite and
//!   inside their ranges.
//! - **I6** The state changes only along permitted transitions. The pipeline starts to run only after the hand has
//!   been clear of all controls for the arming delay. After that, a touch has to begin with a new contact, which
//!   the first step cannot be.

mod output_check;
mod state_check;
mod touch_check;
mod violation;

use ademan::capture::Reading;
use ademan::command::{Command, CommandOrigin};
use ademan::contact::Touch;
use ademan::device::pointer::{CursorOutput, PointerSettings};
use ademan::device::{Capabilities, OutputEvent, TimedCommand};
use ademan::estimate::{JointAngles, JointLimits};
use ademan::hand::Side;
use ademan::kinematics::HandPose;
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::pipeline::{PipelineSettings, StepOutput};
use ademan::snapshot::StepView;
use ademan::time::Timestamp;
use parry3d::math::Vec2;

pub use self::violation::Violation;

use self::output_check::OutputCheck;
use self::state_check::StateCheck;
use self::touch_check::TouchCheck;

/// The events that a layout may emit.
#[derive(Clone, Debug, Default)]
pub struct OutputRules {
    capabilities: Capabilities,
    /// Limits of the pointer, if only the arm moves it.
    pointer: Option<PointerBounds>,
}

/// The limits of pointer motion.
#[derive(Clone, Copy, Debug)]
pub struct PointerBounds {
    /// Size of the screen in pixels: width, height.
    pub screen: Vec2,
    /// Maximum distance per step in pixels.
    pub max_step: f32,
}

impl OutputRules {
    /// Creates the rules for a layout with these capabilities.
    pub fn new(
        capabilities: impl IntoIterator<Item = ademan::device::Capability>,
        pointer: Option<PointerBounds>,
    ) -> Self {
        Self {
            capabilities: capabilities.into_iter().collect(),
            pointer,
        }
    }

    /// Creates the rules for a layout. The pointer is checked only if no control moves it besides the arm.
    pub fn from_layout(layout: &Layout) -> Self {
        let bounds = |settings: &PointerSettings| PointerBounds {
            screen: settings.screen_px,
            max_step: settings.max_step_px,
        };
        let is_moved_by_arm_only = |settings: &&PointerSettings| {
            layout.controls.is_empty()
                && settings.output != CursorOutput::None
                && settings.depth.is_none()
        };
        Self {
            capabilities: layout.required_capabilities(),
            pointer: layout
                .pointer
                .as_ref()
                .filter(is_moved_by_arm_only)
                .map(bounds),
        }
    }
}

impl OutputRules {
    /// Adds the events that a text decoder may emit.
    pub fn with(mut self, more: &Capabilities) -> Self {
        self.capabilities.extend(more.iter());
        self
    }
}

impl From<Capabilities> for OutputRules {
    /// Creates rules without limits of the pointer.
    fn from(capabilities: Capabilities) -> Self {
        Self {
            capabilities,
            pointer: None,
        }
    }
}

/// The visible effect of one call of the pipeline.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// The call.
    pub cause: Cause,
    /// State after the call.
    pub state: PipelineState,
    /// Origin of a pause that was requested and not ended.
    pub paused_by: Option<CommandOrigin>,
    /// Index of the profile that was active before the call.
    pub profile: usize,
    /// Result of a reading that was accepted.
    pub output: Option<ObservedStep<'a>>,
    /// Events of the call.
    pub events: &'a [OutputEvent],
    /// Commands of the devices in that call.
    pub commands: &'a [TimedCommand],
}

/// The call of the pipeline that led to an observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A reading with this time stamp.
    Reading(Timestamp),
    /// A release of everything: a stall, a pause, another profile, moved boards, the end.
    ReleaseAll,
    /// Any other call. It may have released everything.
    Other,
}

/// The result of an accepted reading.
#[derive(Clone, Copy, Debug)]
pub struct ObservedStep<'a> {
    /// Joint angles.
    pub angles: &'a JointAngles,
    /// Pose of the hand at these angles.
    pub pose: &'a HandPose,
    /// Touches of the fingertips.
    pub touches: &'a [Touch],
}

impl<'a> From<&'a StepOutput> for ObservedStep<'a> {
    fn from(output: &'a StepOutput) -> Self {
        Self {
            angles: &output.estimate.angles,
            pose: &output.pose,
            touches: &output.touches,
        }
    }
}

impl<'a> From<&StepView<'a>> for Observation<'a> {
    fn from(step: &StepView<'a>) -> Self {
        let cause = |reading: &Reading| Cause::Reading(reading.time);
        let output = step.angles.zip(step.pose);
        Self {
            cause: step.reading.map_or(Cause::Other, cause),
            state: step.state,
            paused_by: step.paused_by,
            profile: step.profile,
            output: output.map(|(angles, pose)| ObservedStep {
                angles,
                pose,
                touches: step.touches,
            }),
            events: step.events,
            commands: step.commands,
        }
    }
}

/// A checker that follows a pipeline from its start and reports the first violation of an invariant.
///
/// It sees only what an observer of the pipeline sees and shares no code with it.
#[derive(Clone, Debug)]
pub struct Oracle {
    /// Rules of each profile, by index.
    rules: Vec<OutputRules>,
    limits: Option<JointLimits>,
    output: OutputCheck,
    state: StateCheck,
    touches: TouchCheck,
    last_time: [Option<Timestamp>; Side::COUNT],
}

impl Oracle {
    /// Creates an oracle for a new pipeline; `rules` are the rules of its profiles, in order.
    pub fn new(rules: impl IntoIterator<Item = OutputRules>, settings: PipelineSettings) -> Self {
        Self {
            rules: rules.into_iter().collect(),
            limits: Some(JointLimits::human()),
            output: OutputCheck::new(!settings.allow_system_keys),
            state: StateCheck::new(settings),
            touches: TouchCheck::default(),
            last_time: [None; Side::COUNT],
        }
    }

    /// Accepts every finite joint angle.
    #[must_use]
    pub fn without_limits(self) -> Self {
        Self {
            limits: None,
            ..self
        }
    }

    /// Replaces the rules of a profile. An index without a profile changes nothing.
    pub fn replace(&mut self, profile: usize, rules: OutputRules) {
        if let Some(old) = self.rules.get_mut(profile) {
            *old = rules;
            self.output.reset_pointer();
        }
    }

    /// Checks one call of the pipeline. Does not allocate.
    pub fn check<'a>(&mut self, observation: impl Into<Observation<'a>>) -> Result<(), Violation> {
        let observation = observation.into();
        self.check_pose(&observation)?;
        let before = self.state.state();
        self.state.check(&observation)?;
        check_silence(&observation, before.0)?;
        self.touches.check(&observation, before)?;
        let rules = self.rules.get(observation.profile);
        let rules = rules.ok_or(Violation::NoSuchProfile(observation.profile))?;
        let has_step = observation.output.is_some();
        // A command may release what the same step pressed before it.
        let is_sorted = observation.commands.is_empty();
        self.output
            .check(observation.events, rules, has_step, is_sorted)?;
        let is_released = observation.cause == Cause::ReleaseAll;
        if observation.state != PipelineState::Running || is_released {
            self.output.check_all_released(observation.state)?;
        }
        if is_released || observation.commands.iter().any(changes_profile) {
            self.output.reset_pointer();
        }
        Ok(())
    }

    /// Checks I1, I2 and I5 for the events of devices without a pipeline. With `is_release_all` everything has to
    /// be released afterwards. Does not allocate.
    pub fn check_devices(
        &mut self,
        events: &[OutputEvent],
        is_release_all: bool,
    ) -> Result<(), Violation> {
        let rules = self.rules.first().ok_or(Violation::NoSuchProfile(0))?;
        self.output.check(events, rules, !is_release_all, false)?;
        if is_release_all {
            self.output.check_all_released(PipelineState::Running)?;
            self.output.reset_pointer();
        }
        Ok(())
    }

    /// Returns `true` if a key or button is pressed or an axis is off center.
    pub fn has_pressed(&self) -> bool {
        self.output
            .check_all_released(PipelineState::Running)
            .is_err()
    }

    fn check_pose(&mut self, observation: &Observation) -> Result<(), Violation> {
        let Some(step) = observation.output else {
            return Ok(());
        };
        let (time, side) = (step.pose.time, step.pose.side);
        if observation.cause != Cause::Reading(time) {
            return Err(Violation::StalePose(time));
        }
        let last = &mut self.last_time[side.index()];
        if last.is_some_and(|last| time <= last) {
            return Err(Violation::PoseNotNewer(side));
        }
        *last = Some(time);
        for (dof, radians) in step.angles.known() {
            let range = self.limits.as_ref().map(|limits| limits.range(dof));
            let (low, high) = range.unwrap_or((f64::MIN, f64::MAX));
            if !(low..=high).contains(&radians) {
                return Err(Violation::AngleOutOfRange(dof, radians));
            }
        }
        match step.pose.known().find(|(_, pose)| !pose.is_finite()) {
            Some((joint, _)) => Err(Violation::PoseNotFinite(joint)),
            None => Ok(()),
        }
    }
}

/// Checks that no events occur between two states that suppress events.
fn check_silence(observation: &Observation, before: PipelineState) -> Result<(), Violation> {
    let running = PipelineState::Running;
    let is_silent = before != running && observation.state != running;
    match observation.events.first() {
        Some(event) if before == PipelineState::Stopped => {
            Err(Violation::EventAfterStop(event.kind))
        }
        // One step can arm the output, press a key and pause.
        Some(event) if is_silent && observation.output.is_none() => {
            Err(Violation::EventWhileNotRunning(event.kind))
        }
        _ => Ok(()),
    }
}

fn changes_profile(issued: &TimedCommand) -> bool {
    matches!(
        issued.command,
        Command::Profile { .. } | Command::NextProfile
    )
}
