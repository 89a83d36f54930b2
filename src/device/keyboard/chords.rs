//! Keys that do something else when they are pressed together.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::{KeyAction, Keyboard, PressSource};
use crate::contact::{Phase, TargetId, Touch};
use crate::device::DeviceOutput;
use crate::device::target_index::Places;
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::time::Timestamp;

/// How many keys can take part in chords.
pub const MAX_CHORD_KEYS: usize = KeySet::BITS as usize;

/// What several keys do together, whatever the layer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chord {
    /// Its keys, each once.
    pub keys: Vec<TargetId>,
    /// What it does.
    pub action: KeyAction,
}

/// Keys that take part in chords: bit `i` is the key of number `i`.
type KeySet = u64;

/// The chords of a keyboard, and which of their keys are pressed.
///
/// Presses of such keys are gathered until it is known what they are: the window is over, one of them is
/// let go of, another key is pressed, or no larger chord can come of them. Then the largest chords among
/// them are pressed, of two as large the first of the list, and what is left acts on its own. A
/// fingertip that slides off or is lost while they are gathered takes all of them back: what is left
/// could be a chord that nobody meant.
#[derive(Clone, Debug, Default)]
pub(super) struct Chords {
    chords: Vec<(KeySet, KeyAction)>,
    /// From a target to the number of its key.
    numbers: Places,
    within: Duration,
    /// Keys that wait, in order of pressing; each finger has one at most.
    gathered: ArrayVec<Gathered, FINGERS_OF_BOTH_HANDS>,
    /// Chords that are down; each has a finger at least.
    down: ArrayVec<Down, FINGERS_OF_BOTH_HANDS>,
}

#[derive(Clone, Copy, Debug)]
struct Gathered {
    key: KeySet,
    touch: Touch,
}

#[derive(Clone, Copy, Debug)]
struct Down {
    /// In whose name it is pressed.
    owner: PressSource,
    /// Whose release ends it.
    fingers: [Option<PressSource>; FINGERS_OF_BOTH_HANDS],
    keys: KeySet,
}

impl Chords {
    /// What the chords do.
    pub(super) fn actions(&self) -> impl Iterator<Item = KeyAction> + '_ {
        self.chords.iter().map(|&(_, action)| action)
    }

    /// Chords of keys that are pressed `within` that time. Keys beyond [`MOST_CHORD_KEYS`] take part in
    /// none, and chords with them are left out.
    pub(super) fn new(chords: &[Chord], within: Duration) -> Self {
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
            numbers: Places::new(keys.iter().copied()),
            within,
            ..Self::default()
        }
    }

    /// Forgets every finger.
    pub(super) fn forget(&mut self) {
        self.gathered.clear();
        self.down.clear();
    }

    /// Takes back what a finger does in chords.
    pub(super) fn lift(
        &mut self,
        is_of_finger: impl Fn(PressSource) -> bool,
        out: &mut DeviceOutput,
    ) {
        let mut gathered = self.gathered.iter();
        if gathered.any(|other| is_of_finger(PressSource::from_touch(&other.touch))) {
            self.gathered.clear();
        }
        self.down.retain(|chord| {
            let is_lifted = chord.fingers.into_iter().flatten().any(&is_of_finger);
            if is_lifted {
                out.arbiter.cancel(|other| other == chord.owner);
            }
            !is_lifted
        });
    }

    /// Whether the press of a touch waits, or would if it began now.
    pub(super) fn is_waiting(&self, touch: &Touch, owner: PressSource) -> bool {
        let is_down = self.down.iter().any(|chord| chord.has(owner));
        self.numbers.of(touch.target).is_some() && !is_down
    }

    fn key(&self, target: TargetId) -> Option<KeySet> {
        Some(1 << self.numbers.of(target)?)
    }

    fn gathered_keys(&self) -> KeySet {
        self.gathered.iter().fold(0, |set, other| set | other.key)
    }

    fn is_gathered(&self, owner: PressSource) -> bool {
        self.gathered
            .iter()
            .any(|other| PressSource::from_touch(&other.touch) == owner)
    }

    /// When what is gathered is to be pressed; `None` when nothing is.
    fn due(&self) -> Option<Timestamp> {
        Some(self.gathered.first()?.touch.time + self.within)
    }

    /// Whether a chord may still come that has all that is gathered and more.
    fn may_grow(&self) -> bool {
        let gathered = self.gathered_keys();
        let grows = |set: KeySet| set & gathered == gathered && set != gathered;
        self.chords.iter().any(|&(set, _)| grows(set))
    }

    /// The largest chord within `keys`, the first of those as large.
    fn largest_in(&self, keys: KeySet) -> Option<(KeySet, KeyAction)> {
        let within = self.chords.iter().rev().filter(|(set, _)| set & !keys == 0);
        within.max_by_key(|(set, _)| set.count_ones()).copied()
    }
}

