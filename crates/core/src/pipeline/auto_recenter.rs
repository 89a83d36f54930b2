//! Auto-recentering: boards slowly follow a hand that rests above them.

use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use crate::contact::board_pose::AutoRecenter;
use crate::contact::hit_test;
use crate::contact::surface::{Scene, Surface};
use crate::contact::trusted_fingertip;
use crate::hand::{Finger, Side};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// The finger below which boards are centered.
pub(super) const RECENTER_FINGER: Finger = Finger::Index;

/// The smallest distance of every fingertip from all fronts while the hand rests, in metres: more than the height
/// at which a fingertip hovers over a key before it presses it.
const CLEARANCE: f32 = 0.01;

/// The highest speed of a resting hand, in metres per second. A hand that reaches for a key is faster than
/// 0.1; the tremor and noise of a still one, 0.1 mm from step to step at 170 Hz, stay below 0.02.
const MAX_REST_SPEED: f32 = 0.05;

/// The longest step for the displacement of a board, so that a board never jumps after a gap.
const MAX_STEP: Duration = Duration::from_millis(50);

/// The auto-recentering boards of a layout and the rest detectors of both hands.
#[derive(Clone, Debug, Default)]
pub(super) struct AutoRecenterState {
    boards: Vec<RecenteredBoard>,
    hands: [RestDetector; Side::COUNT],
}

#[derive(Clone, Copy, Debug)]
struct RecenteredBoard {
    /// The index of the board's surface.
    surface: usize,
    settings: AutoRecenter,
    /// The displacement so far along the board's X and Y, in metres.
    offset: Vec2,
}

#[derive(Clone, Copy, Debug, Default)]
struct RestDetector {
    last: Option<(Timestamp, Vec3)>,
    resting_since: Option<Timestamp>,
    /// `true` if a fingertip is near a front.
    is_near: bool,
}

impl AutoRecenterState {
    /// Creates the state; `settings[i]` applies to board `i`, which stays with `None`.
    pub fn new(settings: impl IntoIterator<Item = Option<AutoRecenter>>) -> Self {
        let board = |(surface, board_settings): (usize, Option<AutoRecenter>)| {
            Some(RecenteredBoard {
                surface,
                settings: board_settings?,
                offset: Vec2::ZERO,
            })
        };
        Self {
            boards: settings.into_iter().enumerate().filter_map(board).collect(),
            hands: Default::default(),
        }
    }

    /// Makes the current positions of the boards the ones from which their displacement is limited.
    pub fn rebase(&mut self) {
        for board in &mut self.boards {
            board.offset = Vec2::ZERO;
        }
        self.reset();
    }

    /// Restarts the rest detection of both hands.
    pub fn reset(&mut self) {
        self.hands = Default::default();
    }

    /// Processes the next pose of a hand, and moves the boards below it if it rests. `is_touched` is `true` if any
    /// fingertip of either hand touches a target. Does not allocate.
    pub fn update(&mut self, scene: &mut Scene, pose: &HandPose, is_touched: bool) {
        if self.boards.is_empty() {
            return;
        }
        let hand = &mut self.hands[pose.side.index()];
        hand.is_near = is_near(scene, pose);
        let elapsed = hand.update(pose);
        let resting_since = hand.resting_since;
        if is_touched || self.hands.iter().any(|it| it.is_near) {
            for other in &mut self.hands {
                other.resting_since = None;
            }
            return;
        }
        let fingertip = trusted_fingertip(pose, RECENTER_FINGER);
        let (Some(since), Some(fingertip)) = (resting_since, fingertip) else {
            return;
        };
        for board in &mut self.boards {
            if pose.time.since(since) >= board.settings.delay {
                board.follow(scene, pose, fingertip, elapsed.min(MAX_STEP));
            }
        }
    }
}

impl RestDetector {
    /// Appends a pose, and returns the time since the previous one; zero if there is none.
    fn update(&mut self, pose: &HandPose) -> Duration {
        let fingertip = trusted_fingertip(pose, RECENTER_FINGER);
        let last = self.last;
        self.last = fingertip.map(|fingertip| (pose.time, fingertip));
        let (Some(fingertip), Some((time, previous))) = (fingertip, last) else {
            self.resting_since = None;
            return Duration::ZERO;
        };
        let elapsed = pose.time.since(time);
        let is_slow = fingertip.distance(previous) <= MAX_REST_SPEED * elapsed.as_secs_f32();
        self.resting_since = if is_slow && !pose.jumped {
            self.resting_since.or(Some(pose.time))
        } else {
            None
        };
        elapsed
    }
}

impl RecenteredBoard {
    fn follow(&mut self, scene: &mut Scene, pose: &HandPose, fingertip: Vec3, elapsed: Duration) {
        let Some(surface) = scene.surfaces().get(self.surface) else {
            return;
        };
        let Some(world_from_board) = surface.world_from_surface(pose) else {
            return;
        };
        let error = world_from_board.inverse_transform_point(fingertip) - surface.center();
        let step = error
            .truncate()
            .clamp_length_max(self.settings.speed * elapsed.as_secs_f32());
        let offset = (self.offset + step).clamp_length_max(self.settings.max_offset);
        let mut moved = surface.anchor_from_surface();
        moved.translation += moved.rotation * (offset - self.offset).extend(0.0);
        self.offset = offset;
        scene.set_surface_pose(self.surface, moved);
    }
}

/// Returns `true` if a fingertip is near any front that its hand can touch.
fn is_near(scene: &Scene, pose: &HandPose) -> bool {
    let is_near_surface = |surface: &Surface| {
        let Some(world_from_surface) = surface.world_from_surface(pose) else {
            return false;
        };
        let mut fingertips = Finger::ALL
            .iter()
            .filter_map(|&finger| trusted_fingertip(pose, finger));
        fingertips.any(|fingertip| {
            let center = world_from_surface.inverse_transform_point(fingertip);
            hit_test::is_near_any_target(surface, center, pose.tip_radius, CLEARANCE)
        })
    };
    scene.surfaces().iter().any(is_near_surface)
}
