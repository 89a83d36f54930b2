use super::*;

/// Deterministic noise with a standard deviation of 1: the sum of twelve uniform numbers.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// A sensor whose count follows the bend from 500 to 2500, with these errors in counts.
#[derive(Clone, Copy, Default)]
struct Sensor {
    lag: f64,
    drift_per_minute: f64,
    noise: f64,
    /// The count by which a pose is missed.
    spread: f64,
}

const PERIOD_US: u64 = 10_000;
const MOVE: u64 = 80;
const HOLD: u64 = 200;

/// Records cycles of poses, each a bend of 0 to 1, at 100 readings per second.
fn record(sensor: Sensor, poses: &[f64], cycles: usize) -> SensorRecording {
    let mut recording = SensorRecording::new(Some(vec![0, 3]));
    let mut noise = Noise(7);
    let mut reading = 0_u64;
    let (mut bend, mut side) = (0.0, 0.0);
    let all = poses.iter().cycle().take(poses.len() * cycles).copied();
    for (index, pose) in all.chain([poses[0]]).enumerate() {
        // Each of four poses is missed to both sides in turn.
        let sign = [1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0][index % 8];
        let target = pose + sensor.spread * sign / 2_000.0;
        for step in 1..=MOVE + HOLD {
            let t = (step as f64 / MOVE as f64).min(1.0);
            let part = t * t * (3.0 - 2.0 * t);
            let at = bend + part * (target - bend);
            if target != bend {
                side += (sensor.lag / 2.0 * (bend - target).signum() - side) * part;
            }
            let time = Timestamp(reading * PERIOD_US);
            let drift = sensor.drift_per_minute * time.0 as f64 / 60e6;
            let count = 500.0 + 2_000.0 * at + side + drift + sensor.noise * noise.next();
            let mut counts = [0, 0, 0, 800];
            counts[0] = count.round() as u16;
            recording.push(
                time,
                &Channels {
                    full_scale: 4_095,
                    counts: counts.into_iter().collect(),
                    unsent: Default::default(),
                },
            );
            reading += 1;
        }
        bend = target;
    }
    recording
}

const CYCLE: [f64; 4] = [0.0, 0.5, 1.0, 0.5];

fn parameters(sensor: Sensor, poses: &[f64], cycles: usize) -> SensorParameters {
    record(sensor, poses, cycles).parameters().remove(0)
}

#[track_caller]
fn assert_close(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{value} instead of {expected}"
    );
}

#[test]
fn a_channel_that_the_glove_does_not_send_has_no_parameters() {
    let mut recording = SensorRecording::new(Some(vec![0, 1]));
    let mut unsent = ChannelSet::NONE;
    unsent.insert(1);
    let channels = Channels {
        full_scale: 4_095,
        counts: [700, 2_047].into_iter().collect(),
        unsent,
    };
    recording.push(Timestamp(0), &channels);
    let found = recording.parameters();
    let channels_found: Vec<usize> = found.iter().map(|sensor| sensor.channel).collect();
    assert_eq!(channels_found, [0]);
}

#[test]
fn a_sensor_without_errors_has_none() {
    let found = parameters(Sensor::default(), &CYCLE, 5);
    assert_eq!(found.missing(), None);
    assert_eq!((found.holds.low, found.holds.high), (5, 5));
    assert_eq!((found.holds.rising, found.holds.falling), (5, 5));
    assert_close(found.span().unwrap(), 2_000.0, 1.0);
    assert_close(found.jitter.unwrap(), 0.0, 0.3);
    assert_close(found.hysteresis.unwrap(), 0.0, 0.3);
    assert_close(found.repeatability.unwrap(), 0.0, 0.3);
    assert_close(found.drift.unwrap().per_minute, 0.0, 0.3);
}

