//! The engine: whatever comes in, in whatever order and at whatever times, the invariants hold.

use std::sync::LazyLock;

use ademan::capture::{Channels, Hc11Format, Reading, Sample, Source, SourceEvent};
use ademan::device::{EventKind, Events};
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, OtherHand, ProfileSetup, Setup};
use ademan::time::Timestamp;
use parry3d::math::Vec3;

use super::support::checked::CheckedPipeline;

/// What happened in a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ran {
    /// Readings and commands.
    pub steps: u64,
    /// Readings that became a pose.
    pub accepted: u64,
    /// Keys and buttons that went down.
    pub presses: u64,
    /// What went out but those.
    pub other_events: u64,
    /// Times that something was let go of by anything but the hand.
    pub forced: u64,
    /// Times that it began to run.
    pub armed: u64,
}

impl Ran {
    /// Adds what happened in another run.
    pub fn add(&mut self, other: Self) {
        self.steps += other.steps;
        self.accepted += other.accepted;
        self.presses += other.presses;
        self.other_events += other.other_events;
        self.forced += other.forced;
        self.armed += other.armed;
    }
}

/// A setup with the movements of a hand that plays its first layout.
struct World {
    assembly: LoadedSetup,
    movements: Vec<Channels>,
}

/// Layouts of different kinds, scripts that play the first of them, and whether there are two hands.
struct Plan {
    layouts: &'static [&'static str],
    script: &'static str,
    has_two_hands: bool,
    armed: bool,
}

macro_rules! script {
    ($name:literal) => {
        include_str!(concat!("../../examples/scripts/", $name, ".txt"))
    };
}

const PLANS: [Plan; 8] = [
    Plan {
        layouts: &["qwerty-flat", "numpad", "space"],
        script: "press H; wait 40; slide 19 0; lift; tap J; tap ShiftLeft; tap Space",
        has_two_hands: false,
        armed: false,
    },
    Plan {
        layouts: &["arrows", "chords-five"],
        script: script!("arrows"),
        has_two_hands: false,
        armed: true,
    },
    Plan {
        layouts: &["media", "qwerty-flat"],
        script: script!("media"),
        has_two_hands: false,
        armed: false,
    },
    Plan {
        layouts: &["game", "workshop", "joint"],
        script: script!("game"),
        has_two_hands: false,
        armed: false,
    },
    Plan {
        layouts: &["switches", "touch-pad"],
        script: script!("switches"),
        has_two_hands: false,
        armed: true,
    },
    Plan {
        layouts: &["joint", "rate", "direct"],
        script: script!("joint"),
        has_two_hands: false,
        armed: false,
    },
    Plan {
        layouts: &["space", "ray"],
        script: script!("space"),
        has_two_hands: false,
        armed: true,
    },
    Plan {
        layouts: &["qwerty-two-flat", "qwerty-two-arc"],
        script: "tap J; press K; wait 60; lift; tap N",
        has_two_hands: true,
        armed: false,
    },
];

static WORLDS: LazyLock<Vec<World>> = LazyLock::new(|| PLANS.iter().map(World::new).collect());

/// Layouts that take the place of others.
static OTHERS: LazyLock<Vec<Layout>> = LazyLock::new(|| {
    let names = ["arrows", "workshop", "direct", "space", "dvorak-flat"];
    let load = |name| Layout::load(name).expect("a shipped layout");
    names.map(load).into()
});

impl World {
    fn new(plan: &Plan) -> Self {
        let further = plan.layouts[1..].iter().map(|layout| ProfileSetup {
            name: (*layout).into(),
            layout: (*layout).into(),
        });
        let setup = Setup {
            layout: plan.layouts[0].into(),
            profiles: further.collect(),
            other_hand: plan.has_two_hands.then(OtherHand::default),
            arm_immediately: plan.armed,
            ..Setup::default()
        };
        let assembly = setup.load_files().expect("shipped files");
        let hand = assembly.scripted(plan.script, &Hc11Format::default(), 0.0, 0);
        let mut hand = hand.unwrap_or_else(|error| panic!("{error}"));
        let mut movements = Vec::new();
        let mut last = None;
        while let Ok(SourceEvent::Reading(reading)) = hand.next() {
            // The hand comes to a movement a second; the rest is waiting.
            let Sample::Channels(channels) = reading.sample else {
                continue;
            };
            let is_first = reading.side != Some(Side::Left);
            if is_first && last.as_ref() != Some(&channels) {
                last = Some(channels.clone());
                movements.push(channels);
            }
        }
        assert!(movements.len() > 20, "{}", plan.script);
        Self {
            assembly,
            movements,
        }
    }
}

/// Takes bytes one by one; zeros when they are over.
struct Bytes<'a>(std::slice::Iter<'a, u8>);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    fn word(&mut self) -> u16 {
        u16::from_le_bytes([self.byte(), self.byte()])
    }

    fn float(&mut self) -> f32 {
        match self.byte() {
            0 => f32::NAN,
            1 => f32::INFINITY,
            2 => f32::MIN,
            3 => f32::MIN_POSITIVE,
            4 => 1e9,
            other => (f32::from(other) - 130.0) / 5000.0,
        }
    }
}

/// Between two readings, in microseconds; below 0 the clock goes back.
const STEPS: [i64; 11] = [
    0, 1, 1_000, 5_729, 10_000, 50_000, 199_999, 200_000, 200_001, 300_000, 1_000_000,
];

/// The same where a clock is set or broken; few readings come after them.
const LEAPS: [i64; 6] = [
    -1,
    -10_000,
    -1_000_000,
    -3_600_000_000,
    3_600_000_000,
    i64::MAX,
];

