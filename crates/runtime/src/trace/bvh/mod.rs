//! Captured poses as BVH motion capture.
//!
//! The skeleton is a body in the T pose whose arms have the median lengths of the first poses, so that no single one
//! decides them. Every frame has the joints of its pose, moved as little as these lengths need, so that a model of rigid bones is
//! reproduced exactly. The file is in centimetres with +Y up and the person looking along +Z, and has the joint names of
//! Mixamo, which most programs know.

use std::io::{Result, Seek, Write};
use std::time::Duration;

use crate::capture::bvh::{ArmShape, ArmsSkeleton, BvhWriter};
use crate::capture::markers::median;
use ademan_core::geometry::EulerOrder;
use ademan_core::hand::{Joint, JointPositions, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::time::Timestamp;

/// Longest gap between two poses that is kept. Longer ones are shortened to it.
const MAX_GAP: Duration = Duration::from_secs(2);

/// The form of a file of poses.
#[derive(Clone, Copy, Debug)]
pub struct PoseOptions {
    /// Frames per second.
    pub rate_hz: f64,
    /// The only hand that is written; `None` for both.
    pub side: Option<Side>,
    /// Order of the rotation channels: three different axes.
    pub order: EulerOrder,
    /// Number of poses from which the lengths of the bones come. They are in memory until then.
    pub measured_poses: usize,
}

impl PoseOptions {
    /// Creates the options of a file of both hands, with `rate_hz` frames per second and the bones of the first 100 poses.
    pub fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            side: None,
            order: EulerOrder::Zxy,
            measured_poses: 100,
        }
    }
}

/// Writer of the poses of one or two hands at a constant rate: each frame is the latest pose at its time.
#[derive(Debug)]
pub struct PoseWriter<W> {
    options: PoseOptions,
    /// Poses that wait for the lengths of the bones.
    early: Vec<ArmPose>,
    /// `None` until the lengths are known.
    text: Option<Text<W>>,
    /// Waits for the lengths.
    out: Option<W>,
}

/// The positions of the joints of an arm at one time.
#[derive(Clone, Copy, Debug)]
struct ArmPose {
    time: Timestamp,
    side: Side,
    joints: JointPositions,
}

#[derive(Debug)]
struct Text<W> {
    writer: BvhWriter<W>,
    rate_hz: f64,
    skeleton: ArmsSkeleton,
    shapes: Vec<ArmShape>,
    /// The latest joints of each side.
    arms: [JointPositions; Side::COUNT],
    /// Values of the latest pose.
    values: Vec<f64>,
    latest: Timestamp,
    /// Time of frame 0, moved by the gaps that were shortened.
    start: Timestamp,
}

impl<W: Write + Seek> PoseWriter<W> {
    /// Creates a writer to an empty file.
    pub fn new(out: W, options: PoseOptions) -> Self {
        Self {
            options,
            early: Vec::new(),
            text: None,
            out: Some(out),
        }
    }

    /// Adds a pose. A hand that is first seen after the lengths of the bones are known is left out.
    pub fn push(&mut self, pose: &HandPose) -> Result<()> {
        if self.options.side.is_some_and(|side| side != pose.side) {
            return Ok(());
        }
        let pose = ArmPose {
            time: pose.time,
            side: pose.side,
            joints: pose.positions(),
        };
        if let Some(text) = &mut self.text {
            return text.push(&pose);
        }
        self.early.push(pose);
        if self.early.len() < self.options.measured_poses {
            Ok(())
        } else {
            self.start()
        }
    }

    /// Writes the poses so far.
    fn start(&mut self) -> Result<()> {
        let early = std::mem::take(&mut self.early);
        if let (Some(first), Some(out)) = (early.first(), self.out.take()) {
            let mut text = Text::new(out, first.time, &early, &self.options)?;
            for pose in &early {
                text.push(pose)?;
            }
            self.text = Some(text);
        }
        Ok(())
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
    pub fn finish(mut self) -> Result<u64> {
        if self.text.is_none() {
            self.start()?;
        }
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
    fn new(out: W, start: Timestamp, poses: &[ArmPose], options: &PoseOptions) -> Result<Self> {
        let shape = |&side: &Side| {
            let own = poses.iter().filter(|pose| pose.side == side);
            let joints: Vec<JointPositions> = own.map(|pose| pose.joints).collect();
            ArmShape::measure(&joints, side)
        };
        let shapes: Vec<ArmShape> = Side::ALL.iter().filter_map(shape).collect();
        let skeleton = ArmsSkeleton::new(&shapes, width(poses), options.order);
        let frame_time = 1.0 / options.rate_hz;
        Ok(Self {
            writer: BvhWriter::new(out, skeleton.skeleton(), frame_time)?,
            rate_hz: options.rate_hz,
            skeleton,
            shapes,
            arms: Default::default(),
            values: Vec::new(),
            latest: start,
            start,
        })
    }

    fn push(&mut self, pose: &ArmPose) -> Result<()> {
        let Some(shape) = self.shapes.iter().find(|shape| shape.side() == pose.side) else {
            return Ok(());
        };
        let gap = pose.time.since(self.latest);
        self.start = self.start + gap.saturating_sub(MAX_GAP);
        while self.start + frame_time(self.writer.frames(), self.rate_hz) < pose.time {
            self.writer.write_frame(&self.values)?;
        }
        self.latest = self.latest.max(pose.time);
        self.arms[pose.side.index()] = shape.fit(&pose.joints);
        self.skeleton.frame(&self.arms, &mut self.values);
        Ok(())
    }
}

/// Returns the median distance of the shoulders in metres, if both are known.
fn width(poses: &[ArmPose]) -> Option<f64> {
    let mut latest = [None; Side::COUNT];
    let mut widths = Vec::new();
    for pose in poses {
        latest[pose.side.index()] = pose.joints.get(Joint::Shoulder);
        if let [Some(left), Some(right)] = latest {
            widths.push(left.distance(right));
        }
    }
    median(&mut widths)
}

fn frame_time(frame: u64, rate_hz: f64) -> Duration {
    Duration::from_secs_f64(frame as f64 / rate_hz)
}

#[cfg(test)]
mod tests;
