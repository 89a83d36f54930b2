//! A server that writes the lines of a session to all of its clients.

use std::io;
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, bounded, never, select};

use super::client::Client;
use super::{ShareError, ShareTarget, SharedStep};
use crate::advice;
use crate::hand::Side;
use crate::snapshot::Snapshot;
use crate::time::NO_DEADLINE;

/// Most clients at once. Further ones are disconnected.
const MAX_CLIENTS: usize = 128;

/// Steps that wait for the thread of the server.
const MAX_STEPS: usize = 64;

/// Interval at which clients that are behind, or that may not send, are looked at.
const CHECK_INTERVAL: Duration = Duration::from_millis(50);

/// A server, until it is dropped.
pub struct ShareServer {
    target: ShareTarget,
    /// `None` while the server is dropped.
    steps: Option<Sender<SharedStep>>,
    clients: Arc<AtomicUsize>,
    /// Tells the thread that accepts connections to end.
    is_closed: Arc<AtomicBool>,
}

impl ShareServer {
    /// Starts a server for the lines of a session whose first hand is `first`.
    pub fn start(target: ShareTarget, first: Side) -> Result<Self, ShareError> {
        let listen_error = |error| ShareError::Listen {
            address: target.address,
            error,
        };
        let listener = TcpListener::bind(target.address).map_err(listen_error)?;
        let address = listener.local_addr().map_err(listen_error)?;
        let (steps, step_receiver) = bounded(MAX_STEPS);
        let (connections, connection_receiver) = bounded(MAX_CLIENTS);
        let clients = Arc::new(AtomicUsize::new(0));
        let no_thread =
            |error: io::Error| ShareError::NoThread(advice::no_thread(&error).to_string());
        let is_closed = Arc::new(AtomicBool::new(false));
        let closed = is_closed.clone();
        let accept = move || accept(&listener, &connections, &closed);
        thread::Builder::new()
            .name("share-accept".into())
            .spawn(accept)
            .map_err(no_thread)?;
        let mut broadcast = Broadcast {
            target,
            first,
            steps: step_receiver,
            connections: connection_receiver,
            clients: Vec::new(),
            count: clients.clone(),
            line: Vec::new(),
            checked_at: Instant::now(),
        };
        let server = Self {
            target: ShareTarget { address, ..target },
            steps: Some(steps),
            clients,
            is_closed,
        };
        // If this thread cannot be started, dropping the server ends the other one.
        thread::Builder::new()
            .name("share".into())
            .spawn(move || broadcast.run())
            .map_err(no_thread)?;
        Ok(server)
    }

    /// Returns the target with the port at which the server listens.
    pub fn target(&self) -> ShareTarget {
        self.target
    }

    /// Shares a step. Does not wait: a step is dropped while 64 wait.
    pub fn push(&self, snapshot: &Snapshot) {
        if self.clients.load(Ordering::Relaxed) > 0
            && let Some(step) = SharedStep::from_snapshot(snapshot)
            && let Some(steps) = &self.steps
        {
            let _ = steps.try_send(step);
        }
    }
}

impl Drop for ShareServer {
    fn drop(&mut self) {
        self.steps = None;
        self.is_closed.store(true, Ordering::Release);
        // Wakes the thread that accepts connections.
        let _ = TcpStream::connect_timeout(&self.target.address, CHECK_INTERVAL);
    }
}

fn accept(listener: &TcpListener, connections: &Sender<TcpStream>, is_closed: &AtomicBool) {
    loop {
        let accepted = listener.accept();
        if is_closed.load(Ordering::Acquire) {
            return;
        }
        match accepted {
            Ok((stream, _)) => _ = connections.send(stream),
            // Out of descriptors, for instance.
            Err(_) => thread::sleep(CHECK_INTERVAL),
        }
    }
}

/// The thread that writes to all clients.
struct Broadcast {
    target: ShareTarget,
    first: Side,
    steps: Receiver<SharedStep>,
    connections: Receiver<TcpStream>,
    clients: Vec<Client>,
    /// The number of clients, for the session.
    count: Arc<AtomicUsize>,
    line: Vec<u8>,
    checked_at: Instant,
}

