//! Events as their receivers get them: an X server, a Wayland compositor, a client of spacenavd, a kernel in QEMU.

#[path = "../support/mod.rs"]
mod support;

#[cfg(target_os = "linux")]
mod chaos;
#[cfg(all(target_os = "linux", feature = "ime"))]
mod ime;
#[cfg(target_os = "linux")]
mod music;
#[cfg(all(
    target_os = "linux",
    any(feature = "ime", feature = "studio", feature = "tray")
))]
mod session_bus;
#[cfg(target_os = "linux")]
mod spacenav;
#[cfg(all(target_os = "linux", any(feature = "sound", feature = "studio")))]
mod sound;
#[cfg(all(target_os = "linux", feature = "tray"))]
mod tray;
#[cfg(target_os = "linux")]
mod prepared_run;
#[cfg(target_os = "linux")]
mod views;
#[cfg(target_os = "linux")]
mod vm;
#[cfg(feature = "studio")]
mod studio;
#[cfg(feature = "wayland")]
mod wayland;
#[cfg(unix)]
mod x11;
