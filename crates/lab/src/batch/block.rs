//! Eight hands over the boards of a scene.

use parry3d::math::{Pose, Vec3};
use wide::f32x8;

use super::lane_arm::{LaneArm, LaneHands, LaneVector, to_arrays};
use super::{AllTips, HandTouch, LANES, LaneAngles};

use crate::contact::surface::{Anchor, Scene, Surface};
use crate::contact::{ContactTracker, PlacedHand, Touch, Touches};
use crate::estimate::{Estimate, JointAngles};
use crate::hand::{Finger, Joint, Side};
use crate::kinematics::{ArmModel, rotated};
use crate::time::Timestamp;

/// The boards of a scene, for hands of one arm model.
pub(super) struct LaneBoard {
    scene: Scene,
    side: Side,
    tip_radius: f32,
    surfaces: Vec<LaneSurface>,
}

/// One surface. Each hand has its own, because a surface may follow a joint.
struct LaneSurface {
    /// The joint that the surface follows.
    anchor: Option<Joint>,
    /// The translation from the anchor to the surface.
    translation: LaneVector,
    surface_from_world: [f32x8; 4],
    /// Heights below and above all fronts, in metres.
    heights: [f32; 2],
    /// `true` if the fronts are parallel to the surface: a fingertip enters one from above only.
    is_flat: bool,
    tip_radius: f32,
    has_no_place: bool,
}

impl LaneBoard {
    pub fn new(scene: &Scene, arm: &ArmModel) -> Self {
        let rest = arm.forward(&Estimate::new(Timestamp(0), JointAngles::default()));
        let surface = |surface: &Surface| LaneSurface::new(surface, rest.side, rest.tip_radius);
        Self {
            side: rest.side,
            tip_radius: rest.tip_radius,
            surfaces: scene.surfaces().iter().map(surface).collect(),
            scene: scene.clone(),
        }
    }
}

impl LaneSurface {
    fn new(surface: &Surface, side: Side, tip_radius: f32) -> Self {
        let Pose {
            rotation,
            translation,
            ..
        } = surface.anchor_from_surface();
        Self {
            anchor: match surface.anchor() {
                Anchor::World | Anchor::Start | Anchor::OtherHand | Anchor::Body(_) => None,
                Anchor::Joint(joint) => Some(joint),
            },
            translation: translation.to_array().map(f32x8::splat),
            surface_from_world: rotation.inverse().to_array().map(f32x8::splat),
            heights: surface.front_heights(),
            is_flat: surface.is_flat(),
            tip_radius,
            has_no_place: !matches!(surface.anchor(), Anchor::World | Anchor::Joint(_))
                || surface.side().is_some_and(|other| other != side),
        }
    }

    /// Converts fingertips to the frame of the surface; NaN where the surface has no place.
    fn place(&self, hands: &LaneHands) -> AllTips {
        if self.has_no_place {
            return UNKNOWN;
        }
        let anchor = match self.anchor {
            None => [f32x8::ZERO; 3],
            Some(joint) => hands.joints[joint.index()],
        };
        let origin = add(anchor, self.translation).map(|lanes| -lanes);
        let origin = rotated(&self.surface_from_world, origin);
        std::array::from_fn(|finger| {
            let tip = hands.tip(Finger::ALL[finger]);
            to_arrays(add(rotated(&self.surface_from_world, tip), origin))
        })
    }

    /// Adds the lanes in which a fingertip may enter a front between two poses.
    fn add_candidates(&self, previous: &AllTips, current: &AllTips, candidates: &mut FingerLanes) {
        let [lowest, highest] = self.heights.map(f32x8::splat);
        let radius = f32x8::splat(self.tip_radius);
        let tips = previous.iter().zip(current);
        for (lanes, (last_tip, tip)) in candidates.iter_mut().zip(tips) {
            let (from, to) = (f32x8::new(last_tip[2]), f32x8::new(tip[2]));
            let (from_pad, to_pad) = (from - radius, to - radius);
            // A comparison with NaN is false: a fingertip that is not known enters nothing.
            let are_candidates = if self.is_flat {
                from_pad.simd_ge(lowest) & to_pad.simd_le(highest)
            } else {
                let is_low = from_pad.simd_le(highest) | to_pad.simd_le(highest);
                let (from_top, to_top) = (from + radius, to + radius);
                is_low & (from_top.simd_ge(lowest) | to_top.simd_ge(lowest))
            };
            *lanes |= are_candidates.to_bitmask();
        }
    }
}

