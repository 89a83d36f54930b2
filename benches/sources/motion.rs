//! The rate at which motion capture is read and written.

use std::time::{Duration, Instant};

use ademan::capture::bvh::{BvhWriter, Channel, Node, Skeleton, write_frame, write_header};
use ademan::capture::protocol::{ProtocolOptions, bvh};
use glam::DVec3;

/// Joints of the skeleton.
const JOINTS: usize = 60;

/// Frames of a text.
const FRAMES: usize = 100_000;

/// Frames of a block. The fastest block counts: other programs on the machine only add to its time.
const BLOCK: usize = 500;

const GOAL_MB_PER_S: f64 = 50.0;

/// Prints the table of both directions. A test measures a hundredth of the frames.
pub fn print(is_test: bool) {
    let frames = if is_test { FRAMES / 100 } else { FRAMES };
    println!("\n| motion capture of {frames} frames × {JOINTS} joints | size | rate | goal |");
    for (name, fastest) in [("read", read(frames)), ("written", write(frames))] {
        let bytes = BLOCK * frame_bytes();
        let size = (frames / BLOCK * bytes) as f64 / 1e6;
        let rate = bytes as f64 / 1e6 / fastest.as_secs_f64();
        println!("| {name} | {size:.0} MB | {rate:.0} MB/s | {GOAL_MB_PER_S} MB/s |");
    }
}

/// Returns a chain of joints that ends in an arm.
fn skeleton() -> Skeleton {
    let rotations = [Channel::ZRotation, Channel::XRotation, Channel::YRotation];
    let positions = [Channel::XPosition, Channel::YPosition, Channel::ZPosition];
    let mut skeleton = Skeleton::default();
    for joint in 0..JOINTS {
        let name = match joint {
            57 => "RightArm".to_owned(),
            58 => "RightForeArm".to_owned(),
            59 => "RightHand".to_owned(),
            _ => format!("joint{joint}"),
        };
        let is_root = joint == 0;
        skeleton.push(Node {
            name: Some(name),
            parent: joint.checked_sub(1),
            offset: DVec3::new(0.0, 1.5, 0.0),
            channels: if is_root {
                positions.into_iter().chain(rotations).collect()
            } else {
                rotations.to_vec()
            },
        });
    }
    skeleton.push(Node {
        name: None,
        parent: Some(JOINTS - 1),
        offset: DVec3::new(0.0, 9.0, 0.0),
        channels: Vec::new(),
    });
    skeleton
}

/// Returns the values of some frames.
fn frames() -> Vec<Vec<f64>> {
    let mut random = fastrand::Rng::with_seed(1);
    let mut frame = || {
        (0..3 * JOINTS + 3)
            .map(|_| (random.f64() - 0.5) * 360.0)
            .collect()
    };
    (0..BLOCK).map(|_| frame()).collect()
}

/// Returns the lines of some frames.
fn lines() -> Vec<Vec<u8>> {
    let line = |values: &Vec<f64>| {
        let mut line = Vec::new();
        write_frame(&mut line, values);
        line
    };
    frames().iter().map(line).collect()
}

/// Returns the mean length of a frame in bytes.
fn frame_bytes() -> usize {
    lines().iter().map(Vec::len).sum::<usize>() / BLOCK
}

/// Runs a number of blocks. Returns the time of the fastest one.
fn fastest(blocks: usize, mut run: impl FnMut()) -> Duration {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed()
    };
    (0..blocks).map(time).min().unwrap_or_default()
}

fn read(frames: usize) -> Duration {
    let mut header = Vec::new();
    write_header(&mut header, &skeleton(), frames as u64, 0.01);
    let lines = lines();
    let mut decoder = (bvh::PROTOCOL.decoder)(&ProtocolOptions::default());
    let mut read = 0;
    decoder.push(&header, &mut |_| read += 1);
    let time = fastest(frames / BLOCK, || {
        for line in &lines {
            decoder.push(line, &mut |_| read += 1);
        }
    });
    decoder.finish(&mut |_| read += 1);
    assert_eq!((read, decoder.take_error()), (frames, None));
    time
}

fn write(count: usize) -> Duration {
    let frames = frames();
    let (skeleton, mut sink) = (skeleton(), Sink::default());
    let mut writer = BvhWriter::new(&mut sink, &skeleton, 0.01).expect("room");
    let time = fastest(count / BLOCK, || {
        for values in &frames {
            writer.write_frame(values).expect("room");
        }
    });
    assert_eq!(writer.frames(), count as u64);
    writer.finish().expect("room");
    assert!(sink.bytes > count * JOINTS);
    time
}

/// A file that counts its bytes and stores none.
#[derive(Default)]
struct Sink {
    bytes: usize,
}

impl std::io::Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.bytes += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl std::io::Seek for Sink {
    fn seek(&mut self, _: std::io::SeekFrom) -> std::io::Result<u64> {
        Ok(self.bytes as u64)
    }
}
