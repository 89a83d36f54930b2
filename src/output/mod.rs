//! 6 · [`OutputEvent`] → the operating system or a peer.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter};
use std::path::Path;
use std::time::Duration;

use crate::contact::TargetNames;
use crate::device::{Capabilities, OutputEvent, TimedCommand};
use crate::names::UnknownName;
use watchdog::WatchdogSettings;

mod axis_state;
pub mod desktop;
mod display;
#[cfg(target_os = "linux")]
pub mod watchdog;
#[cfg(not(target_os = "linux"))]
#[path = "no_guardian.rs"]
pub mod guardian;
pub mod pressed_keys;
mod launch;
mod pending_motion;
pub mod named_keys;
mod reach;
pub mod router;
#[cfg(target_os = "linux")]
pub(crate) mod socket;
#[cfg(not(target_os = "linux"))]
#[path = "no_socket.rs"]
pub(crate) mod socket;
#[cfg(target_os = "linux")]
pub mod spacenav;
pub mod transcript;
#[cfg(target_os = "linux")]
pub mod uinput;
#[cfg(all(feature = "wayland", target_os = "linux"))]
mod wayland;
#[cfg(all(unix, not(target_os = "macos")))]
#[cfg(not(all(feature = "wayland", target_os = "linux")))]
#[path = "no_wayland.rs"]
mod wayland;
mod worker;

pub use desktop::Desktop;
pub use reach::OutputKind;
pub use router::Router;
pub use transcript::Transcript;

/// Whether `desktop` speaks the protocols of Wayland; else it does not open where `WAYLAND_DISPLAY` is set.
pub const SUPPORTS_WAYLAND: bool = cfg!(all(feature = "wayland", target_os = "linux"));

/// How often an output tries again what the operating system did not take.
const RETRIES: usize = 3;

/// How long it waits before it tries again.
const RETRY_DELAY: Duration = Duration::from_millis(10);

/// Where events go.
///
/// A sink that is dropped without [`close`](Self::close) lets go of what is down too.
pub trait Sink: Send {
    /// Takes the events of one frame, in order; there may be none. Does not wait for the receiver.
    ///
    /// The error may be about events of earlier frames.
    ///
    /// A sink keeps account of what it has put down, so that a release is never lost: what it could
    /// not deliver it delivers later, or lets go of in [`close`](Self::close). It ignores a second
    /// down of a key and an up of what is not down.
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError>;

    /// Logs the commands of a step, before its events are sent. Only outputs that keep a log use it.
    fn log_commands(&mut self, _: &[TimedCommand]) -> Result<(), OutputError> {
        Ok(())
    }

    /// What it can carry; the rest is not sent to it where there is another output.
    fn kind(&self) -> OutputKind {
        OutputKind::All
    }

    /// Takes the names of the targets of events to come, for outputs that write them.
    fn set_target_names(&mut self, _: &TargetNames) {}

    /// Lets go of everything that is still down and waits, at most a second, until all is delivered.
    fn close(&mut self) -> Result<(), OutputError>;

    /// Presses and characters that were not passed on: there was no room for them, or the output lacks
    /// the key.
    fn dropped_presses(&self) -> u64 {
        0
    }

    /// Motions of the pointer and turns of the wheel for which there was no room: later ones took their
    /// place.
    fn coalesced_motions(&self) -> u64 {
        0
    }
}

impl Sink for Box<dyn Sink> {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        (**self).send(events)
    }

    fn log_commands(&mut self, commands: &[TimedCommand]) -> Result<(), OutputError> {
        (**self).log_commands(commands)
    }

    fn kind(&self) -> OutputKind {
        (**self).kind()
    }

    fn set_target_names(&mut self, names: &TargetNames) {
        (**self).set_target_names(names);
    }

    fn close(&mut self) -> Result<(), OutputError> {
        (**self).close()
    }

    fn dropped_presses(&self) -> u64 {
        (**self).dropped_presses()
    }

    fn coalesced_motions(&self) -> u64 {
        (**self).coalesced_motions()
    }
}

