//! A person who sees a cursor and moves it to targets.

use std::collections::VecDeque;

use parry3d::math::Vec2;

use super::cursor::Cursor;
use crate::device::pointer::PointerSettings;
use crate::device::pointer::mode::RateControl;
use crate::measures::distance;
use crate::people::Draw;
use crate::sim::fluent::{FluentHand, PointingPosture};

/// The time from a picture of the cursor to a movement that uses it, in seconds: 100 to 135 ms (Carlton 1981 ?).
const DELAY: f64 = 0.1;
/// The scatter of a movement along its way, as a part of the distance for each millimetre of the scatter of taps, and the part of it
/// across: 4 to 7 mm give 6 to 10 % ?.
const SCATTER_PER_MM: f64 = 0.014;
const ACROSS: f64 = 0.5;
/// The part of a target within which the cursor counts as on it: people do not click at the border ?.
const AIM: f64 = 0.8;
/// The longest time for a target, in seconds.
const TIMEOUT: f64 = 6.0;
/// Clicks that are tried on a target, and the growth of their depth.
const TRIES: u32 = 3;
const STRONGER: f32 = 1.25;
/// The time at rest before the first target, in seconds: output is armed, or the pointer is placed.
const CLEAR: f64 = 0.7;
const PLACED: f64 = 2.5;
/// The time of a movement that tries the cursor, in seconds.
const TRY: f64 = 0.35;
/// The longest time for which a person waits until the cursor rests, in seconds.
const SETTLING: f64 = 0.3;
/// The motion of a cursor at rest within 30 ms, as a part of the target.
const REST: f64 = 0.03;
/// The parts of the difference that a movement must have for the person to learn from it: a small one is noise.
const TELLING: f64 = 0.1;

/// The longest short and the longest middle movement, in pixels.
const LENGTHS: [f64; 2] = [60.0, 240.0];

/// With a velocity: the time in which the remaining way would be made, the time of the hand to a new displacement, the part of the highest
/// velocity that people use, and the time for which an error of the velocity lasts, in seconds ?.
const APPROACH: f64 = 0.25;
const HAND_TIME: f64 = 0.06;
const FASTEST: f64 = 0.9;
const ERROR_TIME: f64 = 0.25;

/// A click.
#[derive(Clone, Debug)]
pub(super) struct Clicked {
    /// The position of the cursor at the beginning of the click.
    pub(super) meant: [f64; 2],
    /// The position when the button went down.
    pub(super) place: [f64; 2],
    /// The time then, in seconds.
    pub(super) seconds: f64,
    /// The positions of the cursor since the last click, this click included.
    pub(super) path: Vec<[f64; 2]>,
}

/// The motion of the cursor, in pixels to the right and down, for displacements of the hand to the right and up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jacobian([[f64; 2]; 2]);

impl Jacobian {
    /// Returns the motion of the cursor for a displacement.
    pub(super) fn apply(&self, by: [f64; 2]) -> [f64; 2] {
        self.0.map(|row| row[0] * by[0] + row[1] * by[1])
    }

    /// Returns the displacement for a motion; `None` if the cursor does not follow in both directions.
    fn solve(&self, way: [f64; 2]) -> Option<[f64; 2]> {
        let [[a, b], [c, d]] = self.0;
        let determinant = a * d - b * c;
        let by = [
            (d * way[0] - b * way[1]) / determinant,
            (a * way[1] - c * way[0]) / determinant,
        ];
        by.iter().all(|it| it.is_finite()).then_some(by)
    }

    /// Learns from a displacement and the motion that it made: the least change that explains it (Broyden 1965), half of it.
    fn learn(&mut self, by: [f64; 2], way: [f64; 2]) {
        let expected = self.apply(by);
        let squared = by[0] * by[0] + by[1] * by[1];
        for (row, axis) in self.0.iter_mut().zip(0..) {
            for (entry, shift) in row.iter_mut().zip(by) {
                *entry += 0.5 * (way[axis] - expected[axis]) * shift / squared;
            }
        }
    }
}

/// A movement of the hand, and the time of a click.
#[derive(Clone, Copy)]
struct Way {
    from: Vec2,
    to: Vec2,
    start: f64,
    duration: f64,
}

