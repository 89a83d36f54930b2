//! The targets of a session as users name them: `text-line:127.0.0.1:10002`, `text-line+tls:192.168.1.7:10002`,
//! `text-line+zenoh:lab/desk-3/right`.

use std::fmt;
use std::net::SocketAddr;
use std::str::FromStr;

use arrayvec::ArrayString;
use serde::{Deserialize, Serialize};

use super::ShareError;
use crate::network::zenoh::{DEFAULT_ROUTER, MAX_KEY_BYTES, check_key, parse_router};
use crate::network::{canonical, check_listen_address};
use ademan_core::message::escape;
use ademan_core::names::{UnknownName, named_enum};

named_enum! {
    /// The form in which a hand is shared.
    pub enum ShareFormat ("format") {
        /// 64 joint angles of the first hand in degrees, by the channel of the HC11 glove: the line that the source
        /// `protocol=text-line` reads.
        TextLine = "text-line",
        /// The JSON of `ademan trace angles`.
        Angles = "angles",
        /// The JSON of `ademan trace pose`.
        Pose = "pose",
        /// Objects of the kinds that a client asks for, as lines of JSON.
        Json = "json",
        /// The objects of `json` as messages of a WebSocket.
        Ws = "ws",
        /// A page that shows the hand and the board, and the WebSocket that it reads.
        Web = "web",
        /// Rotations of the bones of both arms, for programs for avatars: the datagrams that the source `protocol=vmc` reads.
        Vmc = "vmc",
        /// The movement of the first hand, for opentrack: the datagrams that the source `protocol=opentrack` reads.
        Opentrack = "opentrack",
    }
}

impl ShareFormat {
    /// Returns one line about the format, in lower case and without a full stop.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::TextLine => "64 joint angles in degrees, by the channel of the HC11 glove",
            Self::Angles => "joint angles in radians as JSON",
            Self::Pose => "positions and orientations of all joints as JSON",
            Self::Json => "lines of JSON of the kinds that a client asks for",
            Self::Ws => "a WebSocket with the JSON of the kinds that a client asks for",
            Self::Web => "a page that shows the hand and the board",
            Self::Vmc => "rotations of the bones of arms and hands as VMC (OSC), sent over UDP",
            Self::Opentrack => "movement of the first hand for opentrack, sent over UDP",
        }
    }

    /// Returns `true` if the format has one line for each accepted reading, and no requests.
    pub const fn is_plain(self) -> bool {
        matches!(self, Self::TextLine | Self::Angles | Self::Pose)
    }

    /// Returns `true` if clients of other machines are served over TLS.
    pub const fn can_have_tls(self) -> bool {
        self.is_plain() || matches!(self, Self::Json)
    }

    /// Returns `true` if the format is sent to an address, instead of served to clients that connect.
    pub const fn is_datagram(self) -> bool {
        matches!(self, Self::Vmc | Self::Opentrack)
    }
}

/// The connection between the program and those that receive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShareLink {
    /// TCP or UDP on this machine.
    Plain,
    /// TCP with TLS, for clients with a token.
    Tls,
    /// The key of a router of zenoh on this machine.
    Zenoh(ArrayString<MAX_KEY_BYTES>),
}

/// A format, and the address that is listened on or sent to: `text-line:127.0.0.1:10002`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ShareTarget {
    /// The form of what is sent.
    pub format: ShareFormat,
    /// The way in which it is sent.
    pub link: ShareLink,
    /// The address and the port; port 0 is any free one at which a server listens. For zenoh, the router.
    pub address: SocketAddr,
}

impl ShareTarget {
    /// Returns the address at which a server listens; `None` if the target is sent to, or any port will do.
    pub fn listens_at(&self) -> Option<SocketAddr> {
        let is_server = !self.format.is_datagram() && !matches!(self.link, ShareLink::Zenoh(_));
        let has_port = self.address.port() != 0;
        (is_server && has_port).then_some(self.address)
    }
}

impl FromStr for ShareTarget {
    type Err = ShareError;

    fn from_str(text: &str) -> Result<Self, ShareError> {
        parse(text).map_err(|reason| ShareError::InvalidTarget {
            text: text.to_owned(),
            reason,
        })
    }
}

fn parse(text: &str) -> Result<ShareTarget, String> {
    let Some((form, address)) = text.split_once(':') else {
        return Err("write a format and an address: `text-line:127.0.0.1:10002`".into());
    };
    let (format, link) = match form.split_once('+') {
        Some((format, link)) => (format, Some(link)),
        // A key of zenoh carries one hand, and the text line is the form that a source reads.
        None if form == "zenoh" => (ShareFormat::TextLine.name(), Some(form)),
        None => (form, None),
    };
    let format: ShareFormat = format.parse().map_err(|_: UnknownName| {
        let names = ShareFormat::NAMES;
        let error = UnknownName::new("format", format, names.iter().copied());
        format!("{error} (available: {})", names.join(", "))
    })?;
    match link {
        None => parse_address(format, ShareLink::Plain, address),
        Some("tls") if format.can_have_tls() => parse_address(format, ShareLink::Tls, address),
        Some("zenoh") if format.is_plain() => parse_key(format, address),
        Some("tls") => Err(local_only(format)),
        Some("zenoh") => Err(format!(
            "a key of zenoh has no requests, so `{format}` is not sent to one; share `text-line`, `angles` or `pose`"
        )),
        Some(link) => Err(format!(
            "`+{}` is unknown: write `+tls` for clients with a token, or `+zenoh` for the key of a router",
            escape(link)
        )),
    }
}

