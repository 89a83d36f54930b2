//! Taps of a person with scatter on a shipped board: contact, devices and the text decoder, without a source.

use ademan::command::TextMode;
use ademan::contact::{ContactTracker, Presses, Touches};
use ademan::device::pressed_keys::PressedKeys;
use ademan::device::{
    DeviceInput, DeviceOutput, EventKind, Events, KeyAction, KeyArbiter, KeyCode, TimedCommands,
    VirtualDevice,
};
use ademan::estimate::JointAngles;
use ademan::files::Load;
use ademan::hand::{Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::layout::{Key, Layout};
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

    /// Returns the center of the key that types a character.
    fn center(&self, character: char) -> Vec2 {
        let mut codes = KeyCode::for_us_character(character);
        let center = codes.find_map(|(code, _)| self.key(code));
        center.expect("a key")
    }

    /// Returns the center of a key on its board.
    fn key(&self, code: KeyCode) -> Option<Vec2> {
        let has_code = |key: &&Key| match key.action(0) {
            Some(KeyAction::Key(own) | KeyAction::Modifier(own, _)) => own == code,
            _ => false,
        };
        let key = self.layout.keys.iter().find(has_code)?;
        Some(key.face.outline.center)
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

/// A person in front of the board, with a text decoder and a text field.
struct Desk {
    typist: Typist,
    filter: Option<Box<dyn PressFilter>>,
    devices: Vec<Box<dyn VirtualDevice>>,
    arbiter: KeyArbiter,
    held: PressedKeys,
    field: UsTextField,
}

impl Desk {
    fn new(mode: Option<TextMode>, seed: u64) -> Self {
        let typist = Typist::new(seed);
        let language =
            Language::load("en", |_| Err(String::new())).expect("it comes with the program");
        let filter = mode.and_then(|mode| language.filter(&typist.layout, mode, false, false));
        assert_eq!(filter.is_some(), mode.is_some());
        Self {
            filter,
            devices: typist.layout.devices(),
            arbiter: KeyArbiter::new(typist.layout.texts.clone()),
            held: PressedKeys::default(),
            field: UsTextField::new(),
            typist,
        }
    }

    /// Taps a point of the board.
    fn tap(&mut self, at: Vec2) {
        for height in [12, 6, 1, -3, -4, -3, 1, 6, 12, 12] {
            self.step(at, height as f32 * 1e-3);
        }
    }

    /// Taps beside the center of the key of a character.
    fn tap_beside(&mut self, character: char, [right_mm, up_mm]: [f32; 2]) {
        let at = self.typist.center(character) + Vec2::new(right_mm, up_mm) * 1e-3;
        self.tap(at);
    }

    fn tap_shift(&mut self) {
        let shift = self.typist.key(KeyCode::SHIFT_LEFT);
        self.tap(shift.expect("a key"));
    }

    /// Taps the centers of keys.
    fn types(&mut self, text: &str) {
        for character in text.chars() {
            self.tap(self.typist.center(character));
        }
    }

    fn step(&mut self, at: Vec2, height: f32) {
        let pose = self.typist.pose(at, height);
        let (mut touches, mut presses) = (Touches::new(), Presses::new());
        let scene = &self.typist.layout.scene;
        self.typist.tracker.update(scene, &pose, &mut touches);
        self.typist
            .tracker
            .add_presses(scene, &touches, &mut presses);
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
            arbiter: &mut self.arbiter,
            events: &mut events,
            commands: &mut TimedCommands::new(),
        };
        for device in &mut self.devices {
            device.update(&input, &mut output);
        }
        let emitted = events.clone();
        if let Some(filter) = &mut self.filter {
            let filter_input = FilterInput {
                time: pose.time,
                side: pose.side,
                may_type: true,
                presses: &presses,
                held: &self.held,
                contact: Some((&pose, scene)),
            };
            filter.filter(&filter_input, &mut events);
        }
        for event in &emitted {
            match event.kind {
                EventKind::KeyDown(key) => _ = self.held.press(key),
                EventKind::KeyUp(key) => _ = self.held.release(key),
                _ => {}
            }
        }
        events.iter().for_each(|event| self.field.handle(event));
    }

    /// Returns the text, and starts another one.
    fn take_text(&mut self) -> String {
        if let Some(filter) = &mut self.filter {
            filter.reset();
        }
        std::mem::take(&mut self.field).text().to_owned()
    }
}

/// Types the phrases with a scatter in metres, and returns the wrong characters.
fn wrong(mode: Option<TextMode>, scatter: f32, seed: u64) -> usize {
    let mut desk = Desk::new(mode, seed);
    let mut total = 0;
    for phrase in PHRASES {
        for character in phrase.chars() {
            let typist = &mut desk.typist;
            let scattered = Vec2::new(typist.normal(), typist.normal()) * scatter;
            desk.tap(desk.typist.center(character) + scattered);
        }
        total += distance(&desk.take_text().to_lowercase(), phrase);
    }
    total
}

#[test]
fn the_key_that_ends_a_word_is_corrected_with_it() {
    let mut desk = Desk::new(Some(TextMode::Auto), 1);
    // A period that hit the key beside it.
    desk.types("not upon my wprds");
    desk.tap_beside('/', [-9.0, 0.0]);
    desk.types(" ");
    assert_eq!(desk.take_text(), "not upon my words. ");
    // One Backspace brings back what was typed, with the slash.
    desk.types("not upon my wprds");
    desk.tap_beside('/', [-9.0, 0.0]);
    assert_eq!(desk.field.text(), "not upon my words.");
    desk.tap(desk.typist.key(KeyCode::BACKSPACE).expect("a key"));
    assert_eq!(desk.take_text(), "not upon my wprds/");
    // An `m` that hit the comma.
    desk.types("this is for ");
    desk.tap_beside(',', [-9.0, 0.0]);
    desk.types("e ");
    assert_eq!(desk.take_text(), "this is for me ");
}

#[test]
fn a_question_mark_ends_a_word_and_its_slips_are_corrected() {
    let mut desk = Desk::new(Some(TextMode::Auto), 1);
    for [right, up] in [[0.0; 2], [-10.0, 0.0]] {
        desk.types("is this the wrold");
        desk.tap_shift();
        desk.tap_beside('/', [right, up]);
        desk.types(" ");
        assert_eq!(desk.take_text(), "is this the world? ");
    }
    // What is typed in the middle of its key stays.
    desk.types("2");
    desk.tap_shift();
    desk.types("+2 ");
    assert_eq!(desk.take_text(), "2+2 ");
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
