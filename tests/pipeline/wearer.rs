//! A wearer of two gloves whose readings go through a pipeline.

use ademan::capture::{Channels, MAX_CHANNELS, Reading, Sample};
use ademan::device::{EventKind, Events};
use ademan::estimate::ChannelMap;
use ademan::hand::{Dof, HandPart, Side};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::TypingHand;
use ademan::time::Timestamp;

use crate::key_reach::KeyReach;
use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;

/// A wearer of two gloves, each of which sends a reading every 10 ms.
pub struct Wearer {
    pub loaded: LoadedSetup,
    pub pipeline: CheckedPipeline,
    pub time_ms: u64,
    /// The channels of each hand; `None` for a hand that sends nothing.
    pub shown: [Option<Channels>; Side::COUNT],
    transcript: Vec<String>,
}

impl Wearer {
    pub fn new(setup: Setup) -> Self {
        Self::of(setup.load_files().expect("a setup"))
    }

    /// Creates a wearer whose layout has this text.
    pub fn with_layout(text: &str, setup: Setup) -> Self {
        Self::of(load_layout(text, setup))
    }

    fn of(loaded: LoadedSetup) -> Self {
        Self {
            pipeline: CheckedPipeline::new(&loaded),
            loaded,
            time_ms: 0,
            shown: [None, None],
            transcript: Vec::new(),
        }
    }

    /// Moves the fingertip of a side above a key or switch of the active layout, or to the bottom of it.
    pub fn go(&mut self, side: Side, key: &str, is_down: bool) {
        self.shown[side.index()] = Some(self.posture(side, key, is_down));
    }

    fn posture(&self, side: Side, key: &str, is_down: bool) -> Channels {
        let (arm, map) = match &self.loaded.other_hand {
            Some(other) if other.glove.as_ref().expect("a glove").side == side => {
                (&other.arm, &other.glove.as_ref().expect("a glove").map)
            }
            _ => (
                &self.loaded.arm,
                &self.loaded.glove.as_ref().expect("a glove").map,
            ),
        };
        let layout = self.loaded.layouts().nth(self.pipeline.active_profile());
        let layout = layout.expect("a layout is active");
        let target = layout.target_names().find(key).expect("a control");
        let hand = TypingHand::new(arm, map);
        let reach = KeyReach::new(&hand, &layout.scene, target).expect("a place");
        let tip = if is_down {
            reach.bottom()
        } else {
            reach.hover()
        };
        let mut values = hand.rest_values();
        hand.reach(tip, &mut values, &[]);
        let angles = hand.angles(&values);
        channels(map, |dof| angles.get(dof))
    }

    /// Presses a key or switch and stays on it.
    pub fn press(&mut self, side: Side, key: &str) {
        self.go(side, key, false);
        self.hold_still(150);
        self.go(side, key, true);
        self.hold_still(150);
    }

    pub fn hold_still(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds / 10 {
            self.time_ms += 10;
            for side in [Side::Left, Side::Right] {
                let Some(shown) = self.shown[side.index()].clone() else {
                    continue;
                };
                let reading = Reading::new(
                    Timestamp(self.time_ms * 1_000),
                    self.loaded.other_hand.is_some().then_some(side),
                    Sample::Channels(shown),
                );
                let mut events = Events::new();
                if let Ok(step) = self.pipeline.step(&reading, &mut events) {
                    let commands = step.commands.iter();
                    let commands = commands.map(|issued| issued.command.to_string());
                    self.transcript.extend(commands);
                }
                self.write(&events);
            }
        }
    }

    pub fn tap(&mut self, side: Side, key: &str) {
        // Computed first, because the key may activate another layout.
        let postures = [false, true, false].map(|is_down| self.posture(side, key, is_down));
        for posture in postures {
            self.shown[side.index()] = Some(posture);
            self.hold_still(150);
        }
    }

    /// Loses the source of a hand, or of a part of it.
    pub fn lose(&mut self, side: Side, part: Option<HandPart>) {
        let mut events = Events::new();
        self.pipeline.lose(Some(side), part, &mut events);
        self.write(&events);
    }

    pub fn write(&mut self, events: &Events) {
        for event in events {
            self.transcript.push(match event.kind {
                EventKind::KeyDown(key) => format!("+{key}"),
                EventKind::KeyUp(key) => format!("-{key}"),
                EventKind::Character(character) => character.to_string(),
                EventKind::Value(..) => continue,
                other => panic!("{other:?} comes of no key"),
            });
        }
    }

    pub fn transcript(&mut self) -> String {
        std::mem::take(&mut self.transcript).join(" ")
    }
}

/// Returns the text of a board for each hand, with these controls. `SIDE` in them stands for the side of the hand.
pub fn boards_of_both_hands(controls: &str) -> String {
    let board = |side: Side, bearing: i32| {
        let own = controls.replace("SIDE", &side.to_string());
        format!(
            r#"(
            hand: "{side}",
            pose: (anchor: elbow, bearing_deg: {bearing}, forward_mm: 300, height_mm: -45),
            pitch_mm: 24, size_mm: Box(22, 20),
            {own},
        )"#
        )
    };
    let (left, right) = (board(Side::Left, -35), board(Side::Right, 35));
    format!("{left}, {right}")
}

/// Returns what a glove reads of these angles. Channels without a row are in the middle of their range.
pub fn channels(map: &ChannelMap, angle: impl Fn(Dof) -> f64) -> Channels {
    let full_scale = map.full_scale();
    let mut counts: arrayvec::ArrayVec<u16, MAX_CHANNELS> =
        (0..MAX_CHANNELS).map(|_| full_scale / 2).collect();
    for row in map.rows().iter().rev() {
        let exact = row.calibration.apply_inverse(angle(row.dof)).round();
        counts[row.channel] = exact.clamp(1.0, f64::from(full_scale - 1)) as u16;
    }
    Channels {
        full_scale,
        counts,
        unsent: Default::default(),
    }
}
