//! The likelihood of a tap for each key, and the displacement of the hands.

use super::marks::is_punctuation;
use super::precision::Precision;
use crate::keyboard::{Keyboard, MAX_KEYS, Millimetres};
use crate::model::alphabet::{Alphabet, Symbol, plain};
use crate::model::branches::{Letters, bit};
use crate::touch::{Correlations, Hands, Spread, TouchModel};

/// A key as the decoder needs it for one tap.
#[derive(Clone, Copy, Debug)]
struct KeyTouch {
    spread: Spread,
    /// The inverse of the covariance around the expected place, with the uncertainty of the drift.
    inverse: [f32; 3],
    /// The logarithm of the density at the mean.
    peak: f32,
    hand: usize,
    /// The fraction of a residual, beyond what lasts of the last scatter, that is drift, along each axis; 0 along a space bar.
    gain: Millimetres,
    /// The largest residual that counts as drift, in millimetres along each axis.
    reach: Millimetres,
    wide: bool,
    /// `false` if a tap tells nothing about the hand.
    has_place: bool,
    size: Millimetres,
}

/// The knowledge from the previous taps.
#[derive(Clone, Copy, Debug)]
pub struct Carried {
    /// The variance of the drift of each hand.
    variance: [f32; 2],
    /// The last tap and the size of its key.
    last: Option<(Millimetres, Millimetres)>,
    precision: Precision,
}

/// The keys on which a letter is typed: its own key, the key of its plain letter, or both.
#[derive(Clone, Copy, Debug, Default)]
struct LetterKeys {
    own: Option<u8>,
    plain: Option<u8>,
}

/// A key near a tap.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// The character.
    pub character: char,
    /// The letter, if it types one.
    pub symbol: Option<Symbol>,
    /// The index.
    pub key: usize,
}

/// The touch model of a keyboard for the current tap.
#[derive(Clone, Debug)]
pub struct Touches {
    keys: Vec<KeyTouch>,
    letters: Vec<LetterKeys>,
    symbols: Vec<Option<Symbol>>,
    characters: Vec<char>,
    space: Option<usize>,
    floor: f32,
    area: f32,
    plain_cost: f32,
    carried: Carried,
    first_variance: f32,
    step: f32,
    correlations: Correlations,
    tap: Millimetres,
    near: Vec<Near>,
    /// The near keys that type punctuation or an apostrophe.
    marks: Vec<Near>,
    likeliest: f32,
    /// The score of the tap if it means nothing, without its cost.
    stray: f32,
    /// The largest log-likelihood of a key that ends a word.
    separator: f32,
    /// An upper bound, by letter, of the log-likelihood of the tap for any hypothesis that counts.
    bounds: Vec<f32>,
    /// By a number of steps: the letters whose bound is at most that far below the largest bound. The first entry has none, the last one
    /// all letters with a key.
    reachable: [Letters; STEPS],
    /// The largest bound.
    largest: f32,
    /// The largest log-likelihood that any tap can have.
    peak: f32,
}

/// The steps of the bounds by which letters are looked up, and the steps of a nat.
const STEPS: usize = 80;
const STEPS_PER_NAT: f32 = 4.0;
/// More than the rounding error of a difference of scores, in nats.
pub const ROUNDING: f32 = 0.06;

/// The largest gain in log-likelihood of a tap by another hypothesis of the displacement than the best one.
pub const SLACK: f32 = 1.0;
/// The fraction of spurious taps that land near the tap before.
const STRAY_NEAR: f32 = 0.8;
/// The spread of the spurious taps near the tap before, as a multiple of the size of a key.
const STRAY_SPREAD: f32 = 0.9;
/// The log-weight of the wide part of the scatter, ln(1 / 22) − 2 ln 2: one tap in 22 scatters twice as widely as the others, because
/// taps of people have heavier tails than a normal distribution.
const TAIL: f32 = -4.5;
/// Largest difference in log-likelihood of a near key from the likeliest key.
const NEAR: f32 = 8.0;

