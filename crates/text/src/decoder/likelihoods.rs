//! The likelihoods of a tap for one hypothesis, each computed once: its letters are asked for again and again.

use super::touches::Touches;
use crate::keyboard::{MAX_KEYS, Millimetres};
use crate::model::alphabet::Symbol;
use crate::touch::Hands;

/// The log-likelihoods of a tap under a hypothesis of the displacement of the hands.
pub struct Likelihoods<'a> {
    touches: &'a Touches,
    tap: Millimetres,
    shifts: [Millimetres; 2],
    /// By key; not a number where it was not asked for.
    keys: [f32; MAX_KEYS],
}

impl<'a> Likelihoods<'a> {
    /// Starts a tap. [`assume`](Self::assume) has to follow.
    pub fn new(touches: &'a Touches, tap: Millimetres) -> Self {
        Self {
            touches,
            tap,
            shifts: [[0.0; 2]; 2],
            keys: [f32::NAN; MAX_KEYS],
        }
    }

    /// Starts a hypothesis.
    pub fn assume(&mut self, hands: &Hands) {
        self.shifts = self.touches.shifts(hands);
        self.keys[..self.touches.count()].fill(f32::NAN);
    }

    /// Returns the log-likelihood of the tap if it means a key.
    pub fn of_key(&mut self, key: usize) -> f32 {
        let Some(likelihood) = self.keys.get_mut(key) else {
            return f32::NEG_INFINITY;
        };
        if likelihood.is_nan() {
            *likelihood = self.touches.at(self.tap, key, &self.shifts);
        }
        *likelihood
    }

    /// Returns the log-likelihood of the tap if it means a letter, and the key; `None` if the keyboard has no key for it.
    pub fn of_letter(&mut self, symbol: Symbol) -> Option<(f32, usize)> {
        let touches = self.touches;
        touches.letter(symbol, |key| self.of_key(key))
    }
}
