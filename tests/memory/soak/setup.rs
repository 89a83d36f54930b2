//! The movements of the hand on every layout of a setup.

use ademan::capture::Hc11Format;
use ademan::capture::hc11::BODY_BYTES;
use ademan::files::Load;
use ademan::layout::Layout;
use ademan::setup::{LoadedSetup, OtherHand, ProfileSetup, Setup};

pub type Body = [u8; BODY_BYTES];

/// Layouts and scripts. Each script begins and ends clear of all controls.
const PLAYS: [(&str, &[&str]); 4] = [
    (
        "qwerty-two-flat",
        &[
            "tap H; tap J; tap K; tap Space; tap Enter",
            "tap ShiftRight; tap U; press M; wait 300; lift; tap Backspace",
            "press J; wait 100; slide 19 0; lift; tap L; tap Comma",
        ],
    ),
    (
        "media",
        &[
            "tap MediaPlayPause; press Volume 15 0; arc 60; lift; tap Mute; tap Mute",
            "press Seek 0 0; slide 20 0; slide -20 0; lift; press Scroll; slide 10 0; lift",
        ],
    ),
    (
        "game",
        &[
            "press Stick; slide 12 0; slide -12 0; lift; tap PadSouth; bend ring 60 400; wait 200; bend ring -28 400",
        ],
    ),
    (
        "switches",
        &[
            "tap \"Shift lock\"; tap F; tap \"Shift lock\"; tap Eraser; tap Brush",
            "press F; wait 500; lift; push rest 0.3; wait 600; lift; tap ñandú",
            "press Screen -20 0; slide 30 10; lift; push Z 0.9; lift",
        ],
    ),
];

/// The layouts that replace the first one.
const REPLACEMENTS: [&str; 3] = ["qwerty-two-flat", "qwerty-two-arc", "qwerty-flat"];

pub struct SoakSetup {
    pub format: Hc11Format,
    pub loaded: LoadedSetup,
    /// The movements on each layout of the setup.
    pub movements: Vec<Vec<Vec<Body>>>,
    pub replacements: Vec<Layout>,
}

impl SoakSetup {
    pub fn new(format: Hc11Format) -> Self {
        let named = |(name, _): &(&str, _)| ProfileSetup {
            name: (*name).into(),
            text: None,
            layout: (*name).into(),
        };
        let setup = |layout: &str| Setup {
            layout: layout.into(),
            other_hand: Some(OtherHand::default()),
            ..Setup::default()
        };
        let movements = PLAYS.iter().map(|(layout, scripts)| {
            let loaded = setup(layout).load_files().expect("a shipped layout");
            let play = |script: &&str| packets(&loaded, &format, script);
            scripts.iter().map(play).collect()
        });
        let movements = movements.collect();
        let setup = Setup {
            profiles: PLAYS[1..].iter().map(named).collect(),
            ..setup(PLAYS[0].0)
        };
        let load = |name| Layout::load(name).expect("a shipped layout");
        Self {
            format,
            loaded: setup.load_files().expect("shipped layouts"),
            movements,
            replacements: REPLACEMENTS.map(load).into(),
        }
    }
}

/// Returns the packets of the first glove while its hand plays a script.
fn packets(loaded: &LoadedSetup, format: &Hc11Format, script: &str) -> Vec<Body> {
    let typist = loaded.scripted(script, format, 0.0, 0);
    let mut typist = typist.unwrap_or_else(|error| panic!("{script}: {error}"));
    let counts = std::iter::from_fn(|| typist.next_counts());
    let body = |glove_counts: ademan::sim::GloveCounts| {
        std::array::from_fn(|channel| glove_counts[channel].min(255) as u8)
    };
    counts.map(body).collect()
}
