//! Graphics cards as the kernel lists them.

use std::fs;

/// Devices of graphics cards.
const FOLDER: &str = "/dev/dri";

/// Returns `true` if there is a graphics card. Without one Mesa draws in software.
pub fn has_card() -> bool {
    let mut devices = fs::read_dir(FOLDER).into_iter().flatten().flatten();
    devices.any(|device| device.file_name().to_string_lossy().starts_with("renderD"))
}