/// Why events did not arrive. Each text says what was tried, what happened and what to do.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The output cannot be had here.
    #[error("cannot open the output `{output}`: {reason}")]
    Open {
        /// The output as named.
        output: String,
        /// What happened and what to do.
        reason: String,
    },
    /// The output stopped taking events.
    #[error("the output `{output}` failed: {reason}")]
    Send {
        /// The output as named.
        output: String,
        /// What happened.
        reason: String,
    },
    /// Whoever read the output has gone away (a broken pipe): a reason to end quietly.
    #[error("nobody reads the output `{output}` any more")]
    BrokenPipe {
        /// The output as named.
        output: String,
    },
    /// There is no output of this name.
    #[error(
        "{0}; outputs are transcript, transcript:PATH, desktop, uinput, spacenav, spacenav:PATH and none"
    )]
    UnknownOutput(#[from] UnknownName),
}

/// The names that [`open`] knows.
pub const NAMES: [&str; 5] = ["transcript", "desktop", "uinput", "spacenav", "none"];

/// Opens outputs by their names, separated by commas.
///
/// - `transcript`: lines on the standard output; `transcript:PATH`: in a file, which is written anew
///   and, where it is created, is for its owner's eyes only. No comma is in the path.
/// - `desktop`: keys, characters and a pointer on the desktop of the session.
/// - `uinput`: devices of their own that have just what is needed (Linux).
/// - `spacenav`: a 6-DoF mouse for programs that know the spacenav protocol, at a socket in the user's
///   runtime directory; `spacenav:PATH`: at another one (Linux). No comma is in the path.
/// - `none`: nowhere.
///
/// With several, each kind of action goes to the first that can carry it: see [`Router`]. Transcripts
/// hear everything, and count as carrying it only where there are none but transcripts. When something
/// that is needed cannot be carried, nothing is opened.
pub fn open(names: &str, needs: &Capabilities) -> Result<Box<dyn Sink>, OutputError> {
    open_all(names, needs, None)
}

/// As [`open`], with a [guardian] for an output whose keys would outlive this program.
pub fn open_with_watchdog(
    names: &str,
    needs: &Capabilities,
    launch: &WatchdogSettings,
) -> Result<Box<dyn Sink>, OutputError> {
    open_all(names, needs, Some(launch))
}

fn open_all(
    names: &str,
    needs: &Capabilities,
    launch: Option<&WatchdogSettings>,
) -> Result<Box<dyn Sink>, OutputError> {
    check(names, needs)?;
    let (parts, reaches) = parts(names)?;
    let open_share = |(place, name): (usize, &&str)| {
        let needs = reach::routed_to(&reaches, place, needs);
        open_one(name, &needs, launch)
    };
    let mut sinks: Vec<_> = parts
        .iter()
        .enumerate()
        .map(open_share)
        .collect::<Result<_, _>>()?;
    Ok(match sinks.len() {
        1 => sinks.remove(0),
        _ => Box::new(Router::new(sinks)),
    })
}

/// Whether [`open`] would find an output for all that is needed; nothing is opened.
pub fn check(names: &str, needs: &Capabilities) -> Result<(), OutputError> {
    let (parts, reaches) = parts(names)?;
    match reach::unsupported_reason(&parts, &reaches, needs) {
        None => Ok(()),
        Some(reason) => Err(OutputError::Open {
            output: names.into(),
            reason,
        }),
    }
}