fn parse_address(format: ShareFormat, link: ShareLink, text: &str) -> Result<ShareTarget, String> {
    let address: SocketAddr = text.parse().map_err(|_| {
        format!(
            "`{}` is not an address and a port, such as 127.0.0.1:10002",
            escape(text)
        )
    })?;
    let address = canonical(address);
    check_listen_address(address, link == ShareLink::Tls || !format.can_have_tls())?;
    if !format.can_have_tls() && !address.ip().is_loopback() {
        return Err(local_only(format));
    }
    if format.is_datagram() && address.port() == 0 {
        return Err(format!(
            "`{format}` is sent to a port; write the port of the receiver"
        ));
    }
    Ok(ShareTarget {
        format,
        link,
        address,
    })
}

/// Returns the reason why a format is not shared with other machines.
fn local_only(format: ShareFormat) -> String {
    let remedy = if format.is_datagram() {
        "share `text-line+tls` with another machine, and let an `ademan share` there send to its programs"
    } else {
        "use an SSH tunnel for another machine (`ssh -L`), or share `json`, `text-line`, `angles` or `pose` with `+tls`"
    };
    format!("`{format}` is for programs on this machine only, at 127.0.0.1 or [::1]; {remedy}")
}

fn parse_key(format: ShareFormat, text: &str) -> Result<ShareTarget, String> {
    let (key, router) = match text.split_once("?router=") {
        Some((key, router)) => (key, parse_router(router)?),
        None => (text, DEFAULT_ROUTER),
    };
    check_key(key)?;
    let key = ArrayString::from(key).map_err(|error| error.to_string())?;
    Ok(ShareTarget {
        format,
        link: ShareLink::Zenoh(key),
        address: router,
    })
}

impl fmt::Display for ShareTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (format, address) = (self.format, self.address);
        match &self.link {
            ShareLink::Plain => write!(f, "{format}:{address}"),
            ShareLink::Tls => write!(f, "{format}+tls:{address}"),
            ShareLink::Zenoh(key) if address == DEFAULT_ROUTER => write!(f, "{format}+zenoh:{key}"),
            ShareLink::Zenoh(key) => write!(f, "{format}+zenoh:{key}?router={address}"),
        }
    }
}

impl TryFrom<String> for ShareTarget {
    type Error = ShareError;

    fn try_from(text: String) -> Result<Self, ShareError> {
        text.parse()
    }
}

impl From<ShareTarget> for String {
    fn from(target: ShareTarget) -> Self {
        target.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_a_format_and_a_loopback_address() {
        for text in [
            "text-line:127.0.0.1:10002",
            "pose:[::1]:0",
            "angles:127.9.9.9:1",
            "json:127.0.0.1:10004",
            "ws:127.0.0.1:10005",
            "web:127.0.0.1:8080",
            "vmc:127.0.0.1:39539",
            "opentrack:[::1]:4242",
            "text-line+tls:127.0.0.1:0",
            "pose+tls:192.0.2.2:10002",
            "json+tls:192.0.2.2:10004",
            "angles+zenoh:lab/desk-3/right",
            "text-line+zenoh:lab/left?router=127.0.0.1:7448",
        ] {
            assert_eq!(text.parse::<ShareTarget>().unwrap().to_string(), text);
        }
        let error = |text: &str| text.parse::<ShareTarget>().unwrap_err().to_string();
        assert!(error("text-line").contains("`text-line:127.0.0.1:10002`"));
        let unknown = error("text-lnie:127.0.0.1:1");
        assert!(unknown.contains("did you mean `text-line`?"), "{unknown}");
        assert!(error("pose:localhost:1").contains("not an address and a port"));
        for remote in ["pose:192.0.2.2:1", "ws:192.168.1.2:1", "pose:[fd00::2]:1"] {
            assert!(error(remote).contains("ssh -L"), "{remote}");
        }
        for any in [
            "pose:0.0.0.0:1",
            "pose+tls:0.0.0.0:1",
            "pose+tls:[::]:1",
            "pose+tls:[::ffff:0.0.0.0]:1",
            "json+tls:[::ffff:0:0]:1",
            "ws:[::ffff:0.0.0.0]:1",
            "vmc:[::ffff:0.0.0.0]:1",
        ] {
            assert!(error(any).contains("every network"), "{any}");
        }
        let mapped: ShareTarget = "web:[::ffff:127.0.0.1]:1".parse().unwrap();
        assert_eq!(mapped.to_string(), "web:127.0.0.1:1");
        let refused = error("pose:[::ffff:192.0.2.2]:1");
        assert!(refused.contains("ssh -L"), "{refused}");
        for datagrams in ["vmc:192.168.1.2:1", "opentrack+tls:192.0.2.2:1"] {
            let error = error(datagrams);
            assert!(error.contains("text-line+tls"), "{error}");
            assert!(!error.contains("ssh"), "{error}");
        }
        for local in ["ws+tls:192.0.2.2:1", "web:192.0.2.2:1"] {
            assert!(error(local).contains("`json`, `text-line`"), "{local}");
        }
        assert!(error("json+zenoh:lab/right").contains("has no requests"));
        assert!(error("pose+ssl:192.0.2.2:1").contains("`+tls`"));
        assert!(error("zenoh:lab/**").contains("without wildcards"));
        assert!(error("zenoh:lab?router=192.0.2.2:7447").contains("with TLS"));
        let short: ShareTarget = "zenoh:lab/right".parse().unwrap();
        assert_eq!(short.to_string(), "text-line+zenoh:lab/right");
        assert!(error("vmc:127.0.0.1:0").contains("the port of the receiver"));
    }
}
