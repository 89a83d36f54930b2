//! Feedback to a glove, over the line that its readings come from.

use std::io::Write;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use crossbeam_channel::{Receiver, Sender, bounded};

pub use ademan_core::capture::feedback::*;

/// The writing end of a connection. Each write ends within a tenth of a second.
type Writer = Arc<Mutex<Box<dyn Write + Send>>>;

/// The identity of a connection, which does not keep it open. The default identifies no connection.
#[derive(Clone, Default)]
pub struct ConnectionId(Weak<Mutex<Box<dyn Write + Send>>>);

impl PartialEq for ConnectionId {
    fn eq(&self, other: &Self) -> bool {
        Weak::ptr_eq(&self.0, &other.0)
    }
}

/// The writing end of a source on its present connection. Clones belong to the same source.
#[derive(Clone)]
pub struct FeedbackDevice {
    /// The form of the messages. Locked for a moment only.
    format: Arc<Mutex<&'static FeedbackFormat>>,
    /// The present connection. Locked for a moment only.
    writer: Arc<Mutex<Option<Writer>>>,
    changed: Sender<()>,
    changes: Receiver<()>,
}

impl FeedbackDevice {
    /// Creates a device that is not connected.
    pub fn new(format: &'static FeedbackFormat) -> Self {
        let (changed, changes) = bounded(1);
        Self {
            format: Arc::new(Mutex::new(format)),
            writer: Arc::default(),
            changed,
            changes,
        }
    }

    /// Returns the form of the messages.
    pub fn format(&self) -> &'static FeedbackFormat {
        *self.format.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Replaces the form of the messages, as the device has shown that it reads another one.
    pub fn set_format(&self, format: &'static FeedbackFormat) {
        *self.format.lock().unwrap_or_else(PoisonError::into_inner) = format;
        let _ = self.changed.try_send(());
    }

    /// Replaces the connection. `None` stands for a connection that cannot be written to.
    pub fn connect(&self, writer: Option<Box<dyn Write + Send>>) {
        *self.lock() = writer.map(|writer| Arc::new(Mutex::new(writer)));
        // If the channel is full, the message in it announces this change, too.
        let _ = self.changed.try_send(());
    }

    /// Removes the connection and returns it, because closing it may block.
    pub fn disconnect(&self) -> Option<FeedbackConnection> {
        self.lock().take().map(FeedbackConnection)
    }

    /// Returns the present connection.
    pub fn connection(&self) -> Option<FeedbackConnection> {
        self.lock().clone().map(FeedbackConnection)
    }

    /// Returns a channel with a message after each new connection or form of the messages.
    pub fn changes(&self) -> &Receiver<()> {
        &self.changes
    }

    fn lock(&self) -> MutexGuard<'_, Option<Writer>> {
        self.writer.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A connection to a device. It stays open while this exists.
pub struct FeedbackConnection(Writer);

impl FeedbackConnection {
    /// Returns the identity of the connection.
    pub fn id(&self) -> ConnectionId {
        ConnectionId(Arc::downgrade(&self.0))
    }

    /// Writes bytes, and returns how many were written before the device stopped reading or the connection failed.
    pub fn write(&self, bytes: &[u8]) -> usize {
        let mut writer = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut written = 0;
        while written < bytes.len() {
            match writer.write(&bytes[written..]) {
                Ok(length @ 1..) => written += length,
                Ok(0) | Err(_) => break,
            }
        }
        written
    }
}
