//! The systemd scope of the watchdog.
//!
//! A service manager that kills a unit kills all processes in its control group: `systemctl kill -s KILL`, a memory limit,
//! `systemd-oomd`. In a scope of its own the watchdog survives this and releases the keys of the program.

use std::env;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::output::watchdog::scope_name;

/// The method that creates a scope for running processes (`man 5 org.freedesktop.systemd1`), with its signature.
const METHOD: [&str; 5] = [
    "org.freedesktop.systemd1",
    "/org/freedesktop/systemd1",
    "org.freedesktop.systemd1.Manager",
    "StartTransientUnit",
    "ssa(sv)a(sa(sv))",
];

/// Properties of the scope, beside its process: a failed scope is forgotten, an end of the session waits no longer for the
/// watchdog than the unit waits for the program, and the scope has the processor weight of the unit.
const PROPERTIES: [&str; 9] = [
    "CollectMode",
    "s",
    "inactive-or-failed",
    "TimeoutStopUSec",
    "t",
    "5000000",
    "CPUWeight",
    "t",
    "1000",
];

/// Longest time in which the service manager replies. It is also the limit of `busctl`, in seconds.
const REPLY_TIMEOUT: Duration = Duration::from_secs(5);

/// Delay before the next check of the exit of `busctl`.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Moves this process to a scope of its own if a user manager of systemd runs.
///
/// Returns at once: a thread calls the manager, and a manager that does not reply delays nothing. On failure the process
/// stays in the control group of the program.
pub fn enter() {
    if !is_manager_running() {
        return;
    }
    // For lack of a thread or a process the watchdog works as it does without a manager.
    let _ = thread::Builder::new().name("scope".into()).spawn(|| {
        if let Ok(busctl) = call(std::process::id()).spawn() {
            wait(busctl);
        }
    });
}

/// Returns `true` if the runtime folder belongs to a user manager.
fn is_manager_running() -> bool {
    let runtime = env::var_os("XDG_RUNTIME_DIR").filter(|folder| !folder.is_empty());
    runtime.is_some_and(|folder| Path::new(&folder).join("systemd/private").exists())
}

/// Returns the command that calls the manager. `busctl` is part of systemd; a library for D-Bus would be larger than the
/// rest of the watchdog.
fn call(process: u32) -> Command {
    let (scope, process) = (scope_name(process), process.to_string());
    let timeout = format!("--timeout={}", REPLY_TIMEOUT.as_secs());
    let mut command = Command::new("busctl");
    command
        .args(["--user", "--quiet", &timeout, "call"])
        .args(METHOD)
        // Five properties, and no other units.
        .args([&scope, "fail", "5", "PIDs", "au", "1", &process])
        .args(["Description", "s", "Watchdog of ademan"])
        .args(PROPERTIES)
        .arg("0")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

/// Waits for the exit of `busctl`, at most twice its own limit.
fn wait(mut busctl: Child) {
    let start = Instant::now();
    while let Ok(None) = busctl.try_wait() {
        if start.elapsed() > 2 * REPLY_TIMEOUT {
            let _ = busctl.kill();
            let _ = busctl.wait();
            return;
        }
        thread::sleep(POLL_INTERVAL);
    }
}
