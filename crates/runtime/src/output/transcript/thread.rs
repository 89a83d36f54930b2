//! A transcript on a thread of its own, so that a terminal, a pipe or a disk that accepts nothing delays no release.
//!
//! The loop puts the lines of a step into a bounded queue, all or none. When the queue is full there are two policies:
//!
//! - **Lossless**: the loop waits. This is the policy of a transcript that is opened alone: a replay writes the same bytes at
//!   any speed of its reader. Nothing can be held while it waits, as a transcript presses no key of any system.
//! - **[Dropping](Sink::drop_when_full)**: the step is dropped and counted. A transcript next to an output with an effect,
//!   and one of a live source, has this policy: a slow reader of the transcript must not delay the release of a key or the
//!   answer to a command. When the queue has room again, a line `missed 17` has the count, and the transcript writes a release
//!   of every key that has come up since. A press that was dropped is never written, and neither is its release.

use std::io::{self, Write};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

use super::{MissedLines, Transcript};
use crate::output::{OutputError, Sink};
use ademan_core::contact::TargetNames;
use ademan_core::device::{OutputEvent, TimedCommand, TimedCommands};

/// Capacity of the queue in lines: some 10 s of a busy hand.
const QUEUE: usize = 4096;

/// Longest time in which a reader may read the last lines of a transcript that drops lines.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// A part of a step. The last part of each step is [`EndOfStep`](Self::EndOfStep).
enum Message {
    TargetNames(TargetNames),
    // A rare message must not enlarge all others.
    Missed(Box<MissedLines>),
    Command(TimedCommand),
    Event(OutputEvent),
    EndOfStep,
}

/// A [`Transcript`] on a thread of its own.
pub(super) struct TranscriptThread {
    name: String,
    /// `None` once it is closed.
    queue: Option<Sender<Message>>,
    thread: Option<JoinHandle<Result<(), OutputError>>>,
    /// Disconnected when the thread has ended.
    ended: Receiver<()>,
    /// The error with which the thread ended.
    failure: Option<OutputError>,
    is_lossless: bool,
    /// The commands logged since the last call of `send`.
    commands: TimedCommands,
    /// Names that the thread does not have yet.
    target_names: Option<TargetNames>,
    missed: MissedLines,
    missed_in_all: u64,
}

impl TranscriptThread {
    /// Starts the thread. It writes to `writer`; errors call the transcript `name`.
    pub fn start(name: &str, writer: impl Write + Send + 'static) -> io::Result<Self> {
        let (queue, messages) = bounded(QUEUE);
        let (end, ended) = bounded::<()>(0);
        let mut transcript = Transcript::new(name, writer);
        let write = move || {
            let _end = end;
            write_messages(&messages, &mut transcript)
        };
        let thread = thread::Builder::new()
            .name("transcript".into())
            .spawn(write)?;
        Ok(Self {
            name: name.to_owned(),
            queue: Some(queue),
            thread: Some(thread),
            ended,
            failure: None,
            is_lossless: true,
            commands: TimedCommands::new(),
            target_names: None,
            missed: MissedLines::default(),
            missed_in_all: 0,
        })
    }

    /// Queues a step, or drops it if the queue has no room for all of it.
    fn push_step(&mut self, queue: &Sender<Message>, events: &[OutputEvent]) {
        let lines = self.commands.len() + events.len();
        if lines == 0 && self.missed.count == 0 {
            return;
        }
        let commands = std::mem::take(&mut self.commands);
        // Beside the lines: the names, the missed lines and the end. No other thread sends, so the room stays.
        let has_room = QUEUE - queue.len() >= lines + 3;
        if !has_room && !self.is_lossless {
            self.missed.count += lines as u64;
            self.missed_in_all += lines as u64;
            events.iter().for_each(|event| self.missed.apply(event));
            return;
        }
        let names = self.target_names.take().map(Message::TargetNames);
        let missed = self.missed.take().map(Message::Missed);
        events.iter().for_each(|event| self.missed.apply(event));
        let written = commands.into_iter().map(Message::Command);
        let written = written.chain(events.iter().copied().map(Message::Event));
        for message in names.into_iter().chain(missed).chain(written) {
            // An error means that the thread has failed, which the caller checks.
            let _ = queue.send(message);
        }
        let _ = queue.send(Message::EndOfStep);
    }

