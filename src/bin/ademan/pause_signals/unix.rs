//! SIGUSR1 and SIGTSTP on Unix systems.

use std::thread;
use std::time::Duration;

use ademan::command::{Command, CommandOrigin};
use ademan::priority;
use ademan::session::{CommandSender, Reply};
use signal_hook::consts::signal::{SIGTSTP, SIGUSR1};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::failure::Failure;
use crate::view;

/// Longest wait for the session; a process that hangs is stopped all the same.
const REPLY_TIMEOUT: Duration = Duration::from_millis(500);

/// Time for outputs with threads of their own to release all keys.
const OUTPUT_DELAY: Duration = Duration::from_millis(50);

/// Handles the signals until the program ends.
pub fn install(commands: CommandSender) -> Result<(), Failure> {
    let failed = |error| Failure::job(format!("cannot handle signals: {error}"));
    let mut signals = Signals::new([SIGUSR1, SIGTSTP]).map_err(failed)?;
    let pause = commands.with_origin(CommandOrigin::Signal);
    let suspended = commands.with_origin(CommandOrigin::Suspend);
    let handle = move || {
        // An emergency stop does not wait for other programs.
        priority::raise_thread_priority();
        for signal in &mut signals {
            match signal {
                SIGUSR1 => _ = pause.send(Command::Pause),
                _ => suspend(&suspended),
            }
        }
    };
    let thread = thread::Builder::new().name("signals".into());
    thread.spawn(handle).map(drop).map_err(Failure::no_thread)
}

/// Handles Ctrl-Z until the program ends, for a program without a session: gives the terminal back while it is stopped.
pub fn install_without_session() -> Result<(), Failure> {
    let failed = |error| Failure::job(format!("cannot handle signals: {error}"));
    let mut signals = Signals::new([SIGTSTP]).map_err(failed)?;
    let handle = move || signals.forever().for_each(|_| stop_process());
    let thread = thread::Builder::new().name("signals".into());
    thread.spawn(handle).map(drop).map_err(Failure::no_thread)
}

/// Pauses the session and stops the process. The session resumes when the process is continued, unless another pause was
/// in effect before or was requested meanwhile.
fn suspend(commands: &CommandSender) {
    let request = |command| commands.request_with_timeout(command, REPLY_TIMEOUT);
    let was_paused =
        matches!(request(Command::State), Ok(Reply::State(status)) if status.paused_by.is_some());
    if !was_paused {
        let _ = request(Command::Pause);
    }
    thread::sleep(OUTPUT_DELAY);
    stop_process();
    if !was_paused {
        let _ = request(Command::Resume);
    }
}

/// Stops the process until it is continued. The view is closed meanwhile.
fn stop_process() {
    let was_viewed = view::suspend();
    if let Err(error) = emulate_default_handler(SIGTSTP) {
        complain!("cannot stop this process: {error}");
    }
    if was_viewed {
        view::resume();
    }
}
