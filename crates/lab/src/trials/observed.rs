//! Observations of a person.

use std::collections::BTreeMap;

use parry3d::math::Vec2;

use crate::contact::TargetId;
use crate::hand::Finger;
use crate::measures::KeystrokeClasses;
use crate::readings::PhraseTaps;
use crate::sim::EditCounts;
use crate::sim::fluent::Load;

/// The reason for a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrokeKind {
    /// The stroke was meant.
    Meant,
    /// The stroke was meant and did not reach the target.
    Shallow,
    /// The stroke was not meant.
    Spurious,
}

/// A stroke of a person, and what it pressed.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// The target that was meant; the first of a chord.
    pub target: TargetId,
    /// The finger; the first of a chord.
    pub finger: Finger,
    /// The index of the hand.
    pub hand: usize,
    /// The reason.
    pub kind: StrokeKind,
    /// The targets that were meant together: one, or all of a chord.
    pub targets: Vec<TargetId>,
    /// The time of the lowest point, in seconds.
    pub bottom: f64,
    /// The distance that the hand moved for it, in metres.
    pub distance: f64,
    /// The place of the tap from the center of the target, in metres; zero for bends.
    pub point: Vec2,
    /// The place as the pipeline shows it at the lowest point, if it showed the finger.
    pub shown: Option<Vec2>,
    /// The targets that were pressed, with the place from the center of the meant one in metres.
    pub presses: Vec<(TargetId, Vec2)>,
}

impl Stroke {
    /// Returns `true` if it pressed what was meant: the target, perhaps with others, or exactly the targets of a chord.
    pub fn has_hit(&self) -> bool {
        let is_pressed =
            |target: &TargetId| self.presses.iter().any(|(pressed, _)| pressed == target);
        let is_exact = self.targets.len() == 1 || self.presses.len() == self.targets.len();
        is_exact && self.targets.iter().all(is_pressed)
    }
}

/// The strokes that meant one target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeyTally {
    /// Strokes that meant it.
    pub meant: u64,
    /// Strokes that pressed it.
    pub hit: u64,
    /// Strokes that pressed nothing.
    pub nothing: u64,
    /// The sum of the places of the presses from its center, in metres.
    pub sum: [f64; 2],
    /// The sum of their squares.
    pub squares: [f64; 2],
    /// The number of places in these sums.
    pub places: u64,
}

/// The observations of one person.
#[derive(Clone, Debug, Default)]
pub struct Observed {
    /// The characters of all phrases.
    pub edits: EditCounts,
    /// Wrong characters of the text that the nearest keys of the taps type.
    pub nearest_errors: usize,
    /// The errors for the places of the taps as the pipeline shows them.
    pub shown_errors: usize,
    /// The number of characters that were to be typed.
    pub characters: usize,
    /// The number of words that were to be typed, and the edit distance of the words.
    pub words: [usize; 2],
    /// The keystrokes by class.
    pub keystrokes_by_class: KeystrokeClasses,
    /// Keys that went down.
    pub keystrokes: usize,
    /// The time from the first to the last event of each phrase, in seconds.
    pub seconds: f64,
    /// The number of phrases.
    pub phrases: usize,
    /// Each phrase: its characters with the edits of what was typed, and the seconds.
    pub by_phrase: Vec<(EditCounts, usize, f64)>,
    /// The strokes by the target that was meant.
    pub keys: BTreeMap<TargetId, KeyTally>,
    /// Presses of another target than the meant one: meant, pressed, number.
    pub confusions: BTreeMap<(TargetId, TargetId), u64>,
    /// Presses of a target that touches the meant one.
    pub neighbor_slips: u64,
    /// Pairs of strokes one after the other.
    pub pairs: Pairs,
    /// Strokes by finger, of all hands.
    pub fingers: [u64; Finger::COUNT],
    /// The sum of the shortest times of the movements between strokes (Fitts's law), in seconds.
    pub predicted_seconds: f64,
    /// The times between strokes, in seconds.
    pub intervals: Vec<f64>,
    /// The load of the joints.
    pub load: Load,
    /// The taps of each phrase, with a decoder.
    pub(crate) taps: Vec<PhraseTaps>,
    /// Readings that passed through the pipeline, and the simulated time in seconds.
    pub readings: u64,
    /// The simulated time of all hands, in seconds.
    pub simulated_seconds: f64,
}

