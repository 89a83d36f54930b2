//! Fingertips at exact positions over a layout: contact tracking and devices, without a glove and an estimator.

use ademan::contact::surface::Scene;
use ademan::contact::{ContactTracker, TargetId, TargetName, TargetNames, Touch, Touches};
use ademan::device::{DeviceInput, DeviceOutput, Events, KeyArbiter, TimedCommands, VirtualDevice};
use ademan::estimate::{BendRanges, JointAngles};
use ademan::hand::{Finger, FingerSet, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::layout::Layout;
use ademan::pipeline::PipelineSettings;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Rotation, Vec3};

use super::board::Board;
use super::script::{Step, steps};
use super::transcript::{Detail, Transcript};
use crate::support::oracle::{Oracle, OutputRules};

/// The radius of every fingertip, in metres.
pub const TIP_RADIUS: f32 = 0.005;
/// The time from step to step, in microseconds.
const PERIOD: u64 = 10_000;
/// The longest step in which a fingertip may enter a target, in microseconds, as of a pipeline with the default settings.
const MAX_SWEEP: u64 = 150_000;
/// The height of a raised fingertip above the front of a target, in millimetres.
const RAISED_MM: f32 = 6.0;

/// A layout and the hands over it, checked by the oracle after every step.
pub struct Rig {
    /// The surfaces of the layout.
    pub scene: Scene,
    names: TargetNames,
    devices: Vec<Box<dyn VirtualDevice>>,
    arbiter: KeyArbiter,
    /// The commands of the current step.
    commands: TimedCommands,
    hands: [Hand; Side::COUNT],
    side: Side,
    time: Timestamp,
    /// The time for which readings are missing before the next step, in microseconds.
    gap: u64,
    transcript: Transcript,
    oracle: Oracle,
}

struct Hand {
    tracker: ContactTracker,
    angles: JointAngles,
    /// The centers of the fingertips in the world.
    tips: [Option<Vec3>; Finger::COUNT],
    untrusted: FingerSet,
    jumped: bool,
    palm: Rotation,
    knuckle: Option<Vec3>,
}

impl Rig {
    /// A layout file with this text.
    pub fn new(text: &str) -> Self {
        let layout = Layout::parse(text, "test.ron").unwrap_or_else(|error| panic!("{error}"));
        Self::with_parts(
            layout.target_names(),
            layout.devices(),
            KeyArbiter::new(layout.texts.clone()),
            OutputRules::from_layout(&layout),
            layout.scene,
        )
    }

    /// A layout of one flat board, fixed in the world, with these fields, such as `toggles: [(…)]`.
    pub fn on_board(controls: &str) -> Self {
        Self::with_fields(controls, "")
    }

    /// A layout of one flat board with these fields, and with further fields of the layout.
    pub fn with_fields(controls: &str, fields: &str) -> Self {
        Self::new(&format!(
            "Layout(name: \"test\", boards: [(pose: (anchor: world), {controls})], {fields})"
        ))
    }

    /// A keyboard in shorthand, see [`Board`].
    pub fn with_keys(keys: &str) -> Self {
        let board = Board::parse(keys);
        let rules = OutputRules::from(board.capabilities());
        Self::with_parts(
            board.names(),
            vec![Box::new(board.keyboard)],
            KeyArbiter::default(),
            rules,
            board.scene,
        )
    }

    fn with_parts(
        names: TargetNames,
        devices: Vec<Box<dyn VirtualDevice>>,
        arbiter: KeyArbiter,
        rules: OutputRules,
        scene: Scene,
    ) -> Self {
        // The output gate, which suppresses system keys, is not a part of the rig.
        let settings = PipelineSettings {
            allow_system_keys: true,
            ..PipelineSettings::default()
        };
        let hand = || Hand {
            tracker: ContactTracker::new(&scene),
            angles: JointAngles::default(),
            tips: [None; Finger::COUNT],
            untrusted: FingerSet::NONE,
            jumped: false,
            palm: Rotation::IDENTITY,
            knuckle: None,
        };
        Self {
            hands: [hand(), hand()],
            names,
            devices,
            arbiter,
            commands: TimedCommands::new(),
            side: Side::Right,
            time: Timestamp(0),
            gap: 0,
            transcript: Transcript::new(Detail::Every, Timestamp(0)),
            oracle: Oracle::new([rules], settings),
            scene,
        }
    }

    /// Plays a script. The language is described in [the module](super).
    pub fn run(&mut self, script: &str) -> &mut Self {
        for step in steps(script) {
            self.step(&step);
        }
        self
    }

