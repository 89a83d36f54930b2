//! Chords: keys with another action when they are pressed together.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::pending::PendingPress;
use super::{Activation, KeyAction, Keyboard, PressSource, TapHold, action_in_layer};
use crate::contact::{Phase, TargetId, Touch};
use crate::device::DeviceOutput;
use crate::device::target_index::TargetIndex;
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::time::Timestamp;

/// Presses whose action has not fired yet.
type PendingPresses = ArrayVec<PendingPress, FINGERS_OF_BOTH_HANDS>;

/// Maximum number of keys that take part in chords.
pub const MAX_CHORD_KEYS: usize = KeySet::BITS as usize;

/// Several keys that are pressed together.
#[derive(Clone, Debug, PartialEq)]
pub struct Chord {
    /// The keys, each once.
    pub keys: Vec<TargetId>,
    /// The action in each layer, base layer first, as of a [`KeyBinding`](super::KeyBinding). In a layer without an action in
    /// any way it is not a chord.
    pub actions: Vec<Option<KeyAction>>,
    /// The moment at which the action fires; not [`Activation::Dwell`].
    pub activation: Activation,
}

impl Chord {
    /// Returns the action in a layer, or in the base layer if that layer defines none.
    pub fn action(&self, layer: usize) -> Option<KeyAction> {
        action_in_layer(&self.actions, layer)
    }
}

/// A set of chord keys: bit `i` is chord key `i`.
type KeySet = u64;

/// The chords of a keyboard, and which of their keys are pressed.
///
/// Presses of chord keys are gathered until the chord is known: the time window ends, one of the keys is
/// released, another key is pressed, or no larger chord is possible. Then the largest chord among them is
/// pressed, the first in the list if several are as large, then the largest of the rest; keys that are left
/// act on their own. If a fingertip slides off or is lost before that, or a key may have been missed
/// [in a gap](crate::kinematics::HandPose::may_hide_presses), all gathered presses are dropped: the rest could be an unintended chord.
#[derive(Clone, Debug, Default)]
pub(super) struct Chords {
    chords: Vec<(KeySet, Chord)>,
    /// The number of the chord key of each target.
    chord_keys: TargetIndex,
    window: Duration,
    /// Gathered presses, in order; each finger has one at most.
    gathered: ArrayVec<GatheredPress, FINGERS_OF_BOTH_HANDS>,
    /// `true` if other keys may have been pressed in this step and released again.
    may_have_missed: bool,
    /// Chords that are pressed; each has at least one finger.
    pressed: ArrayVec<PressedChord, FINGERS_OF_BOTH_HANDS>,
}

#[derive(Clone, Copy, Debug)]
struct GatheredPress {
    key: KeySet,
    touch: Touch,
}

#[derive(Clone, Copy, Debug)]
struct PressedChord {
    /// The source of its press: the first of its fingers.
    source: PressSource,
    /// The time of its first finger.
    since: Timestamp,
    /// The fingers on its keys; the release of any of them releases the chord.
    fingers: [Option<PressSource>; FINGERS_OF_BOTH_HANDS],
    keys: KeySet,
}

impl Chords {
    /// Creates chords whose keys are pressed within `window`. Keys beyond [`MAX_CHORD_KEYS`] take part in
    /// none, and chords that contain them are ignored.
    pub(super) fn new(chords: &[Chord], window: Duration) -> Self {
        let mut keys: Vec<TargetId> = chords.iter().flat_map(|chord| chord.keys.clone()).collect();
        keys.sort_unstable();
        keys.dedup();
        keys.truncate(MAX_CHORD_KEYS);
        let set = |chord: &Chord| -> Option<KeySet> {
            let mut numbers = chord.keys.iter().map(|key| keys.binary_search(key).ok());
            numbers.try_fold(0, |set, number| Some(set | 1 << number?))
        };
        Self {
            chords: chords
                .iter()
                .filter_map(|chord| Some((set(chord).filter(|&set| set != 0)?, chord.clone())))
                .collect(),
            chord_keys: TargetIndex::new(keys.iter().copied()),
            window,
            ..Self::default()
        }
    }

