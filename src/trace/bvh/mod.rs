//! Captured poses as BVH motion capture.
//!
//! The skeleton is that of the first pose: its joints with their distances, which do not change. Every frame turns the
//! bones into the directions of its pose, so that a model of rigid bones is reproduced exactly. The file is in
//! centimetres with +Y up and the person looking along +Z, and has the joint names of Mixamo, which most programs know.

use std::io::{Result, Seek, Write};
use std::time::Duration;

use crate::capture::bvh::{BvhWriter, PositionSkeleton};
use crate::hand::Side;
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// Longest gap between two poses that is kept. Longer ones are shortened to it.
const MAX_GAP: Duration = Duration::from_secs(2);

/// Writer of the poses of one hand at a constant rate: each frame is the latest pose at its time.
#[derive(Debug)]
pub struct PoseWriter<W> {
    /// `None` until the first pose.
    text: Option<Text<W>>,
    /// Waits for the first pose.
    out: Option<W>,
    rate_hz: f64,
}

#[derive(Debug)]
struct Text<W> {
    writer: BvhWriter<W>,
    skeleton: PositionSkeleton,
    side: Side,
    /// Values of the latest pose.
    values: Vec<f64>,
    latest: Timestamp,
    /// Time of frame 0, moved by the gaps that were shortened.
    start: Timestamp,
}

impl<W: Write + Seek> PoseWriter<W> {
    /// Creates a writer of `rate_hz` frames per second to an empty file.
    pub fn new(out: W, rate_hz: f64) -> Self {
        Self {
            text: None,
            out: Some(out),
            rate_hz,
        }
    }

    /// Adds a pose. The first one decides the hand and the skeleton; poses of the other hand are left out.
    pub fn push(&mut self, pose: &HandPose) -> Result<()> {
        let rate_hz = self.rate_hz;
        if let Some(out) = self.out.take() {
            self.text = Some(Text::new(out, pose, rate_hz)?);
            return Ok(());
        }
        match &mut self.text {
            Some(text) if text.side == pose.side => text.push(pose, rate_hz),
            _ => Ok(()),
        }
    }

    /// Returns the number of frames so far.
    pub fn frames(&self) -> u64 {
        let text = self.text.as_ref();
        text.map_or(0, |text| text.writer.frames())
    }

    /// Completes the file: if nothing follows, it is a whole file of the frames so far.
    pub fn complete_block(&mut self) -> Result<()> {
        match &mut self.text {
            Some(text) => text.writer.complete_block(),
            None => Ok(()),
        }
    }

    /// Writes the last frame and returns the number of frames. Without a pose, nothing is written.
    pub fn finish(self) -> Result<u64> {
        let Some(mut text) = self.text else {
            return Ok(0);
        };
        text.writer.write_frame(&text.values)?;
        let frames = text.writer.frames();
        text.writer.finish()?;
        Ok(frames)
    }
}

impl<W: Write + Seek> Text<W> {
    fn new(out: W, pose: &HandPose, rate_hz: f64) -> Result<Self> {
        let joints = pose.positions();
        let mut skeleton = PositionSkeleton::new(&joints, pose.side);
        let writer = BvhWriter::new(out, skeleton.skeleton(), 1.0 / rate_hz)?;
        let mut values = Vec::new();
        skeleton.frame(&joints, &mut values);
        Ok(Self {
            writer,
            skeleton,
            side: pose.side,
            values,
            latest: pose.time,
            start: pose.time,
        })
    }

    fn push(&mut self, pose: &HandPose, rate_hz: f64) -> Result<()> {
        let gap = pose.time.since(self.latest);
        self.start = self.start + gap.saturating_sub(MAX_GAP);
        while self.start + frame_time(self.writer.frames(), rate_hz) < pose.time {
            self.writer.write_frame(&self.values)?;
        }
        self.latest = pose.time;
        self.skeleton.frame(&pose.positions(), &mut self.values);
        Ok(())
    }
}

fn frame_time(frame: u64, rate_hz: f64) -> Duration {
    Duration::from_secs_f64(frame as f64 / rate_hz)
}

#[cfg(test)]
mod tests;
