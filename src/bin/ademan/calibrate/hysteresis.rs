//! `ademan calibrate --hysteresis`: writes the hysteresis of the sensors to a glove file.

use std::fmt::Write;
use std::path::PathBuf;
use std::str::FromStr;

use ademan::calibrate::SensorRecording;
use ademan::estimate::{ChannelMap, MAX_HYSTERESIS};
use ademan::hand::JointAngles;
use ademan::layout;
use ademan::message::escape_path;

use super::destination::Destination;
use super::{Args, Start, glove_document, recording};
use crate::failure::Failure;

/// A smaller hysteresis is within the steps of the counts.
const LEAST_COUNTS: f64 = 0.5;

/// The source of the hysteresis of the sensors.
#[derive(Clone, Debug)]
pub enum Hysteresis {
    /// A percentage of the calibrated range of each finger sensor.
    Percent(f64),
    /// A recording of sensor cycles.
    Measured(PathBuf),
}

impl FromStr for Hysteresis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let Some(number) = text.strip_suffix('%') else {
            let is_number = text.trim().replace(',', ".").parse::<f64>().is_ok();
            if is_number {
                return Err("a percentage ends with `%`, such as 4%".to_owned());
            }
            return Ok(Self::Measured(text.into()));
        };
        let percent = number.trim().parse().ok();
        let percent = percent.filter(|percent| (0.0..=20.0).contains(percent));
        percent.map(Self::Percent).ok_or_else(|| {
            "expected 0 to 20 percent, such as 4%, or a recording of sensor cycles".to_owned()
        })
    }
}

/// Writes the glove file with the hysteresis of its sensors.
pub fn run(hysteresis: &Hysteresis, args: Args) -> Result<(), Failure> {
    let start = Start::new(glove_document(&args.load_setup()?)?)?;
    let map = &start.glove.map;
    let (found, missing) = match hysteresis {
        Hysteresis::Percent(percent) => of_ranges(map, *percent),
        Hysteresis::Measured(path) => {
            let readings = recording::read(path)?.take_readings(start.glove.side)?;
            let mut cycles = SensorRecording::new(Some(map.angle_channels()));
            for (time, counts) in &readings {
                cycles.push(*time, counts);
            }
            measured(map, &cycles)
        }
    };
    if found.is_empty() {
        return Err(Failure::wrong_use(format!(
            "no sensor has a known hysteresis: {}",
            match hysteresis {
                Hysteresis::Percent(_) =>
                    "the glove file has no `range_counts` of a finger; calibrate the glove first, which writes them"
                        .to_owned(),
                Hysteresis::Measured(path) => format!(
                    "{}; record the cycles of docs/calibration.md#parameters-of-the-sensors as {}",
                    missing.lines().next().unwrap_or_default(),
                    escape_path(path)
                ),
            }
        )));
    }
    let destination = Destination::new(args.out, &start.document, args.force)?;
    let mut hystereses = map.hystereses().to_vec();
    hystereses.retain(|(channel, _)| found.iter().all(|(other, _)| other != channel));
    hystereses.extend(found.iter().filter(|(_, counts)| *counts >= LEAST_COUNTS));
    hystereses.sort_by_key(|(channel, _)| *channel);
    let report = format!("{}{missing}\n", table(map, &found));
    let map = map.clone().with_hystereses(hystereses);
    let text = layout::write_calibration(&start.document, &map, &JointAngles::default())?;
    destination.write(&text, &report)?;
    Ok(())
}

/// The hysteresis of channels in counts, and a line for each channel without one.
type Found = (Vec<(usize, f64)>, String);

/// Returns a part of the ranges of the finger sensors: a wrong hysteresis of the arm would move the whole hand.
fn of_ranges(map: &ChannelMap, percent: f64) -> Found {
    let mut found = Vec::new();
    let mut without_range = Vec::new();
    let is_of_finger = |&channel: &usize| {
        let mut rows = map.rows().iter().filter(|row| row.channel == channel);
        rows.all(|row| row.dof.finger().is_some())
    };
    for channel in map.angle_channels().into_iter().filter(is_of_finger) {
        match map.range(channel) {
            Some((low, high)) => found.push((channel, (high - low) * percent / 100.0)),
            None => without_range.push(channel.to_string()),
        }
    }
    let missing = if without_range.is_empty() {
        String::new()
    } else {
        let channels = without_range.join(", ");
        format!(
            "channels {channels}: no `range_counts`; the calibration got no counts of them, or found a fault\n"
        )
    };
    (within_limit(map, found), missing)
}

fn measured(map: &ChannelMap, cycles: &SensorRecording) -> Found {
    let mut found = Vec::new();
    let mut missing = String::new();
    for sensor in cycles.parameters() {
        match sensor.hysteresis {
            Some(counts) => found.push((sensor.channel, counts.max(0.0))),
            None => {
                let reason = sensor.missing().unwrap_or_default();
                _ = writeln!(missing, "channel {}: {reason}", sensor.channel);
            }
        }
    }
    if found.is_empty() && missing.is_empty() {
        missing.push_str("the recording has no sensor channels\n");
    }
    (within_limit(map, found), missing)
}

fn within_limit(map: &ChannelMap, mut found: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let limit = MAX_HYSTERESIS * f64::from(map.full_scale());
    for (_, counts) in &mut found {
        *counts = counts.min(limit);
    }
    found
}

fn table(map: &ChannelMap, found: &[(usize, f64)]) -> String {
    let mut table = String::from("channel  joint                  hysteresis\n");
    for &(channel, counts) in found {
        let mut rows = map.rows().iter();
        let row = rows.find(|row| row.channel == channel);
        let Some(row) = row else { continue };
        let degrees = counts * row.calibration.gain.abs().to_degrees();
        let joint = row.dof.name();
        if counts < LEAST_COUNTS {
            _ = writeln!(table, "{channel:>7}  {joint:<22} none");
        } else {
            _ = writeln!(
                table,
                "{channel:>7}  {joint:<22} {counts:.1} counts, {degrees:.1}°"
            );
        }
    }
    table
}