/// Whether outputs that were opened for a layout that needs `opened` take one that needs `needs`; if
/// not, why, and what to do. Devices of the kernel have what they were made with and nothing else.
pub fn check_layout_change(
    names: &str,
    opened: &Capabilities,
    needs: &Capabilities,
) -> Result<(), String> {
    let (parts, reaches) = parts(names).map_err(|error| error.to_string())?;
    if let Some(reason) = reach::unsupported_reason(&parts, &reaches, needs) {
        return Err(reason);
    }
    let is_new = |(place, reach): (usize, &OutputKind)| {
        let share = reach::routed_to(&reaches, place, needs);
        let new = share.iter().find(|need| !opened.contains(*need));
        new.filter(|_| *reach == OutputKind::Uinput)
    };
    match reaches.iter().enumerate().find_map(is_new) {
        None => Ok(()),
        Some(need) => Err(format!(
            "the output `uinput` was opened without {need}; start again to use it"
        )),
    }
}

/// Whether one of these outputs writes on the standard output.
pub fn uses_stdout(names: &str) -> bool {
    names.split(',').any(|name| name.trim() == "transcript")
}

/// The single names, and what each can carry.
fn parts(names: &str) -> Result<(Vec<&str>, Vec<OutputKind>), OutputError> {
    let parts: Vec<_> = names.split(',').map(str::trim).collect();
    let reach_of = |name: &&str| match *name {
        "transcript" => Ok(OutputKind::Log),
        name if name.starts_with(TO_FILE) => Ok(OutputKind::Log),
        "desktop" => Ok(OutputKind::Desktop),
        "uinput" => Ok(OutputKind::Uinput),
        "spacenav" => Ok(OutputKind::Spacenav),
        name if name.starts_with(TO_SOCKET) => Ok(OutputKind::Spacenav),
        "none" => Ok(OutputKind::All),
        name => Err(UnknownName::new("output", name, NAMES)),
    };
    let reaches = parts.iter().map(reach_of).collect::<Result<_, _>>()?;
    Ok((parts, reaches))
}

/// How the name of a transcript in a file begins.
const TO_FILE: &str = "transcript:";

/// How the name of a 6-DoF mouse at a socket of its own begins.
const TO_SOCKET: &str = "spacenav:";

fn open_one(
    name: &str,
    needs: &Capabilities,
    launch: Option<&WatchdogSettings>,
) -> Result<Box<dyn Sink>, OutputError> {
    if let Some(path) = name.strip_prefix(TO_FILE) {
        let file = create_transcript(Path::new(path)).map_err(|error| OutputError::Open {
            output: name.into(),
            reason: error.to_string(),
        })?;
        return Ok(Box::new(Transcript::new(name, BufWriter::new(file))));
    }
    if let Some(path) = name.strip_prefix(TO_SOCKET) {
        return open_spacenav(Some(Path::new(path)));
    }
    Ok(match name {
        "transcript" => Box::new(Transcript::new(name, BufWriter::new(io::stdout()))),
        "desktop" => Box::new(match launch {
            Some(launch) => Desktop::open_with_watchdog(launch, needs)?,
            None => Desktop::open(None, needs)?,
        }),
        "uinput" => open_uinput(needs, launch)?,
        "spacenav" => open_spacenav(None)?,
        "none" => Box::new(NullSink),
        _ => return Err(UnknownName::new("output", name, NAMES).into()),
    })
}

/// Takes everything and does nothing with it.
struct NullSink;

impl Sink for NullSink {
    fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
        Ok(())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}

fn create_transcript(path: &Path) -> io::Result<File> {
    owner_only(OpenOptions::new().write(true).create(true).truncate(true)).open(path)
}

/// Makes a file that these options create readable for its owner only: what people type is in it.
#[cfg(unix)]
pub fn owner_only(options: &mut OpenOptions) -> &mut OpenOptions {
    std::os::unix::fs::OpenOptionsExt::mode(options, 0o600)
}

