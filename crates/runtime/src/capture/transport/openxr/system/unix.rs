//! Linux and other systems with `clock_gettime`.

use openxr::ExtensionSet;

/// The remedy for a missing loader.
pub const LOADER: &str = "install the OpenXR loader, on Debian `apt install libopenxr-loader1`";

/// The extension that converts times of the runtime.
pub const CLOCK: &str = "XR_KHR_convert_timespec_time";

/// Returns `true` if times can be converted.
pub fn has_clock(extensions: &ExtensionSet) -> bool {
    extensions.khr_convert_timespec_time
}

/// Adds the extension.
pub fn use_clock(extensions: &mut ExtensionSet) {
    extensions.khr_convert_timespec_time = true;
}
