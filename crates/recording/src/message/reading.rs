//! The message of a reading.

use arrayvec::ArrayVec;

use super::values::{
    angles, choice, element, floats, position, put_angles, put_floats, put_position, put_side,
    rotation, translation,
};
use super::wire::{
    Field, Fields, Value, WireError, integer, message, put_bytes, put_integer, put_message,
    put_varint, take_varint, text,
};
use ademan_core::capture::body::{BodyLandmarks, Landmark};
use ademan_core::capture::{ChannelSet, Channels, MAX_CHANNELS, Reading, Sample};
use ademan_core::hand::{
    ArmBone, ArmRotations, BoneRotations, Displacement, HandPart, Joint, JointPositions, Side,
};
use ademan_core::time::Timestamp;

/// Field of the direction across the wrist, after the fields of the joints.
const WRIST_AXIS: u32 = Joint::COUNT as u32 + 1;

/// Field of the joints that are predicted.
const PREDICTED: u32 = Joint::COUNT as u32 + 2;

/// Appends the message of a reading.
pub fn encode_reading(reading: &Reading, out: &mut Vec<u8>) {
    put_integer(out, 1, reading.time.0);
    put_side(out, 2, reading.side);
    let part = reading.part.map_or(0, |part| part.index() as u64 + 1);
    put_integer(out, 3, part);
    match &reading.sample {
        Sample::Channels(channels) => put_message(out, 4, |out| put_channels(out, channels)),
        Sample::Angles { angles } => put_angles(out, 5, angles),
        Sample::Joints { positions } => put_message(out, 6, |out| {
            for (joint, position) in positions.known() {
                put_position(out, joint.index() as u32 + 1, position);
            }
            if let Some(axis) = positions.wrist_axis() {
                put_position(out, WRIST_AXIS, axis);
            }
            put_integer(out, PREDICTED, u64::from(positions.predicted_bits()));
        }),
        Sample::Body(body) => put_message(out, 7, |out| {
            for &landmark in &body.points {
                put_floats::<4>(out, 1, landmark.into());
            }
        }),
        Sample::Bones { bones } => put_message(out, 8, |out| {
            for &side in Side::ALL {
                let arm = bones.arm(side);
                put_message(out, side.index() as u32 + 1, |out| put_rotations(out, arm));
            }
        }),
        Sample::Displacement { displacement } => put_message(out, 9, |out| {
            let (translation, rotation) = displacement.to_arrays();
            put_bytes(out, 1, displacement.joint.name().as_bytes());
            put_floats(out, 2, translation);
            put_floats(out, 3, rotation);
        }),
    }
}

/// Decodes the message of a reading. Fields that a later version has added are ignored.
pub fn decode_reading(data: &[u8]) -> Result<Reading, WireError> {
    let mut time = Timestamp(0);
    let (mut side, mut part, mut sample) = (None, None, None);
    for field in Fields::new(data) {
        let field = field?;
        match field.0 {
            1 => time = Timestamp(integer(field)?),
            2 => side = choice(field, Side::ALL)?,
            3 => part = choice(field, HandPart::ALL)?,
            4..=9 => sample = Some(decode_sample(field)?),
            _ => {}
        }
    }
    let sample = sample.ok_or(WireError::NoSample)?;
    Ok(Reading {
        time,
        side,
        part,
        sample,
    })
}

fn decode_sample(field: Field) -> Result<Sample, WireError> {
    let fields = message(field)?;
    Ok(match field.0 {
        4 => Sample::Channels(channels(fields)?),
        5 => Sample::Angles {
            angles: angles(fields)?,
        },
        6 => Sample::Joints {
            positions: positions(fields)?,
        },
        7 => Sample::Body(body(fields)?),
        8 => Sample::Bones {
            bones: bones(fields)?,
        },
        _ => Sample::Displacement {
            displacement: displacement(fields)?,
        },
    })
}

fn put_channels(out: &mut Vec<u8>, channels: &Channels) {
    put_integer(out, 1, channels.full_scale.into());
    put_message(out, 2, |out| {
        for &count in &channels.counts {
            put_varint(out, count.into());
        }
    });
    put_integer(out, 3, channels.unsent.bits());
}

fn channels(fields: Fields) -> Result<Channels, WireError> {
    let mut full_scale = 0;
    let mut counts = ArrayVec::<u16, MAX_CHANNELS>::new();
    let mut unsent = ChannelSet::NONE;
    for field in fields {
        let field = field?;
        match field {
            (1, value) => full_scale = count(1, integer((1, value))?)?,
            (2, Value::Bytes(mut packed)) => {
                while !packed.is_empty() {
                    let count = count(2, take_varint(&mut packed)?)?;
                    counts.try_push(count).map_err(|_| WireError::TooMany(2))?;
                }
            }
            // A writer may also send each number in a field of its own.
            (2, value) => {
                let count = count(2, integer((2, value))?)?;
                counts.try_push(count).map_err(|_| WireError::TooMany(2))?;
            }
            (3, value) => unsent = ChannelSet::from_bits(integer((3, value))?),
            _ => {}
        }
    }
    Ok(Channels {
        full_scale,
        counts,
        unsent,
    })
}

fn count(field: u32, value: u64) -> Result<u16, WireError> {
    u16::try_from(value).map_err(|_| WireError::UnknownValue(field))
}

fn positions(fields: Fields) -> Result<JointPositions, WireError> {
    let mut positions = JointPositions::default();
    for field in fields {
        let field = field?;
        if let Some(joint) = element(field, Joint::ALL) {
            positions.set(joint, position(field)?);
        }
        match field.0 {
            WRIST_AXIS => positions.set_wrist_axis(position(field)?),
            // Bits of joints that a later version has added are dropped.
            PREDICTED => positions.set_predicted_bits(integer(field)? as u32),
            _ => {}
        }
    }
    Ok(positions)
}

fn body(fields: Fields) -> Result<BodyLandmarks, WireError> {
    let mut body = BodyLandmarks::default();
    for field in fields {
        let field = field?;
        if field.0 == 1 {
            let [x, y, z, confidence] = floats(field)?;
            let landmark = Landmark {
                position: [x, y, z],
                confidence,
            };
            let pushed = body.points.try_push(landmark);
            pushed.map_err(|_| WireError::TooMany(1))?;
        }
    }
    Ok(body)
}

fn put_rotations(out: &mut Vec<u8>, arm: &ArmRotations) {
    for (bone, rotation) in arm.known() {
        put_floats(out, bone.index() as u32 + 1, rotation.to_array());
    }
}

fn bones(fields: Fields) -> Result<BoneRotations, WireError> {
    let mut bones = BoneRotations::default();
    for field in fields {
        let field = field?;
        let Some(side) = element(field, Side::ALL) else {
            continue;
        };
        for bone_field in message(field)? {
            let bone_field = bone_field?;
            if let Some(bone) = element(bone_field, ArmBone::ALL) {
                bones.arm_mut(side).set(bone, rotation(bone_field)?);
            }
        }
    }
    Ok(bones)
}

fn displacement(fields: Fields) -> Result<Displacement, WireError> {
    let mut joint = None;
    let (mut moved, mut turned) = (Default::default(), glam::Quat::from_array([0.0; 4]));
    for field in fields {
        let field = field?;
        match field.0 {
            1 => {
                let named = text(field)?.parse();
                joint = Some(named.map_err(|_| WireError::UnknownValue(1))?);
            }
            2 => moved = translation(field)?,
            3 => turned = rotation(field)?,
            _ => {}
        }
    }
    let joint: Joint = joint.ok_or(WireError::NoSample)?;
    Ok(Displacement::new(joint, moved, turned))
}
