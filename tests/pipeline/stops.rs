//! The ways to stop that lead through the hand: a gesture that pauses, and the arm that is not seen any more.

use std::fs;

use crate::support::checked::Judged;
use ademan::capture::{Channels, MAX_CHANNELS, Reading, Sample};
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
use arrayvec::ArrayVec;

/// Bending the left ring finger pauses; the hand holds it up.
const GESTURE: &str = "triggers: [(name: \"Stop\", hand: \"left\", action: TogglePause, \
                       when: Angle(dof: \"ring-mcp-flexion\", on_deg: -5, off_deg: -15))],";

/// How far it is bent from there, in radians.
const BENT: f64 = 0.6;

/// In which it is bent, in readings of a millisecond each.
const READINGS: u64 = 60;

/// Two hands over a board in two halves, a reading of each in a millisecond: far more than any line brings.
struct Wearer {
    assembly: LoadedSetup,
    engine: Judged,
    /// Of the hand of each side over its key and on it.
    angles: Vec<(JointAngles, JointAngles)>,
    milliseconds: u64,
    /// Whether the right hand holds J down, and how far the left ring finger is bent.
    is_down: bool,
    bent: f64,
    /// How many events wait already when a reading comes.
    waiting: usize,
    /// The commands of the devices since the last look.
    commands: Vec<Command>,
    /// What went out since it was asked for.
    out: Vec<EventKind>,
}

/// The arm and the channels of a side.
fn worn(assembly: &LoadedSetup, side: Side) -> (&ArmModel, &ChannelMap) {
    let other = assembly.other_hand.as_ref().expect("two hands");
    match side {
        Side::Left => (&other.arm, &other.glove.map),
        Side::Right => (&assembly.arm, &assembly.glove.map),
    }
}

/// The hand of a side over F or J, and with that key pushed in.
fn strokes(assembly: &LoadedSetup, side: Side) -> (JointAngles, JointAngles) {
    let (arm, map) = worn(assembly, side);
    let layout = &assembly.layout;
    let key = if side == Side::Left { "F" } else { "J" };
    let target = layout.key(key).expect("a key").face.target;
    let hand = TypingHand::new(arm, map);
    let stroke = hand.tap_path(&layout.scene, target).expect("within reach");
    let angles = |tip| {
        let mut values = hand.rest_values();
        hand.reach(tip, &mut values, &[]);
        hand.angles(&values)
    };
    (angles(stroke.hover), angles(stroke.bottom))
}

impl Wearer {
    /// Armed.
    fn new() -> Self {
        let board = Document::shipped("qwerty-two-flat").expect("it is shipped");
        let with_gesture = format!("{GESTURE}\n    boards: [\n");
        let board = board.text.replacen("boards: [\n", &with_gesture, 1);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("stop.ron");
        fs::write(&path, board).expect("room on the disk");
        let setup = Setup {
            other_hand: Some(OtherHand::default()),
            layout: path.display().to_string(),
            smoothing: SmoothingSetup::Off,
            ..Setup::default()
        };
        let assembly = setup.load_files().expect("a setup");
        let mut wearer = Self {
            engine: Judged::of(&assembly),
            angles: Side::ALL
                .iter()
                .map(|&side| strokes(&assembly, side))
                .collect(),
            assembly,
            milliseconds: 0,
            is_down: false,
            bent: 0.0,
            waiting: 0,
            commands: Vec::new(),
            out: Vec::new(),
        };
        wearer.stay(400);
        assert_eq!(wearer.engine.state(), PipelineState::Running);
        wearer
    }

    /// The glove of a side as it is now.
    fn posture(&self, side: Side) -> Channels {
        let is_down = self.is_down && side == Side::Right;
        let (over, down) = &self.angles[side.index()];
        let angles = if is_down { down } else { over };
        let bent = if side == Side::Left { self.bent } else { 0.0 };
        let (_, map) = worn(&self.assembly, side);
        let full_scale = map.full_scale();
        let mut counts: ArrayVec<u16, MAX_CHANNELS> =
            (0..MAX_CHANNELS).map(|_| full_scale / 2).collect();
        for row in map.rows().iter().rev() {
            let more = if row.dof == Dof::RingMcpFlexion {
                bent
            } else {
                0.0
            };
            let exact = row
                .calibration
                .apply_inverse(angles.get(row.dof) + more)
                .round();
            counts[row.channel] = exact.clamp(1.0, f64::from(full_scale - 1)) as u16;
        }
        Channels { full_scale, counts }
    }

