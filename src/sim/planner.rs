//! From orders to the movements that carry them out.

use std::time::Duration;

use parry3d::math::Vec3;

use super::action::{HandAction, TargetPoint};
use super::action_error::{ActionError, ActionErrorKind};
use super::movement::{Motion, Movement, TipPath};
use super::typing_hand::{Front, PINCH_GAP, REACH_TOLERANCE, TypingHand};
use crate::contact::TargetId;
use crate::contact::surface::Scene;
use crate::hand::{Dof, Finger};
use crate::names::UnknownName;

/// The hand is shown off all targets for so long at the start, and again at the end.
const SHOW: Duration = Duration::from_millis(600);
/// How long a press or a lift takes, and how long a tap stays down.
const STROKE: Duration = Duration::from_millis(70);
/// How long a joint takes to another angle, and the thumb to the index finger.
const TURN: Duration = Duration::from_millis(300);
/// The mean speed of a fingertip on a way whose time is not said, in m/s.
const SPEED: f64 = 0.25;
/// Nearer to the middle of a target than this, in metres, there is no going around it.
const LEAST_RADIUS: f32 = 0.001;
/// A way around is looked at this often, in radians, for places that are out of reach.
const LOOK: f32 = 0.25;

/// What a hand does, and the posture that it begins in.
pub(super) struct Plan {
    pub(super) hand: TypingHand,
    pub(super) start: Vec<f64>,
    pub(super) movements: Vec<Movement>,
    /// How many movements there are up to the end of each order; the first is the show at the start.
    pub(super) ends: Vec<usize>,
}

/// Plans orders for a hand over the targets of a scene, shown in frames that are `period` apart.
pub(super) fn plan(
    orders: &[HandAction],
    hand: TypingHand,
    scene: &Scene,
    period: Duration,
) -> Result<Plan, ActionError> {
    let mut planner = Planner {
        scene,
        period,
        values: hand.rest_values(),
        rest: hand.rest_values(),
        hand: hand.clone(),
        movements: Vec::new(),
        place: TipState::Off,
        is_pinched: false,
        before_pinch: Vec::new(),
        home: Vec3::ZERO,
    };
    planner.begin(orders);
    let start = planner.values.clone();
    let mut ends = Vec::with_capacity(orders.len());
    for (number, order) in orders.iter().enumerate() {
        let done = planner.order(order).and_then(|()| planner.check_pinch());
        done.map_err(|reason| ActionError {
            index: number,
            kind: reason,
        })?;
        ends.push(planner.movements.len());
    }
    planner.end();
    Ok(Plan {
        hand,
        start,
        movements: planner.movements,
        ends,
    })
}

/// Follows the hand through the movements that it plans.
struct Planner<'a> {
    scene: &'a Scene,
    period: Duration,
    hand: TypingHand,
    /// The posture that the hand comes back to at the end.
    rest: Vec<f64>,
    /// The posture after the movements so far.
    values: Vec<f64>,
    movements: Vec<Movement>,
    place: TipState,
    is_pinched: bool,
    /// What the pinch changed besides the thumb: places in the posture, and their values before.
    before_pinch: Vec<(usize, f64)>,
    /// Where the fingertip began, off all targets (world, metres).
    home: Vec3,
}

/// Where the index fingertip is.
#[derive(Clone, Copy)]
enum TipState {
    /// Over the front of a target, or where the hand began.
    Off,
    /// Down on a target.
    Down(PressedTip),
    /// Somewhere in space.
    Anywhere,
}

/// A fingertip that is down, at `tip` (world, metres).
#[derive(Clone, Copy)]
struct PressedTip {
    target: TargetId,
    front: Front,
    tip: Vec3,
}

