//! Stops caused by the hand: a gesture that pauses, and an arm that is no longer measured.

use crate::key_reach::KeyReach;
use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;
use crate::wearer::channels;
use ademan::capture::{Channels, Reading, Sample};
use ademan::command::Command;
use ademan::device::{EventKind, Events, OutputEvent};
use ademan::document::Document;
use ademan::estimate::{ChannelMap, JointAngles, Rejection};
use ademan::hand::{Dof, Side};
use ademan::kinematics::ArmModel;
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, OtherHand, Setup, SmoothingSetup};
use ademan::sim::TypingHand;
use ademan::time::Timestamp;

/// A trigger that toggles the pause when the left ring finger bends. At rest it is straight.
const GESTURE: &str = "triggers: [(name: \"Stop\", hand: \"left\", action: Command(\"toggle-pause\"), \
                       when: Angle(dof: \"ring-mcp-flexion\", on_deg: -5, off_deg: -15))],";

/// Flexion of the bent ring finger, in radians.
const BENT_RAD: f64 = 0.6;

/// Duration of bending the finger, in readings of 1 ms.
const BENDING_READINGS: u64 = 60;

/// Two hands above a split board, with a reading of each per millisecond.
struct TwoHands {
    setup: LoadedSetup,
    pipeline: CheckedPipeline,
    /// Angles of each hand above its key and pressing it, by side.
    angles: Vec<(JointAngles, JointAngles)>,
    milliseconds: u64,
    /// The right hand presses J.
    is_down: bool,
    /// Flexion of the left ring finger, in radians.
    bent: f64,
    /// Number of events in the list before each step.
    queued_events: usize,
    /// Commands of the devices since the last check.
    commands: Vec<Command>,
    /// Events since the last call of [`Self::take_events`].
    out: Vec<EventKind>,
}

/// Returns the arm and the channel map of a side.
fn arm_and_map(setup: &LoadedSetup, side: Side) -> (&ArmModel, &ChannelMap) {
    let other = setup.other_hand.as_ref().expect("two hands");
    match side {
        Side::Left => (&other.arm, &other.glove.as_ref().expect("a glove").map),
        Side::Right => (&setup.arm, &setup.glove.as_ref().expect("a glove").map),
    }
}

/// Returns the angles of a hand above F (left) or J (right), and pressing it fully.
fn tap_angles(setup: &LoadedSetup, side: Side) -> (JointAngles, JointAngles) {
    let (arm, map) = arm_and_map(setup, side);
    let layout = &setup.layout;
    let key = if side == Side::Left { "F" } else { "J" };
    let target = layout.key(key).expect("a key").face.target;
    let hand = TypingHand::new(arm, map);
    let reach = KeyReach::new(&hand, &layout.scene, target).expect("a place");
    let angles = |tip| {
        let mut values = hand.rest_values();
        hand.reach(tip, &mut values, &[]);
        hand.angles(&values)
    };
    (angles(reach.hover()), angles(reach.bottom()))
}

impl TwoHands {
    /// Creates armed hands at rest.
    fn new() -> Self {
        let board = Document::shipped("qwerty-two-flat").expect("it is shipped");
        let with_gesture = format!("{GESTURE}\n    boards: [\n");
        let board = board.text.replacen("boards: [\n", &with_gesture, 1);
        let setup = Setup {
            other_hand: Some(OtherHand::default()),
            smoothing: SmoothingSetup::Off,
            ..Setup::default()
        };
        let setup = load_layout(&board, setup);
        let mut hands = Self {
            pipeline: CheckedPipeline::new(&setup),
            angles: Side::ALL
                .iter()
                .map(|&side| tap_angles(&setup, side))
                .collect(),
            setup,
            milliseconds: 0,
            is_down: false,
            bent: 0.0,
            queued_events: 0,
            commands: Vec::new(),
            out: Vec::new(),
        };
        hands.hold_still(400);
        assert_eq!(hands.pipeline.state(), PipelineState::Running);
        hands
    }

    /// Returns the channels of a glove in the current posture.
    fn posture(&self, side: Side) -> Channels {
        let is_down = self.is_down && side == Side::Right;
        let (hover, pressed) = &self.angles[side.index()];
        let angles = if is_down { pressed } else { hover };
        let bent = if side == Side::Left { self.bent } else { 0.0 };
        let (_, map) = arm_and_map(&self.setup, side);
        channels(map, |dof| match dof {
            Dof::RingMcpFlexion => angles.get(dof) + bent,
            _ => angles.get(dof),
        })
    }

    /// Steps the pipeline with a reading of one hand. Returns its events and the rejection, if any.
    fn step(&mut self, side: Side, channels: &Channels) -> (Vec<EventKind>, Option<Rejection>) {
        let reading = Reading::new(
            Timestamp(self.milliseconds * 1_000),
            Some(side),
            Sample::Channels(channels.clone()),
        );
        let other = OutputEvent {
            time: reading.time,
            kind: EventKind::MoveBy(0, 0),
        };
        let mut events: Events = std::iter::repeat_n(other, self.queued_events).collect();
        let step = self.pipeline.step(&reading, &mut events);
        let rejection = step.map(|step| {
            let commands = step.commands.iter().map(|issued| issued.command);
            self.commands.extend(commands);
        });
        let rejection = rejection.err();
        let new = events.iter().skip(self.queued_events);
        let out: Vec<EventKind> = new.map(|event| event.kind).collect();
        self.out.extend(&out);
        (out, rejection)
    }

