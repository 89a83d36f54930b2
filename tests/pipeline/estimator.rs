//! What the estimator lets pass, and what never goes on.

use std::time::Duration;

use ademan::capture::{Channels, Reading, Sample};
use ademan::estimate::{Estimator, EstimatorSettings, JointAngles, Rejection, Smoothing};
use ademan::hand::{Dof, Finger, FingerSet};
use ademan::layout::Glove;
use ademan::time::Timestamp;

/// Channels of the shipped glove.
const ELBOW: usize = 17;
const INDEX_MCP: usize = 12;
const MIDDLE_MCP: usize = 57;
const WRIST: usize = 4;

/// A reading every 10 ms of a hand that rests.
struct Wearer {
    time_ms: u64,
    counts: [u16; 64],
    estimator: Estimator,
}

impl Wearer {
    fn new(settings: EstimatorSettings) -> Self {
        let glove = Glove::load("unam-hc11").expect("the shipped glove");
        let mut counts = [127; 64];
        for row in glove.map.rows() {
            counts[row.channel] = row.calibration.apply_inverse(resting(row.dof)).round() as u16;
        }
        Self {
            time_ms: 0,
            counts,
            estimator: Estimator::new(glove.map, settings),
        }
    }

    fn unsmoothed() -> Self {
        Self::new(EstimatorSettings {
            smoothing: Smoothing::Off,
            ..EstimatorSettings::default()
        })
    }

    fn reading(&self) -> Reading {
        Reading {
            time: Timestamp(self.time_ms * 1_000),
            side: None,
            sample: Sample::Channels(Channels {
                full_scale: 255,
                counts: self.counts.into_iter().collect(),
            }),
        }
    }

    fn next(&mut self) -> Result<JointAngles, Rejection> {
        self.time_ms += 10;
        self.estimator.update(&self.reading())
    }

    fn turn(&mut self, channel: usize, count: u16) -> Result<JointAngles, Rejection> {
        self.counts[channel] = count;
        self.next()
    }
}

/// The thumb's sideways sensor of this glove cannot tell 0.
fn resting(dof: Dof) -> f64 {
    match dof {
        Dof::ThumbCmcAbduction => -0.5,
        Dof::ElbowFlexion => 0.5,
        _ => 0.0,
    }
}

#[test]
fn a_resting_hand_has_the_angles_it_rests_at() {
    let mut glove = Wearer::unsmoothed();
    let angles = glove.next().expect("a resting hand");
    for (dof, radians) in angles.known() {
        assert!((radians - resting(dof)).abs() < 0.03, "{dof}: {radians}");
    }
    assert_eq!(angles.untrusted, FingerSet::NONE);
    assert!(!angles.is_known(Dof::ShoulderZ), "no sensor tells it");
}

#[test]
fn readings_of_another_shape_are_refused() {
    let mut glove = Wearer::unsmoothed();
    glove.next().expect("a resting hand");
    let mut short = glove.reading();
    short.time = Timestamp(50_000);
    let Sample::Channels(channels) = &mut short.sample else {
        panic!("channels");
    };
    channels.counts.truncate(60);
    assert_eq!(glove.estimator.update(&short), Err(Rejection::WrongShape));
    let mut wide = glove.reading();
    wide.time = Timestamp(60_000);
    let Sample::Channels(channels) = &mut wide.sample else {
        panic!("channels");
    };
    channels.full_scale = 4_095;
    assert_eq!(glove.estimator.update(&wide), Err(Rejection::WrongShape));
}

#[test]
fn a_clock_that_stands_still_or_goes_back_is_refused() {
    let mut glove = Wearer::unsmoothed();
    glove.next().expect("a resting hand");
    assert_eq!(
        glove.estimator.update(&glove.reading()),
        Err(Rejection::Stale)
    );
    glove.time_ms -= 5;
    assert_eq!(
        glove.estimator.update(&glove.reading()),
        Err(Rejection::Stale)
    );
}

#[test]
fn an_angle_a_little_outside_its_range_is_brought_in_and_one_far_outside_drops_the_reading() {
    let mut glove = Wearer::unsmoothed();
    // 31 counts are a straight elbow: 10 below is 6 degrees too far, 31 below 17 degrees.
    glove.counts[ELBOW] = 21;
    let angles = glove.next().expect("a calibration error");
    assert_eq!(angles.get(Dof::ElbowFlexion), 0.0);
    assert_eq!(glove.turn(ELBOW, 1), Err(Rejection::OutsideLimits));
}

