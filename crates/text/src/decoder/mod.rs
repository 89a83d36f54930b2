//! The decoder: from taps to the text that they most probably mean.
//!
//! A hypothesis is a place in the lexicon, the word before, the characters so far and the displacement of the hands that fits them. With
//! each tap a hypothesis becomes several: the next letter, the end of the word, nothing at all (an insertion), a letter after one that was
//! left out (an omission), two letters in the wrong order, a new word without a space, or a letter of a word that is not in the
//! lexicon. Their score is
//!
//! ```text
//! Σ ln N(tap; key + offset + displacement, Σ) + λ Σ ln P(word | word before) + Σ cost of each error
//! ```
//!
//! and inside a word, ln P of the likeliest word that it can become. Hypotheses at the same place after the same word are one. After
//! each tap the best [`Options::beam`] are kept (Viterbi search, as in Goodman et al. 2002 and VelociTap, Vertanen et al. 2015). A
//! hypothesis is made only if its bound reaches the limit, which rises while better ones are found. Most letters are left out before they
//! are looked at: a node has the letters of its children in one number, and a tap the letters that it can mean at all.
//!
//! The typed characters are a hypothesis of their own, which is never dropped.

mod beam;
mod candidate;
mod expand;
mod finish;
#[cfg(test)]
pub(crate) mod fixture;
mod history;
mod learn;
mod likelihoods;
mod literal;
mod marks;
mod options;
mod precision;
mod reading;
mod render;
mod slips;
mod swiped;
mod token;
mod touches;

pub use candidate::Candidate;
pub use options::{MAX_BEAM, Options};
pub(crate) use swiped::Before;

use beam::Beam;
pub(crate) use candidate::same_letters;
use expand::{Expansion, spurious_cost, steps_per_weight, weights};
use finish::Finished;
use history::{Entry, History, NONE};
use learn::WordRates;
use likelihoods::Likelihoods;
use literal::Literal;
use render::Rendered;
use token::{From, Parent, Place, Token};
use touches::{Carried, Touches};

use crate::keyboard::{Keyboard, Tap};
use crate::model::alphabet::Symbol;
use crate::model::bigrams::{NO_ROW, Row};
use crate::model::lexicon::ROOT;
use crate::model::{Model, ends_sentence};
use crate::swipe::Swipes;
use crate::touch::TouchModel;

/// Maximum number of taps between two commits. The next tap commits first.
pub const MAX_TAPS: usize = 512;
/// Maximum number of candidates, in addition to the typed text.
pub const CANDIDATES: usize = 3;
/// Number of complete hypotheses from which the candidates are chosen.
const FINISHED: usize = 16;
/// Largest gain of the score of a hypothesis, in nats, by a word that is likelier after the word before than alone.
const GAIN: f32 = 8.0;
/// Number of hypotheses of the previous step that are tried for letters in the wrong order.
const TRANSPOSED: usize = 40;

/// The log-probability that unknown text ends with punctuation that has no space after it.
const AFTER_UNKNOWN: f32 = -3.0;
/// The number of taps that a sentence is assumed to have if typing starts in its unknown middle: a period is then as likely as a
/// comma.
const MIDDLE: u16 = 20;

/// The place in the text before the first tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// The start of a word.
    Word,
    /// After punctuation, before its space.
    AfterMark,
    /// Either of them.
    Anywhere,
}

