//! Signals that hold a run up: SIGUSR1 pauses it, and Ctrl-Z (SIGTSTP) stops the program, after everything was
//! let go of.

use std::thread;
use std::time::Duration;

use ademan::session::{Answer, Call, Calls, Order, SessionStatus};
use crossbeam_channel::bounded;
use signal_hook::consts::signal::{SIGTSTP, SIGUSR1};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::failure::Failure;

/// How long a run may take to answer; one that hangs is stopped all the same.
const PATIENCE: Duration = Duration::from_millis(500);

/// How long outputs with threads of their own may take to follow.
const OUTPUT_LIMIT: Duration = Duration::from_millis(50);

/// Listens until the program ends.
pub fn watch(calls: Calls) -> Result<(), Failure> {
    let failed = |error| Failure::job(format!("cannot listen for signals: {error}"));
    let mut signals = Signals::new([SIGUSR1, SIGTSTP]).map_err(failed)?;
    let listen = move || {
        for signal in &mut signals {
            match signal {
                SIGUSR1 => _ = ask(&calls, Order::Pause),
                _ => suspend(&calls),
            }
        }
    };
    let thread = thread::Builder::new().name("signals".into());
    thread.spawn(listen).map(drop).map_err(failed)
}

/// Lets go of everything and stops the program; when it is continued, so is the run.
fn suspend(calls: &Calls) {
    let was_paused = matches!(
        ask(calls, Order::State),
        Some(Answer::State(SessionStatus {
            is_paused: true,
            ..
        }))
    );
    ask(calls, Order::Pause);
    thread::sleep(OUTPUT_LIMIT);
    if let Err(error) = emulate_default_handler(SIGTSTP) {
        say!("cannot stop: {error}");
    }
    if !was_paused {
        ask(calls, Order::Resume);
    }
}

fn ask(calls: &Calls, order: Order) -> Option<Answer> {
    let (answer, answers) = bounded(1);
    calls.send_timeout(Call { order, answer }, PATIENCE).ok()?;
    answers.recv_timeout(PATIENCE).ok()?.ok()
}
