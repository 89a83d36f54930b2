//! The text that names a source: `serial:/dev/ttyUSB0?protocol=hc11&baud=115200`.

use std::fmt;
use std::num::NonZeroU32;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::CaptureError;
use super::hc11::{Framing, PACKET_BYTES};
use crate::names::{UnknownName, named_enum, nearest};

/// Where readings come from.
///
/// | text | source |
/// |---|---|
/// | `serial:PORT[?OPTIONS]` | a serial port: `/dev/ttyUSB0`, `COM3`, `/dev/serial/by-id/…` |
/// | `tcp:HOST:PORT[?OPTIONS]` | an RS232-to-TCP converter; it types only with `role: Both` or `role: Keys` in the setup |
/// | `file:PATH[?OPTIONS]` | the raw bytes of a line, in a file |
/// | `recording:PATH` | a recording made by this program |
/// | `typist:TEXT` | a simulated hand that types the text |
/// | `script:FILE` | a simulated hand that plays a script, in a file or as it stands |
///
/// Options are `key=value` pairs joined by `&`: `protocol` (`hc11`, the default), `framing` (`double06`, the
/// default, or `hash`) and `baud` (bits per second, from 1; 115200 unless said otherwise).
///
/// They start at the last `?` after which everything reads as such pairs; any other `?` belongs to the path. A file whose
/// name ends like options is named by adding an option: `file:what?a=b?protocol=hc11`. What follows `recording:`,
/// `typist:` and `script:` is taken as it stands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum SourceUri {
    /// A serial port.
    Serial {
        /// The port as the operating system names it.
        port: String,
        /// What is spoken on it.
        line: StreamOptions,
    },
    /// A TCP server that passes on the bytes of a serial line.
    Tcp {
        /// Host and port: `192.168.1.7:4001`, `glove.local:4001`, `[::1]:4001`.
        address: String,
        /// What is spoken on it.
        line: StreamOptions,
    },
    /// A file with the bytes of a serial line.
    File {
        /// The file.
        path: PathBuf,
        /// What was spoken on the line.
        line: StreamOptions,
    },
    /// A recording of readings.
    Recording {
        /// The file.
        path: PathBuf,
    },
    /// A simulated hand.
    Typist {
        /// What it types.
        text: String,
    },
    /// A simulated hand that plays a script.
    Script {
        /// The file with the script, or the script itself.
        script: String,
    },
}

/// What is spoken on a line of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamOptions {
    /// Which device sends.
    pub protocol: Protocol,
    /// How it marks its frames.
    pub framing: Framing,
    /// Bits per second; ten of them carry a byte (8 data bits, no parity, 1 stop bit).
    pub baud: NonZeroU32,
}

named_enum! {
    /// A device that can be on a line.
    #[derive(Default)]
    pub enum Protocol ("protocol") {
        /// The glove with the 68HC11 microcontroller.
        #[default]
        Hc11 = "hc11",
    }
}

const SCHEMES: [&str; 6] = ["serial", "tcp", "file", "recording", "typist", "script"];

named_enum! {
    enum OptionKey ("option") {
        Protocol = "protocol",
        Framing = "framing",
        Baud = "baud",
    }
}

const DEFAULT_BAUD: NonZeroU32 = NonZeroU32::new(115_200).unwrap();
const BITS_PER_BYTE: u64 = 10;

impl Default for StreamOptions {
    fn default() -> Self {
        Self {
            protocol: Protocol::default(),
            framing: Framing::default(),
            baud: DEFAULT_BAUD,
        }
    }
}

impl StreamOptions {
    /// The time that `bytes` take on the wire, rounded down to nanoseconds.
    pub fn transmission_time(&self, bytes: usize) -> Duration {
        let nanoseconds = bytes as u64 * BITS_PER_BYTE * 1_000_000_000 / u64::from(self.baud.get());
        Duration::from_nanos(nanoseconds)
    }

    /// The time that one frame takes on the wire: the shortest time between two readings.
    pub fn packet_period(&self) -> Duration {
        self.transmission_time(PACKET_BYTES)
    }