struct Play<'a> {
    world: &'a World,
    engine: CheckedPipeline,
    events: Events,
    time: u64,
    place: usize,
    is_backwards: bool,
    side: Option<Side>,
    /// What a broken wire adds.
    fault: Option<(usize, u16)>,
    ran: Ran,
    state: PipelineState,
}

/// The first byte says which setup; each of the others is an order or belongs to one.
pub fn engine(data: &[u8]) -> Ran {
    let mut bytes = Bytes(data.iter());
    let world = &WORLDS[usize::from(bytes.byte()) % WORLDS.len()];
    let mut play = Play {
        world,
        engine: CheckedPipeline::new(&world.assembly),
        events: Events::new(),
        time: 0,
        place: 0,
        is_backwards: false,
        side: world.assembly.other_hand.is_some().then_some(Side::Right),
        fault: None,
        ran: Ran::default(),
        state: PipelineState::Starting,
    };
    while let Some(&order) = bytes.0.next() {
        play.obey(order, &mut bytes);
    }
    play.ask(CheckedPipeline::stop);
    assert!(
        !play.engine.has_pressed(),
        "something is down after the end"
    );
    play.ran.accepted = play.engine.accepted();
    play.ran
}

impl Play<'_> {
    fn obey(&mut self, order: u8, bytes: &mut Bytes) {
        match order {
            0..=183 => {
                self.fault = None;
                (0..=order / 8).for_each(|_| self.read_next(10_000));
            }
            184..=207 => self.rest(),
            208..=215 => {
                let place = usize::from(bytes.byte());
                let steps = if place < 250 { &STEPS[..] } else { &LEAPS };
                self.read_next(steps[place % steps.len()]);
            }
            216..=219 => self.place = usize::from(bytes.word()),
            220..=222 => self.is_backwards = !self.is_backwards,
            223..=225 => {
                self.fault = Some((usize::from(bytes.byte()), bytes.word()));
                (0..bytes.byte() % 32).for_each(|_| self.read_next(10_000));
            }
            226..=227 => self.read_anything(bytes),
            228..=231 => self.side = Side::ALL.get(usize::from(bytes.byte()) % 3).copied(),
            232 => self.ask(CheckedPipeline::stall),
            233 => self.ask(CheckedPipeline::pause),
            234..=238 => {
                self.engine.resume();
                self.ran.steps += 1;
            }
            239 => self.replace(bytes),
            240..=241 => {
                let profile = usize::from(bytes.byte()) % 5;
                self.ask(|engine, events| engine.switch_profile(profile, events));
            }
            242..=244 => {
                let by = Vec3::new(bytes.float(), bytes.float(), bytes.float());
                self.ask(|engine, events| {
                    let _ = engine.nudge(by, events);
                });
            }
            245..=247 => {
                let by = bytes.float();
                self.ask(|engine, events| {
                    let _ = engine.tilt(by, events);
                });
            }
            248..=250 => self.ask(|engine, events| {
                let _ = engine.recenter(events);
            }),
            251 if bytes.byte() < 4 => self.ask(CheckedPipeline::stop),
            _ => self.read_next(5_729),
        }
    }

    /// Stays where the hand was at the very first, for long enough to arm.
    fn rest(&mut self) {
        self.place = 0;
        let resting = self.world.movements[0].clone();
        (0..35).for_each(|_| self.read(resting.clone(), 10_000));
    }

    fn read_next(&mut self, step: i64) {
        let movements = &self.world.movements;
        let length = movements.len();
        self.place = match self.is_backwards {
            true => (self.place + length - 1) % length,
            false => (self.place + 1) % length,
        };
        let mut channels = movements[self.place].clone();
        if let Some((channel, count)) = self.fault {
            let channel = channel % channels.counts.len();
            channels.counts[channel] = count;
        }
        self.read(channels, step);
    }

    fn read_anything(&mut self, bytes: &mut Bytes) {
        let full_scale = if bytes.byte() < 200 {
            255
        } else {
            bytes.word()
        };
        let length = usize::from(bytes.byte()) % 65;
        let counts = (0..length).map(|_| bytes.word());
        let counts = counts.collect();
        self.read(Channels { full_scale, counts }, 10_000);
    }

    fn read(&mut self, channels: Channels, step: i64) {
        self.time = self.time.saturating_add_signed(step);
        let reading = Reading {
            time: Timestamp(self.time),
            side: self.side,
            sample: Sample::Channels(channels),
        };
        self.events.clear();
        let _ = self.engine.step(&reading, &mut self.events);
        self.count(false);
    }

    fn replace(&mut self, bytes: &mut Bytes) {
        let place = usize::from(bytes.byte()) % 4;
        let layout = &OTHERS[usize::from(bytes.byte()) % OTHERS.len()];
        let controls = self.world.assembly.layout_instance(layout);
        let mut controls = controls.expect("it names no other layout");
        if bytes.byte() < 128 {
            self.engine.keep_board_poses(place, &mut controls);
        }
        if place < self.engine.profile_count() {
            self.ask(|engine, events| engine.replace_profile(place, &mut controls, layout, events));
        }
    }

    fn ask(&mut self, ask: impl FnOnce(&mut CheckedPipeline, &mut Events)) {
        self.events.clear();
        ask(&mut self.engine, &mut self.events);
        self.count(true);
    }

    fn count(&mut self, is_command: bool) {
        let ran = &mut self.ran;
        ran.steps += 1;
        for event in &self.events {
            match event.kind {
                EventKind::KeyDown(_) => ran.presses += 1,
                EventKind::KeyUp(_) if is_command => ran.forced += 1,
                EventKind::KeyUp(_) => {}
                _ => ran.other_events += 1,
            }
        }
        let state = self.engine.state();
        ran.armed +=
            u64::from(self.state != PipelineState::Running && state == PipelineState::Running);
        self.state = state;
    }
}
