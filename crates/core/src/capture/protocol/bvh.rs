//! BVH motion capture: a text with a skeleton and its frames, as a file or as a stream from its start.
//!
//! The joints of one arm and hand are found by [their names](crate::capture::bvh::joint_of). A file plays at its frame
//! time.

use super::encoder::{hands, require_defaults};
use super::space::{self, Facing, HAND, UP, WorldFromSource};
use super::{Carriers, Decoder, Packet, PositionNoise, Protocol, ProtocolOption, ProtocolOptions};
use crate::capture::bvh::{
    self, ArmShape, ArmsSkeleton, BvhError, BvhParser, HandJoints, Motion, NodePose,
    PositionChannels,
};
use crate::capture::{Sample, SampleKind, SourceStats};
use crate::geometry::EulerOrder;
use crate::hand::{JointPositions, Side};
use crate::time::Timestamp;

/// The BVH protocol.
pub const PROTOCOL: Protocol = Protocol {
    name: "bvh",
    summary: "motion capture in a BVH text: the joints of one arm and hand, by their names",
    sample: SampleKind::Joints,
    has_both_hands: false,
    has_parts: false,
    position_noise: PositionNoise::None,
    carriers: Carriers::Streams,
    // Three rotations of shoulder, elbow and wrist: one digit and one separator each.
    min_packet_bytes: 18,
    default_baud: None,
    feedback: None,
    options: &[&HAND, &UNIT, &UP, &POSITIONS],
    // Every frame states its time.
    nominal_rate_hz: |_| None,
    decoder: |options| Box::new(BvhDecoder::new(options)),
    encoder: |options, plan| {
        require_defaults(options, &[&UNIT, &UP, &POSITIONS])?;
        let mut encoder = BvhEncoder {
            hand: space::hand(options),
            frame_time: plan.packet_period.as_secs_f64(),
            frames: (plan.count_packets)(),
            skeleton: None,
            values: Vec::new(),
        };
        Ok(Box::new(move |readings, bytes| {
            for (_, joints) in hands(readings) {
                encoder.encode(&joints, bytes);
            }
        }))
    },
};

/// Longest time between two frames, in seconds. Longer ones are milliseconds by mistake.
const MAX_FRAME_TIME: f64 = 1.0;

const UNIT: ProtocolOption = ProtocolOption {
    name: "unit_mm",
    default: "10",
    summary: "millimetres in the unit of the file: 10 for centimetres, 1000 for metres",
    check: space::check_unit,
};

const POSITIONS: ProtocolOption = ProtocolOption {
    name: "positions",
    default: "add",
    summary: "position channels `add` to the offset of a joint or `replace` it, as in files of Blender",
    check: |value| match value.parse::<PositionChannels>() {
        Ok(_) => Ok(()),
        Err(error) => Err(error.to_string()),
    },
};

/// Encoder of the joints of one hand.
struct BvhEncoder {
    hand: Side,
    /// The time between two frames, in seconds.
    frame_time: f64,
    frames: u64,
    /// Known from the first frame on.
    skeleton: Option<ArmsSkeleton>,
    values: Vec<f64>,
}

impl BvhEncoder {
    fn encode(&mut self, joints: &JointPositions, bytes: &mut Vec<u8>) {
        let skeleton = self.skeleton.get_or_insert_with(|| {
            let shape = ArmShape::measure(std::slice::from_ref(joints), self.hand);
            let arms: Vec<ArmShape> = shape.into_iter().collect();
            let skeleton = ArmsSkeleton::new(&arms, None, EulerOrder::Zxy);
            let header = skeleton.skeleton();
            bvh::write_header(bytes, header, self.frames, self.frame_time);
            skeleton
        });
        let mut arms = [JointPositions::default(); Side::COUNT];
        arms[self.hand.index()] = *joints;
        skeleton.frame(&arms, &mut self.values);
        bvh::write_frame(bytes, &self.values);
    }
}

