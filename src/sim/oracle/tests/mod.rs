//! For every invariant, streams that keep it and streams that break it.

mod states;

use super::*;
use crate::contact::{Phase, TargetId};
use crate::device::{Axis, Capability, KeyCode};
use crate::hand::{Dof, Finger, Joint};
use parry3d::math::{Pose, Vec3};

/// An engine played by hand, 10 ms a frame.
struct Engine {
    oracle: Oracle,
    time: u64,
    state: PipelineState,
    is_paused: bool,
    angles: JointAngles,
    touches: Vec<Touch>,
    pose: HandPose,
}

fn code(name: &str) -> KeyCode {
    name.parse().unwrap()
}

/// A layout with two keys, a pointer, a wheel and two axes.
fn rules() -> OutputRules {
    let needs = [
        Capability::Key(code("A")),
        Capability::Key(code("B")),
        Capability::RelativeMotion,
        Capability::AbsoluteMotion,
        Capability::Axis(Axis::LeftX),
        Capability::Axis(Axis::LeftTrigger),
    ];
    OutputRules {
        needs: needs.into_iter().collect(),
        pointer: Some(PointerBounds {
            screen: Vec2::new(1000.0, 500.0),
            max_step: 50.0,
        }),
    }
}

fn down(name: &str) -> EventKind {
    EventKind::KeyDown(code(name))
}

fn up(name: &str) -> EventKind {
    EventKind::KeyUp(code(name))
}

impl Engine {
    fn new(arming: PipelineSettings) -> Self {
        let time = Timestamp(0);
        Self {
            oracle: Oracle::new([rules(), OutputRules::default()], arming),
            time: 0,
            state: PipelineState::Starting,
            is_paused: false,
            angles: JointAngles::new(time),
            touches: Vec::new(),
            pose: HandPose::new(time, Side::Right, 0.005),
        }
    }

    /// One that runs.
    fn running() -> Self {
        let mut engine = Self::new(PipelineSettings {
            arm_immediately: true,
            ..PipelineSettings::default()
        });
        engine.state = PipelineState::Running;
        engine.frame(&[]).unwrap();
        engine
    }

    fn see(&mut self, cause: Cause, frame: bool, actions: &[EventKind]) -> Result<(), Violation> {
        let time = Timestamp(self.time);
        let events: Vec<_> = actions
            .iter()
            .map(|&action| OutputEvent { time, kind: action })
            .collect();
        let seen = ObservedStep {
            angles: &self.angles,
            pose: &self.pose,
            touches: &self.touches,
        };
        self.oracle.check(Observation {
            cause,
            state: self.state,
            is_paused: self.is_paused,
            profile: 0,
            output: frame.then_some(seen),
            events: &events,
        })
    }

    fn frame(&mut self, actions: &[EventKind]) -> Result<(), Violation> {
        self.time += 10_000;
        let time = Timestamp(self.time);
        (self.angles.time, self.pose.time) = (time, time);
        self.see(Cause::Reading(time), true, actions)
    }

    fn rejected(&mut self, actions: &[EventKind]) -> Result<(), Violation> {
        self.time += 10_000;
        self.see(Cause::Reading(Timestamp(self.time)), false, actions)
    }

