//! The time of one pipeline step for one hand, by stage. All figures are per reading.
//!
//! The readings come from a simulated typist on the shipped board. The boards of the benchmark
//! have the same keys below the hand and more keys around them. A sample is one pass over all
//! readings, so rest, movement and presses have their natural frequency. `a_nothing` is the cost
//! of copying a reading, which the figures of `c_` and `g_` include.
//!
//! The stages run one after the other. A table of ratios, whose rows take turns, precedes them.

#[path = "support/interleaved.rs"]
mod interleaved;
#[path = "support/plain_hand.rs"]
mod plain_hand;
#[path = "frame/ratios.rs"]
mod ratios;

use std::hint::black_box;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use ademan::capture::hc11::{self, BODY_BYTES, Framing, Hc11Decoder, PACKET_BYTES};
use ademan::capture::protocol::Decoder;
use ademan::capture::{CaptureError, Hc11Format, Reading, Sample, Source, SourceEvent};
use ademan::contact::surface::{Anchor, Scene, Target};
use ademan::contact::{ContactTracker, Phase, TargetId, TargetNames, Touch, Touches};
use ademan::device::keyboard::{Activation, KeyBinding, Keyboard};
use ademan::device::{
    Capabilities, DeviceInput, DeviceOutput, Events, KeyAction, KeyArbiter, KeyCode, KeyKind,
    VirtualDevice,
};
use ademan::estimate::{Estimate, Estimator, EstimatorSettings};
use ademan::hand::{JointAngles, Side};
use ademan::kinematics::{ArmModel, BoneLengths, HandPose};
use ademan::output;
use ademan::pipeline::{LayoutInstance, Pipeline, PipelineSettings, StepOutput};
use ademan::session::with_loop_step;
use ademan::setup::{LoadedSetup, Setup};
use ademan::snapshot::{Snapshot, StepView};
use ademan::time::Timestamp;
use divan::Bencher;
use parry3d::math::{Pose, Rotation, Vec3};

use self::plain_hand::PlainHand;

/// The readings of one pass: 12 s at 115 200 baud.
const READINGS: usize = 2_048;
const TEXT: &str = "the quick brown fox jumps over the lazy dog";

fn main() {
    for board in BOARDS {
        let presses = typing().presses_on(board);
        assert_eq!(presses, typing().presses, "presses on {board:?}");
    }
    print_sizes();
    ratios::print();
    divan::Divan::from_args()
        .sample_size(READINGS as u32)
        .main();
}

/// Prints the sizes of what passes from stage to stage, in bytes.
fn print_sizes() {
    let sizes = [
        ("Reading", size_of::<Reading>()),
        ("JointAngles", size_of::<JointAngles>()),
        ("Estimate", size_of::<Estimate>()),
        ("HandPose", size_of::<HandPose>()),
        ("Touches", size_of::<Touches>()),
        ("Events", size_of::<Events>()),
        ("StepOutput", size_of::<StepOutput>()),
        ("StepView", size_of::<StepView>()),
        ("Snapshot", size_of::<Snapshot>()),
    ];
    println!("| struct | bytes |\n|---|---|");
    for (name, bytes) in sizes {
        println!("| `{name}` | {bytes} |");
    }
}

/// A board with a number of keys.
#[derive(Clone, Copy, Debug)]
enum Board {
    /// One flat surface.
    Flat(usize),
    /// Rotated by 30° against the axes of the search tree, so that bounding boxes overlap.
    Rotated(usize),
    /// Distributed over four surfaces.
    FourSurfaces(usize),
}

const BOARDS: [Board; 6] = [
    Board::Flat(64),
    Board::Flat(100),
    Board::Flat(10_000),
    Board::Rotated(100),
    Board::Rotated(10_000),
    Board::FourSurfaces(10_000),
];

