//! Taps as strokes: a fingertip that has gone through the front of a key, until it is known which key it means.
//!
//! A stroke presses at the press depth if the path so far leads to one key, clear of its edge; else, and always with a thumb, as soon as
//! the fingertip turns. Then a thumb means the point that it has reached, and another finger a point between the plane of the keys and
//! its lowest point. A finger that follows another one, and one that sinks slowly, presses nothing.

use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use super::target::Target;
use super::tracker::TargetLocation;
use crate::hand::Finger;
use crate::time::Timestamp;

/// The longest time for which a stroke waits for its turn after it has passed the press depth: a finger turns within 40 to
/// 60 ms.
const MAX_WAIT: Duration = Duration::from_millis(60);

/// The smallest peak speed of a stroke, in metres per second: a resting finger sinks by 1 to 10 mm per second.
const MIN_PEAK_SPEED: f32 = 0.02;

/// The fraction of its peak speed below which a stroke turns: within the last 2 % of a minimum-jerk movement.
const TURN_SPEED_FRACTION: f32 = 0.2;

/// The rise from the deepest point, in metres, beyond which a stroke has turned.
const TURN_RISE: f32 = 0.0005;

/// The longest slip of a stroke along the board, in metres: half the pitch of a keyboard. A fingertip slips by up to 4 mm; a hand that
/// passes by moves further.
const MAX_SLIP: f32 = 0.0095;

/// The same limit for a thumb, whose tip swings in an arc toward the palm: the pitch of a keyboard. Simulated thumbs slip by up to 18 mm.
const THUMB_MAX_SLIP: f32 = 0.019;

/// The speed along the board, in metres per second, below which a thumb turns: above it, the thumb may go down again on its arc.
const THUMB_TURN_SPEED: f32 = 0.1;

/// The speed along the board, in metres per second, of a hand that passes by; a slip has 0.2.
const PASSING_SPEED: f32 = 0.8;

/// The time constant of the velocity of a hand that passes by, in seconds: at 175 Hz, a step between two points with 2 mm of noise looks
/// like 0.6 m/s.
const VELOCITY_TIME: f32 = 0.01;

/// The overtravel, in metres behind the travel of a key, to which the path of a stroke is extrapolated: people press 4 to 10 mm deeper
/// than the travel.
const OVERTRAVEL: f32 = 0.004;

/// The smallest distance of the end of the path from the edge of the key, in metres.
const EDGE_CLEARANCE: f32 = 0.0015;

/// The position of the intended point on the straight way of a finger from the front to its lowest point, as a fraction. A finger that is
/// still on its way to the key means its lowest point, one that slips under pressure or is seen with a lag means the front, and the
/// mean of two points has less noise than each. Between 0.4 and 0.6 simulated people have nearly the same errors.
const INTENDED_FRACTION: f32 = 0.5;

/// A fingertip that has entered a front and has not pressed yet. Points are positions of its pad in the frame of the entered target, in
/// metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// The target whose front it entered.
    pub location: TargetLocation,
    /// The last point above the front, and the point at which it passed the front.
    above: Vec3,
    entry: Vec3,
    /// The deepest point so far, and the point before it.
    deepest: Vec3,
    before: Vec3,
    /// The point after the deepest one, once there is one.
    after: Option<Vec3>,
    /// The highest speed inwards, in metres per second.
    fastest: f32,
    /// The speed inwards in the last step.
    speed: f32,
    /// The speed along the board in the last step.
    along: f32,
    /// The smoothed velocity below the front, in metres per second. It starts at zero, so that the noise of a first step alone is no pass.
    velocity: Vec3,
    /// The smoothed velocity at the deepest point.
    deepening: Vec3,
    /// The time at which it passed the press depth.
    pub passed: Option<Timestamp>,
    /// `true` if it presses nothing until it is above the front again.
    pub is_spent: bool,
}

impl Stroke {
    /// Creates the stroke of a pad that enters a front at a point, in the step from another point.
    pub fn new(location: TargetLocation, above: Vec3, entry: Vec3) -> Self {
        Self {
            location,
            above,
            entry,
            deepest: above,
            before: above,
            after: None,
            fastest: 0.0,
            speed: 0.0,
            along: 0.0,
            velocity: Vec3::ZERO,
            deepening: Vec3::ZERO,
            passed: None,
            is_spent: false,
        }
    }

