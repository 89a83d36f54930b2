//! SIGUSR1, SIGTSTP and SIGQUIT on Unix systems.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use ademan::command::{Command, CommandOrigin};
use ademan::priority;
use ademan::session::{CommandSender, Reply};
use signal_hook::consts::signal::{SIGCONT, SIGQUIT, SIGTSTP, SIGUSR1};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::failure::Failure;
use crate::{signals, view};

/// Longest wait for the session; a process that hangs is stopped all the same.
const REPLY_TIMEOUT: Duration = Duration::from_millis(500);

/// Time for outputs with threads of their own to release all keys.
const OUTPUT_DELAY: Duration = Duration::from_millis(50);

/// Values of [`LastRequest`].
const CONTINUE: usize = 0;
const STOP: usize = 1;

/// The session that the signals pause: the latest one of this process.
static SESSION: Mutex<Option<CommandSender>> = Mutex::new(None);

static IS_INSTALLED: AtomicBool = AtomicBool::new(false);

/// The last one of the signals that stop and continue the process. The system discards a stop when a SIGCONT follows, and so
/// does this program, which has work to do before it stops.
#[derive(Clone)]
struct LastRequest(Arc<AtomicUsize>);

impl LastRequest {
    /// Notes the signals from now on. To be called before another handler of SIGTSTP is installed.
    fn watch() -> io::Result<Self> {
        let last = Arc::new(AtomicUsize::new(CONTINUE));
        flag::register_usize(SIGTSTP, last.clone(), STOP)?;
        flag::register_usize(SIGCONT, last.clone(), CONTINUE)?;
        Ok(Self(last))
    }

    fn is_stop(&self) -> bool {
        self.0.load(Ordering::SeqCst) == STOP
    }
}

/// Handles the signals until the program ends. A later session takes the place of an earlier one.
pub fn install(commands: CommandSender) -> Result<(), Failure> {
    *lock_session() = Some(commands);
    install_without_session()
}

/// Handles the signals until the program ends, for a program that has no session, or none yet: Ctrl-Z gives the terminal back while it is
/// stopped, and Ctrl-\ before it ends. SIGUSR1 to all programs of this name does not end it, which would leave the terminal covered.
pub fn install_without_session() -> Result<(), Failure> {
    if IS_INSTALLED.swap(true, Ordering::SeqCst) {
        return Ok(());
    }
    let failed = |error| Failure::job(format!("cannot handle signals: {error}"));
    let last = LastRequest::watch().map_err(failed)?;
    let mut received = Signals::new([SIGUSR1, SIGTSTP, SIGQUIT]).map_err(failed)?;
    let handle = move || {
        // An emergency stop does not wait for other programs.
        priority::raise_thread_priority();
        for signal in &mut received {
            match signal {
                SIGUSR1 => pause(CommandOrigin::Signal),
                SIGTSTP => suspend(&last),
                _ => quit(),
            }
        }
    };
    let thread = thread::Builder::new().name("signals".into());
    thread.spawn(handle).map(drop).map_err(Failure::no_thread)
}

/// Pauses the session, if there is one, for a signal or for what acts as one.
pub fn pause(origin: CommandOrigin) {
    let session = lock_session();
    if let Some(commands) = session.as_ref() {
        // Before another session takes its place, which starts paused if this one was to be paused.
        let _ = commands.with_origin(origin).send(Command::Pause);
    }
}

fn lock_session() -> MutexGuard<'static, Option<CommandSender>> {
    SESSION.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Pauses the session, if there is one, and stops the process. The session resumes when the process is continued, unless another pause
/// was in effect before or was requested in the meantime.
fn suspend(last: &LastRequest) {
    let session = lock_session().clone();
    let Some(commands) = session.map(|it| it.with_origin(CommandOrigin::Suspend)) else {
        stop_process(last);
        return;
    };
    let request = |command| commands.request_with_timeout(command, REPLY_TIMEOUT);
    let was_paused =
        matches!(request(Command::State), Ok(Reply::State(status)) if status.paused_by.is_some());
    if !was_paused {
        let _ = request(Command::Pause);
    }
    thread::sleep(OUTPUT_DELAY);
    stop_process(last);
    if !was_paused {
        let _ = request(Command::Resume);
    }
}

/// Restores the terminal, and ends the process as without a handler. The watchdog releases the keys.
fn quit() {
    signals::run_last_action();
    // It does not return.
    let _ = emulate_default_handler(SIGQUIT);
}

/// Stops the process until it is continued, unless it was continued already. The view is closed while the process is stopped.
fn stop_process(last: &LastRequest) {
    let was_viewed = view::suspend();
    if last.is_stop()
        && let Err(error) = emulate_default_handler(SIGTSTP)
    {
        complain!("cannot stop this process: {error}");
    }
    if was_viewed {
        view::resume();
    }
}

#[cfg(test)]
mod tests {
    use nix::sys::signal::{Signal, raise};

    use super::*;
    use crate::own_process::has_own_process;

    const NAME: &str =
        "pause_signals::unix::tests::a_program_without_a_session_goes_on_after_sigusr1";

    #[test]
    fn a_program_without_a_session_goes_on_after_sigusr1() {
        if has_own_process(NAME) {
            install_without_session().expect("a thread");
            raise(Signal::SIGUSR1).expect("a signal");
        }
    }
}
