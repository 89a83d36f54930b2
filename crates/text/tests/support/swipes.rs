//! A simulated person who swipes: made for the tests, and different from what the decoder assumes.
//!
//! The finger passes points near the keys in movements of minimum jerk (Flash and Hogan 1985) that overlap, so that it cuts corners
//! by as much as it overlaps. Each person has an offset (2 mm in each direction), each key one of its own (1 mm), each point a
//! scatter that is correlated with the scatter of the point before (0.3). Positions are sampled at a rate of the person with noise of
//! the sensor. Nothing of it comes from lines between keys, samples at equal distances or costs of the decoder.

use ademan_text::{Key, Keyboard, Model, SwipePath};
use fastrand::Rng;

use super::simulated::{keyboard, normal};

/// The samples per second of people.
const RATES: [f32; 4] = [60.0, 90.0, 120.0, 240.0];

/// A person who swipes.
pub struct Swiper {
    random: Rng,
    keyboard: Keyboard,
    scatter: f32,
    /// The scatter of the last point.
    last: [f32; 2],
    shift: [f32; 2],
    offsets: Vec<[f32; 2]>,
    rate: f32,
    /// The part of a movement during which the next one has begun.
    overlap: f32,
    /// Seconds of a movement without a distance, and for each doubling of it.
    pace: [f32; 2],
    /// The noise of a position in mm.
    jitter: f32,
}

impl Swiper {
    /// A person with a scatter in mm.
    pub fn new(scatter: f32, seed: u64) -> Self {
        let mut random = Rng::with_seed(seed);
        let keyboard = keyboard();
        let mut pair = |scale: f32| [scale * normal(&mut random), scale * normal(&mut random)];
        let shift = pair(2.0);
        let offsets = keyboard.keys().iter().map(|_| pair(1.0)).collect();
        Self {
            keyboard,
            scatter,
            last: [0.0; 2],
            shift,
            offsets,
            rate: RATES[random.usize(..RATES.len())],
            overlap: 0.15 + 0.35 * random.f32(),
            pace: [0.05 + 0.03 * random.f32(), 0.06 + 0.05 * random.f32()],
            jitter: 0.2 + 0.8 * random.f32(),
            random,
        }
    }

    /// Returns the path of a word, or `None` if it has fewer than two places.
    pub fn swipes(&mut self, word: &str) -> Option<SwipePath> {
        let mut points = Vec::new();
        let mut last = None;
        for letter in word.chars().filter(|letter| *letter != '\'') {
            let index = self.keyboard.index(letter)?;
            if last.replace(index) == Some(index) {
                continue;
            }
            points.push(self.point(index));
        }
        if points.len() < 2 {
            return None;
        }
        let mut path = SwipePath::default();
        for point in self.moves(&points) {
            assert!(path.push(point), "{word} fits");
        }
        Some(path)
    }

    /// Returns where a key is aimed at.
    fn point(&mut self, index: usize) -> [f32; 2] {
        let Key { center, .. } = self.keyboard.keys()[index];
        std::array::from_fn(|axis| {
            let fresh = normal(&mut self.random);
            self.last[axis] = 0.3 * self.last[axis] + (1.0_f32 - 0.09).sqrt() * fresh;
            center[axis]
                + self.shift[axis]
                + self.offsets[index][axis]
                + self.scatter * self.last[axis]
        })
    }

    /// Returns the positions of the finger on its way through points.
    fn moves(&mut self, points: &[[f32; 2]]) -> Vec<[f32; 2]> {
        let mut moves = Vec::new();
        let mut start = 0.0;
        for pair in points.windows(2) {
            let step = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let length = step[0].hypot(step[1]);
            // Fitts's law with a width of 10 mm, and the person's own variation.
            let varied = 1.0 + 0.2 * normal(&mut self.random).clamp(-2.0, 2.0);
            let time = (self.pace[0] + self.pace[1] * (length / 10.0 + 1.0).log2()) * varied;
            moves.push((start, time, step));
            start += time * (1.0 - self.overlap);
        }
        let end = moves.iter().map(|(begin, time, _)| begin + time);
        let end = end.fold(0.0, f32::max);
        let count = (end * self.rate).ceil() as usize;
        let mut position = |sample: usize| {
            let now = sample as f32 / self.rate;
            std::array::from_fn(|axis| {
                let moved = moves.iter().map(|&(begin, time, step)| {
                    let s = ((now - begin) / time).clamp(0.0, 1.0);
                    step[axis] * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
                });
                points[0][axis] + moved.sum::<f32>() + self.jitter * normal(&mut self.random)
            })
        };
        (0..=count).map(&mut position).collect()
    }
}

/// The reference: the word of the lexicon whose lines between keys are nearest to the path by location alone, both at 32 points of
/// equal distances, among the words that start and end within one and a half keys of the path. It knows no probabilities.
pub struct NearestShape {
    words: Vec<(String, Vec<[f32; 2]>)>,
}

const SHAPE_POINTS: usize = 32;

impl NearestShape {
    pub fn new(model: &Model) -> Self {
        let keyboard = keyboard();
        let words = model.word_list().into_iter().filter_map(|(word, _)| {
            let keys = word.chars().filter(|letter| *letter != '\'');
            let keys = keys.map(|letter| Some(keyboard.keys()[keyboard.index(letter)?].center));
            let mut keys = keys.collect::<Option<Vec<[f32; 2]>>>()?;
            keys.dedup();
            (keys.len() > 1).then(|| (word, evenly(&keys)))
        });
        Self {
            words: words.collect(),
        }
    }

