//! The calibration of a source that measures positions: lengths for the setup, and the place of a board on a table.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError};

use ademan::calibrate::positions::{
    HandLengths, PositionError, TablePlane, board_on_table, measure_lengths,
};
use ademan::capture::{CaptureEvent, Reading, Sample, SourceUri, spawn};
use ademan::contact::board_pose::BoardPose;
use ademan::estimate::{Estimator, EstimatorSettings, Smoothing};
use ademan::hand::JointPositions;
use ademan::message::escape;
use ademan::setup::LoadedSetup;

use super::lengths::{self, LengthArgs};
use crate::failure::Failure;

/// The time for which positions of a live source are collected, from the first one on.
const TIME: Duration = Duration::from_secs(5);

/// The time for which a live source may show nothing at first: a person starts the program that sends, or puts a headset on.
const MAX_WAIT: Duration = Duration::from_secs(60);

/// The most positions that are collected: about 60 MB. A camera shows as many in half an hour.
const MAX_POSITIONS: usize = 100_000;

/// The radius of a fingertip, in metres: the radius in arm models from lengths.
const TIP_RADIUS: f64 = 0.005;

/// Measures the hand of a source and prints what belongs in the setup and the layout.
///
/// `typed` are lengths that were measured with a ruler. They take precedence.
pub fn run(setup: &LoadedSetup, source: &SourceUri, typed: LengthArgs) -> Result<(), Failure> {
    writeln!(
        io::stdout(),
        "lay the hand on the table so that all five fingertips touch it, spread, for {} s",
        TIME.as_secs()
    )?;
    let positions = collect(setup, source)?;
    let lengths = measure_lengths(&positions).and_then(|measured| {
        let lengths = typed.or(measured);
        lengths.check()?;
        Ok(lengths)
    });
    let table = TablePlane::fit(&positions, TIP_RADIUS);
    let mut out = io::stdout().lock();
    writeln!(out, "{}", describe_lengths(&lengths))?;
    writeln!(out, "{}", describe_table(&table))?;
    if let Some(board) = table
        .as_ref()
        .ok()
        .and_then(|table| board_on_table(table, &positions))
    {
        writeln!(out, "{}", describe_board(&board))?;
    }
    match (lengths, table) {
        (Err(error), Err(_)) => Err(Failure::job(format!("nothing was measured: {error}"))),
        _ => Ok(()),
    }
}

/// Collects the positions of a live source for a few seconds, or of another source to its end. Fails if it shows none.
fn collect(setup: &LoadedSetup, source: &SourceUri) -> Result<Vec<JointPositions>, Failure> {
    let capture = spawn(setup.open_source_alone(source)?)?;
    match collect_from(capture.events(), capture.is_live(), MAX_POSITIONS)? {
        Some(positions) => Ok(positions),
        None => Err(Failure::wrong_use(format!(
            "{} has more than {MAX_POSITIONS} readings; calibrate with a shorter recording",
            escape(capture.name())
        ))),
    }
}

/// Collects positions until the time of a live source is over, or the source or its thread ends. Returns `None` if there are more than
/// `limit`, and fails if there is none.
fn collect_from(
    events: &Receiver<CaptureEvent>,
    is_live: bool,
    limit: usize,
) -> Result<Option<Vec<JointPositions>>, Failure> {
    // A filter delays, and a limit hides movement.
    let mut estimator = Estimator::new(EstimatorSettings::unchecked(Smoothing::Off));
    let mut positions = Vec::new();
    let (mut is_waiting, mut has_others) = (is_live, false);
    let mut end = is_live.then(|| Instant::now() + MAX_WAIT);
    while end.is_none_or(|time| Instant::now() < time) {
        match events.recv_timeout(Duration::from_millis(20)) {
            Ok(CaptureEvent::Reading { reading, .. }) => {
                positions.extend(measured(&mut estimator, &reading));
                let has_positions =
                    matches!(reading.sample, Sample::Joints { .. } | Sample::Body(_));
                has_others |= !has_positions;
                if is_waiting && (has_others || !positions.is_empty()) {
                    is_waiting = false;
                    end = Some(Instant::now() + TIME);
                }
                if positions.len() > limit {
                    return Ok(None);
                }
            }
            // A thread that is gone sends no end.
            Ok(CaptureEvent::End(_)) | Err(RecvTimeoutError::Disconnected) => break,
            Ok(CaptureEvent::Lost(error) | CaptureEvent::Failed(error)) => return Err(error.into()),
            Ok(_) | Err(RecvTimeoutError::Timeout) => {}
        }
    }
    if !positions.is_empty() {
        return Ok(Some(positions));
    }
    Err(if has_others {
        Failure::wrong_use(
            "this source measures no positions of joints, and needs no glove file: there is nothing to calibrate",
        )
    } else {
        Failure::job(
            "the source has shown no hand; start what sends to it, and keep the whole hand in view",
        )
    })
}

