//! The movement of a hand in a clip: its size and place taken out, and the moment of the tap found.

use super::{PICTURES, POINTS, Picture};

/// The numbers of one picture: where 20 points are from the wrist, and where the wrist is from its place at the start.
pub const NUMBERS: usize = 2 * POINTS;

const WRIST: usize = 0;
/// The knuckle of the middle finger: from the wrist to it is the direction in which fingers tap.
const MIDDLE_KNUCKLE: usize = 9;
/// Landmarks that give the breadth of the palm: the knuckles of index and little finger.
const BREADTH: [usize; 2] = [5, 17];
const TIPS: [usize; 5] = [4, 8, 12, 16, 20];

/// Pictures at the start that show the hand at rest.
const AT_REST: usize = 3;
/// Energy of a hand that does not move, so that its onset is defined.
const STILL: f32 = 1e-9;

/// A point or a direction in a picture.
type Point = [f32; 2];

/// The movement of a hand in a clip, in breadths of its palm.
#[derive(Clone, Debug)]
pub struct Movement {
    /// The points, from the place of the wrist at the start.
    pictures: [Picture; PICTURES],
    /// The moment, in pictures, at which half of the press is done.
    onset: f32,
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn length([x, y]: Point) -> f32 {
    x.hypot(y)
}

/// Returns the position of a point relative to the wrist.
fn from_wrist(points: &Picture, index: usize) -> Point {
    minus(points[index], points[WRIST])
}

/// Returns the mean of something in the first pictures.
fn at_rest(pictures: &[Picture; PICTURES], of: impl Fn(&Picture) -> Point) -> Point {
    let points = pictures[..AT_REST].iter().map(of);
    let sum = points.fold([0.0; 2], |[x, y], point| [x + point[0], y + point[1]]);
    sum.map(|sum| sum / AT_REST as f32)
}

impl Movement {
    /// Returns the movement in a clip; `None` if there is no hand, or a number is not finite.
    pub fn new(pictures: &[Picture; PICTURES]) -> Option<Self> {
        let [index, little] = BREADTH;
        let breadth = length(at_rest(pictures, |points| {
            minus(points[index], points[little])
        }));
        let numbers = pictures.as_flattened().as_flattened();
        if !(breadth > f32::EPSILON && numbers.iter().all(|number| number.is_finite())) {
            return None;
        }
        let start = at_rest(pictures, |points| points[WRIST]);
        let scaled = |point: Point| minus(point, start).map(|number| number / breadth);
        let normal = pictures.map(|points| points.map(scaled));
        Some(Self {
            onset: onset(&normal)?,
            pictures: normal,
        })
    }

    /// Returns the largest distance of any fingertip, at any time, from its position at rest, both relative to the wrist.
    pub fn largest(&self) -> f32 {
        let changes = TIPS.iter().flat_map(|&tip| {
            let rest = at_rest(&self.pictures, |points| from_wrist(points, tip));
            let change = move |points| length(minus(from_wrist(points, tip), rest));
            self.pictures.iter().map(change)
        });
        changes.fold(0.0, f32::max)
    }

    /// Returns the numbers of a moment, in pictures from the onset. They are interpolated between two pictures; before the first
    /// picture and after the last one the hand stands still.
    pub fn at(&self, moment: f32) -> [f32; NUMBERS] {
        let time = (self.onset + moment).clamp(0.0, (PICTURES - 1) as f32);
        let first = (time as usize).min(PICTURES - 2);
        let part = time - first as f32;
        let (before, after) = (&self.pictures[first], &self.pictures[first + 1]);
        let point = |index: usize| {
            [0, 1].map(|axis| before[index][axis] * (1.0 - part) + after[index][axis] * part)
        };
        let wrist = point(WRIST);
        let mut numbers = [0.0; NUMBERS];
        for (pair, index) in numbers.chunks_exact_mut(2).zip(1..) {
            let values = if index < POINTS {
                minus(point(index), wrist)
            } else {
                wrist
            };
            pair.copy_from_slice(&values);
        }
        numbers
    }
}

/// Returns the moment, in pictures, at which half of the energy of the fingertips towards the board is spent: the sum of their squared
/// speeds along the fingers. The way back does not count. `None` if the hand has no direction.
fn onset(pictures: &[Picture; PICTURES]) -> Option<f32> {
    let direction = at_rest(pictures, |points| from_wrist(points, MIDDLE_KNUCKLE));
    let norm = length(direction);
    if norm <= f32::EPSILON {
        return None;
    }
    let along = |points: &Picture, tip: usize| {
        let [x, y] = from_wrist(points, tip);
        (x * direction[0] + y * direction[1]) / norm
    };
    let mut energies = [0.0; PICTURES - 1];
    for (energy, pair) in energies.iter_mut().zip(pictures.windows(2)) {
        let speeds = TIPS
            .iter()
            .map(|&tip| along(&pair[1], tip) - along(&pair[0], tip));
        *energy = STILL + speeds.map(|speed| speed.max(0.0).powi(2)).sum::<f32>();
    }
    let half = 0.5 * energies.iter().sum::<f32>();
    let mut spent = 0.0;
    for (picture, energy) in energies.into_iter().enumerate() {
        if spent + energy >= half {
            return Some(picture as f32 + (half - spent) / energy);
        }
        spent += energy;
    }
    Some((PICTURES - 1) as f32)
}
