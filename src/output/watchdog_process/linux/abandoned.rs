//! The release of keys whose process was killed together with its watchdog.

use super::releaser::KeyReleaser;
use crate::device::pressed_keys::KeyDirection;
use crate::output::desktop::worker::Injector;
use crate::output::pressed_key_file::AbandonedKeys;
use crate::output::watchdog::ReleaseTarget;

/// Releases the keys that processes without a watchdog have left pressed on the display of the session, and removes what
/// they have left in its keymap. Returns the number of pressed keys.
///
/// # Errors
/// If the display cannot be reached, or a release failed. Then a further call tries again.
pub fn release_abandoned_keys() -> Result<usize, String> {
    let mut count = 0;
    for abandoned in AbandonedKeys::find() {
        release(&abandoned)?;
        count += abandoned.keys.count();
        abandoned.forget();
    }
    Ok(count)
}

fn release(abandoned: &AbandonedKeys) -> Result<(), String> {
    let (keys, character_keys) = (&abandoned.keys, &abandoned.character_keys);
    if keys.is_empty() && character_keys.is_empty() {
        return Ok(());
    }
    let mut releaser = KeyReleaser::connect(&ReleaseTarget::Display)?;
    for key in keys.release_order() {
        releaser.inject(key, KeyDirection::Release)?;
    }
    // The display answers when it has executed the releases. A key of a real keyboard may still be pressed.
    releaser.query_pressed(keys)?;
    releaser.remove_character_keys(character_keys)
}
