//! Windows: a loader beside the program, and the performance counter.

use openxr::ExtensionSet;

/// The remedy for a missing loader.
pub const LOADER: &str = "put openxr_loader.dll into the folder of this program";

/// The extension that converts times of the runtime.
pub const CLOCK: &str = "XR_KHR_win32_convert_performance_counter_time";

/// Returns `true` if times can be converted.
pub fn has_clock(extensions: &ExtensionSet) -> bool {
    extensions.khr_win32_convert_performance_counter_time
}

/// Adds the extension.
pub fn use_clock(extensions: &mut ExtensionSet) {
    extensions.khr_win32_convert_performance_counter_time = true;
}