    /// Holds both hands still.
    fn hold_still(&mut self, milliseconds: u64) {
        let postures = [Side::Left, Side::Right].map(|side| (side, self.posture(side)));
        for _ in 0..milliseconds {
            self.milliseconds += 1;
            for (side, posture) in &postures {
                let (_, rejection) = self.step(*side, posture);
                assert_eq!(rejection, None);
            }
        }
    }

    fn press_j(&mut self, is_down: bool) {
        self.is_down = is_down;
        self.hold_still(100);
    }

    /// Bends or straightens the ring finger. Returns the events of each step that emits any.
    fn bend(&mut self, is_bent: bool) -> Vec<Vec<EventKind>> {
        let mut steps = Vec::new();
        let right = self.posture(Side::Right);
        for number in 1..=BENDING_READINGS {
            self.milliseconds += 1;
            let fraction = number as f64 / BENDING_READINGS as f64;
            self.bent = BENT_RAD * if is_bent { fraction } else { 1.0 - fraction };
            let left = self.posture(Side::Left);
            for (side, posture) in [(Side::Left, &left), (Side::Right, &right)] {
                steps.push(self.step(side, posture).0);
            }
        }
        steps.retain(|events| !events.is_empty());
        steps
    }

    /// Returns the events since the last call, except values.
    fn take_events(&mut self) -> Vec<EventKind> {
        self.out
            .drain(..)
            .filter(|kind| !matches!(kind, EventKind::Value(..)))
            .collect()
    }
}

fn j(down: bool) -> EventKind {
    let key = "J".parse().expect("a key");
    if down {
        EventKind::KeyDown(key)
    } else {
        EventKind::KeyUp(key)
    }
}

#[test]
fn a_gesture_of_one_hand_pauses_and_releases_the_keys_of_the_other_hand_in_the_same_step() {
    let mut hands = TwoHands::new();
    for round in 0..200 {
        hands.press_j(true);
        assert_eq!(hands.take_events(), [j(true)], "round {round}");
        // In every second round the event list has room for a release, but not for a press.
        let is_crowded = round % 2 == 1;
        hands.queued_events = if is_crowded {
            Events::new().capacity() - 3
        } else {
            0
        };
        let steps = hands.bend(true);
        hands.queued_events = 0;
        let pause = std::mem::take(&mut hands.commands);
        assert_eq!(pause, [Command::TogglePause], "round {round}");
        assert_eq!(steps.len(), 1, "round {round}: {steps:?}");
        assert_eq!(hands.pipeline.state(), PipelineState::Paused);
        assert!(!hands.pipeline.has_pressed());
        assert_eq!(hands.take_events(), [j(false)], "round {round}");

        for is_down in [false, true, false] {
            hands.press_j(is_down);
        }
        assert_eq!(hands.bend(false), [[]; 0], "the finger straightens");
        hands.press_j(true);
        hands.press_j(false);
        hands.hold_still(500);
        assert_eq!(
            hands.take_events(),
            [],
            "round {round}: the pipeline is paused"
        );
        assert_eq!(hands.pipeline.state(), PipelineState::Paused);

        hands.bend(true);
        hands.bend(false);
        hands.hold_still(400);
        assert_eq!(
            hands.pipeline.state(),
            PipelineState::Running,
            "the gesture ends the pause"
        );
        assert_eq!(hands.take_events(), []);
    }
}

#[test]
fn a_hand_whose_elbow_is_no_longer_measured_releases_at_the_third_reading() {
    let mut hands = TwoHands::new();
    hands.press_j(true);
    assert_eq!(hands.take_events(), [j(true)]);
    let (left, mut without_elbow) = (hands.posture(Side::Left), hands.posture(Side::Right));
    let map = &hands.setup.glove.as_ref().expect("a glove").map;
    let elbow = map.rows().iter().find(|row| row.dof == Dof::ElbowFlexion);
    // The readings end before the channel of the elbow.
    without_elbow
        .counts
        .truncate(elbow.expect("a row for the elbow").channel);
    for expected in [&[][..], &[], &[j(false)]] {
        hands.milliseconds += 1;
        assert_eq!(hands.step(Side::Left, &left), (Vec::new(), None));
        let (out, rejection) = hands.step(Side::Right, &without_elbow);
        assert_eq!(
            (&out[..], rejection),
            (expected, Some(Rejection::WrongShape))
        );
    }
    assert!(!hands.pipeline.has_pressed());
    hands.take_events();
    hands.hold_still(300);
    assert_eq!(hands.take_events(), [], "the finger has not left the key");
    hands.press_j(false);
    hands.press_j(true);
    assert_eq!(hands.take_events(), [j(true)]);
}