fn add(a: LaneVector, b: LaneVector) -> LaneVector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The lanes of each finger, as bits.
type FingerLanes = [u32; Finger::COUNT];

const UNKNOWN: AllTips = [[[f32::NAN; LANES]; 3]; Finger::COUNT];

/// The state of eight hands.
#[derive(Clone)]
pub(super) struct Block {
    trackers: Vec<ContactTracker>,
    /// The lanes whose tracker follows a fingertip.
    active: FingerLanes,
    time: Timestamp,
    /// The fingertips on each surface.
    tips: Vec<AllTips>,
    /// Room for the fingertips of the next pose.
    next_tips: Vec<AllTips>,
}

impl Block {
    pub fn new(board: &LaneBoard) -> Self {
        let tips = vec![UNKNOWN; board.surfaces.len()];
        Self {
            trackers: vec![ContactTracker::new(&board.scene); LANES],
            active: [0; Finger::COUNT],
            time: Timestamp::default(),
            next_tips: tips.clone(),
            tips,
        }
    }

    /// Moves the hands through poses. Returns their touches with the lane in place of the hand.
    pub fn run(
        &mut self,
        arm: &LaneArm,
        board: &LaneBoard,
        times: &[Timestamp],
        angles: &[LaneAngles],
    ) -> Vec<HandTouch> {
        let mut all = Vec::new();
        let mut hands = LaneHands::new();
        for (&time, pose) in times.iter().zip(angles) {
            arm.forward_into(pose, &mut hands);
            self.step(board, &hands, time, &mut all);
        }
        all
    }

    fn step(
        &mut self,
        board: &LaneBoard,
        hands: &LaneHands,
        time: Timestamp,
        all: &mut Vec<HandTouch>,
    ) {
        let mut fingers = self.active;
        let pairs = self.tips.iter().zip(&mut self.next_tips);
        for ((previous, current), surface) in pairs.zip(&board.surfaces) {
            *current = surface.place(hands);
            surface.add_candidates(previous, current, &mut fingers);
        }
        for (&finger, mut lanes) in Finger::ALL.iter().zip(fingers) {
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                self.follow((lane, finger), board, time, all);
            }
        }
        std::mem::swap(&mut self.tips, &mut self.next_tips);
        self.time = time;
    }

    /// Updates the tracker of one hand for one finger.
    fn follow(
        &mut self,
        (lane, finger): (usize, Finger),
        board: &LaneBoard,
        time: Timestamp,
        all: &mut Vec<HandTouch>,
    ) {
        let pairs = self.tips.iter().zip(&self.next_tips);
        let centers = pairs.map(|(previous, current)| {
            [previous, current].map(|tips| {
                let tip = tips[finger.index()].map(|lanes| lanes[lane]);
                Vec3::from_array(tip)
            })
        });
        let mut touches = Touches::new();
        let hand = PlacedHand {
            side: board.side,
            tip_radius: board.tip_radius,
            span: [self.time, time],
        };
        let tracker = &mut self.trackers[lane];
        let is_free = tracker.update_finger(finger, &board.scene, &hand, centers, &mut touches);
        let (active, bit) = (&mut self.active[finger.index()], 1 << lane);
        if is_free {
            *active &= !bit
        } else {
            *active |= bit
        }
        let of_lane = |touch: &Touch| HandTouch {
            hand: lane,
            touch: *touch,
        };
        all.extend(touches.iter().map(of_lane));
    }
}
