//! Translation of a text to the taps and chords that type it.

use std::collections::VecDeque;
use std::time::Duration;

use super::action::{HandAction, TargetPoint};
use crate::contact::TargetId;
use crate::device::keyboard::{Activation, Chord, KeyBinding, action_in_layer};
use crate::device::{KeyAction, KeyCode, Latch, Multitap, Multitaps};
use crate::layout::Layout;

/// Time by which the pause between two letters of one multitap key is longer than its time-out.
const PAUSE_MARGIN: Duration = Duration::from_millis(100);

/// Time by which the rest on a key that dwelling activates is longer than the key needs.
const REST_MARGIN: Duration = Duration::from_millis(100);

/// Reason why a layout cannot type a character.
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
        /// The key on a US keymap.
        key: KeyCode,
    },
    /// A shifted character on a layout without a one-shot Shift.
    #[error("cannot type {0:?} with one finger: the layout has no one-shot Shift key")]
    NoShift(char),
    /// Several characters, with the reason for the first one.
    #[error("{first}; nor {}", list(.others))]
    Several {
        /// The reason for the first character.
        first: Box<Self>,
        /// The other characters, each once.
        others: Vec<char>,
    },
}

fn list(characters: &[char]) -> String {
    let quoted = characters.iter().map(|character| format!("{character:?}"));
    quoted.collect::<Vec<_>>().join(", ")
}

/// Returns the actions of a hand that type `text` on a layout for a receiver with a US keymap: taps, chords, rests on keys that dwelling
/// activates, and pauses between two letters of one multitap key. Shift and layers are activated by one-shots. If a text decoder
/// `finds_letters` of multitap keys, each letter is one tap.
pub fn actions_for_text(
    text: &str,
    layout: &Layout,
    finds_letters: bool,
) -> Result<Vec<HandAction>, PlanError> {
    let characters = actions_for_characters(text, layout, finds_letters);
    joined(text.chars().zip(characters))
}

/// Returns the same for each character. A character that the layout cannot type does not change the others.
pub(super) fn actions_for_characters(
    text: &str,
    layout: &Layout,
    finds_letters: bool,
) -> Vec<Result<Vec<HandAction>, PlanError>> {
    let keys = layout.key_bindings();
    let mut planner = Planner::new(&keys, layout.bend_chords(), &layout.multitaps);
    planner.finds_letters = finds_letters;
    planner.characters(text)
}

/// Returns the taps and chords that type `text` on a layout for a receiver with a US keymap, without taps in a row that choose a letter:
/// each of them replaces a letter. A key that dwelling activates has a tap like any other. Shift and layers are activated by one-shots.
/// If a text decoder `finds_letters` of multitap keys, each letter is one tap, and a key with signs types its first one.
pub fn taps_for_text(
    text: &str,
    layout: &Layout,
    finds_letters: bool,
) -> Result<Vec<HandAction>, PlanError> {
    let keys = layout.key_bindings();
    let planner = Planner::new(&keys, layout.bend_chords(), &layout.multitaps);
    let mut planner = planner.without_rests();
    planner.finds_letters = finds_letters;
    planner.chooses_letters = false;
    joined(text.chars().zip(planner.characters(text)))
}

/// Returns the tap or the chord that deletes a character in the base layer.
pub fn backspace_of(layout: &Layout) -> Option<HandAction> {
    let keys = layout.key_bindings();
    let planner = Planner::new(&keys, layout.bend_chords(), &layout.multitaps);
    let planner = planner.without_rests();
    let backspace = KeyAction::Key(KeyCode::BACKSPACE);
    let stroke = planner.find(0, |action| action == backspace)?;
    stroke.hand_actions().pop()
}

/// Returns the actions of all characters, or the reasons why there are none for some.
fn joined(
    characters: impl Iterator<Item = (char, Result<Vec<HandAction>, PlanError>)>,
) -> Result<Vec<HandAction>, PlanError> {
    let (mut actions, mut first, mut failed) = (Vec::new(), None, Vec::new());
    for (character, planned) in characters {
        match planned {
            Ok(planned) => actions.extend(planned),
            Err(_) if failed.contains(&character) => {}
            Err(error) => {
                first = first.or(Some(error));
                failed.push(character);
            }
        }
    }
    match first {
        None => Ok(actions),
        Some(first) if failed.len() == 1 => Err(first),
        Some(first) => Err(PlanError::Several {
            first: Box::new(first),
            others: failed.split_off(1),
        }),
    }
}

