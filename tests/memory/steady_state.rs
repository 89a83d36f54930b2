//! The path from bytes to events does not allocate after the start.
#![allow(
    unsafe_code,
    reason = "a global allocator can only be written as unsafe code"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use ademan::capture::hc11::{Framing, Hc11Decoder};
use ademan::capture::protocol::Decoder;
use ademan::capture::{Hc11Format, Reading, Sample};
use ademan::contact::{Phase, TargetId, Touch, Touches};
use ademan::device::keyboard::Keyboard;
use ademan::device::{
    Axis, DeviceInput, DeviceOutput, EventKind, Events, KeyArbiter, OutputEvent, VirtualDevice,
};
use ademan::estimate::{JointAngles, Rejection};
use ademan::files::Load;
use ademan::hand::{Dof, Finger, HandPart, Joint, JointPositions, Side};
use ademan::kinematics::HandPose;
use ademan::layout::Layout as Keys;
use ademan::pipeline::{LayoutInstance, Pipeline, PipelineState, SourceRole};
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::setup::{LoadedSetup, Setup};
use ademan::text::{TextModeSchema, TextSetup};
use ademan::time::Timestamp;
use parry3d::math::{Pose, Rotation, Vec2, Vec3};

use crate::support::press::{postures, reading};
use crate::support::source::typing_estimates;
use crate::support::wearer::packets;

/// The system allocator with counters for each thread.
struct CountingAllocator;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    static FREES: Cell<u64> = const { Cell::new(0) };
    static LIVE_BYTES: Cell<i64> = const { Cell::new(0) };
}

fn add_live(bytes: i64) {
    LIVE_BYTES.with(|live| live.set(live.get() + bytes));
}

fn count() {
    ALLOCATIONS.with(|allocations| allocations.set(allocations.get() + 1));
}

