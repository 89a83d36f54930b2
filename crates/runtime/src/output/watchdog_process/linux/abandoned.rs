//! The release of keys whose process was killed together with its watchdog.

use crate::output::desktop::connect;
use crate::output::desktop::injector::Injector;
use crate::output::pressed_key_file::AbandonedKeys;
use crate::output::watchdog_process::AbandonedRelease;
use ademan_core::device::pressed_keys::KeyDirection;

/// Releases the keys that processes without a watchdog have left pressed on the display of the session, and removes what
/// they have left in its keymap.
///
/// # Errors
/// If the display cannot be reached, or a release failed. Then a further call tries again.
pub fn release_abandoned_keys() -> Result<AbandonedRelease, String> {
    let mut result = AbandonedRelease::default();
    for record in AbandonedKeys::find() {
        let abandoned = match record {
            Ok(abandoned) => abandoned,
            Err(reason) => {
                result.skipped.push(reason);
                continue;
            }
        };
        release(&abandoned)?;
        result.released += abandoned.keys.count();
        abandoned.forget();
    }
    Ok(result)
}

fn release(abandoned: &AbandonedKeys) -> Result<(), String> {
    let (keys, character_keys) = (&abandoned.keys, &abandoned.character_keys);
    if keys.is_empty() && character_keys.is_empty() {
        return Ok(());
    }
    let mut display = connect(Some(abandoned.display_name()), false)?;
    for key in keys.release_order() {
        display.inject(key, KeyDirection::Release)?;
    }
    // The display answers when it has executed the releases. A key of a real keyboard may still be pressed.
    display.query_pressed(keys)?;
    display.remove_character_keys(character_keys)
}
