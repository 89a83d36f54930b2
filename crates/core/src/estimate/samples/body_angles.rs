//! Angles of the head, the feet and the knees from the landmarks of a body.
//!
//! The trunk has the axes up u, from the middle of the hips to the middle of the shoulders, right r, from the left to the right shoulder
//! and perpendicular to u, and forward u × r. With the middle of the ears E, the middle of both eyes and the nose N, and the axis a
//! from the left ear to the right one:
//!
//! | angle | formula |
//! |---|---|
//! | yaw | atan2(f·r, f·(u × r)), where f is the part of N − E perpendicular to a |
//! | pitch | asin(f·u / ‖f‖) |
//! | roll | atan2(−a·v, a·l), where l is level and v upright, both perpendicular to f |
//! | foot pitch | 90° − the angle between shank (ankle to knee) and foot (heel to toes) |
//! | knee flexion | 180° − the angle between thigh (knee to hip) and shank (knee to ankle) |
//!
//! The line from the ears to the eyes rises by some 12° when a person looks straight ahead, and that to the nose falls as much, so
//! N is between them.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::{LANDMARK_HOLD, MIN_CONFIDENCE};
use crate::capture::body::{BODY_LANDMARKS, BodyLandmarks};
use crate::estimate::one_euro::OneEuroFilter;
use crate::estimate::{EstimatorSettings, Smoothing};
use crate::hand::{BodyAngle, InputValues};
use crate::time::Timestamp;

const NOSE: usize = 0;
const EYES: [usize; 2] = [2, 5];
const EARS: [usize; 2] = [7, 8];
const SHOULDERS: [usize; 2] = [11, 12];
const HIPS: [usize; 2] = [23, 24];
const KNEES: [usize; 2] = [25, 26];
const ANKLES: [usize; 2] = [27, 28];
const HEELS: [usize; 2] = [29, 30];
const TOES: [usize; 2] = [31, 32];

/// The shortest bone that shows a direction, in metres.
const MIN_LENGTH: f64 = 0.01;

/// The angles of a body, smoothed.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyAngles {
    angles: [Option<Tracked>; BodyAngle::COUNT],
}

/// An angle that was seen.
#[derive(Clone, Debug)]
struct Tracked {
    seen_at: Timestamp,
    radians: f64,
    filter: Option<OneEuroFilter<1>>,
}

impl BodyAngles {
    /// Writes the angles whose landmarks have enough confidence, or had it within the hold time.
    pub(super) fn write(
        &mut self,
        body: &BodyLandmarks,
        settings: &EstimatorSettings,
        time: Timestamp,
        values: &mut InputValues,
    ) {
        let seen = SeenBody::new(body);
        for (&angle, tracked) in BodyAngle::ALL.iter().zip(&mut self.angles) {
            match seen.angle(angle) {
                Some(radians) => match tracked {
                    Some(tracked) => tracked.update(radians, time, settings),
                    None => *tracked = Some(Tracked::new(radians, time, settings)),
                },
                None => {
                    tracked.take_if(|tracked| time.since(tracked.seen_at) > LANDMARK_HOLD);
                }
            }
            if let Some(tracked) = tracked {
                values.set_angle(angle, tracked.radians as f32);
            }
        }
    }
}

impl Tracked {
    fn new(radians: f64, time: Timestamp, settings: &EstimatorSettings) -> Self {
        let mut filter = match settings.smoothing {
            Smoothing::OneEuro(settings) => Some(OneEuroFilter::new(settings)),
            Smoothing::Off | Smoothing::RecursiveAverage => None,
        };
        if let Some(filter) = &mut filter {
            filter.filter(&mut [radians], 0.0);
        }
        Self {
            seen_at: time,
            radians,
            filter,
        }
    }

    fn update(&mut self, radians: f64, time: Timestamp, settings: &EstimatorSettings) {
        let gap = time.since(self.seen_at);
        let mut value = [radians];
        if let Some(filter) = &mut self.filter {
            if gap > settings.max_gap {
                filter.reset();
            }
            filter.filter(&mut value, gap.as_secs_f64());
        }
        [self.radians] = value;
        self.seen_at = time;
    }
}

/// The landmarks that are seen.
struct SeenBody([Option<DVec3>; BODY_LANDMARKS]);

impl SeenBody {
    fn new(body: &BodyLandmarks) -> Self {
        Self(std::array::from_fn(|index| {
            let landmark = body.points.get(index)?;
            let [x, y, z] = landmark.position;
            let position = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            (landmark.confidence >= MIN_CONFIDENCE && position.is_finite()).then_some(position)
        }))
    }

    fn angle(&self, angle: BodyAngle) -> Option<f64> {
        match angle {
            BodyAngle::HeadYaw => self.head().map(|[yaw, _, _]| yaw),
            BodyAngle::HeadPitch => self.head().map(|[_, pitch, _]| pitch),
            BodyAngle::HeadRoll => self.head().map(|[_, _, roll]| roll),
            BodyAngle::LeftFootPitch => self.foot_pitch(0),
            BodyAngle::RightFootPitch => self.foot_pitch(1),
            BodyAngle::LeftKneeFlexion => self.knee_flexion(0),
            BodyAngle::RightKneeFlexion => self.knee_flexion(1),
        }
    }

    fn middle(&self, [left, right]: [usize; 2]) -> Option<DVec3> {
        Some((self.0[left]? + self.0[right]?) / 2.0)
    }

    /// Returns the direction from one point to another.
    fn direction(&self, from: usize, to: usize) -> Option<DVec3> {
        unit(self.0[to]? - self.0[from]?)
    }

    /// Returns yaw, pitch and roll of the head.
    fn head(&self) -> Option<[f64; 3]> {
        let up = unit(self.middle(SHOULDERS)? - self.middle(HIPS)?)?;
        let across = self.0[SHOULDERS[1]]? - self.0[SHOULDERS[0]]?;
        let right = unit(across - across.dot(up) * up)?;
        let forward = up.cross(right);
        let axis = self.direction(EARS[0], EARS[1])?;
        let face = (self.middle(EYES)? + self.0[NOSE]?) / 2.0 - self.middle(EARS)?;
        let face = unit(face - face.dot(axis) * axis)?;
        let level = unit(face.dot(forward) * right - face.dot(right) * forward)?;
        let upright = unit(up - up.dot(face) * face)?;
        Some([
            face.dot(right).atan2(face.dot(forward)),
            face.dot(up).clamp(-1.0, 1.0).asin(),
            (-axis.dot(upright)).atan2(axis.dot(level)),
        ])
    }

    fn foot_pitch(&self, side: usize) -> Option<f64> {
        let shank = self.direction(ANKLES[side], KNEES[side])?;
        let foot = self.direction(HEELS[side], TOES[side])?;
        Some(FRAC_PI_2 - shank.angle_between(foot))
    }

    fn knee_flexion(&self, side: usize) -> Option<f64> {
        let thigh = self.direction(KNEES[side], HIPS[side])?;
        let shank = self.direction(KNEES[side], ANKLES[side])?;
        Some(PI - thigh.angle_between(shank))
    }
}

fn unit(vector: DVec3) -> Option<DVec3> {
    (vector.length() >= MIN_LENGTH).then(|| vector.normalize())
}
