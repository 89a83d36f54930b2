//! The output `transcript`: events as lines of text.
//!
//! Each line has the time in milliseconds with three decimals, right-aligned to 12 columns, and the event. Keys and
//! buttons have the names of [`KeyCode`](ademan_core::device::KeyCode), targets their names in the layout (or their index if they
//! have none). Depths and values have three decimals, absolute pointer positions four.
//!
//! ```text
//!     1234.567 down Q
//!     1240.250 depth 3 0.512
//!     1300.001 up   Q
//! ```
//!
//! A line `missed 17` states that 17 lines are missing because the reader was too slow for a live source.

mod line;
mod missed_lines;
mod thread;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::axis_state::AxisState;
use super::{Backend, OpenRequest, OutputError, Sink};
use crate::advice;
use crate::files::{self, FileError};
use ademan_core::contact::TargetNames;
use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{Capabilities, EventKind, OutputEvent, TimedCommand, TimedCommands};
use ademan_core::message::escape;
use ademan_core::time::Timestamp;
use line::MissedLine;
use missed_lines::MissedLines;
use thread::TranscriptThread;

pub use line::{CommandLine, EventLine};

/// The backend `transcript`.
pub const BACKEND: Backend = Backend {
    name: "transcript",
    argument: Some("PATH"),
    is_argument_required: false,
    summary: "one line per event, on the standard output or in a new file: transcript:PATH",
    capabilities: Capabilities::all,
    is_log: true,
    is_fixed_when_open: false,
    check: None,
    open,
};

/// Opens a transcript on the standard output, or in a new file that only its owner can read.
fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let writer: Box<dyn Write + Send> = match request.argument {
        None => Box::new(io::stdout()),
        Some(path) => {
            let file = create(Path::new(path));
            Box::new(file.map_err(|error| OutputError::open(request.name, error))?)
        }
    };
    let thread = TranscriptThread::start(request.name, BufWriter::new(writer));
    let no_thread = |error: io::Error| OutputError::open(request.name, advice::no_thread(&error));
    Ok(Box::new(thread.map_err(no_thread)?))
}

/// Creates a file. Its folder is created if it is the folder of the transcripts of setups.
fn create(path: &Path) -> Result<File, FileError> {
    if let Some(folder) = files::transcript_folder().filter(|own| path.parent() == Some(own)) {
        if let Some(parent) = folder.parent() {
            fs::create_dir_all(parent)?;
        }
        files::create_private_folder(&folder)?;
        tracing::info!("the transcript is {}", escape(&path.to_string_lossy()));
    }
    files::create_private(path)
}

/// A sink that writes one line per event and flushes after each step.
///
/// A transcript is complete: it blocks until the writer accepts each line, and the backend gives it a thread of its own.
/// A release of a key that is not pressed and a second press of a pressed key are not written.
pub struct Transcript<W: Write + Send> {
    name: String,
    target_names: TargetNames,
    writer: W,
    pressed: PressedKeys,
    axes: AxisState,
    last_time: Timestamp,
    /// The commands logged since the last call of `send`.
    commands: TimedCommands,
    has_failed: bool,
}

impl<W: Write + Send> Transcript<W> {
    /// Creates a transcript that writes to `writer`; errors call it `name`.
    pub fn new(name: impl Into<String>, writer: W) -> Self {
        Self {
            name: name.into(),
            target_names: TargetNames::default(),
            writer,
            pressed: PressedKeys::default(),
            axes: AxisState::default(),
            last_time: Timestamp::default(),
            commands: TimedCommands::new(),
            has_failed: false,
        }
    }

    fn write_commands(&mut self) -> io::Result<()> {
        for command in std::mem::take(&mut self.commands) {
            self.write_command(&command)?;
        }
        Ok(())
    }

    fn write_command(&mut self, command: &TimedCommand) -> io::Result<()> {
        self.last_time = self.last_time.max(command.time);
        writeln!(self.writer, "{}", CommandLine(command))
    }

    /// Writes the number of lines that are missing, and what was released in them.
    fn write_missed(&mut self, missed: &MissedLines) -> io::Result<()> {
        self.last_time = self.last_time.max(missed.time);
        let time = self.last_time;
        writeln!(self.writer, "{}", MissedLine(time, missed.count))?;
        let releases: Vec<_> = missed.releases_of(&self.pressed, &self.axes).collect();
        for kind in releases {
            self.write(&OutputEvent { time, kind })?;
        }
        Ok(())
    }

    fn write(&mut self, event: &OutputEvent) -> io::Result<()> {
        let has_effect = match event.kind {
            EventKind::KeyDown(key) => self.pressed.press(key),
            EventKind::KeyUp(key) => self.pressed.release(key),
            EventKind::Axis(axis, value) => {
                self.axes.set(axis, value);
                true
            }
            _ => true,
        };
        if !has_effect {
            return Ok(());
        }
        self.last_time = self.last_time.max(event.time);
        writeln!(self.writer, "{}", EventLine(event, &self.target_names))
    }

    fn release_all(&mut self) -> io::Result<()> {
        while let Some(kind) = self.next_release() {
            let time = self.last_time;
            self.write(&OutputEvent { time, kind })?;
        }
        self.writer.flush()
    }

    fn next_release(&self) -> Option<EventKind> {
        let key = self.pressed.release_order().next().map(EventKind::KeyUp);
        key.or_else(|| self.axes.deflected_axes().next().map(AxisState::center))
    }

    fn fail(&mut self, error: &io::Error) -> OutputError {
        self.has_failed = true;
        match error.kind() {
            io::ErrorKind::BrokenPipe => OutputError::BrokenPipe {
                output: self.name.clone(),
            },
            _ => OutputError::send(&self.name, error),
        }
    }
}