/// A key or a chord with its action in each layer, base layer first.
#[derive(Clone, Copy)]
struct Stroke<'a> {
    targets: &'a [TargetId],
    actions: &'a [Option<KeyAction>],
    /// The time for which a fingertip has to rest on the key; `None` if a tap activates it.
    dwell: Option<Duration>,
}

impl Stroke<'_> {
    fn action_in(&self, layer: usize) -> Option<KeyAction> {
        action_in_layer(self.actions, layer)
    }

    fn hand_actions(self) -> Vec<HandAction> {
        match (self.targets, self.dwell) {
            (&[target], Some(dwell)) => vec![
                HandAction::Press(TargetPoint::center(target)),
                HandAction::Wait(dwell + REST_MARGIN),
                HandAction::Lift,
            ],
            (&[target], None) => vec![HandAction::tap(target)],
            (targets, _) => vec![HandAction::Chord(targets.to_vec())],
        }
    }
}

/// The strokes of a layout, and the layers that one-shots activate.
struct Planner<'a> {
    strokes: Vec<Stroke<'a>>,
    /// Layers, nearest first, with the strokes that activate each.
    layers: Vec<(usize, Vec<Stroke<'a>>)>,
    multitaps: &'a Multitaps,
    /// `true` if a text decoder finds the letters of multitap keys.
    finds_letters: bool,
    /// `true` if taps in a row may choose a letter of a multitap key.
    chooses_letters: bool,
}

impl<'a> Planner<'a> {
    fn new(keys: &'a [KeyBinding], chords: &'a [Chord], multitaps: &'a Multitaps) -> Self {
        let keys = keys.iter().map(|key| Stroke {
            targets: std::slice::from_ref(&key.target),
            actions: &key.actions,
            dwell: match key.activation {
                Activation::Dwell(time) => Some(time),
                _ => None,
            },
        });
        let chords = chords.iter().map(|chord| Stroke {
            targets: &chord.keys,
            actions: &chord.actions,
            dwell: None,
        });
        let mut strokes: Vec<Stroke> = keys.chain(chords).collect();
        // A tap is preferred to a rest.
        strokes.sort_by_key(|stroke| stroke.dwell.is_some());
        let mut planner = Self {
            strokes,
            layers: Vec::new(),
            multitaps,
            finds_letters: false,
            chooses_letters: true,
        };
        planner.find_layers();
        planner
    }

    /// Taps keys that dwelling activates, too.
    fn without_rests(mut self) -> Self {
        for stroke in &mut self.strokes {
            stroke.dwell = None;
        }
        self.layers.clear();
        self.find_layers();
        self
    }

    fn find_layers(&mut self) {
        let mut queue = VecDeque::from([(0, Vec::new())]);
        while let Some((layer, path)) = queue.pop_front() {
            if self.layers.iter().any(|(other, _)| *other == layer) {
                continue;
            }
            for stroke in &self.strokes {
                if let Some(KeyAction::Layer(next, Latch::OneShot)) = stroke.action_in(layer) {
                    queue.push_back((next, [path.as_slice(), &[*stroke]].concat()));
                }
            }
            self.layers.push((layer, path));
        }
    }

    /// Returns the actions of each character of a text.
    fn characters(&self, text: &str) -> Vec<Result<Vec<HandAction>, PlanError>> {
        // The multitap key whose letter the next tap would replace.
        let mut open = None;
        let mut plan = |character: char| {
            let codes = KeyCode::for_us_character(character);
            let mut strokes = codes.filter_map(|(code, is_shifted)| self.strokes(code, is_shifted));
            let strokes = strokes.next().ok_or_else(|| self.error_for(character))?;
            let first = strokes.first().map(|stroke| stroke.targets);
            let pause = (first.is_some() && first == open)
                .then(|| HandAction::Wait(self.multitaps.timeout + PAUSE_MARGIN));
            let last = strokes.last().filter(|stroke| self.has_choice(**stroke));
            open = last.map(|stroke| stroke.targets);
            let taps = strokes.into_iter().flat_map(Stroke::hand_actions);
            Ok(pause.into_iter().chain(taps).collect())
        };
        text.chars().map(&mut plan).collect()
    }

