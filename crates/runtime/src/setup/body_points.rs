//! Points of the body that boards follow, and the sources that measure them.

use ademan_core::capture::SampleKind;
use ademan_core::capture::protocol::{bvh, markers};
use ademan_core::hand::BodyPoint;
use ademan_core::layout::Layout;
use ademan_core::message::escape;

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
                "{}: `anchor: {point}` follows the {point}, which {source} does not measure: nothing would be touched; {}",
                escape(&layout.file),
                remedy(point)
            ))
        })
    }
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
