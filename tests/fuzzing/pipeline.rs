//! The pipeline: for any readings and commands, in any order and at any times, the invariants hold.

use std::sync::LazyLock;

use ademan::capture::{Channels, Hc11Format, Reading, Sample, Source, SourceEvent};
use ademan::command::{Command, CommandOrigin, TextMode};
use ademan::device::{EventKind, Events};
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, OtherHand, ProfileSetup, Setup};
use ademan::text::{TextModeSchema, TextSetup};
use ademan::time::Timestamp;
use parry3d::math::Vec3;

use super::support::checked::CheckedPipeline;

/// Statistics of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunStats {
    /// Readings and commands.
    pub steps: u64,
    /// Accepted readings.
    pub accepted: u64,
    /// Presses of keys and buttons.
    pub presses: u64,
    /// Events other than presses and releases.
    pub other_events: u64,
    /// Releases by commands.
    pub forced: u64,
    /// The number of times that output was armed.
    pub armed: u64,
}

impl RunStats {
    /// Adds the statistics of another run.
    pub fn add(&mut self, other: Self) {
        self.steps += other.steps;
        self.accepted += other.accepted;
        self.presses += other.presses;
        self.other_events += other.other_events;
        self.forced += other.forced;
        self.armed += other.armed;
    }
}

/// A setup and the movements of a hand on its first layout.
struct FuzzSetup {
    loaded: LoadedSetup,
    movements: Vec<Channels>,
}

/// The layouts of a setup and a script for the first of them.
struct Plan {
    layouts: &'static [&'static str],
    /// The text of a layout that takes the place of the first one.
    text: Option<&'static str>,
    script: &'static str,
    has_two_hands: bool,
    armed: bool,
}

macro_rules! script {
    ($name:literal) => {
        include_str!(concat!("../../examples/scripts/", $name, ".txt"))
    };
}

/// Switches and keys whose keys together act on the system.
const SYSTEM_CHORDS: &str = include_str!("../scenarios/system-chords.ron");

/// Keys that start sequences.
const SEQUENCES: &str = include_str!("../scenarios/sequences.ron");

const PLANS: [Plan; 10] = [
    Plan {
        layouts: &["qwerty-flat", "numpad", "space"],
        text: None,
        script: "press H; wait 40; slide 19 0; lift; tap J; tap ShiftLeft; tap Space",
        has_two_hands: false,
        armed: false,
    },
    Plan {
        layouts: &["arrows", "chords-bend"],
        text: None,
        script: script!("arrows"),
        has_two_hands: false,
        armed: true,
    },
    Plan {
        layouts: &["media", "qwerty-flat"],
        text: None,
        script: script!("media"),
        has_two_hands: false,
        armed: false,
    },
    Plan {
        layouts: &["game", "workshop", "joint"],
        text: None,
        script: script!("game"),
        has_two_hands: false,
        armed: false,
    },
    Plan {
        layouts: &["switches", "touch-pad"],
        text: None,
        script: script!("switches"),
        has_two_hands: false,
        armed: true,
    },
    Plan {
        layouts: &["joint", "rate", "direct"],
        text: None,
        script: script!("joint"),
        has_two_hands: false,
        armed: false,
    },
    Plan {
        layouts: &["space", "ray"],
        text: None,
        script: script!("space"),
        has_two_hands: false,
        armed: true,
    },
    Plan {
        layouts: &["arrows", "qwerty-flat"],
        text: Some(SYSTEM_CHORDS),
        script: "tap Delete; tap Control; tap Alt; tap F2; tap ControlRight; tap AltRight; tap Delete; tap Backspace; \
                 tap Alt; tap Control; press AltLeft; lift; tap Delete; press NumpadDecimal; lift",
        has_two_hands: false,
        armed: true,
    },
    Plan {
        layouts: &["qwerty-two-flat", "qwerty-two-arc"],
        text: None,
        script: "tap J; press K; wait 60; lift; tap N",
        has_two_hands: true,
        armed: false,
    },
    Plan {
        layouts: &["arrows", "qwerty-flat"],
        text: Some(SEQUENCES),
        script: "tap sign; tap later; tap Q; tap copy; press copy; wait 40; lift; tap ctrl; tap copy; tap shift; tap reset; \
                 tap later; tap write; press later; wait 900; lift; tap nearer; tap later; tap pause; tap copy; tap pause",
        has_two_hands: false,
        armed: true,
    },
];

