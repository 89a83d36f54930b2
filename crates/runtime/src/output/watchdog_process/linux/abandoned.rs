//! The release of keys whose process was killed together with its watchdog.

use crate::output::character_key::CharacterKey;
use crate::output::desktop::connect;
use crate::output::desktop::injector::Injector;
use crate::output::pressed_key_file::AbandonedKeys;
use crate::output::watchdog_process::AbandonedRelease;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};

/// Releases the keys that processes without a watchdog have left pressed on the display of the session, and removes what
/// they have left in its keymap.
pub fn release_abandoned_keys() -> AbandonedRelease {
    release_records(AbandonedKeys::find(), release)
}

/// Releases the keys of each record with `release_keys`, also after one that fails.
fn release_records(
    records: Vec<Result<AbandonedKeys, String>>,
    release_keys: impl Fn(&AbandonedKeys) -> Result<(), String>,
) -> AbandonedRelease {
    let mut result = AbandonedRelease::default();
    for record in records {
        let abandoned = match record {
            Ok(abandoned) => abandoned,
            Err(reason) => {
                result.skipped.push(reason);
                continue;
            }
        };
        match release_keys(&abandoned) {
            Ok(()) => {
                result.released += abandoned.keys.count();
                abandoned.forget();
            }
            Err(reason) => result.failed.push(reason),
        }
    }
    result
}

fn release(abandoned: &AbandonedKeys) -> Result<(), String> {
    let (keys, character_keys) = (&abandoned.keys, &abandoned.character_keys);
    if keys.is_empty() && character_keys.is_empty() {
        return Ok(());
    }
    let mut display = connect(Some(abandoned.display_name()), false)?;
    release_on(&mut *display, keys, character_keys)
}

/// Releases all keys, also those after one that fails.
fn release_on(
    display: &mut dyn Injector,
    keys: &PressedKeys,
    character_keys: &[CharacterKey],
) -> Result<(), String> {
    let release = |key| display.inject(key, KeyDirection::Release);
    let released = keys.release_order().map(release).fold(Ok(()), Result::and);
    // The display answers when it has executed the releases. A key of a real keyboard may still be pressed.
    let answered = display.query_pressed(keys).map(drop);
    let removed = display.remove_character_keys(character_keys);
    released.and(answered).and(removed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::desktop::pending_motion::StatelessAction;
    use crate::output::pressed_key_file::PressedKeyFile;
    use crate::output::tests::key;
    use ademan_core::device::KeyCode;

    /// A display that has no key A.
    #[derive(Default)]
    struct TestDisplay {
        released: Vec<KeyCode>,
        removed: Vec<CharacterKey>,
    }

    impl Injector for TestDisplay {
        fn inject(&mut self, released: KeyCode, direction: KeyDirection) -> Result<(), String> {
            assert_eq!(direction, KeyDirection::Release);
            if released == key("A") {
                return Err("there is no such key".into());
            }
            self.released.push(released);
            Ok(())
        }

        fn perform(&mut self, _: StatelessAction) -> Result<(), String> {
            unreachable!()
        }

        fn remove_character_keys(&mut self, keys: &[CharacterKey]) -> Result<(), String> {
            self.removed.extend(keys);
            Ok(())
        }
    }

    #[test]
    fn a_key_that_the_display_refuses_does_not_cost_the_others() {
        let mut pressed = PressedKeys::default();
        for name in ["ShiftLeft", "A", "B"] {
            pressed.press(key(name));
        }
        let added = CharacterKey {
            code: 13,
            keysym: 0xf1,
        };
        let mut display = TestDisplay::default();
        let released = release_on(&mut display, &pressed, &[added]);
        assert_eq!(released, Err("there is no such key".into()));
        assert_eq!(display.released, [key("B"), key("ShiftLeft")]);
        assert_eq!(display.removed, [added]);
    }

    #[test]
    fn a_record_whose_release_fails_does_not_hide_the_others() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("ademan");
        for (name, display, pressed) in [
            ("pressed-1-0", ":7", "A"),
            ("pressed-2-0", ":7", "B"),
            ("pressed-3-0", ":8", "C"),
        ] {
            let file = PressedKeyFile::create_at(inside.join(name), display).unwrap();
            file.record(key(pressed), KeyDirection::Press);
            file.abandon();
        }
        let release_keys = |abandoned: &AbandonedKeys| {
            if abandoned.keys.contains(key("A")) {
                return Err("refused".to_owned());
            }
            Ok(())
        };
        let records = AbandonedKeys::find_in(&inside, ":7");
        let result = release_records(records, release_keys);
        assert_eq!((result.released, result.skipped.len()), (1, 1));
        assert_eq!(result.failed, ["refused"]);
        let is_left = |name: &str| inside.join(name).exists();
        assert!(is_left("pressed-1-0") && !is_left("pressed-2-0"));
    }
}
