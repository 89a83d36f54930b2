//! A hand that moves a cursor: where it begins, how it moves, and how it clicks.

use parry3d::math::{Vec2, Vec3};

use super::hand::{FluentHand, STRAIGHT};
use super::timeline::{Bump, Timeline};
use crate::device::pointer::mode::{
    AngleMapping, Displacement, HandPoint, RateControl, RayOrigin, RayPointing,
};
use crate::device::pointer::{AnchoredFrame, ClickMethod, Gesture, PointerSettings, PointingMode};
use crate::device::{KeyAction, KeyCode};
use crate::hand::{Dof, Finger, Joint};
use crate::kinematics::HandPose;
use crate::sim::effector::Effector;
use crate::sim::typing_hand::{PINCH_GAP, TypingHand};

/// Looks at the shown hand while a person finds the middle of the range.
const LOOKS: usize = 8;
/// The depth of a push beyond the depth that clicks, in metres: filters make pushes flatter.
const PUSH_MARGIN: f32 = 0.013;
/// The angle by which a bent joint that holds the clutch is beyond its threshold, in radians: 8°.
const CLUTCH_MARGIN: f32 = 0.14;
/// The time at which a finger bends that holds the clutch, and its duration, in seconds.
const CLUTCH_TIME: (f64, f64) = (0.2, 0.2);
/// The range of the wrist in which a ray is looked for, in degrees, and the steps.
const WRIST_RANGE: i32 = 30;
const WRIST_STEP: usize = 3;

/// The joints that move a wrist: to the right and up, with the signs of these directions for a right hand.
const WRIST: [Dof; 2] = [Dof::WristDeviation, Dof::WristFlexion];

/// A hand in the middle of the range of a pointer, and the ways to move the cursor and to click.
#[derive(Clone, Debug)]
pub struct PointingPosture {
    base: Vec<f64>,
    control: Control,
    click: Click,
    /// The law from displacement to velocity; `None` for a pointer whose position follows the hand.
    pub rate: Option<RateControl>,
    /// A displacement for a try, in metres or radians.
    pub probe: f64,
}

/// A displacement of a hand, in metres or radians from the middle.
#[derive(Clone, Debug)]
enum Control {
    /// A point of the hand: its place in the middle, and the directions of the frame (world).
    Point {
        point: HandPoint,
        middle: Vec3,
        right: Vec3,
        up: Vec3,
        forward: Vec3,
    },
    /// Two angles: the indices of their variables, and the angles in the middle.
    Angles([(usize, f64); 2]),
}

/// The way to click.
#[derive(Clone, Debug)]
enum Click {
    /// The point goes forward, in metres.
    Push(f32),
    /// Changes of the posture that bring thumb and index finger together.
    Pinch(Vec<f64>),
}

impl FluentHand {
    /// Goes to the middle of the range of a pointer at time 0; `None` if the hand cannot move the cursor or cannot click.
    pub fn begin_pointing(&mut self, settings: &PointerSettings) -> Option<PointingPosture> {
        let mut base = self.typing_hand(Finger::Index).rest_values();
        let mut held = None;
        if let Some(clutch) = settings.clutch {
            let Gesture::Flexion(dof, angle) = clutch else {
                return None;
            };
            let hand = self.typing_hand(Finger::Index);
            let index = hand.index_of(dof)?;
            held = Some((index, base[index]));
            base[index] = hand.value_near(index, f64::from(angle + CLUTCH_MARGIN.copysign(angle)));
        }
        let (control, rate, probe) = match &settings.mode {
            PointingMode::Direct(direct) => {
                let control = self.point_at(direct.point, &direct.frame, &mut base)?;
                (control, None, 0.02)
            }
            PointingMode::Joint(joint) => {
                let control = self.angles_at_middle([&joint.x, &joint.y], &mut base)?;
                (control, None, 0.06)
            }
            PointingMode::Ray(ray) => (self.wrist_at(ray, &mut base)?, None, 0.04),
            PointingMode::Rate(rate) => {
                let control = match &rate.displacement {
                    Displacement::Fingertip(frame, _) => {
                        self.point_at(HandPoint::Index, frame, &mut base)?
                    }
                    Displacement::Angles(x, y) => self.angles_at_middle([x, y], &mut base)?,
                    Displacement::Stick => return None,
                };
                (control, Some(*rate), 0.0)
            }
            PointingMode::Arm(_) => return None,
        };
        let click = self.click_of(settings, &control, &base)?;
        // A clutch counts from the moment at which it is bent, and not if it was bent from the beginning.
        let mut open = base.clone();
        if let Some((index, value)) = held {
            open[index] = value;
        }
        self.timeline = Timeline::new(open);
        let (start, duration) = CLUTCH_TIME;
        self.timeline.go_to(base.clone(), start, duration);
        Some(PointingPosture {
            base,
            control,
            click,
            rate,
            probe,
        })
    }

