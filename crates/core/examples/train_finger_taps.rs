//! Trains the model of finger taps, and says what it reaches on clips that it has not seen.
//!
//! ```sh
//! cargo run --release -p ademan-core --example train_finger_taps -- train.json validate.json weights.bin
//! ```
//!
//! Both files are lists of clips: `x` has 15 pictures of 21 points of MediaPipe (x and y in pixels, z), `y` the fingers that tapped (0 for
//! the thumb to 4 for the little finger, −1 for none). Each clip is used with its fastest movement one picture early and late, and
//! with a slightly turned and stretched hand. The projection is a linear discriminant analysis of the sets of fingers; four networks
//! of 64 hidden units are trained on it by Adam (Kingma & Ba 2015). The same seed writes the same file on one kind of processor.

use std::collections::BTreeMap;
use std::error::Error;

use ademan_core::contact::finger_taps::{
    FEATURES, Layer, Network, PICTURES, Picture, TapClip, TapModel, features, onset,
};
use ademan_core::hand::{Finger, FingerSet};
use fastrand::Rng;
use serde_json::Value;

type Fingers = [f32; Finger::COUNT];
type Pictures = [Picture; PICTURES];

/// Clips with changed hands, beside each clip.
const CHANGED: usize = 4;
const NETWORKS: usize = 4;
const HIDDEN: usize = 64;
/// The part of the covariance that is replaced by its mean variance.
const SHRINKAGE: f64 = 0.05;
const EPOCHS: usize = 60;
const BATCH: usize = 200;
const STEP: f32 = 1e-3;
/// The pull of weights towards 0.
const DECAY: f32 = 5e-3;

struct Sample {
    features: Vec<f64>,
    fingers: Fingers,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [train, validate, output] = arguments.as_slice() else {
        return Err("usage: train_finger_taps TRAIN.json VALIDATE.json OUTPUT".into());
    };
    let clips = read(train)?;
    let model = fit(&clips, 1);
    std::fs::write(output, model.to_bytes())?;
    let model = TapModel::from_bytes(&model.to_bytes())?;
    report("trained on", &model, &clips);
    report("not trained on", &model, &read(validate)?);
    // Five parts, each read by a model of the others.
    let mut held_out = (0, 0);
    for part in 0..5 {
        let of_part = |index: usize| index % 5 == part;
        let (mut own, mut others) = (Vec::new(), Vec::new());
        for (index, clip) in clips.iter().enumerate() {
            if of_part(index) {
                own.push(*clip)
            } else {
                others.push(*clip)
            }
        }
        let part_model = fit(&others, 2 + part as u64);
        held_out.0 += own.iter().filter(|it| is_exact(&part_model, it)).count();
        held_out.1 += own.len();
    }
    let (exact, all) = held_out;
    println!(
        "five parts: exact {:.3} of {all} clips",
        exact as f64 / all as f64
    );
    Ok(())
}

fn read(path: &str) -> Result<Vec<(Pictures, Fingers)>, Box<dyn Error>> {
    let clips: Vec<Value> = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let clip = |clip: &Value| -> Option<(Pictures, Fingers)> {
        let mut pictures = [[[0.0; 2]; 21]; PICTURES];
        for (frame, picture) in pictures.iter_mut().enumerate() {
            for (joint, point) in picture.iter_mut().enumerate() {
                for (axis, value) in point.iter_mut().enumerate() {
                    *value = clip["x"].get(frame)?.get(joint)?.get(axis)?.as_f64()? as f32;
                }
            }
        }
        let mut fingers = Fingers::default();
        for finger in clip["y"].as_array()? {
            if let Ok(finger) = usize::try_from(finger.as_i64()?) {
                *fingers.get_mut(finger)? = 1.0;
            }
        }
        Some((pictures, fingers))
    };
    let clips: Option<Vec<_>> = clips.iter().map(clip).collect();
    clips.ok_or_else(|| format!("{path} has a clip that is not 15 pictures of 21 points").into())
}

