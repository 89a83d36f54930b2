//! A layout, a hand and a tiny language to move it: script in, transcript out.
//!
//! A script is a list of frames, 10 ms each:
//! - `index@Light:down` moves a fingertip over the middle of the control `Light`, to its full travel;
//!   `:up` 6 mm above its front; `:2.5` 2.5 mm deep; `index@Light+3,-2:1` 3 mm to the right and 2 mm
//!   towards the wearer, along the target's own axes. A finger that was not there before appears.
//! - `index@Light:tap` is three frames: up, down, up. Blanks in names are written `_`.
//! - `a&b` does both in one frame, `t:80ms` lets eight frames go by.
//! - `lost:index`, `doubt:index`, `trust:index`: not known, not to be believed, believed again.
//! - `angle:wrist-flexion=20`: an angle in degrees. `palm=0,30,0`: the hand is turned by so many degrees
//!   about the world's X, Y and Z. `tip:thumb=10,0,-300`: a fingertip in the world, in mm.
//! - `jump`: the hand was re-acquired in another place.
//! - `nan:wrist-flexion`: an angle that is no number. `knuckle=0,30,0`: the index MCP joint in the world, in mm.
//! - `left`, `right`: of which hand the following is; `release`: everything is let go of.

use std::io::{Result, Write};
use std::sync::{Arc, Mutex};

use crate::support::oracle::{Oracle, OutputRules};
use ademan::contact::{ContactTracker, TargetId, TargetName, TargetNames, Touches};
use ademan::device::{DeviceInput, DeviceOutput, Events, KeyArbiter, VirtualDevice};
use ademan::estimate::JointAngles;
use ademan::hand::{Finger, FingerSet, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::layout::Layout;
use ademan::output::{Sink, Transcript};
use ademan::pipeline::PipelineSettings;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Rotation, Vec3};

const RADIUS: f32 = 0.005;
const FRAME: u64 = 10_000;

pub struct Rig {
    layout: Layout,
    names: TargetNames,
    devices: Vec<Box<dyn VirtualDevice>>,
    switchboard: KeyArbiter,
    hands: [Hand; Side::COUNT],
    side: Side,
    time: Timestamp,
    page: Page,
    transcript: Transcript<Page>,
    oracle: Oracle,
}

struct Hand {
    tracker: ContactTracker,
    angles: JointAngles,
    /// The centres of the fingertips in the world.
    tips: [Option<Vec3>; Finger::COUNT],
    untrusted: FingerSet,
    jumped: bool,
    palm: Rotation,
    knuckle: Option<Vec3>,
}

#[derive(Clone, Default)]
struct Page(Arc<Mutex<Vec<u8>>>);

impl Write for Page {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// What a script makes of one flat board with these controls: the transcript without times, the lines
/// apart by ` | `. `controls` are the fields of the board, such as `toggles: [(…)]`.
pub fn simulate(controls: &str, script: &str) -> String {
    Rig::on_board(controls).run(script).events()
}

/// The same with further fields of the layout, such as `triggers: [(…)]`.
pub fn simulate_layout(controls: &str, fields: &str, script: &str) -> String {
    Rig::with_fields(controls, fields).run(script).events()
}

impl Rig {
    /// One flat board that lies in the world.
    pub fn on_board(controls: &str) -> Self {
        Self::with_fields(controls, "")
    }

    /// The same with further fields of the layout.
    pub fn with_fields(controls: &str, fields: &str) -> Self {
        Self::new(&format!(
            "Layout(name: \"test\", boards: [(place: (anchor: world), {controls})], {fields})"
        ))
    }

