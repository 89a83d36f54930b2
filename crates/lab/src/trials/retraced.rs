//! A recorded hand over a layout: the keys under its fingertips, presses, and near misses.

use std::collections::BTreeMap;

use parry3d::math::{Pose, Vec3};
use serde::Serialize;

use crate::contact::surface::{Shape, Surface, Target};
use crate::contact::{Press, TargetId};
use crate::device::Events;
use crate::hand::{Finger, Side};
use crate::kinematics::HandPose;
use crate::layout::Layout;
use crate::pipeline::StepOutput;
use crate::sim::UsTextField;
use crate::time::Timestamp;

/// The height of a pad above the front of a key below which its finger has approached it, in metres.
const NEAR: f32 = 0.004;
/// The height above which an approach is over, in metres.
const LEFT: f32 = 0.009;
/// The height below which a fingertip is over a board, in metres.
const OVER: f32 = 0.03;
/// The distance from another key within which a press is near it, in metres.
const BESIDE: f32 = 0.003;
/// The most near presses, near misses and keys of a path that are kept; all are counted.
const KEPT: usize = 10_000;

/// A press near another key.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NearPress {
    /// The time since the first reading, in seconds.
    pub seconds: f64,
    /// The key that was pressed.
    pub pressed: String,
    /// The nearest other key.
    pub other: String,
    /// The distance from it, in millimetres.
    pub distance_mm: f64,
}

/// An approach to a key that pressed nothing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NearMiss {
    /// The time since the first reading, in seconds.
    pub seconds: f64,
    /// The finger.
    pub finger: String,
    /// The key below it.
    pub key: String,
    /// The lowest height above its front, in millimetres; negative below the front and above the press point.
    pub height_mm: f64,
}

/// The path of the fingertips of one finger, of both hands, over the boards.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FingerPath {
    /// The length over boards, in millimetres.
    pub length_mm: f64,
    /// The keys that it passed, one after the other: the first 10 000.
    pub keys: Vec<String>,
    /// The number of keys that it passed.
    pub key_count: u64,
}

/// The presses of a recorded hand on a layout.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Retraced {
    /// Readings.
    pub readings: u64,
    /// Readings that the estimator rejected.
    pub rejected: u64,
    /// The time from the first to the last reading, in seconds.
    pub seconds: f64,
    /// Presses by key.
    pub presses: BTreeMap<String, u64>,
    /// Presses within 3 mm of another key: the first 10 000.
    pub near_presses: Vec<NearPress>,
    /// The number of presses within 3 mm of another key.
    pub near_press_count: u64,
    /// Approaches to within 4 mm that pressed nothing: the first 10 000.
    pub near_misses: Vec<NearMiss>,
    /// The number of approaches to within 4 mm that pressed nothing.
    pub near_miss_count: u64,
    /// The path of each finger that was over a board, by name.
    pub paths: BTreeMap<String, FingerPath>,
    /// The text that a text field would have received.
    pub text: String,
}

/// A finger near a key.
#[derive(Clone, Copy, Debug)]
struct Approach {
    target: TargetId,
    time: Timestamp,
    lowest: f32,
    has_pressed: bool,
}

/// A finger over a board.
#[derive(Clone, Copy, Debug, Default)]
struct FingerState {
    last: Option<Vec3>,
    key: Option<TargetId>,
    approach: Option<Approach>,
}

/// Watches a recorded hand over a layout.
pub struct Retracer<'a> {
    layout: &'a Layout,
    first: Option<Timestamp>,
    /// The fingers, by hand, finger and board.
    fingers: BTreeMap<(usize, usize, usize), FingerState>,
    field: UsTextField,
    found: Retraced,
}

impl<'a> Retracer<'a> {
    /// Watches over a layout.
    pub fn new(layout: &'a Layout) -> Self {
        Self {
            layout,
            first: None,
            fingers: BTreeMap::new(),
            field: UsTextField::new(),
            found: Retraced::default(),
        }
    }

    /// Notes a reading that was rejected.
    pub fn reject(&mut self) {
        self.found.readings += 1;
        self.found.rejected += 1;
    }

    /// Notes a step of a hand and its events.
    pub fn see(&mut self, time: Timestamp, side: Side, output: &StepOutput, events: &Events) {
        self.found.readings += 1;
        let first = *self.first.get_or_insert(time);
        let since = |moment: Timestamp| moment.since(first).as_secs_f64();
        self.found.seconds = since(time);
        for event in events {
            self.field.handle(event);
        }
        for (board, surface) in self.layout.scene.surfaces().iter().enumerate() {
            let is_own = surface.side().is_none_or(|own| own == side);
            let Some(world_from_surface) = surface.world_from_surface(&output.pose) else {
                continue;
            };
            if is_own {
                self.see_board(
                    (board, surface),
                    &world_from_surface,
                    &output.pose,
                    (time, since(time)),
                );
            }
        }
        for press in &output.presses {
            self.note_press(press, since(press.time));
        }
    }

    /// Returns what was found.
    pub fn finish(mut self) -> Retraced {
        self.found.text = self.field.text().to_owned();
        self.found
    }

    fn name(&self, target: TargetId) -> String {
        self.layout.target_names().get(target).to_string()
    }

