//! Targets in space: a target is selected while the cursor is in it.

use parry3d::math::Vec3;

use super::anchored_frame::AnchoredFrame;
use crate::contact::TargetId;
use crate::contact::surface::TREMOR_MARGIN;
use crate::contact::volume::{Volume, VolumeEntry, VolumeSet};
use crate::device::{
    Capabilities, DeviceOutput, EventKind, KeyAction, MAX_CURSOR_SPACES, PressSource,
};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// Maximum number of targets that the cursor enters in one step; further targets are skipped.
const MAX_ENTRIES: usize = 4;

/// Resolution of the depth, in steps: hand tremor then emits no events.
const DEPTH_STEPS: f32 = 100.0;

/// Targets in space that share a frame.
#[derive(Clone, Debug)]
pub struct SelectionSpace {
    /// The frame of the targets.
    pub frame: AnchoredFrame,
    /// The id of the first target; the others have consecutive ids.
    pub first_target: TargetId,
    /// The volumes of the targets.
    pub volumes: VolumeSet,
    /// The action held while a target is selected, one entry per volume.
    pub actions: Vec<Option<KeyAction>>,
}

impl SelectionSpace {
    fn target(&self, index: usize) -> TargetId {
        TargetId(self.first_target.0 + index as u32)
    }
}

/// The position of the cursor, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CursorPoint {
    /// A position in the world.
    InWorld(Vec3),
    /// A position in the frame of every space.
    InEachSpace(Vec3),
}

impl CursorPoint {
    fn in_space(self, space: &SelectionSpace, pose: &HandPose) -> Option<Vec3> {
        match self {
            Self::InWorld(point) => space.frame.to_local(pose, point),
            Self::InEachSpace(point) => Some(point),
        }
    }
}

/// Selects targets with a cursor.
///
/// Between two steps the cursor moves on a straight line, so it cannot tunnel through a target. A target is
/// selected from the point where the cursor enters it until the cursor is [`TREMOR_MARGIN`] outside. Where
/// targets overlap, the one with the nearest center is selected; the selection changes when another center
/// is nearer by that margin. A cursor that is in a target when it is first seen, or that has entered one
/// [in a gap](HandPose::is_after_gap), has to leave all targets before it selects one.
#[derive(Clone, Debug)]
pub(super) struct Selector {
    spaces: Vec<SelectionSpace>,
    /// The last position of the cursor in each space.
    before: Vec<Option<Vec3>>,
    time: Timestamp,
    /// `true` if the cursor has been outside all targets.
    is_armed: bool,
    selected: Option<Selected>,
    /// A target whose unselect event is not emitted yet.
    pending_unselect: Option<TargetId>,
}

#[derive(Clone, Copy, Debug)]
struct Selected {
    space: usize,
    /// The index of the volume in its space.
    volume: usize,
    target: TargetId,
    /// The depth that was emitted last.
    depth: f32,
}

impl Selector {
    pub(super) fn new(spaces: Vec<SelectionSpace>) -> Self {
        Self {
            before: vec![None; spaces.len()],
            spaces,
            time: Timestamp::default(),
            is_armed: false,
            selected: None,
            pending_unselect: None,
        }
    }

