//! The scheduling priority of the threads that press and release keys.
//!
//! On a busy machine a thread of normal priority waits for others, and a key stays pressed for as long. These threads
//! sleep nearly all the time, so that a higher priority delays no other program. A process may have one if it has the
//! capability `CAP_SYS_NICE` or its limit `RLIMIT_NICE` permits it (`man 2 getrlimit`).

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub use linux::{granted_nice, raise_thread_priority};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub use unsupported::{granted_nice, raise_thread_priority};
