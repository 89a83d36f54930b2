//! Orientations of an inertial sensor on the wrist or the forearm: a quaternion per line of text.
//!
//! A line has the four numbers of a unit quaternion, separated by commas, blanks or tabs: `0.998,0.012,-0.051,0.03`. It may end with
//! the time on the clock of the sender in microseconds: `0.998 0.012 -0.051 0.03 time_us=12500`. The quaternion turns vectors of the
//! sensor to a frame that is fixed to the earth, of which only this matters: it is right-handed. Up and north may lie anywhere, so
//! sensors with and without a compass serve alike.
//!
//! The first valid line is the neutral pose, held still at the start: every later one is the rotation since then, about the
//! axes that the sensor had in the neutral pose. There the axes of the sensor point along the forearm to the fingers (X), to the
//! left (Y) and up (Z), and the forearm points to the bearing of the option `bearing_deg`. The rotation displaces the joint of
//! the option `joint` from its pose at rest; a sensor measures no position.
//!
//! A quaternion of another length than 1 is a damaged line. The decoder scales the length of one within a tenth to 1. The neutral
//! pose ends with the stream, and with a line of text in which a board says that it starts: a sensor that starts again has another north.

use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

use super::line_times::LineTimes;
use super::lines::{LineDecoder, LineParser};
use super::text_line::{RATE, numbers, split_time};
use super::{
    Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol, ProtocolOption,
    ProtocolOptions, space,
};
use crate::capture::{Sample, SampleKind};
use crate::hand::{Displacement, Joint};

/// The protocol of inertial sensors.
pub const PROTOCOL: Protocol = Protocol {
    name: "imu",
    summary: "inertial sensor: orientation of the wrist or the forearm, a quaternion per line of text",
    sample: SampleKind::Displacement,
    has_both_hands: false,
    has_parts: false,
    position_noise: PositionNoise::None,
    carriers: Carriers::Any,
    // A digit and a separator for each number.
    min_packet_bytes: 2 * NUMBERS,
    default_baud: None,
    feedback: None,
    options: &[&JOINT, &ORDER, &BEARING, &RATE],
    nominal_rate_hz: |options| Some(space::number(options, &RATE)),
    decoder: |options| Box::new(decoder(options)),
    encoder: |_, _| {
        Err("an inertial sensor measures no position, so no simulated hand moves by it; use `opentrack`".into())
    },
};

const JOINT: ProtocolOption = ProtocolOption {
    name: "joint",
    default: "wrist",
    summary: "joint that turns: `wrist` for a sensor on the hand, `elbow` for one on the forearm",
    check: |value| match value {
        "wrist" | "elbow" => Ok(()),
        _ => Err(format!("`{value}` is not `wrist` or `elbow`")),
    },
};

const ORDER: ProtocolOption = ProtocolOption {
    name: "order",
    default: "wxyz",
    summary: "order of the numbers, `wxyz` or `xyzw`",
    check: |value| match value {
        "wxyz" | "xyzw" => Ok(()),
        _ => Err(format!("`{value}` is not `wxyz` or `xyzw`")),
    },
};

const BEARING: ProtocolOption = ProtocolOption {
    name: "bearing_deg",
    default: "0",
    summary: "direction of the forearm in the neutral pose: 0 is straight forward, 90 to the right",
    check: |value| space::check_range(value, -180.0..=180.0, "degrees"),
};

/// Numbers in a line.
const NUMBERS: usize = 4;

/// Largest difference of the length of a quaternion from 1. Senders round to two decimals or more.
const MAX_LENGTH_ERROR: f64 = 0.1;

/// Words of which a line has one when a board or its sensor starts, in any case. Other text, such as the state of a calibration, may
/// come at any time.
const RESTART_WORDS: [&str; 3] = ["boot", "reset", "start"];

/// Parser of one line.
#[derive(Clone, Debug)]
pub struct ImuParser {
    joint: Joint,
    is_w_first: bool,
    /// Turns the axes of the sensor in the neutral pose to the axes of the world.
    world_from_sensor: DQuat,
    neutral: Option<DQuat>,
    times: LineTimes,
}

/// Creates a decoder before the neutral pose.
pub fn decoder(options: &ProtocolOptions) -> LineDecoder<ImuParser> {
    let bearing = space::number(options, &BEARING).to_radians();
    // Forward, left and up in the world: X points to the right, Y up and Z to the wearer.
    let axes = DMat3::from_cols(DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y);
    LineDecoder::with_parser(ImuParser {
        joint: match options.get(&JOINT) {
            "elbow" => Joint::Elbow,
            _ => Joint::Wrist,
        },
        is_w_first: options.get(&ORDER) == "wxyz",
        world_from_sensor: DQuat::from_rotation_y(-bearing) * DQuat::from_mat3(&axes),
        neutral: None,
        times: LineTimes::default(),
    })
}

impl ImuParser {
    fn quaternion(&self, numbers: [f64; NUMBERS]) -> Result<DQuat, PacketError> {
        let [w, x, y, z] = match (self.is_w_first, numbers) {
            (true, numbers) => numbers,
            (false, [x, y, z, w]) => [w, x, y, z],
        };
        let quaternion = DQuat::from_xyzw(x, y, z, w);
        let length = quaternion.length();
        if (length - 1.0).abs() <= MAX_LENGTH_ERROR {
            Ok(quaternion.normalize())
        } else {
            let text = format!("the quaternion has the length {length:.3} instead of 1");
            Err(PacketError::new(InvalidPacket::Unknown, text))
        }
    }
}

impl LineParser for ImuParser {
    const MAX_LINE_BYTES: usize = 256;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let (text, time) = split_time(std::str::from_utf8(line)?)?;
        let words = text.split(|it: char| it == ',' || it.is_ascii_whitespace());
        let quaternion = self.quaternion(numbers(words)?)?;
        let time = self.times.check(time)?;
        let neutral = *self.neutral.get_or_insert(quaternion);
        let since = neutral.inverse() * quaternion;
        let rotation = self.world_from_sensor * since * self.world_from_sensor.inverse();
        let [x, y, z, w] = rotation.to_array().map(|number| number as f32);
        let turn = Quat::from_xyzw(x, y, z, w);
        let displacement = Displacement::new(self.joint, Vec3::ZERO, turn);
        emit(Packet::of_line(Sample::Displacement { displacement }, time));
        Ok(())
    }

    fn may_lack_start(_: &[u8]) -> bool {
        // The first number may lack its sign or digits.
        true
    }

    fn is_restart(line: &[u8]) -> bool {
        RESTART_WORDS.iter().any(|word| {
            let mut parts = line.windows(word.len());
            parts.any(|part| part.eq_ignore_ascii_case(word.as_bytes()))
        })
    }

    fn reset(&mut self) {
        self.neutral = None;
        self.times = LineTimes::default();
    }
}

#[cfg(test)]
mod tests;
