//! Pointer motion on its way to a desktop: what has to wait is joined, and the wheel turns in whole clicks.

use arrayvec::ArrayVec;

use crate::device::EventKind;

/// A click of the wheel, in the unit of [`Action::Scroll`].
const CLICK: i32 = 120;

/// The most clicks in one go; each takes time, and releases come after them.
const MOST_CLICKS: i32 = 50;

/// The farthest motion in one go, in pixels: X11 takes 16 bits.
const FARTHEST: i32 = i16::MAX as i32;

/// Something that is over once it is done: it leaves nothing down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StatelessAction {
    /// Writes a character.
    Write(char),
    /// Moves the pointer to the right and down, in pixels: at most 32767 each way.
    MoveBy(i32, i32),
    /// Brings it to a place on the screen, 0..=1 from the left and from the top.
    MoveTo(f32, f32),
    /// Turns the wheel to the right and up, in clicks: at most 50 each way.
    Scroll(i32, i32),
}

/// Motion that has not gone out yet.
#[derive(Debug, Default)]
pub struct PendingMotion {
    place: Option<(f32, f32)>,
    by: (i32, i32),
    wheel: (i32, i32),
}

impl PendingMotion {
    /// Adds a motion to what waits: the last place counts, the ways and the turns after it add up.
    /// What is no motion, or no number, changes nothing.
    pub fn add(&mut self, action: EventKind) {
        match action {
            EventKind::MoveTo(x, y) if x.is_finite() && y.is_finite() => {
                self.place = Some((x.clamp(0.0, 1.0), y.clamp(0.0, 1.0)));
                self.by = (0, 0);
            }
            EventKind::MoveBy(x, y) => self.by = sum(self.by, (x, y)),
            EventKind::Scroll(x, y) => self.wheel = sum(self.wheel, (x, y)),
            _ => {}
        }
    }

    /// Takes out what is to be done now; less than a click of the wheel stays for the next turn.
    pub fn drain(&mut self) -> ArrayVec<StatelessAction, 3> {
        let place = self
            .place
            .take()
            .map(|(x, y)| StatelessAction::MoveTo(x, y));
        let (x, y) = std::mem::take(&mut self.by);
        let way = (x.clamp(-FARTHEST, FARTHEST), y.clamp(-FARTHEST, FARTHEST));
        let way = (way != (0, 0)).then_some(StatelessAction::MoveBy(way.0, way.1));
        let clicks = (self.wheel.0 / CLICK, self.wheel.1 / CLICK);
        self.wheel = (self.wheel.0 % CLICK, self.wheel.1 % CLICK);
        let capped = |clicks: i32| clicks.clamp(-MOST_CLICKS, MOST_CLICKS);
        let turn =
            (clicks != (0, 0)).then(|| StatelessAction::Scroll(capped(clicks.0), capped(clicks.1)));
        [place, way, turn].into_iter().flatten().collect()
    }
}

fn sum(a: (i32, i32), b: (i32, i32)) -> (i32, i32) {
    (a.0.saturating_add(b.0), a.1.saturating_add(b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(motion: &mut PendingMotion, actions: &[EventKind]) -> Vec<StatelessAction> {
        for action in actions {
            motion.add(*action);
        }
        motion.drain().to_vec()
    }

    #[test]
    fn ways_add_up_and_the_last_place_counts() {
        let mut motion = PendingMotion::default();
        let ways = [EventKind::MoveBy(3, -2), EventKind::MoveBy(4, 1)];
        assert_eq!(taken(&mut motion, &ways), [StatelessAction::MoveBy(7, -1)]);
        let places = [
            EventKind::MoveTo(0.1, 0.1),
            EventKind::MoveBy(9, 9),
            EventKind::MoveTo(0.5, 2.0),
            EventKind::MoveBy(1, 0),
        ];
        let expected = [
            StatelessAction::MoveTo(0.5, 1.0),
            StatelessAction::MoveBy(1, 0),
        ];
        assert_eq!(taken(&mut motion, &places), expected);
        assert_eq!(taken(&mut motion, &[]), []);
    }

    #[test]
    fn the_wheel_turns_in_whole_clicks_and_keeps_the_rest() {
        let mut motion = PendingMotion::default();
        assert_eq!(taken(&mut motion, &[EventKind::Scroll(-60, 100)]), []);
        let second = taken(&mut motion, &[EventKind::Scroll(-60, 150)]);
        assert_eq!(second, [StatelessAction::Scroll(-1, 2)]);
        let back = taken(&mut motion, &[EventKind::Scroll(0, -130)]);
        assert_eq!(back, [StatelessAction::Scroll(0, -1)]);
    }

    #[test]
    fn no_number_moves_nothing_and_a_huge_one_no_farther_than_allowed() {
        let mut motion = PendingMotion::default();
        assert_eq!(taken(&mut motion, &[EventKind::MoveTo(f32::NAN, 0.5)]), []);
        let huge = [
            EventKind::MoveBy(i32::MAX, i32::MIN),
            EventKind::MoveBy(1, -1),
            EventKind::Scroll(i32::MIN, i32::MAX),
        ];
        let expected = [
            StatelessAction::MoveBy(FARTHEST, -FARTHEST),
            StatelessAction::Scroll(-50, 50),
        ];
        assert_eq!(taken(&mut motion, &huge), expected);
    }
}
