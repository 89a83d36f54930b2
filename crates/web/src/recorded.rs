//! Recordings of `ademan record` in a page: their hands move on, with the glove and the arm that they were made with.

use std::collections::VecDeque;
use std::time::Duration;

use ademan_core::capture::{Reading, Sample};
use ademan_core::document::{Document, DocumentError};
use ademan_core::estimate::Estimator;
use ademan_core::hand::Side;
use ademan_core::kinematics::ArmModel;
use ademan_core::layout::{Fit, Glove, Person};
use ademan_core::pipeline::{LayoutInstance, Pipeline};
use ademan_core::time::Timestamp;
use ademan_recording::{RecordedEvent, RecordedSetup, Recording, kind};
use serde::Serialize;

use crate::hand::{Hand, MAX_GAP};
use crate::session::{PageSession, estimator, pipeline_settings};

/// Most readings of a recording that are kept: an hour of a glove with 50 readings a second.
const MAX_READINGS: usize = 200_000;

/// A recording that moves the hands.
#[derive(Debug, Serialize)]
pub struct PlayedRecording {
    /// Number of readings.
    pub readings: usize,
    /// The text of the layout with which it was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layout: Option<String>,
    /// The reason why its end is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// The hands of a recording: what they are measured with, and their readings.
struct RecordedHands {
    /// The hand of readings without a side, and the other one.
    arms: [ArmModel; Side::COUNT],
    gloves: [Option<Glove>; Side::COUNT],
    readings: VecDeque<Reading>,
    layout: Option<String>,
    refused: Option<String>,
}

impl PageSession {
    /// Makes a recording move the hands, from the bytes of an MCAP file. The boards fit its hands until other hands move.
    ///
    /// # Errors
    /// The file is not a recording, has no readings, or has a glove or arm that cannot be read.
    pub fn play_recording(&mut self, bytes: &[u8]) -> Result<PlayedRecording, String> {
        let mut recorded = RecordedHands::read(bytes)?;
        schedule(&mut recorded.readings, self.time);
        self.release();
        let [first, second] = &recorded.arms;
        let fit = Fit::new(first, Some(second)).map_err(|error| error.to_string())?;
        self.pipeline = recorded.pipeline(self.words.instance(&self.layout));
        self.fit = fit;
        let played = PlayedRecording {
            readings: recorded.readings.len(),
            layout: recorded.layout,
            refused: recorded.refused,
        };
        self.hand = Hand::Recorded(recorded.readings);
        self.fit_boards();
        Ok(played)
    }

    /// Ends a recording: the hands of the page move again.
    pub(crate) fn end_recording(&mut self) {
        if !matches!(self.hand, Hand::Recorded(_)) {
            return;
        }
        self.hand = Hand::Resting;
        // They were valid at the start.
        if let Ok(fit) = Fit::new(&self.right, Some(&self.left)) {
            self.fit = fit;
        }
        self.renew_pipeline();
        self.fit_boards();
    }

    fn fit_boards(&mut self) {
        // It was valid for other hands.
        if let Ok(layout) = self.layout_of(&self.layout.text) {
            self.move_boards(layout);
        }
    }
}

impl RecordedHands {
    fn read(bytes: &[u8]) -> Result<Self, String> {
        let mut recording = Recording::new(bytes).map_err(|error| error.to_string())?;
        let mut readings = VecDeque::new();
        let refused = read_all(&mut recording, &mut readings);
        if readings.is_empty() {
            return Err(refused.unwrap_or_else(|| "the recording has no readings".to_owned()));
        }
        let setup = recording.setup();
        let measured = readings.iter().find_map(|reading| reading.side);
        let (arms, gloves) = hands(setup, measured).map_err(|error| error.to_string())?;
        let needs_glove = |reading: &Reading| matches!(reading.sample, Sample::Channels(_));
        if gloves.iter().all(Option::is_none) && readings.iter().any(needs_glove) {
            return Err("the recording has counts of a glove, but no glove file".to_owned());
        }
        Ok(Self {
            arms,
            gloves,
            readings,
            layout: setup.get(kind::LAYOUT).map(|layout| layout.text.clone()),
            refused,
        })
    }

