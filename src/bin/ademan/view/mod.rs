//! The live view: the boards, fingertips, values and messages of a session, in the terminal. `demo`, `run` and `watch`
//! share it.
//!
//! Views come from a [`Viewer`] of the session, or through the control socket. A thread draws them, at most 30 times a
//! second. It never delays a session: the session drops views that the terminal has no time for.

pub mod look;
mod painter;
pub mod picture;
pub mod terminal;

use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ademan::advice;
use ademan::session::view::{View, Viewer};
use clap::ValueEnum;
use crossbeam_channel::Receiver;

use crate::{messages, signals};
use look::Look;
use painter::Painter;

/// Longest wait for messages at the end of the view, or when the program ends without order.
const EXIT_TIMEOUT: Duration = Duration::from_millis(200);

/// The display of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ViewKind {
    /// The boards, fingertips and messages, drawn in place
    Board,
    /// Messages, line by line on standard error
    Log,
    /// Errors and warnings only
    None,
}

/// Returns `true` if standard output is a terminal in which a picture can be drawn.
pub fn is_possible() -> bool {
    let is_dumb = std::env::var("TERM").is_ok_and(|term| term == "dumb");
    !is_dumb && terminal::is_usable()
}

/// The origin of views.
pub enum Views {
    /// A session of this process.
    Session(Viewer),
    /// Another process, and the source of its messages.
    Remote(Viewer),
}

impl Views {
    fn receiver(&self) -> &Receiver<View> {
        match self {
            Self::Session(viewer) | Self::Remote(viewer) => viewer.views(),
        }
    }
}

/// Lines of the command itself, such as the text that the demo types.
#[derive(Clone, Default)]
pub struct TaskLines(Arc<Mutex<Vec<String>>>);

impl TaskLines {
    /// Replaces the lines.
    pub fn set(&self, lines: Vec<String>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = lines;
    }

    fn get(&self) -> Vec<String> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

/// The view in the terminal. Dropping it restores the terminal, and prints the last picture and the messages there.
pub struct LiveView {
    painter: Option<JoinHandle<io::Result<Option<String>>>>,
    task: TaskLines,
}

impl LiveView {
    /// Covers the terminal until this is dropped. A terminal that cannot be covered stays as it is.
    pub fn open(views: Views) -> Self {
        let task = TaskLines::default();
        let painter = start(views, task.clone());
        let painter = painter.inspect_err(|error| {
            abandon();
            tracing::warn!("cannot draw in this terminal, continuing without: {error}");
        });
        Self {
            painter: painter.ok(),
            task,
        }
    }

    /// Returns the lines of the command.
    pub fn task(&self) -> &TaskLines {
        &self.task
    }

    /// Waits until the views have ended.
    pub fn wait(mut self) {
        self.finish(|| {});
    }

    fn finish(&mut self, before: impl FnOnce()) {
        let Some(painter) = self.painter.take() else {
            return;
        };
        before();
        let painted = painter.join();
        terminal::restore();
        match painted {
            Ok(Ok(Some(picture))) => terminal::write_after(&picture),
            Ok(Ok(None)) => {}
            _ => tracing::warn!("cannot draw in this terminal"),
        }
        messages::release();
        // The caller prints its result next, after the messages that led to it.
        messages::flush_within(EXIT_TIMEOUT);
    }
}

impl Drop for LiveView {
    fn drop(&mut self) {
        self.finish(painter::end);
    }
}

fn start(views: Views, task: TaskLines) -> io::Result<JoinHandle<io::Result<Option<String>>>> {
    // A second Ctrl-C, or a program that hangs, ends without dropping the view.
    signals::before_exit(leave_at_once);
    painter::begin();
    terminal::take_over()?;
    let painter = Painter::new(views, task, Look::from_environment())?;
    messages::hold();
    let thread = thread::Builder::new().name("view".into());
    let thread = thread.spawn(move || painter.run());
    thread.map_err(|error| io::Error::other(advice::no_thread(&error).to_string()))
}

/// Makes the view end.
pub fn end() {
    painter::end();
}

/// Restores the terminal at once, from any thread and in any state of the program. Messages go to standard error again.
pub fn abandon() {
    terminal::restore();
    messages::release();
}

/// Restores the terminal, and writes the messages that the view has shown, as far as that does not wait long.
fn leave_at_once() {
    abandon();
    messages::flush_within(EXIT_TIMEOUT);
}

/// Restores the terminal while the program is stopped (Ctrl-Z), and returns whether the view covered it.
#[cfg(unix)]
pub fn suspend() -> bool {
    let was_covered = terminal::is_covered();
    if was_covered {
        abandon();
    }
    was_covered
}

/// Covers the terminal again, unless the program continues in the background.
#[cfg(unix)]
pub fn resume() {
    if terminal::is_usable() && terminal::take_over().is_ok() {
        messages::hold();
    }
}

#[cfg(all(test, target_os = "linux"))]
mod panic_tests;