    /// Appends a step of a duration in seconds.
    pub fn push(&mut self, [from, to]: [Vec3; 2], seconds: f32) {
        let rate = |way: f32| if seconds > 0.0 { way / seconds } else { 0.0 };
        self.speed = rate(from.z - to.z);
        self.along = rate((to - from).truncate().length());
        self.fastest = self.fastest.max(self.speed);
        let weight = 1.0 - (-seconds / VELOCITY_TIME).exp();
        let velocity = (to - from) / seconds.max(f32::EPSILON);
        self.velocity += weight * (velocity - self.velocity);
        if to.z < self.deepest.z {
            self.deepening = self.velocity;
            self.before = from;
            self.deepest = to;
            self.after = None;
        } else {
            self.after.get_or_insert(to);
        }
    }

    /// Returns the greatest depth so far, in metres.
    pub fn depth(&self) -> f32 {
        -self.deepest.z
    }

    /// Returns `true` if it is fast enough for a tap.
    pub fn is_fast(&self) -> bool {
        self.fastest >= MIN_PEAK_SPEED
    }

    /// Returns `true` if the fingertip has turned, comes to rest, or has waited for [`MAX_WAIT`], so that its present point counts.
    pub fn has_turned(&self, finger: Finger, at: Vec3, now: Timestamp) -> bool {
        let is_late = self
            .passed
            .is_some_and(|passed| now.since(passed) >= MAX_WAIT);
        let is_slow = self.speed < TURN_SPEED_FRACTION * self.fastest
            && (finger != Finger::Thumb || self.along < THUMB_TURN_SPEED);
        is_late || at.z > self.deepest.z + TURN_RISE || is_slow
    }

    /// Returns `true` if the fingertip has passed below the plane of the keys on its way along the board, instead of going down.
    pub fn is_pass(&self, finger: Finger) -> bool {
        let (inward, along) = (-self.deepening.z, self.deepening.truncate().length());
        let slip = (self.deepest - self.entry).truncate().length();
        let longest = if finger == Finger::Thumb {
            THUMB_MAX_SLIP
        } else {
            MAX_SLIP
        };
        slip > longest || along > PASSING_SPEED.max(inward)
    }

    /// Returns the point that a stroke means, once it has turned `at` a point.
    ///
    /// A thumb that glides along the board at its lowest point is still on its arc to the key.
    pub fn intended(&self, finger: Finger, at: Vec3) -> Vec3 {
        if finger != Finger::Thumb {
            let turn = self.turn();
            let on_board = self.entry.lerp(turn, INTENDED_FRACTION).truncate();
            return on_board.extend(turn.z);
        }
        if at.z < 0.0 { at } else { self.turn() }
    }

    /// Returns the lowest point of a parabola through the deepest pad and its neighbors in time.
    fn turn(&self) -> Vec3 {
        let Some(after) = self.after else {
            return self.deepest;
        };
        let [before, deepest] = [self.before, self.deepest];
        let curvature = before.z - 2.0 * deepest.z + after.z;
        if curvature <= f32::EPSILON {
            return deepest;
        }
        let t = (0.5 * (before.z - after.z) / curvature).clamp(-0.5, 0.5);
        let slope = 0.5 * (after - before);
        let bend = 0.5 * (before - 2.0 * deepest + after);
        deepest + slope * t + bend * (t * t)
    }

    /// Returns the point at which the straight path so far reaches the usual depth of taps on a target.
    pub fn extrapolated_end(&self, at: Vec3, target: &Target) -> Vec3 {
        let path = at - self.above;
        let left = (at.z + target.travel + OVERTRAVEL).max(0.0);
        if path.z < -f32::EPSILON {
            at + path * (left / -path.z)
        } else {
            at
        }
    }
}

/// Returns `true` if a point on the front of a target is clear of the edge of its part of the board.
pub(super) fn is_clear_of_edge(target: &Target, point: Vec2) -> bool {
    let (center, half) = target.entrance();
    (point - center).abs().cmplt(half - EDGE_CLEARANCE).all()
}
