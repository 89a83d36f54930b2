//! The keys and buttons that are pressed.

use arrayvec::ArrayVec;

use super::KeyCode;

/// The direction of a key or button event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyDirection {
    /// The key is pressed.
    Press,
    /// The key is released.
    Release,
}

/// The set of pressed keys and buttons, in the order in which they were pressed.
///
/// It has a fixed capacity and never allocates.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PressedKeys {
    // Each key is in the list at most once, and the capacity exceeds the number of keys.
    keys: ArrayVec<KeyCode, { PressedKeys::CAPACITY }>,
}

impl PressedKeys {
    /// The capacity; it exceeds the number of [`KeyCode`]s.
    pub const CAPACITY: usize = 160;

    /// Adds `key`. Returns `false` if it was pressed already.
    pub fn press(&mut self, key: KeyCode) -> bool {
        !self.contains(key) && self.keys.try_push(key).is_ok()
    }

    /// Removes `key`. Returns `false` if it was not pressed.
    pub fn release(&mut self, key: KeyCode) -> bool {
        let Some(index) = self.keys.iter().position(|pressed| *pressed == key) else {
            return false;
        };
        self.keys.remove(index);
        true
    }

    /// Returns `true` if `key` is pressed.
    pub fn contains(&self, key: KeyCode) -> bool {
        self.keys.contains(&key)
    }

    /// Returns the number of pressed keys.
    pub fn count(&self) -> usize {
        self.keys.len()
    }

    /// Returns `true` if no key is pressed.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Returns all keys in the order in which to release them: the last pressed key first and modifiers at the end, so
    /// that no key is ever down without its modifiers.
    pub fn release_order(&self) -> impl Iterator<Item = KeyCode> + '_ {
        let of_kind = |modifier: bool| {
            let newest_first = self.keys.iter().rev().copied();
            newest_first.filter(move |key| key.is_modifier() == modifier)
        };
        of_kind(false).chain(of_kind(true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> KeyCode {
        name.parse().unwrap()
    }

    #[test]
    fn a_key_is_pressed_once_and_released_once() {
        let mut pressed = PressedKeys::default();
        assert!(pressed.press(key("Q")));
        assert!(!pressed.press(key("Q")));
        assert!(pressed.contains(key("Q")));
        assert!(pressed.release(key("Q")));
        assert!(!pressed.release(key("Q")));
        assert!(pressed.is_empty());
    }

    #[test]
    fn the_last_pressed_key_is_released_first_and_modifiers_last() {
        let mut pressed = PressedKeys::default();
        for name in ["A", "ShiftLeft", "B", "AltRight", "C"] {
            pressed.press(key(name));
        }
        pressed.release(key("B"));
        let order: Vec<_> = pressed.release_order().map(KeyCode::name).collect();
        assert_eq!(order, ["C", "A", "AltRight", "ShiftLeft"]);
    }

    #[test]
    fn all_keys_can_be_pressed_at_once() {
        let mut pressed = PressedKeys::default();
        assert!(KeyCode::all().all(|key| pressed.press(key)));
        assert_eq!(pressed.release_order().count(), KeyCode::all().count());
    }
}
