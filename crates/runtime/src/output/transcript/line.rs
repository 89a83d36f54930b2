//! Events and commands as lines of text.

use std::fmt;

use ademan_core::command::Command;
use ademan_core::contact::TargetNames;
use ademan_core::device::{EventKind, OutputEvent, TimedCommand};
use ademan_core::message::escape;
use ademan_core::time::Timestamp;

/// One event as a line of text without a line end; the second field names its target.
#[derive(Clone, Copy, Debug)]
pub struct EventLine<'a>(pub &'a OutputEvent, pub &'a TargetNames);

impl fmt::Display for EventLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |target| quoted(&self.1.get(target).to_string());
        write_time(f, self.0.time)?;
        match self.0.kind {
            EventKind::KeyDown(key) => write!(f, "down {key}"),
            EventKind::KeyUp(key) => write!(f, "up   {key}"),
            // As a literal of Rust, without an apostrophe inside of the quotes.
            EventKind::Character('\'') => write!(f, r"write '\u{{27}}'"),
            EventKind::Character(character) => write!(f, "write {character:?}"),
            EventKind::MoveBy(x, y) => write!(f, "move {x:+} {y:+}"),
            EventKind::MoveTo(x, y) => write!(f, "position {x:.4} {y:.4}"),
            EventKind::Scroll(x, y) => write!(f, "scroll {x:+} {y:+}"),
            EventKind::Axis(axis, value) => write!(f, "axis {axis} {value:+.3}"),
            EventKind::Depth(target, depth) => write!(f, "depth {} {depth:.3}", name(target)),
            EventKind::Value(target, value) => write!(f, "value {} {value:.3}", name(target)),
            EventKind::Velocity(target, velocity) => {
                write!(f, "velocity {} {velocity:.3}", name(target))
            }
            EventKind::Select(target) => write!(f, "select {}", name(target)),
            EventKind::Unselect(target) => write!(f, "unselect {}", name(target)),
        }
    }
}

/// One command as a line of text without a line end.
#[derive(Clone, Copy, Debug)]
pub struct CommandLine<'a>(pub &'a TimedCommand);

impl fmt::Display for CommandLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_time(f, self.0.time)?;
        match &self.0.command {
            command @ Command::Scale { factor } => write!(f, "{} {factor:.3}", command.name()),
            command => f.write_str(&quoted(&command.to_string())),
        }
    }
}

/// The number of lines that are missing, as a line of text without a line end.
#[derive(Clone, Copy, Debug)]
pub(super) struct MissedLine(pub Timestamp, pub u64);

impl fmt::Display for MissedLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_time(f, self.0)?;
        write!(f, "missed {}", self.1)
    }
}

/// Returns a name without control characters, in quotes if a character has a meaning to a shell: a layout of another person
/// chooses the name, and a transcript may get to where a shell reads it.
fn quoted(name: &str) -> String {
    let is_plain =
        |character: char| !character.is_ascii_punctuation() || "-_.,:+/@%".contains(character);
    let name = escape(name);
    if name.chars().all(is_plain) {
        name.into_owned()
    } else {
        format!("'{}'", name.replace('\'', r"'\''"))
    }
}

/// Writes the first column of a line.
fn write_time(f: &mut fmt::Formatter<'_>, Timestamp(micros): Timestamp) -> fmt::Result {
    write!(f, "{:>8}.{:03} ", micros / 1_000, micros % 1_000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::contact::TargetId;

    fn line(kind: EventKind, names: &TargetNames) -> String {
        let event = OutputEvent {
            time: Timestamp(0),
            kind,
        };
        EventLine(&event, names).to_string().trim_start().to_owned()
    }

    #[test]
    fn names_and_characters_mean_nothing_to_a_shell() {
        let select = |name: &str| {
            let names = TargetNames::new([name.to_owned()]);
            line(EventKind::Select(TargetId(0)), &names)
        };
        for plain in ["Q", "Volume up", "½", "a-b_c.d,e:f+g/h@i%"] {
            assert_eq!(select(plain), format!("0.000 select {plain}"));
        }
        for (name, quoted) in [
            (";touch a;", "';touch a;'"),
            ("$(a)", "'$(a)'"),
            ("a'b", r"'a'\''b'"),
            ("';a;'", r"''\'';a;'\'''"),
            ("a\nb", r"'a\nb'"),
        ] {
            assert_eq!(select(name), format!("0.000 select {quoted}"));
        }
        let write = |character| line(EventKind::Character(character), &TargetNames::default());
        assert_eq!(write('$'), "0.000 write '$'");
        assert_eq!(write('\''), r"0.000 write '\u{27}'");
    }
}
