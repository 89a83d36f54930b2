//! The server of the control socket, with one thread per client.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use super::clients::{Clients, MAX_CLIENTS};
use super::connection;
use super::context::ServerContext;
use super::line_writer::LineWriter;
use super::notification::{NotificationQueue, Notifier, Subscribers, broadcast};
use super::{ControlError, response};
use crate::output::socket::{Listener, Stream};

/// Delay after a failure to accept a client, such as a lack of file descriptors.
const RETRY_DELAY: Duration = Duration::from_millis(100);

/// Time in which the thread of a client that has left closes the connection, and the thread of one that has connected reads its
/// request.
const DISCONNECT_DELAY: Duration = Duration::from_millis(5);

/// A control socket. Dropping it removes the socket.
pub struct ControlServer {
    listener: Arc<Listener>,
    notifier: Notifier,
    /// `None` once clients are served.
    queue: Option<NotificationQueue>,
    is_closed: Arc<AtomicBool>,
}

impl ControlServer {
    /// Creates the socket at `path`. Clients that connect wait until [`serve`](Self::serve).
    ///
    /// Only the owner of the socket may connect, from its creation on. The socket of a process that was killed is replaced.
    ///
    /// # Errors
    /// If the socket cannot be created, or another session listens on it.
    pub fn bind(path: &Path) -> Result<Self, ControlError> {
        let listener = Listener::open(path).map_err(|error| ControlError::bind(path, error))?;
        let (notifier, queue) = Notifier::new();
        Ok(Self {
            listener: Arc::new(listener),
            notifier,
            queue: Some(queue),
            is_closed: Arc::default(),
        })
    }

    /// Returns the path of the socket.
    pub fn path(&self) -> &Path {
        self.listener.path()
    }

    /// Returns a sender of notifications to the clients that have subscribed.
    pub fn notifier(&self) -> Notifier {
        self.notifier.clone()
    }

    /// Starts the threads that serve clients. Further calls have no effect.
    pub fn serve(&mut self, context: ServerContext) -> io::Result<()> {
        let Some(queue) = self.queue.take() else {
            return Ok(());
        };
        let mut acceptor = Acceptor {
            spare: self.listener.spare_descriptor().ok(),
            listener: self.listener.clone(),
            is_closed: self.is_closed.clone(),
            subscribers: queue.subscribers.clone(),
            context: Arc::new(context),
            clients: Clients::default(),
            has_waited: false,
        };
        spawn("control notify", move || broadcast(&queue))?;
        spawn("control", move || acceptor.run())
    }
}

impl Drop for ControlServer {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Relaxed);
        self.listener.close();
    }
}

/// The thread that accepts clients.
struct Acceptor {
    listener: Arc<Listener>,
    is_closed: Arc<AtomicBool>,
    subscribers: Subscribers,
    context: Arc<ServerContext>,
    clients: Clients,
    /// A file descriptor for a client that comes when there are no others.
    spare: Option<File>,
    /// `true` if the client that connects has waited for the clients before it.
    has_waited: bool,
}

impl Acceptor {
    fn run(&mut self) {
        loop {
            let client = self.listener.wait_for_client();
            let accepted = client.and_then(|()| self.listener.accept());
            if self.is_closed.load(Ordering::Relaxed) {
                return;
            }
            let started = accepted.and_then(|stream| self.serve_client(stream));
            match started {
                Ok(()) => {
                    self.has_waited = false;
                    if self.spare.is_none() {
                        self.spare = self.listener.spare_descriptor().ok();
                    }
                }
                Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
                    tracing::warn!("control socket: {error}");
                }
                Err(_) => self.free_descriptor(),
            }
        }
    }

    /// Makes a file descriptor free for the client that could not be accepted, so that a command gets through.
    fn free_descriptor(&mut self) {
        if self.spare.take().is_some() {
            return;
        }
        if !std::mem::replace(&mut self.has_waited, true) {
            // A client that has its response is about to leave, and one that has just connected sends its request.
            thread::sleep(DISCONNECT_DELAY);
            return;
        }
        let is_disconnected = self.clients.disconnect_idle();
        thread::sleep(if is_disconnected {
            DISCONNECT_DELAY
        } else {
            RETRY_DELAY
        });
    }

    fn serve_client(&self, stream: Stream) -> io::Result<()> {
        let stream = Arc::new(stream);
        let writer = Arc::new(LineWriter::new(stream.clone())?);
        let Some(slot) = self.clients.add(writer.clone()) else {
            let error = format!("all {MAX_CLIENTS} connections are in use; try again later");
            // The buffer of a new connection has room for this line.
            let _ = writer.write_line(&response::failure(&error));
            return Ok(());
        };
        let (context, subscribers) = (self.context.clone(), self.subscribers.clone());
        spawn("control client", move || {
            connection::serve(&stream, writer, &slot, &context, &subscribers);
        })
    }
}

/// Starts a thread that is not joined: a client that hangs must not delay the end of a session.
fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    thread::Builder::new()
        .name(name.into())
        .spawn(work)
        .map(drop)
}