    /// Moves to a displacement from the middle, to the right and up, after the movements so far.
    pub fn displace(&mut self, posture: &PointingPosture, by: Vec2, start: f64, duration: f64) {
        let goal = self.values_at(posture, by, 0.0);
        self.timeline.go_to(goal, start, duration);
    }

    /// Clicks at a displacement: down, a pause, and up again. Returns the times of the lowest point and of the end, in seconds.
    /// `stronger` multiplies the depth of a push.
    pub fn click(
        &mut self,
        posture: &PointingPosture,
        at: Vec2,
        start: f64,
        stronger: f32,
    ) -> (f64, f64) {
        let press = self.person.press_ms * 1e-3 * CLICK_TIME;
        let dwell = self.draw.log_normal(self.person.dwell_ms, 0.25) * 1e-3;
        let change = match &posture.click {
            Click::Pinch(change) => change.clone(),
            Click::Push(depth) => {
                let (up, down) = (
                    self.values_at(posture, at, 0.0),
                    self.values_at(posture, at, depth * stronger),
                );
                down.iter().zip(&up).map(|(down, up)| down - up).collect()
            }
        };
        let bottom = start + press;
        self.timeline.add(Bump {
            change,
            start,
            down: press,
            release: bottom + dwell,
            up: press,
        });
        (bottom, bottom + dwell + press)
    }

    fn values_at(&self, posture: &PointingPosture, by: Vec2, forward: f32) -> Vec<f64> {
        let mut values = posture.base.clone();
        let hand = self.typing_hand(Finger::Index);
        match &posture.control {
            Control::Point {
                point,
                middle,
                right,
                up,
                forward: ahead,
            } => {
                let goal = *middle + *right * by.x + *up * by.y + *ahead * forward;
                move_point(hand, *point, goal, &mut values);
            }
            Control::Angles(angles) => {
                for (&(index, middle), shift) in angles.iter().zip([by.x, by.y]) {
                    values[index] = hand.value_near(index, middle + f64::from(shift));
                }
            }
        }
        values
    }

    /// Finds the posture in which a point of the shown hand is in the middle of a frame.
    fn point_at(
        &mut self,
        point: HandPoint,
        frame: &AnchoredFrame,
        base: &mut [f64],
    ) -> Option<Control> {
        let rotation = frame.anchor_from_frame.rotation;
        if point != HandPoint::Index {
            // The arm does not stretch it, and a range at the start is placed at an open hand.
            let hand = self.typing_hand(Finger::Index);
            for (index, value) in hand.values_at_bend(Finger::Index, STRAIGHT) {
                base[index] = value;
            }
        }
        let mut middle = Vec3::ZERO;
        for _ in 0..LOOKS {
            let pose = self.shown(base)?;
            let goal = frame.world_from_frame(&pose)?.translation;
            let shown = pose.position(point.joint())?;
            let hand = self.typing_hand(Finger::Index);
            let own = hand.pose(base).position(point.joint())?;
            middle = own + (goal - shown);
            move_point(hand, point, middle, base);
        }
        Some(Control::Point {
            point,
            middle,
            right: rotation * Vec3::X,
            up: rotation * Vec3::Y,
            forward: rotation * Vec3::NEG_Z,
        })
    }

    /// Goes to the middle of the ranges of two angles.
    fn angles_at_middle(&self, axes: [&AngleMapping; 2], base: &mut [f64]) -> Option<Control> {
        let hand = self.typing_hand(Finger::Index);
        let mut angles = [(0, 0.0); 2];
        for (angle, axis) in angles.iter_mut().zip(axes) {
            let index = hand.index_of(axis.dof)?;
            *angle = (index, f64::from(axis.from.midpoint(axis.to)));
            base[index] = hand.value_near(index, angle.1);
        }
        Some(Control::Angles(angles))
    }

