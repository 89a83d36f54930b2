//! The admission of clients to a server: TLS and a token, off the thread that accepts connections.

mod handshakes;
mod unproven;

pub use self::unproven::Unproven;

use std::fmt;
use std::io::{self, Read, Write};
use std::net::{IpAddr, Shutdown, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

use rustls::{ServerConfig, ServerConnection, StreamOwned};

use self::handshakes::Handshakes;
use super::failed_tries::{FailedTries, network_of};
use super::hello;
use super::identity::Identity;
use super::token::{Hash, Token};
use super::token_list::TokenList;
use crate::advice;
use crate::network::{Admitted, DeadlineStream, MemoryStream, NetworkError, TokenEntry, TokenRole};

/// Longest time for the handshake and the token.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest time of a read or write afterwards, unless the server does not wait at all.
const IO_TIMEOUT: Duration = Duration::from_millis(50);

/// Threads of handshakes, including those that are about to end. Further connections are closed.
const MAX_THREADS: usize = 256;

/// Interval at which clients with revoked tokens are looked for.
const REVOCATION_INTERVAL: Duration = Duration::from_secs(1);

/// The keeper of one server. A clone is the same keeper.
#[derive(Clone)]
pub struct Gatekeeper(Arc<Shared>);

struct Shared {
    config: Arc<ServerConfig>,
    folder: PathBuf,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    tries: FailedTries,
    handshakes: Handshakes,
    threads: usize,
    /// The token of each connected client.
    clients: Vec<(Hash, Weak<TcpStream>)>,
}

impl fmt::Debug for Gatekeeper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Gatekeeper")
            .field("folder", &self.0.folder)
            .finish_non_exhaustive()
    }
}

impl Gatekeeper {
    /// Uses the certificate and the tokens in a folder. Fails if there are no tokens.
    pub fn open(folder: &Path) -> Result<Self, NetworkError> {
        Self::with_handshakes(folder, Handshakes::default(), TokenRole::See)
    }

    /// As [`open`](Self::open), for a server of pages, whose clients show their tokens after a request and at least point.
    pub fn open_for_pages(folder: &Path) -> Result<Self, NetworkError> {
        Self::with_handshakes(folder, Handshakes::of_browsers(), TokenRole::Point)
    }

    /// Fails if no token has at least this role.
    fn with_handshakes(
        folder: &Path,
        handshakes: Handshakes,
        role: TokenRole,
    ) -> Result<Self, NetworkError> {
        let list = TokenList::read(folder)?;
        if !list.entries().any(|token| token.role >= role) {
            return Err(NetworkError::Token(format!(
                "there is no token with which a client could connect; make one: ademan token new NAME --role {role}"
            )));
        }
        let keeper = Self(Arc::new(Shared {
            config: Identity::open(folder)?.server_config()?,
            folder: folder.into(),
            state: Mutex::new(State {
                handshakes,
                ..State::default()
            }),
        }));
        let shared = Arc::downgrade(&keeper.0);
        thread::Builder::new()
            .name("tokens".into())
            .spawn(move || disconnect_revoked(&shared))
            .map_err(|error| NetworkError::Token(advice::no_thread(&error).to_string()))?;
        Ok(keeper)
    }

    /// Admits a client on a thread of its own, or closes its connection. Does not wait.
    pub fn admit(
        &self,
        stream: TcpStream,
        address: IpAddr,
        on_admitted: impl FnOnce(Admitted) + Send + 'static,
    ) {
        let Some(handshake) = Handshake::begin(self.0.clone(), stream, address) else {
            return;
        };
        // Without a thread the connection is closed.
        let _ = thread::Builder::new()
            .name("handshake".into())
            .spawn(move || {
                let admitted = handshake.run();
                drop(handshake);
                match admitted {
                    Ok(Some(admitted)) => on_admitted(admitted),
                    Ok(None) => {}
                    Err(error) => tracing::debug!("a handshake has failed: {error}"),
                }
            });
    }

    /// Returns what a client receives that sends these bytes and no more.
    pub fn answer(&self, bytes: &[u8]) -> Vec<u8> {
        let stream = MemoryStream::new(usize::MAX);
        stream.send(bytes);
        // It fails where the bytes end.
        let _ = receive_token(&self.0.config, stream.clone());
        stream.take_received()
    }
}

