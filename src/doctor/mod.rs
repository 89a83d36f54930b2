//! What a setup needs of the machine, what of that is there, and the lines for a shell that mend the rest.
//!
//! The machine is looked at once ([`look`]), without changing anything: nothing is opened that would notice,
//! such as a serial port, whose adapter may start anew. What was found are plain [`Facts`], and [`examine`] makes
//! [`Finding`]s of them. Reasons and remedies are those of [`access`](crate::access), which the outputs and
//! sources use too. [`Backend::check`] uses an output without a visible effect.

mod checks;
mod facts;
mod probe;

pub use checks::check;
pub use facts::{
    Compositor, DeviceNode, Facts, RunningInstance, RuntimeDir, UinputFacts, User, XDisplay,
};

use std::path::Path;

use serde::Serialize;

use crate::capture::SourceUri;
use crate::output::{self, Backend};
use crate::setup::Setup;

/// What a setup needs of the machine.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Requirements {
    /// Serial ports that are to be read.
    pub ports: Vec<String>,
    /// Keys and pointer of a desktop.
    pub desktop: bool,
    /// Devices of the kernel.
    pub uinput: bool,
}

impl Requirements {
    /// What a setup names.
    pub fn from_setup(setup: &Setup) -> Self {
        let other = setup.other_hand.as_ref();
        let sources = [
            setup.source.as_ref(),
            other.and_then(|hand| hand.source.as_ref()),
        ];
        let port = |source: &SourceUri| source.serial_port().map(str::to_owned);
        let uses = |backend: &Backend| output::uses_backend(&setup.output, backend.name);
        Self {
            ports: sources.into_iter().flatten().filter_map(port).collect(),
            desktop: uses(&output::desktop::BACKEND),
            uinput: uses(&output::uinput::BACKEND),
        }
    }
}

/// How something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckStatus {
    /// It is there and can be used.
    Ok,
    /// It is not there, or this user may not use it.
    Missing,
    /// Nothing says so without trying it.
    Unknown,
}

impl CheckStatus {
    /// In words: `ok`, `missing`, `cannot tell`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Missing => "missing",
            Self::Unknown => "cannot tell",
        }
    }
}

/// What came of one check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What was looked at: `user`, `serial port`, `uinput`, `display`, `compositor`, `sockets`.
    pub check: &'static str,
    /// How it is.
    pub state: CheckStatus,
    /// Whether the setup needs it.
    pub needed: bool,
    /// What was found.
    pub text: String,
    /// Lines for a shell that mend it, one after the other; there may be none.
    pub fix: Vec<String>,
    /// What is to be done after that, or instead; may be empty.
    pub then: String,
}

impl Finding {
    /// Whether the setup can do with it as it is.
    pub fn is_satisfied(&self) -> bool {
        !self.needed || self.state == CheckStatus::Ok
    }
}

/// Looks at the machine, as far as a setup with these wants has to do with it.
pub fn gather_facts(wants: &Requirements) -> Facts {
    probe::gather_facts(Path::new("/"), &probe::Environment::from_process(), wants)
}

/// Whether the user of this process may do everything, so that whatever comes in on a glove's line could.
/// Elsewhere than on Linux nobody knows: `false`.
pub fn is_running_as_root() -> bool {
    probe::is_root()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setup_wants_the_ports_and_outputs_that_it_names() {
        let mut setup = Setup {
            source: Some("serial:/dev/ttyUSB0?baud=9600".parse().unwrap()),
            output: "transcript, uinput".into(),
            ..Setup::default()
        };
        let mut wants = Requirements {
            ports: vec!["/dev/ttyUSB0".into()],
            desktop: false,
            uinput: true,
        };
        assert_eq!(Requirements::from_setup(&setup), wants);
        setup.other_hand = Some(crate::setup::OtherHand {
            source: Some("serial:/dev/ttyUSB1".parse().unwrap()),
            ..Default::default()
        });
        setup.output = "desktop".into();
        wants.ports.push("/dev/ttyUSB1".into());
        (wants.desktop, wants.uinput) = (true, false);
        assert_eq!(Requirements::from_setup(&setup), wants);
        assert_eq!(
            Requirements::from_setup(&Setup::default()),
            Requirements::default()
        );
    }
}
