//! Hands that move and reach nothing.

use std::time::Duration;

use parry3d::math::Vec3;

use super::{LayoutInstance, Pipeline, PipelineState};
use crate::contact::{TargetId, trusted_fingertip};
use crate::device::pointer::mode::DirectPointing;
use crate::device::pointer::{AnchoredFrame, PointingMode};
use crate::hand::{Finger, Side};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// The time for which a hand must move without an effect before it is reported.
const MIN_TIME: Duration = Duration::from_secs(5);

/// The distance from its first position beyond which a hand has moved, in metres.
const MIN_MOTION: f32 = 0.05;

/// A hand that has moved for 5 s while output was enabled, or could have been, and has touched and pointed at nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unreached {
    /// The hand.
    pub side: Side,
    /// The control that is nearest to it; `None` if the source does not show what the layout is anchored to or measures.
    pub nearest: Option<NearestControl>,
}

/// The control that is nearest to the index fingertip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestControl {
    /// The target; `None` for the range of the pointer.
    pub target: Option<TargetId>,
    /// `true` if it is on a board, which can be moved to the hand.
    pub is_on_board: bool,
    /// The vector from the fingertip to its center, or from the point that a pointer follows to its range: to the right, up,
    /// towards the wearer, in metres.
    pub way: Vec3,
}

/// The detector of a hand that moves without an effect.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ReachWatch {
    since: Option<(Timestamp, Vec3)>,
    has_moved: bool,
    /// Set once: a person who knows the layout may move without touching anything.
    found: Option<Unreached>,
    is_over: bool,
}

impl ReachWatch {
    /// Notes that the hand has reached something, or that nothing is to be reached.
    fn restart(&mut self) {
        self.since = None;
        self.has_moved = false;
        self.is_over |= self.found.take().is_some();
    }

    /// Appends a position without an effect. Returns `true` once the hand has to be reported.
    fn push(&mut self, time: Timestamp, position: Vec3) -> bool {
        let (since, first) = *self.since.get_or_insert((time, position));
        self.has_moved |= first.distance(position) > MIN_MOTION;
        self.has_moved && !self.is_over && self.found.is_none() && time.since(since) >= MIN_TIME
    }
}

impl Pipeline {
    /// Returns a hand that moves and reaches nothing; at most once for each hand, until it reaches something.
    pub fn unreached(&self) -> Option<Unreached> {
        self.hands.iter().find_map(|hand| hand.reach.found)
    }

    /// Updates the detection for one hand after a step; `has_events` is `true` if the step has emitted any.
    pub(super) fn watch_reach(&mut self, index: usize, has_events: bool) {
        let layout = &self.profiles[self.active_profile].layout;
        let may_reach = match self.state() {
            PipelineState::Running => !self.awaits_start(),
            PipelineState::Paused => !self.is_paused(),
            _ => false,
        };
        let hand = &mut self.hands[index];
        let output = &hand.output;
        // The remedy for boards is `recenter`, which needs this fingertip.
        let tip = trusted_fingertip(&output.pose, Finger::Index);
        let is_reaching = has_events || !output.touches.is_empty() || layout.is_pointing();
        let Some(tip) = tip.filter(|_| may_reach && !is_reaching && layout.has_place()) else {
            hand.reach.restart();
            return;
        };
        if hand.reach.push(output.pose.time, tip) {
            hand.reach.found = Some(Unreached {
                side: output.pose.side,
                nearest: layout.nearest_control(&output.pose, tip),
            });
        }
    }
}

impl LayoutInstance {
    /// Returns `true` if the layout has controls that a hand reaches by its position, or a pointer.
    fn has_place(&self) -> bool {
        let mut surfaces = self.scene().surfaces().iter();
        let has_board = surfaces.any(|surface| !surface.is_bent());
        let layout = self.layout();
        has_board || layout.is_some_and(|it| it.pointer.is_some() || !it.spaces.is_empty())
    }

    /// Returns the control whose center is nearest to a fingertip of this hand; `None` if no control has a position.
    fn nearest_control(&self, pose: &HandPose, tip: Vec3) -> Option<NearestControl> {
        let surfaces = self.scene().surfaces().iter();
        let surfaces = surfaces.filter(|surface| !surface.is_bent());
        let on_boards = surfaces.flat_map(|surface| {
            let world_from_surface = surface.world_from_surface(pose).into_iter();
            world_from_surface.flat_map(move |world_from_surface| {
                surface.targets().map(move |(id, target)| NearestControl {
                    target: Some(id),
                    is_on_board: true,
                    way: (world_from_surface * target.surface_from_target).translation - tip,
                })
            })
        });
        let layout = self.layout();
        let pointer = layout.and_then(|layout| layout.pointer.as_ref());
        let range = pointer.and_then(|pointer| way_to_range(&pointer.mode, pose, tip));
        let range = range.map(|way| NearestControl {
            target: None,
            is_on_board: false,
            way,
        });
        // Joint angles move a cursor in the spaces, and not the fingertip.
        let has_fingertip = !pointer.is_some_and(|it| matches!(it.mode, PointingMode::Joint(_)));
        let spaces = layout.into_iter().filter(|_| has_fingertip);
        let spaces = spaces.flat_map(|it| &it.spaces);
        let in_spaces = spaces.flat_map(|space| {
            let space = &space.space;
            let frame = space.frame.world_from_frame(pose).into_iter();
            frame.flat_map(move |frame| {
                let ids = (space.first_target.0..).map(TargetId);
                ids.zip(space.volumes.iter())
                    .map(move |(id, volume)| NearestControl {
                        target: Some(id),
                        is_on_board: false,
                        way: frame * volume.center - tip,
                    })
            })
        });
        let all = on_boards.chain(range).chain(in_spaces);
        let finite = all.filter(|control| control.way.is_finite());
        finite.min_by(|one, other| {
            let (one, other) = (one.way.length_squared(), other.way.length_squared());
            one.total_cmp(&other)
        })
    }
}

/// Returns the vector from the point that moves in a box to the nearest point of the box, or from a fingertip to the center of
/// another range.
fn way_to_range(mode: &PointingMode, pose: &HandPose, tip: Vec3) -> Option<Vec3> {
    let frame = mode
        .frame()
        .map(|frame: &AnchoredFrame| frame.world_from_frame(pose))??;
    let (from, half) = match mode {
        PointingMode::Direct(DirectPointing { point, size, .. }) => {
            (pose.position(point.joint())?, *size / 2.0)
        }
        _ => (tip, Vec3::ZERO),
    };
    let local = frame.inverse_transform_point(from);
    Some(frame * local.clamp(-half, half) - from)
}
