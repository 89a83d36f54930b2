//! The keys of a layout that type characters, as the decoder sees them.

use crate::keyboard::{ELSEWHERE, MAX_KEYS, Millimetres};
use crate::model::alphabet;
use crate::{Key, Keyboard};
use parry3d::math::{Pose, Vec3};

use ademan_core::contact::surface::Scene;
use ademan_core::contact::{Press, TargetId, trusted_fingertip};
use ademan_core::device::{Capabilities, Capability, KeyAction, KeyCode, MultitapId};
use ademan_core::hand::{Finger, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;

/// Smallest number of letters in a layout for which the decoder is of use.
const MIN_LETTERS: usize = 10;

/// The distance between boards in the plane of the decoder, in millimetres: too far for a tap to miss its board.
const BOARD_GAP: f32 = 200.0;

/// The distance in the plane of the decoder from the position of a character without Shift to the position of the character with it,
/// such as from `/` to `?`, in millimetres.
const SHIFTED: f32 = 40_000.0;

/// The way in which a character is typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Typed {
    /// By a key, with Shift or without.
    Key(KeyCode, bool),
    /// As a character.
    Character(char),
}

/// A key of a board that types a character in the base layer.
#[derive(Clone, Debug)]
struct Place {
    target: TargetId,
    /// The character; the first one of a key that letters share.
    character: char,
    /// The center, in the plane of the decoder, of the first key that types the character.
    center: Millimetres,
    /// Its own center in that plane.
    own_center: Millimetres,
    /// The smaller extent, in millimetres.
    width: f32,
    /// The index of its board, if fingers swipe over the board.
    swiped_board: Option<usize>,
    /// The transform from the frame of the board to the frame of the key.
    target_from_surface: Pose,
}

/// The keys of a layout that type characters.
#[derive(Clone, Debug)]
pub(super) struct TextKeys {
    keyboard: Keyboard,
    places: Vec<Place>,
    codes: Vec<KeyCode>,
    /// `true` if characters may be typed independent of the keymap.
    has_text: bool,
}

/// Returns `true` if the right one of two hands types at `x` on a board of a hand, or on a board that both share.
fn is_right(board: Option<Side>, x: f32) -> bool {
    board.map_or(x > 0.0, |side| side == Side::Right)
}

impl TextKeys {
    /// Finds the keys of a layout; `None` if it has too few letters, or is for another keymap than the one for which characters
    /// are typed. Of two hands each types on its own boards, and on one half of a board that they share.
    pub(super) fn new(layout: &Layout, has_two_hands: bool) -> Option<Self> {
        if shows_other_keymap(layout) {
            return None;
        }
        let singles = layout.keys.iter().filter_map(|key| {
            let action = key.action(0)?;
            character(layout, action, false)
        });
        // Otherwise multitap keys give the accents of letters that have keys of their own.
        let shares_keys = singles.filter(|single| single.is_alphabetic()).count() < MIN_LETTERS;
        let mut keys: Vec<Key> = Vec::new();
        let mut places = Vec::new();
        let mut left = 0.0;
        for (board_index, board) in layout.boards.iter().enumerate() {
            let (low, high) = layout.extent(board);
            let surface = layout.scene.surfaces().get(board_index);
            let side = surface.and_then(|surface| surface.side());
            for key in &layout.keys[board.keys.clone()] {
                let characters = characters(layout, key.action(0), shares_keys);
                let Some(&first) = characters.first() else {
                    continue;
                };
                let face = &key.face;
                let at = face.row_position;
                let half = board.row_half_extents(face);
                let own_center = [left + (at.x - low.x) * 1e3, -at.y * 1e3];
                let known = keys.iter().find(|known| known.character == first);
                // A second key of the same character counts as the first one.
                let center = known.map_or(own_center, |known| known.center);
                if known.is_none() {
                    keys.extend(characters.into_iter().map(|character| Key {
                        character,
                        center,
                        size: [half.x * 2e3, half.y * 2e3],
                        hand: u8::from(has_two_hands && is_right(side, at.x)),
                    }));
                }
                let target = layout.scene.target(face.target);
                places.push(Place {
                    target: face.target,
                    character: first,
                    center,
                    own_center,
                    width: half.min_element() * 2e3,
                    swiped_board: board.swipe.then_some(board_index),
                    target_from_surface: target.map_or(Pose::IDENTITY, |(_, target)| {
                        target.surface_from_target.inverse()
                    }),
                });
            }
            left += (high.x - low.x) * 1e3 + BOARD_GAP;
        }
        let letters = keys.iter().filter(|key| key.character.is_alphabetic());
        if letters.count() < MIN_LETTERS {
            return None;
        }
        add_elsewhere(layout, &mut keys);
        let plain_letters = ('a'..='z').chain([' ', '\'']);
        let plain_letters =
            plain_letters.flat_map(|letter| KeyCode::for_us_character(letter).next());
        let of_layout = layout.required_capabilities().keys.into_iter();
        let mut codes: Vec<KeyCode> = Vec::new();
        for code in of_layout.chain(plain_letters.map(|(code, _)| code)) {
            if !codes.contains(&code) {
                codes.push(code);
            }
        }
        Some(Self {
            keyboard: Keyboard::new(keys),
            places,
            codes,
            has_text: layout.required_capabilities().text,
        })
    }

