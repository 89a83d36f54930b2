//! The output `ime`: text through the input method of the desktop, everything else through another output.
//!
//! Characters reach the focused text field as text, whatever its keymap is. While a text decoder changes words, the word that is typed
//! stays open: the field shows it underlined, and takes it with the character that ends it. Shortcuts, modifiers, keys without a
//! character and the pointer go through the output `desktop`, or through the output in the argument: `ime:uinput`. So do all keys while no text
//! field has the focus, and in fields for passwords, numbers, addresses and terminals.
//!
//! The input method belongs to a Wayland compositor, or is IBus.

use super::{BACKENDS, Backend, desktop, uinput};
use ademan_core::device::Capabilities;

#[cfg(all(target_os = "linux", feature = "ime"))]
mod client;
#[cfg(all(target_os = "linux", feature = "ime"))]
mod composition;
#[cfg(all(target_os = "linux", feature = "ime"))]
mod ibus;
#[cfg(all(target_os = "linux", feature = "ime"))]
mod outputs;
#[cfg(all(target_os = "linux", feature = "ime"))]
mod sink;
#[cfg(all(target_os = "linux", feature = "ime"))]
use sink::open;

#[cfg(not(all(target_os = "linux", feature = "ime")))]
mod unsupported;
#[cfg(not(all(target_os = "linux", feature = "ime")))]
use unsupported::{check_build, open};

/// Checks that this build has an input method. An error states the reason and the remedy.
#[cfg(all(target_os = "linux", feature = "ime"))]
fn check_build() -> Result<(), String> {
    Ok(())
}

/// The backend `ime`.
pub const BACKEND: Backend = Backend {
    name: "ime",
    argument: Some("OUTPUT"),
    is_argument_required: false,
    summary: "text through the input method of the desktop (IBus or a Wayland compositor; feature `ime`), keys through `desktop` or ime:uinput",
    capabilities,
    is_log: false,
    is_fixed_when_open: false,
    check: None,
    open,
};

/// Returns the capabilities of all outputs for keys together.
fn capabilities() -> Capabilities {
    let mut capabilities = (desktop::BACKEND.capabilities)();
    for capability in (uinput::BACKEND.capabilities)().iter() {
        capabilities.insert(capability);
    }
    capabilities
}

/// Checks that this build has an input method, and that the argument names an output for keys. An error states the reason and the
/// remedy.
pub(super) fn check_presence(argument: Option<&str>) -> Result<(), String> {
    check_build()?;
    key_output(argument).map(drop)
}

/// Returns the output for keys: the argument, or else `desktop`.
pub(super) fn key_output(argument: Option<&str>) -> Result<&'static Backend, String> {
    let name = argument.unwrap_or(desktop::BACKEND.name);
    let is_allowed = [desktop::BACKEND.name, uinput::BACKEND.name].contains(&name);
    let found = BACKENDS.iter().find(|backend| backend.name == name);
    found.copied().filter(|_| is_allowed).ok_or_else(|| {
        "its keys go through `desktop` or `uinput`: write `ime` or `ime:uinput`".into()
    })
}
