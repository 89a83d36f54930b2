//! What stands in for the look at a machine where nobody has written one: only what the environment says.

use std::path::Path;

use super::super::facts::{Compositor, Display, Facts, Node, Runtime, Uinput, User};
use super::Wants;
use crate::output::SUPPORTS_WAYLAND;

/// Nothing is asked of it here.
pub(in crate::doctor) struct Environment;

impl Environment {
    /// Nothing.
    pub fn of_process() -> Self {
        Self
    }
}

/// What can be said of any machine.
pub(in crate::doctor) fn look(_: &Path, _: &Environment, wants: &Wants) -> Facts {
    let unseen = || Node::Odd("this system is not looked at yet; start the run and see".into());
    Facts {
        user: User {
            name: "whoever that is".into(),
            ..User::default()
        },
        ports: wants
            .ports
            .iter()
            .map(|port| (port.clone(), unseen()))
            .collect(),
        uinput: Uinput {
            node: Node::Odd("it is a part of Linux; use the output `desktop`".into()),
            is_loaded: false,
            can_be_loaded: None,
        },
        display: Display::Unseen("the desktop of this system is seen only by using it".into()),
        compositor: Compositor::Unset,
        has_wayland: SUPPORTS_WAYLAND,
        runtime: Runtime::Absent,
    }
}

/// Nobody knows.
pub(in crate::doctor) fn is_root() -> bool {
    false
}
