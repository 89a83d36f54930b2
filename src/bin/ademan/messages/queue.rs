//! A bounded queue of messages, and the thread that writes them.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::session::counted;
use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

/// Messages that wait for their reader: more than a screen.
const CAPACITY: usize = 256;

/// The queue. Dropping it ends the thread.
pub struct MessageQueue {
    entries: Sender<Entry>,
    missed: Arc<AtomicU64>,
}

enum Entry {
    /// A message with its line end.
    Message(String),
    /// The end of a [`flush`](MessageQueue::flush), which is reached when it is dropped.
    Flush { _end: Sender<()> },
    /// The time of the next held back message may have changed.
    Wake,
}

/// Messages that are due, and the time at which the next ones are.
pub type Due = (Vec<String>, Option<Instant>);

impl MessageQueue {
    /// Starts the thread. `take_due` returns messages that were held back until now.
    pub fn start(
        writer: impl Write + Send + 'static,
        take_due: impl Fn() -> Due + Send + 'static,
    ) -> io::Result<Self> {
        let (entries, queue) = bounded(CAPACITY);
        let missed = Arc::new(AtomicU64::new(0));
        let mut printer = Printer {
            writer,
            queue,
            missed: missed.clone(),
        };
        thread::Builder::new()
            .name("messages".into())
            .spawn(move || while printer.print_next(&take_due) {})?;
        Ok(Self { entries, missed })
    }

    /// Queues a message. Does not wait: a full queue drops and counts it.
    pub fn push(&self, message: String) {
        if self.entries.try_send(Entry::Message(message)).is_err() {
            self.missed.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Makes the thread ask for messages that are due.
    pub fn wake(&self) {
        // A full queue wakes it too.
        let _ = self.entries.try_send(Entry::Wake);
    }

    /// Waits until all messages so far are written, or the time is over.
    pub fn flush(&self, timeout: Duration) {
        let deadline = Instant::now() + timeout;
        let (end, flushed) = bounded(0);
        let entry = Entry::Flush { _end: end };
        if self.entries.send_deadline(entry, deadline).is_ok() {
            let _ = flushed.recv_deadline(deadline);
        }
    }
}

struct Printer<W> {
    writer: W,
    queue: Receiver<Entry>,
    missed: Arc<AtomicU64>,
}

impl<W: Write> Printer<W> {
    /// Waits for an entry and handles it. Returns `false` when the queue is closed.
    fn print_next(&mut self, take_due: &impl Fn() -> Due) -> bool {
        let (due, next_due) = take_due();
        for message in due {
            self.print(&message);
        }
        let entry = match next_due {
            Some(time) => self.queue.recv_deadline(time),
            None => self.queue.recv().map_err(RecvTimeoutError::from),
        };
        match &entry {
            Ok(Entry::Message(message)) => self.print(message),
            Ok(Entry::Flush { .. }) => _ = self.writer.flush(),
            _ => {}
        }
        if self.queue.is_empty() {
            self.print_missed();
        }
        !matches!(entry, Err(RecvTimeoutError::Disconnected))
    }

    fn print(&mut self, message: &str) {
        // A failure here has nowhere to be reported.
        let _ = self.writer.write_all(message.as_bytes());
    }

    fn print_missed(&mut self) {
        let missed = self.missed.swap(0, Ordering::Relaxed);
        if missed > 0 {
            self.print(&format!(
                "{} dropped: not written in time\n",
                counted(missed, "message")
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{PipeReader, Read};

    fn no_due() -> Due {
        (Vec::new(), None)
    }

    /// A queue that writes to a pipe that has not been read yet.
    fn queue() -> (MessageQueue, PipeReader) {
        let (reader, writer) = io::pipe().unwrap();
        (MessageQueue::start(writer, no_due).unwrap(), reader)
    }

    /// Longest wait on a busy machine.
    const TIMEOUT: Duration = Duration::from_secs(60);

    /// Longer than the buffer of a pipe.
    const MORE_THAN_FITS: usize = 1000;

    #[test]
    fn a_reader_that_reads_nothing_blocks_nobody_and_gets_the_count_later() {
        let (queue, mut reader) = queue();
        let line = format!("{}\n", "x".repeat(999));
        for _ in 0..MORE_THAN_FITS {
            queue.push(line.clone());
        }
        queue.flush(Duration::from_millis(1));
        let missed = queue.missed.load(Ordering::Relaxed);
        assert!(missed > 0, "the queue is bounded");
        let (sender, read) = bounded(1);
        thread::spawn(move || {
            let mut text = String::new();
            reader.read_to_string(&mut text).unwrap();
            sender.send(text).unwrap();
        });
        queue.flush(TIMEOUT);
        drop(queue);
        let text = read.recv_timeout(TIMEOUT).unwrap();
        let written = text
            .lines()
            .filter(|read_line| read_line.starts_with('x'))
            .count();
        assert_eq!(written as u64 + missed, MORE_THAN_FITS as u64);
        let last = text.lines().last().unwrap();
        assert_eq!(
            last,
            format!(
                "{} dropped: not written in time",
                counted(missed, "message")
            )
        );
    }

    #[test]
    fn messages_that_are_due_are_written_without_another_message() {
        let (reader, writer) = io::pipe().unwrap();
        let (due, dues) = bounded::<String>(1);
        let take_due = move || (dues.try_iter().collect(), None);
        let queue = MessageQueue::start(writer, take_due).unwrap();
        due.send("late\n".into()).unwrap();
        queue.wake();
        let (sender, read) = bounded(1);
        thread::spawn(move || {
            let mut line = String::new();
            io::BufRead::read_line(&mut io::BufReader::new(reader), &mut line).unwrap();
            sender.send(line).unwrap();
        });
        assert_eq!(read.recv_timeout(TIMEOUT).unwrap(), "late\n");
    }
}