/// Performs the handshake of TLS and receives the token of a client; `None` if its first line is not a token.
fn receive_token<S: Read + Write>(
    config: &Arc<ServerConfig>,
    stream: S,
) -> io::Result<(Option<Token>, StreamOwned<ServerConnection, S>)> {
    let connection = ServerConnection::new(config.clone()).map_err(io::Error::other)?;
    let mut stream = StreamOwned::new(connection, stream);
    Ok((hello::receive(&mut stream)?, stream))
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A handshake in progress, which counts until it is dropped.
struct Handshake {
    shared: Arc<Shared>,
    address: IpAddr,
    number: u64,
    socket: Arc<TcpStream>,
}

impl Handshake {
    /// Begins a handshake, unless the address has shown too many wrong tokens. If there are too many handshakes, the oldest of
    /// the address that has most of them makes room.
    fn begin(shared: Arc<Shared>, stream: TcpStream, address: IpAddr) -> Option<Self> {
        let socket = Arc::new(stream);
        let number = {
            let mut state = shared.state();
            if state.threads >= MAX_THREADS || state.tries.is_paused(address, Instant::now()) {
                return None;
            }
            state.threads += 1;
            state.handshakes.add(network_of(address), &socket)
        };
        Some(Self {
            shared,
            address,
            number,
            socket,
        })
    }

    /// Performs the handshake and checks the token. Returns `None` after a wrong one.
    fn run(&self) -> io::Result<Option<Admitted>> {
        // The stream of a listener that does not wait may not wait either.
        self.socket.set_nonblocking(false)?;
        let stream = DeadlineStream::new(self.socket.clone(), HANDSHAKE_TIMEOUT)?;
        let (token, mut stream) = receive_token(&self.shared.config, stream)?;
        let Some((hash, entry)) = self.find(token.as_ref())? else {
            hello::answer(&mut stream, false)?;
            return Ok(None);
        };
        hello::answer(&mut stream, true)?;
        stream.sock.end_deadline(IO_TIMEOUT)?;
        self.register(hash);
        Ok(Some(Admitted {
            stream: Box::new(stream),
            token: entry,
        }))
    }

    /// Returns the hash and the entry of a token; `None` if it is wrong, which counts.
    fn find(&self, token: Option<&Token>) -> io::Result<Option<(Hash, TokenEntry)>> {
        let hash = token.map(Token::hash);
        let list = TokenList::read(&self.shared.folder).map_err(io::Error::other)?;
        let listed = hash.and_then(|hash| Some((hash, list.find(&hash)?.entry.clone())));
        Ok(self.judge(listed))
    }

    /// Disconnects the client once its token is revoked.
    fn register(&self, hash: Hash) {
        let client = (hash, Arc::downgrade(&self.socket));
        self.shared.state().clients.push(client);
    }

    /// Counts a wrong token. A valid one is refused too while the address has to wait: other tries may have failed since the
    /// handshake began. It resets no count, or the holder of a weak token could try others between its own.
    fn judge<T>(&self, listed: Option<T>) -> Option<T> {
        let (mut state, now) = (self.shared.state(), Instant::now());
        if state.tries.is_paused(self.address, now) {
            return None;
        }
        if listed.is_none() {
            let pause = state.tries.count(self.address, now);
            drop(state);
            report_wrong_token(self.address, pause);
        }
        listed
    }
}

impl Drop for Handshake {
    fn drop(&mut self) {
        let mut state = self.shared.state();
        state.handshakes.remove(self.number);
        state.threads -= 1;
    }
}

fn report_wrong_token(address: IpAddr, pause: Duration) {
    match pause {
        Duration::ZERO => tracing::warn!("refused a client at {address}: its token is not valid"),
        pause => tracing::warn!(
            "refused a client at {address}: its token is not valid, as were too many before it; its connections are closed for {} s",
            pause.as_secs()
        ),
    }
}

/// Disconnects clients whose tokens are no longer in the list, until the keeper is dropped. If the list cannot
/// be read, all clients are disconnected.
fn disconnect_revoked(shared: &Weak<Shared>) {
    loop {
        thread::sleep(REVOCATION_INTERVAL);
        let Some(shared) = shared.upgrade() else {
            return;
        };
        shared
            .state()
            .clients
            .retain(|(_, client)| client.strong_count() > 0);
        if shared.state().clients.is_empty() {
            continue;
        }
        let list = TokenList::read(&shared.folder).unwrap_or_default();
        for (hash, client) in &shared.state().clients {
            if list.find(hash).is_none()
                && let Some(socket) = client.upgrade()
            {
                let _ = socket.shutdown(Shutdown::Both);
            }
        }
    }
}

#[cfg(test)]
mod tests;