fn fit(clips: &[(Pictures, Fingers)], seed: u64) -> TapModel {
    let mut random = Rng::with_seed(seed);
    let samples = samples(clips, &mut random);
    let projection = discriminant(&samples);
    let mut projected = Vec::new();
    let inputs = samples.iter().map(|sample| {
        let features: Vec<f32> = sample.features.iter().map(|it| *it as f32).collect();
        projection.apply(&features, &mut projected);
        (projected.clone(), sample.fingers)
    });
    let inputs: Vec<(Vec<f32>, Fingers)> = inputs.collect();
    let networks = (0..NETWORKS).map(|_| train(&inputs, &mut random)).collect();
    TapModel {
        projection,
        networks,
    }
}

/// Returns the samples of clips: with their onset, one picture before and one after it, and with changed hands.
fn samples(clips: &[(Pictures, Fingers)], random: &mut Rng) -> Vec<Sample> {
    let mut all = Vec::new();
    for (pictures, fingers) in clips {
        let mut add = |clip: &Pictures, shift: isize| {
            let onset = (onset(clip) as isize + shift).clamp(0, PICTURES as isize - 1);
            if let Some(features) = features(clip, onset as usize) {
                let features = features.iter().map(|it| f64::from(*it)).collect();
                all.push(Sample {
                    features,
                    fingers: *fingers,
                });
            }
        };
        for shift in -1..=1 {
            add(pictures, shift);
        }
        for _ in 0..CHANGED {
            add(&changed(pictures, random), random.isize(-1..=1));
        }
    }
    all
}

/// Returns the clip of a hand that is turned and stretched a little about its wrist, with noise of 0.3 pixels.
fn changed(pictures: &Pictures, random: &mut Rng) -> Pictures {
    let (size, height) = (between(random, 0.92, 1.08), between(random, 0.93, 1.07));
    let (sine, cosine) = (0.04 * normal(random)).sin_cos();
    let mut changed = *pictures;
    for picture in &mut changed {
        let wrist = picture[0];
        for point in picture.iter_mut() {
            let [x, y] = [point[0] - wrist[0], (point[1] - wrist[1]) * height];
            *point = [
                wrist[0] + size * (x * cosine - y * sine) + 0.3 * normal(random),
                wrist[1] + size * (x * sine + y * cosine) + 0.3 * normal(random),
            ];
        }
    }
    changed
}

fn between(random: &mut Rng, low: f32, high: f32) -> f32 {
    low + (high - low) * random.f32()
}

/// Returns a number of the standard normal distribution (Box-Muller transform).
fn normal(random: &mut Rng) -> f32 {
    let radius = (-2.0 * (1.0 - random.f32()).ln()).sqrt();
    radius * (std::f32::consts::TAU * random.f32()).cos()
}

