//! The thread of the output: one loop for its queue, the socket and all clients.

use std::io::{self, ErrorKind, Read};
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, TryRecvError};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::client::Client;
use super::{Axes, BUTTON_COUNT, CENTERED, Listener, ServerMessage};
use ademan_core::time::Timestamp;

/// Maximum number of clients.
const MAX_CLIENTS: usize = 16;

/// Time without further attempts to accept a client after a failure, such as a lack of file descriptors.
const ACCEPT_RETRY_DELAY: Duration = Duration::from_millis(100);

/// Longest time in which clients read their last messages.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_millis(500);

/// Interval of the attempts to send the last messages.
const SHUTDOWN_INTERVAL: Duration = Duration::from_millis(5);

/// The server with its clients and the state of the mouse.
pub(super) struct Server {
    listener: Listener,
    wake_ups: UnixStream,
    messages: Receiver<ServerMessage>,
    clients: Vec<Client>,
    axes: Axes,
    time: Timestamp,
    is_pressed: [bool; BUTTON_COUNT],
    /// Clients are accepted from this time on.
    accepts_from: Instant,
}

impl Server {
    /// Creates a server for clients of `listener`. It reads `messages` when a byte arrives on `wake_ups`.
    pub fn new(
        listener: Listener,
        wake_ups: UnixStream,
        messages: Receiver<ServerMessage>,
    ) -> io::Result<Self> {
        listener.set_nonblocking()?;
        wake_ups.set_nonblocking(true)?;
        Ok(Self {
            listener,
            wake_ups,
            messages,
            clients: Vec::with_capacity(MAX_CLIENTS),
            axes: CENTERED,
            time: Timestamp(0),
            is_pressed: [false; BUTTON_COUNT],
            accepts_from: Instant::now(),
        })
    }

    /// Serves until the queue is closed, then centers all axes and releases all buttons.
    pub fn run(mut self) {
        while self.handle_messages() && self.serve_clients().is_ok() {}
        self.shut_down();
        self.listener.remove();
    }

    /// Handles the messages in the queue. Returns `false` if it is closed.
    fn handle_messages(&mut self) -> bool {
        loop {
            match self.messages.try_recv() {
                Ok(ServerMessage::Move(axes, time)) => self.set_axes(axes, time),
                Ok(ServerMessage::Press(number)) => self.set_button(number, true),
                Ok(ServerMessage::Release(number)) => self.set_button(number, false),
                Err(TryRecvError::Empty) => return true,
                Err(TryRecvError::Disconnected) => return false,
            }
        }
    }

    fn set_axes(&mut self, axes: Axes, time: Timestamp) {
        (self.axes, self.time) = (axes, time);
        for client in &mut self.clients {
            client.queue_motion(axes, time);
        }
    }

    fn set_button(&mut self, number: usize, is_pressed: bool) {
        self.is_pressed[number] = is_pressed;
        for client in &mut self.clients {
            client.queue_button(number, is_pressed);
        }
    }

    fn flush(&mut self) {
        let now = Instant::now();
        for client in &mut self.clients {
            client.flush(now);
        }
        self.clients.retain(|client| !client.is_lost());
    }

    /// Sends queued messages, waits for an event, and handles the requests of clients.
    fn serve_clients(&mut self) -> io::Result<()> {
        self.flush();
        let ready = self.poll()?;
        let [wake_up, listener, clients @ ..] = &ready[..] else {
            return Ok(());
        };
        if *wake_up {
            // The bytes have no meaning, and a closed queue is detected by the next call.
            let _ = self.wake_ups.read(&mut [0; 64]);
        }
        let path = self.listener.path().to_string_lossy().into_owned();
        for (client, is_ready) in self.clients.iter_mut().zip(clients) {
            if *is_ready {
                client.receive(&path);
            }
        }
        if *listener {
            self.accept();
        }
        Ok(())
    }

    /// Waits until a descriptor is ready or a deadline has passed. Returns the readiness of the waker, the listener and
    /// each client for reading.
    fn poll(&self) -> io::Result<Vec<bool>> {
        let now = Instant::now();
        let accepts = now >= self.accepts_from;
        let listener = if accepts {
            PollFlags::IN
        } else {
            PollFlags::empty()
        };
        let mut descriptors = vec![
            PollFd::new(&self.wake_ups, PollFlags::IN),
            PollFd::new(&self.listener, listener),
        ];
        let flags = |client: &Client| {
            if client.has_messages() {
                PollFlags::IN | PollFlags::OUT
            } else {
                PollFlags::IN
            }
        };
        let clients = self.clients.iter();
        descriptors.extend(clients.map(|client| PollFd::new(client, flags(client))));
        let deadlines = self.clients.iter().filter_map(Client::deadline);
        let deadline = deadlines
            .chain((!accepts).then_some(self.accepts_from))
            .min();
        let timeout = deadline.map(|deadline| timespec(deadline.saturating_duration_since(now)));
        match poll(&mut descriptors, timeout.as_ref()) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
        let is_readable = |descriptor: &PollFd| !(descriptor.revents() - PollFlags::OUT).is_empty();
        Ok(descriptors.iter().map(is_readable).collect())
    }

    fn accept(&mut self) {
        match self.listener.accept().and_then(Client::new) {
            Ok(_) if self.clients.len() == MAX_CLIENTS => {
                tracing::warn!("rejected a spacenav client: {MAX_CLIENTS} are connected");
            }
            Ok(client) => self.clients.push(client),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                tracing::warn!("the spacenav socket: {error}");
            }
            Err(_) => self.accepts_from = Instant::now() + ACCEPT_RETRY_DELAY,
        }
    }

    /// Releases all buttons, centers all axes, and waits until the clients have read it, at most 0.5 s.
    fn shut_down(&mut self) {
        for number in 0..BUTTON_COUNT {
            if self.is_pressed[number] {
                self.set_button(number, false);
            }
        }
        if self.axes != CENTERED {
            self.set_axes(CENTERED, self.time);
        }
        let end = Instant::now() + SHUTDOWN_TIMEOUT;
        self.flush();
        while self.clients.iter().any(Client::has_messages) && Instant::now() < end {
            thread::sleep(SHUTDOWN_INTERVAL);
            self.flush();
        }
    }
}

/// Converts a duration, rounded up by up to 1 ms, so that a deadline has passed when the time-out ends.
fn timespec(duration: Duration) -> Timespec {
    let millis = duration.as_millis() as i64 + 1;
    Timespec {
        tv_sec: millis / 1000,
        tv_nsec: millis % 1000 * 1_000_000,
    }
}
