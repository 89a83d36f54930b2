//! Tests of the messages against their schema.

use arrayvec::ArrayVec;
use glam::{DVec3, Quat, Vec3};

use super::wire::WireError;
use super::*;
use ademan_core::capture::body::{BodyLandmarks, Landmark};
use ademan_core::capture::{ChannelSet, Channels, Reading, Sample};
use ademan_core::hand::{
    ArmBone, BoneRotations, Displacement, Dof, Finger, HandPart, Joint, JointAngles,
    JointPositions, Side,
};
use ademan_core::time::Timestamp;

/// Values whose bits an encoding loses most easily.
const DOUBLES: [f64; 6] = [0.0, -0.0, 0.1 + 0.2, f64::NAN, f64::INFINITY, 5e-324];
const FLOATS: [f32; 6] = [0.0, -0.0, 0.1, f32::NAN, f32::NEG_INFINITY, 1e-45];

fn samples() -> Vec<Sample> {
    let mut angles = JointAngles::default();
    for (&dof, value) in Dof::ALL.iter().zip(DOUBLES.into_iter().cycle()) {
        angles.set(dof, value);
    }
    let mut positions = JointPositions::default();
    for (&joint, value) in Joint::ALL.iter().zip(DOUBLES.into_iter().cycle()) {
        positions.set(joint, DVec3::new(value, 1.0, -value));
    }
    let mut with_pair = positions;
    with_pair.set_wrist_axis(DVec3::new(-0.0, 5e-324, f64::NAN));
    with_pair.set_predicted(Joint::Shoulder);
    with_pair.set_predicted(Joint::LittleTip);
    let mut bones = BoneRotations::default();
    for (&bone, value) in ArmBone::ALL.iter().zip(FLOATS.into_iter().cycle()) {
        let rotation = Quat::from_array([value, 1.0, -value, 0.0]);
        bones.arm_mut(Side::Left).set(bone, rotation);
    }
    let points = FLOATS.map(|value| Landmark {
        position: [value, -value, 1.0],
        confidence: value,
    });
    let points = points.into_iter().collect();
    let moved = Vec3::new(f32::NAN, -0.0, 1e-45);
    let displacement = Displacement::new(Joint::Elbow, moved, Quat::from_array([-0.0; 4]));
    let channels = |full_scale, counts: &[u16]| {
        let counts = ArrayVec::try_from(counts).unwrap();
        Sample::Channels(Channels {
            full_scale,
            counts,
            unsent: Default::default(),
        })
    };
    vec![
        channels(0, &[]),
        channels(255, &[0, 127, 128, 255]),
        channels(u16::MAX, &[u16::MAX; 64]),
        Sample::Channels(Channels {
            full_scale: 4095,
            counts: [2047; 64].into(),
            unsent: ChannelSet::from_bits(1 << 63 | 0b11_1110_0000),
        }),
        Sample::Angles { angles },
        Sample::Angles {
            angles: JointAngles::default(),
        },
        Sample::Joints { positions },
        Sample::Joints {
            positions: with_pair,
        },
        Sample::Body(BodyLandmarks { points }),
        Sample::Bones { bones },
        Sample::Displacement { displacement },
    ]
}

#[test]
fn readings_of_every_kind_keep_all_bits() {
    for sample in samples() {
        for (time, side, part) in [
            (0, None, None),
            (u64::MAX, Some(Side::Left), Some(HandPart::Fingers)),
            (1, Some(Side::Right), Some(HandPart::Arm)),
        ] {
            let mut reading = Reading::new(Timestamp(time), side, sample.clone());
            reading.part = part;
            let mut message = Vec::new();
            encode_reading(&reading, &mut message);
            let decoded = decode_reading(&message).unwrap();
            // Unlike `==`, this tells 0 from −0 and finds NaN equal to itself.
            assert_eq!(format!("{decoded:?}"), format!("{reading:?}"));
        }
    }
}

#[test]
fn fields_of_a_later_version_are_ignored() {
    let reading = Reading::new(Timestamp(7), None, samples().remove(1));
    let mut message = Vec::new();
    encode_reading(&reading, &mut message);
    wire::put_bytes(&mut message, 99, b"later");
    wire::put_integer(&mut message, 100, 1);
    assert_eq!(decode_reading(&message), Ok(reading));
}