/// Decoder of a BVH text.
#[derive(Clone, Debug)]
pub struct BvhDecoder {
    parser: BvhParser,
    frames: FrameReader,
    stats: SourceStats,
    /// Offset of the first byte of the text in the stream.
    text_start: u64,
    /// Offset of the first byte after the last frame, from the start of the stream.
    last_end: u64,
    error: Option<String>,
    has_failed: bool,
}

/// A method of the parser that ends the text.
type EndOfText = fn(&mut BvhParser, &mut dyn FnMut(&Motion, &[f64], u64)) -> Result<(), BvhError>;

impl BvhDecoder {
    /// Creates a decoder at the start of a text.
    pub fn new(options: &ProtocolOptions) -> Self {
        let unit_mm = space::number(options, &UNIT);
        let positions = options.get(&POSITIONS).parse();
        Self {
            parser: BvhParser::new(),
            frames: FrameReader {
                hand: space::hand(options),
                world: WorldFromSource::new(options, unit_mm, Facing::TowardsViewer),
                positions: positions.expect("options are checked when they are set"),
                joints: None,
                poses: Vec::new(),
                count: 0,
            },
            stats: SourceStats::default(),
            text_start: 0,
            last_end: 0,
            error: None,
            has_failed: false,
        }
    }

    /// Runs the parser and counts what it found.
    fn parse(
        &mut self,
        emit: &mut dyn FnMut(Packet),
        run: impl FnOnce(&mut BvhParser, &mut dyn FnMut(&Motion, &[f64], u64)) -> Result<(), BvhError>,
    ) {
        let (mut frame_error, mut readings) = (None, 0);
        let mut on_frame = |motion: &Motion, values: &[f64], end: u64| {
            if frame_error.is_some() {
                return;
            }
            match self.frames.read(motion, values, self.text_start + end) {
                Ok(packet) => {
                    self.last_end = packet.end;
                    readings += 1;
                    emit(packet);
                }
                Err(reason) => frame_error = Some(reason),
            }
        };
        let result = run(&mut self.parser, &mut on_frame);
        self.stats.readings += readings;
        let reason = frame_error.or_else(|| result.err().map(|error| error.to_string()));
        if let Some(reason) = reason {
            self.fail(reason);
        }
    }

    fn fail(&mut self, reason: String) {
        self.error = Some(reason);
        self.has_failed = true;
        self.stats.resyncs += 1;
        self.skip_rest();
    }

    /// Ends the text with a method of the parser.
    fn end_text(&mut self, emit: &mut dyn FnMut(Packet), end: EndOfText) {
        // A connection without a text may be followed by one with a text; a file may not.
        let is_empty = self.stats.bytes == self.text_start && self.text_start > 0;
        if !self.has_failed && !is_empty {
            self.parse(emit, end);
            // Such a text is valid, but its sender means to show a hand.
            if !self.has_failed && self.frames.count == 0 {
                self.fail("the text has no frame with values".to_owned());
            }
        }
        // Blanks after the last frame are part of the text; the rest of a text with an error is skipped already.
        self.last_end = self.stats.bytes;
    }

    fn skip_rest(&mut self) {
        self.stats.skipped_bytes += self.stats.bytes - self.last_end;
        self.last_end = self.stats.bytes;
    }
}

impl Decoder for BvhDecoder {
    fn push(&mut self, bytes: &[u8], emit: &mut dyn FnMut(Packet)) {
        self.stats.bytes += bytes.len() as u64;
        if self.has_failed {
            self.skip_rest();
            return;
        }
        self.parse(emit, |parser, on_frame| parser.push(bytes, on_frame));
    }

    fn finish(&mut self, emit: &mut dyn FnMut(Packet)) {
        self.end_text(emit, BvhParser::finish);
    }

    fn finish_cut(&mut self, emit: &mut dyn FnMut(Packet)) {
        self.end_text(emit, BvhParser::finish_cut);
    }

    fn reset(&mut self) {
        self.skip_rest();
        self.parser = BvhParser::new();
        (self.frames.joints, self.frames.count) = (None, 0);
        (self.text_start, self.has_failed, self.error) = (self.stats.bytes, false, None);
    }

