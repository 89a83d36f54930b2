//! Keys and taps, in millimetres in the plane of the board: x to the right, y down.

use serde::{Deserialize, Serialize};

/// A position or an offset in millimetres.
pub type Millimetres = [f32; 2];

/// The most keys of a keyboard. More are ignored.
pub const MAX_KEYS: usize = 128;

/// A key that types a character.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Key {
    /// The character, in lower case; a space for the space bar.
    pub character: char,
    /// The center.
    pub center: Millimetres,
    /// Width and height.
    pub size: Millimetres,
    /// The group of keys that one hand types, 0 or 1: their drift is tracked together.
    pub hand: u8,
}

/// The coordinate to the wearer of characters that no finger taps in the base layer, in millimetres: beyond every board.
pub(crate) const ELSEWHERE: f32 = 20_000.0;

impl Key {
    /// Returns `true` if its taps tell where the finger was. A character that another layer types is given to the center of a key
    /// beyond all boards.
    pub(crate) fn has_place(&self) -> bool {
        self.center[1] < ELSEWHERE
    }
}

/// A press of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// The position of the fingertip.
    pub position: Millimetres,
    /// The character that the key typed. Without it, the key is the nearest one.
    pub typed: Option<char>,
}

impl Tap {
    /// Makes a tap of the nearest key.
    pub fn at(x: f32, y: f32) -> Self {
        Self {
            position: [x, y],
            typed: None,
        }
    }
}

/// The keys of a keyboard that type characters.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyboard {
    keys: Vec<Key>,
    /// The area of all keys together in mm².
    area: f32,
    has_shared_keys: bool,
}

impl Keyboard {
    /// Makes a keyboard. Keys whose position or size is not finite, and those beyond [`MAX_KEYS`], are left out.
    pub fn new(keys: impl IntoIterator<Item = Key>) -> Self {
        let sane = |key: &Key| {
            let numbers = [key.center, key.size];
            let finite = numbers
                .as_flattened()
                .iter()
                .all(|number| number.is_finite());
            finite && key.size.iter().all(|&length| length > 0.0)
        };
        let keys: Vec<Key> = keys.into_iter().filter(sane).take(MAX_KEYS).collect();
        let area = keys
            .iter()
            .map(|key| key.size[0] * key.size[1])
            .sum::<f32>();
        let letters = keys.iter().filter(|key| key.character.is_alphabetic());
        let mut centers: Vec<Millimetres> = letters.map(|key| key.center).collect();
        centers.sort_by(|[ax, ay], [bx, by]| ax.total_cmp(bx).then(ay.total_cmp(by)));
        let has_shared_keys = centers.windows(2).any(|pair| pair[0] == pair[1]);
        Self {
            keys,
            area: area.max(1.0),
            has_shared_keys,
        }
    }

    /// Returns the keys.
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// Returns `true` if letters share a key, that is, have the same center, as on the keypad of a phone. A tap then tells the key, and
    /// only the words tell the letter.
    pub fn has_shared_keys(&self) -> bool {
        self.has_shared_keys
    }

    /// Returns the area of all keys in mm².
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Returns the index of the key of a character.
    pub fn index(&self, character: char) -> Option<usize> {
        self.keys.iter().position(|key| key.character == character)
    }

    /// Returns the index of the nearest key: the one that has the position on it, or else the one whose edge is nearest.
    pub fn nearest(&self, position: Millimetres) -> Option<usize> {
        let distance = |key: &Key| {
            let beyond = |axis: usize| {
                let from_center = (position[axis] - key.center[axis]).abs();
                (from_center - key.size[axis] / 2.0).max(0.0)
            };
            let from_center = |axis: usize| (position[axis] - key.center[axis]).powi(2);
            // The distance of the centers decides between keys that overlap.
            (beyond(0).hypot(beyond(1)), from_center(0) + from_center(1))
        };
        let keys = self.keys.iter().map(distance).enumerate();
        keys.min_by(|a, b| a.1.0.total_cmp(&b.1.0).then(a.1.1.total_cmp(&b.1.1)))
            .map(|(index, _)| index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(character: char, x: f32, width: f32) -> Key {
        Key {
            character,
            center: [x, 0.0],
            size: [width, 10.0],
            hand: 0,
        }
    }

    #[test]
    fn the_nearest_key_has_the_tap_on_it_or_its_edge_nearest() {
        let keyboard = Keyboard::new([key('a', 0.0, 10.0), key(' ', 40.0, 60.0)]);
        let nearest = |x: f32, y: f32| {
            keyboard
                .nearest([x, y])
                .map(|key| keyboard.keys()[key].character)
        };
        assert_eq!(nearest(4.0, 3.0), Some('a'));
        // Nearer to the center of `a`, and on the space bar.
        assert_eq!(nearest(12.0, 0.0), Some(' '));
        assert_eq!(nearest(-80.0, 90.0), Some('a'));
        assert_eq!(Keyboard::new([]).nearest([0.0, 0.0]), None);
    }

    #[test]
    fn keys_without_a_place_are_left_out() {
        let keyboard = Keyboard::new([
            key('a', f32::NAN, 10.0),
            key('b', 0.0, 0.0),
            key('c', 0.0, 1.0),
        ]);
        assert_eq!(keyboard.keys().len(), 1);
        assert_eq!(keyboard.index('c'), Some(0));
    }
}
