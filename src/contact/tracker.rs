//! What each fingertip does on which target, followed from frame to frame.

use parry3d::math::{Vec2, Vec3};

use super::hit_test::{self, Crossing};
use super::surface::{Scene, Shape, Target};
use super::sweep::{self, Stroke};
use super::{Phase, TargetId, Touch, Touches};
use crate::hand::{Finger, Side};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// Follows the five fingertips of one hand over the targets of one scene.
///
/// Between two frames each fingertip is taken to move in a straight line at constant speed in the
/// frame of each surface, so nothing is missed between frames and events carry times between them.
///
/// - A fingertip begins to touch a target only through its front. A fingertip that is inside a
///   target when it is first seen (new layout, [`reset`](Self::reset), a jump, trusted again) has
///   to come out and in again.
/// - It is on one target at most: the first that it comes in through, on a tie the one whose middle
///   is nearest. It stays latched to that target, however deep it goes.
/// - It goes out through the front (`Left`), or sideways by more than the target's margin
///   (`Cancelled`). After that it touches nothing until it has been in front of the target's plane
///   again, or further beside the target than the target is wide.
/// - Two fingertips may be on one target; each has its own touches.
#[derive(Clone, Debug)]
pub struct ContactTracker {
    /// The hand that was followed last.
    side: Side,
    time: Timestamp,
    /// One for each surface of the scene.
    tracks: Vec<Track>,
    fingers: [FingerState; Finger::COUNT],
}

/// Where the fingertips are in the frame of one surface; `None` where that is not known.
#[derive(Clone, Copy, Debug, Default)]
struct Track {
    before: [Option<Vec3>; Finger::COUNT],
    now: [Option<Vec3>; Finger::COUNT],
}

#[derive(Clone, Copy, Debug, Default)]
struct FingerState {
    contact: Option<Contact>,
    /// The target that the finger slid off, until it may touch again.
    slid_off: Option<Place>,
}

#[derive(Clone, Copy, Debug)]
struct Contact {
    place: Place,
    is_pressed: bool,
    /// The share of the travel that was told last.
    depth: f32,
    /// The place on the front that was told last, in metres.
    at: Vec2,
}

/// A target and the number of its surface, which spares the search for it.
#[derive(Clone, Copy, Debug)]
struct Place {
    surface: usize,
    target: TargetId,
}

impl ContactTracker {
    /// A tracker for `scene` that has not seen the hand yet.
    pub fn new(scene: &Scene) -> Self {
        Self {
            side: Side::Right,
            time: Timestamp::default(),
            tracks: vec![Track::default(); scene.surfaces().len()],
            fingers: [FingerState::default(); Finger::COUNT],
        }
    }

    /// Takes the next pose and appends what the fingertips did since the one before to `touches`,
    /// at most 5 for each finger, in order of time for each finger. `scene` is the one that the
    /// tracker was made for. Does not allocate.
    ///
    /// A finger that is untrusted, not known or not finite, a surface whose anchor is not known,
    /// and a jump of the hand cancel the touches concerned at the time of the pose.
    pub fn update(&mut self, scene: &Scene, pose: &HandPose, touches: &mut Touches) {
        self.locate(scene, pose);
        self.side = pose.side;
        let mut step = Step {
            side: pose.side,
            scene,
            tracks: &self.tracks,
            radius: pose.tip_radius,
            start: self.time,
            end: pose.time,
            touches,
        };
        for (state, &finger) in self.fingers.iter_mut().zip(Finger::ALL) {
            state.advance(finger, &mut step);
        }
        self.time = pose.time;
    }