/// Decodes the taps of a person on a keyboard.
///
/// ```
/// use ademan_text::{Decoder, Key, Keyboard, Model, Options, Prior, Tap, TouchModel, build::Builder};
///
/// let mut builder = Builder::new();
/// builder.words("cat\ncar\t3").expect("a list");
/// let bytes = builder.build()?;
/// let model = Model::from_bytes(&bytes)?;
/// let keys = "catr ".chars().zip(0_u8..).map(|(character, index)| Key {
///     character,
///     center: [f32::from(index) * 19.0, 0.0],
///     size: [19.0; 2],
///     hand: 0,
/// });
/// let mut decoder = Decoder::new(model, Keyboard::new(keys), TouchModel::new(Prior::default()), Options::default());
/// for x in [2.0, 20.0, 48.0] {
///     decoder.tap(Tap::at(x, 1.0));
/// }
/// assert_eq!(decoder.best(), "Car");
/// assert_eq!(decoder.typed(), "car");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Decoder<'m> {
    model: Model<'m>,
    keyboard: Keyboard,
    touch: TouchModel,
    options: Options,
    /// The options with what was learned.
    costs: Options,
    /// The part of a score for each stored log-probability.
    weights: [f32; 256],
    touches: Touches,
    apostrophe: Option<Symbol>,
    beam: Beam,
    history: History,
    tokens: Vec<Token>,
    previous: Vec<Token>,
    /// The hypotheses after the tap of this step.
    next: Vec<Token>,
    taps: Vec<Tap>,
    /// Taps that are decoded again.
    spare: Vec<Tap>,
    literal: Literal,
    /// The text at the last correction, and the taps until then; 0 without one.
    followed: String,
    followed_taps: usize,
    row: Row,
    /// The taps since the last sentence ended, up to the last commit.
    sentence: u16,
    starts_sentence: bool,
    start: Start,
    /// The knowledge of the touches before the first tap, for [`untap`](Self::untap).
    before: Carried,
    words: WordRates,
    finished: Vec<Finished>,
    rendered: Rendered,
    candidates: [Candidate; CANDIDATES],
    found: usize,
    /// The memory for paths, if the keyboard has them.
    swipes: Option<Swipes>,
}

impl<'m> Decoder<'m> {
    /// Creates a decoder at the start of a sentence.
    pub fn new(
        mut model: Model<'m>,
        keyboard: Keyboard,
        mut touch: TouchModel,
        options: Options,
    ) -> Self {
        touch.sanitize();
        touch.reserve(&keyboard);
        let options = options.sane();
        model.own_mut().reserve();
        let touches = Touches::new(&keyboard, &model.alphabet, &touch, &options);
        let candidate = || Candidate {
            text: String::with_capacity(8 * MAX_TAPS),
            score: 0.0,
        };
        let mut decoder = Self {
            apostrophe: model.alphabet.symbol('\''),
            row: NO_ROW,
            model,
            keyboard,
            touch,
            options,
            costs: options,
            weights: weights(&options),
            before: touches.carried(),
            words: WordRates::default(),
            touches,
            beam: Beam::new(options.width, options.beam),
            history: History::new(),
            tokens: Vec::with_capacity(options.beam),
            previous: Vec::with_capacity(options.beam),
            next: Vec::with_capacity(options.beam),
            taps: Vec::with_capacity(MAX_TAPS),
            spare: Vec::with_capacity(MAX_TAPS),
            literal: Literal::new(MAX_TAPS),
            followed: String::with_capacity(8 * MAX_TAPS),
            followed_taps: 0,
            sentence: 0,
            starts_sentence: true,
            start: Start::Word,
            finished: Vec::with_capacity(FINISHED + 1),
            rendered: Rendered::new(),
            candidates: std::array::from_fn(|_| candidate()),
            found: 0,
            swipes: None,
        };
        decoder.update_costs();
        decoder.start_sentence();
        decoder
    }

    /// Returns the touch model with what was learned.
    pub fn touch(&self) -> &TouchModel {
        &self.touch
    }

    /// Adds a word of the person, which taps may mean from now on.
    pub fn add_own_word(&mut self, word: &str) {
        self.model.add_own_word(word);
    }

    /// Drops all taps, and forgets what was learned about the person. Does not allocate.
    pub fn forget(&mut self) {
        self.model.own_mut().clear();
        self.words = WordRates::default();
        self.touch.reset();
        self.touch.reserve(&self.keyboard);
        self.touches.forget(&self.keyboard, &self.touch);
        self.update_costs();
        self.start_anywhere();
    }

