//! Stage 6: [`OutputEvent`]s → the operating system or a peer.
//!
//! A [`Backend`] is a kind of output; [`BACKENDS`] lists all of them. [`open`] turns a list of names, as written after
//! `--output`, into a [`Sink`].
//!
//! Adding a backend takes its file or folder, with a constant `BACKEND`, and one line in [`BACKENDS`].

use std::time::Duration;

use ademan_core::contact::TargetNames;
use ademan_core::device::signals::Signals;
use ademan_core::device::{Capabilities, OutputEvent, TimedCommand};
use ademan_core::message::{escape, escape_line};
use ademan_core::names::UnknownName;
use ademan_core::pipeline::TextState;

mod axis_state;
#[cfg_attr(
    not(target_os = "linux"),
    allow(
        dead_code,
        reason = "only the connection to an X server on Linux adds keys"
    )
)]
mod character_key;
pub mod desktop;
mod desktop_part;
pub mod ime;
pub mod midi;
mod null;
mod open;
pub mod osc;
mod pressed_key_file;
pub mod router;
#[cfg(all(target_os = "linux", feature = "ime"))]
mod sentence;
pub(crate) mod socket;
pub mod spacenav;
mod text_field;
pub mod transcript;
pub mod uinput;
pub mod watchdog;
mod watchdog_process;

pub use desktop::{Desktop, SUPPORTS_WAYLAND};
pub use desktop_part::DesktopPart;
pub use open::{
    available, check, check_layout_change, check_presence, discards_all, has_effect, keeps_order,
    open, open_for_session, transcript_files, uses_backend, uses_stdout,
};
pub use router::Router;
pub use text_field::{FieldKind, TextField};
pub use transcript::Transcript;
use watchdog::WatchdogSettings;
pub use watchdog_process::{AbandonedRelease, release_abandoned_keys, run as run_watchdog};

/// All backends of this build, in the order in which messages and help texts list them.
pub const BACKENDS: &[&Backend] = &[
    &transcript::BACKEND,
    &desktop::BACKEND,
    &uinput::BACKEND,
    &spacenav::BACKEND,
    &osc::BACKEND,
    &midi::BACKEND,
    &ime::BACKEND,
    &null::BACKEND,
];

/// Returns the backend of this name.
pub fn find_backend(name: &str) -> Result<&'static Backend, UnknownName> {
    let found = BACKENDS.iter().find(|backend| backend.name == name);
    let names = BACKENDS.iter().map(|backend| backend.name);
    found
        .copied()
        .ok_or_else(|| UnknownName::new("output", name, names))
}

/// Number of times an output repeats a call that the operating system rejected.
const RETRIES: usize = 3;

/// Delay before each repetition, in threads that may wait and at the end of a run.
const RETRY_DELAY: Duration = Duration::from_millis(10);

/// A kind of output.
pub struct Backend {
    /// The name, as in `--output NAME`.
    pub name: &'static str,
    /// The placeholder of the optional argument in `NAME:ARGUMENT`, such as `PATH`.
    pub argument: Option<&'static str>,
    /// `true` if the argument must be given.
    pub is_argument_required: bool,
    /// One line for help texts, in lower case and without a full stop.
    pub summary: &'static str,
    /// Returns what the backend can send on this operating system.
    pub capabilities: fn() -> Capabilities,
    /// `true` if the backend logs events: it receives every event, and it carries a capability only if all outputs are logs.
    pub is_log: bool,
    /// `true` if the capabilities are fixed when the output is opened; a layout that requires more needs a restart.
    pub is_fixed_when_open: bool,
    /// Uses the backend for a second without a visible effect and returns what worked, for
    /// `ademan doctor --test NAME`. `None` if there is nothing to test.
    pub check: Option<fn() -> Result<String, OutputError>>,
    /// Opens the output.
    pub open: fn(&OpenRequest) -> Result<Box<dyn Sink>, OutputError>,
}

impl std::fmt::Debug for Backend {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl PartialEq for Backend {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// The parameters of [`Backend::open`].
#[derive(Clone, Copy)]
pub struct OpenRequest<'a> {
    /// The output as written, with its argument; errors contain it.
    pub name: &'a str,
    /// The text after the colon.
    pub argument: Option<&'a str>,
    /// The capabilities that the layouts require of this output.
    pub required: &'a Capabilities,
    /// The watchdog to start, if the backend needs one.
    pub watchdog: Option<&'a WatchdogSettings>,
}

/// A function that receives the error of a log. It must not block.
pub type LogFailureReceiver = Box<dyn Fn(&OutputError) + Send>;

/// A receiver of events.
///
/// Dropping a sink releases every pressed key, as [`close`](Self::close) does.
///
/// An output of one's own takes the place of the outputs of the setup:
///
/// ```
/// use std::sync::mpsc::{Sender, channel};
///
/// use ademan_core::device::{EventKind, OutputEvent};
/// use ademan_runtime::output::{OutputError, Sink};
/// use ademan_runtime::session::{Session, SessionOptions};
/// use ademan_runtime::setup::Setup;
///
/// /// Sends the names of the keys that go down.
/// struct KeyNames(Sender<&'static str>);
///
/// impl Sink for KeyNames {
///     fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
///         for event in events {
///             if let EventKind::KeyDown(key) = event.kind {
///                 self.0.send(key.name()).map_err(|error| OutputError::Send {
///                     output: "key names".into(),
///                     reason: error.to_string(),
///                 })?;
///             }
///         }
///         Ok(())
///     }
///
///     /// It holds no keys.
///     fn close(&mut self) -> Result<(), OutputError> {
///         Ok(())
///     }
/// }
///
/// let (sender, names) = channel();
/// let setup = Setup { source: Some("typist:hi".parse()?), ..Setup::default() };
/// let options = SessionOptions { output: Some(Box::new(KeyNames(sender))), ..SessionOptions::default() };
/// Session::start(setup.load_files()?, options)?.join()?;
/// assert_eq!(names.iter().collect::<Vec<_>>(), ["H", "I"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Sink: Send {
    /// Sends the events of one step, in order; the list may be empty. Does not block, except in a lossless log (see
    /// [`drop_when_full`](Self::drop_when_full)).
    ///
    /// The error may concern events of earlier steps.
    ///
    /// A sink tracks what it has pressed, so that no release is lost: a release that failed is repeated later, at the
    /// latest in [`close`](Self::close). A second press of a pressed key and a release of a key that is not pressed
    /// have no effect.
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError>;

