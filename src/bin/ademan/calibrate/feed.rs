//! The readings of a calibration: from a source, or from a simulated person who takes the poses.

use std::thread;
use std::time::{Duration, Instant};

use ademan::calibrate::CalibrationPose;
use ademan::capture::{CaptureEvent, CaptureThread, Channels, Reading, Sample, spawn};
use ademan::setup::LoadedSetup;
use ademan::sim::SimulatedWearer;
use ademan::time::Timestamp;

use crate::failure::Failure;

/// Longest wait for a reading, so that keys are answered.
const POLL_PERIOD: Duration = Duration::from_millis(20);

/// The longest delay that a simulated person makes up for. After a longer one, the process was stopped.
const MAX_DELAY: Duration = Duration::from_secs(1);

/// A source of readings.
pub struct Feed {
    kind: FeedKind,
    name: String,
}

enum FeedKind {
    Source(CaptureThread),
    Person {
        wearer: Box<SimulatedWearer>,
        /// The start of the readings in real time; `None` for as fast as possible.
        start: Option<Instant>,
    },
}

/// An event of a feed.
pub enum FeedEvent {
    /// The counts of all channels, with the reading that contains them.
    Channels(Timestamp, Box<Channels>),
    /// Nothing new.
    Idle,
    /// The source was lost and reconnects, for this reason.
    Lost(String),
    /// The readings have ended.
    End,
}

impl Feed {
    /// Opens the source of a setup.
    pub fn open(setup: &LoadedSetup) -> Result<Self, Failure> {
        let Some(source) = &setup.setup.source else {
            return Err(Failure::wrong_use(
                "no source is named; add --source URI (see `ademan sources`), or --demo for a simulated person",
            ));
        };
        let capture = spawn(setup.open_source_alone(source)?)?;
        Ok(Self {
            name: capture.name().to_owned(),
            kind: FeedKind::Source(capture),
        })
    }

    /// Creates the feed of a simulated person.
    pub fn simulated(wearer: SimulatedWearer, is_in_real_time: bool) -> Self {
        Self {
            name: "a simulated person".to_owned(),
            kind: FeedKind::Person {
                wearer: Box::new(wearer),
                start: is_in_real_time.then(Instant::now),
            },
        }
    }

    /// Returns the name of the source.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the next event, after 20 ms at most. `pose` is the one that the person is asked for.
    pub fn next(&mut self, pose: Option<CalibrationPose>) -> Result<FeedEvent, Failure> {
        match &mut self.kind {
            FeedKind::Source(capture) => match capture.events().recv_timeout(POLL_PERIOD) {
                Ok(event) => captured(event),
                Err(_) => Ok(FeedEvent::Idle),
            },
            FeedKind::Person { wearer, start } => {
                if let Some(pose) = pose {
                    wearer.take(pose);
                }
                let (time, channels) = wearer.next_packet();
                if let Some(start) = start {
                    let (due, now) = (*start + Duration::from_micros(time.0), Instant::now());
                    let delay = now.saturating_duration_since(due);
                    if delay > MAX_DELAY {
                        *start += delay;
                    }
                    thread::sleep(due.saturating_duration_since(now));
                }
                Ok(FeedEvent::Channels(time, Box::new(channels)))
            }
        }
    }
}

fn captured(event: CaptureEvent) -> Result<FeedEvent, Failure> {
    match event {
        CaptureEvent::Reading { reading, .. } => channels(reading),
        CaptureEvent::Lost(error) => Ok(FeedEvent::Lost(error.to_string())),
        CaptureEvent::Failed(error) => Err(error.into()),
        CaptureEvent::End(_) => Ok(FeedEvent::End),
        // Readings come one by one.
        CaptureEvent::Noise(_)
        | CaptureEvent::Elapsed(_)
        | CaptureEvent::Command(_)
        | CaptureEvent::Readings { .. } => Ok(FeedEvent::Idle),
    }
}

fn channels(reading: Reading) -> Result<FeedEvent, Failure> {
    match reading.sample {
        Sample::Channels(channels) => Ok(FeedEvent::Channels(reading.time, Box::new(channels))),
        _ => Err(Failure::wrong_use(
            "this source measures angles or positions of joints, not sensor channels; it needs no glove file and no calibration",
        )),
    }
}
