//! A client of the control socket, for `ademan ctl` and similar programs.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::Deserialize;

use super::ControlError;
use crate::output::socket::{self, Stream};
use ademan_core::command::Command;
use ademan_core::document::MAX_DOCUMENT_BYTES;

/// Time-out of a response. A session answers within 2 s.
const RESPONSE_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest line that is accepted from a session: a layout, each byte of which may take six as JSON, and what is around it.
const MAX_LINE_BYTES: u64 = 8 * MAX_DOCUMENT_BYTES;

/// A connection to a session.
pub struct Client {
    reader: BufReader<Stream>,
    path: PathBuf,
}

/// The response to a request, without its fields.
#[derive(Deserialize)]
struct Response {
    ok: bool,
    #[serde(default)]
    error: String,
}

impl Client {
    /// Connects to the session whose socket is at `path`.
    pub fn connect(path: &Path) -> Result<Self, ControlError> {
        let connected = socket::connect(path).and_then(|stream| {
            stream.set_read_timeout(Some(RESPONSE_TIMEOUT))?;
            stream.set_write_timeout(Some(RESPONSE_TIMEOUT))?;
            Ok(stream)
        });
        match connected {
            Ok(stream) => Ok(Self {
                reader: BufReader::new(stream),
                path: path.into(),
            }),
            Err(error) => Err(ControlError::Connect {
                path: path.into(),
                reason: match error.kind() {
                    io::ErrorKind::NotFound | io::ErrorKind::ConnectionRefused => {
                        "no session listens there".into()
                    }
                    _ => error.to_string(),
                },
            }),
        }
    }

    /// Sends a request and returns the response. Both are one line of JSON without the newline.
    pub fn request(&mut self, request: &str) -> Result<String, ControlError> {
        // A server without a free slot sends its response before it reads anything.
        let _ = self
            .reader
            .get_mut()
            .write_all(format!("{request}\n").as_bytes());
        match self.read_line() {
            Ok(Some(response)) => Ok(response),
            Ok(None) => Err(self.no_response("the connection was closed")),
            Err(error) => Err(self.no_response(&reason(&error))),
        }
    }

    /// Sends a command and waits until the session has executed it.
    pub fn execute(&mut self, command: &Command) -> Result<(), ControlError> {
        let request = serde_json::to_string(command);
        self.confirm(&request.map_err(|error| self.no_response(&error.to_string()))?)
    }

    /// Sends a request and waits until the session has confirmed it.
    pub(super) fn confirm(&mut self, request: &str) -> Result<(), ControlError> {
        let response = self.request(request)?;
        match serde_json::from_str(&response) {
            Ok(Response { ok: true, .. }) => Ok(()),
            Ok(Response { error, .. }) => Err(ControlError::Refused(error)),
            Err(error) => Err(self.no_response(&error.to_string())),
        }
    }

    /// Waits for the next notification, without a time-out. Returns `None` when the session has ended.
    pub fn next_notification(&mut self) -> Result<Option<String>, ControlError> {
        let stream = self.reader.get_mut();
        let line = stream
            .set_read_timeout(None)
            .and_then(|()| self.read_line());
        line.map_err(|error| self.no_response(&error.to_string()))
    }

    /// Waits up to 5 s until the session has ended. Returns `true` if it has.
    pub fn wait_until_closed(mut self) -> bool {
        loop {
            match self.read_line() {
                Ok(Some(_)) => {}
                Ok(None) => return true,
                Err(error) => return error.kind() == io::ErrorKind::ConnectionReset,
            }
        }
    }

    fn read_line(&mut self) -> io::Result<Option<String>> {
        let mut line = String::new();
        let length = self
            .reader
            .by_ref()
            .take(MAX_LINE_BYTES)
            .read_line(&mut line)?;
        if length as u64 == MAX_LINE_BYTES {
            return Err(io::Error::other("a line is too long"));
        }
        Ok(line.strip_suffix('\n').map(str::to_owned))
    }

    pub(super) fn no_response(&self, reason: &str) -> ControlError {
        ControlError::NoResponse {
            path: self.path.clone(),
            reason: reason.into(),
        }
    }
}

/// Returns the reason why no response could be read.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        // The read time-out, on Unix and on Windows.
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => format!(
            "no answer within {} s; the program is stopped or hangs",
            RESPONSE_TIMEOUT.as_secs()
        ),
        _ => error.to_string(),
    }
}
