//! VMC: rotations of the bones of a humanoid as OSC messages, as programs for avatars send them.
//!
//! `/VMC/Ext/Bone/Pos` has the name of a bone, its position and its rotation in the frame of its parent. Positions are
//! ignored: the arm of the setup has its own lengths. The rotation of an upper arm includes its parents' rotations. A
//! frame ends with the datagram that holds `/VMC/Ext/T` or `/VMC/Ext/OK`, or before a bone that it already has: some senders send
//! neither message, others send them seldom, and datagrams are lost. Other messages and additional arguments are ignored. A
//! message that is not valid is left out of its datagram.

mod bone_names;

use glam::Quat;

use self::bone_names::{NamedBone, TRUNK, bone_of, name_of};
use super::datagrams::{DatagramDecoder, DatagramParser};
use super::osc::{self, Message};
use super::{Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol};
use crate::capture::{Reading, Sample, SampleKind};
use crate::hand::{ArmBone, BoneRotations, Side};
use crate::message::escape;
use crate::time::Timestamp;

/// The VMC protocol.
pub const PROTOCOL: Protocol = Protocol {
    name: "vmc",
    summary: "VMC (OSC): rotations of the bones of arms and hands, from a program for avatars",
    sample: SampleKind::Bones,
    has_both_hands: true,
    has_parts: false,
    position_noise: PositionNoise::None,
    carriers: Carriers::Datagrams,
    // A bundle of a time message.
    min_packet_bytes: 40,
    default_baud: None,
    feedback: None,
    options: &[],
    nominal_rate_hz: |_| None,
    decoder: |_| Box::new(decoder()),
    encoder: |_, _| {
        Ok(Box::new(|readings, bytes| {
            bytes.extend(encode(&merged(readings)))
        }))
    },
};

/// Address of the messages of bones.
const BONE: &[u8] = b"/VMC/Ext/Bone/Pos";
/// Address of the message with the state of the sender: 1 if its model is loaded.
const STATE: &[u8] = b"/VMC/Ext/OK";
/// Address of the message with the time of the sender.
const TIME: &[u8] = b"/VMC/Ext/T";

/// Smallest length of a quaternion that shows a rotation.
const MIN_LENGTH: f32 = 1e-3;
/// Largest length of a quaternion: beyond it the square is not exact.
const MAX_LENGTH: f32 = 1e6;

/// Parser of the datagrams of one sender.
#[derive(Clone, Debug, Default)]
pub struct VmcParser {
    /// The bones of the frame so far.
    frame: BoneRotations,
    /// The latest rotations of the bones of the trunk, each in the frame of its parent.
    trunk: [Quat; TRUNK.len()],
    /// The latest rotations of the shoulders in the frame of the trunk, by side.
    shoulders: [Quat; Side::COUNT],
    /// The rotations of the upper arms of the frame so far in the frames of the shoulders, by side.
    upper_arms: [Option<Quat>; Side::COUNT],
    /// `true` if the sender names the metacarpals of the thumbs.
    has_metacarpals: bool,
    /// The names of the frame so far, as [bits](name_bit).
    names: u64,
}

/// Creates a decoder before the first datagram.
pub fn decoder() -> DatagramDecoder<VmcParser> {
    DatagramDecoder::with_parser(VmcParser::default())
}

/// Contents of the messages of a datagram, except the bones.
#[derive(Default)]
struct DatagramState {
    is_frame_end: bool,
    is_model_missing: bool,
    understood: bool,
    error: Option<PacketError>,
}

impl DatagramParser for VmcParser {
    /// The longest datagram of UDP.
    const MAX_BYTES: usize = 65_507;

    fn parse(
        &mut self,
        datagram: &[u8],
        emit: &mut dyn FnMut(Packet),
    ) -> Result<Option<PacketError>, PacketError> {
        let mut state = DatagramState::default();
        let error = osc::messages(datagram, &mut |message| {
            self.handle(message, &mut state, emit);
        });
        let error = error.or(state.error);
        if state.is_model_missing {
            // The next model may have other bones.
            self.reset();
        }
        if state.is_frame_end {
            self.end_frame(emit);
        }
        match (state.understood, error) {
            (false, Some(error)) => Err(error),
            (_, error) => Ok(error),
        }
    }

    fn reset(&mut self) {
        *self = Self::default();
    }
}

impl VmcParser {
    fn handle(
        &mut self,
        message: Message,
        state: &mut DatagramState,
        emit: &mut dyn FnMut(Packet),
    ) {
        let result = match message.address {
            BONE => self.add_bone(&message, emit),
            STATE => message.int().map(|loaded| {
                state.is_frame_end = true;
                state.is_model_missing |= loaded == 0;
            }),
            TIME => message.float().map(|_| state.is_frame_end = true),
            _ => Ok(()),
        };
        match result {
            Ok(()) => state.understood = true,
            Err(error) => state.error = state.error.take().or(Some(error)),
        }
    }

