use super::*;
use crate::capture::protocol::Decoder;

/// Decodes datagrams; returns the frames.
fn decode(decoder: &mut DatagramDecoder<VmcParser>, datagrams: &[Vec<u8>]) -> Vec<BoneRotations> {
    let mut frames = Vec::new();
    let mut emit = |packet: Packet| match packet.sample {
        Sample::Bones { bones } => frames.push(bones),
        other => panic!("{other:?}"),
    };
    for datagram in datagrams {
        for piece in datagram.chunks(7) {
            decoder.push(piece, &mut emit);
        }
        decoder.finish(&mut emit);
    }
    frames
}

/// Returns the message of a bone with this rotation in Unity's frame.
fn bone(name: &str, [x, y, z, w]: [f32; 4]) -> Vec<u8> {
    let numbers = [0.1, 0.2, 0.3, x, y, z, w];
    osc::encode("/VMC/Ext/Bone/Pos", Some(name), &[], &numbers)
}

const REST: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

fn time() -> Vec<u8> {
    osc::encode("/VMC/Ext/T", None, &[], &[1.5])
}

fn names(frame: &BoneRotations) -> Vec<String> {
    let arm = |side| frame.arm(side).known().map(move |(bone, _)| (side, bone));
    let bones = arm(Side::Left).chain(arm(Side::Right));
    bones.map(|(side, bone)| format!("{side} {bone}")).collect()
}

#[test]
fn encoded_bones_are_decoded() {
    let mut bones = BoneRotations::default();
    for (index, &bone) in ArmBone::ALL.iter().enumerate() {
        let turn = Quat::from_rotation_x(0.1 * index as f32) * Quat::from_rotation_z(0.3);
        bones.left.set(bone, turn);
        bones.right.set(bone, turn.inverse());
    }
    let frames = decode(&mut decoder(), &[encode(&bones)]);
    assert_eq!(frames.len(), 1);
    for &side in Side::ALL {
        for (bone, sent) in bones.arm(side).known() {
            let received = frames[0].arm(side).get(bone).expect("the bone");
            assert!(received.abs_diff_eq(sent, 1e-6), "{side} {bone}");
        }
    }
}

#[test]
fn a_rotation_is_converted_from_the_left_handed_frame_of_unity() {
    // About Y, from forward to the right in Unity: from −Z to +X in the world.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = bone("RightHand", [0.0, half, 0.0, half]);
    let frames = decode(&mut decoder(), &[osc::bundle(&[turn, time()])]);
    let hand = frames[0].right.get(ArmBone::Hand).expect("the hand");
    assert!((hand * glam::Vec3::NEG_Z).abs_diff_eq(glam::Vec3::X, 1e-6));
    // A quaternion of another length is normalized.
    let long_turn = bone("RightHand", [0.0, 20.0 * half, 0.0, 20.0 * half]);
    let long_frames = decode(&mut decoder(), &[osc::bundle(&[long_turn, time()])]);
    assert!(
        long_frames[0]
            .right
            .get(ArmBone::Hand)
            .unwrap()
            .is_normalized()
    );
}

#[test]
fn a_frame_of_several_datagrams_with_nested_bundles_is_one_sample() {
    let first = osc::bundle(&[
        bone("Hips", REST),
        bone("LeftUpperArm", REST),
        bone("LeftIndexDistal", REST),
    ]);
    let second = osc::bundle(&[bone("LeftLowerArm", REST)]);
    let nested = osc::bundle(&[osc::bundle(&[bone("LeftHand", REST)])]);
    let state = osc::encode("/VMC/Ext/OK", None, &[1, 3, 1], &[]);
    let last = osc::bundle(&[state, time(), nested]);
    let mut decoder = decoder();
    let frames = decode(&mut decoder, &[first, second, last]);
    assert_eq!(frames.len(), 1);
    assert_eq!(
        names(&frames[0]),
        [
            "left lower-arm",
            "left hand",
            "left index-3",
            "left upper-arm"
        ]
    );
    let stats = decoder.stats();
    assert_eq!((stats.skipped_bytes, stats.invalid.total()), (0, 0));
}

#[test]
fn the_rotation_of_an_upper_arm_includes_the_bones_from_the_hips_to_the_shoulder() {
    // About Z, so that the angles add up; Unity's axis points the other way twice.
    let turn = |name, radians: f32| {
        let (sin, cos) = (radians / 2.0).sin_cos();
        bone(name, [0.0, 0.0, sin, cos])
    };
    let trunk = osc::bundle(&[
        turn("Hips", 0.01),
        turn("Spine", 0.02),
        turn("Chest", 0.04),
        turn("UpperChest", 0.08),
        turn("RightShoulder", 0.16),
        turn("LeftShoulder", 5.0),
        turn("RightUpperArm", 0.32),
        turn("LeftUpperArm", 0.32),
        turn("RightLowerArm", 0.64),
        time(),
    ]);
    // The bones above stay where they were if their datagram is lost.
    let arm = osc::bundle(&[
        turn("RightUpperArm", 0.5),
        turn("RightLowerArm", 0.64),
        time(),
    ]);
    let lost = osc::bundle(&[turn("RightLowerArm", 0.64), time()]);
    let frames = decode(&mut decoder(), &[trunk, arm, lost]);
    let angle = |frame: &BoneRotations| {
        let upper_arm = frame.right.get(ArmBone::UpperArm)?;
        let along = upper_arm * glam::Vec3::X;
        Some((along.y.atan2(along.x) * 1e3).round())
    };
    let angles: Vec<_> = frames.iter().map(angle).collect();
    assert_eq!(angles, [Some(630.0), Some(810.0), None]);
    assert!(frames.iter().all(|frame| frame.left.is_empty()));
}