    /// Iterates over the positions of the cursor in the first spaces, in metres; `None` where it is unknown.
    pub(super) fn positions(&self) -> impl Iterator<Item = Option<Vec3>> + '_ {
        self.before.iter().copied().take(MAX_CURSOR_SPACES)
    }

    pub(super) fn add_capabilities(&self, required: &mut Capabilities) {
        let actions = self.spaces.iter().flat_map(|space| &space.actions);
        required
            .extend(actions.filter_map(|action| action.and_then(KeyAction::required_capability)));
    }

    /// Cancels the selection when the cursor is lost.
    pub(super) fn reset(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if let Some(selected) = self.selected {
            out.cancel(PressSource::Part(selected.target, 0), time);
            self.unselect(selected, time, out);
        }
        self.emit_pending_unselect(time, out);
        self.before.fill(None);
        self.is_armed = false;
    }

    /// Moves the cursor for one step; `None` if its position is unknown.
    pub(super) fn update(
        &mut self,
        cursor: Option<CursorPoint>,
        pose: &HandPose,
        out: &mut DeviceOutput,
    ) {
        let end = pose.time;
        let Some(cursor) = cursor else {
            self.reset(end, out);
            return;
        };
        let start = std::mem::replace(&mut self.time, end);
        self.emit_pending_unselect(end, out);
        if self.is_armed {
            self.sweep(cursor, pose, start, out)
        } else {
            self.is_armed = self.is_clear(cursor, pose)
        }
        for (space, before) in self.spaces.iter().zip(&mut self.before) {
            *before = cursor.in_space(space, pose);
        }
    }

    fn emit_pending_unselect(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if let Some(target) = self.pending_unselect
            && out.emit(time, EventKind::Unselect(target))
        {
            self.pending_unselect = None;
        }
    }

    /// Returns `true` if the cursor is outside all targets.
    fn is_clear(&self, cursor: CursorPoint, pose: &HandPose) -> bool {
        self.spaces.iter().all(|space| {
            let point = cursor.in_space(space, pose);
            point.is_none_or(|point| space.volumes.first_entry([point; 2], 0.0).is_none())
        })
    }

    /// Emits the selections along the segment from the last position to the current one.
    fn sweep(
        &mut self,
        cursor: CursorPoint,
        pose: &HandPose,
        start: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let end = pose.time;
        let mut t = 0.0;
        for _ in 0..MAX_ENTRIES {
            if let Some(selected) = self.selected {
                match self.exit(&selected, cursor, pose) {
                    Some(exit) => {
                        t = exit.max(t);
                        self.end_selection(selected, start.lerp(end, t), out);
                    }
                    None => break,
                }
            }
            if pose.is_after_gap {
                // The straight line leads through targets that the cursor did not enter.
                self.is_armed = self.is_clear(cursor, pose);
                return;
            }
            let Some((space, entry)) = self.first_entry(cursor, pose, t) else {
                return;
            };
            self.select(space, entry.index, start.lerp(end, entry.t), out);
        }
        self.select_nearest(cursor, pose, out);
        self.emit_depth(cursor, pose, out);
    }

    /// Returns the segment of the cursor in a space; `None` if an end is unknown.
    fn segment(&self, space: usize, cursor: CursorPoint, pose: &HandPose) -> Option<[Vec3; 2]> {
        let now = cursor.in_space(&self.spaces[space], pose)?;
        Some([self.before[space]?, now])
    }

    fn volume(&self, selected: &Selected) -> Option<&Volume> {
        self.spaces[selected.space].volumes.get(selected.volume)
    }

    /// Returns the fraction of the segment at which the cursor leaves the selected target, if it does.
    fn exit(&self, selected: &Selected, cursor: CursorPoint, pose: &HandPose) -> Option<f32> {
        let segment = self.segment(selected.space, cursor, pose);
        let inside = |path| {
            self.volume(selected)?
                .intersect_segment(path, TREMOR_MARGIN)
        };
        match segment.and_then(inside) {
            Some([_, exit]) if exit < 1.0 => Some(exit),
            Some(_) => None,
            None => Some(0.0),
        }
    }

    /// Returns the first target that the cursor enters after fraction `t` of its segment, and its space.
    fn first_entry(
        &self,
        cursor: CursorPoint,
        pose: &HandPose,
        t: f32,
    ) -> Option<(usize, VolumeEntry)> {
        self.first_of_all_spaces(|index, space| {
            space
                .volumes
                .first_entry(self.segment(index, cursor, pose)?, t)
        })
    }

    /// Returns the entry of all spaces that precedes the others, and the index of its space.
    fn first_of_all_spaces(
        &self,
        entry: impl Fn(usize, &SelectionSpace) -> Option<VolumeEntry>,
    ) -> Option<(usize, VolumeEntry)> {
        let mut first: Option<(usize, VolumeEntry)> = None;
        for (index, space) in self.spaces.iter().enumerate() {
            let Some(entry) = entry(index, space) else {
                continue;
            };
            if first.is_none_or(|(_, other)| entry.precedes(&other)) {
                first = Some((index, entry));
            }
        }
        first
    }

    fn select(&mut self, space: usize, volume: usize, time: Timestamp, out: &mut DeviceOutput) {
        let target = self.spaces[space].target(volume);
        if self.pending_unselect.is_some() || !out.emit(time, EventKind::Select(target)) {
            return;
        }
        self.selected = Some(Selected {
            space,
            volume,
            target,
            depth: 0.0,
        });
        let action = self.spaces[space].actions.get(volume).copied().flatten();
        if let Some(action) = action {
            // A press that does not fit into the event list is dropped.
            out.press(PressSource::Part(target, 0), action, time);
        }
    }

    fn end_selection(&mut self, selected: Selected, time: Timestamp, out: &mut DeviceOutput) {
        out.release(PressSource::Part(selected.target, 0), time);
        self.unselect(selected, time, out);
    }

    fn unselect(&mut self, selected: Selected, time: Timestamp, out: &mut DeviceOutput) {
        if selected.depth > 0.0 {
            out.emit(time, EventKind::Depth(selected.target, 0.0));
        }
        self.selected = None;
        self.pending_unselect = Some(selected.target);
        self.emit_pending_unselect(time, out);
    }

    /// Selects another target if its center is nearer by the margin.
    fn select_nearest(&mut self, cursor: CursorPoint, pose: &HandPose, out: &mut DeviceOutput) {
        let Some(selected) = self.selected else {
            return;
        };
        let nearest = self.first_of_all_spaces(|index, space| {
            let [_, now] = self.segment(index, cursor, pose)?;
            space.volumes.first_entry([now; 2], 0.0)
        });
        let segment = self.segment(selected.space, cursor, pose);
        let (Some((space, entry)), Some([_, now]), Some(volume)) =
            (nearest, segment, self.volume(&selected))
        else {
            return;
        };
        let is_other = (space, entry.index) != (selected.space, selected.volume);
        if is_other && entry.center_distance + TREMOR_MARGIN < now.distance(volume.center) {
            self.end_selection(selected, pose.time, out);
            self.select(space, entry.index, pose.time, out);
        }
    }

    fn emit_depth(&mut self, cursor: CursorPoint, pose: &HandPose, out: &mut DeviceOutput) {
        let Some(mut selected) = self.selected else {
            return;
        };
        let segment = self.segment(selected.space, cursor, pose);
        let (Some([_, now]), Some(volume)) = (segment, self.volume(&selected)) else {
            return;
        };
        let depth = (volume.depth(now) * DEPTH_STEPS).round() / DEPTH_STEPS;
        let event = EventKind::Depth(selected.target, depth);
        if depth != selected.depth && out.emit(pose.time, event) {
            selected.depth = depth;
            self.selected = Some(selected);
        }
    }
}
