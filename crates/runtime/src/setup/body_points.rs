//! Points of the body that boards and pointers follow, and the sources that measure them.

use ademan_core::capture::SampleKind;
use ademan_core::capture::protocol::{bvh, hand_landmarks, markers};
use ademan_core::contact::surface::Anchor;
use ademan_core::device::pointer::mode::JointPointing;
use ademan_core::device::pointer::{AnchoredFrame, PointingMode};
use ademan_core::hand::{BodyPoint, Joint};
use ademan_core::layout::Layout;
use ademan_core::message::escape;
use parry3d::math::Vec3;

use super::LoadedSetup;
use crate::capture::SourceUri;

impl LoadedSetup {
    /// Returns the reason why a layout that follows a point of the body touches nothing with this setup, or `None`. The readings of a
    /// recording are not known before it is played.
    pub fn unmeasured_body_point(&self, layout: &Layout) -> Option<String> {
        let setup = &self.setup;
        let first = setup.arm_source.as_ref().or(setup.source.as_ref());
        let other = setup.other_hand.as_ref().map(|other| {
            let own = self.other_arm_source().or(other.source.as_ref());
            own.or(setup.source.as_ref())
        });
        let sources = || std::iter::once(first).chain(other);
        let mut points = layout.followed_body_points();
        points.find_map(|point| {
            let source = sources().find(|source| !source.is_some_and(|it| measures(it, point)))?;
            let source = source.map_or_else(
                || "the glove".to_owned(),
                |source| format!("`{}`", escape(&source.to_string())),
            );
            Some(format!(
                "`anchor: {point}` follows the {point}, which {source} does not measure: nothing would be touched; {}",
                remedy(point)
            ))
        })
    }

    /// Returns the reason why the pointer or the targets in space of a layout are out of reach with this setup, or `None`. Hand
    /// landmarks show no elbow: the arm then has its elbow at the camera. A webcam faces the person and sees no hand behind itself.
    pub fn unmeasured_elbow(&self, layout: &Layout) -> Option<String> {
        let setup = &self.setup;
        let SourceUri::Stream(stream) = setup.source.as_ref()? else {
            return None;
        };
        let other = setup.other_hand.as_ref();
        let has_other = other.is_some_and(|it| it.source.is_some() || it.arm_source.is_some());
        let is_camera = stream.format.protocol.name == hand_landmarks::PROTOCOL.name;
        if !is_camera || setup.arm_source.is_some() || has_other {
            return None;
        }
        let place = stream.format.options.get(&hand_landmarks::CAMERA);
        let is_webcam = place == hand_landmarks::CAMERA.default;
        let is_hidden = |frame: &AnchoredFrame, center: Vec3| {
            let is_at_elbow = frame.anchor == Anchor::Joint(Joint::Elbow);
            is_webcam && is_at_elbow && (frame.anchor_from_frame * center).z < 0.0
        };
        let mut spaces = layout.spaces.iter().map(|it| &it.space);
        let remedy = match layout.pointer.as_ref().map(|pointer| pointer.mode) {
            Some(PointingMode::Joint(joint)) if moves_with_arm(&joint) => {
                "the cursor does not move; measure the arm with `arm_source`, or use a layout that needs only a hand, such as `webcam-mouse`"
            }
            Some(PointingMode::Direct(direct)) if is_hidden(&direct.frame, Vec3::ZERO) => {
                "the cursor stays at an edge; write `anchor: start` in a copy of the layout, or use `webcam-mouse`"
            }
            None if spaces.any(|space| {
                let mut volumes = space.volumes.iter();
                volumes.all(|volume| is_hidden(&space.frame, volume.center))
            }) =>
            {
                "the targets in space are behind the camera; write `anchor: start` in a copy of the layout"
            }
            _ => return None,
        };
        let source = escape(&stream.to_string()).into_owned();
        Some(format!(
            "the layout needs the elbow, which `{source}` does not measure: {remedy}"
        ))
    }
}

/// Returns `true` if a coordinate of the cursor is an angle of the wrist or the arm.
fn moves_with_arm(joint: &JointPointing) -> bool {
    let mut mappings = [joint.x, joint.y].into_iter().chain(joint.z);
    mappings.any(|mapping| mapping.dof.finger().is_none())
}

fn remedy(point: BodyPoint) -> &'static str {
    match point {
        BodyPoint::Shoulder => {
            "use `protocol=body-landmarks`, `holistic`, `bvh` or `markers`, or another anchor, such as `elbow`"
        }
        BodyPoint::Head | BodyPoint::Hip => {
            "use `protocol=body-landmarks` or `holistic`, or another anchor, such as `elbow`"
        }
    }
}

/// Returns `true` if readings of a source may place a point of the body. A simulated person without a protocol is seen as a whole.
fn measures(source: &SourceUri, point: BodyPoint) -> bool {
    let Some(protocol) = source.protocol() else {
        return true;
    };
    let shows_joints = [bvh::PROTOCOL.name, markers::PROTOCOL.name].contains(&protocol.name);
    match (protocol.sample, point) {
        (SampleKind::Body, _) => true,
        // The arm comes from the body.
        _ if protocol.has_parts => true,
        (_, BodyPoint::Shoulder) => shows_joints,
        (_, BodyPoint::Head | BodyPoint::Hip) => false,
    }
}
