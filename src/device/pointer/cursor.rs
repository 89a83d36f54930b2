//! Where the cursor is, and what is told of it.

use parry3d::math::{Vec2, Vec3};

use super::motion;
use super::settings::{CursorOutput, PointerSettings};
use crate::device::{DeviceOutput, EventKind};
use crate::time::Timestamp;

/// The share of the hand's motion that brings the cursor back to where the hand points, after it was held
/// still or slow: so slowly that it is not seen (offset recovery, Frees, Kessler & Kay 2007).
const RECOVERS: f32 = 0.2;

/// Rounding to whole pixels makes a step longer by at most half a diagonal.
const ROUNDING: f32 = 1.0;

/// A cursor in pixels to the right, up and towards the wearer from the left, lower and far corner.
#[derive(Clone, Debug)]
pub(super) struct Cursor {
    moves: CursorOutput,
    extent: Vec3,
    max_step: f32,
    /// Where it should be, within the range.
    aim: Option<Vec3>,
    /// Where the receiver was told to bring it.
    told: Option<Vec2>,
    /// How far it is to go by.
    owed: Vec2,
    /// How far it went in all, for those who ask whether it rests.
    gone: Vec2,
}

impl Cursor {
    pub(super) fn new(settings: &PointerSettings) -> Self {
        Self {
            moves: settings.output,
            extent: motion::extent(settings),
            max_step: settings.max_step_px - ROUNDING,
            aim: None,
            told: None,
            owed: Vec2::ZERO,
            gone: Vec2::ZERO,
        }
    }

    /// Where it is: shares of the whole range.
    pub(super) fn shares(&self) -> Vec3 {
        self.aim.map_or(Vec3::splat(0.5), |aim| aim / self.extent)
    }

    /// Where it is on the screen, or how far it went where that is not known, in pixels.
    pub(super) fn way(&self) -> Vec2 {
        match self.moves {
            CursorOutput::Relative => self.gone,
            CursorOutput::Absolute | CursorOutput::None => self.aim.unwrap_or_default().truncate(),
        }
    }

    /// Brings it to a place.
    pub(super) fn put(&mut self, place: Vec3) {
        self.aim = Some(place);
    }

    /// The same where it has none; without a place, to the middle.
    pub(super) fn put_if_new(&mut self, place: Option<Vec3>) {
        self.aim.get_or_insert(place.unwrap_or(self.extent * 0.5));
    }

    /// Moves it by so much; `hand` is where the hand points.
    pub(super) fn advance(&mut self, by: Vec3, hand: Option<Vec3>) {
        self.owed += by.truncate();
        self.gone += by.truncate();
        let Some(aim) = self.aim else {
            return;
        };
        let moved = aim + by;
        let off = hand.map_or(Vec3::ZERO, |hand| hand - moved);
        let back = off.clamp_length_max(RECOVERS * by.length());
        self.aim = Some((moved + back).clamp(Vec3::ZERO, self.extent));
    }

    /// Lets it stay where the receiver has it.
    pub(super) fn hold(&mut self) {
        self.owed = Vec2::ZERO;
        if let (Some(aim), Some(told)) = (&mut self.aim, self.told) {
            *aim = told.extend(aim.z);
        }
    }

    /// Tells how it moves, no further than it may in a frame; what is left follows in the next.
    pub(super) fn tell(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        match self.moves {
            CursorOutput::Absolute => self.tell_place(time, out),
            CursorOutput::Relative => self.tell_step(time, out),
            CursorOutput::None => {}
        }
    }

    fn tell_place(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let Some(aim) = self.aim.map(Vec3::truncate) else {
            return;
        };
        let next = match self.told {
            Some(told) => told + (aim - told).clamp_length_max(self.max_step),
            None => aim,
        };
        let next = next.round();
        let shares = next / self.extent.truncate();
        let action = EventKind::MoveTo(shares.x, 1.0 - shares.y);
        if self.told != Some(next) && out.emit(time, action) {
            self.told = Some(next);
        }
    }

    fn tell_step(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let step = self.owed.clamp_length_max(self.max_step).round();
        let action = EventKind::MoveBy(step.x as i32, -step.y as i32);
        if step != Vec2::ZERO && out.emit(time, action) {
            self.owed -= step;
        }
    }
}
