//! The output `spacenav`: a 6-DoF mouse for CAD and 3D programs, which connect to it through the spacenav protocol.

use super::Backend;
use ademan_core::device::{Axis, Capabilities};

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub(super) use linux::check_presence;
#[cfg(target_os = "linux")]
use linux::open;

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub(super) use unsupported::check_presence;
#[cfg(not(target_os = "linux"))]
use unsupported::open;

/// The backend `spacenav`.
pub const BACKEND: Backend = Backend {
    name: "spacenav",
    argument: Some("PATH"),
    is_argument_required: false,
    summary: "a 6-DoF mouse for 3D programs, at a socket in the runtime folder or at spacenav:PATH (Linux)",
    capabilities,
    is_log: false,
    is_fixed_when_open: false,
    check: None,
    open,
};

/// The keys that are the buttons of the 6-DoF mouse, in the order of their numbers, from 0.
const BUTTONS: [&str; 4] = ["PadSouth", "PadEast", "PadNorth", "PadWest"];

/// Returns the six axes and the four buttons.
fn capabilities() -> Capabilities {
    let axes = Axis::ALL.iter().copied();
    Capabilities {
        keys: BUTTONS.iter().flat_map(|name| name.parse()).collect(),
        axes: axes.filter(|axis| !axis.is_gamepad()).collect(),
        ..Capabilities::default()
    }
}
