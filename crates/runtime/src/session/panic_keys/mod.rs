//! Panic keys: keys of a real keyboard that pause the session at once, independent of the hand.

#[cfg(target_os = "linux")]
mod key_combination;
#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
use linux as platform;
#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
use unsupported as platform;

use ademan_core::device::{KeyCode, KeyKind};
use ademan_core::names::UnknownName;

/// Reason why panic keys cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PanicKeysError {
    /// A name is unknown.
    #[error("panic_keys: {0}")]
    UnknownKey(#[from] UnknownName),
    /// A name belongs to a button or another control.
    #[error("panic_keys: `{0}` is not a key of a keyboard")]
    NotAKeyboardKey(KeyCode),
    /// No keyboard can be read.
    #[error(
        "panic_keys: {0}; a desktop shortcut for `ademan ctl pause` does the same and needs no permission"
    )]
    NoKeyboard(String),
}

/// Parses the names of keys.
pub fn parse_keys(names: &[String]) -> Result<Vec<KeyCode>, PanicKeysError> {
    let parse = |name: &String| {
        let key: KeyCode = name.parse()?;
        match key.kind() {
            KeyKind::Keyboard => Ok(key),
            _ => Err(PanicKeysError::NotAKeyboardKey(key)),
        }
    };
    names.iter().map(parse).collect()
}

/// Checks that the keyboards of this machine can be watched for `keys`. Keeps nothing open.
pub fn check(keys: &[KeyCode]) -> Result<(), PanicKeysError> {
    if keys.is_empty() {
        Ok(())
    } else {
        platform::check(keys).map_err(PanicKeysError::NoKeyboard)
    }
}

/// A thread that watches the keyboards, if there are panic keys. It ends when this is dropped.
#[derive(Debug)]
pub struct PanicKeysWatch(
    #[allow(dead_code, reason = "its end is the signal")] Option<platform::Cancel>,
);

/// Calls `stop` whenever all `keys` are pressed on the keyboards of this machine, on one or on several, until the result is
/// dropped. `stop` must not block.
///
/// Keys that are held already count. Keyboards that are connected later are included; those that this program creates are not. Other
/// keys are ignored, and no key is stored. Without keys there is no thread.
///
/// # Errors
/// If no keyboard can be read: a user who relies on panic keys has to know that they do not work.
pub fn watch(
    keys: &[KeyCode],
    stop: impl Fn() + Send + 'static,
) -> Result<PanicKeysWatch, PanicKeysError> {
    if keys.is_empty() {
        return Ok(PanicKeysWatch(None));
    }
    let cancel = platform::watch(keys, stop).map_err(PanicKeysError::NoKeyboard)?;
    Ok(PanicKeysWatch(Some(cancel)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_keys_of_keyboards_are_accepted() {
        let error = |name: &str| parse_keys(&[name.to_owned()]).unwrap_err().to_string();
        assert_eq!(
            error("MouseLeft"),
            "panic_keys: `MouseLeft` is not a key of a keyboard"
        );
        let text = error("ControlLef");
        assert!(text.contains("did you mean `ControlLeft`?"), "{text}");
    }
}
