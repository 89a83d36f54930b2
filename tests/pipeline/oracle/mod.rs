//! The test oracle itself: for each invariant, sequences of steps that keep it and that violate it.

mod states;

use ademan::command::{Command, CommandOrigin};
use ademan::contact::{Phase, TargetId, Touch};
use ademan::device::{
    Axis, Capabilities, Capability, EventKind, KeyCode, OutputEvent, TimedCommand,
};
use ademan::estimate::JointAngles;
use ademan::hand::{Dof, Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::pipeline::PipelineSettings;
use ademan::pipeline::PipelineState;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Vec2, Vec3};

use crate::support::oracle::{
    Cause, Observation, ObservedStep, Oracle, OutputRules, PointerBounds, Violation,
};

/// A pipeline whose steps are written out by the test, 10 ms apart.
struct FakePipeline {
    oracle: Oracle,
    time: u64,
    state: PipelineState,
    paused_by: Option<CommandOrigin>,
    angles: JointAngles,
    touches: Vec<Touch>,
    commands: Vec<TimedCommand>,
    pose: HandPose,
}

fn key(name: &str) -> KeyCode {
    name.parse().unwrap()
}

/// The rules of a layout with two keys, a pointer and two axes.
fn rules() -> OutputRules {
    let capabilities = [
        Capability::Key(key("A")),
        Capability::Key(key("B")),
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
        Capability::Axis(Axis::LeftX),
        Capability::Axis(Axis::LeftTrigger),
    ];
    let pointer = PointerBounds {
        screen: Vec2::new(1000.0, 500.0),
        max_step: 50.0,
    };
    OutputRules::new(capabilities, Some(pointer))
}

/// Settings with which the first reading arms the output.
fn immediate() -> PipelineSettings {
    PipelineSettings {
        arm_immediately: true,
        ..PipelineSettings::default()
    }
}

fn press(name: &str) -> EventKind {
    EventKind::KeyDown(key(name))
}

fn release(name: &str) -> EventKind {
    EventKind::KeyUp(key(name))
}

impl FakePipeline {
    fn new(settings: PipelineSettings) -> Self {
        let time = Timestamp(0);
        Self {
            oracle: Oracle::new([rules(), OutputRules::default()], settings),
            time: 0,
            state: PipelineState::Starting,
            paused_by: None,
            angles: JointAngles::default(),
            touches: Vec::new(),
            commands: Vec::new(),
            pose: HandPose::new(time, Side::Right, 0.005),
        }
    }

    /// Creates a running pipeline.
    fn running() -> Self {
        let mut pipeline = Self::new(immediate());
        pipeline.state = PipelineState::Running;
        pipeline.step(&[]).unwrap();
        pipeline
    }

    fn observe(&mut self, cause: Cause, step: bool, kinds: &[EventKind]) -> Result<(), Violation> {
        let time = Timestamp(self.time);
        let events: Vec<_> = kinds
            .iter()
            .map(|&kind| OutputEvent { time, kind })
            .collect();
        let observed = ObservedStep {
            angles: &self.angles,
            pose: &self.pose,
            touches: &self.touches,
        };
        self.oracle.check(Observation {
            cause,
            state: self.state,
            paused_by: self.paused_by,
            profile: 0,
            output: step.then_some(observed),
            events: &events,
            commands: &self.commands,
        })
    }

    fn step(&mut self, kinds: &[EventKind]) -> Result<(), Violation> {
        self.time += 10_000;
        let time = Timestamp(self.time);
        self.pose.time = time;
        self.observe(Cause::Reading(time), true, kinds)
    }

    fn reject(&mut self, kinds: &[EventKind]) -> Result<(), Violation> {
        self.time += 10_000;
        self.observe(Cause::Reading(Timestamp(self.time)), false, kinds)
    }

    fn release_all(&mut self, state: PipelineState, kinds: &[EventKind]) -> Result<(), Violation> {
        self.state = state;
        self.observe(Cause::ReleaseAll, false, kinds)
    }

    fn touch(&mut self, phase: Phase) {
        self.touches = vec![Touch {
            time: Timestamp(self.time),
            side: Side::Right,
            finger: Finger::Index,
            target: TargetId(3),
            phase,
            depth: 0.5,
            position: Vec2::ZERO,
        }];
    }
}

