//! The thread that writes messages.

use std::io::{self, ErrorKind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, bounded};

use super::notes::{ALL_NOTES_OFF, CONTROL, Message};

/// A function that writes a message, or the first part of it, to a port or device. Returns the number of bytes that were written;
/// [`WouldBlock`](ErrorKind::WouldBlock) if the device has no room.
pub(super) type Writer = Box<dyn FnMut(&[u8]) -> io::Result<usize> + Send>;

/// Time between two tries to write to a full device.
const RETRY_DELAY: Duration = Duration::from_millis(2);

/// The tries to write to a full device once the session no longer waits for the thread: 5 s, in which a receiver that was stopped for a
/// moment still gets the ends of its notes.
const LAST_TRIES: u32 = 2500;

/// The message that shows a receiver that the sender lives. After it, a silence of 300 ms ends all notes.
const ACTIVE_SENSING: [u8; 1] = [0xfe];

/// Silence after which it is sent again.
const SENSING_PERIOD: Duration = Duration::from_millis(250);

/// Longest time that the end of the thread takes.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// Number of channels.
const CHANNELS: usize = 16;

/// The thread, as the loop sees it.
pub(super) struct MidiThread {
    handle: Option<JoinHandle<()>>,
    ended: Receiver<()>,
    /// Number of steps of the loop.
    steps: Arc<AtomicU64>,
    /// `true` once the session has ended without waiting longer for the thread.
    is_abandoned: Arc<AtomicBool>,
}

impl MidiThread {
    /// Starts the thread. It ends with the queue, or when the device stops accepting messages.
    pub fn start(writer: Writer, queue: Receiver<Message>) -> io::Result<Self> {
        let (end, ended) = bounded::<()>(0);
        let steps = Arc::new(AtomicU64::new(0));
        let is_abandoned = Arc::new(AtomicBool::new(false));
        let port = Port {
            writer,
            is_abandoned: Arc::clone(&is_abandoned),
            last_tries: LAST_TRIES,
            notes: [0; CHANNELS],
            is_sensed: false,
        };
        let seen = Arc::clone(&steps);
        let run = move || {
            let _end = end;
            port.run(&queue, &seen);
        };
        let handle = thread::Builder::new()
            .name("midi output".into())
            .spawn(run)?;
        Ok(Self {
            handle: Some(handle),
            ended,
            steps,
            is_abandoned,
        })
    }

    /// Records that the loop does not hang.
    pub fn report_life(&self) {
        self.steps.fetch_add(1, Ordering::Relaxed);
    }

    /// Waits for the end, after the queue was closed. A device that has not accepted everything within 1 s has 5 s more, for which
    /// this function does not wait. A second call has no effect.
    pub fn join(&mut self) -> Result<(), String> {
        let Some(handle) = self.handle.take() else {
            return Ok(());
        };
        if self.ended.recv_timeout(CLOSE_TIMEOUT) == Err(RecvTimeoutError::Timeout) {
            self.is_abandoned.store(true, Ordering::Relaxed);
            return Err("it did not end within 1 s, and notes may keep sounding".into());
        }
        handle.join().map_err(|_| "its thread panicked".into())
    }
}

/// The port or device, and what sounds there.
struct Port {
    writer: Writer,
    is_abandoned: Arc<AtomicBool>,
    /// The tries that are left after the session has ended.
    last_tries: u32,
    /// The notes of each channel that sound, as bits.
    notes: [u128; CHANNELS],
    /// `true` if Active Sensing was sent, as it is before the first note.
    is_sensed: bool,
}

impl Port {
    fn run(mut self, queue: &Receiver<Message>, steps: &AtomicU64) {
        let written = self.write_messages(queue, steps);
        // A device that does not accept this either is gone, and so are its notes.
        let _ = self.end_notes();
        // The end of the session has reported a device that accepts nothing.
        if let Err(error) = written
            && !self.is_abandoned.load(Ordering::Relaxed)
        {
            tracing::error!("the output `midi` failed: {error}");
        }
    }

    /// Writes the messages of the queue until it is closed.
    fn write_messages(&mut self, queue: &Receiver<Message>, steps: &AtomicU64) -> io::Result<()> {
        let mut seen_steps = 0;
        loop {
            match queue.recv_timeout(SENSING_PERIOD) {
                Ok(message) => self.write(message)?,
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
                Err(RecvTimeoutError::Timeout) => {
                    let now = steps.load(Ordering::Relaxed);
                    let is_hung = std::mem::replace(&mut seen_steps, now) == now;
                    if is_hung && self.notes != [0; CHANNELS] {
                        self.end_notes()?;
                    } else {
                        self.show_life()?;
                    }
                }
            }
        }
    }

    fn write(&mut self, message: Message) -> io::Result<()> {
        let [status, note, _] = message;
        let channel = usize::from(status & 0x0f);
        if status & 0xf0 == 0x90 {
            // Set first: a message that failed may have arrived.
            self.notes[channel] |= 1 << note;
            // The process may be killed before the first silence.
            if !std::mem::replace(&mut self.is_sensed, true) {
                self.send(&ACTIVE_SENSING)?;
            }
        }
        self.send(&message)?;
        if status & 0xf0 == 0x80 {
            self.notes[channel] &= !(1 << note);
        }
        Ok(())
    }

    /// Sends Active Sensing after a silence, also while no note sounds: a receiver that has got it once takes a longer silence for the
    /// end of the sender, and cuts off what still fades.
    fn show_life(&mut self) -> io::Result<()> {
        if self.is_sensed {
            self.send(&ACTIVE_SENSING)
        } else {
            Ok(())
        }
    }

    /// Writes the bytes. Waits for a full device, after the end of the session for 5 s at most.
    fn send(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            match (self.writer)(bytes) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(written) => bytes = &bytes[written..],
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock && self.may_retry() => {
                    thread::sleep(RETRY_DELAY);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Returns `true` unless the session has ended and the last try was made.
    fn may_retry(&mut self) -> bool {
        if !self.is_abandoned.load(Ordering::Relaxed) {
            return true;
        }
        self.last_tries = self.last_tries.saturating_sub(1);
        self.last_tries > 0
    }

    /// Ends the notes that sound: each of them, and all of their channels for receivers that have missed the beginning.
    fn end_notes(&mut self) -> io::Result<()> {
        for channel in 0..CHANNELS {
            let notes = self.notes[channel];
            for note in (0..128).filter(|note| notes & (1 << note) != 0) {
                self.send(&[0x80 | channel as u8, note, 64])?;
            }
            if notes != 0 {
                self.send(&[CONTROL | channel as u8, ALL_NOTES_OFF, 0])?;
            }
            self.notes[channel] = 0;
        }
        Ok(())
    }
}
