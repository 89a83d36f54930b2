//! Bones of constant length in a stream: their lengths are measured in the first readings, and points are fitted to them.

use glam::DVec3;

use super::{Bone, fit_bones, median};

/// Most lengths of a bone whose median is computed.
const MAX_SAMPLES: usize = 1024;

/// Fits the points of a stream to bones whose lengths it measures itself.
///
/// The length of a bone is the median of its first readings, so that single wrong readings have no effect. While the length is measured,
/// the median so far is used; after that the length stays constant.
#[derive(Clone, Debug)]
pub struct LiveFit {
    bones: Vec<MeasuredBone>,
    /// Readings of a bone in which its length is measured.
    readings: usize,
}

#[derive(Clone, Debug)]
struct MeasuredBone {
    from: usize,
    to: usize,
    samples: Vec<f64>,
    length: f64,
}

/// A bone of the next reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SeenBone {
    /// Index of the point at its near end.
    pub from: usize,
    /// Index of the point at its far end.
    pub to: usize,
    /// `true` if both ends are seen well enough to measure the length.
    pub is_measured: bool,
}

impl LiveFit {
    /// Creates a fit that measures each bone in its first `readings`, at least one and at most 1024.
    pub fn new(readings: usize) -> Self {
        Self {
            bones: Vec::new(),
            readings: readings.clamp(1, MAX_SAMPLES),
        }
    }

    /// Forgets the lengths: the next readings may show another person.
    pub fn reset(&mut self) {
        self.bones.clear();
    }

    /// Moves the points of a reading so that the bones have their lengths and the sum of the squared distances is least, as
    /// [`fit_bones`] does. The bones form trees, each after those before it, and their points are finite.
    pub fn fit(&mut self, points: &mut [DVec3], seen: &[SeenBone]) {
        let bones: Vec<Bone> = seen
            .iter()
            .filter_map(|bone| {
                let measured = bone
                    .is_measured
                    .then(|| points[bone.from].distance(points[bone.to]));
                let length = self.length(*bone, measured)?;
                let SeenBone { from, to, .. } = *bone;
                Some(Bone { from, to, length })
            })
            .collect();
        fit_bones(points, &bones);
    }

    /// Returns the length of a bone; `None` before it is measured for the first time.
    fn length(&mut self, seen: SeenBone, measured: Option<f64>) -> Option<f64> {
        let same = |bone: &MeasuredBone| bone.from == seen.from && bone.to == seen.to;
        let index = match self.bones.iter().position(same) {
            Some(index) => index,
            None => {
                measured?;
                self.bones.push(MeasuredBone {
                    from: seen.from,
                    to: seen.to,
                    samples: Vec::with_capacity(self.readings),
                    length: 0.0,
                });
                self.bones.len() - 1
            }
        };
        let bone = &mut self.bones[index];
        if let Some(measured) = measured
            && bone.samples.len() < self.readings
        {
            bone.samples.push(measured);
            bone.length = median(&mut bone.samples)?;
        }
        Some(bone.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BONES: [(usize, usize, f64); 3] = [(0, 1, 0.3), (1, 2, 0.26), (2, 3, 0.09)];

    /// Shoulder, elbow, wrist and knuckle of an arm that moves.
    fn arm(t: f64) -> Vec<DVec3> {
        let mut points = vec![DVec3::ZERO];
        for (index, (_, _, length)) in BONES.iter().enumerate() {
            let turn = t * (1.0 + 0.7 * index as f64);
            let along = DVec3::new(turn.cos(), turn.sin(), 0.4 * (2.0 * t).sin()).normalize();
            points.push(points[index] + along * *length);
        }
        points
    }

    /// Noise with a standard deviation of 1 mm along each axis.
    fn noise(random: &mut fastrand::Rng) -> DVec3 {
        let mut axis = || (0..12).map(|_| random.f64()).sum::<f64>() - 6.0;
        DVec3::new(axis(), axis(), axis()) * 1e-3
    }

    fn seen(is_measured: bool) -> [SeenBone; 3] {
        BONES.map(|(from, to, _)| SeenBone {
            from,
            to,
            is_measured,
        })
    }

    fn spread(lengths: &[f64]) -> f64 {
        let most = lengths.iter().copied().fold(f64::MIN, f64::max);
        most - lengths.iter().copied().fold(f64::MAX, f64::min)
    }

    #[test]
    fn bones_keep_the_lengths_of_the_first_readings_and_joints_come_nearer() {
        let mut random = fastrand::Rng::with_seed(8);
        let mut fit = LiveFit::new(300);
        let (mut before, mut after) = (Vec::new(), Vec::new());
        let mut squares = [[0.0; 2]; 4];
        for index in 0..2000 {
            let exact = arm(f64::from(index) * 0.01);
            let mut points = exact.clone();
            for point in &mut points {
                *point += noise(&mut random);
                // A wrong match now and then.
                if index % 50 == 7 {
                    *point += noise(&mut random) * 40.0;
                }
            }
            let measured = points.clone();
            fit.fit(&mut points, &seen(true));
            if index < 300 || index % 50 == 7 {
                continue;
            }
            before.push(measured[1].distance(measured[2]));
            after.push(points[1].distance(points[2]));
            for (joint, point) in exact.iter().enumerate() {
                squares[joint][0] += measured[joint].distance_squared(*point);
                squares[joint][1] += points[joint].distance_squared(*point);
            }
        }
        let (spread_before, spread_after) = (spread(&before) * 1e3, spread(&after) * 1e3);
        let error = (after[0] - BONES[1].2).abs() * 1e3;
        println!(
            "forearm: spread {spread_before:.2} mm before, {spread_after:.1e} mm after; length off by {error:.2} mm"
        );
        let rms = squares.map(|sums| sums.map(|sum| (sum / before.len() as f64).sqrt() * 1e3));
        println!("joints, RMS in mm before and after: {rms:.2?}");
        assert!(
            spread_before > 6.0 && spread_after < 1e-9,
            "{spread_before} {spread_after}"
        );
        // The median of 300 lengths with 1.4 mm of noise.
        assert!(error < 0.4, "{error}");
        assert!(rms.iter().all(|[raw, fitted]| fitted < raw), "{rms:?}");
    }

    #[test]
    fn a_bone_that_was_never_seen_well_is_not_fitted_and_a_measured_length_stays() {
        let mut fit = LiveFit::new(3);
        let mut points = arm(0.3);
        let exact = points.clone();
        fit.fit(&mut points, &seen(false));
        assert_eq!(points, exact);
        fit.fit(&mut points, &seen(true));
        let mut longer: Vec<DVec3> = exact.iter().map(|point| *point * 2.0).collect();
        fit.fit(&mut longer, &seen(false));
        for (from, to, length) in BONES {
            assert!((longer[from].distance(longer[to]) - length).abs() < 1e-12);
        }
        // Three readings measure; later ones change nothing.
        for scale in [1.0, 1.0, 3.0, 3.0, 3.0] {
            let mut scaled: Vec<DVec3> = exact.iter().map(|point| *point * scale).collect();
            fit.fit(&mut scaled, &seen(true));
            assert!((scaled[0].distance(scaled[1]) - 0.3).abs() < 1e-12);
        }
    }
}
