//! The sound server of the desktop.

#[cfg(all(feature = "sound", target_os = "linux"))]
mod linux;
#[cfg(all(feature = "sound", target_os = "linux"))]
pub use self::linux::SoundServer;

#[cfg(not(all(feature = "sound", target_os = "linux")))]
mod unsupported;
#[cfg(not(all(feature = "sound", target_os = "linux")))]
pub use self::unsupported::SoundServer;
