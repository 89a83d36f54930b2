//! Contact tracking: follows each fingertip from pose to pose.

use parry3d::math::{Vec2, Vec3};

use super::fingertip_positions::{FingertipPositions, Fingertips, trusted_fingertip};
use super::flexion::Flexion;
use super::hit_test::{self, Crossing};
use super::press::{self, Press, Presses};
use super::stroke::Stroke;
use super::surface::{Scene, Shape, Surface, Target};
use super::sweep::{self, Sweep};
use super::{Phase, TargetId, Touch, Touches};
use crate::hand::{Finger, FingerSet, Side};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// A tracker of the contacts between the five fingertips of one hand and the targets of one scene.
///
/// Between two poses each fingertip moves in a straight line at constant speed in the frame of each surface, so no
/// contact between poses is missed, and the times of touches are interpolated.
///
/// - A fingertip starts to touch a target only through its front. A fingertip that is inside a
///   target when it is first seen (new layout, [`reset`](Self::reset), jump, trusted again), or that has entered one
///   [in a gap](HandPose::is_after_gap), must leave and enter again. A gap presses a target only if the fingertip is
///   still on it, and no target by a stroke.
/// - It touches one target at most: the first that it enters, by its outline or its share of the gaps; on a tie, the one whose
///   outline is nearest, then the one whose center is. It stays on that target, however deep it goes.
/// - It leaves through the front (`Left`), or sideways by more than the target's margin
///   (`Cancelled`). After that it touches nothing until it has been in front of the target's plane,
///   or further beside the target than the target is wide.
/// - Several fingertips may touch one target; each has its own touches.
#[derive(Clone, Debug)]
pub struct ContactTracker {
    /// The hand of the last pose.
    side: Side,
    /// The times of the pose before the last one, and of the last one.
    span: [Timestamp; 2],
    /// The fingertip positions, for each surface of the scene.
    positions: Vec<FingertipPositions>,
    fingers: [FingerState; Finger::COUNT],
    /// `true` if strokes press any target.
    has_strokes: bool,
    flexion: Flexion,
}

/// Properties of a hand at a pose that a tracker needs beside the positions of its fingertips.
#[derive(Clone, Copy, Debug)]
pub struct PlacedHand {
    /// The side of the body.
    pub side: Side,
    /// The radius of the fingertip spheres, in metres.
    pub tip_radius: f32,
    /// The times of the last pose and of this one.
    pub span: [Timestamp; 2],
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FingerState {
    pub(super) contact: Option<Contact>,
    /// The target that the finger slid off, until it may touch again.
    slid_off: Option<TargetLocation>,
    /// The stroke that has not pressed yet.
    pub(super) stroke: Option<Stroke>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    pub(super) location: TargetLocation,
    pub(super) is_pressed: bool,
    /// The last reported depth, as a fraction of the travel.
    pub(super) depth: f32,
    /// The last reported position on the front, in metres.
    pub(super) position: Vec2,
}

/// The id of a target and the index of its surface, which saves the search for the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TargetLocation {
    pub(super) surface: usize,
    pub(super) target: TargetId,
}

impl ContactTracker {
    /// Creates a tracker for `scene`.
    pub fn new(scene: &Scene) -> Self {
        Self {
            side: Side::Right,
            span: [Timestamp::default(); 2],
            positions: vec![FingertipPositions::default(); scene.surfaces().len()],
            fingers: [FingerState::default(); Finger::COUNT],
            has_strokes: scene.surfaces().iter().any(Surface::has_struck_targets),
            flexion: Flexion::default(),
        }
    }

    /// Processes the next pose and appends the changes since the previous one to `touches`: at most 5 for each finger,
    /// in order of time for each finger. `scene` must have the surfaces and targets that the tracker was created for.
    /// Does not allocate.
    ///
    /// Touches are cancelled at the time of the pose if the finger is untrusted, not known or not finite in two consecutive poses or
    /// for more than 70 ms, if the anchor of the surface is not known, or if the hand jumped.
    pub fn update(&mut self, scene: &Scene, pose: &HandPose, touches: &mut Touches) {
        let tips = Fingertips::trusted(pose);
        let gap = pose.time.since(self.span[1]);
        for (positions, surface) in self.positions.iter_mut().zip(scene.surfaces()) {
            positions.push(&tips, surface, pose, gap);
        }
        if self.has_strokes {
            self.flexion.push(pose, gap);
        }
        let hand = PlacedHand {
            side: pose.side,
            tip_radius: pose.tip_radius,
            span: [self.span[1], pose.time],
        };
        let (fingers, mut step) = self.begin_step(scene, &hand, touches);
        step.may_enter = !pose.is_after_gap;
        for (state, &finger) in fingers.iter_mut().zip(Finger::ALL) {
            state.update(finger, &mut step);
            // A stroke that begins to wait in this step counts in the decisions about the fingers after it.
            let waiting = [step.first_waiting, state.waits_since()];
            step.first_waiting = waiting.into_iter().flatten().min();
        }
    }

