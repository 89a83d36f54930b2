//! Presses of a target: the choice of the finger, its path to the target, and the check that it presses only this target.

use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use super::watch::Watch;
use super::{CLEAR_TIME, HandState, MOVE_PACKETS, PRESS_PACKETS, Planner, PressedTip, TipState};
use crate::contact::TargetId;
use crate::contact::surface::Anchor;
use crate::hand::{Finger, FingerSet, Joint};
use crate::sim::action::TargetPoint;
use crate::sim::action_error::ActionErrorKind;
use crate::sim::assignment::FingerAssignment;
use crate::sim::effector::{Effector, Limb};
use crate::sim::movement::TipPath;
use crate::sim::reach::pressing_fingers;
use crate::sim::reach_target::ReachTarget;

/// Shortest time of a movement of the joints of one finger.
const FINGER_TIME: Duration = Duration::from_millis(150);

impl Planner<'_> {
    /// Checks that the fingertip was near enough to its path.
    pub(super) fn check_reach(
        &self,
        metres: f64,
        target: Option<TargetId>,
    ) -> Result<(), ActionErrorKind> {
        if metres > self.state.effector.limb.tolerance() {
            Err(ActionErrorKind::OutOfReach { target, metres })
        } else {
            Ok(())
        }
    }

    /// Returns the fingers that may press a target, best first.
    ///
    /// The finger that the layout names is the only one. Without it, a board that moves with the wrist is pressed by the nearest
    /// finger, and any other board by the fingers of the person or, if the person has no choice of fingers, by the index finger,
    /// then the thumb.
    pub(super) fn effectors(&self, target: TargetId) -> Vec<Effector> {
        let Some((surface, found)) = self.scene.target(target) else {
            return vec![Effector::INDEX];
        };
        if self.state.is_pinched || self.state.hand.is_stiff() {
            return vec![Effector::INDEX];
        }
        let used = self.state.motor.fingers;
        let named = self.scene.finger(target);
        let named = named.filter(|finger| used.is_empty() || used.contains(*finger));
        if surface.anchor() != Anchor::Joint(Joint::Wrist) {
            let arm = |finger| Effector {
                finger,
                limb: Limb::Arm,
            };
            let assignment = FingerAssignment {
                hand: &self.state.hand,
                fingers: used,
                keys: &self.state.motor.keys,
            };
            let fingers = match named {
                Some(finger) => vec![finger],
                None if used.is_empty() => vec![Finger::Index, Finger::Thumb],
                None => assignment.fingers_for(surface, target),
            };
            return fingers.into_iter().map(arm).collect();
        }
        let center = |pose| {
            let world_from_surface = surface.world_from_surface(pose)?;
            Some((world_from_surface * found.surface_from_target).translation)
        };
        let pose = self.state.hand.half_bent_pose();
        let goal: Vec3 = center(&pose).unwrap_or_default();
        let distance = |finger: &Finger| {
            let tip = pose.fingertip(*finger);
            tip.map_or(f32::INFINITY, |tip| tip.distance(goal))
        };
        let mut fingers = named.map_or(Finger::ALL.to_vec(), |finger| vec![finger]);
        fingers.retain(|finger| used.is_empty() || used.contains(*finger));
        fingers.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let limbs = [Limb::Finger, Limb::Hand];
        let all = limbs.into_iter().flat_map(|limb| {
            let fingers = fingers.iter();
            fingers.map(move |&finger| Effector { finger, limb })
        });
        all.collect()
    }

    /// Presses a point with the first finger that reaches it and presses nothing else. If none does, fails with the error of a
    /// finger that reached the point, or else of the one that came nearest.
    pub(super) fn press_by_any(
        &mut self,
        point: TargetPoint,
        height: impl Fn(&ReachTarget) -> f32,
    ) -> Result<(), ActionErrorKind> {
        self.lift();
        let (state, count) = (self.state.clone(), self.movements.len());
        let fingers = pressing_fingers(self.scene, point.target, state.motor.fingers);
        let mut best: Option<ActionErrorKind> = None;
        for effector in self.effectors(point.target) {
            match self.press_with(effector, point, &height) {
                Ok(()) => {
                    self.add_error_of_person(effector, point, &height, (&state, count));
                    return Ok(());
                }
                Err(error) => {
                    let is_counted = fingers.contains(effector.finger);
                    if best
                        .as_ref()
                        .is_none_or(|it| is_counted && is_nearer(&error, it))
                    {
                        best = Some(error);
                    }
                }
            }
            self.state = state.clone();
            self.movements.truncate(count);
        }
        let error = best.unwrap_or(ActionErrorKind::NotOnBoard);
        Err(self.with_distance_at_rest(error, point, fingers))
    }

    /// Replaces the distance in an `OutOfReach` error by the distance for a hand at rest: the warnings about a layout state the
    /// same distance.
    fn with_distance_at_rest(
        &self,
        error: ActionErrorKind,
        point: TargetPoint,
        fingers: FingerSet,
    ) -> ActionErrorKind {
        let hand = &self.state.hand;
        match error {
            ActionErrorKind::OutOfReach { target, metres }
                if !self.state.is_pinched && !hand.is_stiff() =>
            {
                let miss = hand.miss_of_fingers(self.scene, point.target, point.offset, fingers);
                let metres = miss.map_or(metres, |miss| miss.distance);
                ActionErrorKind::OutOfReach { target, metres }
            }
            other => other,
        }
    }

    /// Replaces the intended press by one with the error of the person. The intended press is the movements after the first
    /// `count`, which began in the state `before`. It stays if the finger cannot reach the point with the error.
    fn add_error_of_person(
        &mut self,
        effector: Effector,
        point: TargetPoint,
        height: &impl Fn(&ReachTarget) -> f32,
        (before, count): (&HandState, usize),
    ) {
        let Some((_, target)) = self.scene.target(point.target) else {
            return;
        };
        let error = self.state.motor.stroke_error(effector.finger, target);
        if error == Vec3::ZERO {
            return;
        }
        let Ok(reach_target) = self.reach_target(point.target) else {
            return;
        };
        let intended = (self.state.clone(), self.movements.split_off(count));
        self.state.clone_from(before);
        self.state.motor = intended.0.motor.clone();
        let missed = TargetPoint {
            offset: point.offset + error.truncate(),
            ..point
        };
        let depth = height(&reach_target) + error.z;
        let pressed = self
            .go_above(effector, missed, &reach_target)
            .and_then(|()| self.press_to(missed, reach_target, depth));
        if pressed.is_err() {
            // The point with the error is out of reach.
            self.state = intended.0;
            self.movements.truncate(count);
            self.movements.extend(intended.1);
        }
    }

    fn press_with(
        &mut self,
        effector: Effector,
        point: TargetPoint,
        height: &impl Fn(&ReachTarget) -> f32,
    ) -> Result<(), ActionErrorKind> {
        let target = self.reach_target(point.target)?;
        self.watch = Some(Watch::start(&self.state, self.scene));
        let height = height(&target);
        let pressed = self
            .go_above(effector, point, &target)
            .and_then(|()| self.press_to(point, target, height));
        let watch = self.watch.take();
        pressed?;
        let is_full = height <= target.bottom_height;
        match watch {
            Some(watch) => self.check_presses(&watch, point, is_full),
            None => Ok(()),
        }
    }

    /// Fails if the finger would press another target or none, or if another finger would press a target too. A point beside the
    /// center may be beside the target, and a finger that the actions have bent may press on purpose.
    fn check_presses(
        &self,
        watch: &Watch,
        point: TargetPoint,
        is_full: bool,
    ) -> Result<(), ActionErrorKind> {
        if self.state.hand.is_stiff() || self.state.is_pinched {
            return Ok(());
        }
        let own = self.state.effector.finger;
        let is_center = point.offset == Vec2::ZERO;
        let is_wrong = |finger: Finger, target: TargetId| {
            if finger == own {
                is_center && target != point.target
            } else {
                !self.state.posed.contains(finger)
            }
        };
        let mut presses = watch.presses();
        if let Some(wrong) = presses.find(|touch| is_wrong(touch.finger, touch.target)) {
            return Err(ActionErrorKind::WouldPress {
                finger: wrong.finger,
                target: wrong.target,
            });
        }
        let mut touches = watch.presses();
        let is_pressed = touches.any(|touch| touch.finger == own && touch.target == point.target);
        if is_pressed || !is_full || !is_center {
            Ok(())
        } else {
            Err(ActionErrorKind::WouldMiss(point.target))
        }
    }

    /// Moves a fingertip above a point. A person who types with several fingers changes the finger on the way: one that bends in its
    /// place may press what is below it.
    fn go_above(
        &mut self,
        effector: Effector,
        point: TargetPoint,
        target: &ReachTarget,
    ) -> Result<(), ActionErrorKind> {
        let state = &self.state;
        let is_change = effector != state.effector && !state.is_displaced;
        if !is_change || !state.changes_fingers_on_the_way(effector) {
            self.point_with(effector);
            return self.approach(point, target);
        }
        let values = state.values_above(effector, point, target);
        let changed = (0..values.len()).filter(|&index| values[index] != state.values[index]);
        let channel_targets = changed.map(|index| (index, values[index])).collect();
        self.state.effector = effector;
        let hover = target.tip_position(point, target.hover_height);
        let least = self.state.motor.paced(FINGER_TIME);
        let time = self.travel_time(hover).max(least);
        self.push_movement(channel_targets, None, time, MOVE_PACKETS);
        self.state.tip_state = TipState::Clear;
        Ok(())
    }

    /// Points with another fingertip. The fingers that do not point are extended, and a hand at a board that moves with the wrist
    /// does not move the elbow.
    pub(super) fn point_with(&mut self, effector: Effector) {
        if effector == self.state.effector {
            return;
        }
        self.state.effector = effector;
        let state = &self.state;
        let posture = state
            .hand
            .pointing_posture(effector, &state.rest, &state.values);
        let is_posed = |finger| state.posed.contains(finger);
        let free = posture.into_iter();
        let free = free.filter(|&(index, _)| !state.hand.finger_of(index).is_some_and(is_posed));
        let channel_targets: Vec<(usize, f64)> = free.collect();
        if !channel_targets.is_empty() {
            self.push_movement(channel_targets, None, self.turn_time(), MOVE_PACKETS);
        }
    }

    /// Moves a fingertip other than the index finger's to the end of a path, joint by joint: such a finger has few ways to a
    /// point. Returns the distance from the end in metres.
    pub(super) fn move_finger(&mut self, path: TipPath, time: Duration, min_packets: u32) -> f64 {
        let state = &self.state;
        let goal = path.end(self.tip());
        let mut values = state.values.clone();
        let hand = &state.hand;
        let distance = hand.reach_with(state.effector, goal, &mut values, &[]);
        let changed = (0..values.len()).filter(|&index| values[index] != state.values[index]);
        let channel_targets = changed.map(|index| (index, values[index])).collect();
        let time = time.max(state.motor.paced(FINGER_TIME));
        self.push_movement(channel_targets, None, time, min_packets);
        distance
    }

    /// Moves the fingertip above a point.
    fn approach(
        &mut self,
        point: TargetPoint,
        target: &ReachTarget,
    ) -> Result<(), ActionErrorKind> {
        let hover = target.tip_position(point, target.hover_height);
        // After the first movement the fingertip is above the first point of the actions.
        let is_there = self.starts_above
            && self.movements.len() == 1
            && self.state.effector == Effector::INDEX;
        if self.state.is_displaced {
            self.go_around(hover, target.world_from_target.rotation * Vec3::Z)?;
            // A pipeline that is not armed yet is armed here.
            self.wait(CLEAR_TIME);
        } else if !is_there {
            let time = self.travel_time(hover);
            self.move_tip(TipPath::To(hover), time, MOVE_PACKETS);
        }
        self.state.tip_state = TipState::Clear;
        Ok(())
    }

    fn press_to(
        &mut self,
        point: TargetPoint,
        target: ReachTarget,
        height: f32,
    ) -> Result<(), ActionErrorKind> {
        let (id, tip) = (point.target, target.tip_position(point, height));
        let distance = self.move_tip(TipPath::To(tip), self.press_time(), PRESS_PACKETS);
        self.mark_last(true);
        self.check_reach(distance, Some(id))?;
        self.state.tip_state = TipState::Pressed(PressedTip { id, target, tip });
        Ok(())
    }

    /// Marks the last movement as one that presses, up to its end or not.
    pub(super) fn mark_last(&mut self, ends_down: bool) {
        if let Some(movement) = self.movements.last_mut() {
            movement.is_down = true;
            movement.ends_down = ends_down;
        }
    }
}

/// Returns `true` if a finger with the error `one` comes nearer to its target than a finger with the error `other`.
fn is_nearer(one: &ActionErrorKind, other: &ActionErrorKind) -> bool {
    match (one, other) {
        (
            ActionErrorKind::OutOfReach { metres, .. },
            ActionErrorKind::OutOfReach { metres: others, .. },
        ) => metres < others,
        (_, ActionErrorKind::OutOfReach { .. }) => true,
        _ => false,
    }
}
