//! Other programs, started and ended by a test.

use std::io::Result;
use std::process::{Child, Command};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A process that ends with its owner.
pub struct Process(pub Child);

impl Process {
    /// Starts it.
    pub fn start(command: &mut Command) -> Result<Self> {
        let _alone = no_program_starts();
        command.spawn().map(Self)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// While this is held, no program is started.
///
/// A program gets a copy of all that is open at that moment and not marked otherwise; with the end of a pseudo
/// terminal that is just being made it would keep a line alive that a test unplugs.
pub fn no_program_starts() -> MutexGuard<'static, ()> {
    static STARTING: Mutex<()> = Mutex::new(());
    STARTING.lock().unwrap_or_else(PoisonError::into_inner)
}
