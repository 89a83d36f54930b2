//! Time of the contact stage for one frame: five swept fingertips against a board.
//!
//! `hovering`: 10 mm over the board. `tapping`: each finger five times a second at 120 frames a
//! second. `crossing`: the worst case, every finger goes through a front in every frame.

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
const FRAMES: usize = 1_200;

fn main() {
    divan::main();
}

/// Half as deep as wide, lying flat.
fn scene(keys: u32) -> Scene {
    let columns = ((2 * keys) as f32).sqrt().ceil() as u32;
    let key = |number: u32| {
        let (row, column) = (number / columns, number % columns);
        let middle = Vec2::new(column as f32, -(row as f32)) * PITCH;
        Target {
            shape: Shape::Box(Vec2::splat(0.008)),
            surface_from_target: Pose::from_translation(middle.extend(0.0)),
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

/// Frames in which each fingertip's pad is as high over the board as `height` says for its finger
/// and the frame; the hand wanders along a row.
fn poses(height: impl Fn(usize, usize) -> f32) -> Vec<HandPose> {
    let frame = |number: usize| {
        let time = Timestamp(number as u64 * 8_333);
        let mut pose = HandPose::new(time, Side::Right, 0.006);
        for (place, &finger) in Finger::ALL.iter().enumerate() {
            let wander = 0.02 * (number as f32 * 0.01).sin();
            let x = 0.03 + PITCH * place as f32 + wander;
            let centre = Vec3::new(x, 0.006 + height(place, number), 0.04);
            pose.set(Joint::tip(finger), Pose::from_translation(centre));
        }
        pose
    };
    (0..FRAMES).map(frame).collect()
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
    // 24 frames a tap, 5 of them behind the front; the fingers take turns.
    let height = |finger: usize, frame: usize| {
        let turn = (frame + 5 * finger) % 24;
        0.010 - 0.014 * (turn as f32 / 24.0 * std::f32::consts::TAU).sin().max(0.0)
    };
    run(bencher, keys, &poses(height));
}

#[divan::bench(args = KEYS)]
fn crossing(bencher: Bencher, keys: u32) {
    run(
        bencher,
        keys,
        &poses(|_, frame| if frame % 2 == 0 { 0.010 } else { -0.005 }),
    );
}

/// A cursor that wanders through balls in space, 20 mm from middle to middle.
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
    let place = |frame: usize| {
        let turn = frame as f32 * 0.01;
        let wander = Vec3::new(turn.sin(), (1.7 * turn).sin(), (2.3 * turn).sin());
        (wander + 1.0) * 0.03
    };
    let places: Vec<Vec3> = (0..FRAMES).map(place).collect();
    bencher
        .counter(ItemsCount::new(FRAMES - 1))
        .bench_local(|| {
            for way in places.windows(2) {
                black_box(volumes.first_entry([way[0], way[1]], 0.0));
            }
        });
}