// SAFETY: every call is forwarded unchanged to the system allocator.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        add_live(layout.size() as i64);
        // SAFETY: the caller fulfils the contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        FREES.with(|frees| frees.set(frees.get() + 1));
        add_live(-(layout.size() as i64));
        // SAFETY: the caller fulfils the contract.
        unsafe { System.dealloc(block, layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        add_live(size as i64 - layout.size() as i64);
        // SAFETY: the caller fulfils the contract.
        unsafe { System.realloc(block, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Returns the number of allocations of this thread.
pub fn allocations() -> u64 {
    ALLOCATIONS.with(Cell::get)
}

fn frees() -> u64 {
    FREES.with(Cell::get)
}

/// Returns the bytes that this thread has allocated and not freed.
pub fn live_bytes() -> i64 {
    LIVE_BYTES.with(Cell::get)
}

#[test]
fn moving_and_auto_recentering_boards_do_not_allocate() {
    let text = "Layout(name: \"a\", boards: [(auto_recenter: (delay_ms: 100), pose: (anchor: elbow, \
                bearing_deg: 35, forward_mm: 300, height_mm: -145), \
                rows: [(at_mm: (0, 0), keys: \"A B C\")])])";
    let mut setup = Setup::default().load_files().expect("the default setup");
    let typist = setup.typist("h", &Hc11Format::default(), 0.0, 0);
    let counts = typist.expect("a text on the board").next_counts();
    let counts = counts.expect("a first packet");
    let body: [u8; 64] = std::array::from_fn(|channel| counts[channel] as u8);
    setup.layout = Keys::parse(text, "a.ron").expect("a layout");
    let mut pipeline = setup.pipeline();
    let mut events = Events::new();
    let mut step = |stepped: &mut Pipeline, index: u64| {
        let reading = reading(Timestamp(10_000 * index), &body);
        let before = allocations();
        stepped
            .step(&reading, &mut events)
            .expect("a plausible reading");
        allocations() - before
    };
    let mut allocated = 0;
    for index in 1..40 {
        allocated += step(&mut pipeline, index);
    }
    assert_eq!(pipeline.state(), PipelineState::Running);
    let rest = pipeline.board_poses().next();
    for index in 40..100 {
        allocated += step(&mut pipeline, index);
    }
    assert_ne!(pipeline.board_poses().next(), rest, "auto-recentering");
    let mut move_events = Events::new();
    let before = allocations();
    let nudged = pipeline.nudge(Vec3::splat(0.01), &mut move_events);
    let tilted = pipeline.tilt(0.1, &mut move_events);
    let recentered = pipeline.recenter(&mut move_events);
    allocated += allocations() - before;
    assert_eq!([nudged, tilted, recentered], [Ok(()); 3]);
    assert_eq!(allocated, 0);
}

#[test]
fn a_packet_is_processed_to_events_without_allocation() {
    let setup = Setup::default().load_files().expect("the default setup");
    let text = "Steady State!";
    let typist = setup.typist(text, &Hc11Format::default(), 0.5, 7);
    let bytes = packets(&postures(typist.expect("the text can be typed")));
    let mut pipeline = setup.pipeline();
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    let mut events = Events::new();
    let (mut steps, mut sent) = (0, 0);

    let before = allocations();
    for chunk in bytes.chunks(29) {
        decoder.push(chunk, &mut |packet| {
            steps += 1;
            let reading = Reading::new(Timestamp(5_729 * steps), None, packet.sample);
            events.clear();
            let _ = std::hint::black_box(pipeline.step(&reading, &mut events));
            sent += events.len();
        });
    }
    pipeline.stop(&mut events);
    let allocated = allocations() - before;

    assert_eq!(pipeline.accepted(), steps);
    // A press and a release for every key and every Shift, so that the whole path was used.
    assert_eq!(sent, 2 * (text.len() + 3));
    assert_eq!(allocated, 0, "{allocated} allocations in {steps} steps");
    drop(std::hint::black_box(Box::new(0)));
    assert!(allocations() > before, "the allocator does not count");
}

/// Returns the readings of a hand that types `text`, at intervals of 5.7 ms.
fn readings(setup: &LoadedSetup, text: &str) -> Vec<Reading> {
    let typist = setup.typist(text, &Hc11Format::default(), 0.5, 7);
    let postures = postures(typist.expect("the text can be typed"));
    let numbered = (1..).zip(&postures);
    numbered
        .map(|(number, posture)| reading(Timestamp(5_729 * number), posture))
        .collect()
}

/// Processes `readings` with time stamps delayed by `delay_us`. Returns the number of events.
fn play(pipeline: &mut Pipeline, readings: &mut [Reading], delay_us: u64) -> usize {
    let mut events = Events::new();
    let mut sent = 0;
    for reading in readings {
        reading.time.0 += delay_us;
        events.clear();
        let _ = std::hint::black_box(pipeline.step(reading, &mut events));
        sent += events.len();
    }
    sent
}

#[test]
fn rejections_stalls_jumps_and_rearming_do_not_allocate() {
    let setup = Setup::default().load_files().expect("the default setup");
    let mut typing = readings(&setup, "ab");
    let mut pipeline = setup.pipeline();
    let mut impossible = typing[200].clone();
    let Sample::Channels(channels) = &mut impossible.sample else {
        panic!("a glove has channels");
    };
    channels.counts.fill(250);
    let mut short = impossible.clone();
    let Sample::Channels(short_channels) = &mut short.sample else {
        panic!("a glove has channels");
    };
    short_channels.counts.truncate(3);
    let mut far = typing[200].clone();
    let Sample::Channels(far_channels) = &mut far.sample else {
        panic!("a glove has channels");
    };
    // The elbow turns by 1 rad.
    far_channels.counts[17] += 100;
    let mut faulty = [
        typing[0].clone(),
        impossible,
        short,
        far.clone(),
        far.clone(),
        far,
    ];
    let end = typing.last().expect("readings").time.0;
    for (index, reading) in faulty.iter_mut().enumerate().skip(1) {
        reading.time = Timestamp(end + 5_729 * index as u64);
    }
    let mut events = Events::new();

    let before = allocations();
    let typed = play(&mut pipeline, &mut typing, 0);
    play(&mut pipeline, &mut faulty, 0);
    pipeline.stall(&mut events);
    let stalled = pipeline.state();
    let typed_again = play(&mut pipeline, &mut typing, 10_000_000);
    let typed_after_a_gap = play(&mut pipeline, &mut typing, 10_000_000);
    pipeline.stop(&mut events);
    let allocated = allocations() - before;

    assert_eq!([typed, typed_again, typed_after_a_gap], [4; 3]);
    assert_eq!(stalled, PipelineState::Stalled);
    assert_eq!(pipeline.stalls(), 2);
    for reason in [
        Rejection::WrongShape,
        Rejection::OutOfOrder,
        Rejection::OutsideLimits,
        Rejection::TooFast,
    ] {
        assert!(pipeline.rejected()[reason.index()] > 0, "{reason}");
    }
    assert_eq!(allocated, 0);
}

fn update(
    keyboard: &mut Keyboard,
    arbiter: &mut KeyArbiter,
    pose: &HandPose,
    touches: &[Touch],
    events: &mut Events,
) {
    let input = DeviceInput {
        scene: &ademan::contact::surface::Scene::new(),
        angles: &JointAngles::default(),
        bends: &Default::default(),
        inputs: &Default::default(),
        pose,
        touches,
        presses: &[],
    };
    keyboard.update(
        &input,
        &mut DeviceOutput {
            arbiter,
            events,
            commands: &mut ademan::device::TimedCommands::new(),
        },
    );
}

fn release_all(
    keyboard: &mut Keyboard,
    arbiter: &mut KeyArbiter,
    time: Timestamp,
    events: &mut Events,
) {
    arbiter.release_all(time, events);
    keyboard.release_all(
        time,
        &mut DeviceOutput {
            arbiter,
            events,
            commands: &mut ademan::device::TimedCommands::new(),
        },
    );
}

#[test]
fn every_option_of_a_key_is_free_of_allocation() {
    let text = r#"Layout(name: "t", boards: [(pose: (anchor: elbow), debounce_ms: 20, keys: [
        (code: "A", activate_on: Release, at_mm: (0, 0)),
        (code: "B", hold: (code: "ShiftLeft"), hold_after_ms: 60, at_mm: (20, 0)),
        (code: "C", hold: (layer: "l"), hold_after_ms: 2000, at_mm: (40, 0)),
        (code: "AltLeft", latch: Lock, at_mm: (60, 0)),
        (layer: "l", latch: Lock, at_mm: (80, 0)),
    ])], layers: [(name: "l", keys: {"A": "1"})])"#;
    let keys = Keys::parse(text, "t.ron").expect("a layout");
    let mut keyboard = Keyboard::new(keys.key_bindings());
    let mut arbiter = KeyArbiter::default();
    let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
    let (mut random, mut sent) = (fastrand::Rng::with_seed(1), 0);

    let before = allocations();
    for index in 0..10_000_u64 {
        pose.time = Timestamp(index * 15_000);
        let touch = |&finger: &Finger| Touch {
            time: pose.time,
            side: Side::Right,
            finger,
            target: TargetId(finger.index() as u32),
            phase: Phase::ALL[random.usize(..Phase::ALL.len())],
            depth: 0.5,
            position: Vec2::ZERO,
        };
        let touches: Touches = Finger::ALL.iter().map(touch).collect();
        let mut events = Events::new();
        update(&mut keyboard, &mut arbiter, &pose, &touches, &mut events);
        if index % 100 == 99 {
            release_all(&mut keyboard, &mut arbiter, pose.time, &mut events);
        }
        sent += events.len();
    }
    let allocated = allocations() - before;

    assert!(sent > 4_000, "only {sent} events");
    assert_eq!(allocated, 0);
}