    fn let_go(&mut self, state: PipelineState, actions: &[EventKind]) -> Result<(), Violation> {
        self.state = state;
        self.see(Cause::ReleaseAll, false, actions)
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

const NOT_SEEN: Violation = Violation::TouchInFirstStep(Finger::Index, Side::Right, TargetId(3));

#[test]
fn presses_that_come_up_again_before_everything_is_let_go_of_keep_all_invariants() {
    let mut engine = Engine::running();
    engine
        .frame(&[down("A"), EventKind::MoveBy(3, -4)])
        .unwrap();
    engine.frame(&[up("A"), down("B"), down("A")]).unwrap();
    engine.frame(&[EventKind::Axis(Axis::LeftX, -0.5)]).unwrap();
    assert!(engine.oracle.has_pressed());
    let all = [up("A"), up("B"), EventKind::Axis(Axis::LeftX, 0.0)];
    engine.let_go(PipelineState::Stalled, &all).unwrap();
    assert!(!engine.oracle.has_pressed());
    engine.let_go(PipelineState::Stopped, &[]).unwrap();
}

#[test]
fn i1_what_the_layout_in_force_may_not_send_is_told() {
    let table = [
        (down("C"), Capability::Key(code("C"))),
        (EventKind::Character('x'), Capability::Text),
        (EventKind::Scroll(0, 120), Capability::Scroll),
        (
            EventKind::Axis(Axis::RightX, 0.5),
            Capability::Axis(Axis::RightX),
        ),
        (down("MouseLeft"), Capability::Key(code("MouseLeft"))),
    ];
    for (action, need) in table {
        let told = Engine::running().frame(&[action]);
        assert_eq!(told, Err(Violation::NotAllowed(need)), "{action:?}");
    }
    let mut engine = Engine::running();
    engine.oracle.replace(0, OutputRules::default());
    let told = engine.frame(&[down("A")]);
    assert_eq!(told, Err(Violation::NotAllowed(Capability::Key(code("A")))));
}

#[test]
fn i1_a_layout_that_the_setup_has_not_is_told() {
    let mut engine = Engine::running();
    engine.oracle.rules.clear();
    assert_eq!(engine.frame(&[]), Err(Violation::NoSuchProfile(0)));
}

#[test]
fn i2_downs_and_ups_take_turns() {
    let mut engine = Engine::running();
    engine.frame(&[down("A")]).unwrap();
    let twice = engine.clone_oracle().frame(&[down("A")]);
    assert_eq!(twice, Err(Violation::PressedTwice(code("A"))));
    let unasked = engine.frame(&[up("A"), up("A")]);
    assert_eq!(unasked, Err(Violation::ReleasedWithoutPress(code("A"))));
}

impl Engine {
    /// The same again, so that one beginning serves several ends.
    fn clone_oracle(&self) -> Self {
        Self {
            oracle: self.oracle.clone(),
            touches: self.touches.clone(),
            ..*self
        }
    }
}

#[test]
fn i2_nothing_stays_down_or_off_its_rest_but_while_it_runs() {
    for state in [
        PipelineState::Paused,
        PipelineState::Stalled,
        PipelineState::Stopped,
    ] {
        let mut engine = Engine::running();
        engine.frame(&[down("A")]).unwrap();
        let told = engine.let_go(state, &[]);
        assert_eq!(told, Err(Violation::NotReleased(code("A"), state)));

        let mut engine = Engine::running();
        engine.frame(&[EventKind::Axis(Axis::LeftX, 1.0)]).unwrap();
        let told = engine.let_go(state, &[]);
        assert_eq!(told, Err(Violation::AxisNotCentered(Axis::LeftX, state)));
    }
}

#[test]
fn i2_more_codes_than_can_be_held_are_told() {
    let codes: Vec<KeyCode> = KeyCode::all().take(70).collect();
    let needs: Capabilities = codes.iter().map(|&code| Capability::Key(code)).collect();
    let mut oracle = Oracle::new([needs.into()], PipelineSettings::default());
    let events: Vec<_> = codes
        .iter()
        .map(|&code| OutputEvent {
            time: Timestamp(0),
            kind: EventKind::KeyDown(code),
        })
        .collect();
    let told = oracle.check_devices(&events, false);
    assert_eq!(told, Err(Violation::TooManyPressed(codes[64])));
}

#[test]
fn i3_nothing_but_letting_go_happens_without_an_accepted_frame() {
    let presses = [
        down("A"),
        EventKind::MoveBy(1, 0),
        EventKind::MoveTo(0.5, 0.5),
        EventKind::Axis(Axis::LeftX, 0.1),
        EventKind::Character('x'),
        EventKind::Scroll(1, 0),
        EventKind::Depth(TargetId(0), 0.5),
        EventKind::Select(TargetId(0)),
        EventKind::Ask(Request::Pause),
    ];
    for action in presses {
        let told = Err(Violation::WithoutReading(action));
        assert_eq!(Engine::running().rejected(&[action]), told);
        assert_eq!(
            Engine::running().let_go(PipelineState::Running, &[action]),
            told
        );
    }
    let mut engine = Engine::running();
    engine.frame(&[down("A")]).unwrap();
    engine.state = PipelineState::Stalled;
    engine.rejected(&[up("A")]).unwrap();
}

#[test]
fn i3_a_frame_is_of_the_moment_of_its_reading_and_later_than_the_one_before() {
    let mut engine = Engine::running();
    engine.time += 10_000;
    let old = engine.see(Cause::Reading(Timestamp(engine.time)), true, &[]);
    assert_eq!(old, Err(Violation::StalePose(Timestamp(10_000))));
    let of_nothing = engine.see(Cause::Other, true, &[]);
    assert_eq!(of_nothing, Err(Violation::StalePose(Timestamp(10_000))));
    let again = engine.see(Cause::Reading(Timestamp(10_000)), true, &[]);
    assert_eq!(again, Err(Violation::PoseNotNewer(Side::Right)));
    engine.pose.side = Side::Left;
    engine
        .see(Cause::Reading(Timestamp(10_000)), true, &[])
        .expect("the other hand has times of its own");
}

#[test]
fn i3_a_joint_is_within_its_range_and_every_place_a_number() {
    for radians in [f64::NAN, f64::INFINITY, 2.6, -0.1] {
        let mut engine = Engine::running();
        engine.angles.set(Dof::ElbowFlexion, radians);
        let told = engine.frame(&[]).unwrap_err();
        assert!(matches!(
            told,
            Violation::AngleOutOfRange(Dof::ElbowFlexion, _)
        ));
        let is_finite = radians.is_finite();
        let mut lenient = Engine::running();
        lenient.oracle = lenient.oracle.without_limits();
        lenient.angles.set(Dof::ElbowFlexion, radians);
        assert_eq!(lenient.frame(&[]).is_ok(), is_finite, "{radians}");
    }
    let mut engine = Engine::running();
    let nowhere = Pose::from_translation(Vec3::new(0.0, f32::NAN, 0.0));
    engine.pose.set(Joint::Wrist, nowhere);
    assert_eq!(
        engine.frame(&[]),
        Err(Violation::PoseNotFinite(Joint::Wrist))
    );
}

#[test]
fn i4_what_was_down_comes_up_before_anything_goes_down() {
    let mut engine = Engine::running();
    engine.frame(&[down("A")]).unwrap();
    let late = engine.clone_oracle().frame(&[down("B"), up("A")]);
    assert_eq!(late, Err(Violation::LateRelease(code("A"))));
    engine.frame(&[down("B"), up("B")]).unwrap();
    let pause = EventKind::Ask(Request::Pause);
    (engine.state, engine.is_paused) = (PipelineState::Paused, true);
    engine
        .frame(&[down("B"), pause, up("B"), up("A")])
        .expect("a pause lets go of what was pressed before it too");
}

#[test]
fn i4_letting_go_while_it_runs_leaves_nothing_down() {
    let mut engine = Engine::running();
    engine.frame(&[down("A"), down("B")]).unwrap();
    let told = engine.let_go(PipelineState::Running, &[up("A")]);
    let expected = Violation::NotReleased(code("B"), PipelineState::Running);
    assert_eq!(told, Err(expected));
}

#[test]
fn i5_numbers_out_of_their_range_are_told() {
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
    for action in wrong {
        // NaN is not equal to itself.
        let told = Engine::running().frame(&[action]).unwrap_err();
        assert!(matches!(told, Violation::OutOfRange(_)), "{told}");
    }
    let right = [
        EventKind::MoveTo(1.0, 0.0),
        EventKind::Axis(Axis::LeftTrigger, 1.0),
        EventKind::Value(TargetId(0), -7.5),
    ];
    Engine::running().frame(&right).unwrap();
}

#[test]
fn i5_the_pointer_goes_no_further_in_a_frame_than_it_may() {
    let mut engine = Engine::running();
    let steps = [EventKind::MoveBy(30, 0), EventKind::MoveBy(30, 0)];
    assert_eq!(
        engine.frame(&steps),
        Err(Violation::PointerTooFast(60.0, 50.0))
    );
    engine.frame(&[EventKind::MoveBy(-40, 30)]).unwrap();

    let mut engine = Engine::running();
    engine.frame(&[EventKind::MoveTo(0.9, 0.9)]).unwrap();
    engine.frame(&[EventKind::MoveTo(0.9, 0.8)]).unwrap();
    let told = engine.clone_oracle().frame(&[EventKind::MoveTo(0.8, 0.8)]);
    assert!(
        matches!(told, Err(Violation::PointerTooFast(..))),
        "{told:?}"
    );
    engine.oracle.replace(0, rules());
    let anywhere = engine.frame(&[EventKind::MoveTo(0.1, 0.1)]);
    anywhere.expect("a new pointer begins anywhere");
}

#[test]
fn i5_times_of_events_do_not_go_back() {
    let mut engine = Engine::running();
    engine.frame(&[down("A")]).unwrap();
    engine.time -= 1;
    let told = engine.see(Cause::Other, false, &[up("A")]);
    assert_eq!(told, Err(Violation::EventTimeWentBack(up("A"))));
}

#[test]
fn every_violation_names_its_invariant() {
    let text = NOT_SEEN.to_string();
    assert!(
        text.starts_with("I6: the index finger of the right hand"),
        "{text}"
    );
    let text = Violation::PressedTwice(code("A")).to_string();
    assert_eq!(text, "I2: `A` went down twice");
}