#[test]
fn messages_that_are_no_reading_are_refused() {
    let counts = |number: u64, size: usize| {
        let mut message = Vec::new();
        wire::put_message(&mut message, 4, |out| {
            wire::put_message(out, 2, |out| {
                (0..size).for_each(|_| wire::put_varint(out, number));
            });
        });
        decode_reading(&message)
    };
    assert!(counts(65_535, 64).is_ok());
    assert_eq!(counts(65_536, 1), Err(WireError::UnknownValue(2)));
    assert_eq!(counts(1, 65), Err(WireError::TooMany(2)));
    assert_eq!(decode_reading(b""), Err(WireError::NoSample));
    let field = |number: u32, value: u64| {
        let mut message = Vec::new();
        wire::put_integer(&mut message, number, value);
        decode_reading(&message)
    };
    assert_eq!(field(2, 3), Err(WireError::UnknownValue(2)));
    assert_eq!(field(4, 1), Err(WireError::WrongType(4)));
    let mut landmarks = Vec::new();
    wire::put_message(&mut landmarks, 7, |out| {
        (0..34).for_each(|_| wire::put_message(out, 1, |_| {}));
    });
    assert_eq!(decode_reading(&landmarks), Err(WireError::TooMany(1)));
}

#[test]
fn commands_from_outside_are_decoded_and_others_are_not() {
    for text in [
        "recenter",
        "nudge 0 -1.5 2",
        "tilt -2.5",
        "scale 0.9",
        "profile numbers",
        "text literal",
        "text auto",
        "candidate 2",
        "zero",
    ] {
        let command = text.parse().unwrap();
        for is_external in [true, false] {
            let mut message = Vec::new();
            encode_command(Timestamp(9), &command, is_external, &mut message);
            let expected = is_external.then_some(command);
            assert_eq!(decode_external_command(&message), Ok(expected), "{text}");
        }
    }
    let message = |name: &str, deg: f32| {
        let mut message = Vec::new();
        wire::put_bytes(&mut message, 2, name.as_bytes());
        wire::put_integer(&mut message, 3, 1);
        wire::put_nonzero_float(&mut message, 8, deg);
        decode_external_command(&message)
    };
    assert_eq!(message("tilt", 91.0), Ok(None), "out of range");
    assert_eq!(message("tilt", f32::NAN), Ok(None), "no number");
    assert_eq!(message("dance", 0.0), Ok(None), "of a later version");
    assert_eq!(message("text", 0.0), Ok(None), "without its mode");
    assert_eq!(message("candidate", 0.0), Ok(None), "without its number");
}

/// Returns the names and numbers of the fields of a message, or of the values of an enum.
fn declared(kind: &str, name: &str) -> Vec<(String, usize)> {
    let start = format!("\n{kind} {name} {{\n");
    let (_, body) = SCHEMA_TEXT.split_once(&start).expect("it is declared");
    let (body, _) = body.split_once("\n}").expect("it ends");
    let lines = body.lines().filter_map(|line| line.split_once(" = "));
    lines
        .map(|(field, number)| {
            let label = field.split_whitespace().last().expect("it has a name");
            let number = number.strip_suffix(';').expect("it ends");
            (label.to_owned(), number.parse().expect("a number"))
        })
        .collect()
}

#[test]
fn lists_have_the_names_and_numbers_of_the_schema() {
    let expected = |names: Vec<&str>, prefix: &str| -> Vec<(String, usize)> {
        let name = |name: &str| match prefix {
            "" => name.replace('-', "_"),
            _ => format!("{prefix}_{}", name.replace('-', "_").to_uppercase()),
        };
        names.into_iter().map(name).zip(1..).collect()
    };
    macro_rules! names {
        ($enum:ident) => {
            $enum::ALL.iter().map(|value| value.name()).collect()
        };
    }
    for (message, names) in [
        ("JointAngles", names!(Dof)),
        ("RoundedJointAngles", names!(Dof)),
        (
            "JointPositions",
            [names!(Joint), vec!["wrist-axis", "predicted"]].concat(),
        ),
        ("ArmRotations", names!(ArmBone)),
        ("BoneRotations", names!(Side)),
    ] {
        assert_eq!(
            declared("message", message),
            expected(names, ""),
            "{message}"
        );
    }
    for (name, prefix, names) in [
        ("Side", "SIDE", names!(Side)),
        ("HandPart", "HAND_PART", names!(HandPart)),
        ("Finger", "FINGER", names!(Finger)),
    ] {
        let declared = declared("enum", name);
        assert_eq!(declared[0], (format!("{prefix}_UNSPECIFIED"), 0));
        assert_eq!(declared[1..], expected(names, prefix), "{name}");
    }
}
