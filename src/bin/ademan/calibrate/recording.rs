//! The recording of a calibration: the readings, with the times of the poses and the glove file from which it started.

use std::path::Path;

use ademan::calibrate::{MARKS_KIND, PoseMark, marks_from_text, marks_to_text};
use ademan::capture::recording::{RecordedSetup, Replay, SetupText};
use ademan::capture::{Channels, Reading, Sample, Source, SourceEvent};
use ademan::document::Document;
use ademan::hand::Side;
use ademan::message::escape_path;
use ademan::recorder::Recorder;
use ademan::time::Timestamp;

use super::session::Readings;
use crate::failure::Failure;

/// The kind of the setup text with the glove file.
const GLOVE_KIND: &str = "glove";

/// Largest size of the readings in memory beyond the size of their file: a compressed file could expand to any size.
const MAX_EXPANSION_BYTES: u64 = 64 << 20;

/// A reading with the hand that it states.
type SidedReading = (Option<Side>, Timestamp, Channels);

/// A recorded calibration.
pub struct RecordedCalibration {
    readings: Vec<SidedReading>,
    pub marks: Vec<PoseMark>,
    /// The glove file from which it started, if the recording has one.
    pub glove: Option<Document>,
}

impl RecordedCalibration {
    /// Takes the readings of a hand, and those that state none: a run with two gloves has both hands.
    ///
    /// # Errors
    /// Fails if all readings are of the other hand.
    pub fn take_readings(&mut self, side: Side) -> Result<Readings, Failure> {
        let all = std::mem::take(&mut self.readings);
        let has_none = all.is_empty();
        let is_own = |(worn, ..): &SidedReading| worn.is_none_or(|hand| hand == side);
        let own = all.into_iter().filter(is_own);
        let own: Readings = own.map(|(_, time, counts)| (time, counts)).collect();
        if own.is_empty() && !has_none {
            let other = side.opposite();
            return Err(Failure::wrong_use(format!(
                "the recording has readings of the {other} hand only, and the glove is for the {side} hand; name a glove for the \
                 {other} hand with --glove"
            )));
        }
        Ok(own)
    }
}

/// Writes a recording. Fails if the file exists.
pub fn write(
    path: &Path,
    glove: &Document,
    marks: &[PoseMark],
    readings: &Readings,
) -> Result<(), Failure> {
    let setup = RecordedSetup::default()
        .with(GLOVE_KIND, &glove.file, &glove.text)
        .with(MARKS_KIND, "poses", &marks_to_text(marks));
    let mut recorder = Recorder::create(path, &setup)?;
    for (time, channels) in readings {
        let reading = Reading::new(*time, None, Sample::Channels(channels.clone()));
        recorder.write_reading(&reading)?;
    }
    Ok(recorder.finish()?)
}

/// Reads a recording of a calibration or of a run.
pub fn read(path: &Path) -> Result<RecordedCalibration, Failure> {
    let mut replay = Replay::open(path)?;
    let setup = replay.setup().clone();
    let document = |entry: &SetupText| Document::new(entry.name.as_str(), entry.text.as_str());
    let marks = setup.get(MARKS_KIND);
    let marks = marks.map(|marks| marks_from_text(&marks.text));
    let mut readings: Vec<SidedReading> = Vec::new();
    loop {
        match replay.next()? {
            SourceEvent::Reading(reading) => {
                if let Sample::Channels(channels) = reading.sample {
                    readings.push((reading.side, reading.time, channels));
                }
                let bytes = (readings.len() * size_of::<SidedReading>()) as u64;
                if bytes > MAX_EXPANSION_BYTES + replay.stats().bytes {
                    return Err(Failure::wrong_use(format!(
                        "{} has more than {} readings; calibrate with a shorter recording",
                        escape_path(path),
                        readings.len()
                    )));
                }
            }
            SourceEvent::Idle | SourceEvent::Command(_) => {}
            SourceEvent::End => break,
        }
    }
    Ok(RecordedCalibration {
        readings,
        marks: marks.transpose()?.unwrap_or_default(),
        glove: setup.get(GLOVE_KIND).map(document),
    })
}
