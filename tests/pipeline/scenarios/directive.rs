//! Words about a run: what happens to it while the hand plays.
//!
//! | word | what happens |
//! |---|---|
//! | `play MS` | the hand goes on for so long, with whatever comes next |
//! | `still MS` | the hand keeps still, and its glove goes on sending |
//! | `stall MS` | the hand keeps still and the line is silent |
//! | `miss MS` | the hand goes on while the line is silent |
//! | `lose MS` | the cable is pulled, and back after so long; the hand keeps still |
//! | `junk BYTES` | so many bytes come that mean nothing |
//! | `text WORDS` | a line of text comes, as of a device that starts anew |
//! | `flip BYTE` | the next packet has one bit wrong, in this byte of its 66 |
//! | `cut BYTES` | the next packet lacks so many bytes at its end |
//! | `drop BYTES` | the next packet lacks so many bytes at its begin |
//! | `twice` | the next packet comes twice |
//! | `jump COUNTS` | from now on the elbow reads so many counts more |
//! | `rail FINGER COUNT` | from now on a finger's sensors read this |
//! | `mend` | the sensors read what they should |
//! | `clock SECONDS` | the times of the readings jump, back when negative |
//! | `swap` | from now on the readings of one hand are told as those of the other |
//! | `pause`, `resume`, `stop` | somebody says so |
//! | `reload LAYOUT` | the file of the first layout is saved with this in it; `(refused)` when that is no use |
//! | `profile PLACE` | another layout of the setup is put in force |
//! | `nudge X Y Z`, `tilt DEG`, `recentre` | the boards are moved, in mm; `(refused)` when they cannot |

use std::str::FromStr;

use ademan::hand::Finger;

#[derive(Clone, Debug, PartialEq)]
pub enum Directive {
    Play(u64),
    Still(u64),
    Stall(u64),
    Miss(u64),
    Lose(u64),
    Junk(usize),
    Text(String),
    Flip(usize),
    Cut(usize),
    Drop(usize),
    Twice,
    Jump(i32),
    Rail(Finger, u8),
    Mend,
    Clock(i64),
    Swap,
    Pause,
    Resume,
    Stop,
    Reload(String),
    Profile(usize),
    Nudge([f32; 3]),
    Tilt(f32),
    Recentre,
}

impl Directive {
    /// The fault that these words name; `None` when they are an order of the hand.
    pub fn parse(text: &str) -> Option<Self> {
        let mut words = text.split_whitespace();
        let fault = match words.next()? {
            "play" => Self::Play(number(&mut words)),
            "still" => Self::Still(number(&mut words)),
            "stall" => Self::Stall(number(&mut words)),
            "miss" => Self::Miss(number(&mut words)),
            "lose" => Self::Lose(number(&mut words)),
            "junk" => Self::Junk(number(&mut words)),
            "text" => Self::Text(words.by_ref().collect::<Vec<_>>().join(" ")),
            "flip" => Self::Flip(number(&mut words)),
            "cut" => Self::Cut(number(&mut words)),
            "drop" => Self::Drop(number(&mut words)),
            "twice" => Self::Twice,
            "jump" => Self::Jump(number(&mut words)),
            "rail" => Self::Rail(number(&mut words), number(&mut words)),
            "mend" => Self::Mend,
            "clock" => Self::Clock(number(&mut words)),
            "swap" => Self::Swap,
            "pause" => Self::Pause,
            "resume" => Self::Resume,
            "stop" => Self::Stop,
            "reload" => Self::Reload(number(&mut words)),
            "profile" => Self::Profile(number(&mut words)),
            "nudge" => Self::Nudge([(); 3].map(|()| number(&mut words))),
            "tilt" => Self::Tilt(number(&mut words)),
            "recentre" => Self::Recentre,
            _ => return None,
        };
        assert_eq!(words.next(), None, "`{text}` has a word too many");
        Some(fault)
    }
}

fn number<'a, T: FromStr>(words: &mut impl Iterator<Item = &'a str>) -> T {
    let word = words.next().expect("a word is missing");
    word.parse()
        .unwrap_or_else(|_| panic!("`{word}` cannot be read"))
}
