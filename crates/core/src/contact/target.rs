//! Targets in space and their outlines.

use parry3d::math::{Pose, Vec2};

/// The outline of a target's front, in metres, around its center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A rectangle with these half extents along the target's X and Y.
    Box(Vec2),
    /// A circle with this radius.
    Disc(f32),
}

/// The share that a target has of the gaps around it: the widening of its outline on each side for fingertips that enter, in
/// metres. A disc is widened by the smallest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Towards −X and −Y of the target.
    pub low: Vec2,
    /// Towards +X and +Y of the target.
    pub high: Vec2,
}

impl Share {
    /// No share: gaps belong to no target.
    pub const NONE: Self = Self {
        low: Vec2::ZERO,
        high: Vec2::ZERO,
    };

    /// Returns the smallest widening.
    pub(super) fn smallest(self) -> f32 {
        self.low.min(self.high).min_element()
    }
}

/// An object that a fingertip can press.
///
/// The origin of its frame is the center of its front at rest; +X is along its row, +Y away from
/// the wearer, +Z out of the front. The press direction is −Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The outline of the front.
    pub shape: Shape,
    /// The share of the gaps around it.
    pub share: Share,
    /// The pose on its surface.
    pub surface_from_target: Pose,
    /// The travel, in metres; more than 0.
    pub travel: f32,
    /// The depth at which the target counts as pressed, as a fraction of the travel: more than `release_at`, at most 1.
    pub press_at: f32,
    /// The depth at which the target counts as released, as a fraction of the travel: 0 or more.
    pub release_at: f32,
    /// The widening of the outline for a fingertip that touches it, in metres: [`TREMOR_MARGIN`] or more for a target that is
    /// only pressed, [`DRAG_MARGIN`] or more for one that is dragged.
    pub margin: f32,
}

impl Target {
    /// Returns the rectangle that a fingertip enters, around the outline and the share: its center and half extents.
    pub(super) fn entrance(&self) -> (Vec2, Vec2) {
        let Share { low, high } = self.share;
        match self.shape {
            Shape::Box(half) => (0.5 * (high - low), half + 0.5 * (high + low)),
            Shape::Disc(radius) => (Vec2::ZERO, Vec2::splat(radius + self.share.smallest())),
        }
    }
}

/// Returns a key of this outline.
#[cfg(test)]
pub(super) fn test_target(shape: Shape, surface_from_target: Pose) -> Target {
    Target {
        shape,
        share: Share::NONE,
        surface_from_target,
        travel: 0.004,
        press_at: 0.5,
        release_at: 0.25,
        margin: TREMOR_MARGIN,
    }
}

/// The smallest [margin](Target::margin), in metres, so that tremor at the edge does not cancel a touch. An unsupported
/// arm sways by 0.5–2 mm below 2 Hz, a fingertip trembles by 0.02–0.1 mm (Arch Neurol 1982;39:358).
pub const TREMOR_MARGIN: f32 = 0.002;

/// The [margin](Target::margin) of targets that are dragged, in metres: during a drag the wearer looks at the effect,
/// not at the finger. Poke interaction of XR headsets uses the same distance.
pub const DRAG_MARGIN: f32 = 0.03;