/// Kinds of pairs of strokes that mean two different targets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pairs {
    /// All pairs.
    pub all: u64,
    /// Pairs by one finger of one hand.
    pub same_finger: u64,
    /// Pairs by two hands.
    pub alternating: u64,
    /// Pairs by two fingers of one hand, none of them the thumb.
    pub rolls: u64,
    /// Two rolls of one hand in opposite directions.
    pub redirects: u64,
}

impl Observed {
    /// Adds the strokes of a phrase. `are_neighbors` tells whether two targets touch.
    pub(super) fn add_strokes(
        &mut self,
        strokes: &[Stroke],
        are_neighbors: impl Fn(TargetId, TargetId) -> bool,
    ) {
        for stroke in strokes {
            if stroke.kind == StrokeKind::Spurious {
                continue;
            }
            self.fingers[stroke.finger.index()] += 1;
            let tally = self.keys.entry(stroke.target).or_default();
            tally.meant += 1;
            if stroke.presses.is_empty() {
                tally.nothing += 1;
            }
            tally.hit += u64::from(stroke.has_hit());
            if stroke.targets.len() > 1 {
                // A chord presses several targets on purpose.
                continue;
            }
            for &(pressed, place) in &stroke.presses {
                tally.places += 1;
                for (axis, value) in [place.x, place.y].into_iter().enumerate() {
                    tally.sum[axis] += f64::from(value);
                    tally.squares[axis] += f64::from(value).powi(2);
                }
                if pressed != stroke.target {
                    *self.confusions.entry((stroke.target, pressed)).or_default() += 1;
                    self.neighbor_slips += u64::from(are_neighbors(stroke.target, pressed));
                }
            }
        }
        let meant: Vec<&Stroke> = strokes
            .iter()
            .filter(|stroke| stroke.kind != StrokeKind::Spurious)
            .collect();
        for pair in meant.windows(2) {
            self.intervals.push(pair[1].bottom - pair[0].bottom);
        }
        self.pairs.add(&meant);
    }
}

impl Pairs {
    fn add(&mut self, strokes: &[&Stroke]) {
        let direction = |a: &Stroke, b: &Stroke| {
            let is_roll = a.hand == b.hand
                && a.finger != b.finger
                && a.finger != Finger::Thumb
                && b.finger != Finger::Thumb;
            is_roll.then(|| a.finger.index() < b.finger.index())
        };
        let mut last = None;
        for pair in strokes.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let roll = direction(a, b);
            if a.target != b.target {
                self.all += 1;
                self.same_finger += u64::from(a.hand == b.hand && a.finger == b.finger);
                self.alternating += u64::from(a.hand != b.hand);
                self.rolls += u64::from(roll.is_some());
                self.redirects += u64::from(last.is_some() && roll.is_some() && last != roll);
            }
            last = roll;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stroke(targets: &[u32], pressed: &[u32]) -> Stroke {
        Stroke {
            target: TargetId(targets[0]),
            finger: Finger::Index,
            hand: 0,
            kind: StrokeKind::Meant,
            targets: targets.iter().copied().map(TargetId).collect(),
            bottom: 1.0,
            distance: 0.0,
            point: Vec2::ZERO,
            shown: None,
            presses: pressed
                .iter()
                .map(|&id| (TargetId(id), Vec2::ZERO))
                .collect(),
        }
    }

    #[test]
    fn a_chord_hits_with_its_own_targets_only_and_a_key_also_beside_others() {
        for (targets, pressed, has_hit) in [
            (&[1][..], &[1][..], true),
            (&[1], &[2, 1], true),
            (&[1], &[2], false),
            (&[1], &[], false),
            (&[1, 2], &[2, 1], true),
            (&[1, 2], &[1, 3], false),
            (&[1, 2], &[1], false),
            (&[1, 2], &[1, 2, 3], false),
        ] {
            let mut observed = Observed::default();
            observed.add_strokes(&[stroke(targets, pressed)], |_, _| false);
            let hits: u64 = observed.keys.values().map(|key| key.hit).sum();
            assert_eq!(hits, u64::from(has_hit), "{targets:?} {pressed:?}");
        }
    }
}
