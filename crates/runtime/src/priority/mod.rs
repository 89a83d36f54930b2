//! The priority of the threads that press and release keys, and of the thread that draws a window.
//!
//! On a busy machine a thread of normal priority waits for others, and a key stays pressed for as long. The threads that
//! press and release keys sleep nearly all the time, so that a higher priority delays no other program. A process may have
//! one if it has the capability `CAP_SYS_NICE` or its limit `RLIMIT_NICE` permits it (`man 2 getrlimit`).
//!
//! A thread of the kernel passes on the bytes of a serial line. It has normal priority and waits for the time slice of the
//! thread that runs, which a window without a graphics card fills with drawing.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub use linux::{granted_nice, raise_thread_priority, shorten_time_slice};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub use unsupported::{granted_nice, raise_thread_priority, shorten_time_slice};
