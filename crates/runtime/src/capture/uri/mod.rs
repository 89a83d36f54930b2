//! Source URIs: `serial:/dev/ttyUSB0?protocol=hc11&baud=115200`.

use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use self::values::{parse_baud, parse_delay, parse_origin, parse_path, parse_token_file};
use super::protocol::{Carriers, PROTOCOLS, Protocol, StreamFormat};
use super::transport::{HeadsetPages, Scheme, StreamUri, TRANSPORTS, Transport, openxr};
use super::{CaptureError, PositionNoise};
use crate::files;
use crate::network::zenoh::parse_router;
use ademan_core::hand::Side;
use ademan_core::message::escape;
use ademan_core::names::{UnknownName, nearest};

/// Origin of readings.
///
/// | URI | source |
/// |---|---|
/// | `serial:PORT[?OPTIONS]` | serial port: `/dev/ttyUSB0`, `COM3`, `/dev/serial/by-id/…` |
/// | `tcp:HOST:PORT[?OPTIONS]` | TCP server, such as an RS232-to-TCP converter |
/// | `tcp+tls:HOST:PORT?token_file=FILE` | server of another machine, with TLS and a token |
/// | `udp:ADDRESS:PORT[?OPTIONS]` | datagrams from this machine: `udp:127.0.0.1:9000` |
/// | `file:PATH[?OPTIONS]` | bytes of a stream in a file |
/// | `ws:ADDRESS:PORT[?OPTIONS]` | WebSocket server on this machine: `ws:127.0.0.1:9001` |
/// | `headset:ADDRESS:PORT?page=FOLDER` | page for the browser of a headset, over TLS: `headset:192.168.1.7:8443` |
/// | `zenoh:KEY[?OPTIONS]` | key of a zenoh router on this machine: `zenoh:lab/desk-3/right` |
/// | `openxr:[?OPTIONS]` | hands that an OpenXR runtime tracks: `openxr:?rate_hz=120` |
/// | `stdin:[?OPTIONS]` | bytes of a stream on the standard input |
/// | `recording:PATH` | recording made by `ademan record` |
/// | `typist:TEXT` | simulated hand that types the text |
/// | `script:FILE` | simulated hand that plays a script file or the script itself |
///
/// Sources on the network (`tcp:`, `tcp+tls:`, `udp:`, `ws:`, `headset:`, `zenoh:`) press keys only with `role: Both` or
/// `role: Keys` in the setup, or with a token that grants it.
///
/// Options are `key=value` pairs joined by `&`: `protocol` (see [`PROTOCOLS`]), `baud` (bits per second of the serial
/// line, 1 or more), `delay_ms` (time from a movement to the arrival of its reading, 0 to 500, by which the sources of one
/// hand are aligned) and the options of the protocol.
///
/// With `?protocol=NAME` at its end, a text is typed through the bytes of that protocol: `typist:hello?protocol=vmc`. Options
/// of the protocol may follow.
///
/// Options start at the last `?` after which the text consists of such pairs; any other `?` belongs to the path. A
/// file whose name ends like options is written with an added option: `file:what?a=b?protocol=hc11`. The text after
/// `recording:` and `script:` has no options.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum SourceUri {
    /// A byte stream or datagrams.
    Stream(StreamUri),
    /// A recording of readings.
    Recording {
        /// The file.
        path: PathBuf,
    },
    /// A simulated hand that types a text.
    Typist {
        /// The text.
        text: String,
        /// The format of the bytes that the readings go through. `None` for the readings of the glove of the setup.
        format: Option<StreamFormat>,
    },
    /// A simulated hand that plays a script.
    Script {
        /// The script file, or the script itself.
        script: String,
    },
}

const RECORDING: Scheme = Scheme {
    name: "recording",
    syntax: "recording:PATH",
    summary: "recording made by `ademan record`",
    example: "recording:session.mcap",
};

const TYPIST: Scheme = Scheme {
    name: "typist",
    syntax: "typist:TEXT",
    summary: "simulated hand that types the text, with ?protocol=NAME through the bytes of that protocol",
    example: "typist:hello",
};

const SCRIPT: Scheme = Scheme {
    name: "script",
    syntax: "script:FILE",
    summary: "simulated hand that plays a script file or the script itself",
    example: "script:tap A; wait 100",
};

/// Returns all forms of source URI.
pub fn schemes() -> impl Iterator<Item = Scheme> {
    let transports = TRANSPORTS.iter().map(|transport| transport.scheme);
    transports.chain([RECORDING, TYPIST, SCRIPT])
}

