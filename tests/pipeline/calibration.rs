//! Calibration of simulated people in gloves of which nothing is known but the shipped file.
//!
//! People and gloves are drawn from the ranges of `ademan::sim::SimulatedWearer`.

use std::time::Duration;

use ademan::calibrate::{
    CalibrationError, CalibrationResult, Observations, PoseMark, Problem, Procedure,
    at_their_fingers, finger_sensors, fit, observe_recording,
};
use ademan::capture::Channels;
use ademan::device::Events;
use ademan::document::Document;
use ademan::estimate::ChannelMap;
use ademan::files::Load;
use ademan::hand::{Dof, JointAngles, Side};
use ademan::layout::{Glove, write_calibration};
use ademan::setup::{ArmSetup, LoadedSetup, Setup};
use ademan::sim::{GloveFault, SimulatedWearer, UsTextField, error_rate, taps_for_text};
use ademan::time::Timestamp;

use crate::sighted_typist::SightedTypist;

/// The text of the demo.
const TEXT: &str = "Hola! Typed by a hand, 1 tap each.";

/// The number of random postures of each person.
const POSTURES: usize = 60;

/// The corrections that a person makes on the way to a key, at the key, and while pressing it.
const CORRECTIONS: usize = 3;

pub(super) fn person(seed: u64) -> SimulatedWearer {
    SimulatedWearer::new(seed, &shipped(), Side::Right)
}

fn shipped() -> ChannelMap {
    Glove::load("unam-hc11").unwrap().map
}

/// The readings, the times of the poses and the observations of a guided run.
struct Run {
    readings: Vec<(Timestamp, Channels)>,
    marks: Vec<PoseMark>,
    observations: Observations,
}

/// Leads a person through a procedure.
fn guide(wearer: &mut SimulatedWearer, mut procedure: Procedure) -> Run {
    let mut readings = Vec::new();
    while let Some(pose) = procedure.pose() {
        wearer.take(pose);
        let (time, channels) = wearer.next_packet();
        procedure.push(time, &channels);
        readings.push((time, channels));
        assert!(
            readings.len() < 20_000,
            "the person is never still in {pose}"
        );
    }
    Run {
        readings,
        marks: procedure.marks().to_vec(),
        observations: procedure.observations().clone(),
    }
}

fn procedure() -> Procedure {
    Procedure::for_glove(&shipped(), Duration::from_millis(1_500))
}

pub(super) fn calibrate(
    wearer: &mut SimulatedWearer,
) -> Result<CalibrationResult, CalibrationError> {
    fit(&guide(wearer, procedure()).observations, &shipped())
}

/// Returns the errors of all joints in random postures, in degrees.
fn joint_errors(wearer: &mut SimulatedWearer, map: &ChannelMap) -> Vec<f64> {
    let mut errors = Vec::new();
    for _ in 0..POSTURES {
        let angles = wearer.random_posture();
        let channels = wearer.read(&angles);
        for row in map
            .rows()
            .iter()
            .filter(|row| row.dof != Dof::ForearmSecondBone)
        {
            let radians = map.radians(row, f64::from(channels.counts[row.channel]));
            errors.push((radians - angles.get(row.dof)).to_degrees().abs());
        }
    }
    errors
}

fn percentile(errors: &[f64], fraction: f64) -> f64 {
    let mut sorted = errors.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * fraction).round() as usize]
}

/// Loads the setup of a person with a calibrated glove.
pub(super) fn load(
    wearer: &mut SimulatedWearer,
    map: &ChannelMap,
    learn_ranges: bool,
) -> LoadedSetup {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("glove.ron");
    let shipped = Document::shipped("unam-hc11").expect("a shipped glove");
    let text = write_calibration(&shipped, map, &JointAngles::default()).expect("a glove");
    std::fs::write(&path, text).expect("a file");
    let (hand, forearm) = wearer.measured_lengths();
    let setup = Setup {
        glove: Some(path.display().to_string()),
        arm: ArmSetup::Measured {
            hand_length_mm: hand * 1e3,
            forearm_length_mm: forearm * 1e3,
        },
        layout: "qwerty-flat".into(),
        learn_ranges,
        ..Setup::default()
    };
    setup.load_files().expect("a setup")
}

/// Returns the error rate of a person who types the text and makes at most `corrections` corrections for each key.
fn typing_error(wearer: &mut SimulatedWearer, map: &ChannelMap, corrections: usize) -> f64 {
    let setup = load(wearer, map, false);
    let loaded_map = &setup.glove.as_ref().unwrap().map;
    let taps = taps_for_text(TEXT, &setup.layout, false).unwrap();
    let typist = SightedTypist::new(
        wearer,
        &setup.layout.scene,
        loaded_map,
        &setup.arm,
        corrections,
    );
    let readings = typist.tap_all(&taps);
    let (mut pipeline, mut field, mut events) =
        (setup.pipeline(), UsTextField::new(), Events::new());
    for reading in &readings {
        events.clear();
        let _ = pipeline.step(reading, &mut events);
        events.iter().for_each(|event| field.handle(event));
    }
    error_rate(TEXT, field.text())
}

