//! Child processes of a test.

use std::fs;
use std::io::{self, BufRead, BufReader, Read};
use std::process::{Child, Command};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

/// A child process that is killed when this is dropped.
pub struct Process(pub Child);

impl Process {
    /// Starts the process.
    pub fn start(command: &mut Command) -> io::Result<Self> {
        let _lock = lock_spawning();
        command.spawn().map(Self)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Sends a signal to a process. It has the name that `kill -s` uses: `STOP`.
pub fn signal(signal: &str, process: u32) {
    let mut kill = Command::new("kill");
    kill.args(["-s", signal, &process.to_string()]);
    let mut kill = Process::start(&mut kill).expect("kill is installed");
    let status = kill.0.wait().expect("kill exits");
    assert!(status.success(), "no process {process}");
}

/// Returns what this file in `/proc` says of each thread of a process (Linux). Fails if there is no such process.
pub fn of_threads(process: u32, file: &str) -> io::Result<Vec<String>> {
    let threads = fs::read_dir(format!("/proc/{process}/task"))?.flatten();
    let read = |thread: fs::DirEntry| fs::read_to_string(thread.path().join(file));
    // A thread may end while the list is read.
    Ok(threads.flat_map(read).collect())
}

/// Returns the ids of the child processes of a process (Linux).
pub fn children(process: u32) -> Vec<u32> {
    let lists = of_threads(process, "children").unwrap_or_default().concat();
    let ids = lists.split_whitespace();
    ids.filter_map(|id| id.parse().ok()).collect()
}

/// Collects the lines of a stream in a thread.
pub fn collect_lines(stream: impl Read + Send + 'static) -> Arc<Mutex<Vec<String>>> {
    let lines = Arc::new(Mutex::new(Vec::new()));
    let collected = Arc::clone(&lines);
    thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            collected.lock().unwrap().push(line);
        }
    });
    lines
}

/// Prevents the start of processes while the guard exists.
///
/// A child inherits all file descriptors that are not close-on-exec at that moment. With the end of a pseudo terminal
/// that is being opened, it would keep a line alive that a test disconnects.
pub fn lock_spawning() -> MutexGuard<'static, ()> {
    static SPAWNING: Mutex<()> = Mutex::new(());
    SPAWNING.lock().unwrap_or_else(PoisonError::into_inner)
}
