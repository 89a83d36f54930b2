//! The result of a calibration as text: the score, the problems, and the angles before and after.

use std::fmt::Write;

use ademan::calibrate::{CalibrationResult, Observations};
use ademan::estimate::{ChannelMap, ChannelRow};

/// Returns the report of a calibration that started from `start`.
pub fn report(
    result: &CalibrationResult,
    observations: &Observations,
    start: &ChannelMap,
) -> String {
    let mut text = format!("score {} of 100\n", result.score);
    for problem in &result.problems {
        let _ = writeln!(text, "- {problem}");
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

/// Returns the angles of a row at the ends of its range, in degrees.
fn angles(map: &ChannelMap, row: &ChannelRow, low: f64, high: f64) -> String {
    let degrees = |count| map.radians(row, count).to_degrees().round() + 0.0;
    let (one, other) = (degrees(low), degrees(high));
    format!("{}..{}°", one.min(other), one.max(other))
}
