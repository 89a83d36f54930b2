//! Clients of a router, with the library `zenoh`.
//!
//! The library runs its own threads, which all sessions of the process share.

use std::io::{self, ErrorKind, Read, Write};
use std::net::SocketAddr;
use std::time::Duration;

use zenoh::handlers::{RingChannel, RingChannelHandler};
use zenoh::qos::CongestionControl;
use zenoh::sample::Sample;
use zenoh::{Config, Session, Wait};

use super::ZenohError;
use crate::network::Stream;

/// Longest time of one read.
const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// Messages that wait for the source. Older ones are dropped.
const QUEUE_CAPACITY: usize = 64;

/// Longest message that is read, in bytes. A longer one is dropped.
const MAX_MESSAGE_BYTES: usize = 1 << 16;

/// The messages of one key. Each read returns one message.
pub struct Subscriber {
    messages: zenoh::pubsub::Subscriber<RingChannelHandler<Sample>>,
    _session: Session,
}

impl Subscriber {
    /// Connects to a router and subscribes to a key. The library reconnects by itself when the router is lost later.
    pub fn open(router: SocketAddr, key: &str) -> Result<Self, ZenohError> {
        let session = connect(router)?;
        let subscriber = session.declare_subscriber(key.to_owned());
        let subscriber = subscriber.with(RingChannel::new(QUEUE_CAPACITY)).wait();
        Ok(Self {
            messages: subscriber.map_err(|error| router_error(router, &error))?,
            _session: session,
        })
    }
}

impl Read for Subscriber {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let received = self.messages.recv_timeout(READ_TIMEOUT);
        let ended = |error| io::Error::new(ErrorKind::ConnectionAborted, format!("{error}"));
        let Some(sample) = received.map_err(ended)? else {
            return Err(ErrorKind::WouldBlock.into());
        };
        let payload = sample.payload();
        let length = payload.len();
        if length == 0 || length > buffer.len().min(MAX_MESSAGE_BYTES) {
            return Err(ErrorKind::WouldBlock.into());
        }
        payload.reader().read_exact(&mut buffer[..length])?;
        Ok(length)
    }
}

/// A publisher that sends each line that is written as one message.
pub struct Publisher {
    publisher: zenoh::pubsub::Publisher<'static>,
    /// The start of a line.
    line: Vec<u8>,
    _session: Session,
}

impl Publisher {
    /// Connects to a router, to publish a key.
    pub fn open(router: SocketAddr, key: &str) -> Result<Self, ZenohError> {
        let session = connect(router)?;
        // A message that the router does not accept at once is dropped: the next one is newer.
        let publisher = session.declare_publisher(key.to_owned());
        let publisher = publisher
            .congestion_control(CongestionControl::Drop)
            .express(true)
            .wait();
        Ok(Self {
            publisher: publisher.map_err(|error| router_error(router, &error))?,
            line: Vec::new(),
            _session: session,
        })
    }
}

impl Stream for Publisher {
    /// Does nothing: no call of a publisher waits.
    fn set_nonblocking(&self, _: bool) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Publisher {
    /// Reads nothing: subscribers send no requests to a publisher.
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        Err(ErrorKind::WouldBlock.into())
    }
}

impl Write for Publisher {
    /// Publishes all complete lines. Fails only when the session of the library has ended.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for part in bytes.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend_from_slice(part);
            if part.ends_with(b"\n") {
                let put = self.publisher.put(self.line.as_slice()).wait();
                self.line.clear();
                put.map_err(|error| {
                    io::Error::new(ErrorKind::ConnectionAborted, format!("{error}"))
                })?;
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Connects as a client of one router.
fn connect(router: SocketAddr) -> Result<Session, ZenohError> {
    let config = config(router).map_err(|error| router_error(router, &error))?;
    zenoh::open(config)
        .wait()
        .map_err(|error| router_error(router, &error))
}

/// Returns the settings of a client that neither searches for routers nor listens.
fn config(router: SocketAddr) -> zenoh::Result<Config> {
    let mut config = Config::default();
    for (key, value) in [
        ("mode", "\"client\"".to_owned()),
        ("connect/endpoints", format!("[\"tcp/{router}\"]")),
        ("listen/endpoints", "[]".to_owned()),
        ("scouting/multicast/enabled", "false".to_owned()),
        ("scouting/gossip/enabled", "false".to_owned()),
    ] {
        config.insert_json5(key, &value)?;
    }
    Ok(config)
}

fn router_error(router: SocketAddr, error: &zenoh::Error) -> ZenohError {
    ZenohError::Router {
        router,
        reason: error.to_string(),
    }
}
