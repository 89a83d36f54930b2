//! A board, a hand and a tiny language to move its fingertips: script in, transcript out.
//!
//! A board is a text: keys in a row apart by spaces, rows by `/`. A key is its name; `a|1` has the
//! key 1 on layer 1, `~a` tells its depth, `*shift` is a one-shot, `!shift` locks, `layer1` switches
//! to layer 1; `^a` fires on release, `a>shift` is Shift when it is held for 200 ms, `a%50` does not
//! press again for 50 ms; `*shift#S` is called `S` in scripts.
//!
//! A script is a list of frames, 10 ms each:
//! - `index@q:down` moves a fingertip over the middle of `q`, 4 mm deep; `:up` 6 mm above the
//!   front; `:2.5` 2.5 mm deep; `index@q+9:down` 9 mm to the right of the middle. A finger that was
//!   not there before appears.
//! - `index@q:tap` is three frames: up, down, up.
//! - `a&b` does both in one frame, `t:80ms` lets eight frames go by.
//! - `lost:index`, `doubt:index`, `trust:index`: not known, not to be believed, believed again.
//! - `jump`: the hand is re-acquired; `reset`: the tracker forgets; `release`: the keyboard lets go.

use crate::support::oracle::Oracle;
use ademan::contact::surface::{Anchor, Scene, Shape, TREMOR_MARGIN, Target};
use ademan::contact::{ContactTracker, TargetId, Touch, Touches};
use ademan::device::keyboard::{Activation, KeyBinding, Keyboard, TapHold};
use ademan::device::{
    Capabilities, DeviceInput, DeviceOutput, EventKind, Events, KeyAction, KeyArbiter, KeyCode,
    Latch, VirtualDevice,
};
use ademan::estimate::JointAngles;
use ademan::hand::{Finger, FingerSet, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::pipeline::PipelineSettings;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Rotation, Vec2, Vec3};
use std::time::Duration;

pub const PITCH: f32 = 0.019;
pub const HALF: f32 = 0.008;
pub const TRAVEL: f32 = 0.004;
pub const RADIUS: f32 = 0.005;
const FRAME: u64 = 10_000;

/// Lies flat: the board's +Z is up.
pub fn world_from_board() -> Pose {
    Pose::from_parts(
        Vec3::new(0.05, -0.1, -0.2),
        Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2),
    )
}

pub fn key_target(shape: Shape, surface_from_target: Pose) -> Target {
    Target {
        shape,
        surface_from_target,
        travel: TRAVEL,
        press_at: 0.5,
        release_at: 0.25,
        margin: TREMOR_MARGIN,
    }
}

pub struct Rig {
    pub scene: Scene,
    pub tracker: ContactTracker,
    pub keyboard: Keyboard,
    pub switchboard: KeyArbiter,
    pub pose: HandPose,
    /// What is pushed by a script: pad points in the board's frame.
    pads: [Option<Vec3>; Finger::COUNT],
    world_from_board: Pose,
    names: Vec<String>,
    transcript: Vec<(Timestamp, String)>,
    oracle: Oracle,
}

impl Rig {
    pub fn new(board: &str) -> Self {
        let (mut names, mut targets, mut bindings) = (Vec::new(), Vec::new(), Vec::new());
        for (row, keys) in board.split('/').enumerate() {
            for (column, key) in keys.split_whitespace().enumerate() {
                let middle = Vec3::new(column as f32 * PITCH, -(row as f32) * PITCH, 0.0);
                bindings.push(binding(key, TargetId(targets.len() as u32)));
                let pose = Pose::from_translation(middle);
                targets.push(key_target(Shape::Box(Vec2::splat(HALF)), pose));
                let name = key.rsplit('#').next().unwrap();
                let name = name.split(['|', '>', '%']).next().unwrap();
                names.push(name.trim_start_matches(['*', '!', '~', '^']).to_owned());
            }
        }
        let mut scene = Scene::new();
        scene.add_surface(Anchor::World, world_from_board(), targets);
        let keyboard = Keyboard::new(bindings);
        let mut needs = Capabilities::default();
        keyboard.add_capabilities(&mut needs);
        Self {
            tracker: ContactTracker::new(&scene),
            keyboard,
            oracle: Oracle::new([needs.into()], PipelineSettings::default()),
            switchboard: KeyArbiter::default(),
            scene,
            pose: HandPose::new(Timestamp(0), Side::Right, RADIUS),
            pads: [None; Finger::COUNT],
            world_from_board: world_from_board(),
            names,
            transcript: Vec::new(),
        }
    }

