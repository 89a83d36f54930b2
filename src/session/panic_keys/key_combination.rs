//! Keys that mean something when all of them are down.

use crate::device::KeyCode;

/// The keys, and which of them are down.
#[derive(Clone, Debug)]
pub(super) struct KeyCombination {
    pub keys: Vec<KeyCode>,
    /// What is down, with the number of its keyboard.
    down: Vec<(u64, KeyCode)>,
}

impl KeyCombination {
    pub fn new(keys: &[KeyCode]) -> Self {
        Self {
            keys: keys.to_vec(),
            down: Vec::new(),
        }
    }

    fn has(&self, key: KeyCode) -> bool {
        self.keys.contains(&key)
    }

    /// Takes note of a key; whether the last one of all has just gone down.
    pub fn update(&mut self, keyboard: u64, key: KeyCode, is_down: bool) -> bool {
        let was_complete = self.is_complete();
        self.down.retain(|held| *held != (keyboard, key));
        if is_down && self.has(key) {
            self.down.push((keyboard, key));
        }
        self.is_complete() && !was_complete
    }

    /// A keyboard is gone, and with it what was down on it.
    pub fn remove_keyboard(&mut self, keyboard: u64) {
        self.down.retain(|(held, _)| *held != keyboard);
    }

    fn is_complete(&self) -> bool {
        let is_down = |key: &KeyCode| self.down.iter().any(|(_, held)| held == key);
        self.keys.iter().all(is_down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::panic_keys::parse_keys;

    fn chord(names: &[&str]) -> KeyCombination {
        let names: Vec<_> = names.iter().map(|name| name.to_string()).collect();
        KeyCombination::new(&parse_keys(&names).unwrap())
    }

    fn key(name: &str) -> KeyCode {
        name.parse().unwrap()
    }

    #[test]
    fn the_last_key_of_all_stops_once_and_again_after_one_came_up() {
        let mut chord = chord(&["ControlLeft", "ControlRight"]);
        let (left, right) = (key("ControlLeft"), key("ControlRight"));
        assert!(!chord.update(1, left, true));
        assert!(!chord.update(1, key("A"), true));
        assert!(chord.update(2, right, true), "also on another keyboard");
        assert!(!chord.update(2, right, true));
        assert!(!chord.update(2, right, false));
        assert!(chord.update(2, right, true));
    }

    #[test]
    fn what_was_down_on_a_keyboard_that_is_gone_is_not() {
        let mut chord = chord(&["ControlLeft", "ControlRight"]);
        chord.update(1, key("ControlLeft"), true);
        chord.remove_keyboard(1);
        assert!(!chord.update(2, key("ControlRight"), true));
    }
}
