//! Pointer motion that waits to be sent: it is coalesced, and the wheel turns by whole detents.

use arrayvec::ArrayVec;

use ademan_core::device::{DETENT, EventKind};

/// Maximum number of detents per request. Each takes time, and releases come after them in the queue.
const MAX_DETENTS: i32 = 50;

/// Maximum relative motion per request, in pixels: X11 has 16 bits for it.
const MAX_PIXELS: i32 = i16::MAX as i32;

/// An action that leaves no key or button pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StatelessAction {
    /// Moves the pointer to the right and down, by at most 32767 pixels each.
    MoveBy(i32, i32),
    /// Moves the pointer to a position, as fractions 0..=1 of the screen from the left and from the top.
    MoveTo(f32, f32),
    /// Turns the wheel to the right and up, by at most 50 detents each.
    Scroll(i32, i32),
}

/// Pointer motion and wheel rotation that have not been sent.
#[derive(Debug, Default)]
pub struct PendingMotion {
    position: Option<(f32, f32)>,
    relative: (i32, i32),
    wheel: (i32, i32),
}

impl PendingMotion {
    /// Adds a motion: the last position replaces earlier motion; relative motion after it and scrolls are summed.
    /// Other events and positions that are not finite are ignored.
    pub fn push(&mut self, event: EventKind) {
        match event {
            EventKind::MoveTo(x, y) if x.is_finite() && y.is_finite() => {
                self.position = Some((x.clamp(0.0, 1.0), y.clamp(0.0, 1.0)));
                self.relative = (0, 0);
            }
            EventKind::MoveBy(x, y) => self.relative = sum(self.relative, (x, y)),
            EventKind::Scroll(x, y) => self.wheel = sum(self.wheel, (x, y)),
            _ => {}
        }
    }

    /// Removes and returns all motion. Less than one detent of the wheel remains.
    pub fn drain(&mut self) -> ArrayVec<StatelessAction, 3> {
        let position = self.position.take();
        let (x, y) = std::mem::take(&mut self.relative);
        let (x, y) = (clamp(x, MAX_PIXELS), clamp(y, MAX_PIXELS));
        let detents = (self.wheel.0 / DETENT, self.wheel.1 / DETENT);
        self.wheel = (self.wheel.0 % DETENT, self.wheel.1 % DETENT);
        let (right, up) = (clamp(detents.0, MAX_DETENTS), clamp(detents.1, MAX_DETENTS));
        let actions = [
            position.map(|(to_x, to_y)| StatelessAction::MoveTo(to_x, to_y)),
            ((x, y) != (0, 0)).then_some(StatelessAction::MoveBy(x, y)),
            ((right, up) != (0, 0)).then_some(StatelessAction::Scroll(right, up)),
        ];
        actions.into_iter().flatten().collect()
    }
}

fn clamp(value: i32, limit: i32) -> i32 {
    value.clamp(-limit, limit)
}

fn sum(a: (i32, i32), b: (i32, i32)) -> (i32, i32) {
    (a.0.saturating_add(b.0), a.1.saturating_add(b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drained(motion: &mut PendingMotion, events: &[EventKind]) -> Vec<StatelessAction> {
        for event in events {
            motion.push(*event);
        }
        motion.drain().to_vec()
    }

    #[test]
    fn relative_motion_is_summed_and_the_last_position_replaces_earlier_motion() {
        let mut motion = PendingMotion::default();
        let relative = [EventKind::MoveBy(3, -2), EventKind::MoveBy(4, 1)];
        assert_eq!(
            drained(&mut motion, &relative),
            [StatelessAction::MoveBy(7, -1)]
        );
        let positions = [
            EventKind::MoveTo(0.1, 0.1),
            EventKind::MoveBy(9, 9),
            EventKind::MoveTo(0.5, 2.0),
            EventKind::MoveBy(1, 0),
        ];
        let expected = [
            StatelessAction::MoveTo(0.5, 1.0),
            StatelessAction::MoveBy(1, 0),
        ];
        assert_eq!(drained(&mut motion, &positions), expected);
        assert_eq!(drained(&mut motion, &[]), []);
    }

    #[test]
    fn the_wheel_turns_by_whole_detents_and_keeps_the_remainder() {
        let mut motion = PendingMotion::default();
        assert_eq!(drained(&mut motion, &[EventKind::Scroll(-60, 100)]), []);
        let second = drained(&mut motion, &[EventKind::Scroll(-60, 150)]);
        assert_eq!(second, [StatelessAction::Scroll(-1, 2)]);
        let back = drained(&mut motion, &[EventKind::Scroll(0, -130)]);
        assert_eq!(back, [StatelessAction::Scroll(0, -1)]);
    }

    #[test]
    fn nan_is_ignored_and_large_motion_is_limited() {
        let mut motion = PendingMotion::default();
        let not_a_number = [EventKind::MoveTo(f32::NAN, 0.5)];
        assert_eq!(drained(&mut motion, &not_a_number), []);
        let large = [
            EventKind::MoveBy(i32::MAX, i32::MIN),
            EventKind::MoveBy(1, -1),
            EventKind::Scroll(i32::MIN, i32::MAX),
        ];
        let expected = [
            StatelessAction::MoveBy(MAX_PIXELS, -MAX_PIXELS),
            StatelessAction::Scroll(-50, 50),
        ];
        assert_eq!(drained(&mut motion, &large), expected);
    }
}
