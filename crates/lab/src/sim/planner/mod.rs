//! Translation of actions to movements.

mod aim;
mod bends;
mod joints;
mod route;
mod start;
mod state;
mod watch;

use std::time::Duration;

use parry3d::math::Vec3;

use super::action::{HandAction, TargetPoint};
use super::action_error::{ActionError, ActionErrorKind};
use super::effector::Effector;
use super::motor::Motor;
use super::movement::{ActiveMovement, Movement, TipPath};
use super::reach_target::ReachTarget;
use super::typing_hand::{REACH_TOLERANCE, TypingHand};
use crate::contact::TargetId;
use crate::contact::surface::Scene;
pub(super) use state::HandState;
use watch::Watch;

/// Time for which the hand is clear of all targets at the start and at the end.
const CLEAR_TIME: Duration = Duration::from_millis(600);
/// Duration of a press and of a lift; also the time for which a tap stays pressed.
const PRESS_TIME: Duration = Duration::from_millis(70);
/// Duration of a movement of joints, and of a pinch.
const TURN_TIME: Duration = Duration::from_millis(300);
/// Mean speed of a fingertip on a path without a duration, in m/s.
const SPEED: f64 = 0.25;
/// Smallest radius of an arc, in metres.
const MIN_RADIUS: f32 = 0.001;
/// Angle between two points of an arc that are checked for reach, in radians.
const CHECK_ANGLE: f32 = 0.25;
/// Largest difference from its value at rest that a channel keeps at the end, in counts, and as a part of its range.
const AWAY_COUNTS: f64 = 0.5;
const AWAY: f64 = 0.01;
/// Smallest number of packets of a press, so that a slow line transmits it.
const PRESS_PACKETS: u32 = 3;
/// Smallest number of packets of any other movement.
const MOVE_PACKETS: u32 = 5;

/// The movements of a hand, and its first posture.
pub(super) struct Plan {
    pub(super) hand: TypingHand,
    pub(super) start_values: Vec<f64>,
    pub(super) movements: Vec<Movement>,
    /// Number of movements up to the end of each action. The first movement shows the hand at the start.
    pub(super) action_ends: Vec<usize>,
}

/// Plans the actions of a hand above the targets of a scene; `period` is the time between two packets.
pub(super) fn plan(
    actions: &[HandAction],
    hand: TypingHand,
    motor: &Motor,
    scene: &Scene,
    period: Duration,
) -> Result<Plan, ActionError> {
    let state = HandState::new(hand.clone(), motor.clone());
    let mut planner = Planner::new(state, scene, period);
    planner.begin(actions);
    let start_values = planner.state.values.clone();
    let mut action_ends = Vec::with_capacity(actions.len());
    for (index, action) in actions.iter().enumerate() {
        let done = planner.add(action).and_then(|()| planner.check_pinch());
        done.map_err(|kind| ActionError { index, kind })?;
        action_ends.push(planner.movements.len());
    }
    if !actions.is_empty() {
        planner.end();
    }
    Ok(Plan {
        hand,
        start_values,
        movements: planner.movements,
        action_ends,
    })
}

/// A hand that is moved through the planned movements.
struct Planner<'a> {
    scene: &'a Scene,
    period: Duration,
    state: HandState,
    movements: Vec<Movement>,
    /// The fingertip starts above the first point of the actions.
    starts_above: bool,
    /// Contacts on the way to a target.
    watch: Option<Watch>,
}

/// The state of the fingertip that points.
#[derive(Clone, Copy)]
enum TipState {
    /// Above the front of a target, or at its first position.
    Clear,
    /// Pressing a target.
    Pressed(PressedTip),
    /// Anywhere in space.
    Free,
}

/// A fingertip that presses a target; its center is at `tip` (world, metres).
#[derive(Clone, Copy)]
struct PressedTip {
    id: TargetId,
    target: ReachTarget,
    tip: Vec3,
}

