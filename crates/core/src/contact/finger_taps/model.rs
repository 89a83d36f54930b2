//! The model that reads fingers from the features of a clip: a projection and small networks.

use super::features::{FEATURES, features, onset};
use super::{PICTURES, TapClip};
use crate::hand::{Finger, FingerSet};

/// The first bytes of a file of weights.
const MAGIC: &[u8; 8] = b"ademtap1";

/// The shipped weights.
const SHIPPED: &[u8] = include_bytes!("weights.bin");

/// The largest number of inputs and outputs of a layer; more is no file of this program.
const MAX_WIDTH: usize = 1_024;
/// The largest number of networks.
const MAX_NETWORKS: usize = 16;

/// The shifts in pictures for which a clip is read; their mean counts.
const SHIFTS: [isize; 3] = [-1, 0, 1];

/// Reason why bytes are no model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TapModelError {
    /// It is not such a file.
    #[error("not a model of finger taps; make one with the example `train_finger_taps`")]
    NotAModel,
    /// It ends early, has bytes left, or layers that do not fit to each other.
    #[error(
        "the model of finger taps is damaged; make it again with the example `train_finger_taps`"
    )]
    Damaged,
}

/// A layer: a matrix with an offset for each output.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The number of inputs.
    pub inputs: usize,
    /// The weights of each output, one after the other.
    pub weights: Vec<f32>,
    /// The offset of each output.
    pub offsets: Vec<f32>,
}

/// A network with one hidden layer and one output for each finger.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// The hidden layer; its outputs are cut at 0.
    pub hidden: Layer,
    /// The outputs: logarithms of the odds that a finger tapped.
    pub output: Layer,
}

/// A model of finger taps.
#[derive(Clone, Debug, PartialEq)]
pub struct TapModel {
    /// The projection of the features.
    pub projection: Layer,
    /// The networks, whose mean counts.
    pub networks: Vec<Network>,
}

impl Layer {
    /// Sets `outputs` to those for some inputs. Does not allocate beyond the capacity of `outputs`.
    pub fn apply(&self, inputs: &[f32], outputs: &mut Vec<f32>) {
        outputs.clear();
        let rows = self.weights.chunks_exact(self.inputs.max(1));
        outputs.extend(rows.zip(&self.offsets).map(|(row, offset)| {
            let products = row.iter().zip(inputs).map(|(weight, input)| weight * input);
            offset + products.sum::<f32>()
        }));
    }

    fn write(&self, bytes: &mut Vec<u8>) {
        for width in [self.inputs, self.offsets.len()] {
            bytes.extend((width as u32).to_le_bytes());
        }
        let rows = self.weights.chunks_exact(self.inputs.max(1));
        for (row, offset) in rows.zip(&self.offsets) {
            let largest = row
                .iter()
                .fold(0.0_f32, |largest, it| largest.max(it.abs()));
            let scale = largest.max(f32::MIN_POSITIVE) / 127.0;
            bytes.extend(offset.to_le_bytes());
            bytes.extend(scale.to_le_bytes());
            bytes.extend(row.iter().map(|it| (it / scale).round() as i8 as u8));
        }
    }

    fn read(bytes: &mut &[u8]) -> Result<Self, TapModelError> {
        let [inputs, outputs] =
            [word(bytes)?, word(bytes)?].map(|it| u32::from_le_bytes(it) as usize);
        if inputs == 0 || inputs > MAX_WIDTH || outputs > MAX_WIDTH {
            return Err(TapModelError::Damaged);
        }
        let mut layer = Self {
            inputs,
            weights: Vec::with_capacity(inputs * outputs),
            offsets: Vec::with_capacity(outputs),
        };
        for _ in 0..outputs {
            let [offset, scale] = [word(bytes)?, word(bytes)?].map(f32::from_le_bytes);
            let (row, rest) = bytes
                .split_at_checked(inputs)
                .ok_or(TapModelError::Damaged)?;
            *bytes = rest;
            layer.offsets.push(offset);
            layer
                .weights
                .extend(row.iter().map(|it| f32::from(*it as i8) * scale));
        }
        let mut numbers = layer.weights.iter().chain(&layer.offsets);
        if numbers.all(|it| it.is_finite()) {
            Ok(layer)
        } else {
            Err(TapModelError::Damaged)
        }
    }
}