impl Board {
    fn scene(self) -> Scene {
        let shipped = &typing().setup.layout.scene.surfaces()[0];
        let (Self::Flat(keys) | Self::Rotated(keys) | Self::FourSurfaces(keys)) = self;
        let mut targets: Vec<Target> = shipped.targets().map(|(_, target)| *target).collect();
        targets.extend(keys_around(&targets).take(keys - targets.len()));
        // The surface follows the elbow, which does not move.
        let world_from_surface = shipped
            .world_from_surface(&typing().poses[0])
            .expect("the arm has an elbow");
        let mut scene = Scene::new();
        let mut add = |pose, placed| scene.add_surface(Anchor::World, pose, placed);
        match self {
            Self::Flat(_) => {
                add(world_from_surface, targets);
            }
            Self::Rotated(_) => {
                let rotation = Pose::from_parts(Vec3::ZERO, Rotation::from_rotation_z(0.5));
                for target in &mut targets {
                    target.surface_from_target = rotation.inverse() * target.surface_from_target;
                }
                add(world_from_surface * rotation, targets);
            }
            Self::FourSurfaces(_) => {
                for first in 0..4 {
                    let part = targets.iter().skip(first).step_by(4);
                    add(world_from_surface, part.copied().collect());
                }
            }
        }
        scene
    }

    /// Returns a keyboard with other keys side by side: each code that is printed on a keyboard, again and again. Without
    /// modifiers, so that nothing is suppressed.
    fn keyboard(self) -> Keyboard {
        let is_plain = |code: &KeyCode| {
            code.kind() == KeyKind::Keyboard && !code.is_system_key() && !code.is_modifier()
        };
        let codes: Vec<KeyCode> = KeyCode::all().filter(is_plain).take(100).collect();
        let (Self::Flat(keys) | Self::Rotated(keys) | Self::FourSurfaces(keys)) = self;
        let binding = |index: usize| KeyBinding {
            target: TargetId(index as u32),
            actions: vec![Some(KeyAction::Key(codes[index % codes.len()]))],
            reports_depth: false,
            reports_velocity: false,
            activation: Activation::OnPress,
            debounce: Duration::ZERO,
        };
        Keyboard::new((0..keys).map(binding).collect())
    }

    fn pipeline(self) -> Pipeline {
        let arming = PipelineSettings {
            arm_immediately: true,
            ..PipelineSettings::default()
        };
        Pipeline::new(
            typing().estimator(),
            typing().setup.arm.clone(),
            LayoutInstance::new(
                self.scene(),
                TargetNames::default(),
                vec![Box::new(self.keyboard())],
            ),
            arming,
        )
    }
}

/// Returns keys at a pitch of 19 mm around `keys`, the nearest rings first.
fn keys_around(keys: &[Target]) -> impl Iterator<Item = Target> + use<> {
    const PITCH: f32 = 0.019;
    let center = |key: &Target| key.surface_from_target.translation;
    let low = keys.iter().map(center).reduce(Vec3::min).expect("keys");
    let high = keys.iter().map(center).reduce(Vec3::max).expect("keys");
    let columns = ((high.x - low.x) / PITCH).ceil() as i32;
    let rows = ((high.y - low.y) / PITCH).ceil() as i32;
    let template = keys[1];
    (1..).flat_map(move |ring: i32| {
        let row_of = move |row| (-ring..=columns + ring).map(move |column| (column, row));
        let is_in_ring = move |&(column, row): &(i32, i32)| {
            column == -ring || column == columns + ring || row == -ring || row == rows + ring
        };
        let cells = (-ring..=rows + ring).flat_map(row_of).filter(is_in_ring);
        cells.map(move |(column, row)| {
            let position = low + Vec3::new(column as f32, row as f32, 0.0) * PITCH;
            Target {
                surface_from_target: Pose::from_translation(position),
                ..template
            }
        })
    })
}

/// The input of each stage while a simulated person types.
struct Typing {
    setup: LoadedSetup,
    packets: Vec<[u8; PACKET_BYTES]>,
    readings: Vec<Reading>,
    estimates: Vec<Estimate>,
    poses: Vec<HandPose>,
    touches: Vec<Touches>,
    presses: usize,
}

fn typing() -> &'static Typing {
    static TYPING: LazyLock<Typing> = LazyLock::new(Typing::record);
    &TYPING
}

