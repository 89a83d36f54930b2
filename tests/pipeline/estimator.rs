//! The estimator: the readings that it accepts, and the angles that it returns.

use std::time::Duration;

use ademan::capture::{Channels, Reading, Sample};
use ademan::estimate::{Estimate, Estimator, EstimatorSettings, JointAngles, Rejection, Smoothing};
use ademan::files::Load;
use ademan::hand::{Dof, Finger, FingerSet};
use ademan::layout::Glove;
use ademan::time::Timestamp;

/// Channels of the shipped glove.
const ELBOW: usize = 17;
const INDEX_MCP: usize = 12;
const MIDDLE_MCP: usize = 57;
const WRIST: usize = 4;

/// A resting hand in the shipped glove, with a reading every 10 ms.
struct GloveHand {
    time_ms: u64,
    counts: [u16; 64],
    estimator: Estimator,
}

impl GloveHand {
    fn new(settings: EstimatorSettings) -> Self {
        let glove = Glove::load("unam-hc11").expect("the shipped glove");
        let mut counts = [127; 64];
        for row in glove.map.rows() {
            let count = row.calibration.apply_inverse(rest_angle(row.dof));
            counts[row.channel] = count.round() as u16;
        }
        Self {
            time_ms: 0,
            counts,
            estimator: Estimator::new(settings).with_channels(&glove.map),
        }
    }

    fn unsmoothed() -> Self {
        Self::new(unsmoothed())
    }

    fn reading(&self) -> Reading {
        Reading::new(
            Timestamp(self.time_ms * 1_000),
            None,
            Sample::Channels(Channels {
                full_scale: 255,
                counts: self.counts.into_iter().collect(),
                unsent: Default::default(),
            }),
        )
    }

    fn next(&mut self) -> Result<Estimate, Rejection> {
        self.time_ms += 10;
        self.estimator.update(&self.reading()).copied()
    }

    fn set(&mut self, channel: usize, count: u16) -> Result<Estimate, Rejection> {
        self.counts[channel] = count;
        self.next()
    }
}

fn unsmoothed() -> EstimatorSettings {
    EstimatorSettings {
        smoothing: Smoothing::Off,
        ..EstimatorSettings::default()
    }
}

/// The abduction sensor of the thumb cannot measure 0.
fn rest_angle(dof: Dof) -> f64 {
    match dof {
        Dof::ThumbCmcAbduction => -0.5,
        Dof::ElbowFlexion => 0.5,
        _ => 0.0,
    }
}

#[test]
fn a_resting_hand_has_its_rest_angles() {
    let mut hand = GloveHand::unsmoothed();
    let estimate = hand.next().expect("a resting hand");
    for (dof, radians) in estimate.angles.known() {
        assert!((radians - rest_angle(dof)).abs() < 0.03, "{dof}: {radians}");
    }
    assert_eq!(estimate.untrusted, FingerSet::NONE);
    assert!(!estimate.angles.is_known(Dof::ShoulderZ), "no sensor");
}

#[test]
fn readings_of_another_shape_are_rejected() {
    let mut hand = GloveHand::unsmoothed();
    hand.next().expect("a resting hand");
    let mut short = hand.reading();
    short.time = Timestamp(50_000);
    let Sample::Channels(channels) = &mut short.sample else {
        panic!("channels");
    };
    channels.counts.truncate(60);
    assert_eq!(hand.estimator.update(&short), Err(Rejection::WrongShape));
    let mut wide = hand.reading();
    wide.time = Timestamp(60_000);
    let Sample::Channels(wide_channels) = &mut wide.sample else {
        panic!("channels");
    };
    wide_channels.full_scale = 4_095;
    assert_eq!(hand.estimator.update(&wide), Err(Rejection::WrongShape));
}

#[test]
fn channels_without_a_channel_map_are_rejected() {
    let hand = GloveHand::unsmoothed();
    let mut estimator = Estimator::new(unsmoothed());
    assert_eq!(
        estimator.update(&hand.reading()),
        Err(Rejection::WrongShape)
    );
}