impl<W: Write + Send> Sink for Transcript<W> {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut result = self.write_commands();
        for event in events {
            result = result.and_then(|()| self.write(event));
        }
        result
            .and_then(|()| self.writer.flush())
            .map_err(|error| self.fail(&error))
    }

    fn log_commands(&mut self, commands: &[TimedCommand]) -> Result<(), OutputError> {
        // Written by `send`: the releases of the other outputs must not wait for the writer.
        let room = self.commands.remaining_capacity();
        self.commands.extend(commands.iter().take(room).copied());
        Ok(())
    }

    fn is_log(&self) -> bool {
        true
    }

    fn has_effect(&self) -> bool {
        false
    }

    fn set_target_names(&mut self, names: &TargetNames) {
        self.target_names = names.clone();
    }

    /// Writes a release of every pressed key and the centering of every deflected axis, at the time of the last event.
    fn close(&mut self) -> Result<(), OutputError> {
        self.release_all().map_err(|error| self.fail(&error))
    }
}

impl<W: Write + Send> Drop for Transcript<W> {
    fn drop(&mut self) {
        if !self.has_failed {
            let _ = self.release_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::{down, event, up};
    use ademan_core::contact::TargetId;
    use ademan_core::device::Axis;
    use std::sync::{Arc, Mutex};

    #[derive(Clone, Default)]
    struct Buffer(Arc<Mutex<Vec<u8>>>);

    impl Buffer {
        fn text(&self) -> String {
            String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
        }
    }

    impl Write for Buffer {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// Returns a transcript, and the text that it writes.
    fn buffered() -> (Transcript<Buffer>, Buffer) {
        let buffer = Buffer::default();
        (Transcript::new("transcript", buffer.clone()), buffer)
    }

    struct BrokenWriter(io::ErrorKind);

    impl Write for BrokenWriter {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_line_has_the_time_in_milliseconds_and_the_event() {
        let (mut transcript, buffer) = buffered();
        let depth = OutputEvent {
            time: Timestamp(1_240_250),
            kind: EventKind::Depth(TargetId(3), 0.5123),
        };
        transcript
            .send(&[down(1_234_567, "Q"), depth, up(1_300_001, "Q")])
            .unwrap();
        transcript.send(&[down(9, "ShiftLeft")]).unwrap();
        let text = "    1234.567 down Q\n    1240.250 depth 3 0.512\n    1300.001 up   Q\n";
        assert_eq!(
            buffer.text(),
            format!("{text}       0.009 down ShiftLeft\n")
        );

        let (mut value_transcript, value_buffer) = buffered();
        value_transcript.set_target_names(&TargetNames::new(["Volume".to_owned()]));
        let value = OutputEvent {
            time: Timestamp(1_000),
            kind: EventKind::Value(TargetId(0), 0.25),
        };
        value_transcript.send(&[value]).unwrap();
        assert_eq!(value_buffer.text(), "       1.000 value Volume 0.250\n");
    }

    #[test]
    fn closing_releases_pressed_keys_modifiers_last() {
        let (mut transcript, buffer) = buffered();
        transcript
            .send(&[down(1_000, "ShiftLeft"), down(2_000, "A")])
            .unwrap();
        transcript.close().unwrap();
        transcript.close().unwrap();
        drop(transcript);
        let ups: Vec<_> = buffer.text().lines().skip(2).map(str::to_owned).collect();
        assert_eq!(ups, ["       2.000 up   A", "       2.000 up   ShiftLeft"]);
    }

    #[test]
    fn closing_centers_deflected_axes() {
        let (mut transcript, buffer) = buffered();
        let axis = |axis, value| event(3_000, EventKind::Axis(axis, value));
        let events = [
            axis(Axis::LeftX, -0.5),
            axis(Axis::LeftY, 0.25),
            axis(Axis::LeftY, 0.0),
            down(3_000, "PadSouth"),
        ];
        transcript.send(&events).unwrap();
        transcript.close().unwrap();
        transcript.close().unwrap();
        let text = buffer.text();
        let ends: Vec<_> = text.lines().skip(4).collect();
        let expected = [
            "       3.000 up   PadSouth",
            "       3.000 axis LeftX +0.000",
        ];
        assert_eq!(ends, expected);
    }

    #[test]
    fn dropping_a_transcript_releases_pressed_keys() {
        let (mut transcript, buffer) = buffered();
        transcript.send(&[down(5, "A")]).unwrap();
        drop(transcript);
        assert!(buffer.text().ends_with("       0.005 up   A\n"));
    }

    #[test]
    fn a_release_of_a_key_that_is_up_and_a_second_press_are_not_written() {
        let (mut transcript, buffer) = buffered();
        transcript
            .send(&[up(1, "A"), down(2, "B"), down(3, "B"), up(4, "B")])
            .unwrap();
        assert_eq!(buffer.text(), "       0.002 down B\n       0.004 up   B\n");
    }

    #[test]
    fn a_closed_pipe_is_distinguished_from_other_failures() {
        let mut closed = Transcript::new("transcript", BrokenWriter(io::ErrorKind::BrokenPipe));
        let error = closed.send(&[down(1, "A")]).unwrap_err();
        assert!(matches!(error, OutputError::BrokenPipe { .. }), "{error}");

        let mut full = Transcript::new("transcript:x", BrokenWriter(io::ErrorKind::StorageFull));
        let full_error = full.send(&[down(1, "A")]).unwrap_err();
        assert_eq!(
            full_error.to_string(),
            "the output `transcript:x` failed: no storage space"
        );
    }
}