    /// Finds the wrist angles at which a ray meets the middle of its rectangle.
    fn wrist_at(&mut self, ray: &RayPointing, base: &mut [f64]) -> Option<Control> {
        let hand = self.typing_hand(Finger::Index).clone();
        let indices = [hand.index_of(WRIST[0])?, hand.index_of(WRIST[1])?];
        let steps = || (-WRIST_RANGE..=WRIST_RANGE).step_by(WRIST_STEP);
        let mut best: Option<(f32, [f64; 2])> = None;
        for angles in steps().flat_map(|x| steps().map(move |y| [x, y])) {
            let angles = angles.map(|degrees| f64::from(degrees).to_radians());
            for (index, angle) in indices.into_iter().zip(angles) {
                base[index] = hand.value_near(index, angle);
            }
            let place = self.shown(base).and_then(|pose| place_of(ray, &pose));
            let miss = place.map_or(f32::INFINITY, Vec2::length);
            if miss.is_finite() && best.is_none_or(|(least, _)| miss < least) {
                best = Some((miss, angles));
            }
        }
        let (miss, angles) = best?;
        for (index, angle) in indices.into_iter().zip(angles) {
            base[index] = hand.value_near(index, angle);
        }
        let is_inside = miss < ray.size.min_element() / 4.0;
        is_inside.then_some(Control::Angles([
            (indices[0], angles[0]),
            (indices[1], angles[1]),
        ]))
    }

    /// Returns the way to press the left button; `None` if the hand cannot.
    fn click_of(
        &self,
        settings: &PointerSettings,
        control: &Control,
        base: &[f64],
    ) -> Option<Click> {
        let left = KeyAction::Key(KeyCode::MOUSE_LEFT);
        let mut clicks = settings.clicks.iter().filter(|(_, action)| *action == left);
        clicks.find_map(|(method, _)| match method {
            ClickMethod::Push(depth) if matches!(control, Control::Point { .. }) => {
                Some(Click::Push(depth + PUSH_MARGIN))
            }
            ClickMethod::Gesture(Gesture::Pinch(Finger::Index)) => {
                let hand = self.typing_hand(Finger::Index);
                let mut pinched = base.to_vec();
                hand.pinch(&mut pinched);
                let change = pinched.iter().zip(base).map(|(to, from)| to - from);
                (hand.pinch_gap(&pinched) < PINCH_GAP).then(|| Click::Pinch(change.collect()))
            }
            _ => None,
        })
    }
}

/// Moves a point of a hand to a place (world, metres). Fingers that do not move the point stay free to pinch.
fn move_point(hand: &TypingHand, point: HandPoint, place: Vec3, values: &mut [f64]) {
    match point {
        HandPoint::Index => hand.reach_with(Effector::INDEX, place, values, &[]),
        HandPoint::Knuckle | HandPoint::Wrist => hand.carry(point.joint(), place, values),
    };
}

/// A click takes longer than a tap on a key: nothing stops the finger ?.
const CLICK_TIME: f64 = 1.2;

/// Returns where a ray meets the plane of its rectangle, in metres from the middle; `None` if it points away.
fn place_of(ray: &RayPointing, pose: &HandPose) -> Option<Vec2> {
    let knuckle = pose.position(Joint::IndexPhalanxProximal)?;
    let (behind, origin) = match ray.from {
        RayOrigin::Hand => (pose.position(Joint::Wrist)?, knuckle),
        RayOrigin::Index => (knuckle, pose.fingertip(Finger::Index)?),
    };
    let frame = ray.frame.world_from_frame(pose)?;
    let [behind, origin] = [behind, origin].map(|point| frame.inverse_transform_point(point));
    let direction = (origin - behind).try_normalize()?;
    let is_ahead = origin.z > 0.0 && direction.z < -0.2;
    is_ahead.then(|| (origin + direction * (origin.z / -direction.z)).truncate())
}

impl FluentHand {
    /// Returns the displacement from the middle at which the cursor has a velocity, in pixels per second to the right and up.
    pub fn displacement_for(&self, rate: &RateControl, velocity: Vec2) -> Vec2 {
        let speed = velocity.length();
        let part = (speed / rate.max_speed_px_s).clamp(0.0, 1.0);
        if part < NO_SPEED {
            return Vec2::ZERO;
        }
        let length = rate.dead_zone + part.powf(1.0 / rate.curve) * (1.0 - rate.dead_zone);
        let displaced = velocity / speed * length;
        let angle = |axis: &AngleMapping, deflection: f32| {
            let curved = deflection.abs().powf(1.0 / axis.curve).copysign(deflection);
            curved * (axis.to - axis.from) / 2.0
        };
        match &rate.displacement {
            Displacement::Fingertip(_, full) => displaced * *full,
            Displacement::Angles(x, y) => Vec2::new(angle(x, displaced.x), angle(y, displaced.y)),
            Displacement::Stick => Vec2::ZERO,
        }
    }

    /// Returns the person.
    pub fn person(&self) -> &crate::people::Participant {
        &self.person
    }
}

/// A part of the highest velocity that counts as none.
const NO_SPEED: f32 = 1e-4;
