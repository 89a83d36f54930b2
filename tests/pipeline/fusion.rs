//! A hand whose arm and fingers are measured by two sources, and the loss of one of them.

use ademan::capture::{Reading, Sample, SourceUri};
use ademan::device::{EventKind, Events};
use ademan::estimate::{Estimate, JointAngles};
use ademan::hand::{Dof, HandPart, Joint, JointPositions, Side};
use ademan::kinematics::HandPose;
use ademan::pipeline::{PipelineState, SourceRole};
use ademan::setup::{OtherHand, Setup};
use ademan::time::Timestamp;

use crate::support::checked::CheckedPipeline;
use crate::support::source::typing_estimates;

/// A wearer of a glove without arm sensors, whose elbow and wrist a tracker sees.
struct Wearer {
    pipeline: CheckedPipeline,
    postures: Vec<(Estimate, HandPose)>,
    /// The index of the next posture.
    next: usize,
    time_us: u64,
    /// `true` if the tracker sends that it does not see the arm.
    is_arm_hidden: bool,
    transcript: Vec<String>,
}

impl Wearer {
    fn new(layout: &str, text: &str) -> Self {
        Self::with_arm_role(layout, text, Some(SourceRole::Both))
    }

    fn with_arm_role(layout: &str, text: &str, arm_role: Option<SourceRole>) -> Self {
        let setup = Setup {
            arm_source: Some(
                "udp:127.0.0.1:9000?protocol=markers"
                    .parse()
                    .expect("a source"),
            ),
            arm_role,
            layout: layout.into(),
            ..Setup::default()
        };
        let (estimates, arm) = typing_estimates(text);
        let postures = estimates
            .iter()
            .map(|estimate| (*estimate, arm.forward(estimate)));
        Self {
            pipeline: CheckedPipeline::new(&setup.load_files().expect("a setup")),
            postures: postures.collect(),
            next: 0,
            time_us: 0,
            is_arm_hidden: false,
            transcript: Vec::new(),
        }
    }

    /// Plays postures until all are played or a key is pressed.
    fn play_until_press(&mut self) {
        let before = self.transcript.len();
        while self.next < self.postures.len() && self.transcript.len() == before {
            self.show([true, true]);
            self.next += 1;
        }
    }

    fn play(&mut self) {
        while self.next < self.postures.len() {
            self.play_until_press();
        }
    }

    /// Holds the present posture, which only the parts `seen` show.
    fn hold(&mut self, seen: [bool; HandPart::COUNT], milliseconds: u64) {
        for _ in 0..milliseconds / 5 {
            self.show(seen);
        }
    }

    fn show(&mut self, seen: [bool; HandPart::COUNT]) {
        self.time_us += 5_000;
        let (estimate, pose) = self.postures[self.next.min(self.postures.len() - 1)];
        let arm = if self.is_arm_hidden {
            let positions = JointPositions::default();
            Sample::Joints { positions }
        } else {
            arm_sample(&pose)
        };
        let samples = [arm, finger_sample(&estimate)];
        for (index, sample) in samples.into_iter().enumerate() {
            if seen[index] {
                let time = Timestamp(self.time_us + index as u64);
                let mut reading = Reading::new(time, Some(Side::Right), sample);
                reading.part = Some(HandPart::ALL[index]);
                self.step(&reading);
            }
        }
    }

    fn step(&mut self, reading: &Reading) {
        let mut events = Events::new();
        self.pipeline
            .step(reading, &mut events)
            .expect("a valid reading");
        self.write(&events);
    }

    fn write(&mut self, events: &Events) {
        for event in events {
            match event.kind {
                EventKind::KeyDown(key) => self.transcript.push(format!("+{key}")),
                EventKind::KeyUp(key) => self.transcript.push(format!("-{key}")),
                EventKind::MoveTo(..) | EventKind::MoveBy(..) => {
                    self.transcript.push("move".into());
                }
                _ => {}
            }
        }
    }

    fn transcript(&mut self) -> String {
        std::mem::take(&mut self.transcript).join(" ")
    }
}

