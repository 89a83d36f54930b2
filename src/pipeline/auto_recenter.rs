//! Boards that creep under a hand which rests over them.

use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use super::board_move::GUIDE;
use crate::contact::board_pose::AutoRecenter;
use crate::contact::hit_test;
use crate::contact::surface::{Scene, Surface};
use crate::contact::tracker::trusted_fingertip;
use crate::hand::{Finger, Side};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// How far in front of all fronts every fingertip is while the hand rests, in metres: more than a
/// fingertip hovers over a key that it is about to press.
const CLEARANCE: f32 = 0.01;

/// How fast a hand may be that rests, in metres per second. A hand that reaches for a key is faster than
/// 0.1; the tremble and noise of a still one, 0.1 mm from frame to frame at 170 Hz, stay below 0.02.
const SLOW: f32 = 0.05;

/// A longer gap between two frames counts as so long: a board never leaps.
const LONGEST_FRAME: Duration = Duration::from_millis(50);

/// The boards of a layout that drift, and what their hands do.
#[derive(Clone, Debug, Default)]
pub(super) struct Drifting {
    boards: Vec<Board>,
    hands: [Hand; Side::COUNT],
}

#[derive(Clone, Copy, Debug)]
struct Board {
    /// The number of its surface.
    place: usize,
    drift: AutoRecenter,
    /// How far it has crept along its X and Y, in metres.
    crept: Vec2,
}

#[derive(Clone, Copy, Debug, Default)]
struct Hand {
    last: Option<(Timestamp, Vec3)>,
    rests_since: Option<Timestamp>,
    /// Whether a fingertip is near a front.
    is_near: bool,
}

impl Drifting {
    /// Board `i` drifts as `drifts[i]` says.
    pub fn new(drifts: impl IntoIterator<Item = Option<AutoRecenter>>) -> Self {
        let board = |(place, drift): (usize, Option<AutoRecenter>)| {
            Some(Board {
                place,
                drift: drift?,
                crept: Vec2::ZERO,
            })
        };
        Self {
            boards: drifts.into_iter().enumerate().filter_map(board).collect(),
            hands: Default::default(),
        }
    }

    /// From now on the boards creep around where they are.
    pub fn settle(&mut self) {
        for board in &mut self.boards {
            board.crept = Vec2::ZERO;
        }
        self.forget();
    }

    /// Every hand has to come to rest anew.
    pub fn forget(&mut self) {
        self.hands = Default::default();
    }

    /// Takes the next pose of a hand, and moves the boards below it if it rests. `is_touched` says
    /// whether any fingertip of either hand touches anything. Does not allocate.
    pub fn advance(&mut self, scene: &mut Scene, pose: &HandPose, is_touched: bool) {
        if self.boards.is_empty() {
            return;
        }
        let hand = &mut self.hands[pose.side.index()];
        hand.is_near = is_near(scene, pose);
        let elapsed = hand.follow(pose);
        let rests_since = hand.rests_since;
        if is_touched || self.hands.iter().any(|hand| hand.is_near) {
            for hand in &mut self.hands {
                hand.rests_since = None;
            }
            return;
        }
        let (Some(since), Some(tip)) = (rests_since, trusted_fingertip(pose, GUIDE)) else {
            return;
        };
        for board in &mut self.boards {
            if pose.time.since(since) >= board.drift.delay {
                board.creep(scene, pose, tip, elapsed.min(LONGEST_FRAME));
            }
        }
    }
}

impl Hand {
    /// Takes note of whether the hand rests; the time since it was seen before.
    fn follow(&mut self, pose: &HandPose) -> Duration {
        let tip = trusted_fingertip(pose, GUIDE);
        let last = self.last;
        self.last = tip.map(|tip| (pose.time, tip));
        let (Some(tip), Some((time, before))) = (tip, last) else {
            self.rests_since = None;
            return Duration::ZERO;
        };
        let elapsed = pose.time.since(time);
        let is_slow = tip.distance(before) <= SLOW * elapsed.as_secs_f32();
        self.rests_since = match is_slow && !pose.jumped {
            true => self.rests_since.or(Some(pose.time)),
            false => None,
        };
        elapsed
    }
}

impl Board {
    fn creep(&mut self, scene: &mut Scene, pose: &HandPose, tip: Vec3, elapsed: Duration) {
        let Some(surface) = scene.surfaces().get(self.place) else {
            return;
        };
        let Some(world_from_board) = surface.world_from_surface(pose) else {
            return;
        };
        let off = world_from_board.inverse_transform_point(tip) - surface.center();
        let step = off
            .truncate()
            .clamp_length_max(self.drift.speed * elapsed.as_secs_f32());
        let crept = (self.crept + step).clamp_length_max(self.drift.max_offset);
        let mut moved = surface.anchor_from_surface();
        moved.translation += moved.rotation * (crept - self.crept).extend(0.0);
        self.crept = crept;
        scene.set_surface_pose(self.place, moved);
    }
}

/// Whether a fingertip of this hand is near any front that is there for it.
fn is_near(scene: &Scene, pose: &HandPose) -> bool {
    let is_over = |surface: &Surface| {
        let Some(world_from_surface) = surface.world_from_surface(pose) else {
            return false;
        };
        let mut tips = Finger::ALL
            .iter()
            .filter_map(|&finger| trusted_fingertip(pose, finger));
        tips.any(|tip| {
            let centre = world_from_surface.inverse_transform_point(tip);
            hit_test::is_near_any_target(surface, centre, pose.tip_radius, CLEARANCE)
        })
    };
    scene.surfaces().iter().any(is_over)
}