    /// Returns the nearest words, the best first.
    pub fn read(&self, path: &SwipePath) -> Vec<&str> {
        let path = evenly(path.points());
        let apart =
            |left: [f32; 2], right: [f32; 2]| (left[0] - right[0]).hypot(left[1] - right[1]);
        let reach = 1.5 * super::simulated::PITCH;
        let (first, last) = (path[0], path[SHAPE_POINTS - 1]);
        let near = self.words.iter().filter(|(_, shape)| {
            apart(shape[0], first) < reach && apart(shape[SHAPE_POINTS - 1], last) < reach
        });
        let mut found: Vec<(f32, &str)> = near
            .map(|(word, shape)| {
                let pairs = shape.iter().zip(&path);
                (pairs.map(|(&a, &b)| apart(a, b)).sum(), word.as_str())
            })
            .collect();
        found.sort_by(|left, right| left.0.total_cmp(&right.0));
        found.into_iter().take(3).map(|(_, word)| word).collect()
    }
}

/// Returns points at equal distances along lines.
fn evenly(points: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let mut ends = vec![0.0_f32];
    for pair in points.windows(2) {
        let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        ends.push(ends[ends.len() - 1] + step);
    }
    let length = ends[ends.len() - 1];
    let at = |index: usize| {
        let target = length * index as f32 / (SHAPE_POINTS - 1) as f32;
        let segment = ends[1..].partition_point(|&end| end < target);
        let segment = segment.min(points.len() - 2);
        let step = ends[segment + 1] - ends[segment];
        let t = if step > 0.0 {
            (target - ends[segment]) / step
        } else {
            0.0
        };
        std::array::from_fn(|axis| {
            let (a, b) = (points[segment][axis], points[segment + 1][axis]);
            a + t * (b - a)
        })
    };
    (0..SHAPE_POINTS).map(at).collect()
}

/// Reads of swiped words, counted by phrase.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hits {
    pub words: usize,
    /// The meant word is the first one.
    pub first: usize,
    /// It is one of three.
    pub three: usize,
}

impl Hits {
    /// Counts what was read for a word.
    pub fn add<'a>(&mut self, meant: &str, mut read: impl Iterator<Item = &'a str>) {
        let place = read.position(|word| word.to_lowercase() == meant);
        self.words += 1;
        self.first += usize::from(place == Some(0));
        self.three += usize::from(place.is_some_and(|place| place < 3));
    }

    pub fn merge(&mut self, other: &Self) {
        self.words += other.words;
        self.first += other.first;
        self.three += other.three;
    }

    /// Returns the percentages of words that are the first one, and one of three.
    pub fn percent(&self) -> [f64; 2] {
        [self.first, self.three].map(|count| 100.0 * count as f64 / self.words.max(1) as f64)
    }
}

/// Returns the 95 % bootstrap intervals of both percentages, phrases drawn with replacement.
pub fn intervals(phrases: &[Hits]) -> [[f64; 2]; 2] {
    let mut random = Rng::with_seed(1);
    let mut samples: Vec<[f64; 2]> = (0..1_000)
        .map(|_| {
            let mut sum = Hits::default();
            for _ in phrases {
                sum.merge(&phrases[random.usize(..phrases.len())]);
            }
            sum.percent()
        })
        .collect();
    std::array::from_fn(|which| {
        samples.sort_by(|left, right| left[which].total_cmp(&right[which]));
        [0.025, 0.975].map(|share| samples[(999.0 * share) as usize][which])
    })
}

/// The reads of one scatter, by phrase: by the decoder, by the decoder without the words before, and by the nearest shape.
pub struct Measured {
    pub decoded: Vec<Hits>,
    pub alone: Vec<Hits>,
    pub nearest: Vec<Hits>,
}

/// Lets people swipe phrases, each word that has more than one place; the others count as given, for the words after them.
pub fn measure(
    model: &Model,
    reference: &NearestShape,
    phrases: &[String],
    scatter: f32,
    seeds: std::ops::Range<u64>,
) -> Measured {
    use ademan_text::{Decoder, Options, Prior, TouchModel};
    let decoder = || {
        let touch = TouchModel::new(Prior::default());
        let options = Options::default();
        Decoder::new(model.clone(), keyboard(), touch, options).with_swipes()
    };
    let fresh = || vec![Hits::default(); phrases.len()];
    let mut measured = Measured {
        decoded: fresh(),
        alone: fresh(),
        nearest: fresh(),
    };
    let (mut following, mut alone) = (decoder(), decoder());
    alone.start_anywhere();
    for seed in seeds {
        let mut person = Swiper::new(scatter, seed);
        for (index, phrase) in phrases.iter().enumerate() {
            following.start_sentence();
            for word in super::phrases::words(phrase) {
                if let Some(path) = person.swipes(word) {
                    let texts = following.swipe(path.points(), false).iter();
                    measured.decoded[index].add(word, texts.map(|it| it.text.as_str()));
                    let lone_texts = alone.swipe(path.points(), false).iter();
                    measured.alone[index].add(word, lone_texts.map(|it| it.text.as_str()));
                    let reference_texts = reference.read(&path).into_iter();
                    measured.nearest[index].add(word, reference_texts);
                }
                following.commit_text(Some(word));
            }
        }
    }
    measured
}