    /// Drops all taps, and continues after unknown text with what another decoder has learned about the person.
    pub(crate) fn take_over(&mut self, before: &Decoder) {
        self.model.own_mut().take_over(before.model.own());
        self.touch = before.touch.clone();
        self.touch.reserve(&self.keyboard);
        self.words = before.words;
        self.touches.learn(&self.keyboard, &self.touch);
        self.update_costs();
        self.start_anywhere();
    }

    /// Returns the keyboard.
    pub fn keyboard(&self) -> &Keyboard {
        &self.keyboard
    }

    /// Returns the options.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Returns the model.
    pub fn model(&self) -> &Model<'m> {
        &self.model
    }

    /// Returns the number of taps since the last commit.
    pub fn taps(&self) -> usize {
        self.taps.len()
    }

    /// Drops all taps and starts a sentence, without learning.
    pub fn start_sentence(&mut self) {
        self.start_line();
        self.starts_sentence = true;
    }

    /// Drops all taps and continues after unknown text, without learning. The hands may have moved.
    pub fn start_anywhere(&mut self) {
        self.touches.lift();
        self.touch.hands.lift();
        self.row = NO_ROW;
        self.sentence = MIDDLE;
        self.starts_sentence = false;
        self.restart(Start::Anywhere);
    }

    /// Drops all taps and starts at the beginning of a line, without learning.
    pub fn start_line(&mut self) {
        self.row = self.model.row(ROOT);
        self.sentence = 0;
        self.starts_sentence = false;
        self.restart(Start::Word);
    }

    fn restart(&mut self, start: Start) {
        self.start = start;
        self.before = self.touches.carried();
        self.begin();
    }

    fn begin(&mut self) {
        self.history.clear();
        self.taps.clear();
        self.previous.clear();
        self.tokens.clear();
        self.literal.clear(self.row, self.sentence);
        self.followed_taps = 0;
        let token = Token {
            score: self.options.language * self.model.lexicon.node(ROOT).best(),
            place: Place::Word(ROOT),
            row: self.row,
            end: NONE,
            sentence: self.sentence,
            hands: self.touch.hands,
        };
        if self.start != Start::AfterMark {
            self.tokens.push(token);
        }
        if self.start != Start::Word {
            self.tokens.push(Token {
                score: match self.start {
                    Start::Anywhere => AFTER_UNKNOWN,
                    _ => 0.0,
                },
                place: Place::Gap,
                ..token
            });
        }
    }

    /// Decodes a tap. Positions that are not finite are ignored.
    pub fn tap(&mut self, tap: Tap) {
        if !tap.position.iter().all(|value| value.is_finite()) {
            return;
        }
        let Some((key, shown)) = self.typed_key(&tap) else {
            return;
        };
        if self.taps.len() == MAX_TAPS {
            self.commit();
        }
        let character = self.keyboard.keys()[key].character;
        let hands = self
            .tokens
            .first()
            .map_or(self.touch.hands, |token| token.hands);
        self.touches.refresh(&self.keyboard, &self.touch);
        self.touches.tap(tap.position, key, &hands);
        let typed = (key, character);
        self.literal.push(
            typed,
            shown,
            &self.model,
            &self.costs,
            &self.touches,
            &hands,
        );
        self.step(typed);
        self.touches.settle(key);
        self.taps.push(tap);
    }

    /// Returns the key of a tap and the character that it typed.
    fn typed_key(&self, tap: &Tap) -> Option<(usize, char)> {
        let nearest = self.keyboard.nearest(tap.position)?;
        let Some(typed) = tap.typed else {
            return Some((nearest, self.keyboard.keys()[nearest].character));
        };
        let mut lower = typed.to_lowercase();
        let lower = lower.next().unwrap_or(typed);
        Some((self.keyboard.index(lower).unwrap_or(nearest), typed))
    }

    fn step(&mut self, typed: (usize, char)) {
        let Some(&first) = self.tokens.first() else {
            return;
        };
        self.make_room();
        self.beam
            .start(first.score + self.touches.likeliest() + GAIN);
        let (_, character) = typed;
        let is_letter = self.model.alphabet.symbol(character).is_some();
        let mut expansion = Expansion {
            model: &self.model,
            options: &self.costs,
            touches: &self.touches,
            beam: &mut self.beam,
            likelihoods: Likelihoods::new(&self.touches, self.touches.position()),
            parent: first,
            apostrophe: self.apostrophe,
            typed,
            weights: &self.weights,
            steps_per_weight: steps_per_weight(&self.costs),
            spurious: spurious_cost(&self.touches, character),
            is_sign: !is_letter && character != ' ' && !marks::is_punctuation(character),
        };
        let nodes = self.tokens.iter().map(|token| match token.place {
            Place::Word(node) => node,
            _ => ROOT,
        });
        self.model.lexicon.fetch(nodes);
        for (index, token) in self.tokens.iter().enumerate() {
            expansion.expand(index, token);
        }
        if let Some(last) = self.taps.last() {
            let mut previous = Likelihoods::new(&self.touches, last.position);
            for (index, token) in self.previous.iter().take(TRANSPOSED).enumerate() {
                expansion.transpose(index, token, &mut previous);
            }
        }
        let now = self.taps.len() as u32;
        for next in self.beam.best() {
            let parent = match next.parent {
                Parent::Last(index) => &self.tokens[usize::from(index)],
                Parent::BeforeLast(index) => &self.previous[usize::from(index)],
            };
            let last = next.emission.last();
            let mut token = Token {
                score: next.score,
                place: next.place,
                row: next.row,
                end: parent.end,
                sentence: match last {
                    Some(last) if ends_sentence(last.character) => 0,
                    _ => parent.sentence.saturating_add(1),
                },
                hands: next.moved.map_or(parent.hands, |key| {
                    self.touches.moved(usize::from(key), &parent.hands)
                }),
            };
            for emitted in next.emission.items() {
                let tap = match emitted.from {
                    From::This => now,
                    From::Previous => now.saturating_sub(1),
                    From::None => NONE,
                };
                token.end = self.history.push(Entry {
                    previous: token.end,
                    tap,
                    character: emitted.character,
                    case: emitted.case,
                });
            }
            self.next.push(token);
        }
        std::mem::swap(&mut self.tokens, &mut self.previous);
        std::mem::swap(&mut self.tokens, &mut self.next);
        self.next.clear();
    }

    /// Drops characters that belong to no hypothesis, if little room is left.
    fn make_room(&mut self) {
        if self.history.has_room() {
            return;
        }
        for token in self.tokens.iter().chain(&self.previous) {
            self.history.keep(token.end);
        }
        self.history.sweep();
        for token in self.tokens.iter_mut().chain(&mut self.previous) {
            token.end = self.history.moved(token.end);
        }
        self.history.unmark();
    }

    /// Removes the last tap, by decoding the taps before it again: the time grows with their number.
    pub fn untap(&mut self) {
        if self.taps.pop().is_none() {
            return;
        }
        self.touches.restore(self.before);
        std::mem::swap(&mut self.taps, &mut self.spare);
        let followed_taps = self.followed_taps;
        self.begin();
        for index in 0..self.spare.len() {
            let tap = self.spare[index];
            self.tap(tap);
            if self.taps.len() == followed_taps {
                let shown = std::mem::take(&mut self.followed);
                self.finish();
                self.follow_known(&shown);
                (self.followed, self.followed_taps) = (shown, followed_taps);
            }
        }
        self.spare.clear();
    }

    /// Returns what was typed since the last commit.
    pub fn typed(&self) -> &str {
        self.literal.text()
    }
}
