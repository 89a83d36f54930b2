//! The decisions about a stroke in each step of the tracker.

use parry3d::math::Vec3;

use super::Phase;
use super::hit_test;
use super::stroke::{self, Stroke};
use super::surface::Target;
use super::sweep::Sweep;
use super::tracker::{Contact, FingerState, StepContext, TargetLocation};
use crate::hand::Finger;
use crate::time::Timestamp;

/// Half the height of the line along which a point is looked up on a board, in metres.
const LOOKUP: f32 = 1e-3;

impl StepContext<'_> {
    /// Returns `true` if a finger presses the target of an entry by strokes.
    pub(super) fn is_struck(&self, location: TargetLocation, index: u32, finger: Finger) -> bool {
        let surface = self.scene.surfaces().get(location.surface);
        surface.is_some_and(|surface| surface.is_struck(index, finger))
    }

    /// Returns the target that a finger strikes below a point of another target (its frame, metres), and the point in the frame of
    /// that target.
    fn target_at(
        &self,
        finger: Finger,
        (location, target): (TargetLocation, &Target),
        point: Vec3,
    ) -> Option<(TargetLocation, &Target, Vec3)> {
        let surface = self.scene.surfaces().get(location.surface)?;
        let on_front = point.truncate().extend(0.0);
        let ends = [on_front + Vec3::Z * LOOKUP, on_front - Vec3::Z * LOOKUP];
        let ends = ends.map(|end| target.surface_from_target * end);
        let found = hit_test::first_crossing(surface, ends, 0.0, 0.0)?;
        let id = surface.target_id(found.index);
        let other = surface
            .target(id)
            .filter(|_| surface.is_struck(found.index, finger))?;
        let on_surface = target.surface_from_target * point;
        let at = other
            .surface_from_target
            .inverse_transform_point(on_surface);
        let surface_index = location.surface;
        Some((
            TargetLocation {
                surface: surface_index,
                target: id,
            },
            other,
            at,
        ))
    }
}

impl FingerState {
    /// Returns the time at which a stroke that still waits for its turn passed the press depth.
    pub(super) fn waits_since(&self) -> Option<Timestamp> {
        self.stroke.filter(|it| !it.is_spent)?.passed
    }

    /// Follows a stroke from `since` to the end of the step, or to its own end, whose `t` is returned.
    pub(super) fn strike(
        &mut self,
        mut stroke: Stroke,
        finger: Finger,
        since: f32,
        step: &mut StepContext,
    ) -> Option<f32> {
        // Without the fingertip or the board there is no stroke.
        let (target, sweep) = step.sweep(stroke.location, finger)?;
        let seconds = step.end.since(step.start).as_secs_f32();
        stroke.push([sweep.from, sweep.to], seconds);
        // The path of the fingertip in a gap is not known.
        stroke.is_spent |= !step.may_enter;
        let exit = sweep.t_at_depth_outward(0.0).map(|t| t.max(since));
        let press_depth = target.press_at * target.travel;
        let is_deep = stroke.depth() >= press_depth;
        if stroke.passed.is_none() && is_deep && step.stands_out(stroke.location, target, finger) {
            let t = sweep.t_at_depth_inward(press_depth).unwrap_or(since);
            stroke.passed = Some(step.start.lerp(step.end, t.max(since)));
        }
        if let Some(passed) = stroke.passed.filter(|_| !stroke.is_spent) {
            match decide(&stroke, target, &sweep, (finger, exit.is_some()), step) {
                Decision::Press(location, at) => {
                    return self.press(location, at, (finger, since, passed), exit, step);
                }
                Decision::Wait => {}
                Decision::Never => stroke.is_spent = true,
            }
        }
        if exit.is_none() {
            self.stroke = Some(stroke);
        }
        exit
    }

    /// Presses a target, and leaves it if the fingertip is above the front at the end of the step.
    fn press(
        &mut self,
        location: TargetLocation,
        at: Vec3,
        (finger, since, passed): (Finger, f32, Timestamp),
        exit: Option<f32>,
        step: &mut StepContext,
    ) -> Option<f32> {
        let scene = step.scene;
        let surface = scene.surfaces().get(location.surface)?;
        let target = surface.target(location.target)?;
        // A press that was decided late is not older than what came before it.
        let span = step.end.since(step.start).as_secs_f32();
        let t = if span > 0.0 && passed > step.start {
            (passed.since(step.start).as_secs_f32() / span).max(since)
        } else {
            since
        };
        let mut contact = Contact {
            location,
            is_pressed: false,
            depth: 0.0,
            position: at.truncate(),
        };
        step.emit(t, finger, Phase::Touched, &contact);
        contact.is_pressed = true;
        contact.depth = (-at.z / target.travel).clamp(target.press_at, 1.0);
        step.emit(t, finger, Phase::Pressed, &contact);
        if let Some(exit) = exit {
            let exit = exit.max(t);
            contact.is_pressed = false;
            contact.depth = target.release_at;
            step.emit(exit, finger, Phase::Released, &contact);
            step.emit(exit, finger, Phase::Left, &contact);
            return Some(exit);
        }
        self.contact = Some(contact);
        None
    }
}

/// The decision about a stroke behind the press depth.
enum Decision {
    /// The stroke presses a target, at a point in the frame of that target.
    Press(TargetLocation, Vec3),
    /// The target is not known yet.
    Wait,
    /// Ignore the fingertip until it is above the front again.
    Never,
}

fn decide(
    stroke: &Stroke,
    target: &Target,
    sweep: &Sweep,
    (finger, is_over): (Finger, bool),
    step: &StepContext,
) -> Decision {
    let at = sweep.to;
    let entered = (stroke.location, target);
    let has_turned = is_over || stroke.has_turned(finger, at, step.end);
    if !stroke.is_fast() {
        return Decision::Wait;
    }
    if step.flexion.follows(finger, step.touching) {
        return if has_turned {
            Decision::Never
        } else {
            Decision::Wait
        };
    }
    if has_turned && stroke.is_pass(finger) {
        return Decision::Never;
    }
    if has_turned {
        let intended = stroke.intended(finger, at);
        let found = step.target_at(finger, entered, intended);
        let (location, _, place) = found.unwrap_or((stroke.location, target, intended));
        return Decision::Press(location, place);
    }
    let now = step.target_at(finger, entered, at);
    let end = step.target_at(finger, entered, stroke.extrapolated_end(at, target));
    let Some(((location, below, now), (end_location, _, end))) = now.zip(end) else {
        return Decision::Wait;
    };
    let is_first = step
        .first_waiting
        .is_none_or(|first| stroke.passed <= Some(first));
    let is_clear = |point: Vec3| stroke::is_clear_of_edge(below, point.truncate());
    // The arc of a thumb ends on another key than a straight line does.
    let is_straight = finger != Finger::Thumb;
    if is_straight
        && is_first
        && !stroke.is_pass(finger)
        && location == end_location
        && is_clear(now)
        && is_clear(end)
    {
        Decision::Press(location, now)
    } else {
        Decision::Wait
    }
}
