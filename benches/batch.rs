//! Forward kinematics and contact of many hands at once, beside one hand at a time.
//!
//! All rows have the same hands, which type on the default layout, and must find the same touches. The rows take turns. Without
//! `--bench` (as in `cargo test --benches`) each runs once.

#[path = "support/interleaved.rs"]
mod interleaved;

use std::hint::black_box;
use std::thread;

use ademan::batch::{HandBatch, HandTouch, LANES, LaneAngles, LaneTips};
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::contact::surface::Scene;
use ademan::contact::{ContactTracker, Touches};
use ademan::estimate::{Estimate, Estimator, EstimatorSettings};
use ademan::hand::JointAngles;
use ademan::kinematics::{ArmModel, HandPose};
use ademan::setup::Setup;
use ademan::time::Timestamp;

/// Hands at once.
const HANDS: usize = 64;

/// Poses of each hand: six seconds.
const FRAMES: usize = 1_024;

/// Passes of each row; the fastest one counts.
const ROUNDS: usize = 30;

const TEXT: &str = "the quick brown fox jumps over the lazy dog";

/// The input of all rows.
struct Hands {
    arm: ArmModel,
    scene: Scene,
    times: Vec<Timestamp>,
    /// The angles of each hand at all times.
    angles: Vec<Vec<JointAngles>>,
    /// The angles in the lanes of blocks.
    lanes: Vec<LaneAngles>,
}

fn main() {
    let rounds = if interleaved::is_measuring() {
        ROUNDS
    } else {
        1
    };
    let hands = Hands::new();
    let cores = thread::available_parallelism().map_or(1, |cores| cores.get());
    let expected = hands.one_by_one();
    assert_eq!(hands.together(1), expected, "one thread");
    assert_eq!(hands.together(cores), expected, "{cores} threads");
    let times = interleaved::fastest(
        rounds,
        &mut [
            &mut || hands.forward_one_by_one(),
            &mut || hands.forward_together(),
            &mut || _ = black_box(hands.one_by_one()),
            &mut || _ = black_box(hands.together(1)),
            &mut || _ = black_box(hands.together(cores)),
        ],
    );
    println!("{HANDS} hands, {} touches\n", expected.len());
    println!("| work | time of a hand and pose | of them per second | relative |");
    println!("|---|---|---|---|");
    let all_cores = format!("both, {LANES} at once, {cores} threads");
    let rows = [
        ("forward kinematics, one by one", 0, 0),
        ("forward kinematics to the fingertips, 8 at once", 1, 0),
        ("both, one by one", 2, 2),
        ("both, 8 at once", 3, 2),
        (&*all_cores, 4, 2),
    ];
    for (name, row, reference) in rows {
        let seconds = times[row].as_secs_f64() / (HANDS * FRAMES) as f64;
        let ratio = times[reference].as_secs_f64() / times[row].as_secs_f64();
        println!(
            "| {name} | {:.1} ns | {:.1} million | {ratio:.2} |",
            seconds * 1e9,
            1e-6 / seconds
        );
    }
}

impl Hands {
    /// Creates hands that type the same text, each from another place in it.
    fn new() -> Self {
        let setup = Setup::default().load_files().expect("the default setup");
        let glove = &setup.glove.as_ref().expect("a glove").map;
        let mut estimator = Estimator::new(EstimatorSettings::default()).with_channels(glove);
        let typist = setup.typist(TEXT, &Hc11Format::default(), 0.5, 1);
        let mut typist = typist.expect("the hand can type the text");
        let mut typed: Vec<JointAngles> = Vec::new();
        while let SourceEvent::Reading(reading) = typist.next().expect("no errors") {
            let estimate = estimator.update(&reading).expect("a plausible reading");
            typed.push(in_single_precision(&estimate.angles));
        }
        assert!(typed.len() > FRAMES, "only {} readings", typed.len());
        let angles_of = |hand: usize| {
            let start = hand * typed.len() / HANDS;
            let angles = typed.iter().cycle().skip(start).take(FRAMES);
            angles.copied().collect()
        };
        let angles: Vec<Vec<JointAngles>> = (0..HANDS).map(angles_of).collect();
        let mut lanes = vec![LaneAngles::default(); HANDS / LANES * FRAMES];
        for (index, frame_lanes) in lanes.iter_mut().enumerate() {
            for lane in 0..LANES {
                let hand = index / FRAMES * LANES + lane;
                frame_lanes.set(lane, &angles[hand][index % FRAMES]);
            }
        }
        Self {
            arm: setup.arm.clone(),
            scene: setup.layout.scene.clone(),
            times: (1..=FRAMES as u64)
                .map(|frame| Timestamp(frame * 5_729))
                .collect(),
            angles,
            lanes,
        }
    }

    fn forward_one_by_one(&self) {
        let mut pose = HandPose::new(Timestamp(0), self.arm.side(), 0.0);
        let mut estimate = Estimate::new(Timestamp(0), JointAngles::default());
        for angles in self.angles.iter().flatten() {
            estimate.angles = *angles;
            self.arm.forward_into(&estimate, &mut pose);
            black_box(&pose);
        }
    }

    fn forward_together(&self) {
        let batch = HandBatch::new(&self.arm, &self.scene, 0);
        let mut tips = [LaneTips::default(); 64];
        for angles in self.lanes.chunks(64) {
            batch.forward(angles, &mut tips[..angles.len()]);
            black_box(&tips);
        }
    }

    fn one_by_one(&self) -> Vec<HandTouch> {
        let mut pose = HandPose::new(Timestamp(0), self.arm.side(), 0.0);
        let mut all = Vec::new();
        for (hand, angles) in self.angles.iter().enumerate() {
            let mut tracker = ContactTracker::new(&self.scene);
            let mut touches = Touches::new();
            let mut estimate = Estimate::new(Timestamp(0), JointAngles::default());
            for (pose_angles, time) in angles.iter().zip(&self.times) {
                (estimate.time, estimate.angles) = (*time, *pose_angles);
                self.arm.forward_into(&estimate, &mut pose);
                tracker.update(&self.scene, &pose, &mut touches);
                all.extend(touches.drain(..).map(|touch| HandTouch { hand, touch }));
            }
        }
        all
    }

    fn together(&self, threads: usize) -> Vec<HandTouch> {
        let mut batch = HandBatch::new(&self.arm, &self.scene, HANDS);
        batch.run(&self.times, &self.lanes, threads)
    }
}

/// Rounds angles to what a batch has.
fn in_single_precision(angles: &JointAngles) -> JointAngles {
    let mut rounded = JointAngles::default();
    for (dof, radians) in angles.known() {
        rounded.set(dof, f64::from(radians as f32));
    }
    rounded
}