    fn parse(options: &str) -> Result<Self, String> {
        let mut settings = Self::default();
        let mut seen = [false; OptionKey::COUNT];
        for pair in options.split('&').filter(|pair| !pair.is_empty()) {
            let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
            let key: OptionKey = key.parse().map_err(|error| format!("{error}"))?;
            if std::mem::replace(&mut seen[key.index()], true) {
                return Err(format!("option `{key}` is given twice"));
            }
            settings.set(key, value)?;
        }
        Ok(settings)
    }

    fn set(&mut self, key: OptionKey, value: &str) -> Result<(), String> {
        match key {
            OptionKey::Protocol => self.protocol = named(value)?,
            OptionKey::Framing => self.framing = named(value)?,
            OptionKey::Baud => {
                self.baud = value.parse().map_err(|_| {
                    format!("`{value}` is no baud, write bits per second such as `baud=115200`")
                })?;
            }
        }
        Ok(())
    }
}

fn named<T: FromStr<Err = UnknownName>>(value: &str) -> Result<T, String> {
    value.parse().map_err(|error: T::Err| error.to_string())
}

impl SourceUri {
    /// Whether readings come over a network, where others may send some too.
    pub const fn is_remote(&self) -> bool {
        matches!(self, Self::Tcp { .. })
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
        return Err(no_scheme(text));
    };
    if rest.is_empty() {
        return Err(format!("nothing follows `{scheme}:`"));
    }
    match scheme {
        "serial" => {
            let (port, line) = split_plain(rest)?;
            Ok(SourceUri::Serial { port, line })
        }
        "tcp" => {
            let (address, line) = split_plain(rest)?;
            check_address(&address)?;
            Ok(SourceUri::Tcp { address, line })
        }
        "file" => {
            let (path, line) = split_options(rest)?;
            let path = PathBuf::from(path);
            Ok(SourceUri::File { path, line })
        }
        "recording" => Ok(SourceUri::Recording { path: rest.into() }),
        "typist" => Ok(SourceUri::Typist { text: rest.into() }),
        "script" => Ok(SourceUri::Script {
            script: rest.into(),
        }),
        unknown => Err(UnknownName::new("kind of source", unknown, SCHEMES).to_string()),
    }
}

fn no_scheme(text: &str) -> String {
    if text.starts_with("/dev/") || text.starts_with("COM") {
        return format!("write `serial:{text}`");
    }
    match nearest(text, SCHEMES) {
        Some(scheme) => format!("it names no kind of source, did you mean `{scheme}:…`?"),
        None => {
            let schemes = SCHEMES.map(|scheme| format!("`{scheme}:`"));
            format!("a source starts with one of {}", schemes.join(", "))
        }
    }
}

/// Splits what may contain a `?` of its own.
fn split_options(rest: &str) -> Result<(&str, StreamOptions), String> {
    let (place, options) = match rest.rsplit_once('?') {
        Some((place, options)) if are_pairs(options) => (place, options),
        _ => (rest, ""),
    };
    if place.is_empty() {
        return Err("nothing stands before the options".to_owned());
    }
    Ok((place, StreamOptions::parse(options)?))
}

/// Splits a port or an address, which has no `?`.
fn split_plain(rest: &str) -> Result<(String, StreamOptions), String> {
    let (place, line) = split_options(rest)?;
    if place.contains('?') {
        return Err("after `?` options are wanted, such as `baud=115200`".to_owned());
    }
    Ok((place.to_owned(), line))
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

fn check_address(address: &str) -> Result<(), String> {
    let port = address
        .rsplit_once(':')
        .filter(|(host, _)| !host.is_empty())
        .and_then(|(_, port)| port.parse::<u16>().ok())
        .filter(|&port| port != 0);
    match port {
        Some(_) => Ok(()),
        None => Err("write `tcp:HOST:PORT` with a port from 1 to 65535".to_owned()),
    }
}

impl fmt::Display for SourceUri {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { port, line } => write!(f, "serial:{port}{line}"),
            Self::Tcp { address, line } => write!(f, "tcp:{address}{line}"),
            Self::File { path, line } => write!(f, "file:{}{line}", path.display()),
            Self::Recording { path } => write!(f, "recording:{}", path.display()),
            Self::Typist { text } => write!(f, "typist:{text}"),
            Self::Script { script } => write!(f, "script:{script}"),
        }
    }
}

