//! Stages 2 to 5 for one frame: a reading in, events out.

use std::time::Duration;

use crate::capture::Reading;
use crate::contact::surface::Scene;
use crate::contact::tracker::ContactTracker;
use crate::contact::{TargetNames, Touches};
use crate::device::{Events, Out, Seen, Switchboard, VirtualDevice};
use crate::estimate::{Estimator, JointAngles, Rejection};
use crate::kinematics::{ArmModel, HandPose};
use crate::monitor::State;
use crate::time::Timestamp;

/// When the engine lets events out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arming {
    /// Whether the first reading arms, instead of a hand that is seen off all controls.
    pub at_once: bool,
    /// How long the hand has to be seen off all controls.
    pub neutral: Duration,
    /// How long readings may stay away before everything is let go.
    pub stall: Duration,
}

impl Default for Arming {
    /// Off all controls for 300 ms; a stall after 200 ms.
    fn default() -> Self {
        Self {
            at_once: false,
            neutral: Duration::from_millis(300),
            stall: Duration::from_millis(200),
        }
    }
}

/// What each stage made of one reading.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The angles.
    pub angles: JointAngles,
    /// Where they put the hand.
    pub pose: HandPose,
    /// What the fingertips did.
    pub touches: Touches,
}

/// What there is to be touched, and what comes of it.
pub struct Controls {
    scene: Scene,
    names: TargetNames,
    tracker: ContactTracker,
    switchboard: Switchboard,
    devices: Vec<Box<dyn VirtualDevice>>,
}

impl Controls {
    /// Controls that have not seen a hand yet: a fingertip that is in one of them at first has to come
    /// out before it touches anything.
    ///
    /// `names` are those of the targets, for outputs that write them.
    pub fn new(scene: Scene, names: TargetNames, devices: Vec<Box<dyn VirtualDevice>>) -> Self {
        Self {
            tracker: ContactTracker::new(&scene),
            scene,
            names,
            switchboard: Switchboard::default(),
            devices,
        }
    }

    /// The same with texts that keys write; see [`TextId`](crate::device::TextId).
    pub fn with_texts(self, texts: Vec<String>) -> Self {
        Self {
            switchboard: Switchboard::new(texts),
            ..self
        }
    }

    fn update(&mut self, frame: &Frame, events: &mut Events) {
        let seen = Seen {
            angles: &frame.angles,
            pose: &frame.pose,
            touches: &frame.touches,
        };
        let mut out = Out {
            switchboard: &mut self.switchboard,
            events,
        };
        for device in &mut self.devices {
            device.update(&seen, &mut out);
        }
    }

    fn is_clear(&self, pose: &HandPose) -> bool {
        self.tracker.is_clear(&self.scene, pose)
    }

    /// Ends every touch and lets go of everything.
    fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        let mut cancelled = Touches::new();
        self.tracker.reset(time, &mut cancelled);
        self.switchboard.release_all(time, events);
        let mut out = Out {
            switchboard: &mut self.switchboard,
            events,
        };
        for device in &mut self.devices {
            device.release_all(time, &mut out);
        }
    }
}

/// The way from a reading to events.
///
/// [`step`](Self::step) does not allocate, block, fail or read a clock: the same readings in give the
/// same events out.
pub struct Pipeline {
    estimator: Estimator,
    arm: ArmModel,
    controls: Controls,
    /// The latest, in place: it is too large to be passed around for nothing.
    frame: Frame,
    arming: Arming,
    state: State,
    last_accepted: Option<Timestamp>,
    clear_since: Option<Timestamp>,
    accepted: u64,
    rejected: [u64; Rejection::COUNT],
    stalls: u64,
}

impl Pipeline {
    /// A pipeline that has seen nothing yet.
    pub fn new(estimator: Estimator, arm: ArmModel, controls: Controls, arming: Arming) -> Self {
        let angles = JointAngles::at(Timestamp::default());
        Self {
            frame: Frame {
                angles,
                pose: arm.forward(&angles),
                touches: Touches::new(),
            },
            estimator,
            arm,
            controls,
            arming,
            state: State::Starting,
            last_accepted: None,
            clear_since: None,
            accepted: 0,
            rejected: [0; Rejection::COUNT],
            stalls: 0,
        }
    }