static SETUPS: LazyLock<Vec<FuzzSetup>> =
    LazyLock::new(|| PLANS.iter().map(FuzzSetup::new).collect());

/// The layouts that replace others.
static REPLACEMENTS: LazyLock<Vec<Layout>> = LazyLock::new(|| {
    let names = ["arrows", "workshop", "direct", "space", "dvorak-flat"];
    let load = |name| Layout::load(name).expect("a shipped layout");
    names.map(load).into()
});

impl FuzzSetup {
    fn new(plan: &Plan) -> Self {
        let further = plan.layouts[1..].iter().map(|layout| ProfileSetup {
            name: (*layout).into(),
            text: None,
            layout: (*layout).into(),
        });
        let setup = Setup {
            layout: plan.layouts[0].into(),
            profiles: further.collect(),
            other_hand: plan.has_two_hands.then(OtherHand::default),
            arm_immediately: plan.armed,
            // The decoder of a layout without letters is none.
            text: Some(TextSetup {
                mode: Some(TextModeSchema::Auto),
                ..TextSetup::default()
            }),
            ..Setup::default()
        };
        let mut loaded = setup.load_files().expect("shipped files");
        if let Some(text) = plan.text {
            loaded.layout = Layout::parse(text, "text.ron").expect("a valid layout");
        }
        let hand = loaded.scripted(plan.script, &Hc11Format::default(), 0.0, 0);
        let mut hand = hand.unwrap_or_else(|error| panic!("{error}"));
        let mut movements = Vec::new();
        let mut last = None;
        while let Ok(SourceEvent::Reading(reading)) = hand.next() {
            // The hand waits most of the time; repeated postures are left out.
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
        Self { loaded, movements }
    }
}

/// The bytes of an input, followed by zeros.
struct Bytes<'a>(std::slice::Iter<'a, u8>);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    fn word(&mut self) -> u16 {
        u16::from_le_bytes([self.byte(), self.byte()])
    }

    fn origin(&mut self) -> CommandOrigin {
        CommandOrigin::ALL[usize::from(self.byte()) % CommandOrigin::COUNT]
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

/// Times between two readings in microseconds; negative if the clock is set back.
const STEPS: [i64; 11] = [
    0, 1, 1_000, 5_729, 10_000, 50_000, 199_999, 200_000, 200_001, 300_000, 1_000_000,
];

/// Times between two readings when the clock is set or broken; few readings follow.
const LEAPS: [i64; 6] = [
    -1,
    -10_000,
    -1_000_000,
    -3_600_000_000,
    3_600_000_000,
    i64::MAX,
];

struct FuzzRun<'a> {
    setup: &'a FuzzSetup,
    pipeline: CheckedPipeline,
    events: Events,
    time: u64,
    index: usize,
    moves_backwards: bool,
    side: Option<Side>,
    /// A broken sensor: its channel and count.
    fault: Option<(usize, u16)>,
    stats: RunStats,
    state: PipelineState,
}

/// Runs an input. The first byte selects the setup; each following byte is an order or an argument.
pub fn pipeline(data: &[u8]) -> RunStats {
    let mut bytes = Bytes(data.iter());
    let setup = &SETUPS[usize::from(bytes.byte()) % SETUPS.len()];
    let mut run = FuzzRun {
        setup,
        pipeline: CheckedPipeline::new(&setup.loaded),
        events: Events::new(),
        time: 0,
        index: 0,
        moves_backwards: false,
        side: setup.loaded.other_hand.is_some().then_some(Side::Right),
        fault: None,
        stats: RunStats::default(),
        state: PipelineState::Starting,
    };
    while let Some(&order) = bytes.0.next() {
        run.apply(order, &mut bytes);
    }
    run.command(CheckedPipeline::stop);
    assert!(
        !run.pipeline.has_pressed(),
        "a key stays pressed after the end"
    );
    run.stats.accepted = run.pipeline.accepted();
    run.stats
}

