//! Keys of a real keyboard that stop a run at once: a way out that does not lead through the hand.

#[cfg(target_os = "linux")]
mod keyboards;
#[cfg(not(target_os = "linux"))]
#[path = "emergency/no_keyboards.rs"]
mod keyboards;

use crate::device::{KeyCode, KeyKind};
use crate::names::UnknownName;

/// How the names of the program's own keyboards begin: what it presses itself stops nothing.
const OWN: &str = "Ademan ";

/// Why no keys stop a run.
#[derive(Debug, thiserror::Error)]
pub enum EmergencyError {
    /// There is no key of this name.
    #[error("stop_keys: {0}")]
    Name(#[from] UnknownName),
    /// Something else than keys was named.
    #[error("stop_keys: `{0}` is no key of a keyboard")]
    Kind(KeyCode),
    /// No keyboard can be read.
    #[error(
        "stop_keys: {0}; a shortcut of your desktop that calls `ademan ctl pause` does the same and takes no rights"
    )]
    Unreadable(String),
}

/// The keys of these names.
pub fn keys(names: &[String]) -> Result<Vec<KeyCode>, EmergencyError> {
    let key = |name: &String| {
        let key: KeyCode = name.parse()?;
        match key.kind() {
            KeyKind::Key => Ok(key),
            _ => Err(EmergencyError::Kind(key)),
        }
    };
    names.iter().map(key).collect()
}

/// Calls `stop` whenever all of `keys` are down on the keyboards of this machine, together on one or on several,
/// until the program ends. `stop` must not wait. Keyboards that are plugged in later count too; those that the
/// program makes itself do not.
///
/// Of what is typed nothing else is looked at, and nothing is kept. Without keys it does nothing. An error when
/// no keyboard can be read: who asks for a way out is to know that there is none.
pub fn watch(keys: &[KeyCode], stop: impl Fn() + Send + 'static) -> Result<(), EmergencyError> {
    match keys.is_empty() {
        true => Ok(()),
        false => keyboards::watch(Chord::of(keys), stop).map_err(EmergencyError::Unreadable),
    }
}

/// The keys, and which of them are down.
#[derive(Clone, Debug)]
struct Chord {
    keys: Vec<KeyCode>,
    /// What is down, with the number of its keyboard.
    down: Vec<(u64, KeyCode)>,
}

impl Chord {
    fn of(keys: &[KeyCode]) -> Self {
        Self {
            keys: keys.to_vec(),
            down: Vec::new(),
        }
    }

    fn has(&self, key: KeyCode) -> bool {
        self.keys.contains(&key)
    }

    /// Takes note of a key; whether the last one of all has just gone down.
    fn take(&mut self, keyboard: u64, key: KeyCode, is_down: bool) -> bool {
        let was_complete = self.is_complete();
        self.down.retain(|held| *held != (keyboard, key));
        if is_down && self.has(key) {
            self.down.push((keyboard, key));
        }
        self.is_complete() && !was_complete
    }

    /// A keyboard is gone, and with it what was down on it.
    fn forget(&mut self, keyboard: u64) {
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

    fn chord(names: &[&str]) -> Chord {
        let names: Vec<_> = names.iter().map(|name| name.to_string()).collect();
        Chord::of(&keys(&names).unwrap())
    }

    fn key(name: &str) -> KeyCode {
        name.parse().unwrap()
    }

    #[test]
    fn the_last_key_of_all_stops_once_and_again_after_one_came_up() {
        let mut chord = chord(&["ControlLeft", "ControlRight"]);
        let (left, right) = (key("ControlLeft"), key("ControlRight"));
        assert!(!chord.take(1, left, true));
        assert!(!chord.take(1, key("A"), true));
        assert!(chord.take(2, right, true), "also on another keyboard");
        assert!(!chord.take(2, right, true));
        assert!(!chord.take(2, right, false));
        assert!(chord.take(2, right, true));
    }

    #[test]
    fn what_was_down_on_a_keyboard_that_is_gone_is_not() {
        let mut chord = chord(&["ControlLeft", "ControlRight"]);
        chord.take(1, key("ControlLeft"), true);
        chord.forget(1);
        assert!(!chord.take(2, key("ControlRight"), true));
    }

    #[test]
    fn only_keys_of_keyboards_do() {
        let error = |name: &str| keys(&[name.to_owned()]).unwrap_err().to_string();
        assert_eq!(
            error("MouseLeft"),
            "stop_keys: `MouseLeft` is no key of a keyboard"
        );
        let text = error("ControlLef");
        assert!(text.contains("did you mean `ControlLeft`?"), "{text}");
    }
}
