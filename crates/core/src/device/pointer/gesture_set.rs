//! The gestures of a pointer.

use arrayvec::ArrayVec;

use super::gesture::{Change, Gesture, GestureDetector};
use super::push::{self, PushDetector};
use super::settings::{ClickMethod, MAX_CLICKS, PointerSettings};
use super::trusted_hand::TrustedHand;
use crate::contact::TargetId;
use crate::device::{DeviceOutput, KeyAction, PressSource};
use crate::hand::Finger;
use crate::time::Timestamp;

/// All clicks, the clutch, precision and scrolling.
const MAX_GESTURES: usize = MAX_CLICKS + 3;

/// The gestures of a pointer. At most one pinch is on at a time: the pinch of the finger nearest to the thumb.
#[derive(Clone, Debug)]
pub(super) struct GestureSet(ArrayVec<AssignedGesture, MAX_GESTURES>);

#[derive(Clone, Copy, Debug)]
struct AssignedGesture {
    role: Role,
    method: ClickMethod,
    detector: GestureDetector,
    push: PushDetector,
}

/// The effect of a gesture.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Clutch,
    Precision,
    Scroll,
    Press(KeyAction),
}

impl GestureSet {
    /// Creates the gestures, none seen yet; clicks after the first [`MAX_CLICKS`] are ignored.
    pub(super) fn new(settings: &PointerSettings) -> Self {
        let clicks = settings.clicks.iter().take(MAX_CLICKS);
        let clicks = clicks.map(|&(method, action)| (Role::Press(action), method));
        let others = [
            (Role::Clutch, settings.clutch),
            (Role::Precision, settings.precision_gesture),
            (Role::Scroll, settings.scroll.map(|scroll| scroll.gesture)),
        ];
        let others = others.into_iter();
        let others =
            others.filter_map(|(role, gesture)| Some((role, ClickMethod::Gesture(gesture?))));
        let gestures = clicks.chain(others).map(|(role, method)| AssignedGesture {
            role,
            method,
            detector: GestureDetector::default(),
            push: PushDetector::default(),
        });
        Self(gestures.collect())
    }

    /// Returns `true` if a click is held.
    pub(super) fn is_pressing(&self) -> bool {
        let is_press = |it: &&AssignedGesture| matches!(it.role, Role::Press(_));
        self.0.iter().filter(is_press).any(|it| it.detector.is_on())
    }

    /// Returns `true` if a click or scrolling may be about to begin, or has just ended.
    pub(super) fn is_near(&self) -> bool {
        let holds_cursor = |it: &&AssignedGesture| matches!(it.role, Role::Press(_) | Role::Scroll);
        let mut gestures = self.0.iter().filter(holds_cursor);
        gestures.any(|it| it.detector.is_near())
    }

    pub(super) fn is_scrolling(&self) -> bool {
        self.is_on(Role::Scroll)
    }

    pub(super) fn is_precise(&self) -> bool {
        self.is_on(Role::Precision)
    }

    pub(super) fn has_clutch(&self) -> bool {
        self.0.iter().any(|it| it.role == Role::Clutch)
    }

    /// Returns `true` if there is a clutch and it is off.
    pub(super) fn is_clutch_released(&self) -> bool {
        self.has_clutch() && !self.is_on(Role::Clutch)
    }

    fn is_on(&self, role: Role) -> bool {
        let mut gestures = self.0.iter();
        gestures.any(|it| it.role == role && it.detector.is_on())
    }

    /// Updates all gestures for one step; emits releases first, then presses.
    pub(super) fn update(
        &mut self,
        hand: &TrustedHand,
        settings: &PointerSettings,
        seconds: f32,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let nearest = nearest_to_thumb(hand);
        let is_pinching = self
            .0
            .iter()
            .any(|it| it.pinch_finger().is_some() && it.detector.is_on());
        let mut changes = ArrayVec::<Change, MAX_GESTURES>::new();
        for gesture in &mut self.0 {
            let finger = gesture.pinch_finger();
            let may_begin = finger.is_none() || (!is_pinching && finger == nearest);
            changes.push(gesture.update(hand, settings, may_begin, seconds, time));
        }
        let source = |index: usize| PressSource::Part(settings.target, index as u8);
        for (index, change) in changes.iter().enumerate() {
            match change {
                Change::Ended => out.release(source(index), time),
                Change::Lost => out.cancel(source(index), time),
                Change::None | Change::Began => {}
            }
        }
        for ((index, change), gesture) in changes.iter().enumerate().zip(&mut self.0) {
            let Role::Press(action) = gesture.role else {
                continue;
            };
            if *change == Change::Began && !out.press(source(index), action, time) {
                gesture.detector.block();
            }
        }
    }

    /// Cancels all gestures and what they press.
    pub(super) fn cancel(&mut self, target: TargetId, time: Timestamp, out: &mut DeviceOutput) {
        for (index, gesture) in self.0.iter_mut().enumerate() {
            gesture.push = PushDetector::default();
            if gesture.detector.block() {
                out.cancel(PressSource::Part(target, index as u8), time);
            }
        }
    }
}

impl AssignedGesture {
    /// Returns the finger that pinches, if the gesture is a pinch.
    fn pinch_finger(&self) -> Option<Finger> {
        match self.method {
            ClickMethod::Gesture(Gesture::Pinch(finger)) => Some(finger),
            _ => None,
        }
    }

    fn update(
        &mut self,
        hand: &TrustedHand,
        settings: &PointerSettings,
        may_begin: bool,
        seconds: f32,
        time: Timestamp,
    ) -> Change {
        let (measurement, thresholds) = match self.method {
            ClickMethod::Gesture(gesture) => (
                gesture.measurement(hand),
                gesture.thresholds(settings.pinch),
            ),
            ClickMethod::Push(depth) => {
                let (tip, forward) = (hand.tip(Finger::Index), settings.mode.forward());
                let is_on = self.detector.is_on();
                let step = (seconds, hand.pose().is_after_gap);
                (
                    self.push.update(tip, forward, (depth, is_on), step),
                    push::thresholds(depth),
                )
            }
        };
        self.detector
            .update(measurement, thresholds, may_begin, time)
    }
}

/// Returns the finger whose tip is nearest to the tip of the thumb. When one finger moves to the thumb, its
/// neighbor moves along; only the nearest one is intended.
fn nearest_to_thumb(hand: &TrustedHand) -> Option<Finger> {
    let thumb = hand.tip(Finger::Thumb)?;
    let others = Finger::ALL.iter().filter(|&&it| it != Finger::Thumb);
    let gaps = others.filter_map(|&it| Some((it, hand.tip(it)?.distance(thumb))));
    gaps.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(it, _)| it)
}
