//! Fast taps at a low rate of readings: none is missed, and times are interpolated.

use ademan::contact::{Phase, Touches};
use ademan::device::{EventKind, Events};
use ademan::hand::{Finger, Joint};
use ademan::time::Timestamp;
use fastrand::Rng;
use parry3d::math::{Pose, Vec3};

use super::between;
use crate::rig::Rig;
use crate::rig::board::{PITCH, TRAVEL, world_from_board};
use crate::rig::fingers::TIP_RADIUS;

/// Readings per second of the glove at 9600 baud and 66 bytes per packet.
const READINGS_PER_SECOND: f64 = 14.5;

/// Gives the rig one step with the index pad at a point of the board, in metres.
fn show(rig: &mut Rig, seconds: f64, pad: Vec3, touches: &mut Touches, events: &mut Events) {
    let mut pose = rig.pose();
    pose.time = Timestamp::from_seconds(seconds);
    let center = world_from_board().transform_point(pad + Vec3::Z * TIP_RADIUS);
    pose.set(Joint::tip(Finger::Index), Pose::from_translation(center));
    touches.clear();
    rig.track(&pose, touches);
    events.clear();
    rig.update(&pose, touches, events);
}

/// Returns the height of the pad above the board: down and up at `speed`, lowest at time 0.
fn tap_height(seconds: f64, speed: f64, lowest: f64) -> f64 {
    (lowest + speed * seconds.abs()).min(0.06)
}

#[test]
fn every_tap_at_1_metre_per_second_and_14_readings_per_second_is_one_press() {
    let mut random = Rng::with_seed(1);
    let mut rig = Rig::with_keys("q w e r / a s d f / z x c v");
    let (mut touches, mut events) = (Touches::new(), Events::new());
    let codes = ["Q", "W", "E", "R", "A", "S", "D", "F", "Z", "X", "C", "V"];
    let mut readings = 0;
    for tap in 0..600 {
        let key = random.usize(..codes.len());
        let center = Vec3::new((key % 4) as f32 * PITCH, -((key / 4) as f32) * PITCH, 0.0);
        let mut aside = || between(&mut random, -0.006, 0.006) as f32;
        let position = center + Vec3::new(aside(), aside(), 0.0);
        let drift = between(&mut random, -0.015, 0.015) as f32;
        // It stays deep enough for at least one reading; a tap between two readings is invisible.
        let speed = between(&mut random, 0.8, 1.0);
        let lowest = -0.0021 - between(&mut random, 0.5, 0.7) * speed / READINGS_PER_SECOND;
        let phase = between(&mut random, 0.0, 1.0);
        let mut emitted = Vec::new();
        for reading in 0..8 {
            let seconds = (f64::from(reading) - 4.0 + phase) / READINGS_PER_SECOND;
            let height = tap_height(seconds, speed, lowest) as f32;
            let pad = position + Vec3::new(drift * seconds as f32, 0.0, height);
            readings += 1;
            let now = f64::from(readings) / READINGS_PER_SECOND;
            show(&mut rig, now, pad, &mut touches, &mut events);
            emitted.extend(events.iter().map(|event| event.kind));
        }
        let code = codes[key].parse().unwrap();
        assert_eq!(
            emitted,
            [EventKind::KeyDown(code), EventKind::KeyUp(code)],
            "tap {tap}"
        );
    }
}

#[test]
fn press_times_are_exact_to_a_microsecond_at_constant_speed() {
    let mut random = Rng::with_seed(2);
    for _ in 0..200 {
        let mut rig = Rig::with_keys("q");
        let (mut touches, mut events) = (Touches::new(), Events::new());
        let period = 1.0 / between(&mut random, 10.0, 200.0);
        let speed = between(&mut random, 0.05, 1.0);
        let start = between(&mut random, 0.001, 0.05);
        let mut found = Vec::new();
        for number in 0..2000 {
            let seconds = period * f64::from(number);
            // The time stamps of readings are whole microseconds.
            let rounded = Timestamp::from_seconds(seconds).seconds();
            let pad = Vec3::new(0.0, 0.0, (start - speed * rounded) as f32);
            show(&mut rig, seconds, pad, &mut touches, &mut events);
            found.extend(touches.iter().copied());
            if found.iter().any(|touch| touch.phase == Phase::Pressed) {
                break;
            }
        }
        for (phase, depth) in [
            (Phase::Touched, 0.0),
            (Phase::Pressed, 0.5 * f64::from(TRAVEL)),
        ] {
            let touch = found.iter().find(|touch| touch.phase == phase).unwrap();
            let expected = (start + depth) / speed;
            let late = (touch.time.seconds() - expected) * 1e6;
            assert!(late.abs() <= 1.0, "{phase} {late} µs late at {speed} m/s");
        }
    }
}
