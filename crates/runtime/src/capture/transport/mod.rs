//! Transports: carriers of byte streams and datagrams.
//!
//! To add a transport, write its file with a [`Transport`] constant and list the constant in [`TRANSPORTS`].

mod descriptor;
mod file;
mod headset;
pub(super) mod openxr;
pub(super) mod serial;
mod stdin;
pub(super) mod tcp;
mod tcp_tls;
mod udp;
mod usb_port;
pub(crate) mod websocket;
mod zenoh;

pub use headset::HeadsetPages;

use std::fmt;
use std::io;
use std::net::SocketAddr;
use std::num::NonZeroU32;
use std::time::Duration;

use super::connection::Connector;
use super::protocol::StreamFormat;
use super::stream::StreamSource;
use super::{CaptureError, Source};
use ademan_core::hand::Side;
use ademan_core::message::escape;

pub(crate) use self::openxr::{HAS_OPENXR, describe_runtime};

/// All transports.
pub const TRANSPORTS: &[&Transport] = &[
    &serial::TRANSPORT,
    &tcp::TRANSPORT,
    &tcp_tls::TRANSPORT,
    &udp::TRANSPORT,
    &websocket::TRANSPORT,
    &headset::TRANSPORT,
    &zenoh::TRANSPORT,
    &openxr::TRANSPORT,
    &file::TRANSPORT,
    &stdin::TRANSPORT,
];

/// A function that tries to open the source at an address. An error states the cause and the remedy.
type Probe = fn(&str) -> Result<(), String>;

/// A carrier of bytes: the form of its URI and how it is opened.
#[derive(Debug)]
pub struct Transport {
    /// Form of its URI.
    pub scheme: Scheme,
    /// `true` if other programs on the network may send readings too.
    pub is_remote: bool,
    /// `true` if it carries datagrams, each of whole packets, and not a stream.
    pub is_datagram: bool,
    /// `true` if it needs a token file.
    pub needs_token: bool,
    /// `true` if the device or server may appear after the program has started.
    pub is_device: bool,
    /// `true` if the URI has an address.
    pub has_address: bool,
    /// Bit rate if neither the URI nor the protocol states one. `None` if the transport is not a serial line.
    pub default_baud: Option<NonZeroU32>,
    /// Checks that a source at this address can be opened, without reading from it. `None` if opening it has an effect on the
    /// device, or takes long.
    pub(super) probe: Option<Probe>,
    /// Checks an address; an error states what is wrong with it.
    pub(super) check_address: fn(&str) -> Result<(), String>,
    /// Opens the source.
    pub(super) open: fn(&StreamUri) -> Result<Box<dyn Source>, CaptureError>,
}

impl Transport {
    /// Returns `true` if only one source at a time can have an address.
    pub fn is_exclusive(&self) -> bool {
        ["serial", "udp", "ws", "headset", "stdin"].contains(&self.scheme.name)
    }
}

impl PartialEq for Transport {
    fn eq(&self, other: &Self) -> bool {
        self.scheme == other.scheme
    }
}

impl Eq for Transport {}

/// One form of source URI, for help texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scheme {
    /// Text before the colon.
    pub name: &'static str,
    /// The URI with its parts in capitals.
    pub syntax: &'static str,
    /// One line, in lower case and without a full stop.
    pub summary: &'static str,
    /// A valid URI.
    pub example: &'static str,
}

/// A transport, its address and the format of its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StreamUri {
    /// Carrier of the bytes.
    pub transport: &'static Transport,
    /// Port, host and port, or path; empty for transports without an address.
    pub address: String,
    /// Format of the bytes.
    pub format: StreamFormat,
    /// Time from a movement to the arrival of its reading, 0 to [`MAX_DELAY`].
    pub delay: Duration,
    /// Page in a browser that may connect, such as `https://example.org`; for a WebSocket only.
    pub origin: Option<String>,
    /// File with the token for the server: a path, or a name in the network folder.
    pub token_file: Option<String>,
    /// Router of zenoh, if another one than the default.
    pub router: Option<SocketAddr>,
    /// The page and the layout of a server of headsets.
    pub pages: Option<HeadsetPages>,
    /// Rate at which an OpenXR runtime is asked for the hands, in hertz; `None` for the rate of its display.
    pub rate_hz: Option<u32>,
}