    fn add_bone(
        &mut self,
        message: &Message,
        emit: &mut dyn FnMut(Packet),
    ) -> Result<(), PacketError> {
        let (name, numbers) = message.string_and_floats::<7>().ok_or_else(|| {
            PacketError::new(
                InvalidPacket::Truncated,
                "a bone has no name or less than 7 numbers",
            )
        })?;
        let bone = bone_of(name).ok_or_else(|| {
            let name = String::from_utf8_lossy(name);
            let text = format!("unknown bone `{}`", escape(&name));
            PacketError::new(InvalidPacket::Unknown, text)
        })?;
        if bone == NamedBone::Body {
            return Ok(());
        }
        let [_, _, _, x, y, z, w] = numbers;
        let rotation = rotation([x, y, z, w]).ok_or_else(|| {
            PacketError::new(
                InvalidPacket::NotFinite,
                "a rotation is not finite or has no length",
            )
        })?;
        self.set_bone(bone, rotation, emit);
        Ok(())
    }

    fn set_bone(&mut self, bone: NamedBone, rotation: Quat, emit: &mut dyn FnMut(Packet)) {
        let bit = name_bit(bone);
        if self.names & bit != 0 {
            self.end_frame(emit);
        }
        self.names |= bit;
        let (side, bone) = match bone {
            NamedBone::Body => return,
            NamedBone::Trunk(index) => return self.trunk[index] = rotation,
            NamedBone::Shoulder(side) => return self.shoulders[side.index()] = rotation,
            NamedBone::Arm(side, ArmBone::UpperArm) => {
                return self.upper_arms[side.index()] = Some(rotation);
            }
            NamedBone::ThumbMetacarpal(side) => {
                self.has_metacarpals = true;
                (side, ArmBone::ThumbFirst)
            }
            NamedBone::Arm(side, ArmBone::ThumbFirst) if self.has_metacarpals => {
                (side, ArmBone::ThumbSecond)
            }
            NamedBone::Arm(side, bone) => (side, bone),
        };
        self.frame.arm_mut(side).set(bone, rotation);
    }

    fn end_frame(&mut self, emit: &mut dyn FnMut(Packet)) {
        let mut bones = std::mem::take(&mut self.frame);
        self.names = 0;
        let trunk = self.trunk.iter().copied().product::<Quat>();
        for &side in Side::ALL {
            let upper_arm = self.upper_arms[side.index()].take();
            // An avatar without a tracked arm has an upper arm at rest.
            if let Some(rotation) = upper_arm.filter(|_| !bones.arm(side).is_empty()) {
                let rotation = trunk * self.shoulders[side.index()] * rotation;
                bones.arm_mut(side).set(ArmBone::UpperArm, rotation);
            }
        }
        if !bones.left.is_empty() || !bones.right.is_empty() {
            emit(Packet::new(Sample::Bones { bones }, 0));
        }
    }
}

/// Returns the bit of a bone of an arm in a set of names; 0 for other bones.
fn name_bit(bone: NamedBone) -> u64 {
    let (side, index) = match bone {
        NamedBone::Arm(side, bone) => (side, bone.index()),
        NamedBone::ThumbMetacarpal(side) => (side, ArmBone::COUNT),
        NamedBone::Trunk(_) | NamedBone::Shoulder(_) | NamedBone::Body => return 0,
    };
    1 << (side.index() * (ArmBone::COUNT + 1) + index)
}

/// Converts a quaternion from the left-handed frame of Unity (X right, Y up, Z forward) to the world.
fn rotation([x, y, z, w]: [f32; 4]) -> Option<Quat> {
    let quaternion = Quat::from_xyzw(-x, -y, z, w);
    let length = quaternion.length();
    let is_valid = (MIN_LENGTH..=MAX_LENGTH).contains(&length);
    is_valid.then(|| quaternion.normalize())
}

/// Returns the bones of the arms that the readings show.
fn merged(readings: &[Reading]) -> BoneRotations {
    let mut merged = BoneRotations::default();
    for reading in readings {
        let Sample::Bones { bones } = &reading.sample else {
            continue;
        };
        for &side in Side::ALL {
            for (bone, rotation) in bones.arm(side).known() {
                merged.arm_mut(side).set(bone, rotation);
            }
        }
    }
    merged
}

/// Writes a frame at time 0.
pub fn encode(bones: &BoneRotations) -> Vec<u8> {
    encode_at(bones, Timestamp::default())
}

/// Writes a frame as a datagram: a bundle of the state and the time, with the bones in a bundle of their own.
pub fn encode_at(bones: &BoneRotations, time: Timestamp) -> Vec<u8> {
    let mut messages = Vec::new();
    for (side, prefix) in [(Side::Left, "Left"), (Side::Right, "Right")] {
        for (bone, rotation) in bones.arm(side).known() {
            messages.push(encode_bone(&format!("{prefix}{}", name_of(bone)), rotation));
        }
    }
    osc::bundle(&[
        osc::encode("/VMC/Ext/OK", None, &[1], &[]),
        osc::encode("/VMC/Ext/T", None, &[], &[time.seconds() as f32]),
        osc::bundle(&messages),
    ])
}

fn encode_bone(name: &str, rotation: Quat) -> Vec<u8> {
    let [x, y, z, w] = rotation.to_array();
    let numbers = [0.0, 0.0, 0.0, -x, -y, z, w];
    osc::encode("/VMC/Ext/Bone/Pos", Some(name), &[], &numbers)
}

#[cfg(test)]
mod tests;
