//! A hand above a row of keys.

use ademan_core::contact::surface::{Anchor, Scene, Shape, Share, TREMOR_MARGIN, Target};
use ademan_core::contact::{ContactTracker, TargetId, Touch, Touches};
use ademan_core::hand::{Finger, FingerSet, Joint, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::time::Timestamp;
use parry3d::math::{Pose, Rotation, Vec2, Vec3};

pub const RADIUS: f32 = 0.006;
const PITCH: f32 = 0.019;
/// A fingertip that is out of the way.
const AWAY: Vec3 = Vec3::new(0.0, -0.3, 0.05);

const KNUCKLES: [Joint; Finger::COUNT] = [
    Joint::ThumbPhalanxProximal,
    Joint::IndexPhalanxProximal,
    Joint::MiddlePhalanxProximal,
    Joint::RingPhalanxProximal,
    Joint::LittlePhalanxProximal,
];

/// A row of five keys on a board that faces up. Its X is X of the world, its Y is −Z of the world, and key 0 is at the origin.
pub struct Row {
    pub scene: Scene,
    pub tracker: ContactTracker,
    /// Microseconds between two poses.
    pub period: u64,
    pub time: u64,
    pub touches: Vec<Touch>,
}

/// Points of the pads on the board of some fingers, in metres; others are away.
pub type Pads<'a> = &'a [(Finger, Vec3)];

impl Row {
    pub fn new(is_struck: bool) -> Self {
        Self::struck_by(if is_struck {
            FingerSet::ALL
        } else {
            FingerSet::NONE
        })
    }

    /// Creates a row whose keys these fingers press by strokes, and others by planes.
    pub fn struck_by(fingers: FingerSet) -> Self {
        let key = |index: u32| Target {
            shape: Shape::Box(Vec2::splat(0.0085)),
            share: Share {
                low: Vec2::splat(0.001),
                high: Vec2::splat(0.001),
            },
            surface_from_target: Pose::from_translation(Vec3::X * PITCH * index as f32),
            travel: 0.004,
            press_at: 0.5,
            release_at: 0.25,
            margin: TREMOR_MARGIN,
        };
        let mut scene = Scene::new();
        let up = Pose::from_rotation(Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2));
        scene.add_surface(Anchor::World, up, (0..5).map(key).collect());
        if !fingers.is_empty() {
            for index in 0..5 {
                scene.set_struck(TargetId(index), fingers);
            }
        }
        Self {
            tracker: ContactTracker::new(&scene),
            scene,
            period: 5_000,
            time: 0,
            touches: Vec::new(),
        }
    }

    /// Shows a hand. Knuckles are 30 mm above the plane of the keys and 60 mm behind the row, unless the hand is lowered.
    pub fn show(&mut self, pads: Pads, lowered: f32) {
        self.time += self.period;
        let mut pose = HandPose::new(Timestamp(self.time), Side::Right, RADIUS);
        let up = self.scene.surfaces()[0].anchor_from_surface();
        let mut set = |joint, at: Vec3| pose.set(joint, Pose::from_translation(up * at));
        let height = 0.03 - lowered;
        set(Joint::Wrist, Vec3::new(0.0, -0.14, height));
        for &finger in Finger::ALL {
            let x = PITCH * finger.index() as f32;
            set(KNUCKLES[finger.index()], Vec3::new(x, -0.06, height));
            let pad = pads.iter().find(|(other, _)| *other == finger);
            let pad = pad.map_or(AWAY - Vec3::Z * lowered, |(_, pad)| *pad);
            set(Joint::tip(finger), pad + Vec3::Z * RADIUS);
        }
        self.update(&pose);
    }

    pub fn update(&mut self, pose: &HandPose) {
        let mut touches = Touches::new();
        self.tracker.update(&self.scene, pose, &mut touches);
        self.touches.extend(touches);
    }
}

/// Returns a point above or behind a key, in millimetres from its center.
pub fn at(key: u32, x: f32, z: f32) -> Vec3 {
    Vec3::new(PITCH * key as f32 + x * 1e-3, 0.0, z * 1e-3)
}