impl SourceUri {
    /// Returns `true` if readings come over a network, where other programs may send some too.
    pub fn is_remote(&self) -> bool {
        matches!(self, Self::Stream(stream) if stream.transport.is_remote)
    }

    /// Returns `true` if the source is a device or server that may appear later.
    pub fn is_device(&self) -> bool {
        matches!(self, Self::Stream(stream) if stream.transport.is_device)
    }

    /// Returns the format of a byte stream, a real or a simulated one.
    pub fn format(&self) -> Option<&StreamFormat> {
        match self {
            Self::Stream(stream) => Some(&stream.format),
            Self::Typist { format, .. } => format.as_ref(),
            Self::Recording { .. } | Self::Script { .. } => None,
        }
    }

    /// Returns the protocol of a byte stream.
    pub fn protocol(&self) -> Option<&'static Protocol> {
        self.format().map(|format| format.protocol)
    }

    /// Returns `false` if the source measures joint angles, which need no glove file.
    pub fn needs_glove(&self) -> bool {
        self.protocol()
            .is_none_or(|protocol| protocol.sample.needs_glove())
    }

    /// Returns `true` if the source shows both hands.
    pub fn has_both_hands(&self) -> bool {
        self.protocol()
            .is_some_and(|protocol| protocol.has_both_hands)
    }

    /// Returns `true` if the source measures the arm and the fingers in readings of their own.
    pub fn has_parts(&self) -> bool {
        match self {
            Self::Stream(stream) => stream.format.protocol.has_parts,
            _ => false,
        }
    }

    /// Returns the time from a movement to the arrival of its reading.
    pub fn delay(&self) -> Duration {
        match self {
            Self::Stream(stream) => stream.delay,
            _ => Duration::ZERO,
        }
    }

    /// Returns the noise of the positions that the source measures.
    pub fn position_noise(&self) -> PositionNoise {
        let protocol = self.protocol();
        protocol.map_or(PositionNoise::None, |protocol| protocol.position_noise)
    }

    /// Returns the hand that the source measures or, of both, a setup with one hand reads. `None` if the glove determines the hand.
    pub fn hand(&self) -> Option<Side> {
        self.format()?.hand()
    }

    /// Returns the file with the token for the server: a path, or a name in the network folder.
    pub fn token_file(&self) -> Option<&str> {
        match self {
            Self::Stream(stream) => stream.token_file.as_deref(),
            _ => None,
        }
    }

    /// Checks that the source can be opened, without reading from it; texts and scripts always pass. `None` if opening would have an
    /// effect on the device, or take long. An error states the cause and the remedy.
    pub fn probe(&self) -> Option<Result<(), String>> {
        match self {
            Self::Stream(stream) => stream.transport.probe.map(|probe| probe(&stream.address)),
            Self::Recording { path } => {
                let opened = files::open_regular(path);
                Some(opened.map(drop).map_err(|error| error.to_string()))
            }
            Self::Typist { .. } | Self::Script { .. } => Some(Ok(())),
        }
    }

    /// Returns `true` for the hands of an OpenXR runtime (`openxr:`); `false` for the page of a headset (`headset:`).
    pub fn is_openxr(&self) -> bool {
        matches!(self, Self::Stream(stream) if stream.transport == &openxr::TRANSPORT)
    }

    /// Returns the address of the page that a headset opens, such as `192.168.1.7:8443`, if this source serves one.
    pub fn page_address(&self) -> Option<&str> {
        match self {
            Self::Stream(stream) if stream.pages.is_some() => Some(&stream.address),
            _ => None,
        }
    }

    /// Returns `true` if this source and another one cannot be open at the same time.
    pub fn excludes(&self, other: &Self) -> bool {
        let (Self::Stream(own), Self::Stream(other_stream)) = (self, other) else {
            return false;
        };
        let is_same =
            own.transport == other_stream.transport && own.address == other_stream.address;
        is_same && own.transport.is_exclusive()
    }

    /// Returns the serial port as the operating system names it.
    pub fn serial_port(&self) -> Option<&str> {
        match self {
            Self::Stream(stream) if stream.transport.scheme.name == "serial" => {
                Some(&stream.address)
            }
            _ => None,
        }
    }
}

impl FromStr for SourceUri {
    type Err = CaptureError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        parse(text).map_err(|reason| CaptureError::InvalidUri {
            text: text.to_owned(),
            reason,
        })
    }
}