    pub fn run(&mut self, script: &str) -> &mut Self {
        for token in script.split_whitespace() {
            if let Some(wait) = token.strip_prefix("t:") {
                let wait: u64 = wait.trim_end_matches("ms").parse().unwrap();
                (0..wait * 1000 / FRAME).for_each(|_| self.frame());
            } else if let Some(place) = token.strip_suffix(":tap") {
                self.run(&format!("{place}:up {place}:down {place}:up"));
            } else {
                token.split('&').for_each(|order| self.obey(order));
                self.frame();
            }
        }
        self
    }

    fn obey(&mut self, order: &str) {
        let finger = |name: &str| name.parse::<Finger>().unwrap();
        let believed = |set: FingerSet, but: Finger| {
            let stay = Finger::ALL
                .iter()
                .filter(|&&other| other != but && set.contains(other));
            stay.fold(FingerSet::NONE, |set, &finger| set.with(finger))
        };
        match order.split_once(':') {
            Some(("lost", name)) => self.pads[finger(name).index()] = None,
            Some(("doubt", name)) => {
                self.pose.untrusted = self.pose.untrusted.with(finger(name));
            }
            Some(("trust", name)) => {
                self.pose.untrusted = believed(self.pose.untrusted, finger(name));
            }
            Some((place, depth)) => {
                let (name, key) = place.split_once('@').unwrap();
                self.pads[finger(name).index()] = Some(self.point(key, depth));
            }
            None if order == "jump" => self.pose.jumped = true,
            None if order == "reset" => {
                let mut touches = Touches::new();
                self.tracker.reset(self.pose.time, &mut touches);
                self.hear(&touches);
            }
            None if order == "release" => {
                let mut events = Events::new();
                self.release_all(self.pose.time, &mut events);
                self.write(&events, true);
            }
            None => panic!("unknown order {order}"),
        }
    }

    /// The pad point that `q+9` and `down` stand for.
    fn point(&self, key: &str, depth: &str) -> Vec3 {
        let (key, aside) = match key.find(['+', '-']) {
            Some(at) => (&key[..at], key[at..].parse::<f32>().unwrap()),
            None => (key, 0.0),
        };
        let place = self.names.iter().position(|name| name == key).expect(key);
        let (_, target) = self.scene.target(TargetId(place as u32)).unwrap();
        let depth = match depth {
            "down" => 4.0,
            "up" => -6.0,
            number => number.parse().unwrap(),
        };
        target.surface_from_target.translation + Vec3::new(aside, 0.0, -depth) * 1e-3
    }

    /// Shows the tracker the hand as it is now, 10 ms later.
    fn frame(&mut self) {
        let (untrusted, jumped) = (self.pose.untrusted, self.pose.jumped);
        let time = Timestamp(self.pose.time.0 + FRAME);
        self.pose = HandPose::new(time, Side::Right, RADIUS);
        (self.pose.untrusted, self.pose.jumped) = (untrusted, jumped);
        for (&finger, pad) in Finger::ALL.iter().zip(self.pads) {
            if let Some(pad) = pad {
                let centre = self
                    .world_from_board
                    .transform_point(pad + Vec3::Z * RADIUS);
                self.pose
                    .set(Joint::tip(finger), Pose::from_translation(centre));
            }
        }
        let mut touches = Touches::new();
        self.tracker.update(&self.scene, &self.pose, &mut touches);
        self.pose.jumped = false;
        self.hear(&touches);
    }

    /// Shows the keyboard one frame.
    pub fn update(&mut self, pose: &HandPose, touches: &[Touch], events: &mut Events) {
        let seen = DeviceInput {
            scene: &self.scene,
            angles: &JointAngles::default(),
            pose,
            touches,
        };
        let switchboard = &mut self.switchboard;
        self.keyboard.update(
            &seen,
            &mut DeviceOutput {
                arbiter: switchboard,
                events,
            },
        );
    }