#[test]
fn jitter_is_the_noise() {
    for noise in [2.0, 10.0, 40.0] {
        let found = parameters(
            Sensor {
                noise,
                ..Sensor::default()
            },
            &CYCLE,
            5,
        );
        assert_eq!(found.missing(), None);
        assert_close(found.jitter.unwrap(), noise, 0.05 * noise);
        // The mean of 100 readings of a hold.
        assert!(found.repeatability.unwrap() < 0.25 * noise);
    }
}

#[test]
fn hysteresis_is_the_difference_of_both_directions_in_spite_of_drift_and_noise() {
    for lag in [-60.0, 30.0, 100.0] {
        let sensor = Sensor {
            lag,
            drift_per_minute: 90.0,
            noise: 5.0,
            spread: 0.0,
        };
        let found = parameters(sensor, &CYCLE, 6);
        // A sensor that lags shows more on the way back.
        assert_close(found.hysteresis.unwrap(), lag, 2.0);
        assert_close(found.drift.unwrap().per_minute, 90.0, 2.0);
        assert!(found.repeatability.unwrap() < 1.5);
    }
}

#[test]
fn repeatability_is_the_spread_of_a_pose() {
    let sensor = Sensor {
        lag: 40.0,
        drift_per_minute: -50.0,
        noise: 3.0,
        spread: 20.0,
    };
    let found = parameters(sensor, &CYCLE, 40);
    assert_close(found.repeatability.unwrap(), 20.0, 1.0);
    let drift = found.drift.unwrap();
    assert_close(drift.per_minute, -50.0, 3.0 * drift.standard_error);
    assert!(drift.standard_error < 1.0, "{drift:?}");
}

#[test]
fn without_half_way_holds_there_is_no_hysteresis() {
    let found = parameters(Sensor::default(), &[0.0, 1.0], 4);
    assert_eq!(found.hysteresis, None);
    assert!(found.repeatability.is_some());
    let missing = found.missing().unwrap();
    assert_eq!(
        missing,
        "0 of 3 holds half-way from the low end, 0 of 3 holds half-way from the high end"
    );
}

#[test]
fn two_cycles_are_not_enough() {
    let found = parameters(Sensor::default(), &CYCLE, 2);
    assert_eq!(
        (found.repeatability, found.drift, found.hysteresis),
        (None, None, None)
    );
    assert!(found.span().is_some());
    let missing = found.missing().unwrap();
    assert!(
        missing.starts_with(
            "2 of 3 holds at the low end, 2 of 3 holds at the high end, 2 of 3 holds half-way"
        ),
        "{missing}"
    );
}

#[test]
fn a_channel_that_is_not_bent_has_jitter_alone() {
    let found = record(Sensor::default(), &CYCLE, 3).parameters().remove(1);
    assert_eq!((found.channel, found.ends), (3, None));
    assert_eq!(found.jitter, Some(0.0));
    assert_eq!(
        found.missing().unwrap(),
        "it was not bent, or not held still"
    );
}

#[test]
fn late_readings_and_those_of_another_converter_are_ignored() {
    let mut recording = record(Sensor::default(), &CYCLE, 3);
    let before = recording.parameters();
    let readings = recording.readings();
    let other = |full_scale| Channels {
        full_scale,
        counts: [0; 4].into_iter().collect(),
        unsent: Default::default(),
    };
    recording.push(Timestamp(5), &other(4_095));
    recording.push(Timestamp(u64::MAX), &other(255));
    assert_eq!((recording.readings(), recording.ignored()), (readings, 2));
    assert_eq!(recording.parameters(), before);
}

#[test]
fn a_hold_at_the_end_of_all_times_is_a_hold() {
    let mut recording = SensorRecording::new(Some(vec![0]));
    let channels = Channels {
        full_scale: 4_095,
        counts: [800].into_iter().collect(),
        unsent: Default::default(),
    };
    for before_end in (0..HOLD).rev() {
        let time = Timestamp(u64::MAX - before_end * PERIOD_US);
        recording.push(time, &channels);
    }
    let found = recording.parameters().remove(0);
    assert_close(found.jitter.unwrap(), 0.0, 0.1);
}