    pub fn new(text: &str) -> Self {
        let layout = Layout::parse(text, "test.ron").unwrap_or_else(|error| panic!("{error}"));
        let page = Page::default();
        let mut transcript = Transcript::new("test", page.clone());
        let names = layout.target_names();
        transcript.set_target_names(&names);
        let hand = || Hand {
            tracker: ContactTracker::new(&layout.scene),
            angles: JointAngles::default(),
            tips: [None; Finger::COUNT],
            untrusted: FingerSet::NONE,
            jumped: false,
            palm: Rotation::IDENTITY,
            knuckle: None,
        };
        Self {
            hands: [hand(), hand()],
            devices: layout.devices(),
            oracle: Oracle::new(
                [OutputRules::from_layout(&layout)],
                PipelineSettings::default(),
            ),
            switchboard: KeyArbiter::new(layout.texts.clone()),
            names,
            layout,
            side: Side::Right,
            time: Timestamp(0),
            page,
            transcript,
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

    /// The events so far, without times, apart by ` | `.
    pub fn events(&self) -> String {
        let lines = self.transcript();
        let events = lines.lines().map(|line| line[13..].trim_end());
        events.collect::<Vec<_>>().join(" | ")
    }

    /// The whole transcript, with times.
    pub fn transcript(&self) -> String {
        String::from_utf8(self.page.0.lock().unwrap().clone()).unwrap()
    }

    fn hand(&mut self) -> &mut Hand {
        &mut self.hands[self.side.index()]
    }

    fn obey(&mut self, order: &str) {
        let finger = |name: &str| name.parse::<Finger>().unwrap();
        if let Ok(side) = order.parse::<Side>() {
            self.side = side;
            return;
        }
        if let Some((name, place)) = order.split_once('@') {
            let (control, depth) = place.rsplit_once(':').unwrap();
            let centre = self.centre(control, depth);
            self.hand().tips[finger(name).index()] = Some(centre);
            return;
        }
        if let Some(turn) = order.strip_prefix("palm=") {
            let degrees = numbers(turn) * std::f32::consts::PI / 180.0;
            self.hand().palm = Rotation::from_scaled_axis(degrees);
            return;
        }
        if let Some(place) = order.strip_prefix("knuckle=") {
            self.hand().knuckle = Some(numbers(place) * 1e-3);
            return;
        }
        match order.split_once(':') {
            Some(("nan", dof)) => self.hand().angles.set(dof.parse().unwrap(), f64::NAN),
            Some(("lost", name)) => self.hand().tips[finger(name).index()] = None,
            Some(("doubt", name)) => {
                let hand = self.hand();
                hand.untrusted = hand.untrusted.with(finger(name));
            }
            Some(("trust", _)) => self.hand().untrusted = FingerSet::NONE,
            Some(("tip", place)) => {
                let (name, place) = place.split_once('=').unwrap();
                self.hand().tips[finger(name).index()] = Some(numbers(place) * 1e-3);
            }
            Some(("angle", value)) => {
                let (dof, degrees) = value.split_once('=').unwrap();
                let degrees: f64 = degrees.parse().unwrap();
                let dof = dof.parse().unwrap();
                self.hand().angles.set(dof, degrees.to_radians());
            }
            None if order == "jump" => self.hand().jumped = true,
            None if order == "release" => self.release_all(),
            _ => panic!("unknown order {order}"),
        }
    }

    /// Where the fingertip's centre is when its pad is there.
    fn centre(&self, control: &str, depth: &str) -> Vec3 {
        let (name, aside) = match control.find(['+', '-']) {
            Some(at) => (&control[..at], numbers(&control[at..])),
            None => (control, Vec3::ZERO),
        };
        let name = name.replace('_', " ");
        let mut targets = (0..self.layout.scene.len() as u32).map(TargetId);
        let target = targets
            .find(|&target| self.names.get(target) == TargetName::Name(&name))
            .unwrap_or_else(|| panic!("no target is called {name}"));
        let (surface, target) = self.layout.scene.target(target).unwrap();
        let depth = match depth {
            "down" => target.travel * 1e3,
            "up" => -6.0,
            number => number.parse().unwrap(),
        };
        let world_from_surface = surface
            .world_from_surface(&self.pose())
            .expect("the anchor of the board is known");
        let above = Vec3::new(aside.x, aside.y, -depth) * 1e-3 + Vec3::Z * RADIUS;
        world_from_surface * target.surface_from_target * above
    }

    fn pose(&self) -> HandPose {
        let hand = &self.hands[self.side.index()];
        let mut pose = HandPose::new(self.time, self.side, RADIUS);
        pose.untrusted = hand.untrusted;
        pose.jumped = hand.jumped;
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

    /// Shows one hand as it is now, 10 ms later.
    fn frame(&mut self) {
        self.time = Timestamp(self.time.0 + FRAME);
        let pose = self.pose();
        let hand = &mut self.hands[self.side.index()];
        hand.jumped = false;
        let mut touches = Touches::new();
        hand.tracker.update(&self.layout.scene, &pose, &mut touches);
        let seen = DeviceInput {
            scene: &self.layout.scene,
            angles: &hand.angles,
            pose: &pose,
            touches: &touches,
        };
        let mut events = Events::new();
        let mut out = DeviceOutput {
            arbiter: &mut self.switchboard,
            events: &mut events,
        };
        for device in &mut self.devices {
            device.update(&seen, &mut out);
        }
        self.write(&events, false);
    }

    /// Lets go of everything, as the engine does.
    fn release_all(&mut self) {
        let mut events = Events::new();
        for hand in &mut self.hands {
            hand.tracker.reset(self.time, &mut Touches::new());
        }
        self.switchboard.release_all(self.time, &mut events);
        let mut out = DeviceOutput {
            arbiter: &mut self.switchboard,
            events: &mut events,
        };
        for device in &mut self.devices {
            device.release_all(self.time, &mut out);
        }
        self.write(&events, true);
    }

    fn write(&mut self, events: &Events, lets_go: bool) {
        let judgement = self.oracle.check_devices(events, lets_go);
        judgement.unwrap_or_else(|violation| panic!("{violation}: {events:?}"));
        self.transcript.send(events).unwrap();
    }
}

/// Up to three numbers apart by commas; those left out are 0.
fn numbers(text: &str) -> Vec3 {
    let mut found = Vec3::ZERO;
    for (place, number) in text.split(',').enumerate() {
        found[place] = number.parse().unwrap();
    }
    found
}
