//! Source URIs: `serial:/dev/ttyUSB0?protocol=hc11&baud=115200`.

use std::fmt;
use std::num::NonZeroU32;
use std::path::PathBuf;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::CaptureError;
use super::protocol::{PROTOCOLS, Protocol, StreamFormat};
use super::transport::{TRANSPORTS, Transport};
use crate::names::{UnknownName, nearest};

/// Origin of readings.
///
/// | URI | source |
/// |---|---|
/// | `serial:PORT[?OPTIONS]` | serial port: `/dev/ttyUSB0`, `COM3`, `/dev/serial/by-id/…` |
/// | `tcp:HOST:PORT[?OPTIONS]` | TCP server, such as an RS232-to-TCP converter |
/// | `udp:ADDRESS:PORT[?OPTIONS]` | datagrams that arrive at a local address: `udp:0.0.0.0:9000` |
/// | `file:PATH[?OPTIONS]` | bytes of a stream in a file |
/// | `stdin:[?OPTIONS]` | bytes of a stream on the standard input |
/// | `recording:PATH` | recording made by `ademan record` |
/// | `typist:TEXT` | simulated hand that types the text |
/// | `script:FILE` | simulated hand that plays a script file or the script itself |
///
/// Sources on the network (`tcp:`, `udp:`) press keys only with `role: Both` or `role: Keys` in the setup.
///
/// Options are `key=value` pairs joined by `&`: `protocol` (see [`PROTOCOLS`]), `baud` (bits per second of the serial
/// line, 1 or more) and the options of the protocol.
///
/// Options start at the last `?` after which the text consists of such pairs; any other `?` belongs to the path. A
/// file whose name ends like options is written with an added option: `file:what?a=b?protocol=hc11`. The text after
/// `recording:`, `typist:` and `script:` has no options.
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
    },
    /// A simulated hand that plays a script.
    Script {
        /// The script file, or the script itself.
        script: String,
    },
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
}

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

const RECORDING: Scheme = Scheme {
    name: "recording",
    syntax: "recording:PATH",
    summary: "recording made by `ademan record`",
    example: "recording:session.mcap",
};

const TYPIST: Scheme = Scheme {
    name: "typist",
    syntax: "typist:TEXT",
    summary: "simulated hand that types the text",
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

    /// Returns `false` if the source measures joint angles, which need no glove file.
    pub fn needs_glove(&self) -> bool {
        match self {
            Self::Stream(stream) => stream.format.protocol.sample.needs_glove(),
            _ => true,
        }
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
        "typist" => SourceUri::Typist { text: rest.into() },
        "script" => SourceUri::Script {
            script: rest.into(),
        },
        unknown => {
            let names: Vec<&str> = schemes().map(|scheme| scheme.name).collect();
            return Err(unknown_name("kind of source", unknown, &names));
        }
    };
    if rest.is_empty() {
        return Err(format!("`{scheme}:` is followed by nothing"));
    }
    Ok(uri)
}

fn missing_scheme(text: &str) -> String {
    if text.starts_with("/dev/") || text.starts_with("COM") {
        return format!("write `serial:{text}`");
    }
    match nearest(text, schemes().map(|scheme| scheme.name)) {
        Some(scheme) => format!("it has no kind of source, did you mean `{scheme}:…`?"),
        None => {
            let schemes: Vec<String> = schemes()
                .map(|scheme| format!("`{}:`", scheme.name))
                .collect();
            format!("a source starts with one of {}", schemes.join(", "))
        }
    }
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
            _ => "the options are preceded by nothing".to_owned(),
        });
    }
    (transport.check_address)(address)?;
    Ok(StreamUri {
        transport,
        address: address.to_owned(),
        format: parse_format(options, transport.default_baud)?,
    })
}

/// Checks an address that cannot contain a `?`.
pub(super) fn check_no_question_mark(address: &str) -> Result<(), String> {
    if address.contains('?') {
        return Err("the text after `?` is not a list of options such as `baud=115200`".to_owned());
    }
    Ok(())
}

