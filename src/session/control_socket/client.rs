//! The client's end, for `ademan ctl` and programs like it.

use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::ControlError;
use crate::output::socket::{self, Stream};

/// How long an answer may take; a run gives one within 2 s.
const ANSWER_LIMIT: Duration = Duration::from_secs(5);

/// A conversation with a run.
pub struct Client {
    reader: BufReader<Stream>,
    path: PathBuf,
}

impl Client {
    /// Connects to the run whose socket is at `path`.
    pub fn connect(path: &Path) -> Result<Self, ControlError> {
        let connected = socket::connect(path).and_then(|stream| {
            stream.set_read_timeout(Some(ANSWER_LIMIT))?;
            stream.set_write_timeout(Some(ANSWER_LIMIT))?;
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
                        "nobody listens there".into()
                    }
                    _ => error.to_string(),
                },
            }),
        }
    }

    /// Says `request`, one line of JSON without its end, and gives the answer, one without its end.
    pub fn request(&mut self, request: &str) -> Result<String, ControlError> {
        // A run that refuses a client says why without having heard a word.
        let _ = self
            .reader
            .get_mut()
            .write_all(format!("{request}\n").as_bytes());
        match self.line() {
            Ok(Some(answer)) => Ok(answer),
            Ok(None) => Err(self.no_answer("it went away")),
            Err(error) => Err(self.no_answer(&error.to_string())),
        }
    }

    /// Waits for the next line of news, however long that takes; `None` when the run is over.
    pub fn next_notification(&mut self) -> Result<Option<String>, ControlError> {
        let stream = self.reader.get_mut();
        let waited = stream.set_read_timeout(None).and_then(|()| self.line());
        waited.map_err(|error| self.no_answer(&error.to_string()))
    }

    /// Waits until the run has gone away; whether it has within 5 s.
    pub fn wait_until_closed(mut self) -> bool {
        loop {
            match self.line() {
                Ok(Some(_)) => {}
                Ok(None) => return true,
                Err(error) => return error.kind() == io::ErrorKind::ConnectionReset,
            }
        }
    }

    fn line(&mut self) -> io::Result<Option<String>> {
        let mut line = String::new();
        self.reader.read_line(&mut line)?;
        Ok(line.strip_suffix('\n').map(str::to_owned))
    }

    fn no_answer(&self, reason: &str) -> ControlError {
        ControlError::NoResponse {
            path: self.path.clone(),
            reason: reason.into(),
        }
    }
}
