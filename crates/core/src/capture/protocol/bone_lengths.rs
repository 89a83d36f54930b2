//! Bones of constant length for sources that measure positions: the option and the fits of an arm and of a body.

use glam::DVec3;

use super::{ProtocolOption, ProtocolOptions, space};
use crate::capture::body::BodyLandmarks;
use crate::capture::bvh::parent_of;
use crate::capture::markers::{LiveFit, SeenBone};
use crate::hand::{Joint, JointPositions};

/// Time in which the lengths are measured, in seconds.
const MEASURING_S: f64 = 3.0;

/// Smallest visibility of a landmark that shows a length.
const MIN_CONFIDENCE: f32 = 0.5;

/// The lengths of bones in a stream: free, or kept from the first seconds.
pub(super) const BONES: ProtocolOption = ProtocolOption {
    name: "bones",
    default: "free",
    summary: "`fixed`: bones keep the median lengths of the first 3 s, and joints are fitted to them",
    check: |value| match value {
        "free" | "fixed" => Ok(()),
        _ => Err(format!("`{value}` is neither `free` nor `fixed`")),
    },
};

/// Bones of a body as landmarks: shoulders, arms, and the three points of each hand.
const BODY_BONES: [(usize, usize); 11] = [
    (11, 12),
    (11, 13),
    (13, 15),
    (15, 17),
    (15, 19),
    (15, 21),
    (12, 14),
    (14, 16),
    (16, 18),
    (16, 20),
    (16, 22),
];

/// Creates the fit if the option asks for it. `rate` is the option of the rate.
pub(super) fn fit(options: &ProtocolOptions, rate: &ProtocolOption) -> Option<LiveFit> {
    let readings = MEASURING_S * space::number(options, rate);
    (options.get(&BONES) == "fixed").then(|| LiveFit::new(readings as usize))
}

/// Fits the joints of an arm and hand. A joint whose position is predicted does not show a length.
pub(super) fn fit_joints(fit: &mut LiveFit, positions: &mut JointPositions) {
    let known: Vec<Joint> = positions.known().map(|(joint, _)| joint).collect();
    let mut points = [DVec3::ZERO; Joint::COUNT];
    for (joint, position) in positions.known() {
        points[joint.index()] = position;
    }
    let bones: Vec<SeenBone> = known
        .iter()
        .filter_map(|&joint| {
            let parent = parent_of(joint, &known)?;
            Some(SeenBone {
                from: parent.index(),
                to: joint.index(),
                is_measured: !positions.is_predicted(joint) && !positions.is_predicted(parent),
            })
        })
        .collect();
    fit.fit(&mut points, &bones);
    for joint in known {
        let is_predicted = positions.is_predicted(joint);
        positions.set(joint, points[joint.index()]);
        if is_predicted {
            positions.set_predicted(joint);
        }
    }
}

/// Fits the arms of a body.
pub(super) fn fit_body(fit: &mut LiveFit, body: &mut BodyLandmarks) {
    let mut points: Vec<DVec3> = body
        .points
        .iter()
        .map(|landmark| DVec3::from(landmark.position.map(f64::from)))
        .collect();
    let is_seen = |index: usize| body.points[index].confidence >= MIN_CONFIDENCE;
    let bones = BODY_BONES.map(|(from, to)| SeenBone {
        from,
        to,
        is_measured: is_seen(from) && is_seen(to),
    });
    fit.fit(&mut points, &bones);
    for (landmark, point) in body.points.iter_mut().zip(points) {
        landmark.position = point.as_vec3().to_array();
    }
}
