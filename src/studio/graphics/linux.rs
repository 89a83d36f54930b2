//! Graphics cards as the kernel lists them.

use std::env;
use std::fs;

/// Devices of graphics cards.
const FOLDER: &str = "/dev/dri";

/// Returns whether a graphics card draws, and not Mesa's software.
pub fn has_card() -> bool {
    let is_software = env::var_os("LIBGL_ALWAYS_SOFTWARE").is_some_and(|value| value != "0");
    let mut devices = fs::read_dir(FOLDER).into_iter().flatten().flatten();
    !is_software && devices.any(|it| it.file_name().to_string_lossy().starts_with("renderD"))
}
