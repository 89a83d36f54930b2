//! Locks of files.

use std::fs::{File, TryLockError};
use std::io;
use std::ops::Deref;

/// A locked file, which is unlocked when it is dropped.
///
/// Closing alone keeps the lock while a child has the descriptor: until it has executed its program.
#[derive(Debug)]
pub struct LockedFile(File);

impl LockedFile {
    /// Locks a file, after any other process or handle has unlocked it.
    pub fn lock(file: File) -> io::Result<Self> {
        file.lock()?;
        Ok(Self(file))
    }

    /// Locks a file. Fails if another process, or another handle of this one, has locked it.
    pub fn try_lock(file: File) -> Result<Self, TryLockError> {
        file.try_lock()?;
        Ok(Self(file))
    }
}

impl Deref for LockedFile {
    type Target = File;

    fn deref(&self) -> &File {
        &self.0
    }
}

impl Drop for LockedFile {
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_descriptor_that_a_child_has_inherited_keeps_no_lock() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let locked = LockedFile::try_lock(file.reopen().unwrap()).unwrap();
        let inherited = locked.try_clone().unwrap();
        let is_locked = || LockedFile::try_lock(file.reopen().unwrap()).is_err();
        assert!(is_locked());
        drop(locked);
        assert!(!is_locked());
        drop(inherited);
    }
}
