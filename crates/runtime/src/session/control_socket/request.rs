//! One line of a client: a command, or a request for notifications or views.

use ademan_core::command::{Command, InvalidCommand};

/// Longest accepted line, in bytes without the line end.
pub const MAX_LINE_BYTES: usize = 4096;

/// The requests that belong to the connection and not to the session.
const OF_CONNECTION: [(&str, Request); 2] =
    [("subscribe", Request::Subscribe), ("watch", Request::Watch)];

/// A valid line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Request {
    /// A command for the session.
    Command(Command),
    /// Sends notifications to this client from now on.
    Subscribe,
    /// Sends views to this client from now on.
    Watch,
}

/// Reason why a line is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InvalidRequest {
    /// The line is not UTF-8.
    #[error("the line is not UTF-8")]
    Encoding,
    /// The line is not a command.
    #[error(transparent)]
    Command(#[from] InvalidCommand),
}

impl Request {
    /// Parses a line of JSON.
    pub fn parse(line: &[u8]) -> Result<Self, InvalidRequest> {
        let text = str::from_utf8(line).map_err(|_| InvalidRequest::Encoding)?;
        if let Some(request) = of_connection(text) {
            return Ok(request);
        }
        Ok(Self::Command(Command::from_json(text)?))
    }
}

/// Checks a line without executing it.
pub fn validate(line: &[u8]) -> Result<(), InvalidRequest> {
    Request::parse(line).map(drop)
}

fn of_connection(text: &str) -> Option<Request> {
    #[derive(serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Line {
        command: String,
    }
    let line: Line = serde_json::from_str(text).ok()?;
    let mut requests = OF_CONNECTION.into_iter();
    let found = requests.find(|(name, _)| *name == line.command);
    found.map(|(_, request)| request)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_a_command_or_a_subscription() {
        assert_eq!(
            Request::parse(b"{\"command\":\"tilt\",\"deg\":-90}\r"),
            Ok(Request::Command(Command::Tilt { deg: -90.0 }))
        );
        assert_eq!(
            Request::parse(br#"{"command":"subscribe"}"#),
            Ok(Request::Subscribe)
        );
        assert_eq!(
            Request::parse(br#"{"command":"watch"}"#),
            Ok(Request::Watch)
        );
        assert!(Request::parse(br#"{"command":"subscribe","deg":1}"#).is_err());
    }

    #[test]
    fn invalid_lines_are_explained() {
        assert_eq!(Request::parse(b"\xff"), Err(InvalidRequest::Encoding));
        let error = Request::parse(br#"{"command":"paus"}"#).unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown command `paus`, did you mean `pause`?"
        );
    }
}