#[test]
fn controls_and_gestures_do_not_allocate() {
    let text = r#"Layout(name: "t", boards: [(pose: (anchor: elbow),
        keys: [(code: "A", at_mm: (0, 0)), (code: "B", at_mm: (20, 0)), (code: "C", dwell_ms: 50, at_mm: (40, 0))],
        radios: [(name: "R", options: [
            (name: "r0", at_mm: (0, 20), hold: Key("F1")), (name: "r1", at_mm: (20, 20), tap: Key("F2")),
        ])],
        toggles: [(name: "t0", at_mm: (0, 110), hold: Key("F3")), (name: "t1", at_mm: (20, 110), tap: Key("F4"))],
        touch_surfaces: [
            (name: "pad", at_mm: (0, 60), size_mm: Box(40, 40), mode: Touchpad),
            (name: "screen", at_mm: (50, 60), size_mm: Box(40, 40), mode: Touchscreen),
        ],
    )], chords: [(keys: "A B", action: Text("ñandú"))],
    triggers: [
        (name: "claw", action: Key("X"), output: Axis("LeftX"),
         when: Angle(dof: "index-mcp-flexion", on_deg: 50, off_deg: 40, zero_deg: 0, full_deg: 90)),
        (name: "pinch", action: Key("MouseLeft"), when: Pinch(finger: "index")),
        (name: "circle", action: Key("Y"), when: Circle(point: "index")),
        (name: "both", action: Key("Z"), when: Sequence(steps: ["claw", "pinch"])),
    ])"#;
    let layout = Keys::parse(text, "t.ron").expect("a layout");
    let targets = layout.scene.len() as u64;
    let mut devices = layout.devices();
    let mut arbiter = KeyArbiter::new(layout.texts.clone());
    let mut angles = JointAngles::default();
    let mut random = fastrand::Rng::with_seed(1);
    let mut next = |below: u64| random.u64(..below);
    let mut sent = 0;

    let before = allocations();
    for index in 0..10_000_u64 {
        let mut pose = HandPose::new(Timestamp(index * 15_000), Side::Right, 0.005);
        for tip in [Joint::ThumbTip, Joint::IndexTip] {
            let position = Vec3::X * next(60) as f32 * 1e-3;
            pose.set(tip, Pose::from_translation(position));
        }
        angles.set(Dof::IndexMcpFlexion, next(90) as f64 / 60.0);
        let touch = |&finger: &Finger| Touch {
            time: pose.time,
            side: Side::Right,
            finger,
            target: TargetId(next(targets) as u32),
            phase: Phase::ALL[next(Phase::COUNT as u64) as usize],
            depth: 0.5,
            position: Vec2::new(next(40) as f32, next(40) as f32) * 1e-3,
        };
        let touches: Touches = Finger::ALL.iter().map(touch).collect();
        let input = DeviceInput {
            scene: &layout.scene,
            angles: &angles,
            bends: &Default::default(),
            inputs: &Default::default(),
            pose: &pose,
            touches: &touches,
            presses: &[],
        };
        let mut events = Events::new();
        let mut out = DeviceOutput {
            arbiter: &mut arbiter,
            events: &mut events,
            commands: &mut ademan::device::TimedCommands::new(),
        };
        for device in &mut devices {
            device.update(&input, &mut out);
            if index % 100 == 99 {
                device.release_all(pose.time, &mut out);
            }
        }
        sent += events.len();
    }
    let allocated = allocations() - before;

    assert!(sent > 10_000, "only {sent} events");
    assert_eq!(allocated, 0);
}

