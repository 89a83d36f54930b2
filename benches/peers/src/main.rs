//! The library beside other programs that do the same work, in one interleaved run with equal results.
//!
//! Run it with `cargo run --release --manifest-path benches/peers/Cargo.toml -- --bench`; without `--bench` it runs each
//! row once. All figures are nanoseconds for one hand.

#[path = "../../contact/boards.rs"]
mod boards;
mod forward_kinematics;
#[path = "../../support/interleaved.rs"]
mod interleaved;
mod k_chain;
mod link_tree;
#[path = "../../contact/motions.rs"]
mod motions;
#[path = "../../contact/rows.rs"]
mod rows;

use std::hint::black_box;
use std::time::Duration;

use ademan::estimate::Estimate;

use boards::Kind;
use forward_kinematics::{Ours, Tips, recorded_hand};
use k_chain::KChain;
use link_tree::LinkTree;
use motions::Motion;
use rows::{ParryRay, ParryShapeCast, Row, Tracker, pass};

/// The largest distance of a fingertip between two rows, in metres: the rounding of `f32` at arm's length.
const TOLERANCE: f32 = 2e-6;

fn main() {
    let rounds = if interleaved::is_measuring() { 200 } else { 1 };
    print_forward_kinematics(rounds);
    print_contact(rounds);
}

fn print_forward_kinematics(rounds: usize) {
    let (arm, estimates) = recorded_hand();
    let ours = Ours(&arm);
    let tree = LinkTree::new(&arm);
    let chain = KChain::new(&arm);
    for estimate in &estimates {
        let expected = ours.tips(estimate);
        for (name, tips) in [("glam", tree.tips(estimate)), ("k", chain.tips(estimate))] {
            let furthest = expected
                .iter()
                .zip(tips)
                .map(|(one, other)| one.distance(other));
            let furthest = furthest.fold(0.0, f32::max);
            assert!(furthest <= TOLERANCE, "{name}: {furthest} m");
        }
    }
    let times = interleaved::fastest(
        rounds,
        &mut [
            &mut || tips_of_all(&estimates, |estimate| ours.tips(estimate)),
            &mut || tips_of_all(&estimates, |estimate| tree.tips(estimate)),
            &mut || tips_of_all(&estimates, |estimate| chain.tips(estimate)),
        ],
    );
    let joints = arm.links().iter().filter(|link| link.dof.is_some()).count();
    println!("| forward kinematics of {joints} joints | time | relative to ours |\n|---|---|---|");
    let rows = [
        "ours, with the poses of all joints",
        "glam, plain tree of `f32`",
        "`k` 0.32, `f64`",
    ];
    for (name, time) in rows.into_iter().zip(&times) {
        println!(
            "| {name} | {:.0} ns | {:.2} |",
            nanoseconds(*time, estimates.len()),
            time.as_secs_f64() / times[0].as_secs_f64()
        );
    }
}

fn tips_of_all(estimates: &[Estimate], tips: impl Fn(&Estimate) -> Tips) {
    for estimate in estimates {
        black_box(tips(black_box(estimate)));
    }
}

fn print_contact(rounds: usize) {
    println!(
        "\n| contact, 100 keys | hits | ours | ray | shapes | ray / ours | shapes / ours |\n\
         |---|---|---|---|---|---|---|"
    );
    let boards = |motion| Kind::ALL.map(|kind| (motion, kind));
    for (motion, kind) in Motion::ALL.into_iter().flat_map(boards) {
        let (scene, poses) = (kind.scene(100), motion.poses());
        let mut tracker = Tracker::new(&scene);
        let mut ray = ParryRay::new(&scene);
        let mut shapes = ParryShapeCast::new(&scene, 1_000.0);
        let hits = tracker.hits(&poses);
        assert_eq!(ray.hits(&poses), hits, "parry's ray");
        assert_eq!(shapes.hits(&poses), hits, "parry's shape cast");
        let times = interleaved::fastest(
            rounds,
            &mut [
                &mut || pass(&mut tracker, &poses),
                &mut || pass(&mut ray, &poses),
                &mut || pass(&mut shapes, &poses),
            ],
        );
        let [ours, ray, shapes] = [0, 1, 2].map(|row| nanoseconds(times[row], poses.len()));
        println!(
            "| {}, {} | {} | {ours:.0} ns | {ray:.0} ns | {shapes:.0} ns | {:.2} | {:.2} |",
            motion.name(),
            kind.name(),
            hits.len(),
            ray / ours,
            shapes / ours
        );
    }
}

fn nanoseconds(time: Duration, steps: usize) -> f64 {
    time.as_secs_f64() * 1e9 / steps as f64
}
