//! The cursors on the screen: the one of a pipeline, and an ideal one.

use parry3d::math::Vec2;

use super::person::Jacobian;
use crate::capture::Reading;
use crate::device::{EventKind, Events, KeyCode};
use crate::pipeline::Pipeline;
use crate::sim::fluent::FluentHand;
use crate::time::Timestamp;
use crate::trials::session::no_reading;
use crate::trials::station::Station;

/// A cursor on a screen, in pixels from the upper left corner.
pub(super) trait Cursor {
    /// Passes the state of a hand on: `by` is its displacement from the middle, and `is_down` is `true` while it clicks. Returns
    /// `true` if the left button went down.
    fn step(&mut self, hand: &mut FluentHand, seconds: [f64; 2], by: Vec2, is_down: bool) -> bool;

    /// Returns the position.
    fn place(&self) -> [f64; 2];
}

/// The cursor that the events of a pipeline move.
pub(super) struct ScreenCursor {
    pipeline: Pipeline,
    events: Events,
    /// The latest reading. It is large, and reused.
    reading: Reading,
    screen: [f64; 2],
    place: [f64; 2],
}

impl ScreenCursor {
    /// Creates a cursor in the middle of a screen, with a pipeline that has seen nothing.
    pub(super) fn new(station: &Station, screen: [f64; 2]) -> Self {
        Self {
            pipeline: station.pipeline(),
            events: Events::new(),
            reading: no_reading(),
            screen,
            place: screen.map(|size| size / 2.0),
        }
    }

    fn move_to(&mut self, place: [f64; 2]) {
        let inside = |axis: usize| place[axis].clamp(0.0, self.screen[axis]);
        self.place = [inside(0), inside(1)];
    }
}

impl Cursor for ScreenCursor {
    fn step(
        &mut self,
        hand: &mut FluentHand,
        [seconds, period]: [f64; 2],
        _by: Vec2,
        _is_down: bool,
    ) -> bool {
        let reading = &mut self.reading;
        if !hand.sample(seconds, period, &mut reading.sample) {
            return false;
        }
        reading.time = Timestamp((seconds * 1e6).round() as u64);
        reading.side = Some(hand.side());
        self.events.clear();
        if self.pipeline.step(reading, &mut self.events).is_err() {
            return false;
        }
        let mut has_clicked = false;
        for event in std::mem::take(&mut self.events) {
            match event.kind {
                EventKind::MoveBy(x, y) => {
                    self.move_to([self.place[0] + f64::from(x), self.place[1] + f64::from(y)]);
                }
                EventKind::MoveTo(x, y) => {
                    self.move_to([f64::from(x) * self.screen[0], f64::from(y) * self.screen[1]]);
                }
                EventKind::KeyDown(KeyCode::MOUSE_LEFT) => has_clicked = true,
                _ => {}
            }
        }
        has_clicked
    }

    fn place(&self) -> [f64; 2] {
        self.place
    }
}

/// A cursor that follows the intended displacement at once, without tremor, noise and filters, and clicks in time.
pub(super) struct IdealCursor {
    screen: [f64; 2],
    jacobian: Jacobian,
    place: [f64; 2],
    was_down: bool,
}

impl IdealCursor {
    /// Creates a cursor in the middle of a screen.
    pub(super) fn new(screen: [f64; 2], jacobian: Jacobian) -> Self {
        Self {
            screen,
            jacobian,
            place: screen.map(|size| size / 2.0),
            was_down: false,
        }
    }
}

impl Cursor for IdealCursor {
    fn step(&mut self, _: &mut FluentHand, _: [f64; 2], by: Vec2, is_down: bool) -> bool {
        let moved = self.jacobian.apply([by.x, by.y].map(f64::from));
        let inside = |axis: usize| {
            let size = self.screen[axis];
            (size / 2.0 + moved[axis]).clamp(0.0, size)
        };
        self.place = [inside(0), inside(1)];
        let has_clicked = is_down && !self.was_down;
        self.was_down = is_down;
        has_clicked
    }

    fn place(&self) -> [f64; 2] {
        self.place
    }
}