/// Longest delay of a source.
pub const MAX_DELAY: Duration = Duration::from_millis(500);

impl StreamUri {
    /// Creates a URI without a delay, and without the options that only some transports have.
    pub(super) fn new(
        transport: &'static Transport,
        address: String,
        format: impl Into<StreamFormat>,
    ) -> Self {
        Self {
            transport,
            address,
            format: format.into(),
            delay: Duration::ZERO,
            origin: None,
            token_file: None,
            router: None,
            pages: None,
            rate_hz: None,
        }
    }

    /// Returns the stream for the hands that it measures in a setup: one that shows a single hand, and does not state which, shows the
    /// hand of the setup.
    #[must_use]
    pub fn for_sides(&self, sides: &[Side]) -> Self {
        let mut stream = self.clone();
        if let ([side], false) = (sides, stream.format.protocol.has_both_hands) {
            stream.format = stream.format.for_hand_unless_stated(*side);
        }
        stream
    }
}

impl fmt::Display for StreamUri {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = self.transport.scheme.name;
        write!(f, "{scheme}:{}{}", self.address, self.format)?;
        if self.delay > Duration::ZERO {
            write!(f, "&delay_ms={}", self.delay.as_millis())?;
        }
        if let Some(origin) = &self.origin {
            write!(f, "&origin={origin}")?;
        }
        if let Some(file) = &self.token_file {
            write!(f, "&token_file={}", written_path(file))?;
        }
        if let Some(pages) = &self.pages {
            write!(f, "&page={}", written_path(&pages.folder))?;
            if let Some(layout) = &pages.layout {
                write!(f, "&layout={}", written_path(layout))?;
            }
        }
        if let Some(router) = &self.router {
            write!(f, "&router={router}")?;
        }
        match self.rate_hz {
            Some(rate) => write!(f, "&rate_hz={rate}"),
            None => Ok(()),
        }
    }
}

/// Returns a path as the value of an option, such as `page`. The characters that separate options are escaped as in links.
pub fn written_path(path: &str) -> String {
    let escaped = path.replace('%', "%25");
    escaped.replace('&', "%26").replace('?', "%3F")
}

/// Returns the path in the value of an option.
pub(super) fn parse_path(value: &str) -> String {
    let separators = value.replace("%26", "&").replace("%3F", "?");
    separators.replace("%25", "%")
}

/// Opens the source of `uri` through `connector`.
fn open_stream(
    uri: &StreamUri,
    connector: impl Connector,
) -> Result<Box<dyn Source>, CaptureError> {
    let source = StreamSource::open(uri.to_string(), uri.format.clone(), connector)?;
    Ok(if uri.transport.is_remote {
        Box::new(source.drop_old_readings())
    } else {
        Box::new(source)
    })
}

/// The remedy for an address at which this machine cannot listen.
const LISTEN_REMEDY: &str = "use 127.0.0.1 and a free port";

/// Returns the remedy for an error of a socket that listens.
fn listen_remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::AddrInUse => "another program or source has this port: choose a free one",
        _ => LISTEN_REMEDY,
    }
}

/// Checks an address that cannot contain a `?`.
fn check_no_question_mark(address: &str) -> Result<(), String> {
    if address.contains('?') {
        return Err("the text after `?` is not a list of options such as `baud=115200`".to_owned());
    }
    Ok(())
}

/// Checks an address of the form `HOST:PORT`.
fn check_socket_address(scheme: Scheme, address: &str) -> Result<(), String> {
    check_no_question_mark(address)?;
    if let Some(authority) = address.strip_prefix("//") {
        return Err(format!(
            "write `{}:{}` without `//`",
            scheme.name,
            escape(authority.trim_end_matches('/'))
        ));
    }
    let port = address
        .rsplit_once(':')
        .filter(|(host, _)| !host.is_empty())
        .and_then(|(_, port)| port.parse::<u16>().ok());
    match port {
        Some(1..) => Ok(()),
        _ => Err(format!(
            "write `{}` with a port from 1 to 65535",
            scheme.syntax
        )),
    }
}
