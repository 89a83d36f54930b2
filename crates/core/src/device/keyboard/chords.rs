//! Chords: keys with another action when they are pressed together.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::{KeyAction, Keyboard, PressSource};
use crate::contact::{Phase, TargetId, Touch};
use crate::device::DeviceOutput;
use crate::device::target_index::TargetIndex;
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::time::Timestamp;

/// Maximum number of keys that take part in chords.
pub const MAX_CHORD_KEYS: usize = KeySet::BITS as usize;

/// The action of several keys that are pressed together, in every layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Chord {
    /// Its keys, each once.
    pub keys: Vec<TargetId>,
    /// Its action.
    pub action: KeyAction,
}

/// A set of chord keys: bit `i` is chord key `i`.
type KeySet = u64;

/// The chords of a keyboard, and which of their keys are pressed.
///
/// Presses of chord keys are gathered until the chord is known: the time window ends, one of the keys is
/// released, another key is pressed, or no larger chord is possible. Then the largest chord among them is
/// pressed, the first in the list if several are as large, then the largest of the rest; keys that are left
/// act on their own. If a fingertip slides off or is lost meanwhile, all gathered presses are dropped:
/// the rest could be an unintended chord.
#[derive(Clone, Debug, Default)]
pub(super) struct Chords {
    chords: Vec<(KeySet, KeyAction)>,
    /// From a target to the number of its chord key.
    chord_keys: TargetIndex,
    window: Duration,
    /// Gathered presses, in order; each finger has one at most.
    gathered: ArrayVec<GatheredPress, FINGERS_OF_BOTH_HANDS>,
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
                .filter_map(|chord| Some((set(chord).filter(|&set| set != 0)?, chord.action)))
                .collect(),
            chord_keys: TargetIndex::new(keys.iter().copied()),
            window,
            ..Self::default()
        }
    }

    /// Returns the actions of all chords.
    pub(super) fn actions(&self) -> impl Iterator<Item = KeyAction> + '_ {
        self.chords.iter().map(|&(_, action)| action)
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
        out: &mut DeviceOutput,
    ) {
        let mut gathered = self.gathered.iter();
        if gathered.any(|press| is_of_finger(PressSource::from_touch(&press.touch))) {
            self.gathered.clear();
        }
        self.pressed.retain(|chord| {
            let is_cancelled = chord.fingers.into_iter().flatten().any(&is_of_finger);
            if is_cancelled {
                out.arbiter.cancel(|source| source == chord.source);
            }
            !is_cancelled
        });
    }

    /// Returns whether the press of a touch is gathered, or would be if it began now.
    pub(super) fn is_or_would_be_gathered(&self, touch: &Touch, source: PressSource) -> bool {
        let is_pressed = self.pressed.iter().any(|chord| chord.has_finger(source));
        self.chord_keys.get(touch.target).is_some() && !is_pressed
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

    /// Returns whether a chord exists that contains all gathered keys and more.
    fn may_grow(&self) -> bool {
        let gathered = self.gathered_keys();
        let is_larger = |set: KeySet| set & gathered == gathered && set != gathered;
        self.chords.iter().any(|&(set, _)| is_larger(set))
    }

    /// Returns the largest chord within `keys`; the first in the list if several are as large.
    fn largest_within(&self, keys: KeySet) -> Option<(KeySet, KeyAction)> {
        let within = self.chords.iter().rev().filter(|(set, _)| set & !keys == 0);
        within.max_by_key(|(set, _)| set.count_ones()).copied()
    }
}

impl PressedChord {
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
        if occupied & key == 0 {
            let press = GatheredPress { key, touch: *touch };
            // Each finger has one press at most, so there is room.
            let _ = self.chords.gathered.try_push(press);
            if !self.chords.may_grow() {
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

    /// Presses the gathered keys: as chords, and those that are left on their own.
    pub(super) fn press_gathered(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let gathered = std::mem::take(&mut self.chords.gathered);
        let mut left = gathered.iter().fold(0, |set, press| set | press.key);
        while let Some((keys, action)) = self.chords.largest_within(left) {
            left &= !keys;
            let of_chord = gathered.iter().filter(|press| press.key & keys != 0);
            self.press_chord(keys, action, of_chord.map(|press| press.touch), time, out);
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
        for source in chord.fingers.into_iter().flatten() {
            if let PressSource::Touch(.., target) = source
                && let Some(key) = self.index.get(target)
            {
                self.debouncer.record_release(key, touch.time);
            }
        }
        match touch.phase {
            Phase::Cancelled => out.arbiter.cancel(|source| source == chord.source),
            _ => out.arbiter.release(|source| source == chord.source),
        }
    }

    fn press_chord(
        &mut self,
        keys: KeySet,
        action: KeyAction,
        touches: impl Iterator<Item = Touch>,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        let mut fingers = [None; FINGERS_OF_BOTH_HANDS];
        for (finger, touch) in fingers.iter_mut().zip(touches) {
            *finger = Some(PressSource::from_touch(&touch));
        }
        let Some(source) = fingers[0] else {
            return;
        };
        self.hold_pending(time, out);
        if out.press(source, action, time) {
            // Each chord has a finger of its own, so there is room.
            let _ = self.chords.pressed.try_push(PressedChord {
                source,
                fingers,
                keys,
            });
        }
    }
}
