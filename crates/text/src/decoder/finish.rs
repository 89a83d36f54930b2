//! The scores of hypotheses if the text ended here.

use super::expand::spelling_end;
use super::token::{Place, Token};
use super::{GAIN, Options};
use crate::logarithm::nats;
use crate::model::Model;
use crate::model::lexicon::{Case, ROOT};

/// A hypothesis as a complete text.
#[derive(Clone, Copy, Debug)]
pub struct Finished {
    /// The log-probability.
    pub score: f32,
    /// The last character of its chain.
    pub end: u32,
    /// A last letter that was not tapped.
    pub omitted: Option<char>,
    /// The case of its last word.
    pub case: Case,
    /// The node of its last word, if the lexicon has it.
    pub word: Option<u32>,
    /// The index.
    pub token: usize,
}

impl Finished {
    /// Returns a hypothesis as it is, with its last word as far as it was tapped.
    pub fn partial(index: usize, token: &Token) -> Self {
        Self {
            score: token.score,
            end: token.end,
            omitted: None,
            case: Case::Lower,
            word: None,
            token: index,
        }
    }
}

/// Calls `found` with each way in which a hypothesis can be complete, unless it is worse than a score for sure.
pub fn finish(
    model: &Model,
    options: &Options,
    index: usize,
    token: &Token,
    worst: f32,
    mut found: impl FnMut(Finished),
) {
    let plain = Finished::partial(index, token);
    let node = match token.place {
        Place::Word(node) => node,
        Place::Gap | Place::Verbatim => return found(plain),
        Place::Typed(state) | Place::Spelled(state) => {
            let is_typed = matches!(token.place, Place::Typed(_));
            return found(Finished {
                score: token.score + spelling_end(model, options, state, is_typed),
                ..plain
            });
        }
    };
    let best = |prefix: u32| options.language * model.lexicon.node(prefix).best();
    if node == ROOT {
        return found(Finished {
            score: token.score - best(ROOT),
            ..plain
        });
    }
    // Without the part that stands for the word to come.
    let score = token.score - best(node);
    let mut word = |end: u32, cost: f32, is_omitted: bool| {
        let branch = model.lexicon.branch(end);
        let likeliest = options.language * nats(branch.word);
        // Before the look-ups of the word and the pair: how likely they can be at most.
        if branch.word == 0 || score + likeliest + cost < worst {
            return;
        }
        let contents = model.lexicon.node(end);
        let Some(alone) = contents.word() else { return };
        let most = options.language * (alone + GAIN).min(0.0);
        if score + most + cost < worst {
            return;
        }
        let probability = options.language * model.bigrams.after(token.row, end, alone);
        found(Finished {
            score: score + probability + cost,
            omitted: is_omitted.then(|| model.alphabet.letter(contents.symbol())),
            case: contents.case(),
            word: Some(end),
            ..plain
        });
    };
    word(node, 0.0, false);
    if score + options.omission < worst {
        return;
    }
    for child in model.lexicon.child_range(node) {
        word(child, options.omission, true);
    }
}