impl Planner<'_> {
    /// The hand begins over the first target that it is to press, so that it is seen off all of them.
    fn begin(&mut self, orders: &[HandAction]) {
        if orders.is_empty() {
            return;
        }
        // Whether it can be pressed is seen when it is its turn.
        if let Some(spot) = orders.iter().find_map(HandAction::target_point)
            && let Ok(front) = self.front(spot.target)
        {
            let hover = front.tip(spot, front.hover);
            self.hand.reach(hover, &mut self.values, &[]);
        }
        self.home = self.hand.tip(&self.values);
        self.wait(SHOW);
    }

    /// The hand is seen off all targets, as it was at the start.
    fn end(&mut self) {
        if self.movements.is_empty() {
            return;
        }
        self.lift();
        let back = self.rest.iter().copied().enumerate();
        let turns: Vec<(usize, f64)> = back
            .filter(|&(place, value)| {
                !self.hand.reaches_with(place) && (self.values[place] - value).abs() > 0.5
            })
            .collect();
        let tip = match self.place {
            TipState::Anywhere => self.home,
            TipState::Off | TipState::Down(_) => self.hand.tip(&self.values),
        };
        self.is_pinched = false;
        if !turns.is_empty() || matches!(self.place, TipState::Anywhere) {
            let time = self.travel_time(tip).max(TURN);
            self.go(turns, Some(TipPath::To(tip)), time, 5);
        }
        self.wait(SHOW);
    }

    fn order(&mut self, order: &HandAction) -> Result<(), ActionErrorKind> {
        match order {
            HandAction::Tap(spot) => {
                self.press(*spot)?;
                self.wait(STROKE.max(3 * self.period));
                self.lift();
                Ok(())
            }
            HandAction::Press(spot) => self.press(*spot),
            HandAction::Push(target, share) => self.push(*target, *share),
            HandAction::Slide(by, time) => {
                let down = self.down()?;
                let by = down.front.world_from_target.rotation * by.extend(0.0);
                self.slide(down, TipPath::To(down.tip + by), by.length(), *time)
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
            HandAction::SetAngles(angles, time) => self.turn(angles, *time),
            HandAction::Pinch(time) => self.pinch(time.unwrap_or(TURN)),
            HandAction::Unpinch(time) => self.unpinch(time.unwrap_or(TURN)),
            HandAction::Point(place, time) => self.point(*place, *time),
        }
    }

    fn press(&mut self, spot: TargetPoint) -> Result<(), ActionErrorKind> {
        self.lift();
        let front = self.approach(spot)?;
        self.sink(spot, front, front.bottom)
    }

    fn push(&mut self, target: TargetId, share: f32) -> Result<(), ActionErrorKind> {
        if let TipState::Down(mut down) = self.place
            && down.target == target
        {
            let pad = down.front.pad(down.tip);
            let spot = TargetPoint {
                target,
                offset: pad.truncate(),
            };
            down.tip = down.front.tip(spot, -share * down.front.travel);
            let distance = self.follow(TipPath::To(down.tip), STROKE, 3);
            within_reach(distance, Some(target))?;
            self.place = TipState::Down(down);
            return Ok(());
        }
        self.lift();
        let spot = TargetPoint::center(target);
        let front = self.approach(spot)?;
        self.sink(spot, front, -share * front.travel)
    }

    /// Over the place that is to be pressed.
    fn approach(&mut self, spot: TargetPoint) -> Result<Front, ActionErrorKind> {
        let front = self.front(spot.target)?;
        let hover = front.tip(spot, front.hover);
        // Only the show at the start comes before the first movement, and that is over this place.
        let is_there = self.movements.len() == 1;
        if !is_there {
            let time = self.travel_time(hover);
            self.follow(TipPath::To(hover), time, 5);
        }
        self.place = TipState::Off;
        Ok(front)
    }

    fn sink(
        &mut self,
        spot: TargetPoint,
        front: Front,
        height: f32,
    ) -> Result<(), ActionErrorKind> {
        let (target, tip) = (spot.target, front.tip(spot, height));
        let distance = self.follow(TipPath::To(tip), STROKE, 3);
        within_reach(distance, Some(target))?;
        self.place = TipState::Down(PressedTip { target, front, tip });
        Ok(())
    }

    fn lift(&mut self) {
        let TipState::Down(PressedTip { target, front, tip }) = self.place else {
            return;
        };
        let spot = TargetPoint {
            target,
            offset: front.pad(tip).truncate(),
        };
        let hover = front.tip(spot, front.hover);
        self.follow(TipPath::To(hover), STROKE, 3);
        self.place = TipState::Off;
    }

    fn arc(&mut self, radians: f32, time: Option<Duration>) -> Result<(), ActionErrorKind> {
        let down = self.down()?;
        let at = down.front.pad(down.tip).truncate();
        if at.length() < LEAST_RADIUS {
            return Err(ActionErrorKind::AtCenter);
        }
        let axes = down.front.world_from_target.rotation;
        let path = TipPath::Around {
            centre: down.tip - axes * at.extend(0.0),
            axis: axes * Vec3::Z,
            radians,
        };
        self.slide(down, path, at.length() * radians.abs(), time)
    }

    /// Goes along a path of this length while down.
    fn slide(
        &mut self,
        mut down: PressedTip,
        path: TipPath,
        length: f32,
        time: Option<Duration>,
    ) -> Result<(), ActionErrorKind> {
        let time = time.unwrap_or_else(|| time_at_speed(length));
        let distance = self.follow(path, time, 3);
        within_reach(distance, Some(down.target))?;
        down.tip = path.end(down.tip);
        self.place = TipState::Down(down);
        Ok(())
    }

    fn turn(
        &mut self,
        angles: &[(Dof, f64)],
        time: Option<Duration>,
    ) -> Result<(), ActionErrorKind> {
        let mut turns = Vec::new();
        for &(dof, radians) in angles {
            let place = self.hand.place_of(dof).ok_or_else(|| {
                let known = self.hand.dofs().map(Dof::name);
                ActionErrorKind::NoSensor(UnknownName::new("degree of freedom", dof.name(), known))
            })?;
            let value = self.hand.value(place, dof, radians);
            let value = value.map_err(|(low, high)| ActionErrorKind::AngleOutOfRange {
                dof,
                wanted: radians.to_degrees(),
                low: low.to_degrees().ceil(),
                high: high.to_degrees().floor(),
            })?;
            turns.retain(|(other, _)| *other != place);
            turns.push((place, value));
        }
        let moves = |finger| angles.iter().any(|(dof, _)| dof.finger() == finger);
        if moves(Some(Finger::Thumb)) {
            self.is_pinched = false;
        }
        let moves_tip = moves(None) || moves(Some(Finger::Index));
        self.turn_in_place(turns, time.unwrap_or(TURN), moves_tip)
    }

    /// Turns channels. A fingertip that is down keeps its place; another one goes along.
    fn turn_in_place(
        &mut self,
        turns: Vec<(usize, f64)>,
        time: Duration,
        moves_tip: bool,
    ) -> Result<(), ActionErrorKind> {
        if let TipState::Down(PressedTip { target, tip, .. }) = self.place {
            let distance = self.go(turns, Some(TipPath::To(tip)), time, 5);
            return within_reach(distance, Some(target));
        }
        if moves_tip {
            self.place = TipState::Anywhere;
        }
        self.go(turns, None, time, 5);
        Ok(())
    }

    fn pinch(&mut self, time: Duration) -> Result<(), ActionErrorKind> {
        if self.is_pinched {
            return Ok(());
        }
        let mut values = self.values.clone();
        match self.place {
            TipState::Down(_) => self.hand.follow(&mut values),
            TipState::Off | TipState::Anywhere => self.hand.pinch(&mut values),
        }
        let places = 0..values.len();
        let changed: Vec<usize> = places
            .filter(|&place| values[place] != self.values[place])
            .collect();
        let turns = changed.iter().map(|&place| (place, values[place]));
        let turns: Vec<(usize, f64)> = turns.collect();
        let meeting = changed
            .iter()
            .filter(|&&place| self.hand.reaches_with(place));
        self.before_pinch = meeting.map(|&place| (place, self.values[place])).collect();
        let moves_tip = !self.before_pinch.is_empty();
        self.turn_in_place(turns, time, moves_tip)?;
        self.is_pinched = true;
        Ok(())
    }

    /// Whether thumb and index finger are together, where they should be.
    fn check_pinch(&self) -> Result<(), ActionErrorKind> {
        let gap = self.hand.gap(&self.values);
        match self.is_pinched && gap > PINCH_GAP {
            true => Err(ActionErrorKind::PinchFailed(gap)),
            false => Ok(()),
        }
    }

    fn unpinch(&mut self, time: Duration) -> Result<(), ActionErrorKind> {
        self.is_pinched = false;
        let mut turns = std::mem::take(&mut self.before_pinch);
        let moves_tip = !turns.is_empty();
        turns.extend(self.hand.thumb().map(|place| (place, self.rest[place])));
        self.turn_in_place(turns, time, moves_tip)
    }

    fn point(&mut self, place: Vec3, time: Option<Duration>) -> Result<(), ActionErrorKind> {
        self.lift();
        let tip = self.hand.elbow() + place;
        let distance = tip.distance(self.hand.tip(&self.values));
        let time = time.unwrap_or_else(|| time_at_speed(distance));
        let distance = self.follow(TipPath::To(tip), time, 5);
        self.place = TipState::Anywhere;
        within_reach(distance, None)
    }

    fn down(&self) -> Result<PressedTip, ActionErrorKind> {
        match self.place {
            TipState::Down(down) => Ok(down),
            TipState::Off | TipState::Anywhere => Err(ActionErrorKind::NotDown),
        }
    }

    fn front(&self, target: TargetId) -> Result<Front, ActionErrorKind> {
        if self.scene.target(target).is_none() {
            return Err(ActionErrorKind::NotOnBoard);
        }
        let out_of_reach = ActionErrorKind::OutOfReach {
            target: Some(target),
            metres: f64::INFINITY,
        };
        self.hand.front(self.scene, target).ok_or(out_of_reach)
    }

    fn wait(&mut self, time: Duration) {
        let frames = self.frames(time, 1);
        self.movements.push(Movement {
            channel_targets: Vec::new(),
            path: None,
            is_pinched: false,
            frames,
        });
    }

    /// The fingertip goes along a path; the rest as [`go`](Self::go).
    fn follow(&mut self, path: TipPath, time: Duration, fewest: u32) -> f64 {
        self.go(Vec::new(), Some(path), time, fewest)
    }

    /// A movement that takes `time`, and at least `fewest` frames, so that a slow line shows it.
    /// Returns the furthest that the fingertip stays away from its path, in metres.
    fn go(
        &mut self,
        turns: Vec<(usize, f64)>,
        path: Option<TipPath>,
        time: Duration,
        fewest: u32,
    ) -> f64 {
        let movement = Movement {
            channel_targets: turns,
            path,
            is_pinched: self.is_pinched,
            frames: self.frames(time, fewest),
        };
        let motion = Motion::begin(movement.clone(), &mut self.hand, &self.values);
        self.movements.push(movement);
        // Which thumb follows depends on the whole way.
        let looks = match self.is_pinched {
            true => motion.frames(),
            false => looks(path),
        };
        self.walk(&motion, looks)
    }

    /// Looks at a movement in so many steps, and frame by frame if one of them is out of reach: a long
    /// way is found in short steps. Returns the furthest that the fingertip stays away, in metres.
    fn walk(&mut self, motion: &Motion, steps: u32) -> f64 {
        let before = self.values.clone();
        let mut furthest = 0_f64;
        for steps in [steps, motion.frames()] {
            self.values.clone_from(&before);
            furthest = 0.0;
            for step in 1..=steps {
                let share = step as f32 / steps as f32;
                let distance = motion.step(share, &self.hand, &mut self.values);
                furthest = furthest.max(distance);
            }
            if furthest <= REACH_TOLERANCE {
                break;
            }
        }
        furthest
    }

    fn frames(&self, time: Duration, fewest: u32) -> u32 {
        let frames = (time.as_secs_f64() / self.period.as_secs_f64()).ceil() as u32;
        frames.max(fewest)
    }

    /// MT = a + b log₂(A/W + 1) with a = 60 ms, b = 85 ms, the middle of the published ranges for
    /// fingertip taps, and W the width of a key, 19 mm.
    fn travel_time(&self, to: Vec3) -> Duration {
        let distance = self.hand.tip(&self.values).distance(to);
        let difficulty = (f64::from(distance) / 0.019 + 1.0).log2();
        Duration::from_secs_f64(0.060 + 0.085 * difficulty)
    }
}

/// How often a movement is looked at for places that are out of reach.
fn looks(path: Option<TipPath>) -> u32 {
    match path {
        Some(TipPath::Around { radians, .. }) => (radians.abs() / LOOK).ceil().max(1.0) as u32,
        Some(TipPath::To(_)) | None => 1,
    }
}

fn within_reach(metres: f64, target: Option<TargetId>) -> Result<(), ActionErrorKind> {
    match metres > REACH_TOLERANCE {
        true => Err(ActionErrorKind::OutOfReach { target, metres }),
        false => Ok(()),
    }
}

fn time_at_speed(length: f32) -> Duration {
    Duration::from_secs_f64(f64::from(length) / SPEED).max(STROKE)
}
