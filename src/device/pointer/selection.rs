//! Targets in space: one is selected while the cursor is in it.

use parry3d::math::Vec3;

use super::anchored_frame::AnchoredFrame;
use crate::contact::TargetId;
use crate::contact::surface::TREMOR_MARGIN;
use crate::contact::volume::{Volume, VolumeEntry, VolumeSet};
use crate::device::{Capabilities, DeviceOutput, EventKind, KeyAction, PressSource};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// The most targets that a cursor comes into in a frame; those after that are passed over.
const MOST_ENTRIES: usize = 4;

/// The steps in which a depth is told, so that a tremble is no news.
const STEPS: f32 = 100.0;

/// Targets in space that move as one.
#[derive(Clone, Debug)]
pub struct SelectionSpace {
    /// Where they are.
    pub frame: AnchoredFrame,
    /// The id of the first; the others follow.
    pub first_target: TargetId,
    /// What they look like.
    pub volumes: VolumeSet,
    /// What is pressed while each is selected; as many as there are volumes.
    pub actions: Vec<Option<KeyAction>>,
}

impl SelectionSpace {
    fn id(&self, place: usize) -> TargetId {
        TargetId(self.first_target.0 + place as u32)
    }
}

/// Where a cursor is, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum At {
    /// In the world.
    InTheWorld(Vec3),
    /// In the frame of every space.
    InEachSpace(Vec3),
}

impl At {
    fn seen_from(self, space: &SelectionSpace, pose: &HandPose) -> Option<Vec3> {
        match self {
            Self::InTheWorld(point) => space.frame.to_local(pose, point),
            Self::InEachSpace(point) => Some(point),
        }
    }
}

/// Follows a cursor through spaces.
///
/// The cursor moves in a straight line from frame to frame, so nothing is tunnelled through. A target is
/// selected from where the cursor comes into it until that is [`TREMBLE`] outside. Where targets overlap
/// the one whose middle is nearest is selected, another one only when it is nearer by as much. A cursor that
/// is in a target when it is first seen has to leave all targets before it selects any.
#[derive(Clone, Debug)]
pub(super) struct Selector {
    spaces: Vec<SelectionSpace>,
    /// Where the cursor was in each space.
    before: Vec<Option<Vec3>>,
    time: Timestamp,
    is_armed: bool,
    selected: Option<Selected>,
    /// Whose end found no room.
    owed: Option<TargetId>,
}