#[test]
fn a_time_stamp_that_does_not_advance_is_rejected() {
    let mut hand = GloveHand::unsmoothed();
    hand.next().expect("a resting hand");
    let repeated = hand.reading();
    assert_eq!(hand.estimator.update(&repeated), Err(Rejection::OutOfOrder));
    hand.time_ms -= 5;
    let earlier = hand.reading();
    assert_eq!(hand.estimator.update(&earlier), Err(Rejection::OutOfOrder));
}

#[test]
fn an_angle_slightly_outside_its_range_is_clamped_and_one_far_outside_rejects_the_reading() {
    let mut hand = GloveHand::unsmoothed();
    // A straight elbow reads 31 counts: 10 below is 6 degrees too far, 31 below 17 degrees.
    let estimate = hand.set(ELBOW, 21).expect("a calibration error");
    assert_eq!(estimate.angles.get(Dof::ElbowFlexion), 0.0);
    assert_eq!(hand.set(ELBOW, 1), Err(Rejection::OutsideLimits));
}

#[test]
fn a_flipped_bit_in_one_reading_is_rejected() {
    let mut hand = GloveHand::unsmoothed();
    let rest = hand.next().expect("a resting hand");
    let count = hand.counts[INDEX_MCP];
    assert_eq!(hand.set(INDEX_MCP, count ^ 0x80), Err(Rejection::TooFast));
    let next = hand.set(INDEX_MCP, count).expect("the angle as before");
    assert_eq!(next.angles, rest.angles);
    assert!(!next.jumped);
}

#[test]
fn an_implausible_position_is_accepted_at_the_third_consistent_reading() {
    let mut hand = GloveHand::unsmoothed();
    hand.next().expect("a resting hand");
    assert_eq!(hand.set(ELBOW, 200), Err(Rejection::TooFast));
    assert_eq!(hand.set(ELBOW, 201), Err(Rejection::TooFast));
    assert!(hand.set(ELBOW, 202).expect("the third reading").jumped);
    assert!(!hand.set(ELBOW, 203).expect("a small step").jumped);
}

#[test]
fn implausible_positions_that_contradict_each_other_are_never_accepted() {
    let mut hand = GloveHand::unsmoothed();
    hand.next().expect("a resting hand");
    let mut unplaced = 0;
    for (number, count) in [160, 230].into_iter().cycle().take(50).enumerate() {
        match hand.set(ELBOW, count) {
            Err(reason) => assert_eq!(reason, Rejection::TooFast),
            Ok(estimate) => {
                assert!(number >= 3, "a jump of one reading");
                assert!(!estimate.is_placed, "the sensor is unreliable");
                assert!(!estimate.angles.is_known(Dof::ElbowFlexion));
                unplaced += 1;
            }
        }
    }
    assert!(unplaced > 20, "{unplaced}");
}

#[test]
fn the_fastest_finger_is_not_too_fast() {
    let mut hand = GloveHand::unsmoothed();
    hand.next().expect("a resting hand");
    // 20 rad/s, the fastest flexion of a finger, at 100 readings per second.
    let mut count = f64::from(hand.counts[INDEX_MCP]);
    for _ in 0..7 {
        count += 0.2 * 255.0 / 3.0;
        hand.set(INDEX_MCP, count as u16).expect("a fast finger");
    }
}

#[test]
fn a_finger_with_a_broken_sensor_is_untrusted_after_one_second() {
    let mut hand = GloveHand::unsmoothed();
    hand.counts[MIDDLE_MCP] = 0;
    let mut untrusted = FingerSet::NONE;
    for _ in 0..100 {
        untrusted = hand.next().expect("a possible angle").untrusted;
    }
    assert_eq!(untrusted, FingerSet::NONE, "within the first second");
    for _ in 0..2 {
        untrusted = hand.next().expect("the other fingers").untrusted;
    }
    assert_eq!(untrusted, FingerSet::NONE.with(Finger::Middle));
    let repaired = hand.set(MIDDLE_MCP, 20).expect("plugged in again");
    assert_eq!(repaired.untrusted, FingerSet::NONE);
    let loose = hand.set(MIDDLE_MCP, 0).expect("a possible angle");
    assert_eq!(loose.untrusted, FingerSet::NONE, "a new second begins");
}

