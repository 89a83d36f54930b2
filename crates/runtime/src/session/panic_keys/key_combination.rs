//! A combination of keys on several keyboards.

use ademan_core::device::KeyCode;

/// A combination of keys, and the subset that is pressed.
#[derive(Clone, Debug)]
pub(super) struct KeyCombination {
    pub keys: Vec<KeyCode>,
    /// Pressed keys with the ids of their keyboards.
    pressed: Vec<(u64, KeyCode)>,
}

impl KeyCombination {
    pub fn new(keys: &[KeyCode]) -> Self {
        Self {
            keys: keys.to_vec(),
            pressed: Vec::new(),
        }
    }

    /// Updates a key. Returns `true` if this press completes the combination.
    pub fn update(&mut self, keyboard: u64, key: KeyCode, is_pressed: bool) -> bool {
        let was_complete = self.is_complete();
        self.pressed.retain(|other| *other != (keyboard, key));
        if is_pressed && self.keys.contains(&key) {
            self.pressed.push((keyboard, key));
        }
        self.is_complete() && !was_complete
    }

    /// Removes the pressed keys of a keyboard that was disconnected.
    pub fn remove_keyboard(&mut self, keyboard: u64) {
        self.pressed.retain(|(other, _)| *other != keyboard);
    }

    fn is_complete(&self) -> bool {
        let is_pressed = |key: &KeyCode| self.pressed.iter().any(|(_, other)| other == key);
        self.keys.iter().all(is_pressed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> KeyCode {
        name.parse().unwrap()
    }

    fn combination() -> KeyCombination {
        KeyCombination::new(&[key("ControlLeft"), key("ControlRight")])
    }

    #[test]
    fn each_press_that_completes_the_combination_is_detected_once() {
        let mut combination = combination();
        let (left, right) = (key("ControlLeft"), key("ControlRight"));
        assert!(!combination.update(1, left, true));
        assert!(!combination.update(1, key("A"), true));
        assert!(combination.update(2, right, true), "on another keyboard");
        assert!(!combination.update(2, right, true));
        assert!(!combination.update(2, right, false));
        assert!(combination.update(2, right, true));
    }

    #[test]
    fn keys_of_a_disconnected_keyboard_are_not_pressed() {
        let mut combination = combination();
        combination.update(1, key("ControlLeft"), true);
        combination.remove_keyboard(1);
        assert!(!combination.update(2, key("ControlRight"), true));
    }
}
