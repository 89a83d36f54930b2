//! A file with the keys that a process has pressed on a display, for the case that the process and its watchdog are
//! killed in the same instant.
//!
//! The file is in the runtime folder of the user, which is usually in memory, accessible by its owner only. It has one byte per
//! key, which is 1 from before the press until after the release, then the name of the display and a NUL, and then the
//! keysym of each key that the process has added to the keymap, by key code. The process keeps it locked and removes it at
//! its end, and the watchdog does after it has released the keys: an unlocked file is abandoned, and its keys may be released by anyone
//! who finds it.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
pub(super) use linux::{AbandonedKeys, PressedKeyFile};

#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
pub(super) use unsupported::PressedKeyFile;