/// Checks an address of the form `HOST:PORT`.
pub(super) fn check_socket_address(scheme: Scheme, address: &str) -> Result<(), String> {
    check_no_question_mark(address)?;
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

fn are_pairs(options: &str) -> bool {
    options.split('&').all(|pair| {
        let Some((key, _)) = pair.split_once('=') else {
            return false;
        };
        !key.is_empty()
            && key
                .bytes()
                .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    })
}

fn parse_format(options: &str, default_baud: Option<NonZeroU32>) -> Result<StreamFormat, String> {
    let pairs = options.split('&').filter(|pair| !pair.is_empty());
    let pairs: Vec<(&str, &str)> = pairs
        .map(|pair| pair.split_once('=').unwrap_or((pair, "")))
        .collect();
    for (index, (key, _)) in pairs.iter().enumerate() {
        if pairs[..index].iter().any(|(other, _)| other == key) {
            return Err(format!("option `{key}` is given twice"));
        }
    }
    let protocol = match pairs.iter().find(|(key, _)| *key == "protocol") {
        Some((_, name)) => find_protocol(name)?,
        None => PROTOCOLS[0],
    };
    let mut format = StreamFormat::new(protocol);
    format.baud = format.baud.or(default_baud);
    for (key, value) in pairs {
        match key {
            "protocol" => {}
            "baud" => format.baud = Some(parse_baud(value)?),
            _ => set_option(&mut format, key, value)?,
        }
    }
    Ok(format)
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

fn parse_baud(value: &str) -> Result<NonZeroU32, String> {
    value
        .parse()
        .map_err(|_| format!("`{value}` is not a bit rate, write bits per second: `baud=115200`"))
}

fn set_option(format: &mut StreamFormat, key: &str, value: &str) -> Result<(), String> {
    let options = format.protocol.options;
    match options.iter().find(|option| option.name == key) {
        Some(option) => format.options.set(option, value),
        None => {
            let names = ["protocol", "baud"].into_iter();
            let names: Vec<&str> = names
                .chain(options.iter().map(|option| option.name))
                .collect();
            Err(unknown_name("option", key, &names))
        }
    }
}

impl fmt::Display for SourceUri {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stream(stream) => stream.fmt(f),
            Self::Recording { path } => write!(f, "recording:{}", path.display()),
            Self::Typist { text } => write!(f, "typist:{text}"),
            Self::Script { script } => write!(f, "script:{script}"),
        }
    }
}

impl fmt::Display for StreamUri {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = self.transport.scheme.name;
        write!(f, "{scheme}:{}{}", self.address, self.format)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::hc11::{Framing, Hc11Format};

    fn stream(scheme: &str, address: &str, format: impl Into<StreamFormat>) -> SourceUri {
        let mut transports = TRANSPORTS.iter();
        SourceUri::Stream(StreamUri {
            transport: transports
                .find(|transport| transport.scheme.name == scheme)
                .unwrap(),
            address: address.to_owned(),
            format: format.into(),
        })
    }

    fn hc11(framing: Framing, baud: u32) -> Hc11Format {
        Hc11Format {
            framing,
            baud: NonZeroU32::new(baud).unwrap(),
        }
    }

    #[test]
    fn every_kind_of_source_has_a_uri() {
        let default = Hc11Format::default();
        let slow = hc11(Framing::Double06, 9600);
        let text_line = StreamFormat::new(&crate::capture::protocol::text_line::PROTOCOL);
        let text_line_at = |baud| StreamFormat {
            baud: NonZeroU32::new(baud),
            ..text_line.clone()
        };
        let table = [
            (
                "serial:/dev/ttyUSB0",
                stream("serial", "/dev/ttyUSB0", default),
            ),
            (
                "serial:/dev/ttyUSB0?protocol=hc11&baud=9600",
                stream("serial", "/dev/ttyUSB0", slow),
            ),
            (
                "serial:COM3?framing=hash",
                stream("serial", "COM3", hc11(Framing::Hash, 115_200)),
            ),
            (
                "serial:COM3?protocol=text-line",
                stream("serial", "COM3", text_line_at(115_200)),
            ),
            (
                "file:a b.raw?baud=1",
                stream("file", "a b.raw", hc11(Framing::Double06, 1)),
            ),
            ("file:what?", stream("file", "what?", default)),
            ("file:what?now.raw", stream("file", "what?now.raw", default)),
            (
                "file:what?a=b?protocol=hc11",
                stream("file", "what?a=b", default),
            ),
            (
                "tcp:glove.local:4001",
                stream("tcp", "glove.local:4001", default),
            ),
            (
                "tcp:[::1]:4001?baud=9600",
                stream("tcp", "[::1]:4001", slow),
            ),
            (
                "tcp:angles.local:10002?protocol=text-line",
                stream("tcp", "angles.local:10002", text_line.clone()),
            ),
            (
                "udp:0.0.0.0:9000?protocol=text-line",
                stream("udp", "0.0.0.0:9000", text_line.clone()),
            ),
            ("stdin:", stream("stdin", "", default)),
            (
                "stdin:?protocol=text-line",
                stream("stdin", "", text_line.clone()),
            ),
            (
                "recording:x?baud=2.mcap",
                SourceUri::Recording {
                    path: "x?baud=2.mcap".into(),
                },
            ),
            (
                "typist:really? a=b & c: d",
                SourceUri::Typist {
                    text: "really? a=b & c: d".into(),
                },
            ),
            (
                "script:tap Q; wait 5",
                SourceUri::Script {
                    script: "tap Q; wait 5".into(),
                },
            ),
        ];
        for (text, expected) in table {
            let uri: SourceUri = text.parse().unwrap();
            assert_eq!(uri, expected, "{text}");
            assert_eq!(uri.to_string().parse::<SourceUri>().unwrap(), uri, "{text}");
        }
    }

