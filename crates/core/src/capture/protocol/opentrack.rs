//! Poses of opentrack: datagrams of six doubles in the byte order of a PC.
//!
//! The numbers are the position along X, Y and Z in centimetres, then yaw, pitch and roll in degrees. They are measured
//! from the pose that opentrack was centered on, and displace the wrist or the elbow from its pose at rest. X points to the
//! right, Y up and Z backwards; yaw turns to the left, pitch up, and roll lowers the left side. Opentrack inverts an axis on request.
//!
//! A datagram that does not have exactly [`PACKET_BYTES`] bytes is not a packet.

use glam::{EulerRot, Quat, Vec3};

use super::datagrams::{DatagramDecoder, DatagramParser};
use super::{
    Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol, ProtocolOption,
    ProtocolOptions,
};
use crate::capture::{Sample, SampleKind};
use crate::hand::{Displacement, Joint};

/// The opentrack protocol.
pub const PROTOCOL: Protocol = Protocol {
    name: "opentrack",
    summary: "opentrack: position and rotation of the wrist or the elbow",
    sample: SampleKind::Displacement,
    has_both_hands: false,
    has_parts: false,
    position_noise: PositionNoise::None,
    carriers: Carriers::Datagrams,
    min_packet_bytes: PACKET_BYTES,
    default_baud: None,
    feedback: None,
    options: &[&JOINT],
    nominal_rate_hz: |_| None,
    decoder: |options| Box::new(decoder(joint(options))),
    encoder: |_, _| {
        Ok(Box::new(|readings, bytes| {
            for reading in readings {
                if let Sample::Displacement { displacement } = &reading.sample {
                    bytes.extend(encode(&pose(displacement)));
                }
            }
        }))
    },
};

const JOINT: ProtocolOption = ProtocolOption {
    name: "joint",
    default: "wrist",
    summary: "joint that is tracked, `wrist` or `elbow`",
    check: |value| match value {
        "wrist" | "elbow" => Ok(()),
        _ => Err(format!("`{value}` is not `wrist` or `elbow`")),
    },
};

fn joint(options: &ProtocolOptions) -> Joint {
    match options.get(&JOINT) {
        "elbow" => Joint::Elbow,
        _ => Joint::Wrist,
    }
}

/// Bytes of a datagram: six doubles.
pub const PACKET_BYTES: usize = 48;

/// Largest distance along an axis, in centimetres: no camera tracks a hand that is further away.
pub const MAX_POSITION: f64 = 1000.0;

/// Largest angle, in degrees: more than any number of turns that a tracker counts.
const MAX_ANGLE: f64 = 3600.0;

/// Parser of a datagram.
#[derive(Clone, Copy, Debug)]
pub struct OpentrackParser {
    joint: Joint,
}

/// Creates a decoder for poses of `joint`.
pub fn decoder(joint: Joint) -> DatagramDecoder<OpentrackParser> {
    DatagramDecoder::with_parser(OpentrackParser { joint })
}

/// Writes a pose as a datagram: X, Y and Z in centimetres, then yaw, pitch and roll in degrees.
pub fn encode(pose: &[f64; 6]) -> [u8; PACKET_BYTES] {
    let mut datagram = [0; PACKET_BYTES];
    for (bytes, number) in datagram.as_chunks_mut().0.iter_mut().zip(pose) {
        *bytes = number.to_le_bytes();
    }
    datagram
}

/// Returns the numbers of a displacement.
fn pose(displacement: &Displacement) -> [f64; 6] {
    let [x, y, z] = displacement
        .translation()
        .to_array()
        .map(|axis| f64::from(axis) * 100.0);
    let rotation = displacement.rotation().unwrap_or_default();
    let (yaw, pitch, roll) = rotation.to_euler(EulerRot::YXZ);
    let [yaw, pitch, roll] = [yaw, pitch, roll].map(|angle| f64::from(angle).to_degrees());
    [x, y, z, yaw, pitch, roll]
}

/// Reads the six numbers of a datagram.
fn parse(datagram: &[u8]) -> Result<[f64; 6], PacketError> {
    let datagram: &[u8; PACKET_BYTES] = datagram.try_into().map_err(|_| {
        let reason = if datagram.len() < PACKET_BYTES {
            InvalidPacket::Truncated
        } else {
            InvalidPacket::WrongSize
        };
        let text = format!("{} bytes instead of {PACKET_BYTES}", datagram.len());
        PacketError::new(reason, text)
    })?;
    let numbers = datagram.as_chunks().0;
    let pose: [f64; 6] = std::array::from_fn(|index| f64::from_le_bytes(numbers[index]));
    let (position, angles) = pose.split_at(3);
    let is_within = |values: &[f64], limit: f64| values.iter().all(|it| it.abs() <= limit);
    if is_within(position, MAX_POSITION) && is_within(angles, MAX_ANGLE) {
        Ok(pose)
    } else {
        Err(PacketError::new(
            InvalidPacket::NotFinite,
            "a number is not finite or too large",
        ))
    }
}