impl fmt::Display for StreamOptions {
    /// The options that give these settings, with the `?` before them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "?protocol={}", self.protocol)?;
        if self.framing != Framing::default() {
            write!(f, "&framing={}", self.framing)?;
        }
        write!(f, "&baud={}", self.baud)
    }
}

impl TryFrom<String> for SourceUri {
    type Error = CaptureError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl From<SourceUri> for String {
    fn from(name: SourceUri) -> Self {
        name.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(framing: Framing, baud: u32) -> StreamOptions {
        StreamOptions {
            framing,
            baud: NonZeroU32::new(baud).unwrap(),
            ..StreamOptions::default()
        }
    }

    #[test]
    fn every_kind_of_source_has_its_text() {
        let serial = |port: &str, line| SourceUri::Serial {
            port: port.to_owned(),
            line,
        };
        let file = |path: &str, line| SourceUri::File {
            path: path.into(),
            line,
        };
        let tcp = |address: &str, line| SourceUri::Tcp {
            address: address.to_owned(),
            line,
        };
        let usual = StreamOptions::default();
        let table = [
            ("serial:/dev/ttyUSB0", serial("/dev/ttyUSB0", usual)),
            (
                "serial:/dev/ttyUSB0?protocol=hc11&baud=9600",
                serial("/dev/ttyUSB0", line(Framing::Double06, 9600)),
            ),
            (
                "serial:COM3?framing=hash",
                serial("COM3", line(Framing::Hash, 115_200)),
            ),
            (
                "file:a b.raw?baud=1",
                file("a b.raw", line(Framing::Double06, 1)),
            ),
            ("file:what?", file("what?", usual)),
            ("file:what?now.raw", file("what?now.raw", usual)),
            ("file:what?a=b?protocol=hc11", file("what?a=b", usual)),
            ("tcp:glove.local:4001", tcp("glove.local:4001", usual)),
            (
                "tcp:[::1]:4001?baud=9600",
                tcp("[::1]:4001", line(Framing::Double06, 9600)),
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
            let name: SourceUri = text.parse().unwrap();
            assert_eq!(name, expected, "{text}");
            assert_eq!(
                name.to_string().parse::<SourceUri>().unwrap(),
                name,
                "{text}"
            );
        }
    }

    #[test]
    fn a_wrong_name_says_what_was_meant() {
        let table = [
            (
                "seriel:/dev/ttyUSB0",
                "unknown kind of source `seriel`, did you mean `serial`?",
            ),
            ("/dev/ttyUSB0", "write `serial:/dev/ttyUSB0`"),
            ("COM3", "write `serial:COM3`"),
            ("typst", "did you mean `typist:…`?"),
            ("serial:", "nothing follows `serial:`"),
            ("serial:?baud=9600", "nothing stands before the options"),
            (
                "serial:COM3?bauds=9600",
                "unknown option `bauds`, did you mean `baud`?",
            ),
            ("serial:COM3?baud", "after `?` options are wanted"),
            ("serial:COM3?baud=0", "`0` is no baud"),
            ("serial:COM3?baud=fast", "`fast` is no baud"),
            ("serial:COM3?baud=1&baud=2", "option `baud` is given twice"),
            (
                "serial:COM3?protocol=hc12",
                "unknown protocol `hc12`, did you mean `hc11`?",
            ),
            (
                "serial:COM3?framing=double6",
                "unknown framing `double6`, did you mean `double06`?",
            ),
            ("tcp:glove", "write `tcp:HOST:PORT`"),
            ("tcp:glove:99999", "write `tcp:HOST:PORT`"),
            ("tcp:glove:0", "a port from 1 to 65535"),
            ("tcp::4001", "write `tcp:HOST:PORT`"),
        ];
        for (text, part) in table {
            let error = text.parse::<SourceUri>().unwrap_err();
            assert!(matches!(error, CaptureError::InvalidUri { .. }), "{text}");
            let message = error.to_string();
            assert!(message.contains(part), "{text}: {message}");
            assert!(message.contains(text), "{text}: {message}");
        }
    }

    #[test]
    fn a_frame_takes_660_bit_times() {
        assert_eq!(
            line(Framing::Hash, 9600).packet_period(),
            Duration::from_micros(68_750)
        );
        assert_eq!(
            line(Framing::Hash, 660).packet_period(),
            Duration::from_secs(1)
        );
    }
}