#[test]
fn a_layout_change_neither_allocates_nor_frees_in_the_loop() {
    let setup = Setup::default().load_files().expect("the default setup");
    let mut typing = readings(&setup, "ab");
    let mut pipeline = setup.pipeline();
    let typed = play(&mut pipeline, &mut typing, 0);
    let dvorak = Keys::load("dvorak-flat").expect("the shipped layout");
    let mut others = LayoutInstance::from_layout(&dvorak);
    let mut events = Events::new();

    let before = (allocations(), frees());
    pipeline.replace_profile(0, &mut others, &mut events);
    let typed_again = play(&mut pipeline, &mut typing, 10_000_000);
    let after = (allocations(), frees());

    assert_eq!([typed, typed_again], [4; 2]);
    assert_eq!(after, before);
    drop(others);
    assert!(frees() > after.1, "the caller frees the old layout");
}

#[test]
fn corrections_and_candidates_do_not_allocate() {
    let setup = Setup {
        text: Some(TextSetup {
            mode: Some(TextModeSchema::Auto),
            ..TextSetup::default()
        }),
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the default setup");
    let line = "teh quikc brown fox jumps over teh lazy dog ";
    let mut typing = readings(&setup, line);
    let mut pipeline = setup.pipeline();
    play(&mut pipeline, &mut typing, 0);

    let before = (allocations(), frees());
    let sent = play(&mut pipeline, &mut typing, 100_000_000);
    let after = (allocations(), frees());

    // Each correction deletes and types more than the line has.
    assert!(sent > 2 * line.len() + 8, "only {sent} events");
    assert_eq!(after, before);
}

#[test]
fn depths_of_analogue_keys_and_releases_do_not_allocate() {
    let arrows = Keys::load("arrows").expect("the shipped layout");
    let mut keyboard = Keyboard::new(arrows.key_bindings());
    let mut arbiter = KeyArbiter::default();
    let pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
    let mut depths = 0;

    let before = allocations();
    for index in 0..100_u64 {
        let touch = |&finger: &Finger| Touch {
            time: Timestamp(index * 5_729),
            side: Side::Right,
            finger,
            target: TargetId(finger.index() as u32 % 4),
            phase: [Phase::Touched, Phase::Pressed, Phase::Moved][(index % 3) as usize],
            depth: (index % 7) as f32 / 7.0,
            position: Vec2::ZERO,
        };
        let touches: Touches = Finger::ALL.iter().map(touch).collect();
        let mut events = Events::new();
        update(&mut keyboard, &mut arbiter, &pose, &touches, &mut events);
        if index % 10 == 9 {
            release_all(
                &mut keyboard,
                &mut arbiter,
                Timestamp(index * 5_729),
                &mut events,
            );
        }
        let is_depth = |action| matches!(action, EventKind::Depth(..));
        depths += events.iter().filter(|event| is_depth(event.kind)).count();
    }
    let allocated = allocations() - before;

    assert!(depths > 300, "only {depths} depths");
    assert_eq!(allocated, 0);
}

#[test]
fn the_session_loop_does_not_allocate() {
    let setup = Setup::default().load_files().expect("the default setup");
    let typist = setup.typist("loops", &Hc11Format::default(), 0.0, 0);
    let mut sink =
        ademan::output::open("none", &setup.required_capabilities()).expect("the output `none`");
    let mut pipeline = setup.pipeline();
    let (mut steps, mut at_start, mut at_end) = (0, 0, 0);
    let observe = &mut |_: &ademan::snapshot::StepView| {
        steps += 1;
        match steps {
            // Every queue has allocated its waker by then.
            100 => at_start = allocations(),
            500 => at_end = allocations(),
            _ => {}
        }
    };
    let commands = CommandReceiver::disconnected();
    let source = typist.expect("the text can be typed");
    run_pipeline(source, &mut pipeline, &mut *sink, &commands, observe).expect("a run");
    assert!(steps > 500);
    assert_eq!(at_end - at_start, 0, "in 400 steps");
}

/// Random touches, pinches and rotations of the hand, some with a full event list. After each release all axes are at 0 and
/// no key is pressed.
#[test]
fn handles_do_not_allocate_and_return_to_rest() {
    let text = r#"Layout(name: "t", boards: [(pose: (anchor: world),
        sliders: [(name: "a", at_mm: (0, 0), length_mm: 80, output: Axis("LeftTrigger"))],
        levers: [(name: "b", at_mm: (0, 40), length_mm: 80, springs_back: true, output: Axis("MoveX"))],
        knobs: [(name: "c", at_mm: (0, 90), diameter_mm: 50, output: Axis("TurnZ"))],
        valves: [(name: "d", at_mm: (0, 150), diameter_mm: 50,
            output: Taps(increase: Key("A"), decrease: Key("B"), steps: 30))],
        scroll_rings: [(name: "f", at_mm: (0, 280), diameter_mm: 50, output: ScrollY(24))],
        radial_menus: [(name: "g", at_mm: (0, 350), diameter_mm: 60, sectors: [(name: "h", tap: Key("F"), with: "Control"),
            (name: "i", menu: [(name: "j", tap: Key("G")), (name: "k", tap: Key("H"), with: "Shift Alt")])])],
        joysticks: [(name: "e", at_mm: (0, 210), diameter_mm: 50, travel_mm: 20, axes: ("LeftX", "LeftY"),
            direction_keys: (up: Key("W"), down: Key("S"), left: Key("A"), right: Key("D")),
            push_action: Key("E"), pointer_px_per_s: 500)],
        xy_pads: [(name: "l", at_mm: (0, 430), size_mm: Box(60, 60), springs_back: true, x: (output: Axis("RightX")),
            y: (output: Axis("RightY")))])])"#;
    let layout = Keys::parse(text, "t.ron").expect("a layout");
    let mut devices = layout.devices();
    let mut arbiter = KeyArbiter::default();
    let mut generator = fastrand::Rng::with_seed(1);
    let mut random = move || generator.f32();
    let mut axes = [0.0_f32; Axis::COUNT];
    let (mut pressed, mut sent, mut moved) = (0, 0, 0);

    let before = allocations();
    for index in 0..20_000_u64 {
        let mut pose = HandPose::new(Timestamp(index * 15_000), Side::Right, 0.005);
        let turn = Rotation::from_rotation_y(random() - 0.5);
        pose.set(Joint::Wrist, Pose::from_parts(Vec3::ZERO, turn));
        for (joint, side) in [(Joint::ThumbTip, -0.5), (Joint::IndexTip, 0.5)] {
            let apart = if index % 20 < 10 { 0.01 } else { 0.05 };
            let tip = Vec3::new(apart * side, 0.02, -0.09);
            pose.set(joint, Pose::from_translation(tip));
        }
        let touches: Touches = Finger::ALL
            .iter()
            .map(|&finger| Touch {
                time: pose.time,
                side: Side::Right,
                finger,
                target: TargetId((random() * layout.scene.len() as f32) as u32),
                phase: Phase::ALL[(random() * Phase::COUNT as f32) as usize],
                depth: random(),
                position: Vec2::new(random() - 0.5, random() - 0.5) * 0.1,
            })
            .collect();
        let is_release = index % 50 == 49;
        let mut events = Events::new();
        if index % 7 == 0 && !is_release {
            // Room for releases only.
            let filler = OutputEvent {
                time: pose.time,
                kind: EventKind::Scroll(0, 0),
            };
            events.extend(std::iter::repeat_n(filler, events.capacity() - 2));
        }
        let mut out = DeviceOutput {
            arbiter: &mut arbiter,
            events: &mut events,
            commands: &mut ademan::device::TimedCommands::new(),
        };
        let input = DeviceInput {
            scene: &layout.scene,
            angles: &JointAngles::default(),
            bends: &Default::default(),
            inputs: &Default::default(),
            pose: &pose,
            touches: &touches,
            presses: &[],
        };
        for device in &mut devices {
            device.update(&input, &mut out);
        }
        if is_release {
            out.arbiter.release_all(pose.time, out.events);
            for device in &mut devices {
                device.release_all(pose.time, &mut out);
            }
        }
        for event in &events {
            match event.kind {
                EventKind::KeyDown(_) => pressed += 1,
                EventKind::KeyUp(_) => pressed -= 1,
                EventKind::Axis(axis, value) => {
                    assert!((-1.0..=1.0).contains(&value), "{axis} {value}");
                    moved += usize::from(value != axes[axis.index()]);
                    axes[axis.index()] = value;
                }
                _ => {}
            }
        }
        sent += events.len();
        if is_release {
            assert!(axes.iter().all(|value| *value == 0.0), "{axes:?}");
            assert_eq!(pressed, 0);
        }
    }
    let allocated = allocations() - before;

    assert!(
        sent > 20_000 && moved > 2_000,
        "{sent} events, {moved} of axes"
    );
    assert_eq!(allocated, 0);
}