/// Prints a row of the table for each person and returns the joint errors of all, before and after the calibration.
fn joint_table(people: u64) -> [Vec<f64>; 2] {
    println!(
        "joint errors in {POSTURES} random postures of each person, before and after the calibration"
    );
    println!("person  score   before: median   95 %   after: median   95 %   problems");
    let mut all = [Vec::new(), Vec::new()];
    for seed in 0..people {
        let mut wearer = person(seed);
        let result = calibrate(&mut wearer).unwrap_or_else(|error| panic!("{seed}: {error}"));
        let before = joint_errors(&mut wearer, &shipped());
        let after = joint_errors(&mut wearer, &result.map);
        println!(
            "{seed:6} {:6} {:14.1}° {:5.1}° {:14.1}° {:5.1}°   {}",
            result.score,
            percentile(&before, 0.5),
            percentile(&before, 0.95),
            percentile(&after, 0.5),
            percentile(&after, 0.95),
            result.problems.len()
        );
        all[0].extend(before);
        all[1].extend(after);
    }
    all
}

/// Prints a row of the table for each person, and asserts that all of them together make at most 1 % of errors, and more than
/// half before. Some gloves type with their shipped values already.
fn check_typing(people: u64) {
    println!("error rate of {TEXT:?}, by corrections for each key");
    println!("person   before: 3   after: 0      1      2      3");
    let mut totals = [0.0; 2];
    for seed in 0..people {
        let mut wearer = person(seed);
        let percent = |typist: &SimulatedWearer, map: &ChannelMap, corrections| {
            100.0 * typing_error(&mut typist.clone(), map, corrections)
        };
        let before = percent(&wearer, &shipped(), CORRECTIONS);
        let result = calibrate(&mut wearer).unwrap();
        let [none, one, two] = [0, 1, 2].map(|count| percent(&wearer, &result.map, count));
        let after = percent(&wearer, &result.map, CORRECTIONS);
        println!("{seed:6} {before:9.1} % {none:9.1} % {one:5.1} {two:6.1} {after:6.1}");
        totals[0] += before;
        totals[1] += after;
    }
    let [before, after] = totals.map(|total| total / people as f64);
    println!("mean before the calibration: {before:.2} %, after: {after:.2} %");
    assert!(before > 50.0, "{before} %");
    assert!(after <= 1.0, "{after} %");
}

#[test]
fn fifty_people_have_their_joints_within_3_degrees_in_half_of_the_cases_and_8_in_most() {
    let [before, after] = joint_table(50).map(|errors| {
        let (median, high) = (percentile(&errors, 0.5), percentile(&errors, 0.95));
        println!("all people: median {median:.2}°, 95 % {high:.2}°");
        (median, high)
    });
    assert!(before.0 > 3.0 * after.0);
    let (median, high) = after;
    assert!(median <= 3.0 && high <= 8.0, "{median} {high}");
}

#[test]
fn the_curvature_of_bend_sensors_matters() {
    // A fit that expects linear sensors, as in a glove that scales its counts itself.
    let linear = shipped().with_full_range(true);
    let (mut curved_errors, mut linear_errors) = (Vec::new(), Vec::new());
    for seed in 0..50 {
        let mut wearer = person(seed);
        let observations = guide(&mut wearer, procedure()).observations;
        for (start, errors) in [
            (&shipped(), &mut curved_errors),
            (&linear, &mut linear_errors),
        ] {
            let map = fit(&observations, start).unwrap().map;
            errors.extend(joint_errors(&mut wearer.clone(), &map));
        }
    }
    let [curved_error, linear_error] =
        [curved_errors, linear_errors].map(|errors| percentile(&errors, 0.95));
    println!("95 %: {curved_error:.2}° with curvature, {linear_error:.2}° without");
    assert!(curved_error < linear_error, "{curved_error} {linear_error}");
}

#[test]
fn people_type_the_text_after_the_calibration() {
    check_typing(6);
}

#[test]
fn a_person_whose_wrist_bends_less_than_that_of_most_types_keys_at_both_ends() {
    // The calibration takes 15° for 21°, so keys to the left need an angle beyond the limit of the joint.
    let mut wearer = person(10);
    let map = calibrate(&mut wearer).unwrap().map;
    let error = typing_error(&mut wearer, &map, CORRECTIONS);
    assert!(error <= 0.01, "{error}");
}