/// Returns the joints that a reading shows, or `None` if it shows none.
fn measured(estimator: &mut Estimator, reading: &Reading) -> Option<JointPositions> {
    let estimate = estimator.update(reading).ok()?;
    let mut positions = JointPositions::default();
    for (joint, position) in estimate.measured.iter() {
        positions.set(joint, position.as_dvec3());
    }
    (!positions.is_empty()).then_some(positions)
}

fn describe_lengths(lengths: &Result<HandLengths, PositionError>) -> String {
    let millimetres = |metres: f64| (metres * 1e3).round();
    match lengths {
        Ok(HandLengths {
            hand: Some(hand),
            forearm: Some(forearm),
        }) => format!(
            "in the setup file: arm: {}",
            lengths::arm_text(*hand, *forearm)
        ),
        Ok(HandLengths {
            hand: Some(hand), ..
        }) => format!(
            "hand length: {} mm; the source does not show the elbow, so measure the forearm with a ruler, and add --forearm-length MM",
            millimetres(*hand)
        ),
        Ok(HandLengths { forearm, .. }) => format!(
            "forearm length: {} mm; the source does not show the fingers, so measure the hand with a ruler, and add --hand-length MM",
            millimetres(forearm.unwrap_or_default())
        ),
        Err(error) => format!("no lengths: {error}"),
    }
}

fn describe_table(table: &Result<TablePlane, PositionError>) -> String {
    match table {
        Ok(table) => format!(
            "table: {:.0} mm high, slope {:.0}°, fingertips within {:.0} mm",
            table.point.y * 1e3,
            table.normal.y.acos().to_degrees(),
            table.error * 1e3
        ),
        Err(error) => format!("no table: {error}"),
    }
}

fn describe_board(board: &BoardPose) -> String {
    let millimetres = |metres: f32| (metres * 1e3).round() + 0.0;
    let degrees = |radians: f32| radians.to_degrees().round() + 0.0;
    format!(
        "in the layout: pose: (anchor: world, bearing_deg: {}, right_mm: {}, forward_mm: {}, height_mm: {}, tilt_deg: {})",
        degrees(board.bearing),
        millimetres(board.right),
        millimetres(board.forward),
        millimetres(board.height),
        degrees(board.tilt)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan::capture::SourceStats;
    use ademan::hand::{Joint, JointAngles};
    use ademan::time::Timestamp;
    use crossbeam_channel::unbounded;

    /// Returns the events of a source that shows the joints `count` times before its thread ends.
    fn events(count: u64) -> Receiver<CaptureEvent> {
        let mut positions = JointPositions::default();
        positions.set(Joint::Elbow, [0.0; 3].into());
        positions.set(Joint::Wrist, [0.0, 0.0, -0.25].into());
        events_of(&Sample::Joints { positions }, count)
    }

    fn events_of(sample: &Sample, count: u64) -> Receiver<CaptureEvent> {
        let (sender, events) = unbounded();
        for number in 0..count {
            let time = Timestamp(10_000 * number);
            let reading = Reading::new(time, None, sample.clone());
            let event = CaptureEvent::Reading {
                reading,
                received_at: Instant::now(),
                stats: SourceStats::default(),
            };
            sender.send(event).expect("the receiver is there");
        }
        events
    }

    #[test]
    fn a_source_whose_thread_is_gone_is_at_its_end() {
        let collected = collect_from(&events(3), false, 3).expect("no failure");
        assert_eq!(collected.expect("few positions").len(), 3);
    }

    #[test]
    fn a_source_with_too_many_positions_is_refused() {
        let collected = collect_from(&events(4), false, 3).expect("no failure");
        assert!(collected.is_none());
    }

    #[test]
    fn a_source_that_shows_no_hand_is_told_from_one_that_measures_no_positions() {
        let unseen = Sample::Joints {
            positions: JointPositions::default(),
        };
        let angles = Sample::Angles {
            angles: JointAngles::default(),
        };
        for (sample, count, expected) in [
            (&unseen, 3, "the source has shown no hand"),
            (&unseen, 0, "the source has shown no hand"),
            (&angles, 3, "measures no positions of joints"),
        ] {
            let collected = collect_from(&events_of(sample, count), true, 3);
            let error = collected.expect_err("no positions").to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