    /// Updates one finger as [`update`](Self::update) does. The caller has computed its centers on each surface, in the last pose
    /// and in this one. A finger that follows another one, and noise, are not recognized as such. Returns `true` if a later update has
    /// no effect unless the fingertip enters a front.
    pub fn update_finger(
        &mut self,
        finger: Finger,
        scene: &Scene,
        hand: &PlacedHand,
        centers: impl Iterator<Item = [Vec3; 2]>,
        touches: &mut Touches,
    ) -> bool {
        for (positions, ends) in self.positions.iter_mut().zip(centers) {
            positions.set(finger, ends);
        }
        let (fingers, mut step) = self.begin_step(scene, hand, touches);
        let state = &mut fingers[finger.index()];
        state.update(finger, &mut step);
        state.contact.is_none() && state.slid_off.is_none() && state.stroke.is_none()
    }

    /// Returns the fingers that touch a target, or have entered one by a stroke.
    fn touching(&self) -> FingerSet {
        let fingers = self.fingers.iter().zip(Finger::ALL);
        let touching =
            fingers.filter(|(state, _)| state.contact.is_some() || state.stroke.is_some());
        touching.fold(FingerSet::NONE, |set, (_, &finger)| set.with(finger))
    }

    /// Begins a step. Returns the states of the fingers, to be updated, and the data that the fingers share.
    fn begin_step<'a>(
        &'a mut self,
        scene: &'a Scene,
        hand: &PlacedHand,
        touches: &'a mut Touches,
    ) -> (&'a mut [FingerState; Finger::COUNT], StepContext<'a>) {
        let [start, end] = hand.span;
        self.side = hand.side;
        self.span = hand.span;
        let step = StepContext {
            side: hand.side,
            scene,
            positions: &self.positions,
            radius: hand.tip_radius,
            start,
            end,
            may_enter: true,
            flexion: &self.flexion,
            touching: self.touching(),
            first_waiting: self
                .fingers
                .iter()
                .filter_map(FingerState::waits_since)
                .min(),
            touches,
        };
        (&mut self.fingers, step)
    }

    /// Cancels every touch at `time`, appends the cancellations to `touches`, and forgets the last pose.
    pub fn reset(&mut self, time: Timestamp, touches: &mut Touches) {
        for (state, &finger) in self.fingers.iter_mut().zip(Finger::ALL) {
            if let Some(contact) = state.contact {
                push(
                    touches,
                    time,
                    (self.side, finger),
                    Phase::Cancelled,
                    &contact,
                );
            }
        }
        self.fingers = [FingerState::default(); Finger::COUNT];
        self.positions.fill(FingertipPositions::default());
        self.flexion = Flexion::default();
        self.span = [time; 2];
    }

    /// Appends the presses among the touches of the last update to `presses`, with their evidence. Does not allocate.
    pub fn add_presses(&self, scene: &Scene, touches: &[Touch], presses: &mut Presses) {
        let [start, end] = self.span;
        let seconds = end.since(start).as_secs_f64();
        for touch in touches.iter().filter(|touch| touch.phase == Phase::Pressed) {
            let Some((index, surface, target)) = press::locate(scene, touch.target) else {
                continue;
            };
            let positions = self.positions.get(index);
            let centers = positions.and_then(|positions| positions.centers(touch.finger));
            if let Some(centers) = centers.filter(|_| !presses.is_full()) {
                presses.push(Press::new(touch, (surface, target), centers, seconds));
            }
        }
    }

    /// Returns `true` if no fingertip touches a target.
    pub fn is_idle(&self) -> bool {
        self.fingers.iter().all(|state| state.contact.is_none())
    }

    /// Iterates over the targets that fingertips press.
    pub fn pressed(&self) -> impl Iterator<Item = TargetId> + '_ {
        let contacts = self.fingers.iter().filter_map(|state| state.contact);
        let pressed = contacts.filter(|contact| contact.is_pressed);
        pressed.map(|contact| contact.location.target)
    }

    /// Returns `true` if the hand is clear of all targets: no fingertip touches one, no trusted fingertip
    /// is behind a front (inside its outline, at most 0.1 m deep), and at least one trusted fingertip is
    /// known. A surface that waits for its place has no targets yet, and surfaces of the other hand have none for this one. Does
    /// not allocate.
    pub fn is_clear(&self, scene: &Scene, pose: &HandPose) -> bool {
        if !self.is_idle() {
            return false;
        }
        let is_trusted = |&finger: &Finger| trusted_fingertip(pose, finger).is_some();
        // A hand without surfaces has no anchor that must be known.
        let is_of_other = |surface: &Surface| surface.side().is_some_and(|side| side != pose.side);
        let mut is_seen =
            scene.surfaces().iter().all(is_of_other) && Finger::ALL.iter().any(is_trusted);
        for surface in scene.surfaces() {
            let Some(world_from_surface) = surface.world_from_surface(pose) else {
                is_seen |= surface.waits_for_place(pose) && Finger::ALL.iter().any(is_trusted);
                continue;
            };
            for &finger in Finger::ALL {
                let Some(center) = trusted_fingertip(pose, finger) else {
                    continue;
                };
                let center = world_from_surface.inverse_transform_point(center);
                if hit_test::is_inside_any_target(surface, center, pose.tip_radius) {
                    return false;
                }
                is_seen = true;
            }
        }
        is_seen
    }
}

