//! The gestures of a pointer: one at a time where they could be mistaken for each other.

use arrayvec::ArrayVec;

use super::gesture::{Change, Gesture, Watch};
use super::push::{self, Push};
use super::settings::{ClickMethod, MAX_CLICKS, PointerSettings};
use super::trusted_hand::Sight;
use crate::contact::TargetId;
use crate::device::{DeviceOutput, KeyAction, PressSource};
use crate::hand::Finger;
use crate::time::Timestamp;

/// All clicks, the clutch, precision and the wheel.
const MOST: usize = MAX_CLICKS + 3;

/// The gestures of a pointer.
#[derive(Clone, Debug)]
pub(super) struct Gestures(ArrayVec<Watched, MOST>);

#[derive(Clone, Copy, Debug)]
struct Watched {
    role: Role,
    by: ClickMethod,
    watch: Watch,
    push: Push,
}

/// What a gesture is there for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Clutch,
    Slow,
    Scroll,
    Press(KeyAction),
}

impl Gestures {
    /// None of them seen yet; clicks after the first [`MOST_CLICKS`] are left out.
    pub(super) fn new(settings: &PointerSettings) -> Self {
        let clicks = settings.clicks.iter().take(MAX_CLICKS);
        let clicks = clicks.map(|&(by, action)| (Role::Press(action), by));
        let others = [
            (Role::Clutch, settings.clutch),
            (Role::Slow, settings.precision_gesture),
            (Role::Scroll, settings.scroll.map(|scroll| scroll.gesture)),
        ];
        let others = others.into_iter();
        let others = others.filter_map(|(role, by)| Some((role, ClickMethod::Gesture(by?))));
        let watched = clicks.chain(others).map(|(role, by)| Watched {
            role,
            by,
            watch: Watch::default(),
            push: Push::default(),
        });
        Self(watched.collect())
    }

    /// Whether something is pressed.
    pub(super) fn presses(&self) -> bool {
        let is_press = |it: &&Watched| matches!(it.role, Role::Press(_));
        self.0.iter().filter(is_press).any(|it| it.watch.is_on())
    }

    /// Whether something may be about to be pressed or scrolled, or has just been.
    pub(super) fn is_ready(&self) -> bool {
        let moves = |it: &&Watched| matches!(it.role, Role::Press(_) | Role::Scroll);
        self.0.iter().filter(moves).any(|it| it.watch.is_ready())
    }

    pub(super) fn scrolls(&self) -> bool {
        self.is_on(Role::Scroll)
    }

    pub(super) fn is_precise(&self) -> bool {
        self.is_on(Role::Slow)
    }

    pub(super) fn has_clutch(&self) -> bool {
        self.0.iter().any(|it| it.role == Role::Clutch)
    }

    /// Whether there is a clutch and it is let go of.
    pub(super) fn is_let_go(&self) -> bool {
        self.has_clutch() && !self.is_on(Role::Clutch)
    }

    fn is_on(&self, role: Role) -> bool {
        self.0.iter().any(|it| it.role == role && it.watch.is_on())
    }

    /// Takes a frame: what ends comes up first, then what begins goes down.
    pub(super) fn follow(
        &mut self,
        sight: &Sight,
        settings: &PointerSettings,
        seconds: f32,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let nearest = nearest_to_thumb(sight);
        let is_pinching = self
            .0
            .iter()
            .any(|it| it.pinch().is_some() && it.watch.is_on());
        let mut changes = ArrayVec::<Change, MOST>::new();
        for watched in &mut self.0 {
            let is_free = !is_pinching && watched.pinch() == nearest;
            let may_begin = watched.pinch().is_none() || is_free;
            changes.push(watched.follow(sight, settings, may_begin, seconds, time));
        }
        for (place, change) in changes.iter().enumerate() {
            let owner = PressSource::Part(settings.target, place as u8);
            match change {
                Change::Ends => out.release(owner, time),
                Change::IsLost => out.cancel(owner, time),
                Change::None | Change::Begins => {}
            }
        }
        for ((place, change), watched) in changes.iter().enumerate().zip(&mut self.0) {
            let Role::Press(action) = watched.role else {
                continue;
            };
            let owner = PressSource::Part(settings.target, place as u8);
            if *change == Change::Begins && !out.press(owner, action, time) {
                watched.watch.forget();
            }
        }
    }

    /// Cancels what is pressed.
    pub(super) fn lose(&mut self, target: TargetId, time: Timestamp, out: &mut DeviceOutput) {
        for (place, watched) in self.0.iter_mut().enumerate() {
            watched.push = Push::default();
            if watched.watch.forget() {
                out.cancel(PressSource::Part(target, place as u8), time);
            }
        }
    }
}

impl Watched {
    /// The finger that it pinches with.
    fn pinch(&self) -> Option<Finger> {
        match self.by {
            ClickMethod::Gesture(Gesture::Pinch(finger)) => Some(finger),
            _ => None,
        }
    }

    fn follow(
        &mut self,
        sight: &Sight,
        settings: &PointerSettings,
        may_begin: bool,
        seconds: f32,
        time: Timestamp,
    ) -> Change {
        let (measure, levels) = match self.by {
            ClickMethod::Gesture(gesture) => {
                (gesture.measure(sight), gesture.levels(settings.pinch))
            }
            ClickMethod::Push(depth) => {
                let (tip, forward) = (sight.tip(Finger::Index), settings.mode.forward());
                let is_on = self.watch.is_on();
                (
                    self.push.measure(tip, forward, (depth, is_on), seconds),
                    push::levels(depth),
                )
            }
        };
        self.watch.follow(measure, levels, may_begin, time)
    }
}

/// The finger whose tip is nearest to that of the thumb. When one finger comes to the thumb the next one
/// comes along; only the nearest is meant.
fn nearest_to_thumb(sight: &Sight) -> Option<Finger> {
    let thumb = sight.tip(Finger::Thumb)?;
    let others = Finger::ALL.iter().filter(|&&it| it != Finger::Thumb);
    let gaps = others.filter_map(|&it| Some((it, sight.tip(it)?.distance(thumb))));
    gaps.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(it, _)| it)
}