/// A person with a hand at a pointer.
pub(super) struct Pointing<'a, C> {
    hand: &'a mut FluentHand,
    cursor: C,
    posture: PointingPosture,
    draw: Draw,
    /// The scatter of a movement along its way, as a part of the distance.
    scatter: f64,
    period: f64,
    number: u64,
    way: Way,
    /// The times of the lowest point of a click and of its end, in seconds.
    down: [f64; 2],
    /// The positions of the cursor in the last moments, the latest one last.
    seen: VecDeque<[f64; 2]>,
    /// The positions of the cursor since the last click.
    path: Vec<[f64; 2]>,
    /// The person's knowledge of the cursor, for short, middle and long movements: many pointers are faster in a fast movement.
    /// `None` for a cursor whose velocity follows the hand.
    known: Option<[Jacobian; LENGTHS.len() + 1]>,
}

impl<'a, C: Cursor> Pointing<'a, C> {
    /// Moves the hand to the middle of the range, waits until the pointer is ready, and tries the cursor in both directions; `None` if
    /// the hand cannot use the pointer.
    pub(super) fn begin(
        hand: &'a mut FluentHand,
        cursor: C,
        settings: &PointerSettings,
        (seed, period): (u64, f64),
        waits: bool,
    ) -> Option<Self> {
        hand.restart(seed);
        let posture = hand.begin_pointing(settings)?;
        let [x, y] = hand.person().scatter;
        let rest = Way {
            from: Vec2::ZERO,
            to: Vec2::ZERO,
            start: 0.0,
            duration: period,
        };
        let mut pointing = Self {
            scatter: SCATTER_PER_MM * (x + y) / 2.0,
            draw: Draw::new(seed, 0x9017),
            seen: VecDeque::from([cursor.place()]),
            hand,
            cursor,
            posture,
            period,
            number: 0,
            way: rest,
            down: [f64::INFINITY; 2],
            path: Vec::new(),
            known: None,
        };
        pointing.run(if waits { PLACED } else { CLEAR });
        if pointing.posture.rate.is_none() {
            let probe = pointing.posture.probe as f32;
            let right = pointing.probe(Vec2::X * probe);
            let up = pointing.probe(Vec2::Y * probe);
            let jacobian = Jacobian([[right[0], up[0]], [right[1], up[1]]]);
            jacobian.solve([1.0, 1.0])?;
            pointing.known = Some([jacobian; LENGTHS.len() + 1]);
        }
        Some(pointing)
    }

    /// Returns what the person has learned of the cursor; `None` for a cursor whose velocity follows the hand.
    pub(super) fn jacobian(&self) -> Option<Jacobian> {
        Some(*self.known?.last()?)
    }

    /// Goes to a target of a width and clicks on it; `None` if it is given up.
    pub(super) fn click_on(&mut self, target: [f64; 2], width: f64) -> Option<Clicked> {
        let deadline = self.now() + TIMEOUT;
        let (mut tries, mut stronger, mut is_first) = (0, 1.0, true);
        while self.now() < deadline && tries < TRIES {
            let error = between(self.perceived(), target);
            let is_on = error[0].hypot(error[1]) <= AIM * width / 2.0;
            if is_first || !is_on {
                is_first = false;
                let early = match self.posture.rate {
                    Some(rate) => self.steer(&rate, target, width, deadline),
                    None => self.go(error, width)?,
                };
                // A click that was not meant ends the movement.
                if early.is_some() {
                    return early;
                }
                continue;
            }
            let clicked = self.click(stronger);
            if clicked.is_some() {
                return clicked;
            }
            tries += 1;
            stronger *= STRONGER;
        }
        None
    }

    fn now(&self) -> f64 {
        self.number as f64 * self.period
    }

    /// Returns the position of the cursor as the person sees it: what it was a while ago.
    fn perceived(&self) -> [f64; 2] {
        self.seen.front().copied().unwrap_or_default()
    }

    /// Returns the displacement of the hand that is intended now.
    fn displacement(&self) -> Vec2 {
        let Way {
            from,
            to,
            start,
            duration,
        } = self.way;
        let t = ((self.now() - start) / duration).clamp(0.0, 1.0) as f32;
        from.lerp(to, crate::sim::minimum_jerk(t))
    }

    /// Passes one reading on. Returns `true` if the left button went down.
    fn step(&mut self) -> bool {
        self.number += 1;
        let now = self.now();
        let is_down = (self.down[0]..self.down[1]).contains(&now);
        let by = self.displacement();
        let seconds = [now, self.period];
        let has_clicked = self.cursor.step(self.hand, seconds, by, is_down);
        self.path.push(self.cursor.place());
        self.seen.push_back(self.cursor.place());
        let kept = 1 + (DELAY / self.period).round() as usize;
        while self.seen.len() > kept {
            self.seen.pop_front();
        }
        has_clicked
    }

