//! A judge of the engine: whatever comes in, what goes out keeps the invariants that make it safe.
//!
//! - **I1** Nothing goes out that the layout in force may not send.
//! - **I2** What goes down comes up before it goes down again; nothing is down, and no axis off its rest,
//!   in any state but [`Running`](State::Running).
//! - **I3** Nothing is pressed, moved or written but by an accepted frame of this very moment, whose numbers
//!   are finite and whose joints are within their ranges.
//! - **I4** Letting go lets go of all, and what comes up goes out before what goes down.
//! - **I5** The pointer stays on the screen and goes no further in a frame than it may; values are numbers
//!   within their ranges.
//! - **I6** Only the changes of state that there are; `Running` only by a hand that was off all controls for
//!   long enough; after that a touch has to begin, and not with the first frame.

mod output_check;
mod state_check;
#[cfg(test)]
mod tests;
mod touch_check;
mod violation;

use parry3d::math::Vec2;

pub use self::violation::Violation;

use self::output_check::OutputCheck;
use self::state_check::StateCheck;
use self::touch_check::TouchCheck;
use crate::contact::Touch;
use crate::device::pointer::{CursorOutput, PointerSettings};
use crate::device::{Capabilities, EventKind, OutputEvent, Request};
use crate::estimate::{JointAngles, JointLimits};
use crate::hand::Side;
use crate::kinematics::HandPose;
use crate::layout::Layout;
use crate::pipeline::{PipelineSettings, StepOutput};
use crate::snapshot::{PipelineState, Snapshot};
use crate::time::Timestamp;

/// What a layout may send.
#[derive(Clone, Debug, Default)]
pub struct OutputRules {
    needs: Capabilities,
    /// Of a layout in which nothing but the arm moves the pointer.
    pointer: Option<PointerBounds>,
}

/// How far a pointer goes in a frame.
#[derive(Clone, Copy, Debug)]
struct PointerBounds {
    /// Pixels to the right and up.
    screen: Vec2,
    /// In pixels.
    max_step: f32,
}

impl OutputRules {
    /// Those of a layout: what it needs, and the longest step of its pointer where nothing else moves one.
    pub fn from_layout(layout: &Layout) -> Self {
        let bounds = |settings: &PointerSettings| PointerBounds {
            screen: settings.screen_px,
            max_step: settings.max_step_px,
        };
        let is_alone = |settings: &&PointerSettings| {
            layout.controls.is_empty()
                && settings.output != CursorOutput::None
                && settings.depth.is_none()
        };
        Self {
            needs: layout.required_capabilities(),
            pointer: layout.pointer.as_ref().filter(is_alone).map(bounds),
        }
    }
}

impl From<Capabilities> for OutputRules {
    /// Nothing is known of how far a pointer may go.
    fn from(needs: Capabilities) -> Self {
        Self {
            needs,
            pointer: None,
        }
    }
}

/// What an observer sees of an engine after it was asked for something.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// What it was asked for.
    pub cause: Cause,
    /// Its state afterwards.
    pub state: PipelineState,
    /// Whether it is paused because somebody asked for that.
    pub is_paused: bool,
    /// The place of the layout that was in force before.
    pub profile: usize,
    /// What became of a reading that was accepted.
    pub output: Option<ObservedStep<'a>>,
    /// What went out.
    pub events: &'a [OutputEvent],
}

/// What an engine was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// To take a reading of this time.
    Reading(Timestamp),
    /// To let go of everything: a stall, a pause, another layout, moved boards, the end.
    ReleaseAll,
    /// Something else than a reading; it may have let go.
    Other,
}

/// What became of a reading.
#[derive(Clone, Copy, Debug)]
pub struct ObservedStep<'a> {
    /// The angles.
    pub angles: &'a JointAngles,
    /// Where they put the hand.
    pub pose: &'a HandPose,
    /// What the fingertips did.
    pub touches: &'a [Touch],
}

impl<'a> From<&'a StepOutput> for ObservedStep<'a> {
    fn from(frame: &'a StepOutput) -> Self {
        Self {
            angles: &frame.angles,
            pose: &frame.pose,
            touches: &frame.touches,
        }
    }
}

impl<'a> From<&'a Snapshot> for Observation<'a> {
    fn from(snapshot: &'a Snapshot) -> Self {
        let frame = snapshot.angles.as_ref().zip(snapshot.pose.as_ref());
        let reading = snapshot.reading.as_ref();
        Self {
            cause: reading.map_or(Cause::Other, |reading| Cause::Reading(reading.time)),
            state: snapshot.state,
            is_paused: snapshot.is_paused,
            profile: snapshot.profile,
            output: frame.map(|(angles, pose)| ObservedStep {
                angles,
                pose,
                touches: &snapshot.touches,
            }),
            events: &snapshot.events,
        }
    }
}