impl Touches {
    pub fn new(
        keyboard: &Keyboard,
        alphabet: &Alphabet,
        touch: &TouchModel,
        options: &super::Options,
    ) -> Self {
        let key_of = |letter: char| keyboard.index(letter).map(|index| index as u8);
        let letters = alphabet.letters().iter().map(|&letter| LetterKeys {
            own: key_of(letter),
            plain: (plain(letter) != letter)
                .then(|| key_of(plain(letter)))
                .flatten(),
        });
        let characters: Vec<char> = keyboard.keys().iter().map(|key| key.character).collect();
        let mut touches = Self {
            keys: Vec::with_capacity(characters.len()),
            letters: letters.collect(),
            symbols: characters
                .iter()
                .map(|&letter| alphabet.symbol(letter))
                .collect(),
            space: keyboard.index(' '),
            near: Vec::with_capacity(characters.len()),
            marks: Vec::with_capacity(characters.len()),
            characters,
            floor: options.substitution - keyboard.area().ln(),
            plain_cost: options.plain,
            carried: Carried {
                variance: [touch.prior.first_drift.powi(2); 2],
                last: None,
                precision: Precision::new(&touch.prior),
            },
            stray: 0.0,
            separator: 0.0,
            bounds: vec![0.0; alphabet.len()],
            reachable: [0; STEPS],
            largest: 0.0,
            peak: 0.0,
            area: keyboard.area(),
            first_variance: touch.prior.first_drift.powi(2),
            step: touch.prior.drift.powi(2),
            correlations: touch.correlations(),
            tap: [0.0; 2],
            likeliest: 0.0,
        };
        touches.learn(keyboard, touch);
        touches
    }

    /// Computes the keys from the learned touch model.
    pub fn learn(&mut self, keyboard: &Keyboard, touch: &TouchModel) {
        self.correlations = touch.correlations();
        self.keys.clear();
        let spreads = touch.spreads_of(keyboard, self.carried.precision.take());
        for (spread, key) in spreads.zip(keyboard.keys()) {
            self.keys.push(KeyTouch {
                spread,
                inverse: [0.0; 3],
                peak: 0.0,
                hand: usize::from(key.hand.min(1)),
                gain: [0.0; 2],
                reach: [0.0; 2],
                wide: key.size[0] > 2.0 * key.size[1],
                has_place: key.has_place(),
                size: key.size,
            });
        }
    }

    /// Returns to the prior, for an unknown person.
    pub fn forget(&mut self, keyboard: &Keyboard, touch: &TouchModel) {
        self.carried.precision = Precision::new(&touch.prior);
        self.lift();
        self.learn(keyboard, touch);
    }

    /// Forgets the position of the last tap and how well the drift is known, after the hands were lifted.
    pub fn lift(&mut self) {
        self.carried.variance = [self.first_variance; 2];
        self.carried.last = None;
    }

    /// Computes the keys again if the last taps show another precision than the one that the keys were computed with.
    pub fn refresh(&mut self, keyboard: &Keyboard, touch: &TouchModel) {
        if self.carried.precision.has_changed() {
            self.learn(keyboard, touch);
        }
    }

    pub fn carried(&self) -> Carried {
        self.carried
    }

    pub fn restore(&mut self, carried: Carried) {
        let precision = carried.precision.for_keys_of(&self.carried.precision);
        self.carried = Carried {
            precision,
            ..carried
        };
    }

