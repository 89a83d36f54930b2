//! Events as lines of text.
//!
//! One line per event: the time in milliseconds with three decimals, right-aligned to 12 places,
//! then what happened. Keys and buttons have the names of [`KeyCode`](crate::device::KeyCode), targets
//! those of the layout (its number where a target has none). Depths and values have three decimals,
//! places on the screen four.
//!
//! ```text
//!     1234.567 down Q
//!     1240.250 depth 3 0.512
//!     1300.001 up   Q
//! ```

use std::fmt;
use std::io::{self, Write};

use super::axis_state::AxisState;
use super::pressed_keys::PressedKeys;
use super::{OutputError, OutputKind, Sink};
use crate::contact::TargetNames;
use crate::device::{EventKind, OutputEvent, TimedCommand, TimedCommands};
use crate::time::Timestamp;

/// An output that writes one line per event and is flushed after each frame.
///
/// A transcript is a record, so nothing is left out of it: it waits for whoever reads it. An up of
/// what is not down and a second down are not written.
pub struct Transcript<W: Write + Send> {
    name: String,
    names: TargetNames,
    writer: W,
    held: PressedKeys,
    deflected: AxisState,
    last: Timestamp,
    /// The commands logged since the last call of `send`.
    commands: TimedCommands,
    failed: bool,
}

impl<W: Write + Send> Transcript<W> {
    /// Writes to `writer`; `name` is what errors call it.
    pub fn new(name: impl Into<String>, writer: W) -> Self {
        Self {
            name: name.into(),
            names: TargetNames::default(),
            writer,
            held: PressedKeys::default(),
            deflected: AxisState::default(),
            last: Timestamp::default(),
            commands: TimedCommands::new(),
            failed: false,
        }
    }

    fn write_commands(&mut self) -> io::Result<()> {
        for command in std::mem::take(&mut self.commands) {
            self.last = self.last.max(command.time);
            writeln!(self.writer, "{}", CommandLine(&command))?;
        }
        Ok(())
    }

    fn write(&mut self, event: &OutputEvent) -> io::Result<()> {
        let accepted = match event.kind {
            EventKind::KeyDown(key) => self.held.press(key),
            EventKind::KeyUp(key) => self.held.release(key),
            EventKind::Axis(axis, value) => {
                self.deflected.set(axis, value);
                true
            }
            _ => true,
        };
        if !accepted {
            return Ok(());
        }
        self.last = self.last.max(event.time);
        writeln!(self.writer, "{}", EventLine(event, &self.names))
    }

    fn release_all(&mut self) -> io::Result<()> {
        while let Some(action) = self.next_release() {
            let time = self.last;
            self.write(&OutputEvent { time, kind: action })?;
        }
        self.writer.flush()
    }

    fn next_release(&self) -> Option<EventKind> {
        let up = self.held.release_order().next().map(EventKind::KeyUp);
        up.or_else(|| {
            self.deflected
                .deflected_axes()
                .next()
                .map(AxisState::center)
        })
    }

    fn failure(&mut self, error: &io::Error) -> OutputError {
        self.failed = true;
        let output = self.name.clone();
        if error.kind() == io::ErrorKind::BrokenPipe {
            return OutputError::BrokenPipe { output };
        }
        OutputError::Send {
            output,
            reason: error.to_string(),
        }
    }
}

impl<W: Write + Send> Sink for Transcript<W> {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut outcome = self.write_commands();
        for event in events {
            outcome = outcome.and_then(|()| self.write(event));
        }
        outcome
            .and_then(|()| self.writer.flush())
            .map_err(|error| self.failure(&error))
    }

    fn log_commands(&mut self, commands: &[TimedCommand]) -> Result<(), OutputError> {
        // Written by `send`: the releases of the other outputs must not wait for the writer.
        let room = self.commands.remaining_capacity();
        self.commands.extend(commands.iter().take(room).copied());
        Ok(())
    }

    fn kind(&self) -> OutputKind {
        OutputKind::Log
    }

    fn set_target_names(&mut self, names: &TargetNames) {
        self.names = names.clone();
    }

    /// Writes, at the time of the last event, an up line for everything that is still down and a line
    /// for every axis that has to come back to 0.
    fn close(&mut self) -> Result<(), OutputError> {
        self.release_all().map_err(|error| self.failure(&error))
    }
}

impl<W: Write + Send> Drop for Transcript<W> {
    fn drop(&mut self) {
        if !self.failed {
            let _ = self.release_all();
        }
    }
}

/// One event as its line, without the line end; targets have these names.
#[derive(Clone, Copy, Debug)]
pub struct EventLine<'a>(pub &'a OutputEvent, pub &'a TargetNames);

impl fmt::Display for EventLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |target| self.1.get(target);
        write_time(f, self.0.time)?;
        match self.0.kind {
            EventKind::KeyDown(key) => write!(f, "down {key}"),
            EventKind::KeyUp(key) => write!(f, "up   {key}"),
            EventKind::Character(character) => write!(f, "write {character:?}"),
            EventKind::MoveBy(x, y) => write!(f, "move {x:+} {y:+}"),
            EventKind::MoveTo(x, y) => write!(f, "place {x:.4} {y:.4}"),
            EventKind::Scroll(x, y) => write!(f, "scroll {x:+} {y:+}"),
            EventKind::Axis(axis, value) => write!(f, "axis {axis} {value:+.3}"),
            EventKind::Depth(target, depth) => write!(f, "depth {} {depth:.3}", name(target)),
            EventKind::Value(target, value) => write!(f, "value {} {value:.3}", name(target)),
            EventKind::Select(target) => write!(f, "select {}", name(target)),
            EventKind::Unselect(target) => write!(f, "unselect {}", name(target)),
        }
    }
}