    /// One reading of a hand; what goes out because of it.
    fn see(&mut self, side: Side, channels: &Channels) -> (Vec<EventKind>, Option<Rejection>) {
        let reading = Reading {
            time: Timestamp(self.milliseconds * 1_000),
            side: Some(side),
            sample: Sample::Channels(channels.clone()),
        };
        let other = OutputEvent {
            time: reading.time,
            kind: EventKind::MoveBy(0, 0),
        };
        let mut events: Events = std::iter::repeat_n(other, self.waiting).collect();
        let step = self.engine.step(&reading, &mut events);
        let rejection = step.map(|step| {
            let commands = step.commands.iter().map(|issued| issued.command);
            self.commands.extend(commands);
        });
        let rejection = rejection.err();
        let new = events.iter().skip(self.waiting);
        let out: Vec<EventKind> = new.map(|event| event.kind).collect();
        self.out.extend(&out);
        (out, rejection)
    }

    /// Both hands stay as they are.
    fn stay(&mut self, milliseconds: u64) {
        let postures = [Side::Left, Side::Right].map(|side| (side, self.posture(side)));
        for _ in 0..milliseconds {
            self.milliseconds += 1;
            for (side, posture) in &postures {
                let (_, rejection) = self.see(*side, posture);
                assert_eq!(rejection, None);
            }
        }
    }

    fn push_j(&mut self, is_down: bool) {
        self.is_down = is_down;
        self.stay(100);
    }

    /// Bends the ring finger, or holds it up again; what goes out in each reading that lets something out.
    fn bend(&mut self, is_bent: bool) -> Vec<Vec<EventKind>> {
        let mut frames = Vec::new();
        let right = self.posture(Side::Right);
        for number in 1..=READINGS {
            self.milliseconds += 1;
            let share = number as f64 / READINGS as f64;
            self.bent = BENT * if is_bent { share } else { 1.0 - share };
            let left = self.posture(Side::Left);
            for (side, posture) in [(Side::Left, &left), (Side::Right, &right)] {
                frames.push(self.see(side, posture).0);
            }
        }
        frames.retain(|frame| !frame.is_empty());
        frames
    }

    fn said(&mut self) -> Vec<EventKind> {
        self.out
            .drain(..)
            .filter(|action| !matches!(action, EventKind::Value(..)))
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
fn a_gesture_of_one_hand_lets_go_of_what_the_other_holds_in_that_very_frame_and_pauses() {
    let mut wearer = Wearer::new();
    for round in 0..200 {
        wearer.push_j(true);
        assert_eq!(wearer.said(), [j(true)], "round {round}");
        // In every second round there is room left for the pause and a release, and for no press.
        let is_crowded = round % 2 == 1;
        wearer.waiting = if is_crowded {
            Events::new().capacity() - 3
        } else {
            0
        };
        let frames = wearer.bend(true);
        wearer.waiting = 0;
        let pause = std::mem::take(&mut wearer.commands);
        assert_eq!(pause, [Command::TogglePause], "round {round}");
        assert_eq!(frames.len(), 1, "round {round}: {frames:?}");
        assert_eq!(wearer.engine.state(), PipelineState::Paused);
        assert!(!wearer.engine.holds());
        assert_eq!(wearer.said(), [j(false)], "round {round}");

        for is_down in [false, true, false] {
            wearer.push_j(is_down);
        }
        assert_eq!(wearer.bend(false), [[]; 0], "it is held up again");
        wearer.push_j(true);
        wearer.push_j(false);
        wearer.stay(500);
        assert_eq!(wearer.said(), [], "round {round}: it is paused");
        assert_eq!(wearer.engine.state(), PipelineState::Paused);

        wearer.bend(true);
        wearer.bend(false);
        wearer.stay(400);
        assert_eq!(
            wearer.engine.state(),
            PipelineState::Running,
            "the same ends it"
        );
        assert_eq!(wearer.said(), []);
    }
}

#[test]
fn a_hand_whose_elbow_is_not_told_any_more_lets_go_at_the_third_reading() {
    let mut wearer = Wearer::new();
    wearer.push_j(true);
    assert_eq!(wearer.said(), [j(true)]);
    let (left, mut armless) = (wearer.posture(Side::Left), wearer.posture(Side::Right));
    let map = &wearer.assembly.glove.map;
    let elbow = map.rows().iter().find(|row| row.dof == Dof::ElbowFlexion);
    // A reading ends before the channel of the elbow.
    armless.counts.truncate(elbow.expect("it has one").channel);
    for expected in [&[][..], &[], &[j(false)]] {
        wearer.milliseconds += 1;
        assert_eq!(wearer.see(Side::Left, &left), (Vec::new(), None));
        let (out, rejection) = wearer.see(Side::Right, &armless);
        assert_eq!(
            (&out[..], rejection),
            (expected, Some(Rejection::WrongShape))
        );
    }
    assert!(!wearer.engine.holds());
    wearer.said();
    wearer.stay(300);
    assert_eq!(wearer.said(), [], "the finger has not left the key");
    wearer.push_j(false);
    wearer.push_j(true);
    assert_eq!(wearer.said(), [j(true)]);
}
