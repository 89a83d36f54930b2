//! Translation of a text to the taps that type it.

use super::action::HandAction;
use crate::contact::TargetId;
use crate::device::keyboard::KeyBinding;
use crate::device::{KeyAction, KeyCode, Latch};

/// Reason why one finger cannot type a text on a layout.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// A character that a US keymap does not have.
    #[error("cannot type {0:?}: a US keymap has no key for it")]
    NotOnUsKeymap(char),
    /// A key that the layout does not have.
    #[error("cannot type {character:?}: no layer that a tap activates has the key {key}")]
    NoKey {
        /// The character.
        character: char,
        /// Its key on a US keymap.
        key: KeyCode,
    },
    /// A shifted character on a layout without a one-shot Shift.
    #[error("cannot type {0:?} with one finger: the layout has no one-shot Shift key")]
    NoShift(char),
}

/// Returns the taps that type `text` for a receiver with a US keymap, with one finger. Shift and layers are activated
/// by one-shot keys.
pub fn taps_for_text(text: &str, keys: &[KeyBinding]) -> Result<Vec<HandAction>, PlanError> {
    let targets = targets_for_text(text, keys)?;
    Ok(targets.into_iter().map(HandAction::tap).collect())
}

fn targets_for_text(text: &str, keys: &[KeyBinding]) -> Result<Vec<TargetId>, PlanError> {
    let mut targets = Vec::new();
    for character in text.chars() {
        let codes = KeyCode::for_us_character(character);
        let mut taps = codes.filter_map(|(code, is_shifted)| taps_for_key(code, is_shifted, keys));
        targets.extend(taps.next().ok_or_else(|| error_for(character, keys))?);
    }
    Ok(targets)
}

/// Returns the reason why a character cannot be typed.
fn error_for(character: char, keys: &[KeyBinding]) -> PlanError {
    let Some((key, is_shifted)) = KeyCode::for_us_character(character).last() else {
        return PlanError::NotOnUsKeymap(character);
    };
    match is_shifted && taps_for_key(key, false, keys).is_some() {
        true => PlanError::NoShift(character),
        false => PlanError::NoKey { character, key },
    }
}

/// Returns the taps for a key, after a one-shot Shift if `is_shifted`.
fn taps_for_key(code: KeyCode, is_shifted: bool, keys: &[KeyBinding]) -> Option<Vec<TargetId>> {
    let mut taps = match is_shifted {
        true => vec![find_in_base_layer(keys, is_one_shot_shift)?],
        false => Vec::new(),
    };
    taps.extend(taps_without_shift(code, keys)?);
    Some(taps)
}

/// Returns the tap on the key in the base layer, or the taps on a one-shot layer key and on the key in that layer.
fn taps_without_shift(code: KeyCode, keys: &[KeyBinding]) -> Option<Vec<TargetId>> {
    if let Some(tap) = find_in_base_layer(keys, |action| action == KeyAction::Key(code)) {
        return Some(vec![tap]);
    }
    let layers = keys.iter().map(|key| key.actions.len()).max().unwrap_or(0);
    (1..layers).find_map(|layer| {
        let layer_key = find_in_base_layer(keys, |action| {
            action == KeyAction::Layer(layer, Latch::OneShot)
        })?;
        let key = keys
            .iter()
            .find(|key| key.actions.get(layer) == Some(&Some(KeyAction::Key(code))))?;
        Some(vec![layer_key, key.target])
    })
}

/// Returns the first key with a matching action in the base layer.
fn find_in_base_layer(
    keys: &[KeyBinding],
    is_match: impl Fn(KeyAction) -> bool,
) -> Option<TargetId> {
    keys.iter()
        .find(|key| {
            key.actions
                .first()
                .copied()
                .flatten()
                .is_some_and(&is_match)
        })
        .map(|key| key.target)
}

fn is_one_shot_shift(action: KeyAction) -> bool {
    matches!(
        action,
        KeyAction::Modifier(KeyCode::SHIFT_LEFT | KeyCode::SHIFT_RIGHT, Latch::OneShot)
    )
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::device::keyboard::Activation;

    fn key(id: u32, actions: &[Option<KeyAction>]) -> KeyBinding {
        KeyBinding {
            target: TargetId(id),
            actions: actions.to_vec(),
            reports_depth: false,
            activation: Activation::OnPress,
            debounce: Duration::ZERO,
        }
    }

    fn code(name: &str) -> KeyAction {
        KeyAction::Key(name.parse().unwrap())
    }

    fn board() -> Vec<KeyBinding> {
        vec![
            key(0, &[Some(code("Q")), Some(code("1"))]),
            key(
                1,
                &[Some(KeyAction::Modifier(
                    KeyCode::SHIFT_LEFT,
                    Latch::OneShot,
                ))],
            ),
            key(2, &[Some(KeyAction::Layer(1, Latch::OneShot))]),
        ]
    }

    fn ids(text: &str) -> Result<Vec<u32>, PlanError> {
        let targets = targets_for_text(text, &board())?;
        Ok(targets.iter().map(|target| target.0).collect())
    }

    #[test]
    fn capitals_use_shift_and_other_layers_use_their_layer_key() {
        assert_eq!(ids("qQ1!"), Ok(vec![0, 1, 0, 2, 0, 1, 2, 0]));
    }

    #[test]
    fn the_character_and_key_that_are_missing_are_named() {
        assert_eq!(ids("é"), Err(PlanError::NotOnUsKeymap('é')));
        let missing = ids("w").unwrap_err().to_string();
        assert!(
            missing.contains("'w'") && missing.contains("key W"),
            "{missing}"
        );
        let no_shift = taps_for_text("Q", &board()[..1]).unwrap_err();
        assert_eq!(no_shift, PlanError::NoShift('Q'));
    }
}