impl DatagramParser for OpentrackParser {
    const MAX_BYTES: usize = PACKET_BYTES;

    fn parse(
        &mut self,
        datagram: &[u8],
        emit: &mut dyn FnMut(Packet),
    ) -> Result<Option<PacketError>, PacketError> {
        let pose = parse(datagram)?;
        let [x, y, z] = [0, 1, 2].map(|axis| (pose[axis] / 100.0) as f32);
        let [yaw, pitch, roll] = [3, 4, 5].map(|axis| pose[axis].to_radians() as f32);
        let rotation = Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll);
        let displacement = Displacement::new(self.joint, Vec3::new(x, y, z), rotation);
        emit(Packet::new(Sample::Displacement { displacement }, 0));
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::protocol::Decoder;

    /// Decodes datagrams; returns the displacements.
    fn decode(
        decoder: &mut DatagramDecoder<OpentrackParser>,
        datagrams: &[&[u8]],
    ) -> Vec<Displacement> {
        let mut displacements = Vec::new();
        let mut emit = |packet: Packet| match packet.sample {
            Sample::Displacement { displacement } => displacements.push(displacement),
            other => panic!("{other:?}"),
        };
        for datagram in datagrams {
            decoder.push(datagram, &mut emit);
            decoder.finish(&mut emit);
        }
        displacements
    }

    #[test]
    fn a_datagram_is_a_displacement_in_metres_and_radians() {
        let mut decoder = decoder(Joint::Elbow);
        let datagram = encode(&[10.0, -20.0, 30.0, 90.0, 0.0, 0.0]);
        let found = decode(&mut decoder, &[&datagram]);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].joint, Joint::Elbow);
        assert_eq!(found[0].translation(), Vec3::new(0.1, -0.2, 0.3));
        let turned = found[0].rotation().expect("a rotation") * Vec3::NEG_Z;
        assert!(turned.distance(Vec3::NEG_X) < 1e-6, "to the left: {turned}");
        for (angles, axis, expected) in [
            ([0.0, 90.0, 0.0], Vec3::NEG_Z, Vec3::Y),
            ([0.0, 0.0, 90.0], Vec3::NEG_X, Vec3::NEG_Y),
        ] {
            let [yaw, pitch, roll] = angles;
            let turn_only = encode(&[0.0, 0.0, 0.0, yaw, pitch, roll]);
            let decoded = decode(&mut decoder, &[&turn_only]);
            let rotated = decoded[0].rotation().expect("a rotation") * axis;
            assert!(rotated.distance(expected) < 1e-6, "{angles:?}: {rotated}");
        }
    }

    #[test]
    fn datagrams_of_another_size_or_with_impossible_numbers_are_dropped_by_reason() {
        let good = encode(&[0.0; 6]);
        let with = |index: usize, number: f64| {
            let mut pose = [0.0; 6];
            pose[index] = number;
            encode(&pose)
        };
        let mut decoder = decoder(Joint::Wrist);
        let long = [good, good].concat();
        let sizes: [&[u8]; 6] = [&[], &good[..1], &good[..47], &long[..49], &long, &good];
        assert_eq!(decode(&mut decoder, &sizes).len(), 1);
        let (mut nan, mut bytes) = (0, 1 + 47 + 49 + 96);
        for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, 1000.1] {
            let datagram = with(nan % 3, number);
            assert_eq!(decode(&mut decoder, &[&datagram]), []);
            nan += 1;
            bytes += PACKET_BYTES;
        }
        assert_eq!(decode(&mut decoder, &[&with(4, f64::NAN)]), []);
        let stats = decoder.stats();
        assert_eq!(stats.skipped_bytes, (bytes + PACKET_BYTES) as u64);
        assert_eq!((stats.readings, decoder.pending_bytes()), (1, 0));
        for (reason, count) in [
            (InvalidPacket::Truncated, 2),
            (InvalidPacket::WrongSize, 2),
            (InvalidPacket::NotFinite, 6),
        ] {
            assert_eq!(stats.invalid.get(reason), count, "{reason}");
        }
        for number in [-0.0, f64::MIN_POSITIVE, 5e-324, 1000.0] {
            assert_eq!(decode(&mut decoder, &[&with(0, number)]).len(), 1);
        }
    }
}
