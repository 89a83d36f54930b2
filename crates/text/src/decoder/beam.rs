//! The hypotheses after a tap, while they are collected: at most one for each place, none much worse than the best.
//!
//! A histogram of the scores raises the limit as soon as enough better hypotheses were seen, so that most of the others are dropped
//! before they are made.

use super::options::MAX_BEAM;
use super::token::Next;

/// The hypotheses that fit, for each that is kept and at least; further ones of a tap are dropped.
const CAPACITY: usize = 4;
const LEAST_CAPACITY: usize = 4_000;
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
    order: Vec<(f32, u32)>,
    slots: Vec<Slot>,
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
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            self.slots.fill(Slot::default());
            self.round = 1;
        }
    }

    /// Returns the score below which a hypothesis is dropped.
    pub fn limit(&self) -> f32 {
        self.limit
    }

    fn bin(&self, score: f32) -> usize {
        // A conversion of a negative number gives 0.
        (((self.ceiling - score) * BINS_PER_NAT) as usize).min(BINS - 1)
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
        let last = self.slots.len() - 1;
        let mut slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as usize & last;
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
            slot = (slot + 1) & last;
        }
    }

    /// Returns the best hypotheses, the best first.
    pub fn best(&mut self) -> impl Iterator<Item = &Next> {
        let limit = self.limit;
        self.order.clear();
        for (index, next) in self.next.iter().enumerate() {
            if next.score > limit {
                self.order.push((next.score, index as u32));
            }
        }
        self.order
            .sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        self.order.truncate(self.count);
        self.order
            .iter()
            .map(|&(_, index)| &self.next[index as usize])
    }
}