impl<'a> Planner<'a> {
    fn new(state: HandState, scene: &'a Scene, period: Duration) -> Self {
        Self {
            scene,
            period,
            state,
            movements: Vec::new(),
            starts_above: false,
            watch: None,
        }
    }

    /// Returns to the first posture, clear of all targets. A hand at a board that moves with the wrist stays above it.
    fn end(&mut self) {
        self.lift();
        if self.state.effector != Effector::INDEX {
            self.state.is_pinched = false;
            self.wait(CLEAR_TIME);
            return;
        }
        let is_away = |&(index, value): &(usize, f64)| {
            // A value is a count of a glove, or an angle in radians.
            let (low, high) = self.state.hand.variables[index].range;
            (self.state.values[index] - value).abs() > AWAY_COUNTS.min(AWAY * (high - low))
        };
        let rest = self.state.rest.iter().copied().enumerate();
        let channel_targets: Vec<(usize, f64)> = rest
            .filter(|&(index, _)| !self.state.hand.is_used_to_reach(index))
            .filter(is_away)
            .collect();
        let is_free = matches!(self.state.tip_state, TipState::Free);
        let tip = if is_free { self.state.home } else { self.tip() };
        self.state.is_pinched = false;
        if !channel_targets.is_empty() || is_free {
            let time = self.travel_time(tip).max(self.turn_time());
            self.push_movement(channel_targets, Some(TipPath::To(tip)), time, MOVE_PACKETS);
        }
        self.wait(CLEAR_TIME);
    }

    fn add(&mut self, action: &HandAction) -> Result<(), ActionErrorKind> {
        if self.state.is_displaced && !self.state.is_raised && action.target().is_none() {
            self.rise();
        }
        match action {
            HandAction::Chord(targets) => self.play_chord(targets),
            HandAction::Tap(point) => {
                self.press(*point)?;
                let time = self.state.motor.paced(PRESS_TIME);
                self.wait(time.max(PRESS_PACKETS * self.period));
                self.lift();
                Ok(())
            }
            HandAction::Press(point) => self.press(*point),
            HandAction::Push(target, fraction) => self.push(*target, *fraction),
            HandAction::Slide(offset, time) => {
                let pressed = self.pressed_tip()?;
                let offset = pressed.target.world_from_target.rotation * offset.extend(0.0);
                let path = TipPath::To(pressed.tip + offset);
                self.slide(pressed, path, offset.length(), *time)
            }
            HandAction::Arc(radians, time) => self.arc(*radians, *time),
            HandAction::Lift => {
                self.lift();
                Ok(())
            }
            HandAction::Wait(time) => {
                self.wait(*time);
                Ok(())
            }
            HandAction::SetAngles(angles, time) => self.set_angles(angles, *time),
            HandAction::Pinch(time) => self.pinch(time.unwrap_or(self.turn_time())),
            HandAction::Unpinch(time) => self.unpinch(time.unwrap_or(self.turn_time())),
            HandAction::SetInput(input, value) => self.set_input(*input, *value),
            HandAction::SetBody(angle, radians) => self.set_body(*angle, *radians),
            HandAction::Point(position, time) => self.point(*position, *time),
        }
    }

    fn press(&mut self, point: TargetPoint) -> Result<(), ActionErrorKind> {
        if self.finger_of(point.target).is_some() {
            self.lift();
            return self.bend(&[point.target]);
        }
        self.press_by_any(point, |target| target.bottom_height)
    }

    fn push(&mut self, id: TargetId, fraction: f32) -> Result<(), ActionErrorKind> {
        if let TipState::Pressed(mut pressed) = self.state.tip_state
            && pressed.id == id
        {
            let pad = pressed.target.pad_position(pressed.tip);
            let point = TargetPoint {
                target: id,
                offset: pad.truncate(),
            };
            let height = -fraction * pressed.target.travel;
            pressed.tip = pressed.target.tip_position(point, height);
            let path = TipPath::To(pressed.tip);
            let distance = self.move_tip(path, self.press_time(), PRESS_PACKETS);
            self.check_reach(distance, Some(id))?;
            self.state.tip_state = TipState::Pressed(pressed);
            return Ok(());
        }
        self.press_by_any(TargetPoint::center(id), |target| -fraction * target.travel)
    }

