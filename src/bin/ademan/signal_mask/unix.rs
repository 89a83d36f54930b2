//! The signal mask on Unix systems. Threads inherit it, so it is set before the first is started.
//!
//! A process inherits the mask of its parent. The mask is replaced, because a parent that blocks SIGUSR1, SIGINT or SIGTERM
//! would otherwise disable the emergency stop.

use std::fs;
use std::sync::Arc;

use nix::errno::Errno;
use nix::sys::signal::{SigSet, Signal};
use signal_hook::flag;

use crate::failure::Failure;

/// The signals with a handler, and those whose default action a person or the system relies on.
const USED: &[Signal] = &[
    Signal::SIGHUP,
    Signal::SIGINT,
    Signal::SIGQUIT,
    Signal::SIGILL,
    Signal::SIGTRAP,
    Signal::SIGABRT,
    Signal::SIGBUS,
    Signal::SIGFPE,
    Signal::SIGUSR1,
    Signal::SIGSEGV,
    Signal::SIGPIPE,
    Signal::SIGTERM,
    Signal::SIGCHLD,
    Signal::SIGCONT,
    Signal::SIGTSTP,
    Signal::SIGTTIN,
    Signal::SIGTTOU,
    Signal::SIGXCPU,
    Signal::SIGWINCH,
    Signal::SIGSYS,
];

/// Ignores every signal that can be ignored: no signal to all processes of this program may end the watchdog.
pub fn block_all() -> Result<(), Failure> {
    SigSet::all().thread_set_mask().map_err(failed)
}

/// Ignores the signals that this program has no use for, and receives all others.
pub fn block_unused() -> Result<(), Failure> {
    unused().thread_set_mask().map_err(failed)
}

/// Ignores what [`block_unused`] ignores, and SIGUSR1, for a command that types nothing: the emergency stop is sent to all programs of
/// this name.
pub fn block_emergency_stop() -> Result<(), Failure> {
    // The library of serial lines waits without the mask: then a handler without an effect takes the signal.
    flag::register(Signal::SIGUSR1 as i32, Arc::default())
        .map_err(|error| Failure::job(format!("cannot handle SIGUSR1: {error}")))?;
    let mut ignored = unused();
    ignored.add(Signal::SIGUSR1);
    ignored.thread_set_mask().map_err(failed)
}

fn unused() -> SigSet {
    let mut unused = SigSet::all();
    for signal in USED {
        unused.remove(*signal);
    }
    if is_hangup_ignored() {
        // The handler of this program would replace the choice of `nohup`; a blocked signal does not reach it.
        unused.add(Signal::SIGHUP);
    }
    unused
}

/// Makes a read of the terminal by this thread fail while the program is in the background, instead of stopping the program.
#[cfg(feature = "tls")]
pub fn block_background_reads() -> Result<(), Failure> {
    let mut stop = SigSet::empty();
    stop.add(Signal::SIGTTIN);
    stop.thread_block().map_err(failed)
}

/// Returns `true` if the parent process has set SIGHUP to be ignored, as `nohup` does. `false` without procfs.
fn is_hangup_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & 1 << (Signal::SIGHUP as u32 - 1) != 0)
}

fn failed(error: Errno) -> Failure {
    Failure::job(format!("cannot ignore signals: {error}"))
}