const FIRST_STEP: Violation = Violation::TouchInFirstStep(Finger::Index, Side::Right, TargetId(3));

#[test]
fn presses_that_are_released_keep_all_invariants() {
    let mut pipeline = FakePipeline::running();
    pipeline
        .step(&[press("A"), EventKind::MoveBy(3, -4)])
        .unwrap();
    pipeline
        .step(&[release("A"), press("B"), press("A")])
        .unwrap();
    pipeline
        .step(&[EventKind::Axis(Axis::LeftX, -0.5)])
        .unwrap();
    assert!(pipeline.oracle.has_pressed());
    let all = [
        release("A"),
        release("B"),
        EventKind::Axis(Axis::LeftX, 0.0),
    ];
    pipeline.release_all(PipelineState::Stalled, &all).unwrap();
    assert!(!pipeline.oracle.has_pressed());
    pipeline.release_all(PipelineState::Stopped, &[]).unwrap();
}

#[test]
fn i1_events_that_the_active_layout_may_not_emit_are_reported() {
    let table = [
        (press("C"), Capability::Key(key("C"))),
        (EventKind::Character('x'), Capability::Text),
        (EventKind::Scroll(0, 120), Capability::Scroll),
        (
            EventKind::Axis(Axis::RightX, 0.5),
            Capability::Axis(Axis::RightX),
        ),
        (press("MouseLeft"), Capability::Key(key("MouseLeft"))),
    ];
    for (kind, capability) in table {
        let result = FakePipeline::running().step(&[kind]);
        assert_eq!(result, Err(Violation::NotAllowed(capability)), "{kind:?}");
    }
    let mut pipeline = FakePipeline::running();
    pipeline.oracle.replace(0, OutputRules::default());
    let result = pipeline.step(&[press("A")]);
    assert_eq!(
        result,
        Err(Violation::NotAllowed(Capability::Key(key("A"))))
    );
}

#[test]
fn i1_a_profile_that_the_setup_does_not_have_is_reported() {
    let mut pipeline = FakePipeline::running();
    pipeline.oracle = Oracle::new([], immediate());
    assert_eq!(pipeline.step(&[]), Err(Violation::NoSuchProfile(0)));
}

#[test]
fn i2_presses_and_releases_alternate() {
    let mut pipeline = FakePipeline::running();
    pipeline.step(&[press("A")]).unwrap();
    let twice = pipeline.fork().step(&[press("A")]);
    assert_eq!(twice, Err(Violation::PressedTwice(key("A"))));
    let unasked = pipeline.step(&[release("A"), release("A")]);
    assert_eq!(unasked, Err(Violation::ReleasedWithoutPress(key("A"))));
}

impl FakePipeline {
    /// Copies the pipeline, so that one beginning serves several ends.
    fn fork(&self) -> Self {
        Self {
            oracle: self.oracle.clone(),
            touches: self.touches.clone(),
            commands: self.commands.clone(),
            ..*self
        }
    }
}

#[test]
fn i2_nothing_stays_pressed_or_off_center_unless_the_pipeline_runs() {
    for state in [
        PipelineState::Paused,
        PipelineState::Stalled,
        PipelineState::Stopped,
    ] {
        let mut pipeline = FakePipeline::running();
        pipeline.step(&[press("A")]).unwrap();
        let result = pipeline.release_all(state, &[]);
        assert_eq!(result, Err(Violation::NotReleased(key("A"), state)));

        let mut deflected = FakePipeline::running();
        deflected
            .step(&[EventKind::Axis(Axis::LeftX, 1.0)])
            .unwrap();
        let axis_result = deflected.release_all(state, &[]);
        assert_eq!(
            axis_result,
            Err(Violation::AxisNotCentered(Axis::LeftX, state))
        );
    }
}

