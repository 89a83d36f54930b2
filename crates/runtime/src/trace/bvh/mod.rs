//! Captured poses as BVH motion capture.
//!
//! The skeleton is a body in the T pose whose arms have the median lengths of the first poses, so that no single one
//! decides them. Every frame has the joints of its pose, moved as little as these lengths need, so that a model of rigid bones is
//! reproduced exactly. The file is in centimetres with +Y up and the person looking along +Z, and has the joint names of
//! Mixamo, which most programs know.

use std::fs::File;
use std::io::{BufWriter, Result, Seek, Write};
use std::time::Duration;

use crate::capture::bvh::{ArmShape, ArmsSkeleton, BvhWriter};
use crate::capture::markers::median;
use ademan_core::geometry::EulerOrder;
use ademan_core::hand::{Joint, JointPositions, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::time::Timestamp;

/// Longest gap between two poses that is kept. Longer ones are shortened to it.
const MAX_GAP: Duration = Duration::from_secs(2);

/// Frames after which a file is complete again: one second at 100 per second.
const FRAMES_PER_BLOCK: u64 = 100;

/// Room for the frames of a block: they reach the disk together with their number.
const BLOCK_BYTES: usize = 1 << 20;

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
    /// Length of the whole file at the end of the last block.
    whole_bytes: u64,
}

/// Writes poses in blocks to an empty file, and returns the number of frames. After a failed write, the file ends with the last whole
/// block; without one, it is empty.
pub fn write_file(
    poses: impl IntoIterator<Item = HandPose>,
    file: File,
    options: PoseOptions,
) -> Result<u64> {
    let whole = file.try_clone()?;
    let mut writer = PoseWriter::new(BufWriter::with_capacity(BLOCK_BYTES, file), options);
    let mut poses = poses.into_iter();
    let written = poses.try_for_each(|pose| writer.push(&pose));
    let written = written.and_then(|()| writer.complete());
    if written.is_err() {
        let length = writer.whole_bytes();
        // It may write what its buffer has.
        drop(writer);
        // If this fails too, a reader finds a part of a frame after the last one.
        let _ = whole.set_len(length);
    }
    written
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

    /// Adds a pose. A hand that is first seen after the lengths of the bones are known is left out. One that is nowhere, as its source
    /// was lost, keeps its last pose.
    pub fn push(&mut self, pose: &HandPose) -> Result<()> {
        let is_other = self.options.side.is_some_and(|side| side != pose.side);
        if is_other || pose.known().next().is_none() {
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
            let text = Text::new(out, first.time, &early, &self.options)?;
            let text = self.text.insert(text);
            for pose in &early {
                text.push(pose)?;
            }
            text.complete_block()?;
        }
        Ok(())
    }

    /// Returns the length of the whole file at the end of the last block, which is complete if nothing follows; 0 without a block.
    pub fn whole_bytes(&self) -> u64 {
        let text = self.text.as_ref();
        text.map_or(0, |text| text.whole_bytes)
    }

    /// Writes the last frame and returns the number of frames. Without a pose, nothing is written.
    pub fn finish(mut self) -> Result<u64> {
        self.complete()
    }

    fn complete(&mut self) -> Result<u64> {
        if self.text.is_none() {
            self.start()?;
        }
        let Some(text) = &mut self.text else {
            return Ok(0);
        };
        text.writer.write_frame(&text.values)?;
        text.complete_block()?;
        Ok(text.writer.frames())
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
            whole_bytes: 0,
        })
    }

    /// Completes the file: if nothing follows, it is a whole file of the frames so far.
    fn complete_block(&mut self) -> Result<()> {
        self.whole_bytes = self.writer.complete_block()?;
        Ok(())
    }

    fn push(&mut self, pose: &ArmPose) -> Result<()> {
        let Some(shape) = self.shapes.iter().find(|shape| shape.side() == pose.side) else {
            return Ok(());
        };
        let gap = pose.time.since(self.latest);
        self.start = self.start + gap.saturating_sub(MAX_GAP);
        while self.start + frame_time(self.writer.frames(), self.rate_hz) < pose.time {
            self.writer.write_frame(&self.values)?;
            if self.writer.frames().is_multiple_of(FRAMES_PER_BLOCK) {
                self.whole_bytes = self.writer.complete_block()?;
            }
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