    /// Passes readings on for a time. Returns the first click.
    fn run(&mut self, seconds: f64) -> Option<Clicked> {
        let end = self.now() + seconds;
        let meant = self.cursor.place();
        let mut first = None;
        while self.now() < end {
            if self.step() && first.is_none() {
                first = Some(self.clicked(meant));
            }
        }
        first
    }

    /// Returns a click that has just come, and begins the way to the next one.
    fn clicked(&mut self, meant: [f64; 2]) -> Clicked {
        Clicked {
            meant,
            place: self.cursor.place(),
            seconds: self.now(),
            path: std::mem::take(&mut self.path),
        }
    }

    fn displace(&mut self, to: Vec2, duration: f64) {
        let start = self.now();
        self.way = Way {
            from: self.way.to,
            to,
            start,
            duration,
        };
        self.hand.displace(&self.posture, to, start, duration);
    }

    /// Moves the hand and back. Returns the motion of the cursor for a unit of displacement.
    fn probe(&mut self, by: Vec2) -> [f64; 2] {
        let before = self.cursor.place();
        self.displace(by, TRY);
        self.run(TRY + SETTLING);
        let moved = between(before, self.cursor.place());
        self.displace(Vec2::ZERO, TRY);
        self.run(TRY + SETTLING);
        moved.map(|it| it / f64::from(by.length()))
    }

    /// Makes one movement by a distance on the screen, and waits until the cursor rests. Returns a click that came during the
    /// movement; `None` if the person does not know the cursor.
    fn go(&mut self, error: [f64; 2], width: f64) -> Option<Option<Clicked>> {
        let length = error[0].hypot(error[1]);
        let class = LENGTHS.iter().filter(|longest| length > **longest).count();
        let jacobian = self.known?[class];
        let by = jacobian.solve(error)?;
        let along = 1.0 + self.scatter * self.draw.normal();
        let across = self.scatter * ACROSS * self.draw.normal();
        let by = [
            by[0] * along - by[1] * across,
            by[1] * along + by[0] * across,
        ];
        let before = self.cursor.place();
        let duration = self.hand.person().movement_time(length, width);
        let to = self.way.to + Vec2::new(by[0] as f32, by[1] as f32);
        self.displace(to, duration);
        let mut early = self.run(duration + DELAY);
        let end = self.now() + SETTLING;
        while early.is_none() && self.now() < end && !self.rests(width) {
            early = self.run(self.period);
        }
        let moved = between(before, self.cursor.place());
        if length > TELLING.max(1e-3) * width && moved[0].hypot(moved[1]) > TELLING * length {
            let mut learned = jacobian;
            learned.learn(by, moved);
            if let (Some(known), true) = (&mut self.known, learned.solve([1.0, 1.0]).is_some()) {
                known[class] = learned;
            }
        }
        Some(early)
    }

    fn rests(&self, width: f64) -> bool {
        let back = (0.03 / self.period).round().max(1.0) as usize;
        let latest = self.seen.back();
        let earlier = self.seen.iter().rev().nth(back);
        let moved = latest.zip(earlier).map(|(a, b)| distance(*a, *b));
        moved.is_none_or(|moved| moved <= REST * width)
    }

    /// Steers a cursor whose velocity follows the hand until it is on the target or a time has come. Returns a click that came
    /// on the way.
    fn steer(
        &mut self,
        rate: &RateControl,
        target: [f64; 2],
        width: f64,
        deadline: f64,
    ) -> Option<Clicked> {
        let kept = (DELAY / self.period).round().max(1.0) as usize;
        let mut orders: VecDeque<[f64; 2]> = VecDeque::new();
        let (mut gain, mut turn, mut next_error) = ([1.0, 1.0], 0.0, self.now());
        let mut rested = 0;
        while self.now() < deadline {
            if self.now() >= next_error {
                next_error += ERROR_TIME;
                gain = [1.0, 1.0].map(|it| it + self.scatter * self.draw.normal());
                turn = self.scatter * ACROSS * self.draw.normal();
            }
            let seen = between(self.perceived(), target);
            let is_on = |error: [f64; 2]| error[0].hypot(error[1]) <= AIM * width / 2.0;
            // Less the motion that was ordered and is not seen yet.
            let mut error = seen;
            for order in &orders {
                error[0] -= order[0] * self.period;
                error[1] -= order[1] * self.period;
            }
            let order = if is_on(error) {
                [0.0; 2]
            } else {
                limited(error.map(|it| it / APPROACH), rate)
            };
            rested = if is_on(seen) && order == [0.0; 2] {
                rested + 1
            } else {
                0
            };
            let goal = self.hand.displacement_for(
                rate,
                Vec2::new(
                    ((order[0] - order[1] * turn) * gain[0]) as f32,
                    -((order[1] + order[0] * turn) * gain[1]) as f32,
                ),
            );
            let follow = (self.period / HAND_TIME).min(1.0) as f32;
            let to = self.way.to + (goal - self.way.to) * follow;
            self.displace(to, self.period);
            orders.push_back(order);
            if orders.len() > kept {
                orders.pop_front();
            }
            let meant = self.cursor.place();
            if self.step() {
                return Some(self.clicked(meant));
            }
            if rested > kept {
                break;
            }
        }
        None
    }

