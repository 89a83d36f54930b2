//! Which keys have to be tapped, one after the other, so that a text comes out.

use super::action::HandAction;
use crate::contact::TargetId;
use crate::device::keyboard::KeyBinding;
use crate::device::{KeyAction, KeyCode, Latch};

/// Why a text cannot be typed with one finger on a layout.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// No key position writes it.
    #[error("cannot type {0:?}: no key of a US keymap writes it")]
    NotOnUsKeymap(char),
    /// The layout lacks the key.
    #[error(
        "cannot type {character:?}: the layout has no key {key} in any layer that a tap reaches"
    )]
    NoKey {
        /// What was to be typed.
        character: char,
        /// The key that writes it.
        key: KeyCode,
    },
    /// The layout lacks a Shift that is tapped.
    #[error("cannot type {0:?} with one finger: the layout has no one-shot Shift key")]
    NoShift(char),
}

/// The taps that type `text` on these keys for a receiver with a US keymap, one finger at a time:
/// Shift and layers go by their one-shot keys.
pub fn taps_for_text(text: &str, keys: &[KeyBinding]) -> Result<Vec<HandAction>, PlanError> {
    let taps = targets(text, keys)?;
    Ok(taps.into_iter().map(HandAction::tap).collect())
}

fn targets(text: &str, keys: &[KeyBinding]) -> Result<Vec<TargetId>, PlanError> {
    let mut taps = Vec::new();
    for character in text.chars() {
        let ways = KeyCode::for_us_character(character);
        let mut ways = ways.filter_map(|(code, shifted)| way_to(code, shifted, keys));
        let way = ways.next().ok_or_else(|| why_not(character, keys))?;
        taps.extend(way);
    }
    Ok(taps)
}

/// What is missing for `character`.
fn why_not(character: char, keys: &[KeyBinding]) -> PlanError {
    let Some((key, shifted)) = KeyCode::for_us_character(character).last() else {
        return PlanError::NotOnUsKeymap(character);
    };
    match shifted && way_to(key, false, keys).is_some() {
        true => PlanError::NoShift(character),
        false => PlanError::NoKey { character, key },
    }
}

/// The taps for a key, with a one-shot Shift before it where that goes with it.
fn way_to(code: KeyCode, shifted: bool, keys: &[KeyBinding]) -> Option<Vec<TargetId>> {
    let mut way = match shifted {
        true => vec![tapped(keys, is_one_shot_shift)?],
        false => Vec::new(),
    };
    way.extend(way_without_shift(code, keys)?);
    Some(way)
}

/// The taps that press `code`: its key, or the key of a layer that has it and then its key there.
fn way_without_shift(code: KeyCode, keys: &[KeyBinding]) -> Option<Vec<TargetId>> {
    if let Some(tap) = tapped(keys, |action| action == KeyAction::Key(code)) {
        return Some(vec![tap]);
    }
    let layers = keys.iter().map(|key| key.actions.len()).max().unwrap_or(0);
    (1..layers).find_map(|layer| {
        let to_layer = tapped(keys, |action| {
            action == KeyAction::Layer(layer, Latch::OneShot)
        })?;
        let key = keys
            .iter()
            .find(|key| key.actions.get(layer) == Some(&Some(KeyAction::Key(code))))?;
        Some(vec![to_layer, key.target])
    })
}

/// The first key whose action in the base layer is wanted.
fn tapped(keys: &[KeyBinding], wanted: impl Fn(KeyAction) -> bool) -> Option<TargetId> {
    keys.iter()
        .find(|key| key.actions.first().copied().flatten().is_some_and(&wanted))
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

    fn key(number: u32, actions: &[Option<KeyAction>]) -> KeyBinding {
        KeyBinding {
            target: TargetId(number),
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

    fn numbers(text: &str) -> Result<Vec<u32>, PlanError> {
        let taps = targets(text, &board())?;
        Ok(taps.iter().map(|target| target.0).collect())
    }

    #[test]
    fn capitals_go_by_shift_and_what_is_in_a_layer_by_its_key() {
        assert_eq!(numbers("qQ1!"), Ok(vec![0, 1, 0, 2, 0, 1, 2, 0]));
    }

    #[test]
    fn what_cannot_be_typed_is_named() {
        assert_eq!(numbers("é"), Err(PlanError::NotOnUsKeymap('é')));
        let missing = numbers("w").unwrap_err().to_string();
        assert!(
            missing.contains("'w'") && missing.contains("key W"),
            "{missing}"
        );
        let no_shift = taps_for_text("Q", &board()[..1]).unwrap_err();
        assert_eq!(no_shift, PlanError::NoShift('Q'));
    }
}