#[derive(Clone, Copy, Debug)]
struct Selected {
    space: usize,
    place: usize,
    target: TargetId,
    /// The depth that was told last.
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
            owed: None,
        }
    }

    pub(super) fn add_needs(&self, needs: &mut Capabilities) {
        let actions = self.spaces.iter().flat_map(|space| &space.actions);
        needs.extend(actions.filter_map(|action| action.and_then(KeyAction::required_capability)));
    }

    /// The cursor is not seen.
    pub(super) fn lose(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if let Some(selected) = self.selected {
            out.cancel(PressSource::Part(selected.target, 0), time);
            self.unselect(selected, time, out);
        }
        self.settle(time, out);
        self.before.fill(None);
        self.is_armed = false;
    }

    pub(super) fn follow(&mut self, at: Option<At>, pose: &HandPose, out: &mut DeviceOutput) {
        let end = pose.time;
        let Some(at) = at else {
            self.lose(end, out);
            return;
        };
        let start = std::mem::replace(&mut self.time, end);
        self.settle(end, out);
        match self.is_armed {
            true => self.pass(at, pose, start, out),
            false => self.is_armed = self.is_clear(at, pose),
        }
        for (space, before) in self.spaces.iter().zip(&mut self.before) {
            *before = at.seen_from(space, pose);
        }
    }

    /// Sends the end that found no room.
    fn settle(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if let Some(target) = self.owed
            && out.emit(time, EventKind::Unselect(target))
        {
            self.owed = None;
        }
    }

    fn is_clear(&self, at: At, pose: &HandPose) -> bool {
        self.spaces.iter().all(|space| {
            let point = at.seen_from(space, pose);
            point.is_none_or(|point| space.volumes.first_entry([point; 2], 0.0).is_none())
        })
    }

    fn pass(&mut self, at: At, pose: &HandPose, start: Timestamp, out: &mut DeviceOutput) {
        let end = pose.time;
        let mut since = 0.0;
        for _ in 0..MOST_ENTRIES {
            if let Some(selected) = self.selected {
                match self.leaves(&selected, at, pose) {
                    Some(share) => {
                        since = share.max(since);
                        self.end(selected, start.lerp(end, since), out);
                    }
                    None => break,
                }
            }
            let Some((space, entry)) = self.first(at, pose, since) else {
                return;
            };
            self.select(space, entry.index, start.lerp(end, entry.t), out);
        }
        self.prefer_the_nearest(at, pose, out);
        self.tell_depth(at, pose, out);
    }

    /// The way of the cursor in a space; `None` when that is not known.
    fn way(&self, space: usize, at: At, pose: &HandPose) -> Option<[Vec3; 2]> {
        let now = at.seen_from(&self.spaces[space], pose)?;
        Some([self.before[space]?, now])
    }

    fn volume(&self, selected: &Selected) -> Option<&Volume> {
        self.spaces[selected.space].volumes.get(selected.place)
    }

    /// The share of the way at which the cursor leaves what is selected.
    fn leaves(&self, selected: &Selected, at: At, pose: &HandPose) -> Option<f32> {
        let way = self.way(selected.space, at, pose);
        let within = |way| self.volume(selected)?.intersect_segment(way, TREMOR_MARGIN);
        match way.and_then(within) {
            Some([_, leaves]) if leaves < 1.0 => Some(leaves),
            Some(_) => None,
            None => Some(0.0),
        }
    }

    /// The first target on the way since a share of it.
    fn first(&self, at: At, pose: &HandPose, since: f32) -> Option<(usize, VolumeEntry)> {
        let mut first: Option<(usize, VolumeEntry)> = None;
        for (place, space) in self.spaces.iter().enumerate() {
            let way = self.way(place, at, pose);
            let Some(entry) = way.and_then(|way| space.volumes.first_entry(way, since)) else {
                continue;
            };
            if first.is_none_or(|(_, other)| entry.precedes(&other)) {
                first = Some((place, entry));
            }
        }
        first
    }

    fn select(&mut self, space: usize, place: usize, time: Timestamp, out: &mut DeviceOutput) {
        let target = self.spaces[space].id(place);
        if self.owed.is_some() || !out.emit(time, EventKind::Select(target)) {
            return;
        }
        self.selected = Some(Selected {
            space,
            place,
            target,
            depth: 0.0,
        });
        if let Some(action) = self.spaces[space].actions.get(place).copied().flatten() {
            // A press that finds no room is missed.
            out.press(PressSource::Part(target, 0), action, time);
        }
    }

    fn end(&mut self, selected: Selected, time: Timestamp, out: &mut DeviceOutput) {
        out.release(PressSource::Part(selected.target, 0), time);
        self.unselect(selected, time, out);
    }

    fn unselect(&mut self, selected: Selected, time: Timestamp, out: &mut DeviceOutput) {
        if selected.depth > 0.0 {
            out.emit(time, EventKind::Depth(selected.target, 0.0));
        }
        self.selected = None;
        self.owed = Some(selected.target);
        self.settle(time, out);
    }

    fn prefer_the_nearest(&mut self, at: At, pose: &HandPose, out: &mut DeviceOutput) {
        let Some(selected) = self.selected else {
            return;
        };
        let mut nearest: Option<(usize, VolumeEntry)> = None;
        for (place, space) in self.spaces.iter().enumerate() {
            let Some([_, now]) = self.way(place, at, pose) else {
                continue;
            };
            let Some(entry) = space.volumes.first_entry([now; 2], 0.0) else {
                continue;
            };
            if nearest.is_none_or(|(_, other)| entry.precedes(&other)) {
                nearest = Some((place, entry));
            }
        }
        let own = self.way(selected.space, at, pose);
        let (Some((space, entry)), Some([_, now]), Some(volume)) =
            (nearest, own, self.volume(&selected))
        else {
            return;
        };
        let is_other = (space, entry.index) != (selected.space, selected.place);
        if is_other && entry.center_distance + TREMOR_MARGIN < now.distance(volume.center) {
            self.end(selected, pose.time, out);
            self.select(space, entry.index, pose.time, out);
        }
    }

    fn tell_depth(&mut self, at: At, pose: &HandPose, out: &mut DeviceOutput) {
        let Some(mut selected) = self.selected else {
            return;
        };
        let (Some([_, now]), Some(volume)) =
            (self.way(selected.space, at, pose), self.volume(&selected))
        else {
            return;
        };
        let depth = (volume.depth(now) * STEPS).round() / STEPS;
        if depth != selected.depth && out.emit(pose.time, EventKind::Depth(selected.target, depth))
        {
            selected.depth = depth;
            self.selected = Some(selected);
        }
    }
}