    #[test]
    fn every_example_is_a_valid_uri_of_its_scheme() {
        for scheme in schemes() {
            let uri: SourceUri = scheme.example.parse().unwrap();
            let start = format!("{}:", scheme.name);
            assert!(uri.to_string().starts_with(&start), "{}", scheme.example);
            assert!(scheme.syntax.starts_with(&start), "{}", scheme.syntax);
        }
    }

    #[test]
    fn only_sources_of_joint_angles_need_no_glove() {
        let table = [
            ("serial:COM3", true),
            ("udp:0.0.0.0:9000?protocol=text-line", false),
            ("typist:hello", true),
        ];
        for (text, needs_glove) in table {
            let uri: SourceUri = text.parse().unwrap();
            assert_eq!(uri.needs_glove(), needs_glove, "{text}");
        }
    }

    #[test]
    fn an_invalid_uri_names_the_nearest_valid_one() {
        let table = [
            (
                "seriel:/dev/ttyUSB0",
                "unknown kind of source `seriel`, did you mean `serial`?",
            ),
            ("/dev/ttyUSB0", "write `serial:/dev/ttyUSB0`"),
            ("COM3", "write `serial:COM3`"),
            ("typst", "did you mean `typist:…`?"),
            ("serial:", "`serial:` is followed by nothing"),
            ("typist:", "`typist:` is followed by nothing"),
            ("serial:?baud=9600", "the options are preceded by nothing"),
            (
                "serial:COM3?bauds=9600",
                "unknown option `bauds`, did you mean `baud`?",
            ),
            ("serial:COM3?baud", "not a list of options"),
            ("serial:COM3?baud=0", "`0` is not a bit rate"),
            ("serial:COM3?baud=fast", "`fast` is not a bit rate"),
            ("serial:COM3?baud=1&baud=2", "option `baud` is given twice"),
            (
                "serial:COM3?protocol=hc12",
                "unknown protocol `hc12`, did you mean `hc11`?",
            ),
            (
                "serial:COM3?framing=double6",
                "unknown framing `double6`, did you mean `double06`?",
            ),
            (
                "serial:COM3?protocol=text-line&framing=hash",
                "unknown option `framing`",
            ),
            (
                "file:a.txt?protocol=text-line&rate_hz=0",
                "`0` is not a rate from 0.1 to 10000",
            ),
            ("tcp:glove", "write `tcp:HOST:PORT`"),
            ("tcp:glove:99999", "write `tcp:HOST:PORT`"),
            ("tcp:glove:0", "a port from 1 to 65535"),
            ("tcp::4001", "write `tcp:HOST:PORT`"),
            ("udp:9000", "write `udp:ADDRESS:PORT`"),
            ("stdin:now", "`stdin:` has no address"),
        ];
        for (text, part) in table {
            let error = text.parse::<SourceUri>().unwrap_err();
            assert!(matches!(error, CaptureError::InvalidUri { .. }), "{text}");
            let message = error.to_string();
            assert!(message.contains(part), "{text}: {message}");
            assert!(message.contains(text), "{text}: {message}");
        }
    }
}