fn arm_sample(pose: &HandPose) -> Sample {
    let mut positions = JointPositions::default();
    for joint in [Joint::Elbow, Joint::Wrist] {
        let position = pose.position(joint).expect("the model has the joint");
        positions.set(joint, position.as_dvec3());
    }
    Sample::Joints { positions }
}

fn finger_sample(estimate: &Estimate) -> Sample {
    let mut angles = JointAngles::default();
    for (dof, radians) in estimate.angles.known() {
        if dof != Dof::ElbowFlexion {
            angles.set(dof, radians);
        }
    }
    Sample::Angles { angles }
}

#[test]
fn a_glove_and_a_tracker_of_the_arm_type_together() {
    let mut wearer = Wearer::new("qwerty-flat", "hola");
    wearer.play();
    assert_eq!(wearer.transcript(), "+H -H +O -O +L -L +A -A");
}

#[test]
fn a_lost_arm_releases_its_key_and_the_hand_must_leave_the_key_first() {
    let mut wearer = Wearer::new("qwerty-flat", "h");
    wearer.play_until_press();
    assert_eq!(wearer.transcript(), "+H");
    wearer.hold([false, true], 150);
    assert_eq!(wearer.transcript(), "", "a short gap of the tracker");
    wearer.hold([false, true], 100);
    assert_eq!(wearer.transcript(), "-H");
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.hold([true, true], 500);
    assert_eq!(wearer.transcript(), "", "the finger is still in the key");
    wearer.play();
    assert_eq!(wearer.transcript(), "");
    wearer.next = 0;
    wearer.play();
    assert_eq!(wearer.transcript(), "+H -H");
}

#[test]
fn a_hand_that_types_while_its_arm_sends_nothing_presses_no_other_keys() {
    // 160 ms: less than the stall timeout.
    const MISSING: usize = 32;
    const KEYS: [&str; 3] = ["+H", "+E", "+L"];
    let count = Wearer::new("qwerty-flat", "hel").postures.len();
    let mut missed = 0;
    for start in (120..count - MISSING).step_by(8) {
        let mut wearer = Wearer::new("qwerty-flat", "hel");
        while wearer.next < count {
            let is_seen = !(start..start + MISSING).contains(&wearer.next);
            wearer.show([is_seen, true]);
            wearer.next += 1;
        }
        let typed = wearer.transcript();
        let presses: Vec<&str> = typed.split(' ').filter(|it| it.starts_with('+')).collect();
        let mut keys = KEYS.into_iter();
        let is_part = presses.iter().all(|press| keys.any(|key| key == *press));
        assert!(is_part, "from posture {start}: {typed}");
        missed += KEYS.len() - presses.len();
    }
    assert!(missed > 0, "no gap hides a tap");
}

#[test]
fn an_arm_that_its_tracker_does_not_see_releases_its_key_although_readings_arrive() {
    let mut wearer = Wearer::new("qwerty-flat", "h");
    wearer.play_until_press();
    assert_eq!(wearer.transcript(), "+H");
    wearer.is_arm_hidden = true;
    wearer.hold([true, true], 90);
    assert_eq!(wearer.transcript(), "", "it is held for a moment");
    wearer.hold([true, true], 50);
    assert_eq!(wearer.transcript(), "-H");
    wearer.hold([true, true], 1000);
    wearer.is_arm_hidden = false;
    wearer.hold([true, true], 500);
    assert_eq!(wearer.transcript(), "", "the finger is still in the key");
    wearer.play();
    assert_eq!(wearer.transcript(), "");
    wearer.next = 0;
    wearer.play();
    assert_eq!(wearer.transcript(), "+H -H");
}

