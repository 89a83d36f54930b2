//! Probabilities of a letter after the letters before it, for words that no lexicon has.
//!
//! An automaton: a state stands for the last letters of a word, an arc for the next one. A letter without an arc is looked up in the
//! state of one letter less, which costs the weight of the state. The first state knows no letter before and has an arc for each.

use super::ModelError;
use super::alphabet::Symbol;
use super::bytes::{u16_at, u32_at};
use crate::logarithm::nats;

/// The bytes of a state: the index of its first arc and its weight in one number, then the state of one letter less.
pub const STATE_BYTES: usize = 6;
/// The bytes of an arc: letter, probability, next state.
pub const ARC_BYTES: usize = 4;

/// A state: the letters before the next one.
pub type State = u16;

/// The state without a letter before.
const EMPTY: State = 0;
/// The state at the start of a word.
pub const START: State = 1;

/// The spelling of a language.
#[derive(Clone, Copy, Debug)]
pub struct Spelling<'a> {
    states: &'a [u8],
    arcs: &'a [u8],
    end: Symbol,
}

impl<'a> Spelling<'a> {
    pub(super) fn read(
        states: &'a [u8],
        arcs: &'a [u8],
        symbols: usize,
    ) -> Result<Self, ModelError> {
        let spelling = Self {
            states,
            arcs,
            end: symbols as Symbol,
        };
        let count = (states.len() / STATE_BYTES).saturating_sub(1);
        if !states.len().is_multiple_of(STATE_BYTES)
            || count < 2
            || !arcs.len().is_multiple_of(ARC_BYTES)
        {
            return Err(ModelError::Damaged("the size of the spelling"));
        }
        let last = (arcs.len() / ARC_BYTES) as u32;
        for state in 0..count {
            let ordered = spelling.first_arc(state) <= spelling.first_arc(state + 1);
            // A state of one letter less lies before, so that looking up ends.
            let shorter = state == 0 || usize::from(spelling.shorter(state as State)) < state;
            if !ordered || !shorter {
                return Err(ModelError::Damaged("the order of the spelling"));
            }
        }
        let all = spelling.first_arc(1) as usize == symbols + 1 && spelling.first_arc(0) == 0;
        let within = (0..last).all(|arc| usize::from(spelling.next(arc)) < count);
        if !all || !within || spelling.first_arc(count) != last {
            return Err(ModelError::Damaged("an arc of the spelling"));
        }
        Ok(spelling)
    }

    fn first_arc(&self, state: usize) -> u32 {
        u32_at(self.states, state * STATE_BYTES) >> 8
    }

    fn weight(&self, state: State) -> f32 {
        nats(u32_at(self.states, usize::from(state) * STATE_BYTES) as u8)
    }

    fn shorter(&self, state: State) -> State {
        u16_at(self.states, usize::from(state) * STATE_BYTES + 4)
    }

    fn next(&self, arc: u32) -> State {
        u16_at(self.arcs, arc as usize * ARC_BYTES + 2)
    }

    /// Returns the log-probability of a letter in a state, and the next state.
    pub fn letter(&self, state: State, symbol: Symbol) -> (f32, State) {
        let (mut state, mut sum) = (state, 0.0);
        loop {
            let range = self.first_arc(state.into())..self.first_arc(usize::from(state) + 1);
            for arc in range {
                let offset = arc as usize * ARC_BYTES;
                if self.arcs.get(offset) == Some(&symbol) {
                    let probability = self.arcs.get(offset + 1).copied().unwrap_or(255);
                    return (sum + nats(probability), self.next(arc));
                }
            }
            if state == EMPTY {
                return (sum + nats(255), EMPTY);
            }
            sum += self.weight(state);
            state = self.shorter(state);
        }
    }

    /// Returns the log-probability that a word ends in a state.
    pub fn end(&self, state: State) -> f32 {
        self.letter(state, self.end).0
    }
}