fn push(
    touches: &mut Touches,
    time: Timestamp,
    (side, finger): (Side, Finger),
    phase: Phase,
    contact: &Contact,
) {
    // There is room for 6 per finger, and a finger has 5 at most: released, left, touched, pressed,
    // and moved or cancelled.
    let _ = touches.try_push(Touch {
        time,
        side,
        finger,
        target: contact.location.target,
        phase,
        depth: match phase {
            Phase::Left | Phase::Cancelled => 0.0,
            _ => contact.depth,
        },
        position: contact.position,
    });
}

/// The data of one step that the fingers share.
pub(super) struct StepContext<'a> {
    side: Side,
    pub(super) scene: &'a Scene,
    pub(super) positions: &'a [FingertipPositions],
    radius: f32,
    pub(super) start: Timestamp,
    pub(super) end: Timestamp,
    /// `false` if the path of the fingertips is not known.
    pub(super) may_enter: bool,
    pub(super) flexion: &'a Flexion,
    /// The fingers that touch a target, or have entered one by a stroke, at the beginning of the step.
    pub(super) touching: FingerSet,
    /// The time at which the first of the strokes that wait for their turn passed the press depth.
    pub(super) first_waiting: Option<Timestamp>,
    touches: &'a mut Touches,
}

/// The entry of a finger through the front of a target.
struct Entry<'a> {
    location: TargetLocation,
    target: &'a Target,
    crossing: Crossing,
}

impl<'a> StepContext<'a> {
    /// Returns the previous and current center of a fingertip on a surface, if both are known.
    fn centers(&self, surface: usize, finger: Finger) -> Option<[Vec3; 2]> {
        self.positions.get(surface)?.centers(finger)
    }

    /// Returns a target and the sweep of a finger's pad over it, if both centers are known.
    pub(super) fn sweep(
        &self,
        location: TargetLocation,
        finger: Finger,
    ) -> Option<(&'a Target, Sweep)> {
        let centers = self.centers(location.surface, finger)?;
        let target = self
            .scene
            .surfaces()
            .get(location.surface)?
            .target(location.target)?;
        Some((target, Sweep::from_centers(target, centers, self.radius)))
    }

    /// Returns the first front that a finger enters at or after `since`, and the entry.
    fn first_crossing(&self, finger: Finger, since: f32) -> Option<Entry<'a>> {
        let mut first: Option<(TargetLocation, Crossing)> = None;
        for (index, surface) in self.scene.surfaces().iter().enumerate() {
            let Some(centers) = self.centers(index, finger) else {
                continue;
            };
            let crossing = hit_test::first_crossing(surface, centers, self.radius, since);
            let Some(crossing) = crossing else { continue };
            if first.is_none_or(|(_, other)| crossing.precedes(&other)) {
                let location = TargetLocation {
                    surface: index,
                    target: surface.target_id(crossing.index),
                };
                first = Some((location, crossing));
            }
        }
        let (location, crossing) = first?;
        let surface = self.scene.surfaces().get(location.surface)?;
        Some(Entry {
            location,
            target: surface.target(location.target)?,
            crossing,
        })
    }

    pub(super) fn emit(&mut self, t: f32, finger: Finger, phase: Phase, contact: &Contact) {
        let time = self.start.lerp(self.end, t);
        push(self.touches, time, (self.side, finger), phase, contact);
    }
}