impl Down {
    fn has(&self, owner: PressSource) -> bool {
        self.fingers.contains(&Some(owner))
    }
}

impl Keyboard {
    /// The same with chords of keys that are pressed `within` that time of the first of them.
    pub fn with_chords(self, chords: &[Chord], within: Duration) -> Self {
        Self {
            chords: Chords::new(chords, within),
            ..self
        }
    }

    /// Takes the press of a key that takes part in chords; `false` for other keys. A second finger on
    /// such a key does nothing.
    pub(super) fn gather(&mut self, touch: &Touch, out: &mut DeviceOutput) -> bool {
        let Some(key) = self.chords.key(touch.target) else {
            return false;
        };
        let down = self.chords.down.iter();
        let taken = down.fold(self.chords.gathered_keys(), |set, chord| set | chord.keys);
        if taken & key == 0 {
            // Each finger has one press at most, so there is room.
            let _ = self
                .chords
                .gathered
                .try_push(Gathered { key, touch: *touch });
            if !self.chords.may_grow() {
                self.press_gathered(touch.time, out);
            }
        }
        true
    }

    /// Presses what was gathered, if its time is over by `time`.
    pub(super) fn press_gathered_by(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if let Some(due) = self.chords.due().filter(|&due| due <= time) {
            self.press_gathered(due, out);
        }
    }

    /// Presses what was gathered: chords, and keys on their own.
    pub(super) fn press_gathered(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let gathered = std::mem::take(&mut self.chords.gathered);
        let mut left = gathered.iter().fold(0, |set, other| set | other.key);
        while let Some((keys, action)) = self.chords.largest_in(left) {
            left &= !keys;
            let of_chord = gathered.iter().filter(|other| other.key & keys != 0);
            self.press_chord(keys, action, of_chord.map(|other| other.touch), time, out);
        }
        for Gathered { key, touch } in gathered {
            if key & left != 0 {
                self.press_alone(&touch, time, out);
            }
        }
    }

    /// Ends what a finger does in chords, before what it does on its own.
    pub(super) fn end_in_chords(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let owner = PressSource::from_touch(touch);
        if self.chords.is_gathered(owner) {
            match touch.phase {
                Phase::Cancelled => self.chords.gathered.clear(),
                _ => self.press_gathered(touch.time, out),
            }
        }
        let Some(place) = self.chords.down.iter().position(|chord| chord.has(owner)) else {
            return;
        };
        let chord = self.chords.down.remove(place);
        for owner in chord.fingers.into_iter().flatten() {
            if let PressSource::Touch(.., target) = owner
                && let Some(place) = self.places.of(target)
            {
                self.bounces.came_up(place, touch.time);
            }
        }
        match touch.phase {
            Phase::Cancelled => out.arbiter.cancel(|other| other == chord.owner),
            _ => out.arbiter.release(|other| other == chord.owner),
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
        let Some(owner) = fingers[0] else {
            return;
        };
        self.hold_for_another_key(time, out);
        if out.press(owner, action, time) {
            // Each chord has a finger of its own, so there is room.
            let _ = self.chords.down.try_push(Down {
                owner,
                fingers,
                keys,
            });
        }
    }
}