impl Broadcast {
    fn run(&mut self) {
        loop {
            let timeout = match self.clients.is_empty() {
                true => NO_DEADLINE,
                false => CHECK_INTERVAL,
            };
            select! {
                recv(self.steps) -> step => match step {
                    Ok(step) => self.write(&step),
                    Err(_) => return,
                },
                recv(self.connections) -> stream => match stream {
                    Ok(stream) => self.add(stream),
                    Err(_) => self.connections = never(),
                },
                default(timeout) => {}
            }
            self.check();
            self.count.store(self.clients.len(), Ordering::Relaxed);
        }
    }

    fn add(&mut self, stream: TcpStream) {
        if self.clients.len() < MAX_CLIENTS
            && let Ok(client) = Client::new(stream)
        {
            self.clients.push(client);
        }
    }

    fn write(&mut self, step: &SharedStep) {
        if !step.write(self.target.format, self.first, &mut self.line) {
            return;
        }
        let line: Arc<[u8]> = self.line.as_slice().into();
        self.clients.retain_mut(|client| client.push(&line).is_ok());
    }

    /// Disconnects clients that send or do not read.
    fn check(&mut self) {
        if self.checked_at.elapsed() < CHECK_INTERVAL {
            return;
        }
        self.checked_at = Instant::now();
        self.clients.retain_mut(|client| {
            let is_alive = !client.is_behind() || client.flush().is_ok();
            is_alive && client.check_silence().is_ok()
        });
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, BufReader, Read, Write};

    use super::*;
    use crate::estimate::JointAngles;
    use crate::kinematics::HandPose;
    use crate::time::Timestamp;

    const TIMEOUT: Duration = Duration::from_secs(60);

    fn server(format: &str) -> ShareServer {
        let target = format!("{format}:127.0.0.1:0").parse().unwrap();
        ShareServer::start(target, Side::Right).unwrap()
    }

    impl ShareServer {
        fn push_step(&self, time: u64) {
            let step = SharedStep {
                angles: JointAngles::default(),
                pose: HandPose::new(Timestamp(time), Side::Right, 0.008),
            };
            let _ = self.steps.as_ref().unwrap().try_send(step);
        }

        fn connect(&self, number: usize) -> TcpStream {
            let stream = TcpStream::connect(self.target.address).unwrap();
            stream.set_read_timeout(Some(TIMEOUT)).unwrap();
            self.wait_for(number);
            stream
        }

        fn wait_for(&self, clients: usize) {
            let start = Instant::now();
            while self.clients.load(Ordering::Relaxed) != clients {
                assert!(start.elapsed() < TIMEOUT, "not {clients} clients");
                self.push_step(1);
                thread::sleep(Duration::from_millis(1));
            }
        }
    }

    #[test]
    fn a_client_that_reads_nothing_is_disconnected_and_the_others_are_served() {
        let server = server("text-line");
        let _silent = server.connect(1);
        let reader = server.connect(2);
        let lines = thread::spawn(move || {
            let lines = BufReader::new(reader).lines().map_while(Result::ok);
            lines
                .map(|line| line.split_ascii_whitespace().count())
                .collect::<Vec<_>>()
        });
        server.wait_for(1);
        drop(server);
        let lines = lines.join().unwrap();
        assert!(lines.len() > 100, "{} lines", lines.len());
        assert!(lines.iter().all(|&values| values == 64));
    }

    #[test]
    fn a_client_that_sends_is_disconnected() {
        let server = server("pose");
        let mut browser = server.connect(1);
        browser.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
        server.wait_for(0);
        let mut rest = Vec::new();
        // The connection may be reset instead of closed, as not all that was sent was read.
        let _ = browser.read_to_end(&mut rest);
        assert!(rest.iter().all(|byte| *byte != b'<'));
    }

    #[test]
    fn the_port_is_free_again_after_the_server() {
        let server = server("angles");
        let target = server.target();
        drop(server);
        let start = Instant::now();
        while ShareServer::start(target, Side::Right).is_err() {
            assert!(start.elapsed() < TIMEOUT, "{target} is still in use");
            thread::sleep(Duration::from_millis(5));
        }
    }
}
