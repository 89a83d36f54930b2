//! The time of the contact stage for one pose: five swept fingertips against a board.
//!
//! `hovering`: 10 mm above the board. `tapping`: each finger five times per second at 120 poses per
//! second. `crossing`: the worst case, every finger passes through a front at every pose.

use std::hint::black_box;

use ademan::contact::surface::{Anchor, Scene, Shape, TREMOR_MARGIN, Target};
use ademan::contact::volume::{Volume, VolumeSet, VolumeShape};
use ademan::contact::{ContactTracker, Touches};
use ademan::hand::{Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::time::Timestamp;
use divan::Bencher;
use divan::counter::ItemsCount;
use parry3d::math::{Pose, Rotation, Vec2, Vec3};

const KEYS: [u32; 4] = [64, 100, 1_000, 10_000];
const PITCH: f32 = 0.019;
const POSES: usize = 1_200;

fn main() {
    divan::main();
}

/// Returns a flat board, half as deep as wide.
fn scene(keys: u32) -> Scene {
    let columns = ((2 * keys) as f32).sqrt().ceil() as u32;
    let key = |number: u32| {
        let (row, column) = (number / columns, number % columns);
        let center = Vec2::new(column as f32, -(row as f32)) * PITCH;
        Target {
            shape: Shape::Box(Vec2::splat(0.008)),
            surface_from_target: Pose::from_translation(center.extend(0.0)),
            travel: 0.004,
            press_at: 0.5,
            release_at: 0.25,
            margin: TREMOR_MARGIN,
        }
    };
    let flat = Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let mut scene = Scene::new();
    scene.add_surface(
        Anchor::World,
        Pose::from_parts(Vec3::ZERO, flat),
        (0..keys).map(key).collect(),
    );
    scene
}

/// Returns poses of a hand that moves along a row; `height` is the height of a fingertip's pad above the board, by finger
/// and pose.
fn poses(height: impl Fn(usize, usize) -> f32) -> Vec<HandPose> {
    let pose = |number: usize| {
        let time = Timestamp(number as u64 * 8_333);
        let mut pose = HandPose::new(time, Side::Right, 0.006);
        for (index, &finger) in Finger::ALL.iter().enumerate() {
            let offset = 0.02 * (number as f32 * 0.01).sin();
            let x = 0.03 + PITCH * index as f32 + offset;
            let center = Vec3::new(x, 0.006 + height(index, number), 0.04);
            pose.set(Joint::tip(finger), Pose::from_translation(center));
        }
        pose
    };
    (0..POSES).map(pose).collect()
}

fn run(bencher: Bencher, keys: u32, poses: &[HandPose]) {
    let scene = scene(keys);
    let mut tracker = ContactTracker::new(&scene);
    let mut touches = Touches::new();
    bencher
        .counter(ItemsCount::new(poses.len()))
        .bench_local(|| {
            for pose in poses {
                touches.clear();
                tracker.update(&scene, black_box(pose), &mut touches);
                black_box(&touches);
            }
        });
}

#[divan::bench(args = KEYS)]
fn hovering(bencher: Bencher, keys: u32) {
    run(bencher, keys, &poses(|_, _| 0.010));
}

#[divan::bench(args = KEYS)]
fn tapping(bencher: Bencher, keys: u32) {
    // A tap takes 24 poses, 5 of them behind the front, with a different phase for each finger.
    let height = |finger: usize, pose: usize| {
        let phase = (pose + 5 * finger) % 24;
        0.010 - 0.014 * (phase as f32 / 24.0 * std::f32::consts::TAU).sin().max(0.0)
    };
    run(bencher, keys, &poses(height));
}

#[divan::bench(args = KEYS)]
fn crossing(bencher: Bencher, keys: u32) {
    run(
        bencher,
        keys,
        &poses(|_, pose| if pose % 2 == 0 { 0.010 } else { -0.005 }),
    );
}

/// A cursor that moves through balls in space at a pitch of 20 mm.
#[divan::bench(args = [64, 10_000])]
fn through_space(bencher: Bencher, balls: usize) {
    let side = (balls as f32).cbrt().ceil() as usize;
    let ball = |number: usize| Volume {
        center: Vec3::new(
            (number % side) as f32,
            (number / side % side) as f32,
            (number / side / side) as f32,
        ) * 0.02,
        shape: VolumeShape::Ball(0.008),
    };
    let volumes = VolumeSet::new((0..balls).map(ball).collect());
    let position = |number: usize| {
        let phase = number as f32 * 0.01;
        let offset = Vec3::new(phase.sin(), (1.7 * phase).sin(), (2.3 * phase).sin());
        (offset + 1.0) * 0.03
    };
    let positions: Vec<Vec3> = (0..POSES).map(position).collect();
    bencher.counter(ItemsCount::new(POSES - 1)).bench_local(|| {
        for segment in positions.windows(2) {
            black_box(volumes.first_entry([segment[0], segment[1]], 0.0));
        }
    });
}
