//! The output `uinput`: virtual devices of the Linux kernel, a keyboard, a mouse, an absolute pointer and a gamepad.

use super::Backend;
use ademan_core::device::{Axis, Capabilities, KeyCode};

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub use linux::{DeviceNode, Uinput, UinputNode, is_missing};
#[cfg(target_os = "linux")]
pub(super) use linux::{center_axes, release_key};
#[cfg(target_os = "linux")]
use linux::{check, open};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
use unsupported::{check, open};

/// The backend `uinput`.
pub const BACKEND: Backend = Backend {
    name: "uinput",
    argument: None,
    is_argument_required: false,
    summary: "virtual devices with exactly the keys and axes that the layout requires (Linux)",
    capabilities,
    is_log: false,
    is_fixed_when_open: true,
    check: Some(check),
    open,
};

/// Returns all keys and buttons, the axes of gamepads, and the pointer; neither characters, as the receiver's keymap
/// determines those, nor 6-DoF axes.
fn capabilities() -> Capabilities {
    let axes = Axis::ALL.iter().copied();
    Capabilities {
        keys: KeyCode::all().collect(),
        text: false,
        relative_motion: true,
        absolute_motion: true,
        scroll: true,
        axes: axes.filter(|axis| axis.is_gamepad()).collect(),
    }
}
