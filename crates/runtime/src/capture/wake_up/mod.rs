//! Wake-up of a thread that waits for bytes.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
pub use linux::WakeUp;
#[cfg(not(target_os = "linux"))]
pub use unsupported::WakeUp;
