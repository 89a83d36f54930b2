//! The model that reads fingers from the movement of a hand: networks, whose mean counts.

use super::features::{Movement, NUMBERS};
use super::{PICTURES, TapClip};
use crate::hand::{Finger, FingerSet};

/// The first bytes of a file of weights.
const MAGIC: &[u8; 8] = b"ademtap2";

/// The shipped weights.
const SHIPPED: &[u8] = include_bytes!("weights.bin");

/// The largest number of inputs and outputs of a layer; a file with more is not of this program.
const MAX_WIDTH: usize = 1_024;
/// The largest number of networks of a kind.
const MAX_NETWORKS: usize = 16;

/// The number of sets of fingers.
pub const SETS: usize = 1 << Finger::COUNT;

/// The shifts in pictures for which a clip is read; their mean counts.
const SHIFTS: [f32; 3] = [-0.5, 0.0, 0.5];
/// The part that networks without convolutions have in the mean.
const DENSE_PART: f32 = 0.25;
/// A hand whose fingertips move less than this, in breadths of the palm, taps with none.
const LEAST_MOVEMENT: f32 = 0.14;

/// The first moment that networks see, in pictures from the onset. Those with convolutions see as many as a clip has.
const FIRST_MOMENT: isize = -6;
/// The moments that the other networks see, among them: from the fourth picture before the onset to the seventh after it.
const DENSE_MOMENTS: std::ops::Range<usize> = 2..14;
/// The layers of a network: three convolutions of three pictures and two layers, or three layers.
const CONVOLVED_LAYERS: usize = 5;
const DENSE_LAYERS: usize = 3;
const CONVOLUTIONS: usize = 3;
const CONVOLUTION: usize = 3;
/// Number of pairs of pictures after the convolutions. The larger value of each pair is passed on.
const PAIRS: usize = PICTURES / 2;

/// The reason why bytes are not a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TapModelError {
    /// The bytes are not such a file.
    #[error(
        "not a model of finger taps; make one with `train.py`, which stands beside the weights"
    )]
    NotAModel,
    /// The file ends early, has bytes left, or has layers that do not fit each other.
    #[error(
        "the model of finger taps is damaged; make it again with `train.py`, which stands beside the weights"
    )]
    Damaged,
}

/// A layer: a matrix with an offset for each output.
#[derive(Clone, Debug, PartialEq)]
struct Layer {
    inputs: usize,
    /// The weights of each output, one after the other.
    weights: Vec<f32>,
    offsets: Vec<f32>,
}

/// A network.
#[derive(Clone, Debug, PartialEq)]
struct Network {
    /// The means of the inputs, which are subtracted.
    means: Vec<f32>,
    layers: Vec<Layer>,
}

/// A model of finger taps.
#[derive(Clone, Debug, PartialEq)]
pub struct TapModel {
    convolved: Vec<Network>,
    dense: Vec<Network>,
}

impl Layer {
    fn outputs(&self) -> usize {
        self.offsets.len()
    }

    /// Appends the outputs for some inputs.
    fn apply(&self, inputs: &[f32], outputs: &mut Vec<f32>) {
        let rows = self.weights.chunks_exact(self.inputs);
        outputs.extend(rows.zip(&self.offsets).map(|(row, offset)| {
            let products = row.iter().zip(inputs).map(|(weight, input)| weight * input);
            offset + products.sum::<f32>()
        }));
    }

    fn read(bytes: &mut &[u8]) -> Result<Self, TapModelError> {
        let [inputs, outputs] = [size(bytes)?, size(bytes)?];
        let mut layer = Self {
            inputs,
            weights: Vec::with_capacity(inputs * outputs),
            offsets: Vec::with_capacity(outputs),
        };
        for _ in 0..outputs {
            let [offset, scale] = [number(bytes)?, number(bytes)?];
            let (row, rest) = bytes
                .split_at_checked(inputs)
                .ok_or(TapModelError::Damaged)?;
            *bytes = rest;
            layer.offsets.push(offset);
            let weights = row.iter().map(|&it| f32::from(it.cast_signed()) * scale);
            layer.weights.extend(weights);
        }
        Ok(layer)
    }
}

fn word(bytes: &mut &[u8]) -> Result<[u8; 4], TapModelError> {
    let (word, rest) = bytes.split_first_chunk().ok_or(TapModelError::Damaged)?;
    *bytes = rest;
    Ok(*word)
}

