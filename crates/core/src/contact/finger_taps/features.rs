//! The numbers of a clip that a model sees.

use super::{PICTURES, POINTS, Picture};

/// The pictures around the fastest movement: one before it to four after it.
const WINDOW: usize = 6;
const BEFORE: isize = 1;

/// The number of features: the points from the wrist and the wrist in each picture of the window, as differences from the hand at
/// rest; and the hand at rest.
pub const FEATURES: usize = 2 * (WINDOW * POINTS + POINTS - 1);

/// Landmarks that give the breadth of the palm: the knuckles of index and little finger.
const BREADTH: [usize; 2] = [5, 17];
const TIPS: [usize; 5] = [4, 8, 12, 16, 20];

/// Pictures at the start that show the hand at rest, at most.
const AT_REST: usize = 4;
/// Pictures at the start that give the breadth.
const FOR_BREADTH: usize = 3;

/// Returns the mean breadth of the palm in the first pictures; `None` unless it is a number above 0.
fn breadth(pictures: &[Picture; PICTURES]) -> Option<f32> {
    let [a, b] = BREADTH;
    let mut sum = [0.0; 2];
    for points in &pictures[..FOR_BREADTH] {
        for (axis, part) in sum.iter_mut().enumerate() {
            *part += points[a][axis] - points[b][axis];
        }
    }
    let breadth = sum[0].hypot(sum[1]) / FOR_BREADTH as f32;
    (breadth.is_finite() && breadth > f32::EPSILON).then_some(breadth)
}

/// Returns the picture before the fastest movement of the fingertips: that at which half the sum of their squared speeds is reached.
pub fn onset(pictures: &[Picture; PICTURES]) -> usize {
    let mut energies = [0.0; PICTURES - 1];
    for (energy, pair) in energies.iter_mut().zip(pictures.windows(2)) {
        let way = |tip: usize| {
            let [x, y] = [0, 1].map(|axis| pair[1][tip][axis] - pair[0][tip][axis]);
            x.hypot(y)
        };
        *energy = TIPS.into_iter().map(way).sum::<f32>().powi(2);
    }
    let half = 0.5 * energies.iter().sum::<f32>();
    let mut sum = 0.0;
    let before = energies.iter().take_while(|energy| {
        sum += **energy;
        sum < half
    });
    before.count()
}

/// Returns the features of a clip whose fastest movement is after the picture `onset`, in breadths of the palm; `None` if there is no
/// hand, or a number is not finite. Does not allocate.
pub fn features(pictures: &[Picture; PICTURES], onset: usize) -> Option<[f32; FEATURES]> {
    let scale = 1.0 / breadth(pictures)?;
    let count = onset.saturating_sub(1).clamp(1, AT_REST);
    let mut rest = [[0.0; 2]; POINTS];
    for points in &pictures[..count] {
        for (resting, point) in rest.iter_mut().zip(points) {
            *resting = [
                resting[0] + point[0] / count as f32,
                resting[1] + point[1] / count as f32,
            ];
        }
    }
    let mut features = [0.0; FEATURES];
    let mut next = features.iter_mut();
    let mut add = |value: f32| {
        if let Some(feature) = next.next() {
            *feature = value * scale;
        }
    };
    let picture = |step: usize| {
        let index = onset as isize + step as isize - BEFORE;
        &pictures[index.clamp(0, PICTURES as isize - 1) as usize]
    };
    for step in 0..WINDOW {
        let points = picture(step);
        for (point, rest_point) in points.iter().zip(&rest).skip(1) {
            for axis in 0..2 {
                add((point[axis] - points[0][axis]) - (rest_point[axis] - rest[0][axis]));
            }
        }
        for axis in 0..2 {
            add(points[0][axis] - rest[0][axis]);
        }
    }
    for point in &rest[1..] {
        for axis in 0..2 {
            add(point[axis] - rest[0][axis]);
        }
    }
    features.iter().all(|it| it.is_finite()).then_some(features)
}
