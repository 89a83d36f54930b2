//! Head and hip from the landmarks of a body, in the frame of an arm.

use glam::DVec3;
use parry3d::math::Vec3;

use super::{LANDMARK_HOLD, MIN_CONFIDENCE};
use crate::capture::body::BodyLandmarks;
use crate::estimate::EstimatorSettings;
use crate::estimate::one_euro::OneEuroFilter;
use crate::hand::{BodyPoint, BodyPoints, Side};
use crate::time::Timestamp;

/// The ears and the hips, left before right.
const EARS: [usize; 2] = [7, 8];
const HIPS: [usize; Side::COUNT] = [23, 24];

/// The points of a body that were seen.
#[derive(Clone, Debug, Default)]
pub(super) struct SeenPoints {
    points: BodyPoints,
    head: Option<Tracked>,
    hip: Option<Tracked>,
}

/// A point that was seen.
#[derive(Clone, Debug)]
struct Tracked {
    seen_at: Timestamp,
    position: DVec3,
    filter: Option<OneEuroFilter<3>>,
}

impl SeenPoints {
    /// Returns the points.
    pub(super) fn points(&self) -> &BodyPoints {
        &self.points
    }

    /// Updates the points whose landmarks have enough confidence; the others keep their positions for the hold time. `frame` gives the
    /// position of a landmark in the frame of the arm, whose landmarks are seen.
    pub(super) fn see(
        &mut self,
        body: &BodyLandmarks,
        side: Side,
        settings: &EstimatorSettings,
        time: Timestamp,
        frame: impl Fn(DVec3) -> Vec3,
    ) {
        let seen = |landmark: usize| {
            let landmark = body.points.get(landmark)?;
            let [x, y, z] = landmark.position;
            let position = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            let is_seen = landmark.confidence >= MIN_CONFIDENCE;
            (is_seen && position.is_finite()).then(|| frame(position).as_dvec3())
        };
        let head = seen(EARS[0]).zip(seen(EARS[1]));
        let head = head.map(|(left, right)| left.midpoint(right));
        update(&mut self.head, head, settings, time);
        update(&mut self.hip, seen(HIPS[side.index()]), settings, time);
        self.write();
    }

    /// Keeps the positions for the hold time, as the arm is not seen.
    pub(super) fn hold(&mut self, settings: &EstimatorSettings, time: Timestamp) {
        update(&mut self.head, None, settings, time);
        update(&mut self.hip, None, settings, time);
        self.write();
    }

    fn write(&mut self) {
        let position = |tracked: &Option<Tracked>| Some(tracked.as_ref()?.position.as_vec3());
        self.points.set(BodyPoint::Head, position(&self.head));
        self.points.set(BodyPoint::Hip, position(&self.hip));
    }
}

fn update(
    tracked: &mut Option<Tracked>,
    seen: Option<DVec3>,
    settings: &EstimatorSettings,
    time: Timestamp,
) {
    match (tracked.as_mut(), seen) {
        (Some(tracked), Some(position)) => tracked.update(position, settings, time),
        (None, Some(position)) => *tracked = Some(Tracked::new(position, settings, time)),
        (_, None) => {
            tracked.take_if(|tracked| time.since(tracked.seen_at) > LANDMARK_HOLD);
        }
    }
}

impl Tracked {
    fn new(position: DVec3, settings: &EstimatorSettings, time: Timestamp) -> Self {
        let mut filter = settings.position_smoothing.map(OneEuroFilter::new);
        if let Some(filter) = &mut filter {
            filter.filter(&mut position.to_array(), 0.0);
        }
        Self {
            seen_at: time,
            position,
            filter,
        }
    }

    fn update(&mut self, position: DVec3, settings: &EstimatorSettings, time: Timestamp) {
        let gap = time.since(self.seen_at);
        let mut values = position.to_array();
        if let Some(filter) = &mut self.filter {
            if gap > settings.max_gap {
                filter.reset();
            }
            filter.filter(&mut values, gap.as_secs_f64());
        }
        self.position = DVec3::from_array(values);
        self.seen_at = time;
    }
}