    fn pipeline(&self, instance: LayoutInstance) -> Pipeline {
        let [first, second] = &self.arms;
        let [own, other] = self
            .gloves
            .each_ref()
            .map(|glove| estimator_of(glove.as_ref()));
        Pipeline::new(own, first.clone(), instance, pipeline_settings())
            .with_second_hand(other, second.clone())
    }
}

/// Lets the first reading be due at `start`, and shortens gaps to [`MAX_GAP`].
fn schedule(readings: &mut VecDeque<Reading>, start: Timestamp) {
    let (mut due, mut last) = (start, None);
    for reading in readings {
        let gap = last.map_or(Duration::ZERO, |last| reading.time.since(last));
        due = due + gap.min(MAX_GAP);
        last = Some(reading.time);
        reading.time = due;
    }
}

/// Reads all readings that are kept. Returns the reason why the end is left out.
fn read_all(recording: &mut Recording<&[u8]>, readings: &mut VecDeque<Reading>) -> Option<String> {
    loop {
        match recording.next_event() {
            Ok(Some(RecordedEvent::Reading(_))) if readings.len() >= MAX_READINGS => {
                return Some(format!("it has more than {MAX_READINGS} readings"));
            }
            Ok(Some(RecordedEvent::Reading(reading))) => readings.push_back(reading),
            // The page has no commands that move boards.
            Ok(Some(RecordedEvent::Command(_))) => {}
            Ok(None) => return recording.truncation().map(|it| it.reason.clone()),
            Err(error) => return Some(error.to_string()),
        }
    }
}

type Hands = ([ArmModel; Side::COUNT], [Option<Glove>; Side::COUNT]);

/// Reads the arms and gloves of a recording. `measured` is the side that its readings name.
fn hands(setup: &RecordedSetup, measured: Option<Side>) -> Result<Hands, DocumentError> {
    let document = |kind: &str| {
        let entry = setup.get(kind)?;
        Some(Document::new(entry.name.as_str(), entry.text.as_str()))
    };
    let glove = |kind: &str| document(kind).map(|it| Glove::parse(&it)).transpose();
    let gloves = [glove(kind::GLOVE)?, glove(kind::OTHER_GLOVE)?];
    let person = document(kind::PERSON)
        .map(|it| Person::parse(&it))
        .transpose()?;
    let side = gloves[0].as_ref().map(|worn| worn.side);
    let side = side.or(person.as_ref().and_then(|person| person.side));
    let side = side.or(measured).unwrap_or(Side::Right);
    let arm = |kinds: &[&str], arm_side: Side| {
        if let Some(document) = kinds.iter().find_map(|kind| document(kind)) {
            return Ok(ArmModel::parse(&document)?.for_side(arm_side));
        }
        match person
            .as_ref()
            .and_then(|person| person.arm(arm_side)?.ok())
        {
            Some(arm) => Ok(arm),
            None => Ok(ArmModel::parse(&Document::shipped("unam")?)?.for_side(arm_side)),
        }
    };
    let arms = [
        arm(&[kind::ARM], side)?,
        arm(&[kind::OTHER_ARM, kind::ARM], side.opposite())?,
    ];
    Ok((arms, gloves))
}

fn estimator_of(glove: Option<&Glove>) -> Estimator {
    match glove {
        Some(glove) => estimator(&glove.rest_pose).with_channels(&glove.map),
        None => estimator(&Default::default()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::hand::JointAngles;

    #[test]
    fn a_gap_of_an_hour_is_played_in_two_seconds() {
        const HOUR: u64 = 3_600_000_000;
        let reading = |time| {
            let angles = JointAngles::default();
            Reading::new(Timestamp(time), None, Sample::Angles { angles })
        };
        let recorded = [HOUR, HOUR + 10_000, 2 * HOUR, 2 * HOUR + 10_000];
        let mut readings: VecDeque<Reading> = recorded.into_iter().map(reading).collect();
        schedule(&mut readings, Timestamp(500));
        let times: Vec<u64> = readings.iter().map(|it| it.time.0).collect();
        assert_eq!(times, [500, 10_500, 2_010_500, 2_020_500]);
    }
}