    /// Permits characters that no key types to be written as text, if `has_text` is `true`.
    pub(super) fn with_text(mut self, has_text: bool) -> Self {
        self.has_text |= has_text;
        self
    }

    /// Returns the keyboard of the decoder.
    pub(super) fn keyboard(&self) -> &Keyboard {
        &self.keyboard
    }

    /// Returns the capabilities that the filter needs in addition to the events of the layout.
    pub(super) fn capabilities(&self) -> Capabilities {
        let own = [KeyCode::BACKSPACE, KeyCode::SHIFT_LEFT];
        let codes = own.into_iter().chain(self.codes.iter().copied());
        let text = self.has_text.then_some(Capability::Text);
        codes.map(Capability::Key).chain(text).collect()
    }

    /// Returns the character of the pressed key in the base layer, and the position of the press in the plane of the decoder; `None` for
    /// a key that types no character.
    pub(super) fn locate(&self, press: &Press) -> Option<(char, Millimetres)> {
        let mut places = self.places.iter();
        let place = places.find(|place| place.target == press.target)?;
        let at = place.target_from_surface * press.point;
        let [x, y] = place.center;
        Some((place.character, [x + at.x * 1e3, y - at.y * 1e3]))
    }

    /// Returns the board of a key that types a character, if fingers swipe over it, and the smaller extent of the key in millimetres.
    pub(super) fn swiped_board(&self, target: TargetId) -> Option<(usize, f32)> {
        let place = self.places.iter().find(|place| place.target == target)?;
        Some((place.swiped_board?, place.width))
    }

    /// Returns the position of a finger over a board in the plane of the decoder, and its height over the front of the nearest key, in
    /// millimetres; `None` if that is not known.
    pub(super) fn follow(
        &self,
        board: usize,
        finger: Finger,
        (pose, scene): (&HandPose, &Scene),
    ) -> Option<(Millimetres, f32)> {
        let surface = scene.surfaces().get(board)?;
        let world_from_surface = surface.world_from_surface(pose)?;
        let center = world_from_surface.inverse() * trusted_fingertip(pose, finger)?;
        let places = self.places.iter();
        let places = places.filter(|place| place.swiped_board == Some(board));
        let pads = places.map(|place| {
            let pad = place.target_from_surface * center - Vec3::Z * pose.tip_radius;
            (place.own_center, pad)
        });
        let nearest =
            |a: &(_, Vec3), b: &(_, Vec3)| a.1.length_squared().total_cmp(&b.1.length_squared());
        let ([x, y], pad) = pads.min_by(nearest)?;
        Some(([x + pad.x * 1e3, y - pad.y * 1e3], pad.z * 1e3))
    }

    /// Returns the center of the key of a character, ignoring its case; `None` if no key types it.
    pub(super) fn center(&self, character: char) -> Option<Millimetres> {
        let index = self.keyboard.index(lower(character))?;
        Some(self.keyboard.keys()[index].center)
    }

    /// Returns the character in the base layer of the key that types a character, and how far its taps are from that key in the plane
    /// of the decoder, in millimetres to the right.
    pub(super) fn pressed_for(&self, character: char) -> (char, f32) {
        let plain = lower(character);
        if self.places.iter().any(|place| place.character == plain) {
            return (plain, 0.0);
        }
        base_character(character).map_or((plain, 0.0), |base| (base, SHIFTED))
    }

    /// Returns the way in which a character is typed; `None` if it cannot be typed. Where letters share keys, a letter with an accent
    /// that cannot be typed is typed without it: the first letter of its key would be no better.
    pub(super) fn typed(&self, character: char) -> Option<Typed> {
        let by_key = self.typed_by_key(character);
        let typed = by_key.or(self.has_text.then_some(Typed::Character(character)));
        typed.or_else(|| {
            let small = alphabet::plain(lower(character));
            let letter = if character.is_uppercase() {
                small.to_ascii_uppercase()
            } else {
                small
            };
            let is_shared = self.keyboard.has_shared_keys();
            self.typed_by_key(letter).filter(|_| is_shared)
        })
    }

    fn typed_by_key(&self, character: char) -> Option<Typed> {
        [false, true].into_iter().find_map(|shifted| {
            let mut codes = self.codes.iter();
            let code = codes.find(|code| code.us_character(shifted) == Some(character))?;
            Some(Typed::Key(*code, shifted))
        })
    }
}

/// Returns a character in lower case.
pub(super) fn lower(character: char) -> char {
    character.to_lowercase().next().unwrap_or(character)
}

/// Returns the character that an action types on a US keymap; `None` for none or several.
fn character(layout: &Layout, action: KeyAction, shifted: bool) -> Option<char> {
    match action {
        KeyAction::Key(code) => code
            .us_character(shifted)
            .filter(|character| !character.is_control()),
        KeyAction::Text(text) => {
            let mut characters = layout.texts.get(usize::from(text.0))?.chars();
            let first = characters.next()?;
            characters.next().is_none().then_some(first)
        }
        _ => None,
    }
}