impl Typing {
    fn record() -> Self {
        let setup = Setup::default().load_files().expect("the default setup");
        let mut typist = setup
            .typist(TEXT, &Hc11Format::default(), 0.5, 1)
            .expect("the text is on the board");
        let mut typing = Self {
            setup,
            packets: Vec::new(),
            readings: Vec::new(),
            estimates: Vec::new(),
            poses: Vec::new(),
            touches: Vec::new(),
            presses: 0,
        };
        let mut estimator = typing.estimator();
        let scene = typing.setup.layout.scene.clone();
        let mut tracker = ContactTracker::new(&scene);
        for number in 0..READINGS {
            let counts = typist.next_counts().expect("the text is long enough");
            let body: [u8; BODY_BYTES] = std::array::from_fn(|channel| counts[channel] as u8);
            let reading = Reading::new(
                Timestamp(5_729 * (number as u64 + 1)),
                None,
                Sample::Channels(hc11::channels(&body)),
            );
            let estimate = *estimator.update(&reading).expect("a plausible reading");
            let pose = typing.setup.arm.forward(&estimate);
            let mut touches = Touches::new();
            tracker.update(&scene, &pose, &mut touches);
            typing.presses += presses(&touches);
            typing.packets.push(hc11::encode(Framing::Double06, &body));
            typing.readings.push(reading);
            typing.estimates.push(estimate);
            typing.poses.push(pose);
            typing.touches.push(touches);
        }
        assert!(typing.presses >= 20, "only {} presses", typing.presses);
        typing
    }

    fn estimator(&self) -> Estimator {
        Estimator::new(EstimatorSettings::default())
            .with_channels(&self.setup.glove.as_ref().expect("a glove").map)
    }

    fn anthropometric_arm(&self) -> ArmModel {
        let bones = BoneLengths::from_hand_and_forearm(0.190, 0.255).expect("a person");
        ArmModel::anthropometric(Side::Right, &bones).expect("an arm")
    }

    fn presses_on(&self, board: Board) -> usize {
        let mut pipeline = board.pipeline();
        let mut count = 0;
        for reading in &self.readings {
            let step = pipeline.step(reading, &mut Events::new());
            count += presses(&step.expect("a plausible reading").touches);
        }
        count
    }
}

fn presses(touches: &Touches) -> usize {
    let is_press = |touch: &&Touch| touch.phase == Phase::Pressed;
    touches.iter().filter(is_press).count()
}

/// The readings of endless passes with increasing time stamps.
struct Readings {
    readings: Vec<Reading>,
    next: usize,
}

impl Readings {
    fn new() -> Self {
        Self {
            readings: typing().readings.clone(),
            next: 0,
        }
    }

    fn next(&mut self) -> &Reading {
        self.next = (self.next + 1) % READINGS;
        let reading = &mut self.readings[self.next];
        reading.time.0 += 5_729 * READINGS as u64;
        black_box(reading)
    }
}

/// Passes the items one by one to `stage`, in endless passes.
fn run<T, R>(bencher: Bencher, items: &[T], mut stage: impl FnMut(&T) -> R) {
    let mut items = items.iter().cycle();
    bencher.bench_local(|| items.next().map(|item| stage(black_box(item))));
}

#[divan::bench]
fn a_nothing(bencher: Bencher) {
    let mut readings = Readings::new();
    bencher.bench_local(|| {
        black_box(readings.next());
    });
}

#[divan::bench]
fn b_decode(bencher: Bencher) {
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    run(bencher, &typing().packets, |packet| {
        decoder.push(packet, &mut |decoded| {
            black_box(decoded);
        });
    });
}

#[divan::bench]
fn c_estimate(bencher: Bencher) {
    let mut readings = Readings::new();
    let mut estimator = typing().estimator();
    bencher.bench_local(|| {
        let _ = black_box(estimator.update(readings.next()));
    });
}

#[divan::bench(args = ["unam", "anthropometric"])]
fn d_forward_kinematics(bencher: Bencher, arm: &str) {
    let arm = match arm {
        "unam" => typing().setup.arm.clone(),
        _ => typing().anthropometric_arm(),
    };
    let mut pose = typing().poses[0];
    run(bencher, &typing().estimates, |estimate| {
        arm.forward_into(estimate, &mut pose);
        black_box(&pose);
    });
}

/// The reference: the 21 joints of a hand as a tree of glam's quaternions, with its five fingertips.
#[divan::bench]
fn d_plain_glam(bencher: Bencher) {
    let arm = &typing().anthropometric_arm();
    let hand = PlainHand::new(arm);
    run(bencher, &typing().estimates, |estimate| {
        black_box(hand.fingertips(&estimate.angles));
    });
}