    fn lift(&mut self) {
        self.straighten();
        let TipState::Pressed(PressedTip { id, target, tip }) = self.state.tip_state else {
            return;
        };
        let point = TargetPoint {
            target: id,
            offset: target.pad_position(tip).truncate(),
        };
        let hover = target.tip_position(point, target.hover_height);
        self.move_tip(TipPath::To(hover), self.press_time(), PRESS_PACKETS);
        self.mark_last(false);
        self.state.tip_state = TipState::Clear;
    }

    fn arc(&mut self, radians: f32, time: Option<Duration>) -> Result<(), ActionErrorKind> {
        let pressed = self.pressed_tip()?;
        let offset = pressed.target.pad_position(pressed.tip).truncate();
        if offset.length() < MIN_RADIUS {
            return Err(ActionErrorKind::AtCenter);
        }
        let rotation = pressed.target.world_from_target.rotation;
        let path = TipPath::Around {
            center: pressed.tip - rotation * offset.extend(0.0),
            axis: rotation * Vec3::Z,
            radians,
        };
        self.slide(pressed, path, offset.length() * radians.abs(), time)
    }

    /// Moves the pressed fingertip along a path of this length in metres.
    fn slide(
        &mut self,
        mut pressed: PressedTip,
        path: TipPath,
        length: f32,
        time: Option<Duration>,
    ) -> Result<(), ActionErrorKind> {
        let time = time.unwrap_or_else(|| self.slide_time(length));
        let distance = self.move_tip(path, time, PRESS_PACKETS);
        self.check_reach(distance, Some(pressed.id))?;
        pressed.tip = path.end(pressed.tip);
        self.state.tip_state = TipState::Pressed(pressed);
        Ok(())
    }

    fn point(&mut self, position: Vec3, time: Option<Duration>) -> Result<(), ActionErrorKind> {
        self.lift();
        self.point_with(Effector::INDEX);
        let tip = self.state.hand.elbow() + position;
        let length = tip.distance(self.tip());
        let time = time.unwrap_or_else(|| self.slide_time(length));
        let distance = self.move_tip(TipPath::To(tip), time, MOVE_PACKETS);
        self.state.tip_state = TipState::Free;
        self.check_reach(distance, None)
    }

    fn pressed_tip(&self) -> Result<PressedTip, ActionErrorKind> {
        match self.state.tip_state {
            TipState::Pressed(pressed) => Ok(pressed),
            TipState::Clear | TipState::Free => Err(ActionErrorKind::NotPressed),
        }
    }

    fn reach_target(&self, target: TargetId) -> Result<ReachTarget, ActionErrorKind> {
        if self.scene.target(target).is_none() {
            return Err(ActionErrorKind::NotOnBoard);
        }
        let out_of_reach = ActionErrorKind::OutOfReach {
            target: Some(target),
            metres: f64::INFINITY,
        };
        self.state
            .hand
            .reach_target(self.scene, target)
            .ok_or(out_of_reach)
    }

    fn wait(&mut self, time: Duration) {
        let packets = self.packets(time, 1);
        self.movements.push(Movement {
            channel_targets: Vec::new(),
            path: None,
            input: None,
            effector: self.state.effector,
            is_pinched: false,
            is_down: self.is_down(),
            ends_down: self.is_down(),
            packets,
        });
    }

    /// Returns the position of the fingertip that points, in metres in the world.
    fn tip(&self) -> Vec3 {
        let state = &self.state;
        state.hand.tip_of(state.effector.finger, &state.values)
    }