#[test]
fn a_flipped_bit_for_one_reading_does_not_go_on() {
    let mut glove = Wearer::unsmoothed();
    let rest = glove
        .next()
        .expect("a resting hand")
        .get(Dof::IndexMcpFlexion);
    let count = glove.counts[INDEX_MCP];
    assert_eq!(glove.turn(INDEX_MCP, count ^ 0x80), Err(Rejection::TooFast));
    let after = glove.turn(INDEX_MCP, count).expect("as before");
    assert_eq!(after.get(Dof::IndexMcpFlexion), rest);
    assert!(!after.jumped);
}

#[test]
fn a_hand_that_stays_where_it_cannot_have_come_is_believed_at_the_third_reading() {
    let mut glove = Wearer::unsmoothed();
    glove.next().expect("a resting hand");
    assert_eq!(glove.turn(ELBOW, 200), Err(Rejection::TooFast));
    assert_eq!(glove.turn(ELBOW, 201), Err(Rejection::TooFast));
    let angles = glove.turn(ELBOW, 202).expect("the third of its kind");
    assert!(angles.jumped);
    assert!(!glove.turn(ELBOW, 203).expect("from there on").jumped);
}

#[test]
fn places_that_do_not_agree_with_each_other_are_never_believed() {
    let mut glove = Wearer::unsmoothed();
    glove.next().expect("a resting hand");
    for count in [160, 230].into_iter().cycle().take(50) {
        assert_eq!(glove.turn(ELBOW, count), Err(Rejection::TooFast));
    }
}

#[test]
fn the_fastest_finger_is_not_too_fast() {
    let mut glove = Wearer::unsmoothed();
    glove.next().expect("a resting hand");
    // 20 rad/s, the fastest flexion of a finger, at 100 readings a second.
    let mut count = f64::from(glove.counts[INDEX_MCP]);
    for _ in 0..7 {
        count += 0.2 * 255.0 / 3.0;
        glove
            .turn(INDEX_MCP, count as u16)
            .expect("a person can do that");
    }
}

#[test]
fn a_finger_whose_sensor_is_broken_is_not_believed_after_a_second() {
    let mut glove = Wearer::unsmoothed();
    glove.counts[MIDDLE_MCP] = 0;
    let mut untrusted = FingerSet::NONE;
    for _ in 0..100 {
        untrusted = glove.next().expect("the angle is possible").untrusted;
    }
    assert_eq!(untrusted, FingerSet::NONE, "not within the first second");
    for _ in 0..2 {
        untrusted = glove.next().expect("the others go on").untrusted;
    }
    assert_eq!(untrusted, FingerSet::NONE.with(Finger::Middle));
    let back = glove.turn(MIDDLE_MCP, 20).expect("plugged in again");
    assert_eq!(back.untrusted, FingerSet::NONE);
}

#[test]
fn a_broken_wrist_takes_all_fingers_with_it() {
    let mut glove = Wearer::unsmoothed();
    glove.next().expect("a resting hand");
    glove.counts[WRIST] = 255;
    let mut refused = 0;
    let mut untrusted = FingerSet::NONE;
    for _ in 0..110 {
        match glove.next() {
            Ok(angles) => untrusted = angles.untrusted,
            Err(_) => refused += 1,
        }
    }
    assert!(
        refused >= 100,
        "an impossible wrist drops the reading at first"
    );
    assert_eq!(untrusted, FingerSet::ALL);
}

#[test]
fn filters_start_anew_after_a_gap() {
    let mut glove = Wearer::new(EstimatorSettings {
        smoothing: Smoothing::RecursiveAverage,
        ..EstimatorSettings::default()
    });
    for _ in 0..50 {
        glove.next().expect("a resting hand");
    }
    glove.time_ms += 1_000;
    let angles = glove
        .turn(ELBOW, 100)
        .expect("a second is time enough to get there");
    let exact = (100.0 - 31.0) * 2.5 / 255.0;
    assert!((angles.get(Dof::ElbowFlexion) - exact).abs() < 1e-9);
}

#[test]
fn a_filter_that_runs_on_lags_behind() {
    let mut glove = Wearer::new(EstimatorSettings {
        smoothing: Smoothing::RecursiveAverage,
        max_gap: Duration::MAX,
        ..EstimatorSettings::default()
    });
    let rest = glove.next().expect("a resting hand").get(Dof::ElbowFlexion);
    let moved = glove
        .turn(ELBOW, 90)
        .expect("a small step")
        .get(Dof::ElbowFlexion);
    let exact = (90.0 - 31.0) * 2.5 / 255.0;
    assert!(moved > rest && moved < exact);
}
