//! Messages on standard error, which may be a terminal that is stopped or a full pipe.
//!
//! A command that runs a session [starts](start) a queue with a thread of its own, so that no message delays a release.
//! A full queue drops messages, and their number is printed once the stream accepts data again. The other commands print at once.
//! While the live view covers the terminal, messages are [held](hold) for it, and written to standard error when it ends.
//! Text of others is escaped, and log messages are limited by kind and source. A log file has a queue of its own. On a terminal,
//! lines break between words.

mod args;
mod log;
mod log_file;
mod queue;
mod stream;
mod terminal_width;
mod wrap;

use std::sync::OnceLock;
use std::time::Duration;

use ademan::message::escape_lines;
use ademan::session::Notice;

pub use self::args::LogArgs;
use self::queue::{Due, MessageQueue};
use self::stream::MessageStream;
pub use self::stream::{hold, latest, release};
pub use self::terminal_width::output_columns;
pub use self::wrap::row;
use crate::failure::Failure;

/// Longest wait at the end of the program for a standard error that is not read.
const FLUSH_TIMEOUT: Duration = Duration::from_millis(500);

static QUEUE: OnceLock<MessageQueue> = OnceLock::new();

/// Only errors and warnings are printed.
static IS_QUIET: OnceLock<bool> = OnceLock::new();

/// Prints messages and logs as the arguments say. May start a thread.
pub fn install(args: &LogArgs) -> Result<(), Failure> {
    let (verbosity, error) = args.verbosity();
    // This is called once.
    let _ = IS_QUIET.set(verbosity.is_quiet);
    log::install(verbosity.levels);
    if let Some(path) = &args.log {
        log_file::open(path)?;
    }
    if let Some(error) = error {
        complain!("warning: {error}");
    }
    Ok(())
}

/// Prints all later messages on a thread of its own. A second call has no effect.
pub fn start() -> Result<(), Failure> {
    if QUEUE.get().is_some() {
        return Ok(());
    }
    let queue = MessageQueue::start(MessageStream, take_due).map_err(Failure::no_thread)?;
    // A second queue would have no messages.
    let _ = QUEUE.set(queue);
    Ok(())
}

/// Returns log messages that were held back, and writes them to the log file.
fn take_due() -> Due {
    let (due, next_due) = log::take_due();
    due.iter().for_each(|lines| log_file::write(lines));
    (due, next_due)
}

/// Prints a message of one or more lines, unless the program is quiet. A closed or full standard error is ignored: it must not
/// end a session.
pub fn print(message: &str) {
    print_line(message, IS_QUIET.get() == Some(&true));
}

/// Prints an error or a warning.
pub fn print_error(message: &str) {
    print_line(message, false);
}

/// Prints a notice of a session.
pub fn print_notice(notice: &Notice) {
    let message = notice.to_string();
    if notice.is_routine() {
        print(&message)
    } else {
        print_error(&message)
    }
}

fn print_line(message: &str, is_hidden: bool) {
    let line = format!("{}\n", escape_lines(message));
    log_file::write(&line);
    match QUEUE.get() {
        _ if is_hidden => {}
        Some(queue) => queue.push(line),
        // The test harness captures only what is written by the macro.
        None if cfg!(test) => eprint!("{line}"),
        None => _ = stream::write_to_terminal(&line),
    }
}

/// Waits until all messages are printed, at most 0.5 s.
pub fn flush() {
    flush_within(FLUSH_TIMEOUT);
}

/// Waits until all messages are printed, or the time is over.
pub fn flush_within(timeout: Duration) {
    // Messages of levels that are not printed were not held back.
    let held_back = log::take_all();
    held_back.iter().for_each(|message| print_error(message));
    // Its failure is a message.
    log_file::flush(timeout);
    if let Some(queue) = QUEUE.get() {
        queue.flush(timeout);
    }
}

/// Makes the thread ask for log messages that are held back.
fn wake() {
    if let Some(queue) = QUEUE.get() {
        queue.wake();
    }
}
