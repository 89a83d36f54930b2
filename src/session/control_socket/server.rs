//! The server's end: accepts clients, and has a thread for each.

use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use super::connection::{self, LineWriter};
use super::notification::{NotificationQueue, Notifier, Subscribers, broadcast};
use super::{ControlError, ProfileInfo, response};
use crate::output::socket::{Listener, Stream};
use crate::session::command_channel::CommandSender;

/// Clients at a time.
const MAX_CLIENTS: usize = 16;

/// How long no client is accepted after that failed for want of something, such as file numbers.
const RECOVERY: Duration = Duration::from_millis(100);

/// The session that a control socket serves.
pub struct ServerContext {
    /// The layouts of the setup, in order.
    pub profiles: Vec<ProfileInfo>,
    /// Channel to the session loop.
    pub commands: CommandSender,
}

/// A control socket. It is taken away when this is dropped; clients then hear no more.
pub struct ControlServer {
    listener: Arc<Listener>,
    reporter: Notifier,
    untold: Option<NotificationQueue>,
    is_over: Arc<AtomicBool>,
}

impl ControlServer {
    /// Takes the socket at `path`; clients wait until it is [served](Self::serve).
    ///
    /// It is its owner's alone from the first instant on. One that a dead owner has left is taken over; one
    /// of a run that is alive is refused.
    pub fn bind(path: &Path) -> Result<Self, ControlError> {
        let listener = Listener::open(path).map_err(|error| ControlError::bind(path, error))?;
        let (reporter, untold) = Notifier::new();
        Ok(Self {
            listener: Arc::new(listener),
            reporter,
            untold: Some(untold),
            is_over: Arc::default(),
        })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.listener.path()
    }

    /// Takes what happens in the run, for clients that ask for it.
    pub fn notifier(&self) -> Notifier {
        self.reporter.clone()
    }

    /// Serves clients from now on, on threads of its own. Only the first call does so.
    pub fn serve(&mut self, desk: ServerContext) -> io::Result<()> {
        let Some(untold) = self.untold.take() else {
            return Ok(());
        };
        let reception = Acceptor {
            listener: self.listener.clone(),
            is_over: self.is_over.clone(),
            subscribers: untold.subscribers.clone(),
            desk: Arc::new(desk),
            clients: Arc::default(),
        };
        spawn("control news", move || broadcast(&untold))?;
        spawn("control", move || reception.run())
    }
}

impl Drop for ControlServer {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        self.listener.close();
    }
}

struct Acceptor {
    listener: Arc<Listener>,
    is_over: Arc<AtomicBool>,
    subscribers: Subscribers,
    desk: Arc<ServerContext>,
    clients: Arc<AtomicUsize>,
}

impl Acceptor {
    fn run(&self) {
        loop {
            let accepted = self.listener.accept();
            if self.is_over.load(Ordering::Relaxed) {
                return;
            }
            let started = accepted.and_then(|stream| self.serve_client(stream));
            match started {
                Ok(()) => {}
                Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
                    tracing::warn!("the control socket: {error}");
                }
                Err(_) => thread::sleep(RECOVERY),
            }
        }
    }

    fn serve_client(&self, stream: Stream) -> io::Result<()> {
        let mouth = LineWriter::new(&stream)?;
        let Some(seat) = ClientSlot::acquire(&self.clients) else {
            let full = format!("{MAX_CLIENTS} clients are here already, come back later");
            // Nothing else is in its way; whether the client hears it is up to the client.
            let _ = mouth.write_line(&response::failure(&full));
            return Ok(());
        };
        let (desk, subscribers) = (self.desk.clone(), self.subscribers.clone());
        spawn("control client", move || {
            connection::serve(stream, mouth, &desk, &subscribers);
            drop(seat);
        })
    }
}

/// One of the places for clients, free again when it is dropped.
struct ClientSlot(Arc<AtomicUsize>);

impl ClientSlot {
    fn acquire(taken: &Arc<AtomicUsize>) -> Option<Self> {
        let seat = Self(taken.clone());
        let before = taken.fetch_add(1, Ordering::Relaxed);
        (before < MAX_CLIENTS).then_some(seat)
    }
}

impl Drop for ClientSlot {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    // They are not waited for: a client that hangs must not hold up the end of a run.
    thread::Builder::new()
        .name(name.into())
        .spawn(work)
        .map(drop)
}