/// Random fingertips and angles with a pointer that has every option and 1000 targets in space.
#[test]
fn a_pointer_and_targets_in_space_do_not_allocate() {
    let targets: String = (0..1000)
        .map(|number| {
            let (x, y, z) = (number % 10, number / 10 % 10, number / 100);
            let at = format!("({}, {}, {})", x * 20 - 100, y * 20 - 100, z * 20 - 100);
            format!("(name: \"t{number}\", at_mm: {at}, shape: Ball(24), action: Key(\"A\")),")
        })
        .collect();
    let text = format!(
        r#"Layout(name: "t", pointer: Pointer(
            mode: Direct(pose: (anchor: world), size_mm: (200, 200, 200)),
            dead_zone_px: 1, precision: Pinch("ring"), clutch: Flexion("wrist-flexion", 30),
            clicks: [(gesture: Pinch("index"), action: Key("MouseLeft")), (gesture: Push(15), action: Key("B"))],
            scroll: (gesture: Pinch("little"), px_per_detent: 30), z_output: Axis("MoveZ"),
            dwell: (time_ms: 50, radius_px: 400, action: Key("MouseMiddle")),
        ), spaces: [(pose: (anchor: world), targets: [{targets}])])"#
    );
    let layout = Keys::parse(&text, "t.ron").expect("a layout");
    let mut devices = layout.devices();
    let mut arbiter = KeyArbiter::default();
    let mut generator = fastrand::Rng::with_seed(1);
    let mut random = move || generator.f32();
    let mut sent = [0; 4];

    let before = allocations();
    for index in 0..20_000_u64 {
        let mut pose = HandPose::new(Timestamp(index * 5_729), Side::Right, 0.005);
        let mut angles = JointAngles::default();
        angles.set(Dof::WristFlexion, f64::from(random()));
        for &finger in Finger::ALL {
            let tip = Vec3::new(random() - 0.5, random() - 0.5, random() - 0.5) * 0.2;
            pose.set(Joint::tip(finger), Pose::from_translation(tip));
        }
        let input = DeviceInput {
            scene: &layout.scene,
            angles: &angles,
            bends: &Default::default(),
            inputs: &Default::default(),
            pose: &pose,
            touches: &[],
            presses: &[],
        };
        let mut events = Events::new();
        let mut out = DeviceOutput {
            arbiter: &mut arbiter,
            events: &mut events,
            commands: &mut ademan::device::TimedCommands::new(),
        };
        for device in &mut devices {
            match index % 1000 {
                999 => device.release_all(pose.time, &mut out),
                _ => device.update(&input, &mut out),
            }
        }
        for event in &events {
            match event.kind {
                EventKind::MoveTo(..) => sent[0] += 1,
                EventKind::Select(_) => sent[1] += 1,
                EventKind::KeyDown(_) => sent[2] += 1,
                EventKind::Scroll(..) => sent[3] += 1,
                _ => {}
            }
        }
    }
    let allocated = allocations() - before;

    assert!(sent.iter().all(|&count| count > 50), "{sent:?}");
    assert_eq!(allocated, 0);
}

