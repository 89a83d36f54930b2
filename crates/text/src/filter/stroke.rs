//! A finger from the press of a letter until it is lifted.

use std::time::Duration;

use crate::SwipePath;
use crate::keyboard::Millimetres;
use crate::swipe::distance;

use super::keys::{TextKeys, lower};
use ademan_core::contact::Press;
use ademan_core::hand::{Finger, Side};
use ademan_core::pipeline::press_filter::FilterInput;
use ademan_core::time::Timestamp;

/// The distance from the press, in widths of the key, from which a stroke is a swipe.
const SWIPE_WIDTHS: f32 = 1.5;
/// The limit for a stroke that has lasted for [`SLOW_TIME`]: a tap is over by then.
const SLOW_SWIPE_WIDTHS: f32 = 1.0;
const SLOW_TIME: Duration = Duration::from_millis(150);

/// A finger this high over the fronts, in millimetres, is lifted; a lower one may waver.
const LIFT_HEIGHT: f32 = 2.0;
/// A finger that is over the fronts for this time is lifted.
const LIFT_TIME: Duration = Duration::from_millis(100);

/// A finger that is not seen for this time is lost, as for its contacts.
const LOSS_TIME: Duration = Duration::from_millis(70);
/// A finger that moves this far in one step, in millimetres, has jumped.
const JUMP: f32 = 80.0;
/// The longest swipe.
const MAX_TIME: Duration = Duration::from_secs(10);

/// A finger that has pressed a letter of a board with swipes.
#[derive(Clone, Debug)]
pub(super) struct Stroke {
    pub(super) side: Side,
    pub(super) finger: Finger,
    board: usize,
    character: char,
    width: f32,
    path: SwipePath,
    /// The last known position.
    last: Millimetres,
    /// The points of the path until the finger was last behind the fronts.
    pressed_points: usize,
    pub(super) start: Timestamp,
    seen: Timestamp,
    above_since: Option<Timestamp>,
    /// `true` if it has gone too far to be a tap.
    pub(super) is_swipe: bool,
    /// `true` if the letter was typed.
    is_typed: bool,
    /// `true` if it is too long for a word.
    is_void: bool,
}

/// The state of a stroke after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// The finger is down.
    Down,
    /// The finger was lifted.
    Lifted,
    /// The finger is no longer known.
    Lost,
}

impl Stroke {
    /// Begins a stroke with a press at a position in the plane of the decoder; `None` on a board without swipes.
    pub(super) fn new(
        press: &Press,
        (character, position): (char, Millimetres),
        keys: &TextKeys,
    ) -> Option<Self> {
        let (board, width) = keys.swiped_board(press.target)?;
        let mut path = SwipePath::default();
        path.push(position);
        Some(Self {
            side: press.side,
            finger: press.finger,
            board,
            character,
            width,
            path,
            last: position,
            pressed_points: 1,
            start: press.time,
            seen: press.time,
            above_since: None,
            is_swipe: false,
            is_typed: false,
            is_void: false,
        })
    }

    /// Notes that a character was typed. Returns `false` if it is not the pressed one, so that it is not a letter to be replaced.
    pub(super) fn note_typed(&mut self, character: char) -> bool {
        let is_own = !self.is_typed && lower(character) == self.character;
        self.is_typed |= is_own;
        is_own
    }

    /// Follows the finger in a step of its hand.
    pub(super) fn follow(&mut self, input: &FilterInput, keys: &TextKeys) -> Progress {
        let contact = input.contact;
        let seen = contact.and_then(|contact| keys.follow(self.board, self.finger, contact));
        let Some((point, height)) = seen else {
            let is_lost = input.time.since(self.seen) > LOSS_TIME;
            return if is_lost {
                Progress::Lost
            } else {
                Progress::Down
            };
        };
        if distance(self.last, point) > JUMP {
            return Progress::Lost;
        }
        self.last = point;
        self.seen = input.time;
        let lasted = input.time.since(self.start);
        self.is_void |= !self.path.push(point) || lasted > MAX_TIME;
        if height >= 0.0 {
            let since = *self.above_since.get_or_insert(input.time);
            let is_lifted =
                !self.is_swipe || height > LIFT_HEIGHT || input.time.since(since) > LIFT_TIME;
            return if is_lifted {
                Progress::Lifted
            } else {
                Progress::Down
            };
        }
        self.above_since = None;
        self.pressed_points = self.path.points().len();
        let first = self.path.points().first();
        let moved = first.map_or(0.0, |&first| distance(first, point)) / self.width;
        self.is_swipe |= moved > SWIPE_WIDTHS || moved > SLOW_SWIPE_WIDTHS && lasted > SLOW_TIME;
        Progress::Down
    }

    /// Returns the path of a swipe whose letter was typed.
    pub(super) fn path(&self) -> Option<&[Millimetres]> {
        let is_usable = self.is_swipe && self.is_typed && !self.is_void;
        is_usable.then(|| &self.path.points()[..self.pressed_points])
    }
}