fn word(bytes: &mut &[u8]) -> Result<[u8; 4], TapModelError> {
    let (word, rest) = bytes.split_first_chunk().ok_or(TapModelError::Damaged)?;
    *bytes = rest;
    Ok(*word)
}

impl TapModel {
    /// Returns the shipped model.
    pub fn shipped() -> Self {
        Self::from_bytes(SHIPPED).expect("the shipped weights are tested")
    }

    /// Reads a model as [`to_bytes`](Self::to_bytes) writes it.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TapModelError> {
        let mut bytes = bytes.strip_prefix(MAGIC).ok_or(TapModelError::NotAModel)?;
        let projection = Layer::read(&mut bytes)?;
        let count = u32::from_le_bytes(word(&mut bytes)?) as usize;
        if projection.inputs != FEATURES || count == 0 || count > MAX_NETWORKS {
            return Err(TapModelError::Damaged);
        }
        let mut networks = Vec::with_capacity(count);
        for _ in 0..count {
            let network = Network {
                hidden: Layer::read(&mut bytes)?,
                output: Layer::read(&mut bytes)?,
            };
            let fits = network.hidden.inputs == projection.offsets.len()
                && network.output.inputs == network.hidden.offsets.len()
                && network.output.offsets.len() == Finger::COUNT;
            if !fits {
                return Err(TapModelError::Damaged);
            }
            networks.push(network);
        }
        let model = Self {
            projection,
            networks,
        };
        bytes
            .is_empty()
            .then_some(model)
            .ok_or(TapModelError::Damaged)
    }

    /// Returns the bytes of the model: weights of 8 bits with a scale for each output.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        self.projection.write(&mut bytes);
        bytes.extend((self.networks.len() as u32).to_le_bytes());
        for network in &self.networks {
            network.hidden.write(&mut bytes);
            network.output.write(&mut bytes);
        }
        bytes
    }

    /// Returns the fingers that tapped in a clip; `None` if the clip is not full or has no hand.
    pub fn fingers(&self, clip: &TapClip) -> Option<FingerSet> {
        let scores = self.scores(clip)?;
        let fingers = Finger::ALL.iter().zip(scores);
        let tapped = fingers.filter(|(_, score)| *score > 0.0);
        Some(tapped.fold(FingerSet::NONE, |set, (finger, _)| set.with(*finger)))
    }

    /// Returns the logarithm of the odds that each finger tapped in a clip, thumb first; `None` if the clip is not full or has no hand.
    pub fn scores(&self, clip: &TapClip) -> Option<[f32; Finger::COUNT]> {
        let pictures = clip.pictures()?;
        let onset = onset(pictures) as isize;
        let mut scores = [0.0; Finger::COUNT];
        let [mut projected, mut hidden, mut output] = [const { Vec::new() }; 3];
        let weight = 1.0 / (SHIFTS.len() * self.networks.len()) as f32;
        for shift in SHIFTS {
            let onset = (onset + shift).clamp(0, PICTURES as isize - 1) as usize;
            self.projection
                .apply(&features(pictures, onset)?, &mut projected);
            for network in &self.networks {
                network.hidden.apply(&projected, &mut hidden);
                hidden.iter_mut().for_each(|it| *it = it.max(0.0));
                network.output.apply(&hidden, &mut output);
                for (score, value) in scores.iter_mut().zip(&output) {
                    *score += value * weight;
                }
            }
        }
        Some(scores)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damaged_and_foreign_files_are_refused() {
        let bytes = TapModel::shipped().to_bytes();
        assert!(TapModel::from_bytes(&bytes).is_ok());
        assert_eq!(TapModel::from_bytes(b"PNG"), Err(TapModelError::NotAModel));
        for length in [8, 9, 20, 400, bytes.len() - 1] {
            let found = TapModel::from_bytes(&bytes[..length]);
            assert_eq!(found, Err(TapModelError::Damaged), "{length}");
        }
        let longer = [&bytes[..], b"x"].concat();
        assert_eq!(TapModel::from_bytes(&longer), Err(TapModelError::Damaged));
        let mut wide = bytes;
        wide[8..12].fill(0xff);
        assert_eq!(TapModel::from_bytes(&wide), Err(TapModelError::Damaged));
    }
}
