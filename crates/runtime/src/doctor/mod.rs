//! Checks of the machine: the permissions and services that a setup needs, and commands that provide missing ones.
//!
//! [`gather_facts`] inspects the machine once and changes nothing. In particular it opens no serial port, since that can
//! reset the adapter. [`check`] turns the [`Facts`] into [`Finding`]s, with the advice of [`advice`](crate::advice), which
//! the errors of outputs and sources contain too. [`Backend::check`](output::Backend::check) uses an output without a visible effect.

mod checks;
mod facts;
mod focus;
mod headset;
mod panic_keys;
mod probe;
mod share;
mod source;
mod time_limit;

pub use checks::check;
pub use facts::{
    Compositor, DeviceNode, Facts, RunningInstance, RuntimeDir, UinputFacts, User, WatchdogScope,
    XDisplay,
};
pub use focus::check_focus;
pub use headset::check_headset;
pub use panic_keys::check_panic_keys;
pub use share::check_share;
pub use source::check_source;

use std::path::Path;

use serde::Serialize;

use crate::capture::SourceUri;
use crate::output;
use crate::setup::Setup;
use ademan_core::message::escape_line;
use ademan_core::names::named_enum;

/// The permissions and services that a setup needs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Requirements {
    /// Serial ports to be read.
    pub ports: Vec<String>,
    /// `true` if the setup uses the output `desktop`, also for the keys of `ime`.
    pub desktop: bool,
    /// `true` if the setup uses the output `uinput`, also for the keys of `ime:uinput`.
    pub uinput: bool,
}

impl Requirements {
    /// Returns the requirements of a setup.
    pub fn from_setup(setup: &Setup) -> Self {
        let port = |source: &SourceUri| source.serial_port().map(str::to_owned);
        let uses = |name: &str| output::uses_backend(&setup.output, name);
        // The output `ime` sends keys through one of them.
        let [desktop, ime, uinput] = [
            output::desktop::BACKEND,
            output::ime::BACKEND,
            output::uinput::BACKEND,
        ]
        .map(|backend| backend.name);
        Self {
            ports: setup.source_uris().filter_map(port).collect(),
            desktop: uses(desktop) || uses(ime) || uses(&format!("{ime}:{desktop}")),
            uinput: uses(uinput) || uses(&format!("{ime}:{uinput}")),
        }
    }
}

named_enum! {
    /// The status of a permission or service.
    pub enum CheckStatus ("status") {
        /// The permission or service exists, and the user may use it.
        Ok = "ok",
        /// The permission or service does not exist, or the user may not use it.
        Missing = "missing",
        /// Unknown: only a use would show it.
        Unknown = "unknown",
    }
}

/// The result of one check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Subject of the check: `user`, `serial port`, `source`, `headset`, `uinput`, `display`, `compositor`, `priority`, `watchdog`,
    /// `sockets`, `panic keys`, `focus`, `share`, `outputs`.
    pub check: &'static str,
    /// Status of the subject.
    pub status: CheckStatus,
    /// `true` if the setup needs the subject.
    pub needed: bool,
    /// Explanation.
    pub text: String,
    /// Shell commands that provide the subject, in order; may be empty.
    pub commands: Vec<String>,
    /// Step after the commands, or instead of them; may be empty.
    pub next_step: String,
}

impl Finding {
    /// Returns the finding of something that was tried, with the text of the success or the reason of the failure.
    pub fn from_result(check: &'static str, needed: bool, tried: Result<String, String>) -> Self {
        let (status, text) = match tried {
            Ok(text) => (CheckStatus::Ok, text),
            Err(reason) => (CheckStatus::Missing, reason),
        };
        Self {
            check,
            status,
            needed,
            text: escape_line(&text).into_owned(),
            commands: Vec::new(),
            next_step: String::new(),
        }
    }

    /// Moves the remedy, which follows the last semicolon of the text, to the next step.
    fn with_remedy_as_next_step(mut self) -> Self {
        if let Some((reason, remedy)) = self.text.rsplit_once("; ") {
            (self.text, self.next_step) = (reason.to_owned(), remedy.to_owned());
        }
        self
    }

    /// Returns `true` if the setup works with this status.
    pub fn is_satisfied(&self) -> bool {
        !self.needed || self.status == CheckStatus::Ok
    }
}

/// Inspects the parts of the machine that matter for these requirements.
pub fn gather_facts(requirements: &Requirements) -> Facts {
    let environment = probe::Environment::from_process();
    probe::gather_facts(Path::new("/"), &environment, requirements)
}

/// Returns `true` if this process runs as root; `false` on systems other than Linux.
pub fn is_running_as_root() -> bool {
    probe::is_running_as_root()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_requirements_are_the_ports_and_outputs_of_the_setup() {
        let mut setup = Setup {
            source: Some("serial:/dev/ttyUSB0?baud=9600".parse().unwrap()),
            output: "transcript, uinput".into(),
            ..Setup::default()
        };
        let mut requirements = Requirements {
            ports: vec!["/dev/ttyUSB0".into()],
            desktop: false,
            uinput: true,
        };
        assert_eq!(Requirements::from_setup(&setup), requirements);
        setup.other_hand = Some(crate::setup::OtherHand {
            source: Some("serial:/dev/ttyUSB1".parse().unwrap()),
            ..Default::default()
        });
        setup.output = "desktop".into();
        requirements.ports.push("/dev/ttyUSB1".into());
        (requirements.desktop, requirements.uinput) = (true, false);
        assert_eq!(Requirements::from_setup(&setup), requirements);
        setup.output = "ime".into();
        assert_eq!(Requirements::from_setup(&setup), requirements);
        setup.output = "ime:uinput".into();
        (requirements.desktop, requirements.uinput) = (false, true);
        assert_eq!(Requirements::from_setup(&setup), requirements);
        let empty = Requirements::from_setup(&Setup::default());
        assert_eq!(empty, Requirements::default());
    }
}
