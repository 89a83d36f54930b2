//! Reasons why a runtime cannot be used, each with its remedy.

use std::error::Error;

use openxr::{EntryError, ExtensionSet};

use super::system::{CLOCK, LOADER, has_clock, use_clock};
use crate::capture::connection::ConnectError;

const NO_RUNTIME: &str =
    "start Monado (`monado-service`) or WiVRn, or name the file of your runtime in XR_RUNTIME_JSON";

/// Returns the error if the loader cannot be loaded.
pub fn no_loader(error: &EntryError) -> ConnectError {
    // Only the first cause names the file.
    let mut cause: &dyn Error = error;
    while let Some(source) = cause.source() {
        cause = source;
    }
    ConnectError::Unusable(format!(
        "the OpenXR loader cannot be loaded: {cause}; {LOADER}"
    ))
}

/// Returns the error if no runtime is installed or it does not answer.
pub fn no_runtime(error: openxr::sys::Result) -> ConnectError {
    use openxr::sys::Result as Code;
    match error {
        // The loader has room for one instance, and another source or a lost one still has it.
        Code::ERROR_LIMIT_REACHED => ConnectError::Absent(
            "the OpenXR loader has another session of this program; it is opened when that one has ended".to_owned(),
        ),
        Code::ERROR_RUNTIME_UNAVAILABLE | Code::ERROR_FILE_ACCESS_ERROR => ConnectError::Absent(
            format!("no OpenXR runtime is active ({error:?}); {NO_RUNTIME}"),
        ),
        _ => ConnectError::Absent(format!(
            "the OpenXR runtime does not answer ({error:?}); {NO_RUNTIME}"
        )),
    }
}

/// Checks the extensions; an error names those that are missing.
pub fn check_extensions(available: &ExtensionSet) -> Result<(), ConnectError> {
    let needed = [
        ("XR_EXT_hand_tracking", available.ext_hand_tracking),
        ("XR_MND_headless", available.mnd_headless),
        (CLOCK, has_clock(available)),
    ];
    let missing = needed.iter().filter(|(_, is_available)| !is_available);
    let missing: Vec<&str> = missing.map(|(name, _)| *name).collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(ConnectError::Unusable(format!(
        "the active OpenXR runtime lacks {}; turn hand tracking on in its settings, or use Monado or WiVRn, which have them",
        missing.join(", ")
    )))
}

/// Returns the needed extensions and those that are used if they are there.
pub fn used_extensions(available: &ExtensionSet) -> ExtensionSet {
    let mut used = ExtensionSet::default();
    used.ext_hand_tracking = true;
    used.mnd_headless = true;
    use_clock(&mut used);
    used.fb_display_refresh_rate = available.fb_display_refresh_rate;
    used
}

/// Returns the error if the runtime has no headset.
pub fn no_headset(runtime: &str, error: openxr::sys::Result) -> ConnectError {
    ConnectError::Absent(format!(
        "{runtime} has no headset ({error:?}); connect and switch on the headset"
    ))
}

/// Returns the error if the headset tracks no hands.
pub fn no_hands(runtime: &str, headset: &str) -> ConnectError {
    ConnectError::Unusable(format!(
        "{runtime} tracks no hands with `{headset}`; turn on hand tracking in the settings of the headset"
    ))
}

/// Returns the error if the runtime refuses a session.
pub fn no_session(runtime: &str, error: openxr::sys::Result) -> ConnectError {
    ConnectError::Absent(format!(
        "{runtime} starts no session without graphics ({error:?}); start the runtime again"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_missing_extension_is_named() {
        let mut available = ExtensionSet::default();
        available.ext_hand_tracking = true;
        let error = check_extensions(&available).unwrap_err().into_reason();
        let expected = format!("lacks XR_MND_headless, {CLOCK}; ");
        assert!(error.contains(&expected), "{error}");
        assert_eq!(check_extensions(&used_extensions(&available)), Ok(()));
    }
}
