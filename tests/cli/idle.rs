//! The idle program: a silent glove, an unchanged layout file, a control socket without clients. No thread wakes up, except
//! for the checks that the watchdog and the display are there.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use crate::support::binary::ademan;
use crate::support::process::{Process, lock_spawning};
use crate::support::run::{TIMEOUT, line_receiver, postures, shipped};
use crate::support::x11::XServer;
use ademan::capture::hc11::{Framing, encode};
use ademan::capture::{Hc11Format, Loopback, open_loopback};
use tempfile::TempDir;

/// The time over which wake-ups are counted. Every timer of the program is shorter.
const WINDOW: Duration = Duration::from_secs(3);

/// A timer wakes its thread in every window. Work that a busy machine does late wakes it in one of them.
const WINDOWS: usize = 6;

/// A session whose glove sends nothing.
struct Idle {
    program: Process,
    _loopback: Loopback,
    _folder: TempDir,
}

impl Idle {
    fn start(output: &str, display: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("my.ron"), shipped("qwerty-flat")).expect("a file");
        fs::write(
            folder.path().join("setup.ron"),
            "Setup(layout: \"my.ron\", stall_timeout_ms: 300)",
        )
        .expect("a file");
        let mut loopback = {
            let _alone = lock_spawning();
            open_loopback(Hc11Format::default()).expect("a line")
        };
        let source = loopback.uri.to_string();
        let arguments = ["run", "setup.ron", "--source", &source, "--output", output];
        let mut command = ademan(arguments);
        command
            .args(["--armed", "--control", "control.sock"])
            .current_dir(folder.path())
            .env("DISPLAY", display)
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut program = Process::start(&mut command).expect("the program starts");
        let messages = line_receiver(program.0.stderr.take().expect("it is piped"));
        let wait_for = |part: &str| {
            while !messages.recv_timeout(TIMEOUT).expect(part).contains(part) {}
        };
        wait_for("listening to");
        let hand = encode(Framing::Double06, &postures().0);
        for _ in 0..20 {
            loopback.writer.write_all(&hand).expect("the line is open");
        }
        wait_for("stalled");
        Self {
            program,
            _loopback: loopback,
            _folder: folder,
        }
    }

    /// Returns the number of wake-ups so far by thread: its ID and its name.
    fn wake_ups(&self) -> BTreeMap<String, u64> {
        let tasks = format!("/proc/{}/task", self.program.0.id());
        let tasks = fs::read_dir(tasks).expect("the program runs");
        tasks.flatten().map(|task| wake_ups(&task.path())).collect()
    }

    /// Returns the wake-ups of each thread in its quietest window. Returns early once every thread had a window without.
    fn recurring_wake_ups(&self) -> BTreeMap<String, u64> {
        let mut fewest: BTreeMap<String, u64> = BTreeMap::new();
        let mut before = self.wake_ups();
        for _ in 0..WINDOWS {
            sleep(WINDOW);
            let after = self.wake_ups();
            for (thread, count) in &after {
                let woken = count - before.get(thread).copied().unwrap_or(0);
                let least = fewest.entry(thread.clone()).or_insert(woken);
                *least = woken.min(*least);
            }
            if fewest.values().all(|count| *count == 0) {
                break;
            }
            before = after;
        }
        fewest
    }
}

/// Returns the name of a thread and its voluntary context switches: a thread makes one each time it waits again.
fn wake_ups(task: &Path) -> (String, u64) {
    let status = fs::read_to_string(task.join("status")).expect("the status of a thread");
    let field = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name));
        line.expect("a field of the status").trim().to_owned()
    };
    let thread = format!("{} {}", field("Pid:"), field("Name:"));
    let count = field("voluntary_ctxt_switches:");
    (thread, count.parse().expect("a number"))
}

/// Most wake-ups of a thread in a window with a watchdog: two for each of its probes, which are 0.4 s apart. A window begins and
/// ends within the wake-ups of one.
const CHECKS: u64 = 2 * (3_000 / 400 + 2);

/// Checks that no thread wakes up more often than this in its quietest window.
fn check_wake_ups(output: &str, display: &str, most: u64) {
    let idle = Idle::start(output, display);
    let found = idle.recurring_wake_ups();
    println!("recurring wake-ups in {WINDOW:?} with the output {output}:");
    for (thread, count) in &found {
        println!("{count:8}  {thread}");
    }
    assert!(found.len() > 3, "the threads of a run: {found:?}");
    assert!(
        found.values().all(|count| *count <= most),
        "{output}: {found:#?}"
    );
}

#[test]
fn an_idle_session_does_not_wake_up() {
    check_wake_ups("transcript", "", 0);
}

#[test]
fn an_idle_session_with_a_desktop_wakes_up_only_to_check_its_watchdog_and_display() {
    let Some(server) = XServer::start() else {
        return;
    };
    check_wake_ups("desktop", server.display(), CHECKS);
}

#[test]
fn an_idle_session_with_uinput_devices_wakes_up_only_to_check_its_watchdog() {
    if let Err(error) = fs::File::options().write(true).open("/dev/uinput") {
        println!("SKIPPED: /dev/uinput: {error}");
        return;
    }
    check_wake_ups("uinput", "", CHECKS);
}
