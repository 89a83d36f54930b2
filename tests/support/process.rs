//! Other programs, started and ended by a test.

use std::io::{self, BufRead, BufReader, Read};
use std::process::{Child, Command};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

/// A process that ends with its owner.
pub struct Process(pub Child);

impl Process {
    /// Starts it.
    pub fn start(command: &mut Command) -> io::Result<Self> {
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

/// The lines of a stream, as they come.
pub fn overheard(stream: impl Read + Send + 'static) -> Arc<Mutex<Vec<String>>> {
    let heard = Arc::new(Mutex::new(Vec::new()));
    let listener = Arc::clone(&heard);
    thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            listener.lock().unwrap().push(line);
        }
    });
    heard
}

/// While this is held, no program is started.
///
/// A program gets a copy of all that is open at that moment and not marked otherwise; with the end of a pseudo
/// terminal that is just being made it would keep a line alive that a test unplugs.
pub fn no_program_starts() -> MutexGuard<'static, ()> {
    static STARTING: Mutex<()> = Mutex::new(());
    STARTING.lock().unwrap_or_else(PoisonError::into_inner)
}
