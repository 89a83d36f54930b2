//! Reading and writing motion capture allocates nothing after the first frames.

use std::fmt::Write;
use std::io::{self, Seek, SeekFrom};

use ademan::capture::bvh::{Bvh, BvhWriter};
use ademan::capture::protocol::{ProtocolOptions, bvh};

use crate::steady_state::{allocations, live_bytes};

/// Joints of the skeleton.
const JOINTS: usize = 60;

/// Frames of the text: 5 min at 60 Hz.
const FRAMES: u64 = 18_000;

/// Returns the text before the frames.
fn header() -> String {
    let mut text =
        "HIERARCHY\nROOT Hips { OFFSET 0 95 0 CHANNELS 6 Xposition Yposition Zposition Zrotation \
                    Xrotation Yrotation\n"
            .to_owned();
    for joint in 1..JOINTS {
        let name = match joint {
            57 => "RightArm".to_owned(),
            58 => "RightForeArm".to_owned(),
            59 => "RightHand".to_owned(),
            _ => format!("joint{joint}"),
        };
        let channels = "CHANNELS 3 Zrotation Xrotation Yrotation";
        let _ = writeln!(text, "JOINT {name} {{ OFFSET 0 1.5 0 {channels}");
    }
    text.push_str("End Site { OFFSET 0 9 0 }");
    text.push_str(&" }\n".repeat(JOINTS));
    let _ = write!(text, "MOTION\nFrames: {FRAMES}\nFrame Time: 0.016667\n");
    text
}

#[test]
fn a_long_motion_capture_is_read_in_the_memory_of_its_first_frames() {
    let frame = "-12.345678 0.5 1e-3 ".repeat(JOINTS + 1) + "\n";
    let mut decoder = (bvh::PROTOCOL.decoder)(&ProtocolOptions::default());
    let mut frames = 0;
    decoder.push(header().as_bytes(), &mut |_| frames += 1);
    let mut push_frame = |count: &mut u64| {
        for piece in frame.as_bytes().chunks(512) {
            decoder.push(piece, &mut |_| *count += 1);
        }
    };
    (0..10).for_each(|_| push_frame(&mut frames));
    let (allocated, live) = (allocations(), live_bytes());
    (10..FRAMES).for_each(|_| push_frame(&mut frames));
    assert_eq!(allocations() - allocated, 0);
    assert_eq!(live_bytes() - live, 0);
    assert_eq!((frames, decoder.take_error()), (FRAMES, None));
}

/// A file that counts its bytes and stores none.
#[derive(Default)]
struct Sink {
    bytes: u64,
}

impl io::Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Sink {
    fn seek(&mut self, _: SeekFrom) -> io::Result<u64> {
        Ok(self.bytes)
    }
}

#[test]
fn a_long_motion_capture_is_written_in_the_memory_of_its_first_frames() {
    let text = header().replace(&format!("Frames: {FRAMES}"), "Frames: 0");
    let skeleton = Bvh::parse(text.as_bytes()).expect("a skeleton");
    let skeleton = &skeleton.motion().skeleton;
    let mut sink = Sink::default();
    let mut writer = BvhWriter::new(&mut sink, skeleton, 0.016_667).expect("room");
    let values = vec![-179.123_456; skeleton.channel_count()];
    (0..10).for_each(|_| writer.write_frame(&values).expect("room"));
    let (allocated, live) = (allocations(), live_bytes());
    (10..FRAMES).for_each(|_| writer.write_frame(&values).expect("room"));
    assert_eq!(allocations() - allocated, 0);
    assert_eq!(live_bytes() - live, 0);
    assert_eq!(writer.frames(), FRAMES);
    writer.finish().expect("room");
    assert!(sink.bytes > FRAMES * 183 * 10, "{} bytes", sink.bytes);
}
