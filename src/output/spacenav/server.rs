//! The thread behind the output: one loop for the orders, the socket and all clients.

use std::io::{self, ErrorKind, Read};
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, TryRecvError};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::client::Client;
use super::{Axes, BUTTONS, Listener, REST, ServerMessage};
use crate::time::Timestamp;

/// Clients at a time.
const MOST_CLIENTS: usize = 16;

/// How long no client is accepted after that failed for want of something, such as file numbers.
const RECOVERY: Duration = Duration::from_millis(100);

/// How long clients have to take the last that they are told.
const FAREWELL: Duration = Duration::from_millis(500);

/// How often it is looked whether they have.
const FAREWELL_STEP: Duration = Duration::from_millis(5);

/// The server's side: what clients were told, and who they are.
pub(super) struct Server {
    listener: Listener,
    bell: UnixStream,
    orders: Receiver<ServerMessage>,
    clients: Vec<Client>,
    axes: Axes,
    time: Timestamp,
    is_down: [bool; BUTTONS],
    accepts_from: Instant,
}

impl Server {
    /// Of clients that come to `listener`. Orders are looked at when something is on `bell`.
    pub fn new(
        listener: Listener,
        bell: UnixStream,
        orders: Receiver<ServerMessage>,
    ) -> io::Result<Self> {
        listener.set_nonblocking()?;
        bell.set_nonblocking(true)?;
        Ok(Self {
            listener,
            bell,
            orders,
            clients: Vec::with_capacity(MOST_CLIENTS),
            axes: REST,
            time: Timestamp(0),
            is_down: [false; BUTTONS],
            accepts_from: Instant::now(),
        })
    }

    /// Serves until there will be no more orders, then lets go of everything.
    pub fn work(mut self) {
        while self.take_orders() && self.turn().is_ok() {}
        self.say_farewell();
        self.listener.remove();
    }

    /// Whether there may be more.
    fn take_orders(&mut self) -> bool {
        loop {
            match self.orders.try_recv() {
                Ok(order) => self.follow(order),
                Err(TryRecvError::Empty) => return true,
                Err(TryRecvError::Disconnected) => return false,
            }
        }
    }

    fn follow(&mut self, order: ServerMessage) {
        match order {
            ServerMessage::Move(axes, time) => self.move_to(axes, time),
            ServerMessage::Press(number) => self.put(number, true),
            ServerMessage::Release(number) => self.put(number, false),
        }
    }

    fn move_to(&mut self, axes: Axes, time: Timestamp) {
        (self.axes, self.time) = (axes, time);
        for client in &mut self.clients {
            client.tell_motion(axes, time);
        }
    }

    fn put(&mut self, number: usize, is_down: bool) {
        self.is_down[number] = is_down;
        for client in &mut self.clients {
            client.tell_button(number, is_down);
        }
    }

    fn flush(&mut self) {
        let now = Instant::now();
        for client in &mut self.clients {
            client.flush(now);
        }
        self.clients.retain(|client| !client.is_lost());
    }

    /// Tells clients what waits for them, then waits for whoever has something, and hears it.
    fn turn(&mut self) -> io::Result<()> {
        self.flush();
        let ready = self.wait()?;
        let [bell, listener, clients @ ..] = &ready[..] else {
            return Ok(());
        };
        if *bell {
            // Which bytes, and whether the other end is there, does not matter: the orders tell.
            let _ = self.bell.read(&mut [0; 64]);
        }
        let path = self.listener.path().to_string_lossy().into_owned();
        for (client, is_ready) in self.clients.iter_mut().zip(clients) {
            if *is_ready {
                client.hear(&path);
            }
        }
        if *listener {
            self.welcome();
        }
        Ok(())
    }

    /// Who has something to say: the bell, the listener and each client. Ends too when a client takes
    /// again what is told to it, or has not for too long.
    fn wait(&self) -> io::Result<Vec<bool>> {
        let now = Instant::now();
        let accepts = now >= self.accepts_from;
        let listener = if accepts {
            PollFlags::IN
        } else {
            PollFlags::empty()
        };
        let mut files = vec![
            PollFd::new(&self.bell, PollFlags::IN),
            PollFd::new(&self.listener, listener),
        ];
        let of_client = |client: &Client| match client.is_waiting() {
            true => PollFlags::IN | PollFlags::OUT,
            false => PollFlags::IN,
        };
        let clients = self.clients.iter();
        files.extend(clients.map(|client| PollFd::new(client, of_client(client))));
        let deadlines = self.clients.iter().filter_map(Client::deadline);
        let until = deadlines
            .chain((!accepts).then_some(self.accepts_from))
            .min();
        let left = until.map(|until| timespec(until.saturating_duration_since(now)));
        match poll(&mut files, left.as_ref()) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
        let has_something = |file: &PollFd| !(file.revents() - PollFlags::OUT).is_empty();
        Ok(files.iter().map(has_something).collect())
    }

    fn welcome(&mut self) {
        match self.listener.accept().and_then(Client::new) {
            Ok(_) if self.clients.len() == MOST_CLIENTS => {
                tracing::warn!("a spacenav client was sent away: {MOST_CLIENTS} are here already");
            }
            Ok(client) => self.clients.push(client),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                tracing::warn!("the spacenav socket: {error}");
            }
            Err(_) => self.accepts_from = Instant::now() + RECOVERY,
        }
    }

    /// Lets go of everything, and gives clients time to hear of it.
    fn say_farewell(&mut self) {
        for number in 0..BUTTONS {
            if self.is_down[number] {
                self.put(number, false);
            }
        }
        if self.axes != REST {
            self.move_to(REST, self.time);
        }
        let end = Instant::now() + FAREWELL;
        self.flush();
        while self.clients.iter().any(Client::is_waiting) && Instant::now() < end {
            thread::sleep(FAREWELL_STEP);
            self.flush();
        }
    }
}

/// A little more than that, so that a deadline has passed when it is over.
fn timespec(duration: Duration) -> Timespec {
    let millis = duration.as_millis() as i64 + 1;
    Timespec {
        tv_sec: millis / 1000,
        tv_nsec: millis % 1000 * 1_000_000,
    }
}