#[test]
fn i2_more_pressed_keys_than_the_oracle_follows_are_reported() {
    let codes: Vec<KeyCode> = KeyCode::all().take(70).collect();
    let capabilities: Capabilities = codes.iter().map(|&key| Capability::Key(key)).collect();
    let settings = PipelineSettings {
        allow_system_keys: true,
        ..PipelineSettings::default()
    };
    let mut oracle = Oracle::new([capabilities.into()], settings);
    let events: Vec<_> = codes
        .iter()
        .map(|&key| OutputEvent {
            time: Timestamp(0),
            kind: EventKind::KeyDown(key),
        })
        .collect();
    let result = oracle.check_devices(&events, false);
    assert_eq!(result, Err(Violation::TooManyPressed(codes[64])));
}

#[test]
fn i3_without_an_accepted_reading_only_releases_are_permitted() {
    let presses = [
        press("A"),
        EventKind::MoveBy(1, 0),
        EventKind::MoveTo(0.5, 0.5),
        EventKind::Axis(Axis::LeftX, 0.1),
        EventKind::Character('x'),
        EventKind::Scroll(1, 0),
        EventKind::Depth(TargetId(0), 0.5),
        EventKind::Select(TargetId(0)),
    ];
    for kind in presses {
        let result = Err(Violation::WithoutReading(kind));
        assert_eq!(FakePipeline::running().reject(&[kind]), result);
        assert_eq!(
            FakePipeline::running().release_all(PipelineState::Running, &[kind]),
            result
        );
    }
    let mut pipeline = FakePipeline::running();
    pipeline.step(&[press("A")]).unwrap();
    pipeline.state = PipelineState::Stalled;
    pipeline.reject(&[release("A")]).unwrap();
}

#[test]
fn i3_a_pose_has_the_time_of_its_reading_and_is_newer_than_the_previous_one() {
    let mut pipeline = FakePipeline::running();
    pipeline.time += 10_000;
    let old = pipeline.observe(Cause::Reading(Timestamp(pipeline.time)), true, &[]);
    assert_eq!(old, Err(Violation::StalePose(Timestamp(10_000))));
    let of_nothing = pipeline.observe(Cause::Other, true, &[]);
    assert_eq!(of_nothing, Err(Violation::StalePose(Timestamp(10_000))));
    let again = pipeline.observe(Cause::Reading(Timestamp(10_000)), true, &[]);
    assert_eq!(again, Err(Violation::PoseNotNewer(Side::Right)));
    pipeline.pose.side = Side::Left;
    pipeline
        .observe(Cause::Reading(Timestamp(10_000)), true, &[])
        .expect("the other hand has times of its own");
}

#[test]
fn i3_joint_angles_are_inside_their_limits_and_positions_are_finite() {
    for radians in [f64::NAN, f64::INFINITY, 2.6, -0.1] {
        let mut pipeline = FakePipeline::running();
        pipeline.angles.set(Dof::ElbowFlexion, radians);
        let result = pipeline.step(&[]).unwrap_err();
        assert!(matches!(
            result,
            Violation::AngleOutOfRange(Dof::ElbowFlexion, _)
        ));
        let is_finite = radians.is_finite();
        let mut without_limits = FakePipeline::running();
        without_limits.oracle = without_limits.oracle.without_limits();
        without_limits.angles.set(Dof::ElbowFlexion, radians);
        assert_eq!(without_limits.step(&[]).is_ok(), is_finite, "{radians}");
    }
    let mut pipeline = FakePipeline::running();
    let not_finite = Pose::from_translation(Vec3::new(0.0, f32::NAN, 0.0));
    pipeline.pose.set(Joint::Wrist, not_finite);
    assert_eq!(
        pipeline.step(&[]),
        Err(Violation::PoseNotFinite(Joint::Wrist))
    );
}

#[test]
fn i1_no_system_chord_is_down_without_permission() {
    let chord = ["Delete", "ControlRight", "AltLeft"].map(key);
    let rules = || OutputRules::new(chord.map(Capability::Key), None);
    let presses = chord.map(EventKind::KeyDown);
    for allow_system_keys in [false, true] {
        let settings = PipelineSettings {
            allow_system_keys,
            ..immediate()
        };
        let mut pipeline = FakePipeline::new(settings);
        pipeline.oracle = Oracle::new([rules()], settings);
        pipeline.state = PipelineState::Running;
        pipeline.step(&presses[..2]).unwrap();
        let completed = pipeline.step(&presses[2..]);
        let expected = if allow_system_keys {
            Ok(())
        } else {
            Err(Violation::SystemChord(chord[2]))
        };
        assert_eq!(completed, expected);
    }
}