    /// Returns the strokes for a key, after a one-shot Shift if `is_shifted`: the fewest. In one layer a key is preferred to a multitap
    /// key.
    fn strokes(&self, code: KeyCode, is_shifted: bool) -> Option<Vec<Stroke<'a>>> {
        let mut strokes = if is_shifted {
            vec![self.find(0, is_one_shot_shift)?]
        } else {
            Vec::new()
        };
        let key = KeyAction::Key(code);
        let taps_of = |action| self.taps(action, key);
        let taps = |(layer, path): &(usize, Vec<Stroke<'a>>)| {
            let single = self.find(*layer, |action| action == key);
            let single = single.map(|stroke| (path.clone(), stroke, 1));
            single.or_else(|| {
                let multitap = self.find(*layer, |action| taps_of(action).is_some())?;
                let count = taps_of(multitap.action_in(*layer)?)?;
                Some((path.clone(), multitap, count))
            })
        };
        let plans = self.layers.iter().filter_map(taps);
        let (path, stroke, count) = plans.min_by_key(|(path, _, count)| path.len() + count)?;
        strokes.extend(path);
        strokes.extend(std::iter::repeat_n(stroke, count));
        Some(strokes)
    }

    /// Returns the multitap key of an action.
    fn multitap(&self, action: KeyAction) -> Option<&'a Multitap> {
        let KeyAction::Multitap(id) = action else {
            return None;
        };
        self.multitaps.keys.get(usize::from(id.0))
    }

    /// Returns `true` if a text decoder finds the letters of a multitap key from one tap each.
    fn is_found(&self, key: &Multitap) -> bool {
        self.finds_letters && key.has_word_letters()
    }

    /// Returns `true` if taps in a row of a stroke choose a letter in a layer.
    fn has_choice(&self, stroke: Stroke) -> bool {
        let keys = stroke.actions.iter().flatten();
        let mut keys = keys.filter_map(|action| self.multitap(*action));
        let has_multitaps = self.chooses_letters || self.finds_letters;
        has_multitaps && keys.any(|key| !self.is_found(key))
    }

    /// Returns the number of taps of a multitap key that choose a letter.
    fn taps(&self, action: KeyAction, letter: KeyAction) -> Option<usize> {
        let key = self.multitap(action)?;
        let index = key.letters.iter().position(|other| *other == letter)?;
        if self.is_found(key) {
            letter.types_letter().then_some(1)
        } else {
            let is_first = self.finds_letters && index == 0;
            (self.chooses_letters || is_first).then_some(index + 1)
        }
    }

    /// Returns the first stroke with a matching action in a layer.
    fn find(&self, layer: usize, is_match: impl Fn(KeyAction) -> bool) -> Option<Stroke<'a>> {
        let mut strokes = self.strokes.iter();
        let found = strokes.find(|stroke| stroke.action_in(layer).is_some_and(&is_match));
        found.copied()
    }

    /// Returns the reason why a character cannot be typed.
    fn error_for(&self, character: char) -> PlanError {
        let Some((key, is_shifted)) = KeyCode::for_us_character(character).last() else {
            return PlanError::NotOnUsKeymap(character);
        };
        if is_shifted && self.strokes(key, false).is_some() {
            PlanError::NoShift(character)
        } else {
            PlanError::NoKey { character, key }
        }
    }
}

