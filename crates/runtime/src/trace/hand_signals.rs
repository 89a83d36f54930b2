//! Jitter and lag of the angles and fingertips of each hand: those after the filters against those before.

use std::fmt;

use serde_json::{Value, json};

use super::signal::{SignalReport, SignalStats, WINDOW};
use ademan_core::device::Events;
use ademan_core::hand::{Finger, JointAngles, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::pipeline::{Pipeline, StepOutput};
use ademan_core::snapshot::Snapshot;

/// Jitter and lag of both hands of a session.
///
/// A second pipeline without filters gets the same readings.
pub struct HandSignals {
    unfiltered: Pipeline,
    /// The signals of each hand, by side.
    hands: [HandSignal; Side::COUNT],
}

#[derive(Default)]
struct HandSignal {
    readings: u64,
    angles: SignalStats,
    fingertips: SignalStats,
}

impl HandSignals {
    /// Creates the statistics of a session. `unfiltered` is its pipeline without filters.
    pub fn new(unfiltered: Pipeline) -> Self {
        Self {
            unfiltered,
            hands: Default::default(),
        }
    }

    /// Adds the reading of a snapshot.
    pub fn update(&mut self, snapshot: &Snapshot) {
        let Some(reading) = &snapshot.reading else {
            return;
        };
        let raw = self.unfiltered.step(reading, &mut Events::new());
        let (Ok(raw), Some(angles), Some(pose)) = (raw, &snapshot.angles, &snapshot.pose) else {
            return;
        };
        if raw.pose.untrusted != pose.untrusted {
            return;
        }
        self.hands[pose.side.index()].push(raw, angles, pose);
    }
}

impl HandSignals {
    /// Returns jitter and lag of each hand with a reading.
    pub fn to_json(&self) -> Value {
        let hands = Side::ALL.iter().zip(&self.hands);
        let hands = hands.filter(|(_, hand)| hand.readings > 0);
        hands
            .map(|(side, hand)| {
                let (angles, fingertips) = (hand.angles.report(), hand.fingertips.report());
                json!({
                    "side": side.to_string(),
                    "readings": hand.readings,
                    "angles_deg": report_json(&angles),
                    "fingertips_mm": report_json(&fingertips),
                })
            })
            .collect()
    }
}

fn report_json(report: &SignalReport) -> Value {
    json!({
        "jitter_raw": report.jitter.map(|[raw, _]| raw),
        "jitter_filtered": report.jitter.map(|[_, filtered]| filtered),
        "lag_ms": report.lag.map(|lag| lag.as_secs_f64() * 1000.0),
    })
}

impl HandSignal {
    fn push(&mut self, raw: &StepOutput, angles: &JointAngles, pose: &HandPose) {
        self.readings += 1;
        let known = angles.known();
        let known = known.filter(|(dof, _)| raw.estimate.angles.is_known(*dof));
        let (raw_angles, filtered): (Vec<f64>, Vec<f64>) = known
            .map(|(dof, angle)| {
                let raw = raw.estimate.angles.get(dof);
                (raw.to_degrees(), angle.to_degrees())
            })
            .unzip();
        self.angles.push(pose.time, &raw_angles, &filtered);
        self.fingertips
            .push(pose.time, &fingertips_mm(&raw.pose), &fingertips_mm(pose));
    }
}

fn fingertips_mm(pose: &HandPose) -> Vec<f64> {
    let tips = Finger::ALL.iter().map(|&finger| pose.fingertip(finger));
    tips.flatten()
        .flat_map(|tip| tip.to_array())
        .map(|metres| f64::from(metres) * 1000.0)
        .collect()
}

impl fmt::Display for HandSignals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hands = Side::ALL.iter().zip(&self.hands);
        for (side, hand) in hands.filter(|(_, hand)| hand.readings > 0) {
            writeln!(f, "{side} hand, {} readings", hand.readings)?;
            writeln!(f, "                    raw   filtered   lag of the filter")?;
            write_row(f, "angles", "deg", &hand.angles.report())?;
            write_row(f, "fingertips", "mm", &hand.fingertips.report())?;
        }
        let window = WINDOW.as_secs_f64();
        writeln!(
            f,
            "Jitter: RMS deviation from the mean of windows of {window} s, over the quietest fifth of them. Lag: shift of the \
             speeds with the highest correlation; the delay of the sensor is not included."
        )
    }
}

fn write_row(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    unit: &str,
    report: &SignalReport,
) -> fmt::Result {
    write!(f, "{name:<10} {unit:<3}")?;
    match report.jitter {
        Some([raw, filtered]) => write!(f, " {raw:>8.3}   {filtered:>8.3}")?,
        None => write!(f, " {:>8}   {:>8}", "–", "–")?,
    }
    match report.lag {
        Some(lag) => writeln!(f, "   {:.1} ms", lag.as_secs_f64() * 1000.0),
        None => writeln!(f, "   no movement"),
    }
}