    /// Cancels every touch at `time`, appends that to `touches`, and forgets where the hand was.
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
        self.tracks.fill(Track::default());
        self.time = time;
    }

    /// Whether no fingertip touches anything.
    pub fn is_idle(&self) -> bool {
        self.fingers.iter().all(|state| state.contact.is_none())
    }

    /// Whether the hand is seen off all targets: no fingertip touches one, none that can be
    /// believed is behind a front (inside its outline, at most 0.1 m deep), and at least one is
    /// seen. Does not allocate.
    pub fn is_clear(&self, scene: &Scene, pose: &HandPose) -> bool {
        if !self.is_idle() {
            return false;
        }
        let believed = |&finger: &Finger| trusted_fingertip(pose, finger).is_some();
        // Where there is nothing to touch, no surface has to be known.
        let mut is_seen = scene.surfaces().is_empty() && Finger::ALL.iter().any(believed);
        for surface in scene.surfaces() {
            let Some(world_from_surface) = surface.world_from_surface(pose) else {
                continue;
            };
            for &finger in Finger::ALL {
                let Some(centre) = trusted_fingertip(pose, finger) else {
                    continue;
                };
                let centre = world_from_surface.inverse_transform_point(centre);
                if hit_test::is_in_a_target(surface, centre, pose.tip_radius) {
                    return false;
                }
                is_seen = true;
            }
        }
        is_seen
    }

    fn locate(&mut self, scene: &Scene, pose: &HandPose) {
        for (track, surface) in self.tracks.iter_mut().zip(scene.surfaces()) {
            track.before = if pose.jumped {
                Default::default()
            } else {
                track.now
            };
            track.now = Default::default();
            let Some(world_from_surface) = surface.world_from_surface(pose) else {
                continue;
            };
            let surface_from_world = world_from_surface.inverse();
            for (now, &finger) in track.now.iter_mut().zip(Finger::ALL) {
                *now = trusted_fingertip(pose, finger)
                    .map(|centre| surface_from_world.transform_point(centre))
                    .filter(|centre| centre.is_finite());
            }
        }
    }
}

/// The centre of a fingertip that a press can come from (world, metres); `None` where it is not known,
/// not finite or not to be trusted.
pub fn trusted_fingertip(pose: &HandPose, finger: Finger) -> Option<Vec3> {
    if pose.untrusted.contains(finger) || !pose.tip_radius.is_finite() {
        return None;
    }
    pose.fingertip(finger).filter(|centre| centre.is_finite())
}

fn push(
    touches: &mut Touches,
    time: Timestamp,
    (side, finger): (Side, Finger),
    phase: Phase,
    contact: &Contact,
) {
    // There is room for 6 a finger, and a finger has 5 at most: released, left, touched, pressed,
    // and held or cancelled.
    let _ = touches.try_push(Touch {
        time,
        side,
        finger,
        target: contact.place.target,
        phase,
        depth: match phase {
            Phase::Left | Phase::Cancelled => 0.0,
            _ => contact.depth,
        },
        position: contact.at,
    });
}

/// What the fingers need to know about one frame.
struct Step<'a> {
    side: Side,
    scene: &'a Scene,
    tracks: &'a [Track],
    radius: f32,
    start: Timestamp,
    end: Timestamp,
    touches: &'a mut Touches,
}

impl<'a> Step<'a> {
    /// Where a finger's centre was and is on a surface, if both are known.
    fn centres(&self, surface: usize, finger: Finger) -> Option<[Vec3; 2]> {
        let track = self.tracks.get(surface)?;
        Some([track.before[finger.index()]?, track.now[finger.index()]?])
    }

    /// A target and how a finger's pad moved over it, if both are known.
    fn stroke(&self, place: Place, finger: Finger) -> Option<(&'a Target, Stroke)> {
        let centres = self.centres(place.surface, finger)?;
        let target = self
            .scene
            .surfaces()
            .get(place.surface)?
            .target(place.target)?;
        Some((target, Stroke::of(target, centres, self.radius)))
    }

    /// The first front that a finger comes in through at or after the share `since`.
    fn first_crossing(&self, finger: Finger, since: f32) -> Option<(Place, f32)> {
        let mut first: Option<(Place, Crossing)> = None;
        for (number, surface) in self.scene.surfaces().iter().enumerate() {
            let Some(centres) = self.centres(number, finger) else {
                continue;
            };
            let crossing = hit_test::first_crossing(surface, centres, self.radius, since);
            let Some(crossing) = crossing else { continue };
            if first.is_none_or(|(_, other)| crossing.beats(&other)) {
                let place = Place {
                    surface: number,
                    target: surface.target_id(crossing.place),
                };
                first = Some((place, crossing));
            }
        }
        first.map(|(place, crossing)| (place, crossing.share))
    }