    /// Logs the commands of a step, before its events are sent. Logs write them; other outputs ignore them.
    fn log_commands(&mut self, _: &[TimedCommand]) -> Result<(), OutputError> {
        Ok(())
    }

    /// Returns what the sink can send. A [`Router`] sends everything else to its other sinks.
    fn capabilities(&self) -> Capabilities {
        Capabilities::all()
    }

    /// Returns `true` for a log, which a [`Router`] sends every event to (see [`Backend::is_log`]).
    fn is_log(&self) -> bool {
        false
    }

    /// Returns `true` if the events change something outside of this process, such as a pressed key. Then the loop must not wait for
    /// its observers.
    fn has_effect(&self) -> bool {
        true
    }

    /// Makes a log drop lines, and count them, when its reader is too slow. Before this call a log is lossless: it waits for its reader.
    fn drop_when_full(&mut self) {}

    /// Sets the receiver of errors of logs that fail while the other outputs continue; see [`Router`].
    fn on_log_failure(&mut self, _: LogFailureReceiver) {}

    /// Sets the names of the targets in later events, for sinks that write them.
    fn set_target_names(&mut self, _: &TargetNames) {}

    /// Sets the signals that targets in later events send to music and stage programs, for sinks that send them. Ends the notes of
    /// targets in earlier events.
    fn set_signals(&mut self, _: &Signals) {}

    /// Voids the presses and characters that were sent and not yet delivered; called before the releases of a
    /// pause, a stall or a stop. They are [counted](Self::dropped_presses). Ends a [stall](Self::has_stalled) of the sink.
    /// Sinks without a queue and without a watchdog ignore it.
    fn void_presses(&mut self) {}

    /// Returns `true` if a press was dropped, or the watchdog has released keys, since the last call of
    /// [`void_presses`](Self::void_presses). The state of the receiver then differs from the state after the events so far: a
    /// modifier that counts as pressed may be up. The sink drops presses until everything is released and
    /// `void_presses` is called.
    fn has_stalled(&self) -> bool {
        false
    }

    /// Releases everything that is pressed and waits until all events are delivered, at most 1 s; a lossless log waits
    /// for its reader.
    fn close(&mut self) -> Result<(), OutputError>;

    /// Returns the number of presses and characters that were dropped, because the queue was full, they were voided before
    /// they were delivered, the output lacks the key, or it cannot type their text.
    fn dropped_presses(&self) -> u64 {
        0
    }

    /// Returns the number of pointer motions, scrolls and axis positions that were merged into later ones because the
    /// queue was full.
    fn coalesced_motions(&self) -> u64 {
        0
    }

    /// Returns the text field that has the focus, if the sink knows it.
    fn text_field(&self) -> TextField {
        TextField::default()
    }

    /// Shows the candidates of the text decoder of the active layout, after each step; `None` without a decoder.
    fn show_text(&mut self, _: Option<&TextState>) {}

    /// Returns, once, the number of the candidate that was chosen in the list of the sink, from 1.
    fn take_choice(&mut self) -> Option<u8> {
        None
    }
}

/// A failure of an output.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The output cannot be opened.
    #[error("cannot open the output `{}`: {}", escape(.output), escape_line(.reason))]
    Open {
        /// The output as written.
        output: String,
        /// The cause and the remedy.
        reason: String,
    },
    /// The output stopped accepting events.
    #[error("the output `{}` failed: {}", escape(.output), escape_line(.reason))]
    Send {
        /// The output as written.
        output: String,
        /// The cause.
        reason: String,
    },
    /// The reader of the output has closed it (`EPIPE`). A program ends without an error message then.
    #[error("the reader of the output `{}` has closed it", escape(.output))]
    BrokenPipe {
        /// The output as written.
        output: String,
    },
    /// No backend has this name.
    #[error("{0}; available: {available}", available = available())]
    UnknownOutput(#[from] UnknownName),
    /// The backend has no argument.
    #[error("the output `{}` takes no argument; available: {}", escape(.output), available())]
    UnexpectedArgument {
        /// The output as written.
        output: String,
    },
}

impl OutputError {
    /// Creates the failure to open `output`.
    fn open(output: impl Into<String>, reason: impl ToString) -> Self {
        Self::Open {
            output: output.into(),
            reason: reason.to_string(),
        }
    }

    /// Creates the failure to send to `output`.
    fn send(output: impl Into<String>, reason: impl ToString) -> Self {
        Self::Send {
            output: output.into(),
            reason: reason.to_string(),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