#[test]
#[ignore = "takes minutes; `cargo test --test pipeline calibration:: -- --ignored --nocapture` prints the table"]
fn fifty_people_type_the_text_after_the_calibration() {
    check_typing(50);
}

#[test]
fn three_bad_gloves_are_refused_with_the_reason() {
    let reason = |fault: GloveFault| {
        let error = calibrate(&mut person(3).with_fault(fault)).unwrap_err();
        println!("{fault:?}: {error}");
        match error {
            CalibrationError::Unusable { problems } => problems,
            other => panic!("{other}"),
        }
    };
    let dead = reason(GloveFault::Dead(60));
    assert!(
        matches!(dead[..], [Problem::DeadChannel { channel: 60, .. }]),
        "{dead:?}"
    );
    let swapped = reason(GloveFault::Swapped(17, 4));
    assert!(
        matches!(
            swapped[..],
            [Problem::SwappedChannels {
                first: (4, _),
                second: (17, _)
            }]
        ),
        "{swapped:?}"
    );
    let mixed = reason(GloveFault::CrossTalk(12, 4, 0.9));
    assert!(
        matches!(
            mixed[..],
            [Problem::CrossTalk {
                channel: 12,
                source: (4, _),
                ..
            }]
        ),
        "{mixed:?}"
    );
}

#[test]
fn an_inverted_sensor_is_corrected() {
    let mut wearer = person(5).with_fault(GloveFault::Inverted(12));
    let result = calibrate(&mut wearer).unwrap();
    let is_named =
        |problem: &Problem| matches!(problem, Problem::InvertedChannel { channel: 12, .. });
    assert!(
        result.problems.iter().any(is_named),
        "{:?}",
        result.problems
    );
    let errors = joint_errors(&mut wearer, &result.map);
    assert!(percentile(&errors, 0.5) <= 3.0);
}

#[test]
fn swapped_sensors_of_two_fingers_are_found_by_bending_single_fingers() {
    let mut wearer = person(8).with_fault(GloveFault::Swapped(9, 52));
    let run = guide(&mut wearer, procedure().with_single_fingers(&shipped()));
    let error = fit(&run.observations, &shipped()).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("channels 9 (") && text.contains(") and 52 ("),
        "{text}"
    );
}

#[test]
fn exchanged_sensors_are_put_right_and_sound_gloves_stay_as_they_are() {
    let map = shipped();
    let mut errors = Vec::new();
    for seed in 0..20 {
        let mut sound = person(seed);
        let all_sound = guide(&mut sound, procedure().with_single_fingers(&map));
        let sensors = finger_sensors(&all_sound.observations, &map).unwrap();
        assert_eq!(
            at_their_fingers(&sensors, &map),
            None,
            "{seed}: {sensors:?}"
        );

        let mut wearer = person(seed).with_fault(GloveFault::Swapped(9, 52));
        let run = guide(&mut wearer, procedure().with_single_fingers(&map));
        let exchanged = finger_sensors(&run.observations, &map).unwrap();
        let matched = at_their_fingers(&exchanged, &map);
        let matched = matched.unwrap_or_else(|| panic!("{seed}: {exchanged:?}"));
        let result = fit(&run.observations.without_single_fingers(), &matched);
        errors.extend(joint_errors(&mut wearer, &result.unwrap().map));
    }
    let median = percentile(&errors, 0.5);
    assert!(median <= 3.0, "{median}");
}

#[test]
fn a_recording_gives_the_same_calibration_with_marks_and_a_similar_one_without() {
    let mut wearer = person(2);
    let run = guide(&mut wearer, procedure());
    let map = shipped();
    let live = fit(&run.observations, &map).unwrap();
    let marked = observe_recording(&run.readings, &run.marks, &map).unwrap();
    assert_eq!(marked, run.observations);
    let found = observe_recording(&run.readings, &[], &map).unwrap();
    let again = observe_recording(&run.readings, &[], &map).unwrap();
    assert_eq!(found, again);
    let found = fit(&found, &map).unwrap();
    for (live_row, found_row) in live.map.rows().iter().zip(found.map.rows()) {
        let difference = live_row.calibration.apply(100.0) - found_row.calibration.apply(100.0);
        assert!(
            difference.to_degrees().abs() < 3.0,
            "{} {difference}",
            live_row.dof
        );
    }
}

#[test]
fn a_recording_with_a_pose_too_few_is_refused() {
    let run = guide(&mut person(2), procedure());
    let half = run.readings.len() / 2;
    let error = observe_recording(&run.readings[..half], &[], &shipped()).unwrap_err();
    assert!(
        matches!(error, CalibrationError::PosesNotFound { expected: 13, found } if found < 13),
        "{error}"
    );
    let empty_error = observe_recording(&[], &[], &shipped()).unwrap_err();
    assert_eq!(empty_error, CalibrationError::NoChannels);
}
