//! The hypotheses after a tap, while they are collected: at most one for each place, none much worse than the best.
//!
//! A histogram of the scores raises the limit as soon as enough better hypotheses were seen, so that most of the others are dropped
//! before they are made.

use super::options::MAX_BEAM;
use super::token::Next;

/// The hypotheses that fit, for each that is kept and at least; further ones of a tap are dropped.
const CAPACITY: usize = 4;
const LEAST_CAPACITY: usize = 4_000;
/// The slots of the hash table at the start of a tap; it grows with the hypotheses.
const LEAST_SLOTS: usize = 1_024;
// A slot has 16 bits for an index.
const _: () = assert!(CAPACITY * MAX_BEAM <= 1 << 16 && LEAST_CAPACITY <= 1 << 16);
/// The bins of the histogram.
const BINS: usize = 1_024;
/// The bins of a nat.
const BINS_PER_NAT: f32 = 16.0;

/// A place of the hash table, small so that the table stays in the fastest cache.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    /// The round in which it was used.
    round: u16,
    index: u16,
}

/// The hypotheses of a tap.
#[derive(Clone, Debug)]
pub struct Beam {
    /// The most hypotheses of a tap.
    capacity: usize,
    next: Vec<Next>,
    /// Scores and indices in numbers that increase with worse scores.
    order: Vec<u64>,
    slots: Vec<Slot>,
    /// The number of slots of this tap, less one.
    last_slot: usize,
    round: u16,
    width: f32,
    count: usize,
    limit: f32,
    /// The score of the upper edge of the first bin.
    ceiling: f32,
    /// The number of hypotheses that were collected of each bin.
    bins: Vec<u32>,
    /// The last bin that is kept, and the hypotheses until there.
    cut: usize,
    kept: usize,
}

impl Beam {
    pub fn new(width: f32, count: usize) -> Self {
        let capacity = (CAPACITY * count).max(LEAST_CAPACITY);
        Self {
            capacity,
            next: Vec::with_capacity(capacity),
            order: Vec::with_capacity(capacity),
            slots: vec![Slot::default(); (2 * capacity).next_power_of_two()],
            last_slot: LEAST_SLOTS - 1,
            round: 0,
            width,
            count,
            limit: f32::NEG_INFINITY,
            ceiling: 0.0,
            bins: vec![0; BINS],
            cut: BINS - 1,
            kept: 0,
        }
    }

    /// Starts a tap whose hypotheses have scores below a ceiling, more or less.
    pub fn start(&mut self, ceiling: f32) {
        self.next.clear();
        self.limit = f32::NEG_INFINITY;
        self.ceiling = ceiling;
        self.bins.fill(0);
        self.cut = BINS - 1;
        self.kept = 0;
        self.last_slot = LEAST_SLOTS - 1;
        self.start_round();
    }