impl FingerState {
    fn update(&mut self, finger: Finger, step: &mut StepContext) {
        let mut since = 0.0;
        if let Some(contact) = self.contact {
            match self.follow(contact, finger, since, step) {
                Some(t) => since = t,
                None => return,
            }
        }
        if let Some(stroke) = self.stroke.take() {
            match self.strike(stroke, finger, since, step) {
                Some(t) => since = t,
                None => return,
            }
        }
        if self.is_locked_out(finger, step) || !step.may_enter {
            return;
        }
        let Some(entry) = step.first_crossing(finger, since) else {
            return;
        };
        let Crossing { t, sweep, .. } = entry.crossing;
        if step.is_struck(entry.location, entry.crossing.index, finger) {
            let stroke = Stroke::new(entry.location, sweep.from, sweep.point_at(t));
            self.strike(stroke, finger, t, step);
            return;
        }
        let contact = Contact {
            location: entry.location,
            is_pressed: false,
            depth: 0.0,
            position: sweep.point_at(t).truncate(),
        };
        step.emit(t, finger, Phase::Touched, &contact);
        self.follow_over(entry.target, &sweep, contact, (finger, t), step);
    }

    /// Follows a contact from `since` to the end of the step, or to its own end, whose `t` is returned.
    fn follow(
        &mut self,
        contact: Contact,
        finger: Finger,
        since: f32,
        step: &mut StepContext,
    ) -> Option<f32> {
        let Some((target, sweep)) = step.sweep(contact.location, finger) else {
            self.contact = None;
            step.emit(1.0, finger, Phase::Cancelled, &contact);
            return Some(1.0);
        };
        self.follow_over(target, &sweep, contact, (finger, since), step)
    }

    /// Follows a contact as [`follow`](Self::follow) does, with the sweep of the finger over the target.
    fn follow_over(
        &mut self,
        target: &Target,
        sweep: &Sweep,
        mut contact: Contact,
        (finger, since): (Finger, f32),
        step: &mut StepContext,
    ) -> Option<f32> {
        self.contact = None;
        let side_exit = sweep
            .t_at_side_exit(target.shape, target.share, target.margin)
            .map(|t| t.max(since));
        let (crossing, phase, level) = if contact.is_pressed {
            let depth = target.release_at * target.travel;
            let crossing = sweep.t_at_depth_outward(depth);
            (crossing, Phase::Released, target.release_at)
        } else {
            let depth = target.press_at * target.travel;
            let crossing = sweep.t_at_depth_inward(depth);
            (crossing, Phase::Pressed, target.press_at)
        };
        // On a tie the side exit wins, so that nothing fires.
        let is_before_side_exit = |t: f32| side_exit.is_none_or(|exit| t < exit);
        if let Some(t) = crossing.map(|t| t.max(since))
            && is_before_side_exit(t)
            // After a gap, a straight line to another target may press this one on the way.
            && (contact.is_pressed || step.may_enter || side_exit.is_none())
            && (contact.is_pressed || step.stands_out(contact.location, target, finger))
        {
            contact.is_pressed = phase == Phase::Pressed;
            contact.depth = level;
            contact.position = sweep.point_at(t).truncate();
            step.emit(t, finger, phase, &contact);
        }
        let front_exit = sweep.t_at_depth_outward(0.0).map(|t| t.max(since));
        if let Some(t) = front_exit.filter(|&t| is_before_side_exit(t)) {
            contact.position = sweep.point_at(t).truncate();
            step.emit(t, finger, Phase::Left, &contact);
            return Some(t);
        }
        if let Some(t) = side_exit {
            contact.position = sweep.point_at(t).truncate();
            step.emit(t, finger, Phase::Cancelled, &contact);
            self.slid_off = Some(contact.location);
            return Some(t);
        }
        let depth = (-sweep.to.z / target.travel).clamp(0.0, 1.0);
        let position = sweep.to.truncate();
        if depth != contact.depth || position != contact.position {
            contact.depth = depth;
            contact.position = position;
            step.emit(1.0, finger, Phase::Moved, &contact);
        }
        self.contact = Some(contact);
        None
    }

    /// Returns `true` if the finger slid off a target and has not yet left its neighborhood.
    fn is_locked_out(&mut self, finger: Finger, step: &StepContext) -> bool {
        let Some(location) = self.slid_off else {
            return false;
        };
        let is_free = step.sweep(location, finger).is_none_or(|(target, sweep)| {
            sweep.from.z >= 0.0 || is_well_beside(target, sweep.from)
        });
        if is_free {
            self.slid_off = None;
        }
        !is_free
    }
}

/// Returns `true` if a pad is further from the edge of a target than the target is wide, so that it cannot have just slid
/// off. Without this test, a board that bends away from the hand locks a
/// finger out behind the plane of a target that it left long ago.
fn is_well_beside(target: &Target, pad: Vec3) -> bool {
    let width = match target.shape {
        Shape::Box(half) => 2.0 * half.max_element(),
        Shape::Disc(radius) => 2.0 * radius,
    };
    !sweep::is_inside(target.shape, pad.truncate(), width)
}