/// Returns the projection on the differences of the sets of fingers, in units of the deviation within a set.
fn discriminant(samples: &[Sample]) -> Layer {
    let mut sets: BTreeMap<u8, (Vec<f64>, f64)> = BTreeMap::new();
    let key = |fingers: &Fingers| {
        fingers
            .iter()
            .enumerate()
            .fold(0, |set, (index, it)| set | (*it as u8) << index)
    };
    let mut mean = vec![0.0; FEATURES];
    for sample in samples {
        let (sum, count) = sets
            .entry(key(&sample.fingers))
            .or_insert((vec![0.0; FEATURES], 0.0));
        *count += 1.0;
        for (feature, value) in sample.features.iter().enumerate() {
            sum[feature] += value;
            mean[feature] += value / samples.len() as f64;
        }
    }
    for (sum, count) in sets.values_mut() {
        sum.iter_mut().for_each(|it| *it /= *count);
    }
    let mut covariance = vec![vec![0.0; FEATURES]; FEATURES];
    for sample in samples {
        let (of_set, _) = &sets[&key(&sample.fingers)];
        let own: Vec<f64> = sample
            .features
            .iter()
            .zip(of_set)
            .map(|(it, set_mean)| it - set_mean)
            .collect();
        for (row, values) in covariance.iter_mut().enumerate() {
            for (value, other) in values.iter_mut().zip(&own[..=row]) {
                *value += own[row] * other / samples.len() as f64;
            }
        }
    }
    // Each feature is scaled by its own deviation before the covariance is shrunk towards a diagonal one.
    for (row, values) in covariance.iter_mut().enumerate() {
        for value in &mut values[..row] {
            *value *= 1.0 - SHRINKAGE;
        }
        values[row] += 1e-9;
    }
    let lower = cholesky(covariance);
    // The differences of the sets, made orthogonal where deviations are equal in all directions.
    let mut axes: Vec<Vec<f64>> = Vec::new();
    for (of_set, _) in sets.values() {
        let difference: Vec<f64> = of_set.iter().zip(&mean).map(|(a, b)| a - b).collect();
        let mut axis = forward(&lower, difference);
        for other in &axes {
            let part = dot(&axis, other);
            axis.iter_mut()
                .zip(other)
                .for_each(|(it, other)| *it -= part * other);
        }
        let length = dot(&axis, &axis).sqrt();
        if length > 1e-3 {
            axis.iter_mut().for_each(|it| *it /= length);
            axes.push(axis);
        }
    }
    let mut layer = Layer {
        inputs: FEATURES,
        weights: Vec::new(),
        offsets: Vec::new(),
    };
    for axis in axes {
        let weights = backward(&lower, axis);
        layer.offsets.push(-dot(&weights, &mean) as f32);
        layer.weights.extend(weights.iter().map(|it| *it as f32));
    }
    layer
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the lower triangle whose product with its transpose is a positive definite matrix.
fn cholesky(mut matrix: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for row in 0..matrix.len() {
        for column in 0..=row {
            let product = dot(&matrix[row][..column], &matrix[column][..column]);
            let rest = matrix[row][column] - product;
            matrix[row][column] = if row == column {
                rest.sqrt()
            } else {
                rest / matrix[column][column]
            };
        }
    }
    matrix
}

/// Solves `lower · x = right`.
fn forward(lower: &[Vec<f64>], mut right: Vec<f64>) -> Vec<f64> {
    for row in 0..right.len() {
        let known = dot(&lower[row][..row], &right[..row]);
        right[row] = (right[row] - known) / lower[row][row];
    }
    right
}

/// Solves `lowerᵀ · x = right`.
fn backward(lower: &[Vec<f64>], mut right: Vec<f64>) -> Vec<f64> {
    for row in (0..right.len()).rev() {
        right[row] /= lower[row][row];
        let solved = right[row];
        for column in 0..row {
            right[column] -= lower[row][column] * solved;
        }
    }
    right
}

/// A layer with its gradients and the moments of Adam.
struct Trained {
    layer: Layer,
    gradients: Vec<f32>,
    moments: Vec<[f32; 2]>,
}

impl Trained {
    fn new(inputs: usize, outputs: usize, random: &mut Rng) -> Self {
        let bound = (6.0 / (inputs + outputs) as f32).sqrt();
        let weights = (0..inputs * outputs)
            .map(|_| between(random, -bound, bound))
            .collect();
        let count = (inputs + 1) * outputs;
        Self {
            layer: Layer {
                inputs,
                weights,
                offsets: vec![0.0; outputs],
            },
            gradients: vec![0.0; count],
            moments: vec![[0.0; 2]; count],
        }
    }

    /// Adds the gradients of one sample, and returns the gradients of its inputs.
    fn backward(&mut self, inputs: &[f32], errors: &[f32]) -> Vec<f32> {
        let width = inputs.len();
        let mut of_inputs = vec![0.0; width];
        for (output, error) in errors
            .iter()
            .enumerate()
            .filter(|(_, error)| **error != 0.0)
        {
            let row = output * width..(output + 1) * width;
            for ((gradient, input), (of_input, weight)) in self.gradients[row.clone()]
                .iter_mut()
                .zip(inputs)
                .zip(of_inputs.iter_mut().zip(&self.layer.weights[row]))
            {
                *gradient += error * input;
                *of_input += error * weight;
            }
            let offset = self.layer.weights.len() + output;
            self.gradients[offset] += error;
        }
        of_inputs
    }

    /// Makes a step of Adam, the `number`-th.
    fn step(&mut self, samples: usize, number: i32) {
        let decays = self.layer.weights.len();
        let parameters = self.layer.weights.iter_mut().chain(&mut self.layer.offsets);
        let state = self.gradients.iter_mut().zip(&mut self.moments);
        for (index, (parameter, (gradient, [mean, square]))) in parameters.zip(state).enumerate() {
            let decay = if index < decays {
                DECAY * *parameter
            } else {
                0.0
            };
            let own = *gradient / samples as f32 + decay;
            *gradient = 0.0;
            *mean = 0.9 * *mean + 0.1 * own;
            *square = 0.999 * *square + 0.001 * own * own;
            let unbiased = *mean / (1.0 - 0.9_f32.powi(number));
            let deviation = (*square / (1.0 - 0.999_f32.powi(number))).sqrt();
            *parameter -= STEP * unbiased / (deviation + 1e-8);
        }
    }
}

fn train(samples: &[(Vec<f32>, Fingers)], random: &mut Rng) -> Network {
    let inputs = samples[0].0.len();
    let mut first = Trained::new(inputs, HIDDEN, random);
    let mut second = Trained::new(HIDDEN, Finger::COUNT, random);
    let mut order: Vec<usize> = (0..samples.len()).collect();
    let (mut hidden, mut outputs) = (Vec::new(), Vec::new());
    let mut number = 0;
    for _ in 0..EPOCHS {
        random.shuffle(&mut order);
        for batch in order.chunks(BATCH) {
            for &index in batch {
                let (own_inputs, fingers) = &samples[index];
                first.layer.apply(own_inputs, &mut hidden);
                hidden.iter_mut().for_each(|it| *it = it.max(0.0));
                second.layer.apply(&hidden, &mut outputs);
                let errors = outputs.iter().zip(fingers);
                let errors: Vec<f32> = errors
                    .map(|(output, finger)| 1.0 / (1.0 + (-output).exp()) - finger)
                    .collect();
                let mut of_hidden = second.backward(&hidden, &errors);
                for (error, activation) in of_hidden.iter_mut().zip(&hidden) {
                    if *activation <= 0.0 {
                        *error = 0.0;
                    }
                }
                first.backward(own_inputs, &of_hidden);
            }
            number += 1;
            first.step(batch.len(), number);
            second.step(batch.len(), number);
        }
    }
    Network {
        hidden: first.layer,
        output: second.layer,
    }
}

fn is_exact(model: &TapModel, (pictures, fingers): &(Pictures, Fingers)) -> bool {
    let tapped = Finger::ALL.iter().zip(fingers).filter(|(_, it)| **it > 0.0);
    let tapped = tapped.fold(FingerSet::NONE, |set, (finger, _)| set.with(*finger));
    model.fingers(&TapClip::new(*pictures)) == Some(tapped)
}

/// Prints the part of the clips whose fingers are exact, and the F1 of each finger.
fn report(what: &str, model: &TapModel, clips: &[(Pictures, Fingers)]) {
    let exact = clips.iter().filter(|it| is_exact(model, it)).count();
    let mut counts = [[0.0; 3]; Finger::COUNT];
    for (pictures, fingers) in clips {
        let Some(scores) = model.scores(&TapClip::new(*pictures)) else {
            continue;
        };
        for ((own_counts, score), truth) in counts.iter_mut().zip(scores).zip(fingers) {
            match (score > 0.0, *truth > 0.0) {
                (true, true) => own_counts[0] += 1.0,
                (true, false) => own_counts[1] += 1.0,
                (false, true) => own_counts[2] += 1.0,
                (false, false) => {}
            }
        }
    }
    let f1 = counts.map(|[hit, wrong, missed]| 2.0 * hit / (2.0 * hit + wrong + missed));
    let part = exact as f64 / clips.len() as f64;
    println!(
        "{what}: exact {part:.3} of {} clips, F1 of thumb to little finger {f1:.3?}",
        clips.len()
    );
}