/// A command as a line of a transcript, without the line end.
#[derive(Clone, Copy, Debug)]
pub struct CommandLine<'a>(pub &'a TimedCommand);

impl fmt::Display for CommandLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_time(f, self.0.time)?;
        write!(f, "{}", self.0.command)
    }
}

/// Writes a time in milliseconds, as the first column of a line.
fn write_time(f: &mut fmt::Formatter<'_>, Timestamp(micros): Timestamp) -> fmt::Result {
    write!(f, "{:>8}.{:03} ", micros / 1_000, micros % 1_000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::TargetId;
    use crate::device::Axis;
    use crate::output::tests::{down, event, up};
    use std::sync::{Arc, Mutex};

    #[derive(Clone, Default)]
    struct Page(Arc<Mutex<Vec<u8>>>);

    impl Page {
        fn text(&self) -> String {
            String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
        }
    }

    impl Write for Page {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    struct Broken(io::ErrorKind);

    impl Write for Broken {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn an_event_is_a_line_with_its_time_in_milliseconds() {
        let page = Page::default();
        let mut transcript = Transcript::new("transcript", page.clone());
        let depth = OutputEvent {
            time: Timestamp(1_240_250),
            kind: EventKind::Depth(TargetId(3), 0.5123),
        };
        transcript
            .send(&[down(1_234_567, "Q"), depth, up(1_300_001, "Q")])
            .unwrap();
        transcript.send(&[down(9, "ShiftLeft")]).unwrap();
        let text = "    1234.567 down Q\n    1240.250 depth 3 0.512\n    1300.001 up   Q\n";
        assert_eq!(page.text(), format!("{text}       0.009 down ShiftLeft\n"));

        let page = Page::default();
        let mut transcript = Transcript::new("transcript", page.clone());
        transcript.set_target_names(&TargetNames::new(["Volume".to_owned()]));
        let value = OutputEvent {
            time: Timestamp(1_000),
            kind: EventKind::Value(TargetId(0), 0.25),
        };
        transcript.send(&[value]).unwrap();
        assert_eq!(page.text(), "       1.000 value Volume 0.250\n");
    }

    #[test]
    fn closing_lets_go_of_what_is_down_and_modifiers_come_last() {
        let page = Page::default();
        let mut transcript = Transcript::new("transcript", page.clone());
        transcript
            .send(&[down(1_000, "ShiftLeft"), down(2_000, "A")])
            .unwrap();
        transcript.close().unwrap();
        transcript.close().unwrap();
        drop(transcript);
        let ups: Vec<_> = page.text().lines().skip(2).map(str::to_owned).collect();
        assert_eq!(ups, ["       2.000 up   A", "       2.000 up   ShiftLeft"]);
    }

    #[test]
    fn closing_brings_back_the_axes_that_are_away_from_their_rest() {
        let page = Page::default();
        let mut transcript = Transcript::new("transcript", page.clone());
        let axis = |axis, value| event(3_000, EventKind::Axis(axis, value));
        let frame = [
            axis(Axis::LeftX, -0.5),
            axis(Axis::LeftY, 0.25),
            axis(Axis::LeftY, 0.0),
            down(3_000, "PadSouth"),
        ];
        transcript.send(&frame).unwrap();
        transcript.close().unwrap();
        transcript.close().unwrap();
        let text = page.text();
        let ends: Vec<_> = text.lines().skip(4).collect();
        let expected = [
            "       3.000 up   PadSouth",
            "       3.000 axis LeftX +0.000",
        ];
        assert_eq!(ends, expected);
    }

    #[test]
    fn dropping_it_lets_go_too() {
        let page = Page::default();
        let mut transcript = Transcript::new("transcript", page.clone());
        transcript.send(&[down(5, "A")]).unwrap();
        drop(transcript);
        assert!(page.text().ends_with("       0.005 up   A\n"));
    }

    #[test]
    fn an_up_of_what_is_not_down_and_a_second_down_are_not_written() {
        let page = Page::default();
        let mut transcript = Transcript::new("transcript", page.clone());
        transcript
            .send(&[up(1, "A"), down(2, "B"), down(3, "B"), up(4, "B")])
            .unwrap();
        assert_eq!(page.text(), "       0.002 down B\n       0.004 up   B\n");
    }

    #[test]
    fn a_reader_that_went_away_is_told_from_other_failures() {
        let mut unread = Transcript::new("transcript", Broken(io::ErrorKind::BrokenPipe));
        let error = unread.send(&[down(1, "A")]).unwrap_err();
        assert!(matches!(error, OutputError::BrokenPipe { .. }), "{error}");

        let mut full = Transcript::new("transcript:x", Broken(io::ErrorKind::StorageFull));
        let error = full.send(&[down(1, "A")]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the output `transcript:x` failed: no storage space"
        );
    }
}
