//! Taps of a person with scatter on a shipped board: contact, devices and the text decoder, without a source.

use ademan::command::TextMode;
use ademan::contact::{ContactTracker, Presses, Touches};
use ademan::device::pressed_keys::PressedKeys;
use ademan::device::{
    DeviceInput, DeviceOutput, EventKind, Events, KeyArbiter, KeyCode, TimedCommands,
};
use ademan::estimate::JointAngles;
use ademan::files::Load;
use ademan::hand::{Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::layout::Layout;
use ademan::pipeline::PressFilter;
use ademan::pipeline::press_filter::FilterInput;
use ademan::sim::UsTextField;
use ademan::text::Language;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Vec2, Vec3};

use super::text::distance;

const RADIUS: f32 = 0.006;

const PHRASES: [&str; 10] = [
    "the weather was very nice so we went for a long walk in the park ",
    "please call me back when you have some time this afternoon ",
    "my sister wants to learn how to play the piano next year ",
    "there is a small restaurant near the station with good food ",
    "he did not know what to say when she asked him about it ",
    "we should leave early tomorrow because the road is very busy ",
    "the children were playing in the garden behind the house ",
    "i would like a cup of coffee and a piece of cake please ",
    "nobody could remember where the old map was hidden ",
    "it takes about twenty minutes to walk from here to the river ",
];

/// A person who taps with the index finger.
struct Typist {
    layout: Layout,
    tracker: ContactTracker,
    random: fastrand::Rng,
    frame: u64,
}

impl Typist {
    fn new(seed: u64) -> Self {
        let layout = Layout::load("qwerty-flat").expect("the shipped layout");
        Self {
            tracker: ContactTracker::new(&layout.scene),
            layout,
            random: fastrand::Rng::with_seed(seed),
            frame: 0,
        }
    }

    fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.random.f32()).sum::<f32>() - 6.0
    }

    /// Returns the center of the key of a character on its board.
    fn center(&self, character: char) -> Vec2 {
        let (code, _) = KeyCode::for_us_character(character).next().expect("a key");
        let has_code = |key: &&ademan::layout::Key| {
            key.action(0) == Some(ademan::device::KeyAction::Key(code))
        };
        let key = self.layout.keys.iter().find(has_code).expect("a key");
        key.face.outline.center
    }

    /// Returns the pose of the next frame, at 100 Hz, with the pad of the index finger at a point of the board.
    fn pose(&mut self, at: Vec2, height: f32) -> HandPose {
        self.frame += 1;
        let mut pose = HandPose::new(Timestamp(self.frame * 10_000), Side::Right, RADIUS);
        pose.set(Joint::Elbow, Pose::IDENTITY);
        let surface = &self.layout.scene.surfaces()[0];
        let world = surface.world_from_surface(&pose).expect("the elbow");
        let center = world * (at.extend(height) + Vec3::Z * RADIUS);
        pose.set(Joint::tip(Finger::Index), Pose::from_translation(center));
        pose
    }
}

/// Types the phrases with a scatter in metres, and returns the wrong characters.
fn wrong(mode: Option<TextMode>, scatter: f32, seed: u64) -> usize {
    let mut typist = Typist::new(seed);
    let language = Language::load("en", |_| Err(String::new())).expect("it comes with the program");
    let mut filter: Option<Box<dyn PressFilter>> =
        mode.and_then(|mode| language.filter(&typist.layout, mode, false, false));
    assert_eq!(filter.is_some(), mode.is_some());
    let mut devices = typist.layout.devices();
    let mut arbiter = KeyArbiter::new(typist.layout.texts.clone());
    let mut held = PressedKeys::default();
    let mut total = 0;
    for phrase in PHRASES {
        let mut field = UsTextField::new();
        for character in phrase.chars() {
            let scattered = Vec2::new(typist.normal(), typist.normal()) * scatter;
            let at = typist.center(character) + scattered;
            for height in [12, 6, 1, -3, -4, -3, 1, 6, 12, 12] {
                let pose = typist.pose(at, height as f32 * 1e-3);
                let (mut touches, mut presses) = (Touches::new(), Presses::new());
                let scene = &typist.layout.scene;
                typist.tracker.update(scene, &pose, &mut touches);
                typist.tracker.add_presses(scene, &touches, &mut presses);
                let input = DeviceInput {
                    scene,
                    angles: &JointAngles::default(),
                    bends: &Default::default(),
                    inputs: &Default::default(),
                    pose: &pose,
                    touches: &touches,
                    presses: &presses,
                };
                let mut events = Events::new();
                let mut output = DeviceOutput {
                    arbiter: &mut arbiter,
                    events: &mut events,
                    commands: &mut TimedCommands::new(),
                };
                for device in &mut devices {
                    device.update(&input, &mut output);
                }
                let emitted = events.clone();
                if let Some(filter) = &mut filter {
                    let filter_input = FilterInput {
                        time: pose.time,
                        side: pose.side,
                        presses: &presses,
                        held: &held,
                        contact: Some((&pose, scene)),
                    };
                    filter.filter(&filter_input, &mut events);
                }
                for event in &emitted {
                    match event.kind {
                        EventKind::KeyDown(key) => _ = held.press(key),
                        EventKind::KeyUp(key) => _ = held.release(key),
                        _ => {}
                    }
                }
                events.iter().for_each(|event| field.handle(event));
            }
        }
        if let Some(filter) = &mut filter {
            filter.reset();
        }
        total += distance(&field.text().to_lowercase(), phrase);
    }
    total
}

#[test]
fn a_run_in_auto_mode_has_fewer_wrong_characters_at_every_scatter() {
    let characters: usize = PHRASES.iter().map(|phrase| phrase.len()).sum::<usize>() * 3;
    for (scatter, most) in [(0.003, 0.5), (0.005, 0.1), (0.006, 0.1)] {
        let sum = |mode| (1..4).map(|seed| wrong(mode, scatter, seed)).sum::<usize>();
        let (literal, auto) = (sum(None), sum(Some(TextMode::Auto)));
        let percent = |count: usize| 100.0 * count as f32 / characters as f32;
        println!(
            "{scatter}: literal {:.2} %, auto {:.2} % of {characters}",
            percent(literal),
            percent(auto)
        );
        assert!(
            auto as f32 <= most * literal as f32,
            "{scatter}: {auto} of {literal}"
        );
        assert_eq!(sum(Some(TextMode::Literal)), literal);
    }
}