fn parse(text: &str) -> Result<SourceUri, String> {
    let Some((scheme, rest)) = text.split_once(':') else {
        return Err(missing_scheme(text));
    };
    let transport = TRANSPORTS.iter().find(|known| known.scheme.name == scheme);
    if let Some(transport) = transport {
        return parse_stream(transport, rest).map(SourceUri::Stream);
    }
    let uri = match scheme {
        "recording" => SourceUri::Recording { path: rest.into() },
        "typist" => parse_typist(rest)?,
        "script" => SourceUri::Script {
            script: rest.into(),
        },
        host if is_host(host) && rest.parse::<u16>().is_ok() => {
            return Err(format!("write `tcp:{}`", escape(text)));
        }
        unknown => {
            let names: Vec<&str> = schemes().map(|it| it.name).collect();
            return Err(unknown_name("kind of source", unknown, &names));
        }
    };
    if rest.is_empty() {
        Err(format!("`{scheme}:` is followed by nothing"))
    } else {
        Ok(uri)
    }
}

/// Reads a text, whose options start with `protocol`: a text may end with a question.
fn parse_typist(rest: &str) -> Result<SourceUri, String> {
    let (text, format) = match rest.rsplit_once('?') {
        Some((_, options)) if !options.starts_with("protocol=") || !are_pairs(options) => {
            (rest, None)
        }
        Some(("", _)) => return Err("there is no text before the options".to_owned()),
        Some((text, options)) => (text, Some(parse_options(options, None)?.format)),
        None => (rest, None),
    };
    Ok(SourceUri::Typist {
        text: text.to_owned(),
        format,
    })
}

/// Returns `true` for an address of the internet or the name of a host with its domain.
fn is_host(text: &str) -> bool {
    text == "localhost" || text.contains('.')
}

fn missing_scheme(text: &str) -> String {
    if text.starts_with("/dev/") || text.starts_with("COM") {
        return format!("write `serial:{}`", escape(text));
    }
    if text.ends_with(".mcap") {
        return format!("write `recording:{}`", escape(text));
    }
    let schemes: Vec<&str> = schemes().map(|scheme| scheme.name).collect();
    let nearest = nearest(text, schemes.iter().copied());
    let suggestion = nearest.map_or(String::new(), |scheme| {
        format!(", did you mean `{scheme}:…`?")
    });
    let schemes: Vec<String> = schemes
        .iter()
        .map(|scheme| format!("`{scheme}:`"))
        .collect();
    format!(
        "a source starts with one of {}{suggestion}",
        schemes.join(", ")
    )
}

fn parse_stream(transport: &'static Transport, rest: &str) -> Result<StreamUri, String> {
    let (address, options) = match rest.rsplit_once('?') {
        Some((address, options)) if are_pairs(options) => (address, options),
        _ => (rest, ""),
    };
    let scheme = transport.scheme.name;
    if address.is_empty() && transport.has_address {
        return Err(match rest {
            "" => format!("`{scheme}:` is followed by nothing"),
            _ => "there is no address before the options".to_owned(),
        });
    }
    (transport.check_address)(address)?;
    let ParsedOptions {
        format,
        delay,
        origin,
        token_file,
        router,
        pages,
        rate_hz,
    } = parse_options(options, Some(transport))?;
    if transport.needs_token && token_file.is_none() {
        return Err(format!(
            "`{scheme}` needs the file of a token, which `ademan token new` makes on the other machine: `token_file=desk.token`"
        ));
    }
    let name = format.protocol.name;
    if scheme == "openxr" {
        openxr::check_protocol(name)?;
    }
    match format.protocol.carriers {
        Carriers::Streams if transport.is_datagram => Err(format!(
            "protocol `{name}` needs a stream from its start, which datagrams do not carry; use `file:` or `tcp:`"
        )),
        Carriers::Datagrams if !transport.is_datagram => Err(format!(
            "the packets of protocol `{name}` are datagrams, which a stream does not separate; use `udp:127.0.0.1:PORT`"
        )),
        _ => Ok(()),
    }?;
    Ok(StreamUri {
        delay,
        origin,
        token_file,
        router,
        pages,
        rate_hz,
        ..StreamUri::new(transport, address.to_owned(), format)
    })
}

fn are_pairs(options: &str) -> bool {
    let mut pairs = options
        .split('&')
        .filter(|pair| !pair.is_empty())
        .peekable();
    pairs.peek().is_some()
        && pairs.all(|pair| {
            let Some((key, _)) = pair.split_once('=') else {
                return false;
            };
            !key.is_empty()
                && key
                    .bytes()
                    .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
        })
}