#[test]
fn lost_fingers_release_their_key_and_the_arm_still_points() {
    let mut wearer = Wearer::new("qwerty-flat", "h");
    wearer.play_until_press();
    wearer.hold([true, false], 250);
    assert_eq!(wearer.transcript(), "+H -H");
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);

    let mut joint_wearer = Wearer::new("joint", "h");
    joint_wearer.hold([true, true], 500);
    joint_wearer.hold([true, false], 300);
    assert_eq!(joint_wearer.transcript(), "");
    for step in 0..50 {
        joint_wearer.time_us += 5_000;
        let mut angles = JointAngles::default();
        angles.set(Dof::ElbowFlexion, 0.8);
        angles.set(Dof::WristFlexion, 0.0);
        angles.set(Dof::WristDeviation, f64::from(step) * 0.004);
        let time = Timestamp(joint_wearer.time_us);
        let mut reading = Reading::new(time, Some(Side::Right), Sample::Angles { angles });
        reading.part = Some(HandPart::Arm);
        joint_wearer.step(&reading);
    }
    assert!(
        joint_wearer.transcript().contains("move"),
        "the wrist points"
    );
}

#[test]
fn the_loss_of_a_source_releases_at_once_and_the_loss_of_both_stalls() {
    let mut wearer = Wearer::new("qwerty-flat", "h");
    wearer.play_until_press();
    let mut events = Events::new();
    let (side, part) = (Some(Side::Right), Some(HandPart::Arm));
    wearer.pipeline.lose(side, part, &mut events);
    wearer.write(&events);
    assert_eq!(wearer.transcript(), "+H -H");
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    events.clear();
    wearer
        .pipeline
        .lose(side, Some(HandPart::Fingers), &mut events);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    assert!(!wearer.pipeline.expects_readings());
}

#[test]
fn a_hand_does_only_what_both_of_its_sources_may() {
    let roles = |setup: Setup| {
        let setup = setup.load_files()?;
        let roles = setup.sources().map(|(_, permissions)| permissions.role);
        Ok::<_, ademan::setup::SetupError>(roles.collect::<Vec<_>>())
    };
    let camera = Setup {
        source: Some("serial:/dev/x".parse().expect("a source")),
        arm_source: Some(
            "tcp:camera:4001?protocol=body-landmarks"
                .parse()
                .expect("a source"),
        ),
        ..Setup::default()
    };
    assert_eq!(
        roles(camera.clone()).expect("a setup"),
        [SourceRole::Pointer]
    );
    let trusted = Setup {
        arm_role: Some(SourceRole::Both),
        ..camera.clone()
    };
    assert_eq!(roles(trusted).expect("a setup"), [SourceRole::Both]);
    let nothing = Setup {
        role: Some(SourceRole::Keys),
        ..camera
    };
    let error = roles(nothing).expect_err("roles that exclude each other");
    assert!(
        error.to_string().contains("set `arm_role: Keys`"),
        "{error}"
    );
}

#[test]
fn a_hand_whose_arm_is_on_the_network_types_only_if_its_arm_may() {
    for (arm_role, expected) in [(None, ""), (Some(SourceRole::Both), "+H -H")] {
        let mut wearer = Wearer::with_arm_role("qwerty-flat", "h", arm_role);
        wearer.play();
        assert_eq!(wearer.transcript(), expected, "{arm_role:?}");
        let is_suppressed = wearer.pipeline.suppressed().keys_by_role > 0;
        assert_eq!(is_suppressed, expected.is_empty(), "{arm_role:?}");
    }
}

#[test]
fn the_roles_of_one_hand_do_not_limit_the_other_hand() {
    let uri = |text: &str| Some(text.parse::<SourceUri>().expect("a source"));
    let right_types_and_left_points = Setup {
        source: uri("serial:/dev/right"),
        role: Some(SourceRole::Keys),
        other_hand: Some(OtherHand {
            source: uri("serial:/dev/left"),
            role: Some(SourceRole::Pointer),
            arm_source: uri("udp:127.0.0.1:9000?protocol=markers"),
            ..OtherHand::default()
        }),
        ..Setup::default()
    };
    let setup = right_types_and_left_points.load_files().expect("a setup");
    let roles: Vec<_> = setup.sources().map(|(_, source)| source.role).collect();
    assert_eq!(roles, [SourceRole::Keys, SourceRole::Pointer]);
    let mut nothing = setup.setup.clone();
    nothing.other_hand.as_mut().expect("a hand").role = Some(SourceRole::Keys);
    let error = nothing
        .load_files()
        .expect_err("an arm that may only point");
    assert!(error.to_string().contains("permit nothing"), "{error}");
}