    /// Returns the actions of all chords.
    pub(super) fn actions(&self) -> impl Iterator<Item = KeyAction> + '_ {
        self.chords.iter().flat_map(|(_, chord)| {
            let hold = match chord.activation {
                Activation::TapHold(TapHold { hold_action, .. }) => Some(hold_action),
                _ => None,
            };
            chord.actions.iter().copied().flatten().chain(hold)
        })
    }

    /// Begins a step. If keys may have been missed before it, the gathered presses are dropped, and the presses of the step have no effect
    /// until they are released.
    pub(super) fn begin_step(&mut self, may_have_missed: bool) {
        self.may_have_missed = may_have_missed;
        if may_have_missed {
            self.gathered.clear();
        }
    }

    /// Forgets all presses.
    pub(super) fn reset(&mut self) {
        self.gathered.clear();
        self.pressed.clear();
    }

    /// Cancels the gathered presses and the chords of a finger.
    pub(super) fn cancel_finger(
        &mut self,
        is_of_finger: impl Fn(PressSource) -> bool,
        pending: &mut PendingPresses,
        out: &mut DeviceOutput,
    ) {
        let mut gathered = self.gathered.iter();
        if gathered.any(|press| is_of_finger(PressSource::from_touch(&press.touch))) {
            self.gathered.clear();
        }
        self.pressed.retain(|chord| {
            let is_cancelled = chord.fingers.into_iter().flatten().any(&is_of_finger);
            if is_cancelled {
                pending.retain(|press| press.source != chord.source);
                out.arbiter.cancel(|source| source == chord.source);
            }
            !is_cancelled
        });
    }

    /// Returns `true` if the press of a touch is gathered, or would be if it began now.
    pub(super) fn is_or_would_be_gathered(&self, touch: &Touch, source: PressSource) -> bool {
        let is_pressed = self.pressed.iter().any(|chord| chord.has_finger(source));
        self.chord_keys.get(touch.target).is_some() && !is_pressed
    }

    /// Returns the source of the pressed chord that a finger is part of.
    pub(super) fn source_of_chord(&self, finger: PressSource) -> Option<PressSource> {
        let mut pressed = self.pressed.iter();
        let chord = pressed.find(|chord| chord.has_finger(finger))?;
        Some(chord.source)
    }

    /// Iterates over the fingers of a press: of the pressed chord with this source, or else the source itself.
    pub(super) fn fingers_of(&self, source: PressSource) -> impl Iterator<Item = PressSource> {
        let chord = self.pressed.iter().find(|chord| chord.source == source);
        let fingers = chord.map_or([None; FINGERS_OF_BOTH_HANDS], |chord| chord.fingers);
        fingers.into_iter().flatten().chain([source])
    }

    fn key(&self, target: TargetId) -> Option<KeySet> {
        Some(1 << self.chord_keys.get(target)?)
    }

    fn gathered_keys(&self) -> KeySet {
        self.gathered.iter().fold(0, |set, press| set | press.key)
    }

    fn is_gathered(&self, source: PressSource) -> bool {
        self.gathered
            .iter()
            .any(|press| PressSource::from_touch(&press.touch) == source)
    }

    /// Returns the end of the time window, if presses are gathered.
    fn due(&self) -> Option<Timestamp> {
        Some(self.gathered.first()?.touch.time + self.window)
    }

    /// Returns `true` if a layer has a chord that contains all gathered keys and more.
    fn may_grow(&self, layer: usize) -> bool {
        let gathered = self.gathered_keys();
        let is_larger = |set: KeySet| set & gathered == gathered && set != gathered;
        let mut chords = self.chords.iter();
        chords.any(|(set, chord)| is_larger(*set) && chord.action(layer).is_some())
    }

    /// Returns the largest chord of a layer within `keys`, the first in the list if several are as large, with its action.
    fn largest_within(
        &self,
        keys: KeySet,
        layer: usize,
    ) -> Option<(KeySet, KeyAction, Activation)> {
        let within = self.chords.iter().rev().filter(|(set, _)| set & !keys == 0);
        let active =
            within.filter_map(|(set, chord)| Some((*set, chord.action(layer)?, chord.activation)));
        active.max_by_key(|(set, ..)| set.count_ones())
    }
}

impl PressedChord {
    /// Creates a chord of these touches; `None` if there are none.
    fn new(keys: KeySet, touches: impl Iterator<Item = Touch>) -> Option<Self> {
        let mut fingers = [None; FINGERS_OF_BOTH_HANDS];
        let mut since = None;
        for (finger, touch) in fingers.iter_mut().zip(touches) {
            since = since.or(Some(touch.time));
            *finger = Some(PressSource::from_touch(&touch));
        }
        Some(Self {
            source: fingers[0]?,
            since: since?,
            fingers,
            keys,
        })
    }

    fn has_finger(&self, source: PressSource) -> bool {
        self.fingers.contains(&Some(source))
    }
}