/// Follows an engine from its start and tells the first time that it breaks an invariant.
///
/// It sees no more than an observer does, and knows nothing of how the engine works.
#[derive(Clone, Debug)]
pub struct Oracle {
    /// Those of each layout of the setup.
    rules: Vec<OutputRules>,
    limits: Option<JointLimits>,
    ledger: OutputCheck,
    passage: StateCheck,
    touching: TouchCheck,
    last: [Option<Timestamp>; Side::COUNT],
}

impl Oracle {
    /// One for an engine that has seen nothing yet; `rules` are those of each layout of its setup.
    pub fn new(rules: impl IntoIterator<Item = OutputRules>, arming: PipelineSettings) -> Self {
        Self {
            rules: rules.into_iter().collect(),
            limits: Some(JointLimits::human()),
            ledger: OutputCheck::default(),
            passage: StateCheck::new(arming),
            touching: TouchCheck::default(),
            last: [None; Side::COUNT],
        }
    }

    /// The same for an estimator that lets every finite angle pass.
    #[must_use]
    pub fn without_limits(self) -> Self {
        Self {
            limits: None,
            ..self
        }
    }

    /// From now on another layout has this place in the setup. A place that there is not changes nothing.
    pub fn replace(&mut self, profile: usize, rules: OutputRules) {
        if let Some(old) = self.rules.get_mut(profile) {
            *old = rules;
            self.ledger.reset_pointer();
        }
    }

    /// Judges one step. Does not allocate.
    pub fn check<'a>(&mut self, step: impl Into<Observation<'a>>) -> Result<(), Violation> {
        let step = step.into();
        self.check_pose(&step)?;
        let before = self.passage.state();
        self.passage.check(&step)?;
        self.check_silence(&step, before.0)?;
        self.touching.check(&step, before)?;
        let rules = self.rules.get(step.profile);
        let rules = rules.ok_or(Violation::NoSuchProfile(step.profile))?;
        self.ledger
            .check(step.events, rules, step.output.is_some(), true)?;
        if step.state != PipelineState::Running || step.cause == Cause::ReleaseAll {
            self.ledger.check_all_released(step.state)?;
        }
        if step.cause == Cause::ReleaseAll || step.events.iter().any(changes_the_layout) {
            self.ledger.reset_pointer();
        }
        Ok(())
    }

    /// Judges what devices send that have no engine around them: I1, I2 and I5. With `lets_go` nothing may
    /// be down afterwards. Does not allocate.
    pub fn check_devices(
        &mut self,
        events: &[OutputEvent],
        lets_go: bool,
    ) -> Result<(), Violation> {
        let rules = self.rules.first().ok_or(Violation::NoSuchProfile(0))?;
        self.ledger.check(events, rules, !lets_go, false)?;
        if lets_go {
            self.ledger.check_all_released(PipelineState::Running)?;
            self.ledger.reset_pointer();
        }
        Ok(())
    }

    /// Whether a key or button is down, or an axis off its rest.
    pub fn has_pressed(&self) -> bool {
        self.ledger
            .check_all_released(PipelineState::Running)
            .is_err()
    }

    fn check_pose(&mut self, step: &Observation) -> Result<(), Violation> {
        let Some(frame) = step.output else {
            return Ok(());
        };
        let (time, side) = (frame.pose.time, frame.pose.side);
        if step.cause != Cause::Reading(time) || frame.angles.time != time {
            return Err(Violation::StalePose(time));
        }
        let last = &mut self.last[side.index()];
        if last.is_some_and(|last| time <= last) {
            return Err(Violation::PoseNotNewer(side));
        }
        *last = Some(time);
        for (dof, radians) in frame.angles.known() {
            let range = self.limits.as_ref().map(|limits| limits.range(dof));
            let (low, high) = range.unwrap_or((f64::MIN, f64::MAX));
            if !(low..=high).contains(&radians) {
                return Err(Violation::AngleOutOfRange(dof, radians));
            }
        }
        match frame.pose.known().find(|(_, pose)| !pose.is_finite()) {
            Some((joint, _)) => Err(Violation::PoseNotFinite(joint)),
            None => Ok(()),
        }
    }

    /// Nothing goes out between two states that let nothing out.
    fn check_silence(&self, step: &Observation, before: PipelineState) -> Result<(), Violation> {
        let is_idle = before != PipelineState::Running && step.state != PipelineState::Running;
        match step.events.first() {
            Some(event) if before == PipelineState::Stopped => {
                Err(Violation::EventAfterStop(event.kind))
            }
            // A frame can arm, be pressed in and pause.
            Some(event) if is_idle && step.output.is_none() => {
                Err(Violation::EventWhileNotRunning(event.kind))
            }
            _ => Ok(()),
        }
    }
}

fn changes_the_layout(event: &OutputEvent) -> bool {
    matches!(
        event.kind,
        EventKind::Ask(Request::Profile(_) | Request::NextProfile)
    )
}
