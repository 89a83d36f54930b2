//! The places of keys that type a character, in millimetres.

use parry3d::math::{Vec2, Vec3};

use crate::contact::TargetId;
use crate::contact::surface::Surface;
use crate::contact::sweep::distance_from_outline;
use crate::device::{KeyAction, KeyCode, MultitapId};
use crate::layout::Layout;

/// A tap of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touch {
    /// The character that the key types; the first letter of a multitap key.
    pub(crate) character: char,
    /// The index of the board.
    pub(crate) board: usize,
    /// The place on it, in millimetres.
    pub(crate) at: Vec2,
}

#[derive(Clone, Debug)]
struct KeyPlace {
    target: TargetId,
    character: char,
    board: usize,
    center: Vec2,
}

/// The keys of a layout that type a character in the base layer. A multitap key has a place for each of its letters.
#[derive(Clone, Debug)]
pub(crate) struct KeyPlaces(Vec<KeyPlace>);

impl KeyPlaces {
    /// Finds the keys. A decoder that `finds_letters` reads multitap keys, which are left out otherwise.
    pub(crate) fn new(layout: &Layout, finds_letters: bool) -> Self {
        let mut places = Vec::new();
        for (board, own) in layout.boards.iter().enumerate() {
            for key in &layout.keys[own.keys.clone()] {
                let characters = match key.action(0) {
                    Some(KeyAction::Multitap(id)) if finds_letters => letters(layout, id),
                    action => action.and_then(character).into_iter().collect(),
                };
                places.extend(characters.into_iter().map(|character| KeyPlace {
                    target: key.face.target,
                    character,
                    board,
                    center: key.face.row_position * 1e3,
                }));
            }
        }
        Self(places)
    }

    fn place(&self, target: TargetId) -> Option<&KeyPlace> {
        self.0.iter().find(|place| place.target == target)
    }

    /// Returns the tap of a target at a point from its center, in metres; `None` if its key types nothing.
    pub(crate) fn touch(&self, target: TargetId, point: Vec2) -> Option<Touch> {
        let place = self.place(target)?;
        Some(Touch {
            character: place.character,
            board: place.board,
            at: place.center + point * 1e3,
        })
    }

    /// Returns the board and the center of the key of a character, in millimetres.
    pub(crate) fn center(&self, character: char) -> Option<(usize, Vec2)> {
        let place = self.0.iter().find(|place| place.character == character)?;
        Some((place.board, place.center))
    }
}

/// Returns the target of a surface that is nearest to a point on it: the one whose outline is, then the one whose center is.
pub(crate) fn nearest_target(surface: &Surface, point: Vec3) -> Option<TargetId> {
    let distances = surface.targets().map(|(id, target)| {
        let at = target.surface_from_target.inverse_transform_point(point);
        let beside = distance_from_outline(target.shape, at.truncate());
        (beside, at.truncate().length_squared(), id)
    });
    let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    nearest.map(|(_, _, id)| id)
}

/// Returns the character that an action types; a Backspace too.
fn character(action: KeyAction) -> Option<char> {
    match action {
        KeyAction::Key(KeyCode::BACKSPACE) => Some('\u{8}'),
        KeyAction::Key(code) => {
            let typed = code.us_character(false);
            typed.filter(|typed| !typed.is_control())
        }
        _ => None,
    }
}

/// Returns the characters that one tap of a multitap key may mean: its letters, or its first sign.
fn letters(layout: &Layout, id: MultitapId) -> Vec<char> {
    let key = layout.multitaps.keys.get(usize::from(id.0));
    key.map_or(Vec::new(), |key| key.characters_of_tap(character))
}

/// Adds a character to a text; a Backspace removes the last one.
pub(super) fn write(text: &mut String, character: char) {
    match character {
        '\u{8}' => _ = text.pop(),
        other => text.push(other),
    }
}