#[test]
fn two_sources_of_a_hand_and_the_loss_of_one_do_not_allocate() {
    let setup = Setup {
        arm_source: Some(
            "udp:127.0.0.1:9000?protocol=markers"
                .parse()
                .expect("a source"),
        ),
        arm_role: Some(SourceRole::Both),
        ..Setup::default()
    };
    let setup = setup.load_files().expect("a setup");
    let mut pipeline = setup.pipeline();
    let (estimates, arm) = typing_estimates("ab");
    let mut readings = Vec::new();
    for (index, estimate) in estimates.iter().enumerate() {
        let mut positions = JointPositions::default();
        let pose = arm.forward(estimate);
        for joint in [Joint::Elbow, Joint::Wrist] {
            let position = pose.position(joint).expect("the model has the joint");
            positions.set(joint, position.as_dvec3());
        }
        let angles = estimate.angles;
        let samples = [Sample::Joints { positions }, Sample::Angles { angles }];
        for (part, sample) in HandPart::ALL.iter().zip(samples) {
            let time = 5_729 * (index as u64 + 1) + part.index() as u64;
            let mut reading = Reading::new(Timestamp(time), Some(Side::Right), sample);
            reading.part = Some(*part);
            readings.push(reading);
        }
    }

    let before = allocations();
    let sent = play(&mut pipeline, &mut readings, 0);
    let mut events = Events::new();
    pipeline.lose(Some(Side::Right), Some(HandPart::Arm), &mut events);
    let lost = pipeline.lost_hands();
    let allocated = allocations() - before;

    assert_eq!(sent, 4, "two keys");
    assert_eq!(lost, [false, true]);
    assert_eq!(allocated, 0);
}