#[divan::bench(args = BOARDS)]
fn e_contact(bencher: Bencher, board: Board) {
    let scene = board.scene();
    let mut tracker = ContactTracker::new(&scene);
    let mut touches = Touches::new();
    run(bencher, &typing().poses, |pose| {
        touches.clear();
        tracker.update(&scene, pose, &mut touches);
        black_box(&touches);
    });
}

#[divan::bench]
fn f_keyboard(bencher: Bencher) {
    let mut keyboard = Board::Flat(100).keyboard();
    let mut arbiter = KeyArbiter::default();
    let scene = Scene::new();
    let mut events = Events::new();
    let pose = typing().poses[0];
    run(bencher, &typing().touches, |touches| {
        events.clear();
        let seen = DeviceInput {
            scene: &scene,
            angles: &typing().estimates[0].angles,
            bends: &Default::default(),
            inputs: &Default::default(),
            pose: &pose,
            touches,
            presses: &[],
        };
        let mut out = DeviceOutput {
            arbiter: &mut arbiter,
            events: &mut events,
            commands: &mut ademan::device::TimedCommands::new(),
        };
        keyboard.update(&seen, &mut out);
        black_box(&events);
    });
}

#[divan::bench(args = BOARDS)]
fn g_step(bencher: Bencher, board: Board) {
    let mut readings = Readings::new();
    let mut pipeline = board.pipeline();
    let mut events = Events::new();
    bencher.bench_local(|| {
        events.clear();
        let _ = black_box(&pipeline.step(readings.next(), &mut events));
        black_box(&events);
    });
}

/// Returns readings of both hands in turn, of which the left one is the mirror image of the right one, and their pipeline.
fn two_hands() -> (Readings, Pipeline) {
    let mut readings = Readings::new();
    for (reading, side) in readings.readings.iter_mut().zip(Side::ALL.iter().cycle()) {
        reading.side = Some(*side);
    }
    let left_arm = typing().setup.arm.clone().for_side(Side::Left);
    let pipeline = Board::Flat(100).pipeline();
    let both = pipeline.with_second_hand(typing().estimator(), left_arm);
    (readings, both)
}

#[divan::bench]
fn g_step_of_two_hands(bencher: Bencher) {
    let (mut readings, mut pipeline) = two_hands();
    let mut events = Events::new();
    bencher.bench_local(|| {
        events.clear();
        let _ = black_box(&pipeline.step(readings.next(), &mut events));
        black_box(&events);
    });
}

/// The step, and the loop of a session around it: with an observer that looks at the step, and with one that copies it.
#[divan::bench(args = ["looks", "copies"])]
fn g_step_in_loop(bencher: Bencher, observer: &str) {
    let mut readings = Readings::new();
    let mut pipeline = Board::Flat(100).pipeline();
    let mut sink = output::open("none", &Capabilities::default()).expect("the output `none`");
    let mut look = |step: &StepView, _: Instant, _: &Pipeline| _ = black_box(step.events);
    let mut copy = |step: &StepView, _: Instant, _: &Pipeline| _ = black_box(&step.to_snapshot());
    let observe: &mut dyn FnMut(&StepView, Instant, &Pipeline) = match observer {
        "looks" => &mut look,
        _ => &mut copy,
    };
    let body = |step: &mut dyn FnMut(&Reading)| bencher.bench_local(|| step(readings.next()));
    with_loop_step(SilentSource, &mut pipeline, &mut *sink, observe, body).expect("a loop");
}

/// A source without readings.
struct SilentSource;

impl Source for SilentSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        std::thread::sleep(Duration::from_millis(20));
        Ok(SourceEvent::Idle)
    }

    fn name(&self) -> &str {
        "silent"
    }
}

#[divan::bench(args = BOARDS)]
fn h_bytes_to_events(bencher: Bencher, board: Board) {
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    let mut pipeline = board.pipeline();
    let mut events = Events::new();
    let mut time = Timestamp(0);
    run(bencher, &typing().packets, |packet| {
        decoder.push(packet, &mut |decoded| {
            time.0 += 5_729;
            let sample = decoded.sample;
            events.clear();
            let _ = black_box(&pipeline.step(&Reading::new(time, None, sample), &mut events));
            black_box(&events);
        });
    });
}
