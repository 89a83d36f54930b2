//! The connected clients, and which of them makes room for another one.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::line_writer::LineWriter;

/// Largest number of connected clients.
pub(super) const MAX_CLIENTS: usize = 16;

/// Largest number of clients that receive notifications. They are not disconnected for others, so one place is left for
/// commands.
pub(super) const MAX_SUBSCRIBERS: usize = MAX_CLIENTS - 1;

/// Longest wait for a client that is about to have its response, or that has left: its thread may not have noted that yet.
const PLACE_TIMEOUT: Duration = Duration::from_millis(500);

/// The connected clients, at most [`MAX_CLIENTS`].
///
/// A client that is idle is disconnected when another one needs its place: programs that hold a connection open must not
/// keep a person from pausing the session.
#[derive(Clone, Default)]
pub(super) struct Clients(Arc<Shared>);

#[derive(Default)]
struct Shared {
    list: Mutex<ClientList>,
    /// Notified when a client becomes idle or leaves.
    place: Condvar,
}

#[derive(Default)]
struct ClientList {
    clients: Vec<ConnectedClient>,
    /// Number of changes so far, as the time of [`Activity`].
    changes: u64,
}

struct ConnectedClient {
    id: u64,
    activity: Activity,
    writer: Arc<LineWriter>,
}

/// The state of a client. The smallest one is disconnected first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Activity {
    /// The client has sent no request since it connected.
    Silent(u64),
    /// The client has received its last response.
    Idle(u64),
    /// The request of the client is being executed.
    Busy,
    /// The client receives notifications.
    Subscribed,
}

impl Clients {
    /// Adds a client. If all slots are taken, disconnects the client that has been idle for the longest time. Returns `None` if no
    /// client becomes idle within [`PLACE_TIMEOUT`].
    pub fn add(&self, writer: Arc<LineWriter>) -> Option<ClientSlot> {
        let mut list = self.lock();
        let deadline = Instant::now() + PLACE_TIMEOUT;
        while list.clients.len() >= MAX_CLIENTS && list.disconnect_idle().is_none() {
            let remaining = deadline.saturating_duration_since(Instant::now());
            if remaining.is_zero() {
                return None;
            }
            let waited = self.0.place.wait_timeout(list, remaining);
            (list, _) = waited.unwrap_or_else(PoisonError::into_inner);
        }
        let id = list.next_change();
        list.clients.push(ConnectedClient {
            id,
            activity: Activity::Silent(id),
            writer,
        });
        Some(ClientSlot {
            clients: self.clone(),
            id,
        })
    }

    /// Disconnects the client that has been idle for the longest time. Returns `false` if no client is idle.
    pub fn disconnect_idle(&self) -> bool {
        self.lock().disconnect_idle().is_some()
    }

    fn lock(&self) -> MutexGuard<'_, ClientList> {
        let list = self.0.list.lock();
        list.unwrap_or_else(PoisonError::into_inner)
    }
}

impl ClientList {
    fn next_change(&mut self) -> u64 {
        self.changes += 1;
        self.changes
    }

    fn find(&mut self, id: u64) -> Option<&mut ConnectedClient> {
        self.clients.iter_mut().find(|client| client.id == id)
    }

    fn disconnect_idle(&mut self) -> Option<()> {
        let clients = self.clients.iter().enumerate();
        let (index, idlest) = clients.min_by_key(|(_, client)| client.activity)?;
        if idlest.activity >= Activity::Busy {
            return None;
        }
        self.clients.swap_remove(index).writer.shutdown();
        Some(())
    }
}

/// The place of a client, which is free again when the slot is dropped.
pub(super) struct ClientSlot {
    clients: Clients,
    id: u64,
}

impl ClientSlot {
    /// Notes that a request is being executed. Returns `false` if the client was disconnected.
    pub fn begin_request(&self) -> bool {
        let mut list = self.clients.lock();
        let client = list.find(self.id);
        if let Some(client) = client {
            client.activity = client.activity.max(Activity::Busy);
            return true;
        }
        false
    }

    /// Notes that the response was written.
    pub fn end_request(&self) {
        let mut list = self.clients.lock();
        let now = list.next_change();
        if let Some(client) = list.find(self.id)
            && client.activity == Activity::Busy
        {
            client.activity = Activity::Idle(now);
            self.clients.0.place.notify_all();
        }
    }

    /// Notes that the client receives notifications. Returns `false` if too many do.
    pub fn subscribe(&self) -> bool {
        let mut list = self.clients.lock();
        let is_subscribed = |client: &&ConnectedClient| client.activity == Activity::Subscribed;
        let has_room = list.clients.iter().filter(is_subscribed).count() < MAX_SUBSCRIBERS;
        if has_room && let Some(client) = list.find(self.id) {
            client.activity = Activity::Subscribed;
        }
        has_room
    }
}

impl Drop for ClientSlot {
    fn drop(&mut self) {
        self.clients
            .lock()
            .clients
            .retain(|client| client.id != self.id);
        self.clients.0.place.notify_all();
    }
}