    /// Starts a tap under a hypothesis of the displacement of the hands.
    pub fn tap(&mut self, tap: Millimetres, nearest: usize, hands: &Hands) {
        self.tap = tap;
        for variance in &mut self.carried.variance {
            *variance += self.step;
        }
        for key in &mut self.keys {
            // The variance that is left when the last tap is known.
            let fresh = 1.0 - self.correlations.with(hands, key.hand).powi(2);
            let [xx, yy, xy] = key.spread.covariance.map(|value| value * fresh);
            let variance = self.carried.variance[key.hand];
            for (axis, own) in [xx, yy].into_iter().enumerate() {
                let spread = variance + own;
                key.gain[axis] = if !key.has_place || key.wide && axis == 0 {
                    0.0
                } else {
                    variance / spread
                };
                key.reach[axis] = 3.0 * spread.sqrt();
            }
            let (xx, yy) = (xx + variance, yy + variance);
            let determinant = xx * yy - xy * xy;
            key.inverse = [yy / determinant, xx / determinant, -xy / determinant];
            key.peak = -(std::f32::consts::TAU.ln() + 0.5 * determinant.ln());
        }
        let peaks = self.keys.iter().map(|key| key.peak);
        self.peak = peaks.fold(self.floor, f32::max);
        let shifts = self.shifts(hands);
        let mut likelihoods = [f32::NEG_INFINITY; MAX_KEYS];
        for (key, likelihood) in likelihoods[..self.keys.len()].iter_mut().enumerate() {
            *likelihood = self.at(tap, key, &shifts);
        }
        let likelihoods = &likelihoods[..self.keys.len()];
        let all = likelihoods.iter().copied().enumerate();
        let likeliest = all.max_by(|(_, a), (_, b)| a.total_cmp(b));
        let (likeliest, largest) = likeliest.unwrap_or((nearest, f32::NEG_INFINITY));
        self.likeliest = largest;
        for symbol in 0..self.bounds.len() {
            let letter = self.letter(symbol as Symbol, |key| likelihoods[key]);
            self.bounds[symbol] =
                letter.map_or(f32::NEG_INFINITY, |(likelihood, _)| likelihood + SLACK);
        }
        self.find_reachable();
        self.stray = self.stray_density();
        self.separator = (0..self.keys.len())
            .filter(|&key| {
                matches!(self.characters[key], ' ' | '\'') || is_punctuation(self.characters[key])
            })
            .map(|key| likelihoods[key])
            .fold(f32::NEG_INFINITY, f32::max);
        let meant = self.keys[likeliest];
        if meant.has_place && !meant.wide {
            let shift = self.correlations.expected(hands, meant.hand);
            self.carried.precision.add(std::array::from_fn(|axis| {
                tap[axis] - meant.spread.mean[axis] - shift[axis]
            }));
        }
        self.carried.last = Some((tap, self.keys[nearest].size));
        self.near.clear();
        for (key, &likelihood) in likelihoods.iter().enumerate() {
            if key == nearest || likelihood > self.likeliest - NEAR {
                self.near.push(Near {
                    character: self.characters[key],
                    symbol: self.symbols[key],
                    key,
                });
            }
        }
        self.marks.clear();
        let is_mark = |near: &&Near| near.character == '\'' || is_punctuation(near.character);
        self.marks.extend(self.near.iter().filter(is_mark));
    }

    /// Reduces the uncertainty of the drift of a hand after the tap of this step.
    pub fn settle(&mut self, nearest: usize) {
        let key = self.keys[nearest];
        if !key.has_place {
            return;
        }
        let variance = &mut self.carried.variance[key.hand];
        let noise = (key.spread.covariance[0] * key.spread.covariance[1]).sqrt();
        *variance *= noise / (*variance + noise);
    }

    /// Returns the mean of the taps of a key, without the displacement of the hands.
    pub fn mean(&self, key: usize) -> Option<Millimetres> {
        self.keys.get(key).map(|key| key.spread.mean)
    }

    /// Returns the keys near the tap.
    pub fn near(&self) -> &[Near] {
        &self.near
    }

    /// Returns the keys near the tap that type punctuation or an apostrophe.
    pub fn marks(&self) -> &[Near] {
        &self.marks
    }

    /// Returns the log-density of the tap if it means nothing: near the tap before, or anywhere.
    fn stray_density(&self) -> f32 {
        let anywhere = 1.0 / self.area;
        let Some((last, size)) = self.carried.last else {
            return anywhere.ln();
        };
        let size = size[0].min(size[1]) * STRAY_SPREAD;
        let [x, y] = [self.tap[0] - last[0], self.tap[1] - last[1]];
        let variance = size * size;
        let near = (-0.5 * (x * x + y * y) / variance).exp() / (std::f32::consts::TAU * variance);
        (STRAY_NEAR * near + (1.0 - STRAY_NEAR) * anywhere).ln()
    }

    /// Returns the largest log-likelihood of a key that ends a word.
    pub fn separator(&self) -> f32 {
        self.separator
    }

    /// Returns the log-likelihood of the tap if it means nothing, without its cost.
    pub fn stray(&self) -> f32 {
        self.stray
    }

    /// Returns an upper bound of the log-likelihood of the tap for a letter, for any likely displacement.
    pub fn bound(&self, symbol: Symbol) -> f32 {
        self.bounds
            .get(usize::from(symbol))
            .copied()
            .unwrap_or(f32::NEG_INFINITY)
    }

    /// Collects the letters by their bounds.
    fn find_reachable(&mut self) {
        let bounds = self.bounds.iter().copied();
        self.largest = bounds.fold(f32::NEG_INFINITY, f32::max);
        self.reachable = [0; STEPS];
        for (symbol, &bound) in self.bounds.iter().enumerate() {
            if bound > f32::NEG_INFINITY {
                let step = ((self.largest - bound) * STEPS_PER_NAT) as usize + 1;
                self.reachable[step.min(STEPS - 1)] |= bit(symbol as Symbol);
            }
        }
        for step in 1..STEPS {
            self.reachable[step] |= self.reachable[step - 1];
        }
    }