    fn note_press(&mut self, press: &Press, seconds: f64) {
        let name = self.name(press.target);
        *self.found.presses.entry(name.clone()).or_default() += 1;
        for ((hand, finger, _), state) in &mut self.fingers {
            if (*hand, *finger) == (press.side.index(), press.finger.index())
                && let Some(approach) = &mut state.approach
            {
                approach.has_pressed = true;
            }
        }
        let other = press.neighbors.first();
        let other = other.filter(|other| other.distance <= BESIDE);
        let Some(other) = other else { return };
        self.found.near_press_count += 1;
        if self.found.near_presses.len() < KEPT {
            self.found.near_presses.push(NearPress {
                seconds,
                pressed: name,
                other: self.name(other.target),
                distance_mm: f64::from(other.distance) * 1e3,
            });
        }
    }

    fn see_board(
        &mut self,
        (board, surface): (usize, &Surface),
        world_from_surface: &Pose,
        pose: &HandPose,
        (time, seconds): (Timestamp, f64),
    ) {
        for &finger in Finger::ALL {
            let Some(tip) = pose.fingertip(finger) else {
                continue;
            };
            let tip = world_from_surface.inverse_transform_point(tip);
            let key = key_below(surface, tip);
            let place = (pose.side.index(), finger.index(), board);
            let mut state = self.fingers.get(&place).copied().unwrap_or_default();
            let below = key.map(|(id, target)| {
                let pad = target.surface_from_target.inverse_transform_point(tip);
                (id, pad.z - pose.tip_radius, target.travel)
            });
            match below.filter(|(_, height, _)| *height < OVER) {
                None => {
                    state.last = None;
                    state.key = None;
                }
                Some((id, ..)) => {
                    let path = self.found.paths.entry(finger.name().to_owned());
                    let path = path.or_default();
                    if let Some(last) = state.last.replace(tip) {
                        path.length_mm += f64::from((tip - last).truncate().length()) * 1e3;
                    }
                    if state.key.replace(id) != Some(id) {
                        path.key_count += 1;
                        if path.keys.len() < KEPT {
                            let name = self.layout.target_names().get(id).to_string();
                            path.keys.push(name);
                        }
                    }
                }
            }
            self.approach(&mut state, finger, below, (time, seconds));
            self.fingers.insert(place, state);
        }
    }

    /// Follows a finger that is near a key until it leaves.
    fn approach(
        &mut self,
        state: &mut FingerState,
        finger: Finger,
        below: Option<(TargetId, f32, f32)>,
        (time, seconds): (Timestamp, f64),
    ) {
        let height = below.map_or(f32::INFINITY, |(_, height, _)| height);
        match (&mut state.approach, below) {
            (None, Some((target, tip_height, _))) if tip_height < NEAR => {
                state.approach = Some(Approach {
                    target,
                    time,
                    lowest: tip_height,
                    has_pressed: false,
                });
            }
            (Some(approach), Some((target, tip_height, _))) if tip_height < approach.lowest => {
                (approach.target, approach.time, approach.lowest) = (target, time, tip_height);
            }
            (Some(approach), _) if height > LEFT => {
                let ended = *approach;
                state.approach = None;
                let is_deep = {
                    let target = self.layout.scene.target(ended.target);
                    target.is_some_and(|(_, target)| ended.lowest < -target.travel)
                };
                if ended.has_pressed || is_deep {
                    return;
                }
                self.found.near_miss_count += 1;
                if self.found.near_misses.len() < KEPT {
                    let ago = time.since(ended.time).as_secs_f64();
                    self.found.near_misses.push(NearMiss {
                        seconds: seconds - ago,
                        finger: finger.name().to_owned(),
                        key: self.name(ended.target),
                        height_mm: f64::from(ended.lowest) * 1e3,
                    });
                }
            }
            _ => {}
        }
    }
}

/// Returns the key whose outline is below a fingertip.
fn key_below(surface: &Surface, tip: Vec3) -> Option<(TargetId, &Target)> {
    let mut keys = surface.targets();
    keys.find(|(id, target)| {
        let at = target.surface_from_target.inverse_transform_point(tip);
        let at = at.truncate();
        surface.bent_by(*id).is_none()
            && match target.shape {
                Shape::Box(half) => at.abs().cmple(half).all(),
                Shape::Disc(radius) => at.length() <= radius,
            }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Neighbor;
    use crate::document::Document;

    #[test]
    fn near_presses_beyond_those_that_are_kept_are_counted() {
        let document = Document::shipped("numpad").expect("a shipped layout");
        let layout = Layout::from_document(document).expect("a layout");
        let mut retracer = Retracer::new(&layout);
        let press = |distance: f32| Press {
            time: Timestamp::default(),
            side: Side::Right,
            finger: Finger::Index,
            target: TargetId(0),
            point: Vec3::ZERO,
            depth: 0.0,
            speed: 0.0,
            neighbors: std::iter::once(Neighbor {
                target: TargetId(1),
                distance,
            })
            .collect(),
        };
        for _ in 0..KEPT + 5 {
            retracer.note_press(&press(BESIDE / 2.0), 0.0);
        }
        retracer.note_press(&press(BESIDE * 2.0), 0.0);
        let found = retracer.finish();
        assert_eq!(found.near_presses.len(), KEPT);
        assert_eq!(found.near_press_count, KEPT as u64 + 5);
        assert_eq!(found.presses.values().sum::<u64>(), KEPT as u64 + 6);
    }
}
