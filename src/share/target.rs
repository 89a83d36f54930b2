//! The targets of a session as users name them: `text-line:127.0.0.1:10002`.

use std::fmt;
use std::net::SocketAddr;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::ShareError;
use super::kinds::LineKind;
use crate::message::escape;
use crate::names::{UnknownName, named_enum};

named_enum! {
    /// The form in which a hand is shared.
    pub enum ShareFormat ("format") {
        /// 64 joint angles of the first hand in degrees, by the wire index of the HC11 glove: the line that the source
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
            Self::TextLine => "64 joint angles in degrees, by the wire index of the HC11 glove",
            Self::Angles => "joint angles in radians as JSON",
            Self::Pose => "positions and orientations of all joints as JSON",
            Self::Json => "lines of JSON of the kinds that a client asks for",
            Self::Ws => "a WebSocket with the JSON of the kinds that a client asks for",
            Self::Web => "a page that shows the hand and the board",
            Self::Vmc => "rotations of the bones of arms and hands as VMC (OSC), sent over UDP",
            Self::Opentrack => "movement of the first hand for opentrack, sent over UDP",
        }
    }

    /// Returns the kind of its lines, if the client cannot choose.
    pub(super) const fn plain_kind(self) -> Option<LineKind> {
        match self {
            Self::TextLine | Self::Angles | Self::Pose => Some(LineKind::Plain(self)),
            _ => None,
        }
    }

    /// Returns whether the format is sent to an address, instead of served to clients that connect.
    pub const fn is_datagram(self) -> bool {
        matches!(self, Self::Vmc | Self::Opentrack)
    }
}

/// A format, and the address that is listened at or sent to: `text-line:127.0.0.1:10002`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ShareTarget {
    /// The form of what is sent.
    pub format: ShareFormat,
    /// The loopback address and the port; port 0 is any free one at which a server listens.
    pub address: SocketAddr,
}

impl FromStr for ShareTarget {
    type Err = ShareError;

    fn from_str(text: &str) -> Result<Self, ShareError> {
        let invalid = |reason: String| ShareError::InvalidTarget {
            text: text.to_owned(),
            reason,
        };
        let Some((format, address)) = text.split_once(':') else {
            let example = "write a format and an address: `text-line:127.0.0.1:10002`";
            return Err(invalid(example.into()));
        };
        let format: ShareFormat = format.parse().map_err(|error: UnknownName| {
            let names: Vec<_> = ShareFormat::ALL.iter().map(|it| it.name()).collect();
            invalid(format!("{error} (available: {})", names.join(", ")))
        })?;
        let address: SocketAddr = address.parse().map_err(|_| {
            invalid(format!(
                "`{}` is not an address and a port, such as 127.0.0.1:10002",
                escape(address)
            ))
        })?;
        if !address.ip().is_loopback() {
            return Err(invalid(
                "only programs on this machine may connect; use 127.0.0.1 or [::1], and `ssh -L` from another machine".into(),
            ));
        }
        if format.is_datagram() && address.port() == 0 {
            return Err(invalid(format!(
                "`{format}` is sent to a port; write that of the receiver"
            )));
        }
        Ok(Self { format, address })
    }
}

impl fmt::Display for ShareTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.format, self.address)
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
        ] {
            assert_eq!(text.parse::<ShareTarget>().unwrap().to_string(), text);
        }
        let error = |text: &str| text.parse::<ShareTarget>().unwrap_err().to_string();
        assert!(error("text-line").contains("`text-line:127.0.0.1:10002`"));
        let unknown = error("text-lnie:127.0.0.1:1");
        assert!(unknown.contains("did you mean `text-line`?"), "{unknown}");
        assert!(error("pose:localhost:1").contains("not an address and a port"));
        for remote in ["pose:0.0.0.0:1", "vmc:192.168.1.2:1", "pose:[::]:1"] {
            assert!(error(remote).contains("ssh -L"), "{remote}");
        }
        assert!(error("vmc:127.0.0.1:0").contains("that of the receiver"));
    }
}