    /// Lets go of everything, as the engine does.
    pub fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        self.switchboard.release_all(time, events);
        let switchboard = &mut self.switchboard;
        self.keyboard.release_all(
            time,
            &mut DeviceOutput {
                arbiter: switchboard,
                events,
            },
        );
    }

    fn hear(&mut self, touches: &Touches) {
        let mut events = Events::new();
        self.update(&self.pose.clone(), touches, &mut events);
        self.write(&events, false);
    }

    fn write(&mut self, events: &Events, lets_go: bool) {
        let judgement = self.oracle.check_devices(events, lets_go);
        judgement.unwrap_or_else(|violation| panic!("{violation}: {events:?}"));
        for event in events {
            let text = match event.kind {
                EventKind::KeyDown(code) => format!("dn:{code}"),
                EventKind::KeyUp(code) => format!("up:{code}"),
                EventKind::Depth(target, depth) => {
                    format!("depth:{}={depth:.2}", self.names[target.0 as usize])
                }
                _ => panic!("a keyboard does not send {:?}", event.kind),
            };
            self.transcript.push((event.time, text));
        }
    }

    /// The events with the time that went by before each.
    pub fn transcript(&self) -> String {
        let mut last = Timestamp(0);
        let mut words = Vec::new();
        for (time, text) in &self.transcript {
            assert!(*time >= last, "time went back at {text}");
            if *time > last {
                words.push(format!(
                    "t:{}ms",
                    time.since(last).as_micros() as f64 / 1000.0
                ));
            }
            words.push(text.clone());
            last = *time;
        }
        words.join(" ")
    }

    /// The events alone.
    pub fn keys(&self) -> String {
        let words: Vec<&str> = self
            .transcript
            .iter()
            .map(|(_, text)| text.as_str())
            .collect();
        words.join(" ")
    }
}

fn binding(key: &str, target: TargetId) -> KeyBinding {
    let (key, repress) = key.split_once('%').unwrap_or((key, "0"));
    let (key, hold) = match key.split_once('>') {
        Some((key, hold)) => (key, action(hold)),
        None => (key, None),
    };
    let fires = match hold {
        Some(action) => Activation::TapHold(TapHold {
            hold_action: action,
            hold_after: Duration::from_millis(200),
        }),
        None if key.starts_with('^') => Activation::OnRelease,
        None => Activation::OnPress,
    };
    let actions = key.trim_start_matches(['~', '^']).split('|');
    KeyBinding {
        target,
        actions: actions.map(action).collect(),
        reports_depth: key.starts_with('~'),
        activation: fires,
        debounce: Duration::from_millis(repress.parse().unwrap()),
    }
}

fn action(key: &str) -> Option<KeyAction> {
    let key = key.split('#').next().unwrap();
    let (name, latch) = match key.split_at(1) {
        ("*", name) => (name, Latch::OneShot),
        ("!", name) => (name, Latch::Lock),
        _ => (key, Latch::Momentary),
    };
    if let Some(layer) = name.strip_prefix("layer") {
        return Some(KeyAction::Layer(layer.parse().unwrap(), latch));
    }
    Some(match name {
        "-" => return None,
        "shift" => KeyAction::Modifier(KeyCode::SHIFT_LEFT, latch),
        "ctrl" => KeyAction::Modifier("ControlLeft".parse().unwrap(), latch),
        letter => KeyAction::Key(letter.to_uppercase().parse().unwrap()),
    })
}

/// The events that a script gives on a board, with times.
pub fn simulate(board: &str, script: &str) -> String {
    Rig::new(board).run(script).transcript()
}

/// The events that a script gives on a board, without times.
pub fn simulate_keys(board: &str, script: &str) -> String {
    Rig::new(board).run(script).keys()
}

/// Numbers that look random, the same for the same seed (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly spread over `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Whether something happens that happens once in `count` times.
    pub fn once_in(&mut self, count: u64) -> bool {
        self.bits().is_multiple_of(count)
    }
}