    /// Empties the hash table.
    fn start_round(&mut self) {
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            self.slots.fill(Slot::default());
            self.round = 1;
        }
    }

    /// Returns the slot of a hypothesis if there is no other one in its place.
    fn slot(&self, key: u64) -> usize {
        (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as usize & self.last_slot
    }

    /// Doubles the hash table.
    #[cold]
    fn grow(&mut self) {
        self.last_slot = 2 * self.last_slot + 1;
        self.start_round();
        for index in 0..self.next.len() {
            let mut slot = self.slot(self.next[index].key());
            while self.slots[slot].round == self.round {
                slot = (slot + 1) & self.last_slot;
            }
            self.slots[slot] = Slot {
                round: self.round,
                index: index as u16,
            };
        }
    }

    /// Returns the score below which a hypothesis is dropped.
    pub fn limit(&self) -> f32 {
        self.limit
    }

    fn bin(&self, score: f32) -> usize {
        // A conversion saturates.
        (((self.ceiling - score) * BINS_PER_NAT) as i32).clamp(0, BINS as i32 - 1) as usize
    }

    /// Counts a score, and raises the limit to the worst bin that is needed.
    fn count(&mut self, score: f32) {
        let bin = self.bin(score);
        self.bins[bin] += 1;
        if bin <= self.cut {
            self.kept += 1;
        }
        while self.cut > 0 && self.kept - self.bins[self.cut] as usize >= self.count {
            self.kept -= self.bins[self.cut] as usize;
            self.cut -= 1;
        }
        if self.cut < BINS - 1 {
            let edge = self.ceiling - (self.cut + 1) as f32 / BINS_PER_NAT;
            self.limit = self.limit.max(edge);
        }
    }

    fn uncount(&mut self, score: f32) {
        let bin = self.bin(score);
        self.bins[bin] -= 1;
        if bin <= self.cut {
            self.kept -= 1;
        }
    }

    /// Adds a hypothesis.
    pub fn push(&mut self, next: Next) {
        let score = next.score;
        // Also refuses what is not a number.
        if !(score > self.limit && score.is_finite()) {
            return;
        }
        self.limit = self.limit.max(score - self.width);
        let key = next.key();
        let mut slot = self.slot(key);
        loop {
            let found = &mut self.slots[slot];
            if found.round != self.round {
                if self.next.len() < self.capacity {
                    *found = Slot {
                        round: self.round,
                        index: self.next.len() as u16,
                    };
                    self.next.push(next);
                    self.count(score);
                    if 2 * self.next.len() > self.last_slot + 1 {
                        self.grow();
                    }
                }
                return;
            }
            let other = &mut self.next[usize::from(found.index)];
            if other.key() == key {
                let worse = other.score;
                if worse < score {
                    *other = next;
                    self.uncount(worse);
                    self.count(score);
                }
                return;
            }
            slot = (slot + 1) & self.last_slot;
        }
    }

    /// Returns the best hypotheses, the best first.
    pub fn best(&mut self) -> impl Iterator<Item = &Next> {
        let limit = self.limit;
        self.order.clear();
        for (index, next) in self.next.iter().enumerate() {
            if next.score > limit {
                self.order
                    .push(u64::from(descending(next.score)) << 32 | index as u64);
            }
        }
        self.order.sort_unstable();
        self.order.truncate(self.count);
        self.order
            .iter()
            .map(|&ordered| &self.next[ordered as u32 as usize])
    }
}

/// Returns a number that is smaller for a larger score.
fn descending(score: f32) -> u32 {
    let bits = score.to_bits();
    if score.is_sign_negative() {
        bits
    } else {
        !(bits | 1 << 31)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decoder::token::{Emission, Parent, Place};
    use crate::model::bigrams::NO_ROW;

    fn next(node: u32, score: f32) -> Next {
        Next {
            score,
            place: Place::Word(node),
            row: NO_ROW,
            parent: Parent::Last(0),
            moved: None,
            emission: Emission::NOTHING,
        }
    }

    #[test]
    fn a_place_is_found_again_after_the_table_has_grown() {
        let mut beam = Beam::new(100.0, 2_000);
        beam.start(0.0);
        let score = |node: u32| -1.0 - node as f32 / 1_000.0;
        for node in 0..1_500 {
            beam.push(next(node, score(node) - 0.5));
        }
        for node in 0..1_500 {
            beam.push(next(node, score(node)));
            beam.push(next(node, score(node) - 0.7));
        }
        let best: Vec<_> = beam.best().map(|next| (next.node(), next.score)).collect();
        let expected: Vec<_> = (0..1_500).map(|node| (node, score(node))).collect();
        assert_eq!(best, expected);
    }

    #[test]
    fn hypotheses_fill_half_of_a_table_that_cannot_grow_and_further_ones_are_dropped() {
        let mut beam = Beam::new(100.0, 1_024);
        assert_eq!(beam.slots.len(), 2 * beam.capacity);
        beam.start(0.0);
        for node in 0..5_000 {
            beam.push(next(node, -1.0));
        }
        assert_eq!(beam.next.len(), beam.capacity);
        let best: Vec<_> = beam.best().map(Next::node).collect();
        let expected: Vec<u32> = (0..1_024).collect();
        assert_eq!(best, expected);
    }

    #[test]
    fn scores_are_in_falling_order_with_the_first_of_equal_ones_first() {
        let scores = [-2.5, 3.0, -2.5, 0.0, -0.0, 1e-20, -7.0];
        let mut beam = Beam::new(100.0, 10);
        beam.start(4.0);
        for (node, score) in (0..).zip(scores) {
            beam.push(next(node, score));
        }
        let best: Vec<_> = beam.best().map(Next::node).collect();
        assert_eq!(best, [1, 5, 3, 4, 0, 2, 6]);
    }
}