impl FuzzRun<'_> {
    fn apply(&mut self, order: u8, bytes: &mut Bytes) {
        match order {
            0..=183 => {
                self.fault = None;
                (0..=order / 8).for_each(|_| self.read_next(10_000));
            }
            184..=207 => self.rest(),
            208..=215 => {
                let index = usize::from(bytes.byte());
                let steps = if index < 250 { &STEPS[..] } else { &LEAPS };
                self.read_next(steps[index % steps.len()]);
            }
            216..=219 => self.index = usize::from(bytes.word()),
            220..=222 => self.moves_backwards = !self.moves_backwards,
            223..=225 => {
                self.fault = Some((usize::from(bytes.byte()), bytes.word()));
                (0..bytes.byte() % 32).for_each(|_| self.read_next(10_000));
            }
            226..=227 => self.read_anything(bytes),
            228..=231 => self.side = Side::ALL.get(usize::from(bytes.byte()) % 3).copied(),
            232 => self.command(CheckedPipeline::stall),
            233 => {
                let origin = bytes.origin();
                self.command(|pipeline, events| pipeline.pause(origin, events));
            }
            234..=238 => {
                self.pipeline.resume(bytes.origin());
                self.stats.steps += 1;
            }
            239 => self.replace(bytes),
            240..=241 => {
                let profile = usize::from(bytes.byte()) % 5;
                self.command(|pipeline, events| pipeline.switch_profile(profile, events));
            }
            242..=244 => {
                let by = Vec3::new(bytes.float(), bytes.float(), bytes.float());
                self.command(|pipeline, events| {
                    let _ = pipeline.nudge(by, events);
                });
            }
            245..=247 => {
                let by = bytes.float();
                self.command(|pipeline, events| {
                    let _ = pipeline.tilt(by, events);
                });
            }
            248..=249 => self.command(|pipeline, events| {
                let _ = pipeline.recenter(events);
            }),
            250 => self.command(|pipeline, events| {
                let _ = pipeline
                    .zero(events)
                    .or_else(|_| pipeline.undo_zero(events))
                    .or_else(|_| pipeline.undo_learning(events));
            }),
            252 => {
                let mode = TextMode::ALL[usize::from(bytes.byte()) % TextMode::COUNT];
                let number = 1 + bytes.byte() % 3;
                let command = match bytes.byte() {
                    0..64 => Command::Text { mode },
                    _ => Command::Candidate { number },
                };
                self.command(|pipeline, events| {
                    let _ = pipeline.execute(&command, CommandOrigin::Client, events);
                });
            }
            251 if bytes.byte() < 4 => self.command(CheckedPipeline::stop),
            _ => self.read_next(5_729),
        }
    }

    /// Holds the first posture long enough to arm.
    fn rest(&mut self) {
        self.index = 0;
        let resting = self.setup.movements[0].clone();
        (0..35).for_each(|_| self.read(resting.clone(), 10_000));
    }

    fn read_next(&mut self, step: i64) {
        let movements = &self.setup.movements;
        let length = movements.len();
        self.index = if self.moves_backwards {
            (self.index + length - 1) % length
        } else {
            (self.index + 1) % length
        };
        let mut channels = movements[self.index].clone();
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
        self.read(
            Channels {
                full_scale,
                counts,
                unsent: Default::default(),
            },
            10_000,
        );
    }

    fn read(&mut self, channels: Channels, step: i64) {
        self.time = self.time.saturating_add_signed(step);
        let reading = Reading::new(Timestamp(self.time), self.side, Sample::Channels(channels));
        self.events.clear();
        let _ = self.pipeline.step(&reading, &mut self.events);
        self.count(false);
    }

    fn replace(&mut self, bytes: &mut Bytes) {
        let index = usize::from(bytes.byte()) % 4;
        let layout = &REPLACEMENTS[usize::from(bytes.byte()) % REPLACEMENTS.len()];
        let controls = self.setup.loaded.layout_instance(layout);
        let mut controls = controls.expect("it names no other layout");
        if bytes.byte() < 128 {
            self.pipeline.keep_board_poses(index, &mut controls);
        }
        if index < self.pipeline.profile_count() {
            self.command(|pipeline, events| {
                pipeline.replace_profile(index, &mut controls, layout, events)
            });
        }
    }

    fn command(&mut self, command: impl FnOnce(&mut CheckedPipeline, &mut Events)) {
        self.events.clear();
        command(&mut self.pipeline, &mut self.events);
        self.count(true);
    }

    fn count(&mut self, is_command: bool) {
        let stats = &mut self.stats;
        stats.steps += 1;
        for event in &self.events {
            match event.kind {
                EventKind::KeyDown(_) => stats.presses += 1,
                EventKind::KeyUp(_) if is_command => stats.forced += 1,
                EventKind::KeyUp(_) => {}
                _ => stats.other_events += 1,
            }
        }
        let state = self.pipeline.state();
        stats.armed +=
            u64::from(self.state != PipelineState::Running && state == PipelineState::Running);
        self.state = state;
    }
}
