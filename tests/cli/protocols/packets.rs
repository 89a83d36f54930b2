//! Packets of every protocol: of a hand that presses a key, as far as the protocol can show one.

use ademan::capture::hc11::{Framing, encode};
use ademan::capture::protocol::lucidgloves::Fields;
use ademan::capture::protocol::{
    body_landmarks, hand_landmarks, holistic, joint_sets, opentrack, vmc,
};
use ademan::hand::{ArmBone, BoneRotations, JointPositions, Side};
use ademan::kinematics::HandPose;

use crate::support::lucidgloves::chords;
use crate::support::press::typing;
use crate::support::source::{bvh_text, marker_lines, text_lines, typing_poses};
use crate::support::{body, lucidgloves};

/// A stream in one protocol.
pub struct Stream {
    /// The protocol and its options, as in a URI.
    pub format: String,
    /// Bytes that are sent at once: a packet, or a file.
    pub packets: Vec<Vec<u8>>,
    /// Each packet is a datagram.
    pub is_datagram: bool,
    /// Parts of the lines of `ademan trace readings`, `angles` and `pose`.
    pub traced: [&'static str; 3],
}

impl Stream {
    fn new(format: impl Into<String>, packets: Vec<Vec<u8>>, traced: [&'static str; 3]) -> Self {
        Self {
            format: format.into(),
            packets,
            is_datagram: false,
            traced,
        }
    }

    fn of_lines(format: &str, lines: Vec<String>, traced: [&'static str; 3]) -> Self {
        let packets = lines.into_iter().map(String::into_bytes);
        Self::new(format, packets.collect(), traced)
    }

    /// Returns the name of the protocol.
    pub fn protocol(&self) -> &str {
        self.format.split('&').next().expect("a name")
    }
}

fn hands(pose: &HandPose) -> [(Side, JointPositions); 1] {
    let mut positions = JointPositions::default();
    for (joint, joint_pose) in pose.known() {
        positions.set(joint, joint_pose.translation.as_dvec3());
    }
    [(Side::Right, positions)]
}

fn lines_of_poses(encode: impl Fn(&HandPose) -> String) -> Vec<String> {
    typing_poses("h").iter().map(encode).collect()
}

/// Returns the legacy line of a glove.
fn legacy(fields: &Fields) -> String {
    let curls = fields
        .curls
        .map(|curl| curl.unwrap_or_default().to_string());
    format!("{}&2047&2047&0&0&0&0&0&0\n", curls.join("&"))
}

/// Returns both arms, bent.
fn bones() -> BoneRotations {
    let mut bones = BoneRotations::default();
    for &bone in ArmBone::ALL {
        let turn = glam::Quat::from_rotation_y(0.1);
        bones.left.set(bone, turn);
        bones.right.set(bone, turn.inverse());
    }
    bones
}

/// Returns a stream in each protocol, in both encodings of LucidGloves.
pub fn streams() -> Vec<Stream> {
    const TIP: &str = "\"index-finger-tip\":";
    const COUNTS: &str = "\"channels\":[";
    const JOINTS: &str = "\"joints_m\":{";
    let rate = format!("rate_hz={}", lucidgloves::RATE_HZ);
    let bodies = body::taps(&[Side::Right]);
    let line = |pose: &HandPose| hand_landmarks::encode(Some(pose.time.0), &hands(pose));
    let whole = bodies.iter().zip(typing_poses("h"));
    let whole =
        whole.map(|(body, pose)| holistic::join(&body_landmarks::encode(body), &line(&pose)));
    let set = |protocol: &'static _| {
        lines_of_poses(|pose| joint_sets::encode(protocol, Some(pose.time.0), &hands(pose)))
    };
    let packets = typing("h")
        .iter()
        .map(|body| encode(Framing::Double06, body).to_vec())
        .collect();
    let pose = |x: f64| opentrack::encode(&[x, 0.0, 0.0, 0.0, 0.0, 0.0]).to_vec();
    let mut streams = vec![
        Stream::new(
            "hc11&baud=115200",
            packets,
            [COUNTS, "\"elbow-flexion\":", TIP],
        ),
        Stream::of_lines(
            "text-line&rate_hz=170",
            text_lines("h"),
            ["\"angles_rad\":{", "\"elbow-flexion\":", TIP],
        ),
        Stream::of_lines(
            "markers",
            marker_lines("h"),
            [JOINTS, "\"elbow-flexion\":", TIP],
        ),
        Stream::new(
            "bvh",
            vec![bvh_text("h")],
            [JOINTS, "\"elbow-flexion\":", TIP],
        ),
        Stream::of_lines(
            "body-landmarks",
            bodies.iter().map(body_landmarks::encode).collect(),
            ["\"body_landmarks\":[[", "\"elbow-flexion\":", TIP],
        ),
        Stream::of_lines(
            &format!("lucidgloves&{rate}"),
            chords().iter().map(Fields::encode).collect(),
            [COUNTS, "\"index-pip-flexion\":", TIP],
        ),
        Stream::of_lines(
            &format!("lucidgloves&{rate}"),
            chords().iter().map(legacy).collect(),
            [COUNTS, "\"index-pip-flexion\":", TIP],
        ),
        Stream::of_lines(
            "hand-landmarks&camera=head",
            lines_of_poses(line),
            [JOINTS, "\"index-pip-flexion\":", TIP],
        ),
        Stream::of_lines(
            "holistic&camera=head",
            whole.collect(),
            ["\"part\":\"arm\"", "\"elbow-flexion\":", "\"wrist\":"],
        ),
        Stream::of_lines(
            "openxr",
            set(&joint_sets::OPENXR),
            [JOINTS, "\"index-pip-flexion\":", TIP],
        ),
        Stream::of_lines(
            "webxr",
            set(&joint_sets::WEBXR),
            [JOINTS, "\"index-pip-flexion\":", TIP],
        ),
        Stream::of_lines(
            "imu&rate_hz=100",
            (0..100)
                .map(|number| {
                    let (sin, cos) = (0.01 * f64::from(number)).sin_cos();
                    format!("{cos:.5},{sin:.5},0,0\n")
                })
                .collect(),
            ["\"displacement\":{", "\"angles\":{", TIP],
        ),
        Stream::new(
            "opentrack",
            (0..100)
                .map(|number| pose(0.1 * f64::from(number)))
                .collect(),
            ["\"displacement\":{", "\"angles_rad\":{", TIP],
        ),
        Stream::new(
            "vmc",
            vec![vmc::encode(&bones()); 100],
            ["\"bones\":{", "\"elbow-flexion\":", TIP],
        ),
    ];
    for stream in &mut streams {
        stream.is_datagram = ["opentrack", "vmc"].contains(&stream.protocol());
    }
    streams
}
