//! The clients of a server: which of them are connected, and which one is read.

use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::capture::active_sender::ActiveSender;

/// Most clients that are connected while none is active. Beyond them, the oldest makes room.
const MAX_CLIENTS: usize = 16;

/// Most threads of clients, including those that are about to end.
const MAX_THREADS: usize = 64;

/// The number of a client, in the order of their connections.
pub(in crate::capture::transport) type ClientId = u64;

/// The clients of a server. Locked for a moment only.
#[derive(Default)]
pub(in crate::capture::transport) struct Clients(Mutex<State>);

#[derive(Default)]
struct State {
    /// The connected clients, the oldest first, also those that have not sent their request.
    connected: Vec<(ClientId, Arc<TcpStream>)>,
    senders: ActiveSender<ClientId>,
    latest: ClientId,
    threads: usize,
}

impl Clients {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a connection. Returns its number, or `None` if it is refused: one client is read at a time.
    pub fn add(&self, stream: &Arc<TcpStream>) -> Option<ClientId> {
        let mut state = self.state();
        let is_active = state.senders.get(Instant::now()).is_some();
        if is_active {
            return None;
        }
        if state.connected.len() == MAX_CLIENTS {
            state.make_room();
        }
        state.latest += 1;
        state.threads += 1;
        let id = state.latest;
        state.connected.push((id, Arc::clone(stream)));
        Some(id)
    }

    /// Returns `true` if as many threads run as may. Most of them are about to end.
    pub fn are_too_many(&self) -> bool {
        self.state().threads >= MAX_THREADS
    }

    /// Removes a client whose thread ends.
    pub fn remove(&self, id: ClientId) {
        let mut state = self.state();
        state.connected.retain(|(other, _)| *other != id);
        state.threads -= 1;
    }

    /// Returns `true` if a client was not disconnected.
    pub fn is_connected(&self, id: ClientId) -> bool {
        let state = self.state();
        state.connected.iter().any(|(other, _)| *other == id)
    }

    /// Handles bytes of a client. Returns `false` if they are dropped because another client is active.
    pub fn read_from(&self, id: ClientId) -> bool {
        self.state().senders.read_from(id, Instant::now())
    }

    /// Returns `true` if bytes of another client were read since the latest call.
    pub fn take_change(&self) -> bool {
        self.state().senders.take_change()
    }

    /// Makes the client active whose bytes were read last, and disconnects all others. Returns `true` unless it was active
    /// before.
    pub fn accept(&self) -> bool {
        let mut state = self.state();
        let is_new = state.senders.accept(Instant::now()).is_some();
        if state.connected.len() > 1 {
            let active = state.senders.last();
            state.disconnect(|id| Some(id) != active);
        }
        is_new
    }

    /// Handles the end of a client. Returns `true` if it was the latest active one: the hand is lost with it.
    pub fn leave(&self, id: ClientId) -> bool {
        let mut state = self.state();
        let is_lost = state.senders.last() == Some(id);
        if is_lost {
            state.senders = ActiveSender::default();
        }
        is_lost
    }

    /// Disconnects all clients.
    pub fn disconnect_all(&self) {
        self.state().disconnect(|_| true);
    }
}

impl State {
    /// Disconnects the oldest client. One that has sent packets before stays, as it may send again.
    fn make_room(&mut self) {
        let last = self.senders.last();
        let mut ids = self.connected.iter().map(|(id, _)| *id);
        let oldest = ids.find(|id| Some(*id) != last);
        self.disconnect(|id| Some(id) == oldest);
    }

    fn disconnect(&mut self, is_meant: impl Fn(ClientId) -> bool) {
        self.connected.retain(|(id, stream)| {
            if is_meant(*id) {
                let _ = stream.shutdown(Shutdown::Both);
            }
            !is_meant(*id)
        });
    }
}