#[test]
fn i4_releases_precede_presses() {
    let mut pipeline = FakePipeline::running();
    pipeline.step(&[press("A")]).unwrap();
    let late = pipeline.fork().step(&[press("B"), release("A")]);
    assert_eq!(late, Err(Violation::LateRelease(key("A"))));
    pipeline.step(&[press("B"), release("B")]).unwrap();
    pipeline.commands = vec![TimedCommand {
        time: Timestamp(pipeline.time),
        command: Command::TogglePause,
    }];
    (pipeline.state, pipeline.paused_by) = (PipelineState::Paused, Some(CommandOrigin::Layout));
    pipeline
        .step(&[press("B"), release("B"), release("A")])
        .expect("a pause releases what was pressed before it");
}

#[test]
fn i4_releasing_everything_while_running_leaves_nothing_pressed() {
    let mut pipeline = FakePipeline::running();
    pipeline.step(&[press("A"), press("B")]).unwrap();
    let result = pipeline.release_all(PipelineState::Running, &[release("A")]);
    let expected = Violation::NotReleased(key("B"), PipelineState::Running);
    assert_eq!(result, Err(expected));
}

#[test]
fn i5_values_out_of_range_are_reported() {
    let wrong = [
        EventKind::MoveTo(1.001, 0.5),
        EventKind::MoveTo(0.5, -0.001),
        EventKind::MoveTo(f32::NAN, 0.5),
        EventKind::Axis(Axis::LeftX, 1.5),
        EventKind::Axis(Axis::LeftX, f32::NAN),
        EventKind::Axis(Axis::LeftTrigger, -0.5),
        EventKind::Depth(TargetId(0), 1.5),
        EventKind::Value(TargetId(0), f32::INFINITY),
    ];
    for kind in wrong {
        // NaN is not equal to itself.
        let result = FakePipeline::running().step(&[kind]).unwrap_err();
        assert!(matches!(result, Violation::OutOfRange(_)), "{result}");
    }
    let right = [
        EventKind::MoveTo(1.0, 0.0),
        EventKind::Axis(Axis::LeftTrigger, 1.0),
        EventKind::Value(TargetId(0), -7.5),
    ];
    FakePipeline::running().step(&right).unwrap();
}

#[test]
fn i5_the_pointer_moves_at_most_its_maximum_distance_per_step() {
    let mut pipeline = FakePipeline::running();
    let steps = [EventKind::MoveBy(30, 0), EventKind::MoveBy(30, 0)];
    assert_eq!(
        pipeline.step(&steps),
        Err(Violation::PointerTooFast(60.0, 50.0))
    );
    pipeline.step(&[EventKind::MoveBy(-40, 30)]).unwrap();

    let mut placed = FakePipeline::running();
    placed.step(&[EventKind::MoveTo(0.9, 0.9)]).unwrap();
    placed.step(&[EventKind::MoveTo(0.9, 0.8)]).unwrap();
    let result = placed.fork().step(&[EventKind::MoveTo(0.8, 0.8)]);
    assert!(
        matches!(result, Err(Violation::PointerTooFast(..))),
        "{result:?}"
    );
    placed.oracle.replace(0, rules());
    let anywhere = placed.step(&[EventKind::MoveTo(0.1, 0.1)]);
    anywhere.expect("a new pointer begins anywhere");
}

#[test]
fn i5_times_of_events_do_not_go_back() {
    let mut pipeline = FakePipeline::running();
    pipeline.step(&[press("A")]).unwrap();
    pipeline.time -= 1;
    let result = pipeline.observe(Cause::Other, false, &[release("A")]);
    assert_eq!(result, Err(Violation::EventTimeWentBack(release("A"))));
}

#[test]
fn every_violation_names_its_invariant() {
    let text = FIRST_STEP.to_string();
    assert!(
        text.starts_with("I6: the index finger of the right hand"),
        "{text}"
    );
    let twice = Violation::PressedTwice(key("A")).to_string();
    assert_eq!(twice, "I2: `A` was pressed twice");
}
