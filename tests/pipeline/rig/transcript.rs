//! Events as words: the expected results of all scripts.

use std::collections::BTreeMap;

use ademan::contact::TargetNames;
use ademan::device::{EventKind, OutputEvent, TimedCommand};
use ademan::time::Timestamp;

/// The level of detail of a transcript.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// A word for each event, times in milliseconds with their fractions.
    Every,
    /// Continuous values as `FIRST..LAST` and relative motion as its sum, times in whole milliseconds.
    Summary,
}

/// Turns events into words.
///
/// | word | event |
/// |---|---|
/// | `dn:KEY`, `up:KEY` | a key or button is pressed, released |
/// | `write:TEXT` | characters are written |
/// | `move=X,Y`, `scroll=X,Y` | relative motion in pixels, wheel in 120ths of a detent |
/// | `place=X,Y` | absolute position of the pointer, 0..=1 of the screen |
/// | `axis:NAME=V`, `depth:NAME=V`, `value:NAME=V` | a gamepad axis, the depth of a key, the value of a control |
/// | `select:NAME`, `unselect:NAME` | a target in space |
/// | `command:NAME,FIELD,…` | a command to the session |
/// | `t:MSms` | time since the word before |
#[derive(Debug)]
pub struct Transcript {
    detail: Detail,
    words: Vec<String>,
    /// The time of the last word.
    time: Timestamp,
    /// Continuous values since the last word that ended them.
    ranges: Vec<(String, Range)>,
    sums: BTreeMap<&'static str, (i32, i32)>,
}

#[derive(Debug)]
struct Range {
    first: String,
    last: String,
}

impl Transcript {
    /// An empty transcript; the first time is counted from `start`.
    pub fn new(detail: Detail, start: Timestamp) -> Self {
        Self {
            detail,
            words: Vec::new(),
            time: start,
            ranges: Vec::new(),
            sums: BTreeMap::new(),
        }
    }

    /// Adds an event of a layout whose targets have these names.
    pub fn push(&mut self, event: &OutputEvent, names: &TargetNames) {
        let name = |target| names.get(target).to_string().replace(' ', "_");
        let time = event.time;
        match event.kind {
            EventKind::KeyDown(key) => self.word(time, format!("dn:{key}")),
            EventKind::KeyUp(key) => self.word(time, format!("up:{key}")),
            EventKind::Character(character) => self.character(time, character),
            EventKind::MoveBy(x, y) => self.motion(time, "move", x, y),
            EventKind::Scroll(x, y) => self.motion(time, "scroll", x, y),
            EventKind::MoveTo(x, y) => {
                let position = match self.detail {
                    Detail::Every => format!("{x:.4},{y:.4}"),
                    Detail::Summary => format!("{x:.2},{y:.2}"),
                };
                self.value(time, "place".into(), position);
            }
            EventKind::Axis(axis, value) => {
                let value = match self.detail {
                    Detail::Every => format!("{value:+.3}"),
                    Detail::Summary => two_decimals(value),
                };
                self.value(time, format!("axis:{axis}"), value);
            }
            EventKind::Depth(target, depth) => {
                let depth = self.decimals(depth);
                self.value(time, format!("depth:{}", name(target)), depth);
            }
            EventKind::Value(target, value) => {
                let value = self.decimals(value);
                self.value(time, format!("value:{}", name(target)), value);
            }
            EventKind::Velocity(target, velocity) => {
                let velocity = self.decimals(velocity);
                self.word(time, format!("velocity:{}={velocity}", name(target)));
            }
            EventKind::Select(target) => self.word(time, format!("select:{}", name(target))),
            EventKind::Unselect(target) => self.word(time, format!("unselect:{}", name(target))),
        }
    }

    /// Adds a command of a device.
    pub fn push_command(&mut self, issued: &TimedCommand) {
        let command = issued.command.to_string().replace(' ', ",");
        self.word(issued.time, format!("command:{command}"));
    }

    /// Adds a word that happens at a moment.
    pub fn word(&mut self, time: Timestamp, word: String) {
        self.end_ranges();
        self.advance(time);
        self.words.push(word);
    }

    /// Adds a word without a time of its own.
    pub fn note(&mut self, word: String) {
        self.end_ranges();
        self.words.push(word);
    }

    /// Removes and returns the words so far.
    pub fn take(&mut self) -> Vec<String> {
        self.end_ranges();
        std::mem::take(&mut self.words)
    }

    /// The words so far, with or without times.
    pub fn text(&self, has_times: bool) -> String {
        let words = self.words.iter().map(String::as_str);
        let words = words.filter(|word| has_times || !word.starts_with("t:"));
        words.collect::<Vec<_>>().join(" ")
    }

    fn advance(&mut self, time: Timestamp) {
        match self.detail {
            Detail::Every => {
                assert!(time >= self.time, "time goes back from {:?}", self.time);
                if time > self.time {
                    let milliseconds = time.since(self.time).as_micros() as f64 / 1_000.0;
                    self.words.push(format!("t:{milliseconds}ms"));
                }
            }
            Detail::Summary => {
                let milliseconds = (time.0 / 1_000).saturating_sub(self.time.0 / 1_000);
                if milliseconds > 0 {
                    self.words.push(format!("t:{milliseconds}ms"));
                }
            }
        }
        self.time = self.time.max(time);
    }

    /// In a summary the characters of one moment are one word.
    fn character(&mut self, time: Timestamp, character: char) {
        let is_text = |word: &&mut String| word.starts_with("write:");
        match self.words.last_mut().filter(is_text) {
            Some(word) if self.detail == Detail::Summary && time == self.time => {
                word.push(character);
            }
            _ => self.word(time, format!("write:{character}")),
        }
    }

    fn motion(&mut self, time: Timestamp, what: &'static str, x: i32, y: i32) {
        if self.detail == Detail::Every {
            return self.word(time, format!("{what}={x:+},{y:+}"));
        }
        let sum = self.sums.entry(what).or_default();
        *sum = (sum.0 + x, sum.1 + y);
    }

    fn value(&mut self, time: Timestamp, what: String, value: String) {
        if self.detail == Detail::Every {
            return self.word(time, format!("{what}={value}"));
        }
        match self.ranges.iter_mut().find(|(other, _)| *other == what) {
            Some((_, range)) => range.last = value,
            None => {
                let (first, last) = (value.clone(), value);
                self.ranges.push((what, Range { first, last }));
            }
        }
    }

    fn decimals(&self, value: f32) -> String {
        match self.detail {
            Detail::Every => format!("{value:.3}"),
            Detail::Summary => two_decimals(value),
        }
    }

    fn end_ranges(&mut self) {
        for (what, Range { first, last }) in std::mem::take(&mut self.ranges) {
            self.words.push(if first == last {
                format!("{what}={first}")
            } else {
                format!("{what}={first}..{last}")
            });
        }
        for (what, (x, y)) in std::mem::take(&mut self.sums) {
            self.words.push(format!("{what}={x:+},{y:+}"));
        }
    }
}

/// Two decimals, and no −0.
fn two_decimals(value: f32) -> String {
    let text = format!("{value:.2}");
    if text == "-0.00" { "0.00".into() } else { text }
}