    fn pending_bytes(&self) -> usize {
        (self.stats.bytes - self.last_end) as usize
    }

    fn stats(&self) -> SourceStats {
        self.stats
    }

    fn take_error(&mut self) -> Option<String> {
        self.error.take()
    }
}

/// The conversion of frames to joint positions.
#[derive(Clone, Debug)]
struct FrameReader {
    hand: Side,
    world: WorldFromSource,
    positions: PositionChannels,
    /// Known from the first frame on.
    joints: Option<HandJoints>,
    poses: Vec<NodePose>,
    count: u64,
}

impl FrameReader {
    fn read(&mut self, motion: &Motion, values: &[f64], end: u64) -> Result<Packet, String> {
        if self.joints.is_none() {
            self.joints = Some(self.find_joints(motion)?);
        }
        self.count += 1;
        let skeleton = &motion.skeleton;
        skeleton.world_poses(values, self.positions, &mut self.poses);
        let mut positions = JointPositions::default();
        for (joint, node) in self.joints.iter().flat_map(HandJoints::iter) {
            positions.set(joint, self.world.position(self.poses[node].position));
        }
        Ok(Packet {
            sample: Sample::Joints { positions },
            end,
            time: Some(Timestamp::from_seconds(
                self.count as f64 * motion.frame_time,
            )),
            sent_at: None,
            side: Some(self.hand),
            part: None,
        })
    }

