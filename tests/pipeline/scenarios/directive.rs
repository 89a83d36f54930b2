//! Orders about what happens to a run while the hand plays.
//!
//! | order | what happens |
//! |---|---|
//! | `play MS` | the hand continues for this time with whatever comes next |
//! | `hold MS` | the hand keeps still, and its glove continues sending |
//! | `silent MS` | the hand keeps still, and its glove sends nothing |
//! | `drop MS` | the hand continues, and its packets are lost |
//! | `unplug MS` | the cable is pulled, and plugged in again after this time; the hand keeps still |
//! | `noise BYTES` | random bytes arrive |
//! | `text WORDS` | a line of text arrives, as of a device that restarts |
//! | `flip BYTE` | one bit is wrong in this byte of the next packet, of 66 |
//! | `truncate BYTES` | the next packet lacks these bytes at its end |
//! | `skip BYTES` | the next packet lacks these bytes at its start |
//! | `duplicate` | the next packet arrives twice |
//! | `offset COUNTS` | from now on the elbow reads this many counts more |
//! | `rail FINGER COUNT` | from now on the sensors of a finger read this |
//! | `repair` | all sensors read what they should |
//! | `clock SECONDS` | the time stamps jump, back when negative |
//! | `swap` | from now on the readings of one hand have the label of the other |
//! | `pause`, `resume`, `stop` | a command to the pipeline |
//! | `reload LAYOUT` | the file of the first layout is saved with this content; `(refused)` when it is invalid |
//! | `profile INDEX` | another layout of the setup becomes active |
//! | `nudge X Y Z`, `tilt DEG`, `recenter` | the boards are moved, in mm; `(refused)` when they cannot |

use std::str::FromStr;

use ademan::hand::Finger;

/// An order about what happens to a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Directive {
    Play(u64),
    Hold(u64),
    Silent(u64),
    Drop(u64),
    Unplug(u64),
    Noise(usize),
    Text(String),
    Flip(usize),
    Truncate(usize),
    Skip(usize),
    Duplicate,
    Offset(i32),
    Rail(Finger, u8),
    Repair,
    Clock(i64),
    Swap,
    Pause,
    Resume,
    Stop,
    Reload(String),
    Profile(usize),
    Nudge([f32; 3]),
    Tilt(f32),
    Recenter,
}

impl Directive {
    /// Parses an order; `None` if it is one of the simulated hand.
    pub fn parse(text: &str) -> Option<Self> {
        let mut words = text.split_whitespace();
        let directive = match words.next()? {
            "play" => Self::Play(argument(&mut words)),
            "hold" => Self::Hold(argument(&mut words)),
            "silent" => Self::Silent(argument(&mut words)),
            "drop" => Self::Drop(argument(&mut words)),
            "unplug" => Self::Unplug(argument(&mut words)),
            "noise" => Self::Noise(argument(&mut words)),
            "text" => Self::Text(words.by_ref().collect::<Vec<_>>().join(" ")),
            "flip" => Self::Flip(argument(&mut words)),
            "truncate" => Self::Truncate(argument(&mut words)),
            "skip" => Self::Skip(argument(&mut words)),
            "duplicate" => Self::Duplicate,
            "offset" => Self::Offset(argument(&mut words)),
            "rail" => Self::Rail(argument(&mut words), argument(&mut words)),
            "repair" => Self::Repair,
            "clock" => Self::Clock(argument(&mut words)),
            "swap" => Self::Swap,
            "pause" => Self::Pause,
            "resume" => Self::Resume,
            "stop" => Self::Stop,
            "reload" => Self::Reload(argument(&mut words)),
            "profile" => Self::Profile(argument(&mut words)),
            "nudge" => Self::Nudge([(); 3].map(|()| argument(&mut words))),
            "tilt" => Self::Tilt(argument(&mut words)),
            "recenter" => Self::Recenter,
            _ => return None,
        };
        assert_eq!(words.next(), None, "`{text}` has a word too many");
        Some(directive)
    }
}

fn argument<'a, T: FromStr>(words: &mut impl Iterator<Item = &'a str>) -> T {
    let word = words.next().expect("an argument is missing");
    word.parse()
        .unwrap_or_else(|_| panic!("`{word}` is not a valid argument"))
}