    /// Takes one reading and adds to `events` what goes out because of it.
    ///
    /// An error when the reading gives no angles; it is counted, and changes nothing else.
    pub fn step(&mut self, reading: &Reading, events: &mut Events) -> Result<&Frame, Rejection> {
        self.notice_gap(reading.time, events);
        let Frame {
            angles,
            pose,
            touches,
        } = &mut self.frame;
        let controls = &mut self.controls;
        *angles = self.estimator.apply(reading).inspect_err(|&reason| {
            self.rejected[reason.index()] += 1;
        })?;
        *pose = self.arm.forward(angles);
        touches.clear();
        controls.tracker.update(&controls.scene, pose, touches);
        self.accepted += 1;
        self.last_accepted = Some(pose.time);
        self.arm_when_clear();
        if self.state == State::Running {
            self.controls.update(&self.frame, events);
        }
        Ok(&self.frame)
    }

    /// Readings have stayed away for longer than they may: lets go of everything.
    ///
    /// The hand has to be seen off all controls before anything is pressed again.
    pub fn stall(&mut self, events: &mut Events) {
        let Some(last) = self.last_accepted.take() else {
            return;
        };
        self.stalls += 1;
        self.let_go(last + self.arming.stall, State::Stalled, events);
    }

    /// The end: lets go of everything, for good.
    pub fn stop(&mut self, events: &mut Events) {
        let time = self.last_accepted.unwrap_or_default();
        self.let_go(time, State::Stopped, events);
    }

    /// Lets go of everything and puts `controls` in force; those that were, let go of, are in its place
    /// afterwards.
    ///
    /// An engine that is running stays so: a fingertip that is in one of the new controls has to come out
    /// first. One that waits for a hand off all controls waits for one that is off the new ones.
    pub fn replace(&mut self, controls: &mut Controls, events: &mut Events) {
        let time = self.last_accepted.unwrap_or_default();
        self.controls.release_all(time, events);
        self.clear_since = None;
        std::mem::swap(&mut self.controls, controls);
    }

    /// What the targets are called.
    pub fn names(&self) -> &TargetNames {
        &self.controls.names
    }

    /// What the engine is doing.
    pub fn state(&self) -> State {
        self.state
    }

    /// Whether readings are expected: one came, and none has been missed since.
    pub fn is_fed(&self) -> bool {
        self.last_accepted.is_some()
    }

    /// How long readings may stay away.
    pub fn stall_limit(&self) -> Duration {
        self.arming.stall
    }

    /// Sets how long readings may stay away.
    pub fn set_stall_limit(&mut self, limit: Duration) {
        self.arming.stall = limit;
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

    /// The readings' own times tell of a stall too, so that a recording of one repeats it.
    fn notice_gap(&mut self, time: Timestamp, events: &mut Events) {
        let gap = self.last_accepted.map(|last| time.since(last));
        if gap.is_some_and(|gap| gap > self.arming.stall) {
            self.stall(events);
        }
    }

    fn let_go(&mut self, time: Timestamp, state: State, events: &mut Events) {
        self.controls.release_all(time, events);
        self.state = state;
        self.clear_since = None;
    }

    fn arm_when_clear(&mut self) {
        let pose = &self.frame.pose;
        match self.state {
            State::Running | State::Stopped => return,
            State::Starting if self.arming.at_once => {
                self.state = State::Running;
                return;
            }
            State::Starting => self.state = State::Paused,
            State::Paused | State::Stalled => {}
        }
        if !self.controls.is_clear(pose) {
            self.clear_since = None;
            return;
        }
        let since = *self.clear_since.get_or_insert(pose.time);
        if pose.time.since(since) >= self.arming.neutral {
            self.state = State::Running;
        }
    }
}