    /// The events so far as words, with times.
    pub fn transcript(&self) -> String {
        self.transcript.text(true)
    }

    /// The events so far as words, without times.
    pub fn events(&self) -> String {
        self.transcript.text(false)
    }

    /// The pose of the hand that the next order is about.
    pub fn pose(&self) -> HandPose {
        let hand = &self.hands[self.side.index()];
        let mut pose = HandPose::new(self.time, self.side, TIP_RADIUS);
        pose.untrusted = hand.untrusted;
        pose.jumped = hand.jumped;
        pose.is_after_gap = self.gap + PERIOD > MAX_SWEEP;
        if let Some(knuckle) = hand.knuckle {
            let knuckle = Pose::from_parts(knuckle, hand.palm);
            pose.set(Joint::IndexPhalanxProximal, knuckle);
        }
        for joint in [Joint::Elbow, Joint::Wrist] {
            pose.set(joint, Pose::from_parts(Vec3::ZERO, hand.palm));
        }
        for (&finger, tip) in Finger::ALL.iter().zip(hand.tips) {
            if let Some(tip) = tip {
                pose.set(Joint::tip(finger), Pose::from_parts(tip, hand.palm));
            }
        }
        pose
    }

    /// The contact tracker of the right hand.
    pub fn tracker(&mut self) -> &mut ContactTracker {
        &mut self.hands[Side::Right.index()].tracker
    }

    /// Returns `true` if the tracker sees the hand clear of every target.
    pub fn is_clear(&mut self) -> bool {
        let pose = self.pose();
        let tracker = &mut self.hands[self.side.index()].tracker;
        tracker.is_clear(&self.scene, &pose)
    }

    /// Tracks the contacts of the right hand in a pose.
    pub fn track(&mut self, pose: &HandPose, touches: &mut Touches) {
        let tracker = &mut self.hands[Side::Right.index()].tracker;
        tracker.update(&self.scene, pose, touches);
    }

    /// Gives all devices one step of a hand.
    pub fn update(&mut self, pose: &HandPose, touches: &[Touch], events: &mut Events) {
        let angles = self.hands[pose.side.index()].angles;
        let input = DeviceInput {
            scene: &self.scene,
            angles: &angles,
            bends: &BendRanges::human().bends(&angles),
            inputs: &Default::default(),
            pose,
            touches,
            presses: &[],
        };
        let mut output = DeviceOutput {
            arbiter: &mut self.arbiter,
            events,
            commands: &mut self.commands,
        };
        // As a layout does before its devices.
        let last_time = output.arbiter.last_event_time();
        output.arbiter.emit_changes(last_time, output.events);
        for device in &mut self.devices {
            device.update(&input, &mut output);
        }
    }