fn number(bytes: &mut &[u8]) -> Result<f32, TapModelError> {
    let number = f32::from_le_bytes(word(bytes)?);
    let is_sane = number.is_finite();
    is_sane.then_some(number).ok_or(TapModelError::Damaged)
}

fn size(bytes: &mut &[u8]) -> Result<usize, TapModelError> {
    let size = u32::from_le_bytes(word(bytes)?) as usize;
    let is_sane = (1..=MAX_WIDTH).contains(&size);
    is_sane.then_some(size).ok_or(TapModelError::Damaged)
}

impl Network {
    fn read(bytes: &mut &[u8], layers: usize) -> Result<Self, TapModelError> {
        let means = (0..size(bytes)?)
            .map(|_| number(bytes))
            .collect::<Result<_, _>>()?;
        let layers = (0..layers)
            .map(|_| Layer::read(bytes))
            .collect::<Result<_, _>>()?;
        Ok(Self { means, layers })
    }

    /// Returns `true` if the means and the inputs of each layer have these sizes, and the last layer an output for each set.
    fn fits(&self, means: usize, inputs: &[usize]) -> bool {
        let found = self.layers.iter().map(|layer| layer.inputs);
        let last = self.layers.last().map(Layer::outputs);
        self.means.len() == means && found.eq(inputs.iter().copied()) && last == Some(SETS)
    }

    fn is_convolved(&self) -> bool {
        let [first, second, third, hidden, _] = &self.layers[..] else {
            return false;
        };
        let width = first.outputs();
        let same = [second, third].iter().all(|layer| layer.outputs() == width);
        let next = CONVOLUTION * width;
        let sizes = [
            CONVOLUTION * NUMBERS,
            next,
            next,
            PAIRS * width,
            hidden.outputs(),
        ];
        same && self.fits(NUMBERS, &sizes)
    }

    fn is_dense(&self) -> bool {
        let [first, second, _] = &self.layers[..] else {
            return false;
        };
        let inputs = DENSE_MOMENTS.len() * NUMBERS;
        self.fits(inputs, &[inputs, first.outputs(), second.outputs()])
    }

    /// Returns the values of the sets for the numbers of all moments, with three convolutions.
    fn convolved(&self, numbers: &[f32]) -> Vec<f32> {
        let mut pictures = self.centered(numbers);
        for (index, layer) in self.layers[..CONVOLUTIONS].iter().enumerate() {
            // The picture before the first one and the one after the last one are 0.
            let edge = vec![0.0; pictures.len() / PICTURES];
            let padded = [&edge[..], &pictures, &edge].concat();
            let mut outputs = Vec::with_capacity(PICTURES * layer.outputs());
            for inputs in padded.windows(layer.inputs).step_by(edge.len()) {
                layer.apply(inputs, &mut outputs);
            }
            cut(&mut outputs);
            if index > 0 {
                for (output, before) in outputs.iter_mut().zip(&pictures) {
                    *output += before;
                }
            }
            pictures = outputs;
        }
        let width = pictures.len() / PICTURES;
        let mut larger = Vec::with_capacity(PAIRS * width);
        for pair in pictures.chunks_exact(2 * width) {
            let (a, b) = pair.split_at(width);
            larger.extend(a.iter().zip(b).map(|(a, b)| a.max(*b)));
        }
        apply_all(&self.layers[CONVOLUTIONS..], larger)
    }

    /// Returns the values of the sets for the numbers of all moments, of which it sees some, without convolutions.
    fn dense(&self, numbers: &[f32]) -> Vec<f32> {
        let seen = NUMBERS * DENSE_MOMENTS.start..NUMBERS * DENSE_MOMENTS.end;
        apply_all(&self.layers, self.centered(&numbers[seen]))
    }

    /// Returns numbers without their means.
    fn centered(&self, numbers: &[f32]) -> Vec<f32> {
        let centered = numbers.iter().zip(self.means.iter().cycle());
        centered.map(|(number, mean)| number - mean).collect()
    }
}

/// Applies layers one after the other; all but the last one are cut at 0.
fn apply_all(layers: &[Layer], mut values: Vec<f32>) -> Vec<f32> {
    for (index, layer) in layers.iter().enumerate() {
        let mut outputs = Vec::with_capacity(layer.outputs());
        layer.apply(&values, &mut outputs);
        if index + 1 < layers.len() {
            cut(&mut outputs);
        }
        values = outputs;
    }
    values
}

