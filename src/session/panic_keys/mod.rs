//! Keys of a real keyboard that stop a run at once: a way out that does not lead through the hand.

#[cfg(target_os = "linux")]
mod key_combination;
#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod unsupported;

#[cfg(target_os = "linux")]
use linux as platform;
#[cfg(not(target_os = "linux"))]
use unsupported as platform;

use crate::device::{KeyCode, KeyKind};
use crate::names::UnknownName;

/// Why no keys stop a run.
#[derive(Debug, thiserror::Error)]
pub enum PanicKeysError {
    /// There is no key of this name.
    #[error("panic_keys: {0}")]
    UnknownKey(#[from] UnknownName),
    /// Something else than keys was named.
    #[error("panic_keys: `{0}` is no key of a keyboard")]
    NotAKeyboardKey(KeyCode),
    /// No keyboard can be read.
    #[error(
        "panic_keys: {0}; a shortcut of your desktop that calls `ademan ctl pause` does the same and takes no rights"
    )]
    NoKeyboard(String),
}

/// The keys of these names.
pub fn parse_keys(names: &[String]) -> Result<Vec<KeyCode>, PanicKeysError> {
    let key = |name: &String| {
        let key: KeyCode = name.parse()?;
        match key.kind() {
            KeyKind::Keyboard => Ok(key),
            _ => Err(PanicKeysError::NotAKeyboardKey(key)),
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
pub fn watch(keys: &[KeyCode], stop: impl Fn() + Send + 'static) -> Result<(), PanicKeysError> {
    match keys.is_empty() {
        true => Ok(()),
        false => platform::watch(keys, stop).map_err(PanicKeysError::NoKeyboard),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_keys_of_keyboards_do() {
        let error = |name: &str| parse_keys(&[name.to_owned()]).unwrap_err().to_string();
        assert_eq!(
            error("MouseLeft"),
            "panic_keys: `MouseLeft` is no key of a keyboard"
        );
        let text = error("ControlLef");
        assert!(text.contains("did you mean `ControlLeft`?"), "{text}");
    }
}