/// The options of a stream.
struct ParsedOptions {
    format: StreamFormat,
    delay: Duration,
    origin: Option<String>,
    token_file: Option<String>,
    router: Option<SocketAddr>,
    pages: Option<HeadsetPages>,
    rate_hz: Option<u32>,
}

/// Reads the options of a stream; `transport` is `None` for a simulated person, which no transport delays.
fn parse_options(options: &str, transport: Option<&Transport>) -> Result<ParsedOptions, String> {
    let pairs = options.split('&').filter(|pair| !pair.is_empty());
    let pairs: Vec<(&str, &str)> = pairs
        .map(|pair| pair.split_once('=').unwrap_or((pair, "")))
        .collect();
    for (index, (key, _)) in pairs.iter().enumerate() {
        if pairs[..index].iter().any(|(other, _)| other == key) {
            return Err(format!("option `{}` is given twice", escape(key)));
        }
    }
    let scheme = transport.map_or("", |transport| transport.scheme.name);
    let needs_token = transport.is_some_and(|transport| transport.needs_token);
    let protocol = match pairs.iter().find(|(key, _)| *key == "protocol") {
        Some((_, name)) => find_protocol(name)?,
        // The text line is the form in which a hand is shared.
        None if scheme == "zenoh" => find_protocol("text-line")?,
        None if scheme == "headset" => find_protocol("webxr")?,
        None if scheme == "openxr" => find_protocol("openxr")?,
        None => PROTOCOLS[0],
    };
    let mut format = StreamFormat::new(protocol);
    format.baud = format
        .baud
        .or(transport.and_then(|transport| transport.default_baud));
    let (mut delay, mut origin) = (Duration::ZERO, None);
    let (mut token_file, mut router, mut rate_hz) = (None, None, None);
    let (mut page, mut layout) = (None, None);
    for (key, value) in pairs {
        match key {
            "protocol" => {}
            "baud" => format.baud = Some(parse_baud(value)?),
            "delay_ms" if transport.is_some() => delay = parse_delay(value)?,
            "origin" if scheme == "ws" => origin = Some(parse_origin(value)?),
            "token_file" if needs_token => token_file = Some(parse_token_file(value)?),
            "router" if scheme == "zenoh" => router = Some(parse_router(value)?),
            "page" if scheme == "headset" => page = Some(parse_path(value)),
            "layout" if scheme == "headset" => layout = Some(parse_path(value)),
            "rate_hz" if scheme == "openxr" => rate_hz = Some(openxr::parse_rate(value)?),
            _ => set_option(&mut format, key, value)?,
        }
    }
    Ok(ParsedOptions {
        format,
        delay,
        origin,
        token_file,
        router,
        pages: page.map(|folder| HeadsetPages { folder, layout }),
        rate_hz,
    })
}

fn find_protocol(name: &str) -> Result<&'static Protocol, String> {
    let mut protocols = PROTOCOLS.iter().copied();
    let names: Vec<&str> = PROTOCOLS.iter().map(|protocol| protocol.name).collect();
    protocols
        .find(|protocol| protocol.name == name)
        .ok_or_else(|| unknown_name("protocol", name, &names))
}

fn unknown_name(kind: &'static str, text: &str, available: &[&str]) -> String {
    let error = UnknownName::new(kind, text, available.iter().copied());
    format!("{error} (available: {})", available.join(", "))
}

fn set_option(format: &mut StreamFormat, key: &str, value: &str) -> Result<(), String> {
    match format.protocol.option(key) {
        Some(option) => format.options.set(option, value),
        None if key == "hand" && format.protocol.has_both_hands => Err(format!(
            "protocol `{}` has no option `hand`, as its packets have both arms; `other_hand` in the setup adds the left one",
            format.protocol.name
        )),
        None => {
            let names = ["protocol", "baud", "delay_ms"].into_iter();
            let options = format.protocol.options.iter();
            let names: Vec<&str> = names.chain(options.map(|option| option.name)).collect();
            Err(unknown_name("option", key, &names))
        }
    }
}

impl fmt::Display for SourceUri {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stream(stream) => stream.fmt(f),
            Self::Recording { path } => write!(f, "recording:{}", path.to_string_lossy()),
            Self::Typist { text, format: None } => write!(f, "typist:{text}"),
            Self::Typist {
                text,
                format: Some(format),
            } => write!(f, "typist:{text}{format}"),
            Self::Script { script } => write!(f, "script:{script}"),
        }
    }
}

impl TryFrom<String> for SourceUri {
    type Error = CaptureError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl From<SourceUri> for String {
    fn from(uri: SourceUri) -> Self {
        uri.to_string()
    }
}

mod values;

#[cfg(test)]
mod tests;