impl Keyboard {
    /// Adds chords whose keys are pressed within `window` of the first one.
    pub fn with_chords(self, chords: &[Chord], window: Duration) -> Self {
        Self {
            chords: Chords::new(chords, window),
            ..self
        }
    }

    /// Gathers the press of a chord key; returns `false` for other keys. A second finger on a chord key is
    /// ignored.
    pub(super) fn gather(&mut self, touch: &Touch, out: &mut DeviceOutput) -> bool {
        let Some(key) = self.chords.key(touch.target) else {
            return false;
        };
        let pressed = self.chords.pressed.iter();
        let occupied = pressed.fold(self.chords.gathered_keys(), |set, chord| set | chord.keys);
        if occupied & key == 0 && !self.chords.may_have_missed {
            let press = GatheredPress { key, touch: *touch };
            // Each finger has one press at most, so there is room.
            let _ = self.chords.gathered.try_push(press);
            let active = out.arbiter.active_layer();
            // A chord turns a pending key into a hold, which may be the layer of the chord.
            let held = self.pending.iter().filter_map(PendingPress::held_layer);
            if !held.chain([active]).any(|it| self.chords.may_grow(it)) {
                self.press_gathered(touch.time, out);
            }
        }
        true
    }

    /// Presses the gathered keys if their time window has ended by `time`.
    pub(super) fn press_gathered_if_due(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if let Some(due) = self.chords.due().filter(|&due| due <= time) {
            self.press_gathered(due, out);
        }
    }

    /// Presses the gathered keys if their time window has ended by the latest pose of each of their hands.
    pub(super) fn press_gathered_if_seen(&mut self, out: &mut DeviceOutput) {
        let gathered = self.chords.gathered.iter();
        let seen = gathered.map(|press| self.seen[press.touch.side.index()]);
        if let Some(time) = seen.min() {
            self.press_gathered_if_due(time, out);
        }
    }

    /// Presses the gathered keys: as chords, and those that are left on their own.
    pub(super) fn press_gathered(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let gathered = std::mem::take(&mut self.chords.gathered);
        if !gathered.is_empty() {
            // What another key holds from now on may be the layer of the chords.
            self.hold_pending(time, out);
        }
        let mut left = gathered.iter().fold(0, |set, press| set | press.key);
        while let Some((keys, action, activation)) =
            self.chords.largest_within(left, out.arbiter.active_layer())
        {
            left &= !keys;
            let of_chord = gathered.iter().filter(|press| press.key & keys != 0);
            let of_chord = of_chord.map(|press| press.touch);
            if let Some(chord) = PressedChord::new(keys, of_chord) {
                self.press_chord(chord, action, activation, time, out);
            }
        }
        for GatheredPress { key, touch } in gathered {
            if key & left != 0 {
                self.press_single(&touch, time, out);
            }
        }
    }

    /// Ends the part of a finger in gathered presses and chords, before its own press ends.
    pub(super) fn end_chords(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let source = PressSource::from_touch(touch);
        if self.chords.is_gathered(source) {
            match touch.phase {
                Phase::Cancelled => self.chords.gathered.clear(),
                _ => self.press_gathered(touch.time, out),
            }
        }
        let mut pressed = self.chords.pressed.iter();
        let Some(index) = pressed.position(|chord| chord.has_finger(source)) else {
            return;
        };
        let chord = self.chords.pressed.remove(index);
        for finger in chord.fingers.into_iter().flatten() {
            if let PressSource::Touch(.., target) = finger
                && let Some(key) = self.index.get(target)
            {
                self.debouncer.record_release(key, touch.time);
            }
        }
        if touch.phase != Phase::Cancelled {
            self.fire_on_release(chord.source, touch.time, out);
        }
        self.pending.retain(|press| press.source != chord.source);
        match touch.phase {
            Phase::Cancelled => out.arbiter.cancel(|holder| holder == chord.source),
            _ => out.arbiter.release(|holder| holder == chord.source),
        }
    }

    fn press_chord(
        &mut self,
        chord: PressedChord,
        action: KeyAction,
        activation: Activation,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        self.hold_pending(time, out);
        // The time of a hold counts from the first finger, as a key's hold counts from its press.
        let is_pressed = match PendingPress::new(chord.source, action, activation, chord.since) {
            Some(press) if out.arbiter.has_room(out.events) => self.pending.try_push(press).is_ok(),
            Some(_) => false,
            None => out.press(chord.source, action, time),
        };
        if is_pressed {
            // Each chord has a finger of its own, so there is room.
            let _ = self.chords.pressed.try_push(chord);
        }
    }
}
