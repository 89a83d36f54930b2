//! The result of a calibration as text: the score, the problems, and the angles before and after.

use std::fmt::Write;

use ademan::calibrate::{CalibrationResult, FingerSensor, Observations, Problem, problem_messages};
use ademan::estimate::{ChannelMap, ChannelRow};
use ademan::hand::Finger;

/// Returns the report of a calibration that started from `start`.
pub fn report(
    result: &CalibrationResult,
    observations: &Observations,
    start: &ChannelMap,
) -> String {
    let mut text = format!("score {} of 100\n", result.score);
    for (_, message) in problem_messages(&result.problems) {
        let _ = writeln!(text, "- {message}");
    }
    let is_dead = |problem: &Problem| matches!(problem, Problem::DeadChannel { .. });
    if result.problems.iter().any(is_dead) {
        text.push_str("- a joint with a dead sensor is straight in the new file\n");
    }
    let _ = writeln!(
        text,
        "\n{:<22}{:>11}  {:>14}  {:>14}",
        "joint", "counts", "before", "after"
    );
    for (old, new) in start.rows().iter().zip(result.map.rows()) {
        let range = observations.range(new.channel);
        let Some((low, high)) = range.filter(|_| observations.is_sent(new.channel)) else {
            let reason = match range {
                Some(_) => "not sent",
                None => "not seen",
            };
            let _ = writeln!(text, "{:<22}{reason:>11}", new.dof.name());
            continue;
        };
        let counts = format!("{low:.0}..{high:.0}");
        let before = angles(start, old, low, high);
        let after = angles(&result.map, new, low, high);
        let name = new.dof.name();
        let _ = writeln!(text, "{name:<22}{counts:>11}  {before:>14}  {after:>14}");
    }
    text
}

/// The report if a pose of a single finger was skipped.
pub const NOT_COMPARED: &str =
    "the sensors of the fingers were not compared: a pose that bends one finger was skipped\n\n";

/// Returns the channels that follow each finger, and what the new file makes of exchanged ones. `is_matched` states that the new file
/// has each sensor at its finger.
pub fn fingers(sensors: &[FingerSensor], is_matched: bool) -> String {
    let mut text = "finger   channels that follow it\n".to_owned();
    for &finger in Finger::ALL {
        let mut parts: Vec<String> = Vec::new();
        for &stated in Finger::ALL {
            let own = sensors.iter().filter(|sensor| sensor.stated == stated);
            let own = own.filter(|sensor| sensor.followed == Some(finger));
            let channels: Vec<String> = own.map(|sensor| sensor.channel.to_string()).collect();
            let list = channels.join(", ");
            if stated == finger && !channels.is_empty() {
                parts.push(list);
            } else if !channels.is_empty() {
                parts.push(format!("{list} (starting glove: {stated})"));
            }
        }
        let shown = if parts.is_empty() {
            "none".to_owned()
        } else {
            parts.join(", ")
        };
        let _ = writeln!(text, "{:<9}{shown}", finger.name());
    }
    if is_matched {
        text.push_str("exchanged sensors: the new file has each at the finger that it follows\n");
    } else if sensors.iter().any(FingerSensor::is_moved) {
        text.push_str(
            "a finger has more sensors than in the starting glove, so the channels stay: a sensor without contact follows its neighbor; check its wires, \
             or exchange plugs or numbers in the glove file\n",
        );
    }
    text.push('\n');
    text
}

/// Returns the angles of a row at the ends of its range, in degrees.
fn angles(map: &ChannelMap, row: &ChannelRow, low: f64, high: f64) -> String {
    let degrees = |count| map.radians(row, count).to_degrees().round() + 0.0;
    let (one, other) = (degrees(low), degrees(high));
    format!("{}..{}°", one.min(other), one.max(other))
}
