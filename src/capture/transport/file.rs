//! Raw bytes of a line that were kept in a file.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::{ConnectError, Connection, Connector};

/// Opens a file of bytes.
#[derive(Clone)]
pub(in crate::capture) struct FileConnector {
    path: PathBuf,
}

impl FileConnector {
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
        }
    }
}

impl Connector for FileConnector {
    const IS_LIVE: bool = false;

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let refuse = |error: std::io::Error| ConnectError::Absent(error.to_string());
        let kind = std::fs::metadata(&self.path).map_err(refuse)?;
        if !kind.is_file() {
            // Pipes and devices block, and a source that blocks cannot be stopped.
            return Err(ConnectError::Unusable(
                "it is not a regular file".to_owned(),
            ));
        }
        let file = File::open(&self.path).map_err(refuse)?;
        Ok(Connection {
            bytes: Box::new(file),
            readiness: None,
            endpoint: self.path.display().to_string(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::hc11::{Framing, encode};
    use crate::capture::{SourceEvent, SourceUri, StreamOptions, open};

    fn name(path: &Path) -> SourceUri {
        SourceUri::File {
            path: path.to_owned(),
            line: StreamOptions {
                baud: 9600.try_into().unwrap(),
                ..StreamOptions::default()
            },
        }
    }

    #[test]
    fn a_file_plays_at_the_nominal_baud_to_its_last_frame() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut bytes = b"noise".to_vec();
        for number in 1..=30 {
            bytes.extend(encode(Framing::Double06, &[number; 64]));
        }
        std::fs::write(file.path(), bytes).unwrap();
        let mut source = open(&name(file.path())).unwrap();
        assert!(!source.is_live());
        for number in 1..=30 {
            let SourceEvent::Reading(reading) = source.next().unwrap() else {
                panic!("no frame {number}");
            };
            assert_eq!(reading.time.0, number * 68_750);
        }
        assert_eq!(source.next().unwrap(), SourceEvent::End);
        assert_eq!(source.next().unwrap(), SourceEvent::End);
        let counts = source.stats();
        assert_eq!(
            (counts.readings, counts.skipped_bytes, counts.losses),
            (30, 5, 0)
        );
    }

    #[test]
    fn what_is_no_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let message = |path: &Path| open(&name(path)).err().unwrap().to_string();
        assert!(message(folder.path()).contains("it is not a regular file"));
        assert!(message(&folder.path().join("absent")).contains("cannot open file:"));
    }
}