#[test]
fn a_broken_wrist_sensor_makes_all_fingers_untrusted() {
    let mut hand = GloveHand::unsmoothed();
    hand.next().expect("a resting hand");
    hand.counts[WRIST] = 255;
    let mut rejected = 0;
    let mut untrusted = FingerSet::NONE;
    for _ in 0..110 {
        match hand.next() {
            Ok(estimate) => {
                assert!(!estimate.is_placed, "the place follows from the wrist");
                untrusted = estimate.untrusted;
            }
            Err(_) => rejected += 1,
        }
    }
    assert!((3..30).contains(&rejected), "{rejected}");
    assert_eq!(untrusted, FingerSet::ALL);
}

#[test]
fn a_gap_resets_the_filters() {
    let mut hand = GloveHand::new(EstimatorSettings {
        smoothing: Smoothing::RecursiveAverage,
        ..EstimatorSettings::default()
    });
    for _ in 0..50 {
        hand.next().expect("a resting hand");
    }
    hand.time_ms += 1_000;
    let estimate = hand.set(ELBOW, 100).expect("possible within a second");
    let exact = (100.0 - 31.0) * 2.5 / 255.0;
    assert!((estimate.angles.get(Dof::ElbowFlexion) - exact).abs() < 1e-9);
}

#[test]
fn without_a_gap_the_filters_lag() {
    let mut hand = GloveHand::new(EstimatorSettings {
        smoothing: Smoothing::RecursiveAverage,
        max_gap: Duration::MAX,
        ..EstimatorSettings::default()
    });
    let elbow = |estimate: Estimate| estimate.angles.get(Dof::ElbowFlexion);
    let rest = elbow(hand.next().expect("a resting hand"));
    let moved = elbow(hand.set(ELBOW, 90).expect("a small step"));
    let exact = (90.0 - 31.0) * 2.5 / 255.0;
    assert!(moved > rest && moved < exact);
}

/// A reading of joint angles.
fn angles(time_ms: u64, angles: &[(Dof, f64)]) -> Reading {
    let mut known = JointAngles::default();
    for &(dof, radians) in angles {
        known.set(dof, radians);
    }
    Reading::new(
        Timestamp(time_ms * 1_000),
        None,
        Sample::Angles { angles: known },
    )
}

#[test]
fn angles_need_no_channel_map_and_are_checked_in_the_same_way() {
    let mut estimator = Estimator::new(unsmoothed());
    let mut elbow = |time_ms, radians| {
        let estimate = estimator.update(&angles(time_ms, &[(Dof::ElbowFlexion, radians)]))?;
        assert!(!estimate.angles.is_known(Dof::WristFlexion));
        Ok(estimate.angles.get(Dof::ElbowFlexion))
    };
    assert_eq!(elbow(10, 0.5), Ok(0.5));
    assert_eq!(elbow(10, 0.5), Err(Rejection::OutOfOrder));
    assert_eq!(elbow(20, -0.1), Err(Rejection::TooFast));
    assert_eq!(elbow(30, 0.2), Ok(0.2));
    assert_eq!(elbow(40, -0.1), Ok(0.0), "clamped");
    assert_eq!(elbow(50, -0.5), Err(Rejection::OutsideLimits));
    assert_eq!(elbow(60, f64::NAN), Err(Rejection::NotFinite));
    assert_eq!(
        estimator.update(&angles(70, &[])),
        Err(Rejection::WrongShape)
    );
}

#[test]
fn a_change_of_the_known_angles_resets_the_filters() {
    let mut estimator = Estimator::new(EstimatorSettings::default());
    let elbow = (Dof::ElbowFlexion, 0.5);
    for number in 1..10 {
        let estimate = estimator.update(&angles(10 * number, &[elbow]));
        assert!(
            !estimate
                .expect("an elbow")
                .angles
                .is_known(Dof::WristFlexion)
        );
    }
    let with_wrist = angles(100, &[elbow, (Dof::WristFlexion, 0.9)]);
    let estimate = estimator.update(&with_wrist).expect("a wrist");
    assert_eq!(estimate.angles.get(Dof::WristFlexion), 0.9, "no lag from 0");
    assert!(!estimate.jumped);
}