    /// Returns the error of the thread if it has ended.
    fn check_thread(&mut self) -> Result<(), OutputError> {
        if self.thread.as_ref().is_some_and(JoinHandle::is_finished) {
            self.join();
        }
        self.failure.clone().map_or(Ok(()), Err)
    }

    fn join(&mut self) {
        self.failure = match self.thread.take().map(JoinHandle::join) {
            Some(Ok(Err(error))) => Some(error),
            Some(Err(_)) => Some(OutputError::send(&self.name, "its thread panicked")),
            Some(Ok(Ok(()))) | None => self.failure.take(),
        };
    }

    /// Waits until the thread has written the queue. Returns `false` after 1 s, unless it is lossless.
    fn wait_for_thread(&self) -> bool {
        if self.is_lossless {
            self.ended.recv().is_err()
        } else {
            self.ended.recv_timeout(CLOSE_TIMEOUT) != Err(RecvTimeoutError::Timeout)
        }
    }
}

/// Writes the steps of the queue, one write per step, until the queue is closed.
fn write_messages<W: Write + Send>(
    messages: &Receiver<Message>,
    transcript: &mut Transcript<W>,
) -> Result<(), OutputError> {
    for message in messages {
        let written = match message {
            Message::TargetNames(names) => {
                transcript.set_target_names(&names);
                Ok(())
            }
            Message::Missed(missed) => transcript.write_missed(&missed),
            Message::Command(command) => transcript.write_command(&command),
            Message::Event(event) => transcript.write(&event),
            Message::EndOfStep => transcript.writer.flush(),
        };
        written.map_err(|error| transcript.fail(&error))?;
    }
    transcript.close()
}

impl Sink for TranscriptThread {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        self.check_thread()?;
        let Some(queue) = self.queue.take() else {
            return Err(OutputError::send(&self.name, "it is closed"));
        };
        self.push_step(&queue, events);
        self.queue = Some(queue);
        Ok(())
    }

    fn log_commands(&mut self, commands: &[TimedCommand]) -> Result<(), OutputError> {
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

    fn drop_when_full(&mut self) {
        self.is_lossless = false;
    }

    fn set_target_names(&mut self, names: &TargetNames) {
        self.target_names = Some(names.clone());
    }

    /// Writes the rest of the queue, and a release of every pressed key and axis.
    fn close(&mut self) -> Result<(), OutputError> {
        if let Some(queue) = self.queue.take() {
            self.push_step(&queue, &[]);
        }
        if self.thread.is_none() {
            return self.failure.clone().map_or(Ok(()), Err);
        }
        if !self.wait_for_thread() {
            tracing::warn!(
                "the output `{}` is not read: its last lines are lost",
                self.name
            );
            // It ends with the program, or when the reader continues.
            self.thread = None;
            return Ok(());
        }
        if self.missed_in_all > 0 {
            tracing::warn!(
                "the output `{}` was read too slowly: {} lines are missing",
                self.name,
                self.missed_in_all
            );
        }
        self.join();
        self.failure.clone().map_or(Ok(()), Err)
    }
}

impl Drop for TranscriptThread {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::{down, event, up, wait_until};
    use ademan_core::command::Command;
    use ademan_core::device::{Axis, EventKind};
    use ademan_core::time::Timestamp;
    use std::io::{PipeReader, Read};

    /// A transcript to a pipe that has not been read yet.
    fn transcript() -> (TranscriptThread, PipeReader) {
        let (reader, writer) = io::pipe().unwrap();
        let writer = io::BufWriter::new(writer);
        let thread = TranscriptThread::start("transcript", writer);
        (thread.unwrap(), reader)
    }

    /// A writer that blocks until the other end of the channel is dropped.
    struct Gate(Receiver<()>, io::PipeWriter);

