//! Joint angles and poses for other programs on this machine, over TCP.
//!
//! A server only writes: a line for each accepted reading, to every client. It listens on loopback addresses only, because
//! the angles of a typing hand tell what is typed; a client on another machine comes through an SSH tunnel. A client that
//! sends anything is disconnected, so that no web page can make a request of it. Nothing in the session waits for a client.

mod client;
mod server;

pub use server::ShareServer;

use std::fmt;
use std::io;
use std::net::SocketAddr;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::capture::protocol::text_line;
use crate::estimate::JointAngles;
use crate::hand::Side;
use crate::kinematics::HandPose;
use crate::message::escape;
use crate::names::{UnknownName, named_enum};
use crate::snapshot::Snapshot;
use crate::trace::{angles_json, pose_json};

named_enum! {
    /// The form of the lines of a server.
    pub enum ShareFormat ("format") {
        /// 64 joint angles of the first hand in degrees, by the wire index of the HC11 glove: the line that the source
        /// `protocol=text-line` reads.
        TextLine = "text-line",
        /// The JSON of `ademan trace angles`.
        Angles = "angles",
        /// The JSON of `ademan trace pose`.
        Pose = "pose",
    }
}

impl ShareFormat {
    /// Returns one line about the format, in lower case and without a full stop.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::TextLine => "64 joint angles in degrees, by the wire index of the HC11 glove",
            Self::Angles => "joint angles in radians as JSON",
            Self::Pose => "positions and orientations of all joints as JSON",
        }
    }
}

/// A server as the user names it: `text-line:127.0.0.1:10002`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ShareTarget {
    /// The form of its lines.
    pub format: ShareFormat,
    /// The loopback address and the port; port 0 is any free one.
    pub address: SocketAddr,
}

/// The reason why angles or poses cannot be shared.
#[derive(Debug, thiserror::Error)]
pub enum ShareError {
    /// The text names no server.
    #[error("cannot share with `{}`: {reason}", escape(.text))]
    InvalidTarget {
        /// The text as written.
        text: String,
        /// The error in it.
        reason: String,
    },
    /// The address cannot be used.
    #[error(
        "cannot listen at {address}: {error}; another program may use the port, choose another one"
    )]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The cause.
        error: io::Error,
    },
    /// A thread cannot be started.
    #[error("{0}")]
    NoThread(String),
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
        let format = format.parse().map_err(|error: UnknownName| {
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

/// The shared part of one step.
#[derive(Clone, Copy, Debug)]
struct SharedStep {
    angles: JointAngles,
    pose: HandPose,
}

impl SharedStep {
    /// Returns the part of a snapshot that is shared; `None` if its reading was rejected.
    fn from_snapshot(snapshot: &Snapshot) -> Option<Self> {
        Some(Self {
            angles: snapshot.angles?,
            pose: snapshot.pose?,
        })
    }

    /// Writes the line of a format into `line`, with its end. Returns `false` if the format has no line for this hand;
    /// `first` is the first hand of the session.
    fn write(&self, format: ShareFormat, first: Side, line: &mut Vec<u8>) -> bool {
        line.clear();
        match format {
            ShareFormat::TextLine if self.pose.side != first => return false,
            ShareFormat::TextLine => {
                line.extend_from_slice(text_line::encode(&self.angles).as_bytes());
                return true;
            }
            ShareFormat::Angles => _ = angles_json(self.pose.time, &self.angles, line),
            ShareFormat::Pose => _ = pose_json(&self.pose, line),
        }
        line.push(b'\n');
        true
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
        ] {
            assert_eq!(text.parse::<ShareTarget>().unwrap().to_string(), text);
        }
        let error = |text: &str| text.parse::<ShareTarget>().unwrap_err().to_string();
        assert!(error("text-line").contains("`text-line:127.0.0.1:10002`"));
        let unknown = error("text-lnie:127.0.0.1:1");
        assert!(unknown.contains("did you mean `text-line`?"), "{unknown}");
        assert!(error("pose:localhost:1").contains("not an address and a port"));
        for remote in ["pose:0.0.0.0:1", "pose:192.168.1.2:1", "pose:[::]:1"] {
            assert!(error(remote).contains("ssh -L"), "{remote}");
        }
    }
}
