//! The position of the cursor and the events that move it.

use parry3d::math::{Vec2, Vec3};

use super::motion;
use super::settings::{CursorOutput, PointerSettings};
use crate::device::{DeviceOutput, EventKind};
use crate::time::Timestamp;

/// Fraction of the hand's motion that brings the cursor back to where the hand points after it was held or
/// slow: too little to be noticed (offset recovery, Frees, Kessler & Kay 2007).
const RECOVERY: f32 = 0.2;

/// Rounding to whole pixels lengthens a step by half a diagonal at most.
const ROUNDING_PX: f32 = 1.0;

/// A cursor in pixels: to the right, up and towards the wearer from the left, lower, far corner.
#[derive(Clone, Debug)]
pub(super) struct Cursor {
    output: CursorOutput,
    extent: Vec3,
    max_step_px: f32,
    /// The position, within the range.
    position: Option<Vec3>,
    /// The position emitted last.
    emitted: Option<Vec2>,
    /// Relative motion that is not emitted yet.
    remainder: Vec2,
    /// The sum of all relative motion.
    travelled: Vec2,
}

impl Cursor {
    pub(super) fn new(settings: &PointerSettings) -> Self {
        Self {
            output: settings.output,
            extent: motion::extent(settings),
            max_step_px: settings.max_step_px - ROUNDING_PX,
            position: None,
            emitted: None,
            remainder: Vec2::ZERO,
            travelled: Vec2::ZERO,
        }
    }

    /// Returns its position as fractions of the whole range.
    pub(super) fn fractions(&self) -> Vec3 {
        self.position
            .map_or(Vec3::splat(0.5), |position| position / self.extent)
    }

    /// Returns a position that is comparable between steps, in pixels: that on the screen, or the sum of all
    /// motion if the position on the screen is unknown.
    pub(super) fn travelled(&self) -> Vec2 {
        match self.output {
            CursorOutput::Relative => self.travelled,
            CursorOutput::Absolute | CursorOutput::None => {
                self.position.unwrap_or_default().truncate()
            }
        }
    }

    pub(super) fn move_to(&mut self, position: Vec3) {
        self.position = Some(position);
    }

    /// Sets the position if there is none yet: to `position`, or else to the middle.
    pub(super) fn initialise(&mut self, position: Option<Vec3>) {
        self.position
            .get_or_insert(position.unwrap_or(self.extent * 0.5));
    }

    /// Moves the cursor by `delta`, and a little towards `hand`, the position that the hand points at.
    pub(super) fn move_by(&mut self, delta: Vec3, hand: Option<Vec3>) {
        self.remainder += delta.truncate();
        self.travelled += delta.truncate();
        let Some(position) = self.position else {
            return;
        };
        let moved = position + delta;
        let offset = hand.map_or(Vec3::ZERO, |hand| hand - moved);
        let recovered = offset.clamp_length_max(RECOVERY * delta.length());
        self.position = Some((moved + recovered).clamp(Vec3::ZERO, self.extent));
    }

    /// Holds the cursor at the position emitted last.
    pub(super) fn hold(&mut self) {
        self.remainder = Vec2::ZERO;
        if let (Some(position), Some(emitted)) = (&mut self.position, self.emitted) {
            *position = emitted.extend(position.z);
        }
    }

    /// Emits its motion, limited to the maximum of a step. The rest follows in the next steps.
    pub(super) fn emit(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        match self.output {
            CursorOutput::Absolute => self.emit_position(time, out),
            CursorOutput::Relative => self.emit_motion(time, out),
            CursorOutput::None => {}
        }
    }

    fn emit_position(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let Some(position) = self.position.map(Vec3::truncate) else {
            return;
        };
        let next = match self.emitted {
            Some(emitted) => emitted + (position - emitted).clamp_length_max(self.max_step_px),
            None => position,
        };
        let next = next.round();
        let fractions = next / self.extent.truncate();
        let event = EventKind::MoveTo(fractions.x, 1.0 - fractions.y);
        if self.emitted != Some(next) && out.emit(time, event) {
            self.emitted = Some(next);
        }
    }

    fn emit_motion(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let step = self.remainder.clamp_length_max(self.max_step_px).round();
        let event = EventKind::MoveBy(step.x as i32, -step.y as i32);
        if step != Vec2::ZERO && out.emit(time, event) {
            self.remainder -= step;
        }
    }
}