#[test]
fn a_sender_without_end_messages_ends_a_frame_with_a_bone_that_comes_again() {
    let mut decoder = decoder();
    let arm = |name| bone(name, REST);
    let frames = decode(
        &mut decoder,
        &[
            arm("LeftHand"),
            arm("RightHand"),
            arm("LeftHand"),
            arm("RightHand"),
            arm("LeftHand"),
        ],
    );
    assert_eq!(frames.len(), 2);
    assert!(frames.iter().all(|frame| names(frame).len() == 2));
}

#[test]
fn a_bone_that_comes_again_ends_a_frame_of_a_sender_whose_end_messages_are_seldom_or_lost() {
    let mut decoder = decoder();
    let state = osc::encode("/VMC/Ext/OK", None, &[1], &[]);
    for end in [time(), state] {
        assert!(decode(&mut decoder, &[end]).is_empty());
        let arm = |name| bone(name, REST);
        let frames = decode(
            &mut decoder,
            &[
                osc::bundle(&[arm("LeftUpperArm"), arm("LeftHand")]),
                osc::bundle(&[arm("LeftUpperArm"), arm("LeftHand")]),
                osc::bundle(&[arm("LeftUpperArm"), arm("LeftHand"), time()]),
            ],
        );
        let names: Vec<_> = frames.iter().map(names).collect();
        assert_eq!(names, vec![["left hand", "left upper-arm"]; 3]);
    }
}

#[test]
fn a_thumb_named_by_both_conventions_ends_no_frame() {
    let thumb = ["Metacarpal", "Proximal", "Intermediate", "Distal"];
    let mut messages: Vec<_> = thumb
        .iter()
        .map(|segment| bone(&format!("LeftThumb{segment}"), REST))
        .collect();
    messages.push(time());
    let mut decoder = decoder();
    for _ in 0..2 {
        let frames = decode(&mut decoder, &[osc::bundle(&messages)]);
        assert_eq!(frames.len(), 1);
    }
}

#[test]
fn end_messages_without_their_argument_end_no_frame_and_are_counted() {
    let messages = |argument: &[u8]| {
        ["/VMC/Ext/T", "/VMC/Ext/OK"].map(|address| {
            let mut message = osc::encode(address, None, &[], &[]);
            message.truncate(address.len() / 4 * 4 + 4);
            message.extend_from_slice(argument);
            message
        })
    };
    for (argument, reason) in [
        (&b",\0\0\0"[..], InvalidPacket::Truncated),
        (b",i\0\0", InvalidPacket::Truncated),
        (b",s\0\0one\0", InvalidPacket::Unknown),
        (b",f\0\0\x7f\xc0\0\0", InvalidPacket::NotFinite),
    ] {
        for bad in messages(argument) {
            let mut decoder = decoder();
            let frames = decode(&mut decoder, &[bone("LeftHand", REST), bad.clone()]);
            assert!(frames.is_empty(), "{}", bad.escape_ascii());
            let invalid = decoder.stats().invalid;
            assert_eq!(invalid.total(), 1, "{}", bad.escape_ascii());
            // The first argument of one message has the type of the other one.
            let is_type = invalid.get(InvalidPacket::Unknown) == 1;
            assert!(
                invalid.get(reason) == 1 || is_type,
                "{}",
                bad.escape_ascii()
            );
            let [hand, end] = [bone("RightHand", REST), time()];
            let complete = decode(&mut decoder, &[osc::bundle(&[hand, end])]);
            assert_eq!(names(&complete[0]), ["left hand", "right hand"]);
        }
    }
}

#[test]
fn one_bad_message_does_not_void_the_datagram() {
    let numbers = [0.0; 6];
    let short = osc::encode("/VMC/Ext/Bone/Pos", Some("LeftHand"), &[], &numbers);
    let nameless = osc::encode("/VMC/Ext/Bone/Pos", None, &[], &[0.0; 7]);
    for (bad, reason) in [
        (short, InvalidPacket::Truncated),
        (nameless, InvalidPacket::Truncated),
        (bone("LeftHand", [0.0; 4]), InvalidPacket::NotFinite),
        (
            bone("LeftHand", [f32::NAN, 0.0, 0.0, 1.0]),
            InvalidPacket::NotFinite,
        ),
        (
            bone("LeftHand", [f32::INFINITY, 0.0, 0.0, 1.0]),
            InvalidPacket::NotFinite,
        ),
        (bone("LeftHnad", REST), InvalidPacket::Unknown),
        (b"no osc".to_vec(), InvalidPacket::Unknown),
        (Vec::new(), InvalidPacket::Unknown),
    ] {
        let mut decoder = decoder();
        let good = bone("RightHand", REST);
        let frames = decode(&mut decoder, &[osc::bundle(&[bad, good, time()])]);
        assert_eq!(frames.len(), 1, "{reason}");
        assert_eq!(names(&frames[0]), ["right hand"]);
        let stats = decoder.stats();
        assert_eq!(stats.invalid.get(reason), 1, "{reason}");
        assert_eq!(stats.skipped_bytes, 0);
    }
}

