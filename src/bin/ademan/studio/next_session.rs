//! The session after a change of the setup: its files, the checks of its devices, and its start.

use ademan::capture::{self, SourceUri};
use ademan::command::{Command, CommandOrigin};
use ademan::document::Document;
use ademan::message::escape;
use ademan::output;
use ademan::session::panic_keys::{self, PanicKeysWatch};
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::{LoadedSetup, Setup, continued_outputs};
use ademan::studio::StudioError;
use ademan::studio::headset::HeadsetLink;
use ademan::studio::simulated::HandControl;

use super::window::{NO_OUTPUT, launch, live_options};
use super::{headset_link, source};
use crate::failure::Failure;
use crate::pause_signals;

/// The reason why a change does not apply that was cancelled.
pub(super) const CANCELLED: &str =
    "the change was cancelled before its source and outputs were open";

/// A session whose source and outputs may not be open.
pub(super) struct Pending {
    pub session: SessionHandle,
    pub next: Shown,
    /// The setup before, to which a failure leads back, and whether its session starts paused.
    pub back: Option<(Setup, bool)>,
    /// Reason why the session is on the setup before.
    pub refusal: Option<String>,
    /// The person has cancelled the change, and the session has not ended.
    pub is_cancelled: bool,
}

/// The parts of a setup that a window shows besides its session.
pub(super) struct Shown {
    /// The setup before its files were loaded.
    pub base: Setup,
    pub hand: Option<HandControl>,
    pub arm: Option<Document>,
    pub headset: Option<HeadsetLink>,
}

impl Pending {
    /// Starts a session, which opens its source and outputs on a thread of its own. `is_paused` is asked when signals reach it: an earlier
    /// one has paused the session before.
    pub fn launch(next: Next, is_paused: impl FnOnce() -> bool) -> Result<Self, Failure> {
        let shown = Shown {
            base: next.base,
            hand: next.hand,
            arm: next.loaded.arm_document().cloned(),
            headset: headset_link(&next.loaded)?,
        };
        let session = launch(next.loaded, next.options)?;
        if is_paused() {
            // Queued before the first reading, which arms the output of a setup with `arm_immediately`. A session that has ended
            // receives nothing.
            let _ = session.commands().send(Command::Pause);
        }
        Ok(Self {
            session,
            next: shown,
            back: None,
            refusal: None,
            is_cancelled: false,
        })
    }

    /// Waits for the end of a session that the window does not show, and returns the reason.
    pub fn reason_of_end(self) -> Failure {
        match self.session.join() {
            _ if self.is_cancelled => Failure::job(CANCELLED),
            Ok(_) => Failure::job(StudioError::Ended.to_string()),
            Err(error) => error.into(),
        }
    }
}

/// Watches the panic keys of a setup for the session that signals pause, also after its end: a session watches them only while it runs.
/// `None` if the session of the setup does not watch any, or they cannot be watched.
pub(super) fn watch_panic_keys(setup: &Setup) -> Option<PanicKeysWatch> {
    if setup.output == NO_OUTPUT {
        return None;
    }
    // A session that cannot watch them does not start.
    let keys = panic_keys::parse_keys(&setup.panic_keys).ok()?;
    panic_keys::watch(&keys, || pause_signals::pause(CommandOrigin::PanicKeys)).ok()
}

/// A setup whose files are loaded, for the next session.
pub(super) struct Next {
    /// The setup before its files were loaded.
    pub base: Setup,
    loaded: LoadedSetup,
    options: SessionOptions,
    hand: Option<HandControl>,
}

impl Next {
    /// Loads the files of a setup. `written` are the outputs of the session before, whose transcripts exist.
    pub fn load(base: Setup, written: &str) -> Result<Self, Failure> {
        let mut options = live_options();
        let setup = Setup {
            output: continued_outputs(&base.output, written),
            ..base.clone()
        };
        let (loaded, hand) = source::load(setup, &mut options)?;
        Ok(Self {
            base,
            loaded,
            options,
            hand,
        })
    }

    /// Checks the outputs, and the sources that the session `before` does not read: it would be in the way of a check of its own.
    pub fn check_devices(&self, before: &Setup) -> Result<(), Failure> {
        output::check(
            &self.loaded.setup.output,
            &self.loaded.required_capabilities(),
        )?;
        let is_used = |uri: &&SourceUri| before.source_uris().any(|used| is_same_device(used, uri));
        let new = self.base.source_uris().filter(|uri| !is_used(uri));
        for uri in new {
            check_source(uri)?;
        }
        Ok(())
    }
}

/// Returns `true` if two sources read from one device or address.
fn is_same_device(one: &SourceUri, other: &SourceUri) -> bool {
    match (one, other) {
        (SourceUri::Stream(one), SourceUri::Stream(other)) => one.address == other.address,
        _ => one == other,
    }
}

/// Checks that a source can be opened. One that cannot be checked without an effect counts as present; a serial port is opened.
fn check_source(uri: &SourceUri) -> Result<(), Failure> {
    if uri.serial_port().is_some() {
        return Ok(capture::open(uri).map(drop)?);
    }
    match uri.probe() {
        Some(Err(reason)) => Err(Failure::wrong_use(format!(
            "cannot open `{}`: {reason}",
            escape(&uri.to_string())
        ))),
        Some(Ok(())) | None => Ok(()),
    }
}
