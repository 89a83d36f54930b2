//! The parameters of the bend sensors of each hand as a table and as JSON.

use std::fmt;

use ademan::calibrate::{SensorParameters, SensorRecording};
use ademan::capture::{Reading, Sample};
use ademan::estimate::ChannelMap;
use ademan::hand::Side;
use ademan::layout::Glove;
use ademan::setup::LoadedSetup;
use serde_json::{Value, json};

/// The sensors of both hands; of neither if the source has no channels.
pub struct SensorTables {
    hands: Vec<HandSensors>,
}

struct HandSensors {
    side: Side,
    map: ChannelMap,
    recording: SensorRecording,
}

impl SensorTables {
    /// Creates the tables of the gloves of a setup.
    pub fn new(setup: &LoadedSetup) -> Self {
        Self {
            hands: setup.gloves().map(HandSensors::new).collect(),
        }
    }

    /// Adds a reading; one without channels changes nothing.
    pub fn push(&mut self, reading: &Reading) {
        let Sample::Channels(channels) = &reading.sample else {
            return;
        };
        let mut hands = self.hands.iter_mut();
        let hand = hands.find(|hand| reading.side.is_none_or(|side| side == hand.side));
        if let Some(hand) = hand {
            hand.recording.push(reading.time, channels);
        }
    }

    /// Returns the parameters of each sensor: counts, percent of the span, and degrees where the glove file has a gain.
    pub fn to_json(&self) -> Value {
        let hands = self.seen();
        hands.map(HandSensors::to_json).collect()
    }

    fn seen(&self) -> impl Iterator<Item = &HandSensors> {
        let hands = self.hands.iter();
        hands.filter(|hand| hand.recording.readings() > 0)
    }
}

impl HandSensors {
    fn new(glove: &Glove) -> Self {
        Self {
            side: glove.side,
            map: glove.map.clone(),
            recording: SensorRecording::new(Some(glove.map.angle_channels())),
        }
    }

    /// Returns the joints of a channel in the words of the glove file.
    fn joints(&self, channel: usize) -> Vec<&'static str> {
        let rows = self.map.rows().iter().filter(|row| row.channel == channel);
        rows.map(|row| row.dof.name()).collect()
    }

    /// Returns the degrees of one count.
    fn degrees_per_count(&self, channel: usize) -> Option<f64> {
        let mut rows = self.map.rows().iter();
        let row = rows.find(|row| row.channel == channel)?;
        Some(row.calibration.gain.abs().to_degrees())
    }

    fn to_json(&self) -> Value {
        let parameters = self.recording.parameters();
        let sensors = parameters.iter().map(|sensor| self.sensor_json(sensor));
        json!({
            "side": self.side.to_string(),
            "readings": self.recording.readings(),
            "ignored_readings": self.recording.ignored(),
            "full_scale": self.recording.full_scale(),
            "channels": sensors.collect::<Vec<_>>(),
        })
    }

    fn sensor_json(&self, sensor: &SensorParameters) -> Value {
        let span = sensor.span();
        let degrees = self.degrees_per_count(sensor.channel);
        let quantity = |counts: Option<f64>| {
            counts.map(|counts| {
                json!({
                    "counts": counts,
                    "percent": span.map(|span| counts / span * 100.0),
                    "deg": degrees.map(|degrees| counts * degrees),
                })
            })
        };
        let holds = sensor.holds;
        json!({
            "channel": sensor.channel,
            "joints": self.joints(sensor.channel),
            "holds": {"low": holds.low, "high": holds.high, "rising": holds.rising, "falling": holds.falling},
            "ends": sensor.ends.map(|(low, high)| [low, high]),
            "span": quantity(span),
            "resolution_deg": degrees,
            "jitter": quantity(sensor.jitter),
            "hysteresis": quantity(sensor.hysteresis),
            "repeatability": quantity(sensor.repeatability),
            "drift_per_minute": quantity(sensor.drift.map(|drift| drift.per_minute)),
            "drift_standard_error": quantity(sensor.drift.map(|drift| drift.standard_error)),
            "missing": sensor.missing(),
        })
    }

    fn write_row(&self, f: &mut fmt::Formatter<'_>, sensor: &SensorParameters) -> fmt::Result {
        let joints = self.joints(sensor.channel);
        let (first, others) = joints.split_first().unwrap_or((&"", &[]));
        let joint = match others.len() {
            0 => (*first).to_owned(),
            count => format!("{first} +{count}"),
        };
        let cell = |value: Option<f64>, decimals: usize| match value {
            Some(value) => format!("{value:.decimals$}"),
            None => "–".into(),
        };
        let span = sensor.span();
        let percent = |counts: Option<f64>| Some(counts? / span? * 100.0);
        let jitter_deg = sensor
            .jitter
            .zip(self.degrees_per_count(sensor.channel))
            .map(|(counts, degrees)| counts * degrees);
        writeln!(
            f,
            "{:>7}  {joint:<22} {:>6} {:>8} {:>6} {:>8} {:>7} {:>9}",
            sensor.channel,
            cell(span, 0),
            cell(sensor.jitter, 2),
            cell(jitter_deg, 2),
            cell(percent(sensor.hysteresis), 2),
            cell(percent(sensor.repeatability), 2),
            cell(percent(sensor.drift.map(|drift| drift.per_minute)), 2),
        )
    }
}

impl fmt::Display for SensorTables {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for hand in self.seen() {
            let parameters = hand.recording.parameters();
            writeln!(f, "\nsensors of the {} hand", hand.side)?;
            writeln!(
                f,
                "channel  joint                    span   jitter jitter  hyster-  repeat-     drift\n\
                 \x20                               counts   counts    deg  esis %  ability %    %/min"
            )?;
            for sensor in &parameters {
                hand.write_row(f, sensor)?;
            }
            let missing: Vec<_> = parameters
                .iter()
                .filter_map(|sensor| Some((sensor.channel, sensor.missing()?)))
                .collect();
            for (channel, reason) in &missing {
                writeln!(f, "channel {channel}: {reason}")?;
            }
            if !missing.is_empty() {
                writeln!(
                    f,
                    "Record at least three cycles of straight, half bent, closed and half bent, each held for 2 s: see \
                     docs/calibration.md#parameters-of-the-sensors"
                )?;
            }
            if hand.recording.ignored() > 0 {
                writeln!(
                    f,
                    "{} readings were not evaluated",
                    hand.recording.ignored()
                )?;
            }
        }
        Ok(())
    }
}