fn cut(values: &mut [f32]) {
    values.iter_mut().for_each(|value| *value = value.max(0.0));
}

/// Adds a part of the log-probabilities that values stand for.
fn add(scores: &mut [f32; SETS], values: &[f32], part: f32) {
    let largest = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let sum: f32 = values.iter().map(|value| (value - largest).exp()).sum();
    let norm = largest + sum.ln();
    for (score, value) in scores.iter_mut().zip(values) {
        *score += part * (value - norm);
    }
}

impl TapModel {
    /// Returns the shipped model.
    pub fn shipped() -> Self {
        Self::from_bytes(SHIPPED).expect("the shipped weights are tested")
    }

    /// Reads a model as `train.py` writes it.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TapModelError> {
        let mut bytes = bytes.strip_prefix(MAGIC).ok_or(TapModelError::NotAModel)?;
        let counts = [size(&mut bytes)?, size(&mut bytes)?];
        if counts.iter().any(|&count| count > MAX_NETWORKS) {
            return Err(TapModelError::Damaged);
        }
        let [convolved, dense] = counts;
        let mut read = |count: usize, layers: usize| {
            let networks = (0..count).map(|_| Network::read(&mut bytes, layers));
            networks.collect::<Result<Vec<_>, _>>()
        };
        let model = Self {
            convolved: read(convolved, CONVOLVED_LAYERS)?,
            dense: read(dense, DENSE_LAYERS)?,
        };
        let fits = model.convolved.iter().all(Network::is_convolved)
            && model.dense.iter().all(Network::is_dense);
        (fits && bytes.is_empty())
            .then_some(model)
            .ok_or(TapModelError::Damaged)
    }

    /// Returns the fingers that most probably tapped in a clip; `None` if the clip is not full or has no hand.
    pub fn fingers(&self, clip: &TapClip) -> Option<FingerSet> {
        let movement = Movement::new(clip.pictures()?)?;
        if movement.largest() < LEAST_MOVEMENT {
            return Some(FingerSet::NONE);
        }
        let scores = self.read(&movement);
        let best = (0..SETS).max_by(|&a, &b| scores[a].total_cmp(&scores[b]))?;
        let fingers = Finger::ALL.iter().zip(0..);
        let tapped = fingers.filter(|(_, bit)| best >> bit & 1 == 1);
        Some(tapped.fold(FingerSet::NONE, |set, (finger, _)| set.with(*finger)))
    }

    /// Returns the log-probability of each set of fingers, up to a constant, however little the hand moves. The bits of an index
    /// are the fingers, thumb first. `None` if the clip is not full or has no hand.
    pub fn scores(&self, clip: &TapClip) -> Option<[f32; SETS]> {
        Some(self.read(&Movement::new(clip.pictures()?)?))
    }

    fn read(&self, movement: &Movement) -> [f32; SETS] {
        let mut scores = [0.0; SETS];
        let shifts = SHIFTS.len() as f32;
        let convolved = (1.0 - DENSE_PART) / (shifts * self.convolved.len() as f32);
        let dense = DENSE_PART / (shifts * self.dense.len() as f32);
        for shift in SHIFTS {
            let moments = (FIRST_MOMENT..).take(PICTURES);
            let numbers: Vec<f32> = moments
                .flat_map(|moment| movement.at(shift + moment as f32))
                .collect();
            for network in &self.convolved {
                add(&mut scores, &network.convolved(&numbers), convolved);
            }
            for network in &self.dense {
                add(&mut scores, &network.dense(&numbers), dense);
            }
        }
        scores
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damaged_and_foreign_files_are_refused() {
        assert!(TapModel::from_bytes(SHIPPED).is_ok());
        assert_eq!(TapModel::from_bytes(b"PNG"), Err(TapModelError::NotAModel));
        for length in [8, 9, 20, 400, SHIPPED.len() - 1] {
            let found = TapModel::from_bytes(&SHIPPED[..length]);
            assert_eq!(found, Err(TapModelError::Damaged), "{length}");
        }
        let longer = [SHIPPED, b"x"].concat();
        assert_eq!(TapModel::from_bytes(&longer), Err(TapModelError::Damaged));
        // Both counts, the size of the means, and a mean.
        for place in [8, 12, 16, 20] {
            let mut wide = SHIPPED.to_vec();
            wide[place..place + 4].fill(0xff);
            let found = TapModel::from_bytes(&wide);
            assert_eq!(found, Err(TapModelError::Damaged), "{place}");
        }
    }
}