    fn find_joints(&self, motion: &Motion) -> Result<HandJoints, String> {
        if motion.frame_time == 0.0 {
            return Err(
                "`Frame Time:` is 0, so the frames have no order in time; write the seconds between two frames"
                    .to_owned(),
            );
        }
        if motion.frame_time > MAX_FRAME_TIME {
            let frame_time = motion.frame_time;
            return Err(format!(
                "`Frame Time:` is {frame_time} seconds, more than {MAX_FRAME_TIME}; if these are milliseconds, write {}",
                frame_time / 1000.0
            ));
        }
        HandJoints::find(&motion.skeleton, self.hand).map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::capture::protocol::options;
    use crate::hand::Joint;

    const TEXT: &str = "HIERARCHY\nROOT Hips { OFFSET 0 0 0 CHANNELS 3 Xposition Yposition Zposition\n\
        JOINT RightArm { OFFSET -20 150 0 CHANNELS 1 Zrotation\n\
        JOINT RightForeArm { OFFSET -30 0 0 CHANNELS 1 Yrotation\n\
        JOINT RightHand { OFFSET -25 0 0 CHANNELS 0 End Site { OFFSET -18 0 0 } } } } }\n\
        MOTION\nFrames: 2\nFrame Time: 0.02\n0 0 0 0 0\n10 0 0 90 0\n";

    fn decode(options: &ProtocolOptions, text: &str, size: usize) -> (Vec<Packet>, BvhDecoder) {
        let (mut decoder, mut packets) = (BvhDecoder::new(options), Vec::new());
        for piece in text.as_bytes().chunks(size) {
            decoder.push(piece, &mut |packet| packets.push(packet));
        }
        decoder.finish(&mut |packet| packets.push(packet));
        (packets, decoder)
    }

    fn position(packet: &Packet, joint: Joint) -> DVec3 {
        match &packet.sample {
            Sample::Joints { positions } => positions.get(joint).unwrap(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn frames_are_positions_in_metres_at_the_frame_time() {
        for size in [1, 7, 10_000] {
            let (packets, mut decoder) = decode(&options(&[]), TEXT, size);
            let times: Vec<_> = packets
                .iter()
                .map(|packet| packet.time.unwrap().0)
                .collect();
            assert_eq!(times, [20_000, 40_000]);
            assert_eq!(packets[0].side, Some(Side::Right));
            let tip = position(&packets[0], Joint::IndexTip);
            assert!(tip.distance(DVec3::new(0.93, 1.5, 0.0)) < 1e-9, "{tip}");
            let elbow = position(&packets[1], Joint::Elbow);
            assert!(elbow.distance(DVec3::new(0.1, 1.2, 0.0)) < 1e-9, "{elbow}");
            let stats = decoder.stats();
            assert_eq!((stats.readings, stats.bytes), (2, TEXT.len() as u64));
            assert_eq!((stats.skipped_bytes, decoder.take_error()), (0, None));
        }
    }

    #[test]
    fn a_unit_of_metres_and_z_up_are_converted() {
        let options = options(&[(&UNIT, "1000"), (&UP, "z")]);
        let (packets, _) = decode(&options, TEXT, 100);
        let tip = position(&packets[0], Joint::IndexTip);
        assert!(tip.distance(DVec3::new(93.0, 0.0, 150.0)) < 1e-9, "{tip}");
    }

    #[test]
    fn errors_keep_the_frames_before_them_and_state_what_is_wrong() {
        let error = |options: &ProtocolOptions, text: &str| {
            let (packets, mut decoder) = decode(options, text, 50);
            let stats = decoder.stats();
            assert_eq!(decoder.pending_bytes(), 0);
            assert_eq!(stats.bytes, text.len() as u64);
            (packets.len(), decoder.take_error().unwrap())
        };
        let cut = TEXT.strip_suffix("90 0\n").unwrap();
        let (frames, reason) = error(&options(&[]), cut);
        assert!(
            reason.contains("after 1 frames and 3 of 5 values"),
            "{reason}"
        );
        assert_eq!(frames, 1);
        let (left_frames, left_reason) = error(&options(&[(&HAND, "left")]), TEXT);
        assert!(left_reason.contains("use `hand=right`"), "{left_reason}");
        assert_eq!(left_frames, 0);
        let (_, time_reason) = error(&options(&[]), &TEXT.replace("0.02", "0"));
        assert!(time_reason.contains("`Frame Time:` is 0"), "{time_reason}");
        let (_, long_reason) = error(&options(&[]), &TEXT.replace("0.02", "33.333"));
        assert!(
            long_reason.contains("`Frame Time:` is 33.333 seconds, more than 1; if these are milliseconds, write 0.033333"),
            "{long_reason}"
        );
        let (_, empty_reason) = error(&options(&[]), "");
        assert!(
            empty_reason.contains("the text ends here"),
            "{empty_reason}"
        );
        let (header, _) = TEXT.split_once("Frames: 2").unwrap();
        let no_frames = format!("{header}Frames: 0\nFrame Time: 0.02\n");
        let (_, no_frames_reason) = error(&options(&[]), &no_frames);
        assert_eq!(no_frames_reason, "the text has no frame with values");
    }

    #[test]
    fn a_number_at_the_end_of_a_cut_text_is_read_only_if_it_completes_the_text() {
        let ended = |text: &str| {
            let (mut decoder, mut packets) = (BvhDecoder::new(&options(&[])), Vec::new());
            decoder.push(text.as_bytes(), &mut |packet| packets.push(packet));
            decoder.finish_cut(&mut |packet| packets.push(packet));
            (packets.len(), decoder.take_error())
        };
        assert_eq!(ended(TEXT.trim_end()), (2, None));
        let longer = TEXT.replace("Frames: 2", "Frames: 3");
        let (frames, reason) = ended(longer.trim_end());
        let reason = reason.expect("an error");
        assert!(
            reason.contains("after 1 frames and 4 of 5 values"),
            "{reason}"
        );
        assert_eq!(frames, 1);
    }

    #[test]
    fn a_new_connection_starts_a_new_text() {
        let mut decoder = BvhDecoder::new(&options(&[]));
        let mut packets = Vec::new();
        decoder.push(&TEXT.as_bytes()[..300], &mut |packet| packets.push(packet));
        decoder.reset();
        decoder.push(TEXT.as_bytes(), &mut |packet| packets.push(packet));
        assert_eq!(packets.len(), 2);
        assert_eq!(packets[1].end, 300 + TEXT.len() as u64 - 1);
    }
}