/// Makes a file that these options create readable for its owner only, where the system has a simple
/// way to say so; elsewhere the folder decides.
#[cfg(not(unix))]
pub fn private(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

#[cfg(target_os = "linux")]
fn open_uinput(
    needs: &Capabilities,
    launch: Option<&WatchdogSettings>,
) -> Result<Box<dyn Sink>, OutputError> {
    Ok(Box::new(match launch {
        Some(launch) => uinput::Uinput::open_with_watchdog("Ademan", needs, launch)?,
        None => uinput::Uinput::open("Ademan", needs)?,
    }))
}

#[cfg(not(target_os = "linux"))]
fn open_uinput(
    _: &Capabilities,
    _: Option<&WatchdogSettings>,
) -> Result<Box<dyn Sink>, OutputError> {
    Err(OutputError::Open {
        output: "uinput".into(),
        reason: "it is a part of Linux; use the output `desktop`".into(),
    })
}

#[cfg(target_os = "linux")]
fn open_spacenav(path: Option<&Path>) -> Result<Box<dyn Sink>, OutputError> {
    Ok(Box::new(spacenav::Spacenav::open(path)?))
}

#[cfg(not(target_os = "linux"))]
fn open_spacenav(_: Option<&Path>) -> Result<Box<dyn Sink>, OutputError> {
    Err(OutputError::Open {
        output: "spacenav".into(),
        reason: "it needs Linux; leave it out".into(),
    })
}

/// What a desktop is, by operating system.
#[cfg(all(unix, not(target_os = "macos")))]
mod platform {
    use super::display::EnigoDisplay;
    use super::wayland;
    use super::worker::Injector;
    use crate::advice;
    use crate::device::KeyCode;
    use enigo::{Direction, Enigo, InputResult, Keyboard};
    use std::env;

    /// Beside a compositor there may be an X server for old programs. It is not asked when the compositor
    /// refuses: its keys would not reach the program that the user looks at.
    pub fn open(display: Option<&str>, needs_pointer: bool) -> Result<Box<dyn Injector>, String> {
        let compositor = match display {
            Some(display) if display.contains(':') => None,
            Some(display) => Some(display.into()),
            None => env::var_os("WAYLAND_DISPLAY").filter(|name| !name.is_empty()),
        };
        match compositor {
            Some(name) => wayland::connect(&name, needs_pointer),
            None => Ok(Box::new(EnigoDisplay::connect(display)?)),
        }
    }

    /// Presses the key in this place, whatever the keymap writes for it.
    pub fn inject(enigo: &mut Enigo, key: KeyCode, direction: Direction) -> InputResult<()> {
        enigo.raw(key.x11_code(), direction)
    }

    pub fn has(_: KeyCode) -> bool {
        true
    }

    pub fn no_display(display: Option<&str>) -> String {
        let named = display
            .map(str::to_owned)
            .or_else(|| env::var("DISPLAY").ok());
        advice::no_display(named.as_deref()).to_string()
    }
}

/// What a desktop is, by operating system.
#[cfg(not(all(unix, not(target_os = "macos"))))]
mod platform {
    use super::display::EnigoDisplay;
    use super::named_keys;
    use super::worker::Injector;
    use crate::device::KeyCode;
    use enigo::{Direction, Enigo, InputResult};

    #[cfg(not(target_os = "windows"))]
    use named_keys::OF_MACOS as OF_SYSTEM;
    #[cfg(target_os = "windows")]
    use named_keys::OF_WINDOWS as OF_SYSTEM;

    pub fn open(display: Option<&str>, _: bool) -> Result<Box<dyn Injector>, String> {
        Ok(Box::new(EnigoDisplay::connect(display)?))
    }

    pub fn inject(enigo: &mut Enigo, key: KeyCode, direction: Direction) -> InputResult<()> {
        named_keys::by_name(enigo, key, direction, OF_SYSTEM)
    }

    pub fn has(key: KeyCode) -> bool {
        named_keys::has(key, OF_SYSTEM)
    }

    pub fn no_display(_: Option<&str>) -> String {
        "there is no desktop to press keys on; start this from a graphical session".into()
    }
}

#[cfg(test)]
mod tests;