    /// Returns the letters whose [`bound`](Self::bound) exceeds a number, and maybe some more.
    pub fn reachable(&self, least: f32) -> Letters {
        let step = (self.largest - least + ROUNDING) * STEPS_PER_NAT + 1.0;
        self.reachable[(step as i32).clamp(0, STEPS as i32 - 1) as usize]
    }

    /// Returns the largest log-likelihood that this tap, or another one in its place, can have.
    pub fn peak(&self) -> f32 {
        self.peak
    }

    /// Returns the largest log-likelihood of any key.
    pub fn likeliest(&self) -> f32 {
        self.likeliest
    }

    /// Returns the smallest log-likelihood of a tap for a key: of a tap far from the key.
    pub fn anywhere(&self) -> f32 {
        self.floor
    }

    /// Returns the log-likelihood of the tap if it means a key.
    pub fn of_key(&self, key: usize, hands: &Hands) -> f32 {
        self.at(self.tap, key, &self.shifts(hands))
    }

    /// Returns the expected distance of a tap of each hand from the mean of its key.
    pub fn shifts(&self, hands: &Hands) -> [Millimetres; 2] {
        [0, 1].map(|hand| self.correlations.expected(hands, hand))
    }

    /// Returns the log-likelihood of a tap if it means a key, with the [`shifts`](Self::shifts) of the hands.
    pub fn at(&self, tap: Millimetres, key: usize, shifts: &[Millimetres; 2]) -> f32 {
        let Some(key) = self.keys.get(key) else {
            return f32::NEG_INFINITY;
        };
        let shift = shifts[key.hand];
        let x = tap[0] - key.spread.mean[0] - shift[0];
        let y = tap[1] - key.spread.mean[1] - shift[1];
        let [xx, yy, xy] = key.inverse;
        let distance = x * x * xx + y * y * yy + 2.0 * x * y * xy;
        let near = key.peak - 0.5 * distance;
        let far = key.peak + TAIL - 0.125 * distance;
        near.max(far).max(self.floor)
    }

    /// Returns the log-likelihood of a tap if it means a letter, and the key, from the log-likelihood of each key; `None` if the keyboard
    /// has no key for the letter.
    pub fn letter(
        &self,
        symbol: Symbol,
        mut of_key: impl FnMut(usize) -> f32,
    ) -> Option<(f32, usize)> {
        let keys = self.letters.get(usize::from(symbol))?;
        let own = keys.own.map(|key| (of_key(key.into()), usize::from(key)));
        let plain = keys.plain.map(|key| {
            let cost = if own.is_some() { self.plain_cost } else { 0.0 };
            (of_key(key.into()) + cost, usize::from(key))
        });
        match (own, plain) {
            (Some(own), Some(plain)) => Some(if plain.0 > own.0 { plain } else { own }),
            (own, plain) => own.or(plain),
        }
    }

    /// Returns the number of keys.
    pub fn count(&self) -> usize {
        self.keys.len()
    }

    /// Returns the position of the tap.
    pub fn position(&self) -> Millimetres {
        self.tap
    }

    /// Returns the index of the space bar.
    pub fn space(&self) -> Option<usize> {
        self.space
    }

    /// Returns the displacement of the hands after the tap meant a key.
    pub fn moved(&self, key: usize, hands: &Hands) -> Hands {
        let Some(key) = self.keys.get(key) else {
            return *hands;
        };
        let correlation = self.correlations.with(hands, key.hand);
        let mut moved = Hands {
            last: key.hand as u8,
            ..*hands
        };
        for axis in 0..2 {
            let drift = &mut moved.drift[key.hand][axis];
            let lasting = correlation * hands.scatter[axis];
            let scatter = self.tap[axis] - key.spread.mean[axis] - *drift;
            let surprise = scatter - lasting;
            // A slip to another key is not drift.
            let followed = if surprise.abs() < key.reach[axis] {
                key.gain[axis] * surprise
            } else {
                0.0
            };
            *drift += followed;
            moved.scatter[axis] = if !key.has_place || key.wide && axis == 0 {
                lasting
            } else {
                (scatter - followed).clamp(-key.reach[axis], key.reach[axis])
            };
        }
        moved
    }
}