    /// Clicks where the cursor is, and begins to raise the finger. Returns the click, if the button went down.
    fn click(&mut self, stronger: f32) -> Option<Clicked> {
        let start = self.now();
        let (bottom, end) = self.hand.click(&self.posture, self.way.to, start, stronger);
        self.down = [bottom, end];
        let meant = self.cursor.place();
        let clicked = self.run(end - start);
        self.down = [f64::INFINITY; 2];
        clicked.map(|clicked| Clicked { meant, ..clicked })
    }
}

/// Returns a velocity of at most the part of the highest one that people use.
fn limited(velocity: [f64; 2], rate: &RateControl) -> [f64; 2] {
    let length = velocity[0].hypot(velocity[1]);
    let most = FASTEST * f64::from(rate.max_speed_px_s);
    if length > most {
        velocity.map(|it| it * most / length)
    } else {
        velocity
    }
}

fn between(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [to[0] - from[0], to[1] - from[1]]
}

#[cfg(test)]
mod tests {
    use super::super::cursor::IdealCursor;
    use super::*;
    use crate::document::Document;
    use crate::people::{Participant, People, population};
    use crate::sim::fluent::SourceKind;
    use crate::trials::Station;

    /// A cursor that also goes up and down by two pixels with each reading.
    struct Trembling {
        steady: IdealCursor,
        is_low: bool,
    }

    impl Cursor for Trembling {
        fn step(
            &mut self,
            hand: &mut FluentHand,
            seconds: [f64; 2],
            by: Vec2,
            is_down: bool,
        ) -> bool {
            self.is_low = !self.is_low;
            self.steady.step(hand, seconds, by, is_down)
        }

        fn place(&self) -> [f64; 2] {
            let [x, y] = self.steady.place();
            [x, if self.is_low { y + 2.0 } else { y }]
        }
    }

    #[test]
    fn the_way_to_a_click_begins_at_the_click_before_while_the_finger_is_still_down() {
        let document = Document::shipped("direct").expect("a shipped layout");
        let person = Participant {
            scatter: [0.0; 2],
            ..population(&People::Drawn(1), None, 2).remove(0)
        };
        let mut station = Station::new(&document, &person, SourceKind::Ideal).expect("a person");
        let settings = station.layout.pointer.clone().expect("a pointer");
        let cursor = Trembling {
            steady: IdealCursor::new([1280.0, 800.0], Jacobian([[8e3, 0.0], [0.0, -8e3]])),
            is_low: false,
        };
        let period = 1.0 / 175.0;
        let hand = &mut station.hands[0];
        let pointing = Pointing::begin(hand, cursor, &settings, (1, period), false);
        let mut pointing = pointing.expect("the hand can use it");
        // Twice on the target on which the cursor is: all of its way is the trembling.
        let mut click = || pointing.click_on([640.0, 400.0], 100.0).expect("a click");
        let (first, second) = (click(), click());
        let readings = ((second.seconds - first.seconds) / period).round();
        assert!(readings > 20.0, "{readings}");
        let start = [first.place].into_iter();
        let positions: Vec<[f64; 2]> = start.chain(second.path).collect();
        let steps = positions.windows(2);
        let way: f64 = steps.map(|step| distance(step[0], step[1])).sum();
        let each = way / readings;
        assert!((1.95..2.3).contains(&each), "{each} px a reading");
    }

    #[test]
    fn a_person_learns_how_a_cursor_follows_a_turned_hand() {
        let truth = Jacobian([[3.0, 1.0], [-0.5, -4.0]]);
        let mut known = Jacobian([[2.0, 0.0], [0.0, -2.0]]);
        for _ in 0..40 {
            for by in [[0.3, 0.1], [-0.1, 0.4], [0.2, -0.3]] {
                known.learn(by, truth.apply(by));
            }
        }
        let way = truth.apply(known.solve([10.0, 5.0]).expect("it is invertible"));
        assert!(distance(way, [10.0, 5.0]) < 0.1, "{way:?}");
        assert_eq!(Jacobian([[1.0, 2.0], [2.0, 4.0]]).solve([1.0, 0.0]), None);
    }
}
