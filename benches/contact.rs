//! The time of the contact stage for one pose, five fingertips against a board, beside parry alone.
//!
//! All rows of a line run in turn and must find the same entries. `growth` is the time with this many keys relative to the time with
//! 64 keys. Without `--bench` (as in `cargo test --benches`) it measures one pass.

#[path = "contact/boards.rs"]
mod boards;
#[path = "support/interleaved.rs"]
mod interleaved;
#[path = "contact/motions.rs"]
mod motions;
#[path = "contact/rows.rs"]
mod rows;

use std::hint::black_box;
use std::time::Instant;

use ademan::contact::surface::Scene;
use ademan::contact::volume::{Volume, VolumeSet, VolumeShape};
use ademan::kinematics::HandPose;
use parry3d::math::Vec3;

use boards::Kind;
use motions::Motion;
use rows::{ParryRay, ParryShapeCast, Row, Tracker, pass};

const KEYS: [usize; 4] = [64, 100, 1_000, 10_000];

/// Passes of each row; the fastest one counts.
const ROUNDS: usize = 100;

fn main() {
    let rounds = if interleaved::is_measuring() {
        ROUNDS
    } else {
        1
    };
    println!(
        "| motion | board | keys | entries | ours | ray | shapes | ray / ours | shapes / ours | growth |\n\
         |---|---|---|---|---|---|---|---|---|---|"
    );
    print_contact(rounds);
    print_units();
    print_rebuild(rounds);
    print_space(rounds);
}

fn print_contact(rounds: usize) {
    for motion in Motion::ALL {
        let poses = motion.poses();
        for kind in Kind::ALL {
            let mut smallest = None;
            for keys in KEYS {
                let scene = kind.scene(keys);
                let (hits, [ours, ray, shapes]) = times(&scene, &poses, rounds);
                let growth = ours / *smallest.get_or_insert(ours);
                println!(
                    "| {} | {} | {keys} | {hits} | {ours:.0} ns | {ray:.0} ns | {shapes:.0} ns | {:.2} | {:.2} | {growth:.2} |",
                    motion.name(),
                    kind.name(),
                    ray / ours,
                    shapes / ours,
                );
            }
        }
    }
}

/// Returns the number of entries and the time of a pose in each row, in nanoseconds.
fn times(scene: &Scene, poses: &[HandPose], rounds: usize) -> (usize, [f64; 3]) {
    let mut tracker = Tracker::new(scene);
    let mut ray = ParryRay::new(scene);
    let mut shapes = ParryShapeCast::new(scene, 1_000.0);
    let hits = tracker.hits(poses);
    assert_eq!(ray.hits(poses), hits, "parry's ray");
    assert_eq!(shapes.hits(poses), hits, "parry's shape cast");
    let times = interleaved::fastest(
        rounds,
        &mut [
            &mut || pass(&mut tracker, poses),
            &mut || pass(&mut ray, poses),
            &mut || pass(&mut shapes, poses),
        ],
    );
    let per_pose = |row: usize| times[row].as_secs_f64() * 1e9 / poses.len() as f64;
    (hits.len(), [0, 1, 2].map(per_pose))
}

/// The entries that `cast_shapes` finds with lengths in metres.
fn print_units() {
    let (scene, poses) = (Kind::Regular.scene(100), Motion::Tap.poses());
    let expected = Tracker::new(&scene).hits(&poses).len();
    let found = ParryShapeCast::new(&scene, 1.0).hits(&poses).len();
    println!("\n`cast_shapes` in metres finds {found} of {expected} entries");
}

/// The time to build the scene of a board, as at the start and when a layout is edited.
fn print_rebuild(rounds: usize) {
    println!("\n| scene of 10 000 keys | time | goal |\n|---|---|---|");
    for kind in Kind::ALL {
        let scene = kind.scene(10_000);
        let surfaces: Vec<_> = scene
            .surfaces()
            .iter()
            .map(|surface| {
                let targets: Vec<_> = surface.targets().map(|(_, target)| *target).collect();
                (surface.anchor(), surface.anchor_from_surface(), targets)
            })
            .collect();
        let mut fastest = f64::INFINITY;
        for _ in 0..rounds {
            let copy = surfaces.clone();
            let start = Instant::now();
            let mut copied = Scene::new();
            for (anchor, pose, targets) in copy {
                copied.add_surface(anchor, pose, targets);
            }
            fastest = fastest.min(start.elapsed().as_secs_f64());
            black_box(copied);
        }
        println!("| {} | {:.2} ms | 1 ms |", kind.name(), fastest * 1e3);
    }
}

/// A cursor that moves through balls in space at a pitch of 20 mm.
fn print_space(rounds: usize) {
    println!("\n| balls in space | time of a step |\n|---|---|");
    for balls in [64, 10_000] {
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
        let positions: Vec<Vec3> = (0..1_200).map(position).collect();
        let times = interleaved::fastest(
            rounds,
            &mut [&mut || {
                for segment in positions.windows(2) {
                    black_box(volumes.first_entry([segment[0], segment[1]], 0.0));
                }
            }],
        );
        let nanoseconds = times[0].as_secs_f64() * 1e9 / (positions.len() - 1) as f64;
        println!("| {balls} | {nanoseconds:.0} ns |");
    }
}