#[test]
fn additional_arguments_and_other_addresses_are_ignored() {
    let mut more = bone("RightHand", REST);
    let types = more.windows(9).position(|it| it == b",sfffffff").unwrap();
    // Three more floats: the types end four bytes later.
    more.splice(types..types + 12, *b",sffffffffff\0\0\0\0");
    more.extend([0; 12]);
    let other = osc::encode("/VMC/Ext/Con", Some("key"), &[], &[1.0]);
    let mut decoder = decoder();
    let frames = decode(&mut decoder, &[osc::bundle(&[other, more, time()])]);
    assert_eq!(names(&frames[0]), ["right hand"]);
    assert_eq!(decoder.stats().invalid.total(), 0);
}

#[test]
fn names_of_vrm_are_known_and_its_metacarpal_is_the_first_bone_of_the_thumb() {
    let frame = |names: &[&str]| {
        let mut messages: Vec<Vec<u8>> = names.iter().map(|name| bone(name, REST)).collect();
        messages.push(time());
        let frames = decode(&mut decoder(), &[osc::bundle(&messages)]);
        frames.first().map(super::tests::names)
    };
    assert_eq!(
        frame(&["leftLittleProximal", "rightPinkyDistal", "LEFTHAND"]).unwrap(),
        ["left hand", "left little-1", "right little-3"]
    );
    assert_eq!(
        frame(&["RightThumbProximal", "RightThumbIntermediate"]).unwrap(),
        ["right thumb-1", "right thumb-2"]
    );
    assert_eq!(
        frame(&[
            "rightThumbMetacarpal",
            "rightThumbProximal",
            "rightThumbDistal"
        ])
        .unwrap(),
        ["right thumb-1", "right thumb-2", "right thumb-3"]
    );
    assert_eq!(frame(&["Hips", "LeftFoot", "Jaw", "RightEye"]), None);
}

#[test]
fn a_sender_without_a_model_shows_no_hand() {
    let state = osc::encode("/VMC/Ext/OK", None, &[0], &[]);
    let datagram = osc::bundle(&[bone("LeftHand", REST), state, time()]);
    assert!(decode(&mut decoder(), &[datagram]).is_empty());
}

#[test]
fn the_model_after_another_one_keeps_none_of_its_names_and_rotations() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let first = osc::bundle(&[
        bone("Hips", [0.0, half, 0.0, half]),
        bone("LeftThumbMetacarpal", REST),
        time(),
    ]);
    let unloaded = osc::encode("/VMC/Ext/OK", None, &[0], &[]);
    let second = osc::bundle(&[
        bone("LeftUpperArm", REST),
        bone("LeftThumbProximal", REST),
        time(),
    ]);
    let mut decoder = decoder();
    let frames = decode(&mut decoder, &[first, unloaded, second]);
    let last = frames.last().expect("a frame");
    assert_eq!(names(last), ["left thumb-1", "left upper-arm"]);
    assert_eq!(last.left.get(ArmBone::UpperArm), Some(Quat::IDENTITY));
}

#[test]
fn damaged_bundles_end_without_a_loop() {
    let good = encode(&{
        let mut bones = BoneRotations::default();
        bones.right.set(ArmBone::Hand, Quat::IDENTITY);
        bones
    });
    let mut decoder = decoder();
    for length in 0..good.len() {
        decode(&mut decoder, &[good[..length].to_vec()]);
    }
    for at in (16..good.len() - 4).step_by(4) {
        for number in [-1_i32, i32::MIN, i32::MAX, 0, 3] {
            let mut damaged = good.clone();
            damaged[at..at + 4].copy_from_slice(&number.to_be_bytes());
            decode(&mut decoder, &[damaged]);
        }
    }
    let nested = (0..100).fold(time(), |inner, _| osc::bundle(&[inner]));
    let mut nested_decoder = super::decoder();
    assert!(decode(&mut nested_decoder, &[nested]).is_empty());
    assert_eq!(nested_decoder.stats().invalid.total(), 1);
    let mut large_decoder = super::decoder();
    assert!(decode(&mut large_decoder, &[vec![0; 70_000]]).is_empty());
    assert_eq!(
        large_decoder.stats().invalid.get(InvalidPacket::WrongSize),
        1
    );
    assert_eq!(large_decoder.stats().skipped_bytes, 70_000);
}