fn is_one_shot_shift(action: KeyAction) -> bool {
    matches!(
        action,
        KeyAction::Modifier(KeyCode::SHIFT_LEFT | KeyCode::SHIFT_RIGHT, Latch::OneShot)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::MultitapId;

    fn key(id: u32, actions: &[Option<KeyAction>]) -> KeyBinding {
        KeyBinding {
            target: TargetId(id),
            actions: actions.to_vec(),
            reports_depth: false,
            reports_velocity: false,
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

    fn chord(ids: &[u32], actions: &[Option<KeyAction>]) -> Chord {
        Chord {
            keys: ids.iter().copied().map(TargetId).collect(),
            actions: actions.to_vec(),
            activation: Activation::OnPress,
        }
    }

    fn taps(
        text: &str,
        keys: &[KeyBinding],
        chords: &[Chord],
    ) -> Result<Vec<HandAction>, PlanError> {
        let multitaps = Multitaps::default();
        let planner = Planner::new(keys, chords, &multitaps);
        joined(text.chars().zip(planner.characters(text)))
    }

    /// The numbers of the keys of each stroke.
    fn ids(text: &str, chords: &[Chord]) -> Result<Vec<Vec<u32>>, PlanError> {
        let actions = taps(text, &board(), chords)?;
        let targets = |action| match action {
            HandAction::Tap(point) => vec![point.target.0],
            HandAction::Chord(targets) => targets.iter().map(|target| target.0).collect(),
            other => panic!("{other:?}"),
        };
        Ok(actions.into_iter().map(targets).collect())
    }

    #[test]
    fn capitals_use_shift_and_other_layers_use_their_layer_key() {
        let taps = [0, 1, 0, 2, 0, 1, 2, 0].map(|id| vec![id]);
        assert_eq!(ids("qQ1!", &[]), Ok(taps.to_vec()));
    }

    #[test]
    fn chords_type_and_activate_layers_of_layers() {
        let to_next = Some(KeyAction::Layer(2, Latch::OneShot));
        let chords = [
            chord(&[0, 1], &[Some(code("W")), None, Some(code("X"))]),
            chord(&[1, 2], &[None, to_next]),
        ];
        assert_eq!(ids("w", &chords), Ok(vec![vec![0, 1]]));
        assert_eq!(ids("x", &chords), Ok(vec![vec![2], vec![1, 2], vec![0, 1]]));
    }

    #[test]
    fn letters_of_multitap_keys_take_taps_in_a_row_and_a_pause_before_another_one_of_the_key() {
        let multitap = |label: &str, letters: &[&str]| Multitap {
            label: label.to_owned(),
            letters: letters.iter().map(|letter| code(letter)).collect(),
        };
        let multitaps = Multitaps {
            keys: vec![
                multitap("ab2", &["A", "B", "2"]),
                multitap(".,", &["Period", "Comma"]),
            ],
            timeout: Duration::from_millis(800),
        };
        let mut keys = board();
        keys.push(key(3, &[Some(KeyAction::Multitap(MultitapId(0)))]));
        keys.push(key(4, &[Some(KeyAction::Multitap(MultitapId(1)))]));
        let planned = |text: &str, finds_letters: bool, chooses_letters: bool| {
            let mut planner = Planner::new(&keys, &[], &multitaps);
            planner.finds_letters = finds_letters;
            planner.chooses_letters = chooses_letters;
            planner.characters(text)
        };
        let words = |text: &str, finds_letters: bool| {
            let characters = planned(text, finds_letters, true);
            let actions = characters.into_iter().flat_map(Result::unwrap);
            let words = actions.map(|action| match action {
                HandAction::Tap(point) => point.target.0.to_string(),
                HandAction::Wait(time) => format!("{} ms", time.as_millis()),
                other => panic!("{other:?}"),
            });
            words.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(words("baq", false), "3 3 900 ms 3 0");
        assert_eq!(words("aqa", false), "3 0 3");
        assert_eq!(words("aB", false), "3 1 3 3");
        // A text decoder finds the letters.
        assert_eq!(words("baqB", true), "3 3 0 1 3");
        // No taps in a row choose.
        let is_typed = |text: &str, finds_letters| planned(text, finds_letters, false)[0].is_ok();
        assert!(is_typed("b", true) && !is_typed("a", false));
        assert!(!is_typed("2", true) && is_typed("q", false));
        assert!(is_typed(".", true) && !is_typed(".", false) && !is_typed(",", true));
    }

    #[test]
    fn a_key_that_dwelling_activates_is_rested_on_unless_a_tap_types_the_same() {
        let mut keys = board();
        keys[0].activation = Activation::Dwell(Duration::from_millis(400));
        let rest = vec![
            HandAction::Press(TargetPoint::center(TargetId(0))),
            HandAction::Wait(Duration::from_millis(500)),
            HandAction::Lift,
        ];
        assert_eq!(taps("q", &keys, &[]), Ok(rest));
        let multitaps = Multitaps::default();
        let planner = Planner::new(&keys, &[], &multitaps).without_rests();
        let tapped = vec![HandAction::tap(TargetId(0))];
        assert_eq!(planner.characters("q")[0], Ok(tapped));
        keys.push(key(3, &[Some(code("Q"))]));
        let tap = vec![HandAction::tap(TargetId(3))];
        assert_eq!(taps("q", &keys, &[]), Ok(tap));
    }

    #[test]
    fn the_characters_and_key_that_are_missing_are_named() {
        assert_eq!(ids("é", &[]), Err(PlanError::NotOnUsKeymap('é')));
        let missing = ids("w", &[]).unwrap_err().to_string();
        assert!(
            missing.contains("'w'") && missing.contains("key W"),
            "{missing}"
        );
        let several = ids("wqew", &[]).unwrap_err().to_string();
        assert!(several.ends_with("the key W; nor 'e'"), "{several}");
        let no_shift = taps("Q", &board()[..1], &[]).unwrap_err();
        assert_eq!(no_shift, PlanError::NoShift('Q'));
    }
}