    /// Releases all that the devices have pressed; the trackers keep their contacts.
    pub fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        self.arbiter.release_all(time, events);
        let mut output = DeviceOutput {
            arbiter: &mut self.arbiter,
            events,
            commands: &mut self.commands,
        };
        for device in &mut self.devices {
            device.release_all(time, &mut output);
        }
    }

    fn step(&mut self, step: &Step) {
        if let [order] = &step.orders[..]
            && let ["wait", milliseconds] = order[..]
        {
            let milliseconds: u64 = number(milliseconds);
            (0..milliseconds * 1_000 / PERIOD).for_each(|_| self.show());
            return;
        }
        let is_tap = |order: &Vec<&str>| order.last() == Some(&"tap");
        let heights = if step.orders.iter().any(is_tap) {
            &["up", "down", "up"][..]
        } else {
            &[""]
        };
        for height in heights {
            for order in &step.orders {
                match order.split_last() {
                    Some((&"tap", words)) => self.obey(&[words, &[*height]].concat()),
                    _ => self.obey(order),
                }
            }
            self.show();
        }
    }

    fn obey(&mut self, order: &[&str]) {
        match *order {
            ["left"] => self.side = Side::Left,
            ["right"] => self.side = Side::Right,
            ["gap", milliseconds] => self.gap = number::<u64>(milliseconds) * 1_000,
            ["reacquire"] => self.hand().jumped = true,
            ["reset"] => self.reset(),
            ["release"] => self.release(true),
            ["release-devices"] => self.release(false),
            ["hide", name] => self.hand().tips[finger(name).index()] = None,
            ["doubt", name] => {
                let hand = self.hand();
                hand.untrusted = hand.untrusted.with(finger(name));
            }
            ["trust", name] => {
                let (trusted, hand) = (finger(name), self.hand());
                let others = Finger::ALL.iter().copied();
                hand.untrusted = others
                    .filter(|&other| other != trusted && hand.untrusted.contains(other))
                    .fold(FingerSet::NONE, FingerSet::with);
            }
            ["set", joint, degrees] => {
                let dof = joint.parse().expect("the name of a joint angle");
                let degrees: f64 = number(degrees);
                self.hand().angles.set(dof, degrees.to_radians());
            }
            ["palm", x, y, z] => {
                let degrees = vector([x, y, z]) * std::f32::consts::PI / 180.0;
                self.hand().palm = Rotation::from_scaled_axis(degrees);
            }
            ["knuckle", x, y, z] => self.hand().knuckle = Some(vector([x, y, z]) * 1e-3),
            ["tip", name, x, y, z] => {
                self.hand().tips[finger(name).index()] = Some(vector([x, y, z]) * 1e-3);
            }
            [name, target, depth] => self.move_tip(name, target, ["0", "0"], depth),
            [name, target, x, y, depth] => self.move_tip(name, target, [x, y], depth),
            _ => panic!("unknown order `{}`", order.join(" ")),
        }
    }

    /// Moves a fingertip over a target so that its pad is `depth` deep.
    fn move_tip(&mut self, name: &str, target: &str, [x, y]: [&str; 2], depth: &str) {
        let mut targets = (0..self.scene.len() as u32).map(TargetId);
        let target = targets
            .find(|&id| self.names.get(id) == TargetName::Name(target))
            .unwrap_or_else(|| panic!("no target is named `{target}`"));
        let (surface, target) = self.scene.target(target).expect("a target of the scene");
        let depth_mm = match depth {
            "down" => target.travel * 1e3,
            "up" => -RAISED_MM,
            depth => number(depth),
        };
        let pad = Vec3::new(number(x), number(y), -depth_mm) * 1e-3;
        let world_from_surface = surface
            .world_from_surface(&self.pose())
            .expect("the anchor of the board is known");
        let center = pad + Vec3::Z * TIP_RADIUS;
        let tip = world_from_surface * target.surface_from_target * center;
        self.hand().tips[finger(name).index()] = Some(tip);
    }

    /// Shows the current hand 10 ms later, or after the gap.
    fn show(&mut self) {
        self.time = Timestamp(self.time.0 + self.gap + PERIOD);
        let pose = self.pose();
        self.gap = 0;
        let hand = &mut self.hands[self.side.index()];
        hand.jumped = false;
        let mut touches = Touches::new();
        hand.tracker.update(&self.scene, &pose, &mut touches);
        self.show_touches(&pose, &touches);
    }

    fn show_touches(&mut self, pose: &HandPose, touches: &Touches) {
        let mut events = Events::new();
        self.update(pose, touches, &mut events);
        self.write(&events, false);
    }

    fn reset(&mut self) {
        let (pose, mut touches) = (self.pose(), Touches::new());
        self.hand().tracker.reset(pose.time, &mut touches);
        self.show_touches(&pose, &touches);
    }

    /// Releases everything; with `resets_trackers` as the pipeline does, so that every finger has to leave first.
    fn release(&mut self, resets_trackers: bool) {
        if resets_trackers {
            for hand in &mut self.hands {
                hand.tracker.reset(self.time, &mut Touches::new());
            }
        }
        let mut events = Events::new();
        self.release_all(self.time, &mut events);
        self.write(&events, true);
    }

    fn write(&mut self, events: &Events, is_release: bool) {
        let judgement = self.oracle.check_devices(events, is_release);
        judgement.unwrap_or_else(|violation| panic!("{violation}: {events:?}"));
        for command in std::mem::take(&mut self.commands) {
            self.transcript.push_command(&command);
        }
        for event in events {
            self.transcript.push(event, &self.names);
        }
    }

    fn hand(&mut self) -> &mut Hand {
        &mut self.hands[self.side.index()]
    }
}

fn finger(name: &str) -> Finger {
    name.parse()
        .unwrap_or_else(|error| panic!("unknown order or finger: {error}"))
}

fn number<T: std::str::FromStr>(word: &str) -> T {
    word.parse()
        .unwrap_or_else(|_| panic!("`{word}` is not a number"))
}

fn vector(words: [&str; 3]) -> Vec3 {
    Vec3::from_array(words.map(number))
}