    fn tell(&mut self, share: f32, finger: Finger, phase: Phase, contact: &Contact) {
        let time = self.start.lerp(self.end, share);
        push(self.touches, time, (self.side, finger), phase, contact);
    }
}

impl FingerState {
    fn advance(&mut self, finger: Finger, step: &mut Step) {
        let mut since = 0.0;
        if let Some(contact) = self.contact {
            match self.follow(contact, finger, since, step) {
                Some(share) => since = share,
                None => return,
            }
        }
        if self.may_not_touch(finger, step) {
            return;
        }
        let Some((place, share)) = step.first_crossing(finger, since) else {
            return;
        };
        let Some((_, sweep)) = step.stroke(place, finger) else {
            return;
        };
        let contact = Contact {
            place,
            is_pressed: false,
            depth: 0.0,
            at: sweep.at(share).truncate(),
        };
        step.tell(share, finger, Phase::Touched, &contact);
        self.follow(contact, finger, share, step);
    }

    /// Follows a contact from the share `since` to the end of the frame, or to the share at which
    /// it ends, which it returns.
    fn follow(
        &mut self,
        mut contact: Contact,
        finger: Finger,
        since: f32,
        step: &mut Step,
    ) -> Option<f32> {
        let place = contact.place;
        self.contact = None;
        let Some((target, sweep)) = step.stroke(place, finger) else {
            step.tell(1.0, finger, Phase::Cancelled, &contact);
            return Some(1.0);
        };
        let slides_off = sweep
            .leaves_sideways(target.shape, target.margin)
            .map(|share| share.max(since));
        let (turn, phase, level) = if contact.is_pressed {
            let depth = target.release_at * target.travel;
            (sweep.rises_to(depth), Phase::Released, target.release_at)
        } else {
            let depth = target.press_at * target.travel;
            (sweep.sinks_to(depth), Phase::Pressed, target.press_at)
        };
        // On a tie sliding off wins, so that nothing fires.
        let is_before_sliding_off = |share: f32| slides_off.is_none_or(|end| share < end);
        if let Some(share) = turn.map(|share| share.max(since))
            && is_before_sliding_off(share)
        {
            contact.is_pressed = phase == Phase::Pressed;
            contact.depth = level;
            contact.at = sweep.at(share).truncate();
            step.tell(share, finger, phase, &contact);
        }
        let leaves = sweep.rises_to(0.0).map(|share| share.max(since));
        if let Some(share) = leaves.filter(|&share| is_before_sliding_off(share)) {
            contact.at = sweep.at(share).truncate();
            step.tell(share, finger, Phase::Left, &contact);
            return Some(share);
        }
        if let Some(share) = slides_off {
            contact.at = sweep.at(share).truncate();
            step.tell(share, finger, Phase::Cancelled, &contact);
            self.slid_off = Some(place);
            return Some(share);
        }
        let depth = (-sweep.to.z / target.travel).clamp(0.0, 1.0);
        let at = sweep.to.truncate();
        if depth != contact.depth || at != contact.at {
            contact.depth = depth;
            contact.at = at;
            step.tell(1.0, finger, Phase::Moved, &contact);
        }
        self.contact = Some(contact);
        None
    }

    /// Whether the finger still has to come out from where it slid off a target.
    fn may_not_touch(&mut self, finger: Finger, step: &Step) -> bool {
        let Some(place) = self.slid_off else {
            return false;
        };
        let is_free = step.stroke(place, finger).is_none_or(|(target, sweep)| {
            sweep.from.z >= 0.0 || is_well_beside(target, sweep.from)
        });
        if is_free {
            self.slid_off = None;
        }
        !is_free
    }
}

/// Whether a pad is so far beside a target that it cannot have just slid off it: further from its
/// edge than the target is wide. Without this, a board that bends away from the hand would keep a
/// finger locked out behind the plane of a target that it has long left.
fn is_well_beside(target: &Target, pad: Vec3) -> bool {
    let width = match target.shape {
        Shape::Box(half) => 2.0 * half.max_element(),
        Shape::Disc(radius) => 2.0 * radius,
    };
    !sweep::is_inside(target.shape, pad.truncate(), width)
}
