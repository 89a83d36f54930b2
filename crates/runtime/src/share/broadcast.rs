//! The thread that sends to all clients and addresses.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, never, select};

use super::client::Client;
use super::datagrams::DatagramSender;
use super::lines::{LineEncoder, Wanted};
use super::listener::Connection;
use super::rounds::Rounds;
use super::step::SharedStep;
use super::target::ShareTarget;
use crate::network::max_connections;
use ademan_core::time::NO_DEADLINE;

/// Most clients of a server at once. The one that has been silent for the longest time makes room for another; if there is
/// none, the other is disconnected.
const MAX_CLIENTS: usize = 128;

/// Interval at which the requests of clients are read.
const RECEIVE_INTERVAL: Duration = Duration::from_millis(20);

/// Time between two writes to a client, for each client: a write takes some 10 µs, so all of them together take a thirtieth
/// of a processor. A single client gets each line at once, and each of 100 clients the lines of 30 ms in one write.
const WRITE_INTERVAL_PER_CLIENT: Duration = Duration::from_micros(300);

/// The state of the thread.
pub(super) struct Broadcast {
    steps: Receiver<SharedStep>,
    connections: Receiver<Connection>,
    /// The targets of the servers, by their indices.
    servers: Vec<ShareTarget>,
    senders: Vec<DatagramSender>,
    clients: Vec<Client>,
    /// Most clients of all servers.
    max_clients: usize,
    /// The number of clients, for the session.
    count: Arc<AtomicUsize>,
    encoder: LineEncoder,
    rounds: Rounds,
    written_at: Instant,
    received_at: Instant,
}

impl Broadcast {
    /// Creates the state before the first step.
    pub fn new(
        steps: Receiver<SharedStep>,
        connections: Receiver<Connection>,
        servers: Vec<ShareTarget>,
        senders: Vec<DatagramSender>,
        encoder: LineEncoder,
        count: Arc<AtomicUsize>,
    ) -> Self {
        Self {
            steps,
            connections,
            servers,
            senders,
            clients: Vec::new(),
            max_clients: max_connections(),
            count,
            encoder,
            rounds: Rounds::default(),
            written_at: Instant::now(),
            received_at: Instant::now(),
        }
    }

    /// Shares steps until the session ends.
    pub fn run(&mut self) {
        loop {
            select! {
                recv(self.steps) -> step => match step {
                    Ok(step) => self.share(&step),
                    Err(_) => break,
                },
                recv(self.connections) -> connection => match connection {
                    Ok(connection) => self.add(connection),
                    Err(_) => self.connections = never(),
                },
                default(self.timeout()) => {}
            }
            self.write();
            self.receive();
            self.count.store(self.clients.len(), Ordering::Relaxed);
        }
        self.end_round();
        for client in &mut self.clients {
            let _ = client.flush();
        }
    }

    fn timeout(&self) -> Duration {
        if self.clients.is_empty() {
            return NO_DEADLINE;
        }
        let is_behind = !self.rounds.is_empty() || self.clients.iter().any(Client::is_behind);
        let write_in = if is_behind {
            self.write_interval().max(Duration::from_millis(1))
        } else {
            RECEIVE_INTERVAL
        };
        write_in.min(RECEIVE_INTERVAL)
    }

    fn write_interval(&self) -> Duration {
        WRITE_INTERVAL_PER_CLIENT * (self.clients.len() - 1) as u32
    }

    /// Adds a client, or closes its connection if it is one too many.
    pub fn add(&mut self, connection: Connection) {
        let server = connection.server;
        if !self.make_room(server) {
            tracing::debug!("a client of {} is one too many", self.servers[server]);
            return;
        }
        // The lines before it came are not its own.
        self.end_round();
        let client = Client::new(connection, &self.servers[server]);
        self.clients.push(client);
    }

    /// Disconnects the client that has been silent for the longest time, if there are too many. Returns `false` if no client
    /// is silent.
    fn make_room(&mut self, server: usize) -> bool {
        let clients = self.clients.iter();
        let is_server_full = clients.filter(|it| it.server == server).count() >= MAX_CLIENTS;
        if !is_server_full && self.clients.len() < self.max_clients {
            return true;
        }
        loop {
            let numbered = self.clients.iter().enumerate();
            let silent = numbered
                .filter(|(_, client)| !is_server_full || client.server == server)
                .filter_map(|(index, client)| Some((client.silent_since()?, index)));
            let Some((_, index)) = silent.min() else {
                return false;
            };
            // Its request may have arrived since the last round.
            let client = &mut self.clients[index];
            if client.receive().is_err() || client.silent_since().is_some() {
                self.clients.remove(index);
                return true;
            }
        }
    }

    fn share(&mut self, step: &SharedStep) {
        for sender in &mut self.senders {
            sender.send(step);
        }
        let mut wanted = Wanted::default();
        for client in &mut self.clients {
            client.start_step(step, &mut wanted);
        }
        let lines = self.encoder.encode(step, &wanted);
        for line in lines.iter().filter(|line| line.kind.is_plain()) {
            self.rounds.push(line);
        }
        for client in &mut self.clients {
            client.push(lines);
        }
    }

    /// Sends the lines since the last write to the clients without requests.
    fn end_round(&mut self) {
        let clients = &mut self.clients;
        self.rounds.take(|kind, round| {
            for client in clients.iter_mut().filter(|it| it.has_rounds_of(kind)) {
                client.push_round(round.clone());
            }
        });
    }

    /// Writes to all clients if that is due, and disconnects those that do not read.
    fn write(&mut self) {
        if !self.clients.is_empty() && self.written_at.elapsed() >= self.write_interval() {
            self.written_at = Instant::now();
            self.end_round();
            self.clients.retain_mut(|client| client.flush().is_ok());
        }
    }

    /// Reads the requests of clients if that is due, and disconnects those that may not send.
    fn receive(&mut self) {
        if !self.clients.is_empty() && self.received_at.elapsed() >= RECEIVE_INTERVAL {
            self.received_at = Instant::now();
            let encoder = &mut self.encoder;
            self.clients.retain_mut(|client| {
                let is_alive = client.receive().is_ok();
                client.catch_up(encoder);
                is_alive
            });
        }
    }
}