/// Returns the characters in lower case that a tap of a key may mean: one, or if `shares_keys` is `true` the letters of a multitap key.
fn characters(layout: &Layout, action: Option<KeyAction>, shares_keys: bool) -> Vec<char> {
    let single = |of_key| character(layout, of_key, false).map(lower);
    let Some(KeyAction::Multitap(MultitapId(index))) = action.filter(|_| shares_keys) else {
        return action.and_then(single).into_iter().collect();
    };
    let multitap = layout.multitaps.keys.get(usize::from(index));
    multitap.map_or(Vec::new(), |key| key.characters_of_tap(single))
}

/// The labels of keys whose character joins the next one, such as the accent of `á`.
const DEAD: [&str; 4] = ["´", "`", "^", "¨"];

/// Returns `true` if the label of a key shows that the receiver has another keymap than the US one: another letter, or an accent.
pub fn shows_other_keymap(layout: &Layout) -> bool {
    layout.keys.iter().any(|key| {
        let Some(KeyAction::Key(code)) = key.action(0) else {
            return false;
        };
        let mut label = key.face.label.chars().map(lower);
        let (Some(shown), None) = (label.next(), label.next()) else {
            return false;
        };
        let typed = code.us_character(false);
        let typed = typed.filter(|typed| !typed.is_control() && *typed != shown);
        typed.is_some_and(|typed| {
            shown.is_alphabetic() || typed.is_alphabetic() || DEAD.contains(&&*key.face.label)
        })
    })
}

/// Returns the character that a key of the US keymap types without Shift, if it types this one with it.
fn base_character(shifted: char) -> Option<char> {
    let mut keys = KeyCode::for_us_character(shifted);
    keys.find_map(|(code, has_shift)| code.us_character(false).filter(|_| has_shift))
}

/// Adds keys for the characters that are typed with Shift or in a layer. They are away from all other keys, because their taps say
/// nothing about the keys below. Characters that are typed with Shift are arranged as their keys are; the others are away from
/// everything.
fn add_elsewhere(layout: &Layout, keys: &mut Vec<Key>) {
    for key in &layout.keys {
        let actions = key.actions.iter().copied().flatten();
        let actions = actions.chain(key.hold_action());
        for (action, shifted) in actions.flat_map(|action| [(action, false), (action, true)]) {
            let Some(character) = character(layout, action, shifted).map(lower) else {
                continue;
            };
            let is_known = keys.iter().any(|known| known.character == character);
            if is_known || keys.len() >= MAX_KEYS {
                continue;
            }
            let base = base_character(character).filter(|_| shifted);
            let below = keys.iter().find(|known| Some(known.character) == base);
            let place =
                below.map(|below| ([below.center[0] + SHIFTED, below.center[1]], below.hand));
            let away = [ELSEWHERE + 100.0 * keys.len() as f32, ELSEWHERE];
            let (center, hand) = place.unwrap_or((away, 0));
            keys.push(Key {
                character,
                center,
                size: [1.0; 2],
                hand,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the hand, 0 for left, that types each of these characters on a layout that comes with the program.
    fn hands(layout: &str, has_two_hands: bool, characters: &str) -> Vec<u8> {
        let mut shipped = Layout::shipped().expect("valid layouts").into_iter();
        let (_, found) = shipped.find(|(name, _)| *name == layout).expect("a layout");
        let keys = TextKeys::new(&found, has_two_hands).expect("letters");
        let hand = |character| {
            let mut all = keys.keyboard().keys().iter();
            let key = all.find(|key| key.character == character);
            key.expect("a key").hand
        };
        characters.chars().map(hand).collect()
    }

    #[test]
    fn a_letter_that_shares_its_key_is_typed_without_an_accent_that_cannot_be_typed() {
        let typed = |layout: &str, has_text: bool, letter: char| {
            let mut shipped = Layout::shipped().expect("valid layouts").into_iter();
            let (_, found) = shipped.find(|(name, _)| *name == layout).expect("a layout");
            let keys = TextKeys::new(&found, false).expect("letters");
            keys.with_text(has_text).typed(letter)
        };
        let o: KeyCode = "O".parse().expect("the name of a key");
        let key = |has_shift: bool| Some(Typed::Key(o, has_shift));
        assert_eq!(typed("phone-pad", false, 'ó'), key(false));
        assert_eq!(typed("phone-pad", false, 'Ó'), key(true));
        assert_eq!(typed("phone-pad", true, 'ó'), Some(Typed::Character('ó')));
        assert_eq!(typed("qwerty-flat", false, 'ó'), None);
    }

    #[test]
    fn each_hand_types_on_its_board_or_its_half_of_a_board() {
        assert_eq!(hands("qwerty-two-flat", true, "qtgyhp"), [0, 0, 0, 1, 1, 1]);
        assert_eq!(hands("qwerty-flat", true, "qtop"), [0, 0, 1, 1]);
        assert_eq!(hands("qwerty-flat", false, "qtop"), [0; 4]);
    }
}
