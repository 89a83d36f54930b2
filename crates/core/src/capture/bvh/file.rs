//! A whole BVH text in memory.

use glam::DVec3;

use super::error::BvhError;
use super::parser::{BvhParser, Motion};
use super::skeleton::PositionChannels;

/// A skeleton and all its frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    motion: Motion,
    values: Vec<f64>,
}

impl Bvh {
    /// Parses a text.
    pub fn parse(text: &[u8]) -> Result<Self, BvhError> {
        let mut parser = BvhParser::new();
        let mut values = Vec::new();
        let mut on_frame = |_: &Motion, frame: &[f64], _: u64| values.extend_from_slice(frame);
        parser.push(text, &mut on_frame)?;
        parser.finish(&mut on_frame)?;
        let motion = parser.motion().cloned().unwrap_or_default();
        Ok(Self { motion, values })
    }

    /// Returns the skeleton, the number of frames and the frame time.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Returns the channel values of a frame, in file order.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn frame(&self, index: u64) -> &[f64] {
        assert!(index < self.motion.frame_count, "no frame {index}");
        let channels = self.motion.skeleton.channel_count();
        &self.values[index as usize * channels..][..channels]
    }

    /// Returns the world position of every node in a frame, in the axes and the unit of the file.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn positions(&self, index: u64, positions: PositionChannels) -> Vec<DVec3> {
        let mut poses = Vec::new();
        let skeleton = &self.motion.skeleton;
        skeleton.world_poses(self.frame(index), positions, &mut poses);
        poses.iter().map(|pose| pose.position).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::bvh::{MAX_DEPTH, MAX_NODES, MAX_TOKEN_BYTES};

    fn text(joints: &str, motion: &str) -> String {
        format!("HIERARCHY\nROOT r\n{{\nOFFSET 0 0 0\n{joints}\n}}\nMOTION\n{motion}")
    }

    fn error(text: &str) -> String {
        Bvh::parse(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn pieces_of_any_size_give_the_same_frames_and_offsets() {
        let joints =
            "CHANNELS 3 xposition YROTATION Zrotation\r\nEnd Site\r\n{\r\nOFFSET 1e0 -.5 +2.\r\n}";
        let text = text(joints, "Frames:\t2\r\nFrame Time: .04\r\n1 2 3\r\n4\t5\n6");
        let whole = Bvh::parse(text.as_bytes()).unwrap();
        assert_eq!(whole.frame(1), [4.0, 5.0, 6.0]);
        assert_eq!(
            whole.motion().skeleton.nodes()[1].offset,
            DVec3::new(1.0, -0.5, 2.0)
        );
        for size in 1..20 {
            let (mut parser, mut values, mut ends) = (BvhParser::new(), Vec::new(), Vec::new());
            let mut on_frame = |_: &Motion, frame: &[f64], end: u64| {
                values.extend_from_slice(frame);
                ends.push(end);
            };
            for piece in text.as_bytes().chunks(size) {
                parser.push(piece, &mut on_frame).unwrap();
            }
            parser.finish(&mut on_frame).unwrap();
            assert_eq!(values, whole.values, "{size}");
            let first = text.find("3\r\n4").unwrap() as u64 + 1;
            assert_eq!(ends, [first, text.len() as u64], "{size}");
        }
    }

    #[test]
    fn a_line_has_any_length_and_ends_in_lf_cr_or_both() {
        let frames = "1 2 3 ".repeat(300_000);
        let motion = format!("Frames: 900000\nFrame Time: 1\n{frames}");
        let long = text("CHANNELS 1 Xposition", &motion);
        let bvh = Bvh::parse(long.as_bytes()).unwrap();
        assert_eq!(bvh.frame(899_999), [3.0]);
        let wrong = text("CHANNELS 1 Xposition", "Frames: 2\nFrame Time: 1\n1\n\nx");
        for end in ["\n", "\r", "\r\n"] {
            let found = error(&wrong.replace('\n', end));
            assert!(found.starts_with("line 12: value 1 of frame 2"), "{found}");
        }
    }

    #[test]
    fn joints_without_channels_and_texts_without_frames_are_valid() {
        let one_hundred = text("CHANNELS 0", "Frames: 100000000\nFrame Time: 0.01\n");
        let bvh = Bvh::parse(one_hundred.as_bytes()).unwrap();
        assert_eq!(
            bvh.positions(99_999_999, PositionChannels::Add),
            [DVec3::ZERO]
        );
        let none = text("CHANNELS 1 Xposition", "Frames: 0\nFrame Time: 0.01\n");
        assert_eq!(Bvh::parse(none.as_bytes()).unwrap().motion().frame_count, 0);
    }

    #[test]
    fn position_channels_add_or_replace() {
        let joints = "CHANNELS 1 Yposition\nJOINT a\n{\nOFFSET 1 2 3\nCHANNELS 1 Zposition\n}";
        let bvh = text(joints, "Frames: 1\nFrame Time: 1\n5 7\n");
        let bvh = Bvh::parse(bvh.as_bytes()).unwrap();
        let positions = |rule| bvh.positions(0, rule)[1];
        assert_eq!(positions(PositionChannels::Add), DVec3::new(1.0, 7.0, 10.0));
        assert_eq!(
            positions(PositionChannels::Replace),
            DVec3::new(1.0, 7.0, 7.0)
        );
    }

    #[test]
    fn errors_name_the_line_and_the_word() {
        let motion = "Frames: 1\nFrame Time: 1\n";
        for (joints, frames, message) in [
            (
                "CHANNELS 2 Xposition",
                motion,
                "line 6: `}` is not a channel",
            ),
            (
                "CHANNELS -1",
                motion,
                "line 5: `-1` is not a number of channels",
            ),
            (
                "CHANNELS 1 Xscale",
                motion,
                "line 5: `Xscale` is not a channel",
            ),
            ("JOINT a { }", motion, "line 5: `a` has no offset"),
            (
                "JOINT a { OFFSET 1 2 }",
                motion,
                "three finite numbers, and `}` is none",
            ),
            ("OFFSET 1 2 3", motion, "line 5: expected `CHANNELS` once"),
            (
                "End Site { OFFSET 1 2 3 CHANNELS 0 }",
                motion,
                "expected `}`, not `CHANNELS`",
            ),
            ("", "Frames: -1", "line 8: `-1` is not a number of frames"),
            (
                "",
                "Frames: 100000001",
                "is not a number of frames from 0 to 100000000",
            ),
            (
                "",
                "Frames: 1\nFrame Time: nan",
                "line 9: `nan` is not a frame time",
            ),
            (
                "",
                "Frames: 1\n",
                "line 9: the text ends here and `Frame Time:` is missing",
            ),
            (
                "",
                "Frames: 1\nFrame Time: 1\n7",
                "line 10: `7` follows the last of 1 frames",
            ),
            (
                "CHANNELS 1 Xposition",
                "Frames: 1\nFrame Time: 1\n1e999",
                "value 1 of frame 1 is `1e999`",
            ),
            (
                "CHANNELS 1 Xposition",
                "Frames: 2\nFrame Time: 1\n1\n",
                "ends after 1 frames and 0 of 1 values",
            ),
            ("}", "", "line 6: expected `MOTION`, not `}`"),
        ] {
            let found = error(&text(joints, frames));
            assert!(found.contains(message), "{joints} {frames}: {found}");
        }
        assert_eq!(
            error(""),
            "line 1: the text ends here and `HIERARCHY` is missing"
        );
        assert!(error("HIERARCHY ROOT \u{1b}[2J x").contains("line 1: expected `{`, not `x`"));
        assert!(error("\u{1b}[2J").contains(r"not `\u{1b}[2J`"));
    }

    #[test]
    fn names_words_depth_and_joints_are_limited() {
        let many = "End Site { OFFSET 0 0 0 }\n".repeat(MAX_NODES);
        assert!(error(&text(&many, "")).contains("more than 4096 joints"));
        let deep = "JOINT a { OFFSET 0 0 0\n".repeat(MAX_DEPTH);
        assert!(error(&text(&deep, "")).contains("deeper than 256 levels"));
        let long = "x".repeat(MAX_TOKEN_BYTES + 1);
        assert!(error(&long).contains("longer than 256 bytes"));
        let channels = format!("CHANNELS 99999 {}", "Xposition ".repeat(99_999));
        assert!(error(&text(&channels, "")).contains("more than 24576 channels"));
    }
}
