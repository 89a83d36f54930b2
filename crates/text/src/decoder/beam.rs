//! The hypotheses after a tap, while they are collected: at most one for each place, none much worse than the best.

use super::token::Next;

/// The hypotheses that fit; further ones of a tap are dropped.
const CAPACITY: usize = 8_000;
/// The slots of the index, a power of two.
const SLOTS: usize = 1 << 14;

#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    key: u64,
    round: u32,
    index: u32,
}

/// The hypotheses of a tap.
#[derive(Clone, Debug)]
pub struct Beam {
    next: Vec<Next>,
    slots: Vec<Slot>,
    round: u32,
    width: f32,
    limit: f32,
}

impl Beam {
    pub fn new(width: f32) -> Self {
        Self {
            next: Vec::with_capacity(CAPACITY),
            slots: vec![Slot::default(); SLOTS],
            round: 0,
            width,
            limit: f32::NEG_INFINITY,
        }
    }

    /// Starts a tap.
    pub fn clear(&mut self) {
        self.next.clear();
        self.limit = f32::NEG_INFINITY;
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

    /// Adds a hypothesis.
    pub fn push(&mut self, next: Next) {
        let score = next.token.score;
        // Also refuses what is not a number.
        if !(score > self.limit && score.is_finite()) {
            return;
        }
        self.limit = self.limit.max(score - self.width);
        let key = next.token.key();
        let mut slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 50) as usize;
        loop {
            let found = &mut self.slots[slot];
            if found.round != self.round {
                if self.next.len() < CAPACITY {
                    *found = Slot {
                        key,
                        round: self.round,
                        index: self.next.len() as u32,
                    };
                    self.next.push(next);
                }
                return;
            }
            if found.key == key {
                let other = &mut self.next[found.index as usize];
                if other.token.score < score {
                    *other = next;
                }
                return;
            }
            slot = (slot + 1) % SLOTS;
        }
    }

    /// Returns the places of the last characters of the collected hypotheses.
    pub fn ends_mut(&mut self) -> impl Iterator<Item = &mut u32> {
        self.next.iter_mut().map(|next| &mut next.token.end)
    }

    /// Returns the best hypotheses, the very best first.
    pub fn best(&mut self, count: usize) -> &[Next] {
        let limit = self.limit;
        self.next.retain(|next| next.token.score > limit);
        if self.next.len() > count {
            self.next
                .select_nth_unstable_by(count, |a, b| b.token.score.total_cmp(&a.token.score));
            self.next.truncate(count);
        }
        let scores = self.next.iter().map(|next| next.token.score).enumerate();
        if let Some((first, _)) = scores.max_by(|a, b| a.1.total_cmp(&b.1)) {
            self.next.swap(0, first);
        }
        &self.next
    }
}
