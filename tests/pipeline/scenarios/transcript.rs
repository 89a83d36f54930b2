//! The transcript of a scenario: a word for each thing that goes out.

use std::collections::BTreeMap;

use ademan::contact::TargetNames;
use ademan::device::{EventKind, OutputEvent, Request};
use ademan::time::Timestamp;

/// Takes what goes out and makes words of it.
#[derive(Default)]
pub struct TranscriptWriter {
    words: Vec<String>,
    /// When the last word was.
    time: Timestamp,
    /// What goes on: what it is, and how far it has come.
    ways: Vec<(String, ValueRange)>,
    sums: BTreeMap<&'static str, (i32, i32)>,
}

struct ValueRange {
    first: String,
    last: String,
}

impl TranscriptWriter {
    pub fn starting_at(time: Timestamp) -> Self {
        Self {
            time,
            ..Self::default()
        }
    }

    pub fn event(&mut self, event: &OutputEvent, names: &TargetNames) {
        let of = |target| names.get(target).to_string().replace(' ', "_");
        match event.kind {
            EventKind::KeyDown(key) => self.once(event.time, format!("dn:{key}")),
            EventKind::KeyUp(key) => self.once(event.time, format!("up:{key}")),
            EventKind::Character(character) => self.write(event.time, character),
            EventKind::MoveBy(x, y) => self.add("move", x, y),
            EventKind::Scroll(x, y) => self.add("scroll", x, y),
            EventKind::MoveTo(x, y) => self.go("place".into(), format!("{x:.2},{y:.2}")),
            EventKind::Axis(axis, at) => self.go(format!("axis:{axis}"), decimals(at)),
            EventKind::Depth(target, at) => self.go(format!("depth:{}", of(target)), decimals(at)),
            EventKind::Value(target, at) => self.go(format!("value:{}", of(target)), decimals(at)),
            EventKind::Select(target) => self.once(event.time, format!("select:{}", of(target))),
            EventKind::Unselect(target) => {
                self.once(event.time, format!("unselect:{}", of(target)))
            }
            EventKind::Ask(Request::Profile(place)) => {
                self.once(event.time, format!("ask:profile-{place}"));
            }
            EventKind::Ask(request) => {
                let name = format!("{request:?}").to_lowercase().replace(' ', "");
                self.once(event.time, format!("ask:{name}"));
            }
            other => panic!("no word for {other:?}"),
        }
    }

    /// Something that happens once.
    pub fn once(&mut self, time: Timestamp, word: String) {
        self.tell_ways();
        let milliseconds = time.0 / 1_000 - (self.time.0 / 1_000).min(time.0 / 1_000);
        if milliseconds > 0 {
            self.words.push(format!("t:{milliseconds}ms"));
        }
        self.time = self.time.max(time);
        self.words.push(word);
    }

    /// A remark, at no time of its own.
    pub fn remark(&mut self, word: String) {
        self.tell_ways();
        self.words.push(word);
    }

    /// The words since the last time that they were taken.
    pub fn take(&mut self) -> Vec<String> {
        self.tell_ways();
        std::mem::take(&mut self.words)
    }

    /// The characters of a text are one word.
    fn write(&mut self, time: Timestamp, character: char) {
        let is_text = |word: &&mut String| word.starts_with("write:");
        match self.words.last_mut().filter(is_text) {
            Some(word) if time == self.time => word.push(character),
            _ => self.once(time, format!("write:{character}")),
        }
    }

    fn add(&mut self, what: &'static str, x: i32, y: i32) {
        let sum = self.sums.entry(what).or_default();
        *sum = (sum.0 + x, sum.1 + y);
    }

    fn go(&mut self, what: String, place: String) {
        match self.ways.iter_mut().find(|(other, _)| *other == what) {
            Some((_, way)) => way.last = place,
            None => {
                let (first, last) = (place.clone(), place);
                self.ways.push((what, ValueRange { first, last }));
            }
        }
    }

    fn tell_ways(&mut self) {
        for (what, ValueRange { first, last }) in std::mem::take(&mut self.ways) {
            self.words.push(match first == last {
                true => format!("{what}={first}"),
                false => format!("{what}={first}..{last}"),
            });
        }
        for (what, (x, y)) in std::mem::take(&mut self.sums) {
            self.words.push(format!("{what}={x:+},{y:+}"));
        }
    }
}

/// Two of them; there is no −0.
fn decimals(value: f32) -> String {
    let text = format!("{value:.2}");
    if text == "-0.00" { "0.00".into() } else { text }
}