    fn is_down(&self) -> bool {
        matches!(self.state.tip_state, TipState::Pressed(_))
    }

    /// Adds a movement of the fingertip along a path; see [`push_movement`](Self::push_movement).
    fn move_tip(&mut self, path: TipPath, time: Duration, min_packets: u32) -> f64 {
        if self.state.effector != Effector::INDEX {
            return self.move_finger(path, time, min_packets);
        }
        self.push_movement(Vec::new(), Some(path), time, min_packets)
    }

    /// Adds a movement that takes `time` and at least `min_packets`. Returns the largest distance from the fingertip
    /// to its path in metres.
    fn push_movement(
        &mut self,
        channel_targets: Vec<(usize, f64)>,
        path: Option<TipPath>,
        time: Duration,
        min_packets: u32,
    ) -> f64 {
        let movement = Movement {
            channel_targets,
            path,
            input: None,
            effector: self.state.effector,
            is_pinched: self.state.is_pinched,
            is_down: self.is_down(),
            ends_down: self.is_down(),
            packets: self.packets(time, min_packets),
        };
        let active =
            ActiveMovement::begin(movement.clone(), &mut self.state.hand, &self.state.values);
        self.movements.push(movement);
        // The posture of a pinching thumb depends on all steps before it.
        let steps = if self.state.is_pinched {
            active.packets()
        } else {
            check_steps(path)
        };
        let before = self.state.values.clone();
        let distance = self.perform(&active, steps);
        if let Some(watch) = &mut self.watch {
            let duration = self.period * active.packets();
            watch.follow((&active, duration), before, &self.state, self.scene);
        }
        distance
    }

    /// Performs a movement in `steps` steps, and again packet by packet if one of them is out of reach: inverse kinematics finds
    /// distant solutions only in short steps. Returns the largest distance from the path in metres.
    fn perform(&mut self, active: &ActiveMovement, steps: u32) -> f64 {
        let before = self.state.values.clone();
        let mut max_distance = 0_f64;
        for count in [steps, active.packets()] {
            self.state.values.clone_from(&before);
            max_distance = 0.0;
            for step in 1..=count {
                let fraction = step as f32 / count as f32;
                let distance = active.step(fraction, &self.state.hand, &mut self.state.values);
                max_distance = max_distance.max(distance);
            }
            if max_distance <= REACH_TOLERANCE {
                break;
            }
        }
        max_distance
    }

    fn packets(&self, time: Duration, min: u32) -> u32 {
        let packets = (time.as_secs_f64() / self.period.as_secs_f64()).ceil() as u32;
        packets.max(min)
    }

    /// Returns the time of a movement to a point by Fitts's law: MT = a + b log₂(A/W + 1) with a = 60 ms and b = 85 ms, the middle of
    /// the published ranges for taps of a fingertip, and W = 19 mm, the width of a key.
    fn travel_time(&self, to: Vec3) -> Duration {
        let distance = self.tip().distance(to);
        let difficulty = (f64::from(distance) / 0.019 + 1.0).log2();
        let usual = Duration::from_secs_f64(0.060 + 0.085 * difficulty);
        self.state.motor.paced(usual)
    }

    fn press_time(&self) -> Duration {
        self.state.motor.paced(PRESS_TIME)
    }

    fn turn_time(&self) -> Duration {
        self.state.motor.paced(TURN_TIME)
    }

    fn slide_time(&self, length: f32) -> Duration {
        let usual = Duration::from_secs_f64(f64::from(length) / SPEED).max(PRESS_TIME);
        self.state.motor.paced(usual)
    }
}

/// Returns the number of points of a path that are checked for reach.
fn check_steps(path: Option<TipPath>) -> u32 {
    match path {
        Some(TipPath::Around { radians, .. }) => {
            (radians.abs() / CHECK_ANGLE).ceil().max(1.0) as u32
        }
        Some(TipPath::To(_)) | None => 1,
    }
}
