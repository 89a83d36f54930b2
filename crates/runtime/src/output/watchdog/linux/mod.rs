//! The client side on Linux: a Unix socket pair, over which the handle to release keys with is passed.

mod link;
mod receive;
mod release_target;

pub use link::Link;
pub use release_target::{DeviceHandle, ReleaseTarget};

/// Returns the name of the systemd scope of the watchdog with this process id.
pub fn scope_name(process: u32) -> String {
    format!("ademan-watchdog-{process}.scope")
}