    impl Write for Gate {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let _ = self.0.recv();
            self.1.write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn read(mut reader: PipeReader) -> JoinHandle<String> {
        thread::spawn(move || {
            let mut text = String::new();
            reader.read_to_string(&mut text).unwrap();
            text
        })
    }

    /// Sends more steps than the queue and a pipe hold.
    fn send_many(sink: &mut TranscriptThread) {
        for step in 0..10_000 {
            let character = event(2_000 + step, EventKind::Character('x'));
            sink.send(&[character]).unwrap();
        }
    }

    #[test]
    fn a_lossless_transcript_is_complete_and_in_order_for_a_slow_reader() {
        let (mut sink, reader) = transcript();
        let reader = read(reader);
        let (time, command) = (Timestamp(1_000), Command::Pause);
        sink.log_commands(&[TimedCommand { time, command }])
            .unwrap();
        sink.send(&[down(1_000, "A")]).unwrap();
        send_many(&mut sink);
        sink.close().unwrap();
        sink.close().unwrap();
        let text = reader.join().unwrap();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[..2], ["       1.000 pause", "       1.000 down A"]);
        assert_eq!(lines.len(), 2 + 10_000 + 1);
        assert!(lines[2..10_002].is_sorted(), "in order");
        assert_eq!(lines[10_002], "      11.999 up   A");
    }

    #[test]
    fn a_dropping_transcript_never_waits_and_writes_the_count_and_the_releases_later() {
        let ((gate, closed), (reader, pipe)) = (bounded(0), io::pipe().unwrap());
        let writer = io::BufWriter::new(Gate(closed, pipe));
        let mut sink = TranscriptThread::start("transcript", writer).unwrap();
        sink.drop_when_full();
        let deflect = event(1_000, EventKind::Axis(Axis::LeftX, 0.5));
        sink.send(&[down(1_000, "A"), down(1_000, "B"), deflect])
            .unwrap();
        wait_until("an empty queue", || {
            let queue = sink.queue.as_ref();
            queue.is_none_or(|it| it.is_empty())
        });
        send_many(&mut sink);
        let center = event(20_000, EventKind::Axis(Axis::LeftX, 0.0));
        sink.send(&[up(20_000, "A"), down(20_000, "C"), center])
            .unwrap();
        let missed = sink.missed_in_all;
        assert!((5_000..10_003).contains(&missed), "{missed}");

        drop(gate);
        let reader = read(reader);
        // The loop calls every output in each step, and while it waits.
        wait_until("the count of missed lines", || {
            sink.send(&[]).unwrap();
            thread::sleep(Duration::from_millis(1));
            sink.missed.count == 0
        });
        // The press of C was dropped, so its release is not a line.
        sink.send(&[up(30_000, "C"), up(30_000, "B")]).unwrap();
        sink.close().unwrap();
        let text = reader.join().unwrap();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len() as u64, 3 + 10_000 + 3 - missed + 4);
        let missed = format!("      20.000 missed {missed}");
        let last = [
            &*missed,
            "      20.000 up   A",
            "      20.000 axis LeftX +0.000",
            "      30.000 up   B",
        ];
        assert!(lines.ends_with(&last), "{:#?}", &lines[lines.len() - 8..]);
    }

    #[test]
    fn a_dropping_transcript_that_nobody_reads_is_closed_within_its_time_limit() {
        let (mut sink, _reader) = transcript();
        sink.drop_when_full();
        send_many(&mut sink);
        sink.close().unwrap();
        assert!(sink.thread.is_none(), "its thread is left behind");
    }

    #[test]
    fn a_failure_is_returned_by_a_later_step() {
        let (mut sink, reader) = transcript();
        drop(reader);
        let mut failure = None;
        wait_until("a failure", || {
            failure = sink.send(&[down(1, "A"), up(1, "A")]).err();
            failure.is_some()
        });
        let error = failure.unwrap();
        assert!(matches!(error, OutputError::BrokenPipe { .. }), "{error}");
        assert!(sink.close().is_err());
    }
}
