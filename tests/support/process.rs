//! Child processes of a test.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::process::{Child, Command, ExitStatus};
use std::sync::{Arc, Mutex, MutexGuard, Once, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The longest time that a child process of a test runs, even on a busy machine.
const LIFETIME: Duration = Duration::from_secs(600);

/// The longest time until a child process ends after it was told to, or has nothing more to do, even on a busy machine.
const EXIT_TIMEOUT: Duration = Duration::from_secs(60);

/// Variables of runs that may take longer: a person sets the first two; `tests/outputs/vm`, which has its own limit, sets the others.
const NO_LIMIT: [&str; 4] = [
    "ADEMAN_CHAOS_SECONDS",
    "ADEMAN_MINUTES",
    "ADEMAN_PROGRAM",
    "ADEMAN_VM_TIMES",
];

/// A child process that is killed when this is dropped.
pub struct Process(pub Child);

impl Process {
    /// Starts the process.
    pub fn start(command: &mut Command) -> io::Result<Self> {
        limit_lifetimes();
        let _lock = lock_spawning();
        command.spawn().map(Self)
    }

    /// Waits for the end of the process.
    pub fn wait_for_exit(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.0.try_wait().expect("a child process") {
                return status;
            }
            assert!(start.elapsed() < EXIT_TIMEOUT, "the process does not end");
            thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// From now on, kills each child process of this test program that runs longer than any test needs (Linux), so that a test that waits for
/// it or reads from it fails instead of hanging.
pub fn limit_lifetimes() {
    static LIMIT: Once = Once::new();
    if NO_LIMIT.iter().all(|name| env::var_os(name).is_none()) {
        LIMIT.call_once(|| _ = thread::spawn(kill_overdue_children));
    }
}

fn kill_overdue_children() {
    let mut first_seen: BTreeMap<u32, Instant> = BTreeMap::new();
    loop {
        thread::sleep(Duration::from_secs(5));
        let present = children(std::process::id());
        first_seen.retain(|id, _| present.contains(id));
        for id in present {
            let since = first_seen.entry(id).or_insert_with(Instant::now);
            if since.elapsed() > LIFETIME {
                kill_with_children(id);
            }
        }
    }
}

/// Kills a process and its descendants, which may have inherited its pipes.
fn kill_with_children(process: u32) {
    let line = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
    // A process that has ended and is not waited for yet has no command line.
    if line.is_empty() {
        return;
    }
    let mut all = vec![process];
    let mut next = 0;
    while let Some(&parent) = all.get(next) {
        all.extend(children(parent));
        next += 1;
    }
    let line = String::from_utf8_lossy(&line).replace('\0', " ");
    // The test harness captures `eprintln!` as output of the test that has started this thread.
    let _ = writeln!(
        io::stderr(),
        "killed, because it did not end in {LIFETIME:?}: {line}"
    );
    let mut kill = Command::new("kill");
    kill.args(["-s", "KILL"])
        .args(all.iter().map(u32::to_string));
    // Some of them may have ended since.
    if let Ok(mut kill) = Process::start(&mut kill) {
        let _ = kill.0.wait();
    }
}

/// Sends a signal to a process, by the name that `kill -s` uses, such as `STOP`.
pub fn signal(signal: &str, process: u32) {
    let mut kill = Command::new("kill");
    kill.args(["-s", signal, &process.to_string()]);
    let mut kill = Process::start(&mut kill).expect("kill is installed");
    let status = kill.0.wait().expect("kill exits");
    assert!(status.success(), "no process {process}");
}

/// Returns the content of a file in `/proc` for each thread of a process (Linux). Fails if there is no such process.
pub fn read_of_threads(process: u32, file: &str) -> io::Result<Vec<String>> {
    let threads = fs::read_dir(format!("/proc/{process}/task"))?.flatten();
    let read = |thread: fs::DirEntry| fs::read_to_string(thread.path().join(file));
    // A thread may end while the list is read.
    Ok(threads.flat_map(read).collect())
}

/// Returns the ids of the child processes of a process (Linux).
pub fn children(process: u32) -> Vec<u32> {
    let lists = read_of_threads(process, "children")
        .unwrap_or_default()
        .concat();
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
