//! Lines of a simulated room with three cameras.

use glam::DVec3;
use serde_json::{Value, json};

use crate::hand::{Joint, JointPositions};

/// Optical centers of the cameras around a person whose shoulder is at the origin, in metres.
const CAMERAS: [DVec3; 3] = [
    DVec3::new(0.8, 1.0, 0.3),
    DVec3::new(-0.9, 0.9, -0.2),
    DVec3::new(0.1, 1.2, -1.4),
];

/// Writes the line of three cameras that see a marker over each joint, with its line end. Positions are in the world, in
/// metres.
///
/// The first camera labels all markers, the second one only the arm and the third one none, so that reading the line
/// includes matching.
pub fn encode(time_us: Option<u64>, joints: &JointPositions) -> String {
    let cameras: Vec<Value> = (0..CAMERAS.len())
        .map(|camera| json!({ "position": CAMERAS[camera].to_array(), "markers": markers(camera, joints) }))
        .collect();
    let line = match time_us {
        Some(time) => json!({ "time_us": time, "cameras": cameras }),
        None => json!({ "cameras": cameras }),
    };
    format!("{line}\n")
}

fn markers(camera: usize, joints: &JointPositions) -> Vec<Value> {
    let marker = |(joint, position): (Joint, DVec3)| {
        let direction = (position - CAMERAS[camera]).to_array();
        let is_labelled = camera == 0 || (camera == 1 && joint <= Joint::Wrist);
        if is_labelled {
            json!({ "label": joint, "direction": direction })
        } else {
            json!({ "direction": direction })
        }
    };
    joints.known().map(marker).collect()
}
