//! The lock of the folder with the tokens, so that commands do not undo each other's work.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use super::{file_error, secret_file};
use crate::files;
use crate::network::NetworkError;

/// The file that is locked. It stays, empty.
const NAME: &str = "lock";

/// Longest wait for another command.
const TIMEOUT: Duration = Duration::from_secs(10);

/// Pause between two tries.
const RETRY_INTERVAL: Duration = Duration::from_millis(5);

/// The right to change the files in a folder, until it is dropped. The system withdraws it from a process that ends.
///
/// Without it, a command that adds a token could write the list back that it has read before another one removed a token.
#[derive(Debug)]
pub struct FolderLock {
    folder: PathBuf,
    _file: File,
}

impl FolderLock {
    /// Locks a folder, and creates it if it does not exist. Waits for another command.
    pub fn acquire(folder: &Path) -> Result<Self, NetworkError> {
        secret_file::create_folder(folder)?;
        let path = folder.join(NAME);
        let fail = |error: io::Error| file_error("lock", &path, error);
        let file = files::open_private(&path).map_err(|error| file_error("write", &path, error))?;
        let start = Instant::now();
        loop {
            match file.try_lock() {
                Ok(()) => break,
                Err(TryLockError::WouldBlock) if start.elapsed() < TIMEOUT => {
                    thread::sleep(RETRY_INTERVAL);
                }
                Err(TryLockError::WouldBlock) => {
                    return Err(NetworkError::Token(
                        "another `ademan token` is still running; end it and try again".into(),
                    ));
                }
                Err(TryLockError::Error(error)) => return Err(fail(error)),
            }
        }
        Ok(Self {
            folder: folder.into(),
            _file: file,
        })
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}
