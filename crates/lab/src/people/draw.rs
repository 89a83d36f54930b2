//! Random numbers of a person.

/// A stream of random numbers with the distributions that people need.
#[derive(Clone, Debug)]
pub struct Draw(fastrand::Rng);

impl Draw {
    /// Creates the stream of a seed and a purpose. Streams of different purposes are independent.
    pub fn new(seed: u64, purpose: u64) -> Self {
        Self(fastrand::Rng::with_seed(mix(seed ^ mix(purpose))))
    }

    /// Returns a number of the range.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    /// Returns a number of the standard normal distribution (Box-Muller transform).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.0.f64()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.0.f64()).cos()
    }

    /// Returns a number of the log-normal distribution with this median and coefficient of variation.
    pub fn log_normal(&mut self, median: f64, variation: f64) -> f64 {
        let deviation = (1.0 + variation * variation).ln().sqrt();
        median * (deviation * self.normal()).exp()
    }

    /// Returns `true` with this probability.
    pub fn happens(&mut self, probability: f64) -> bool {
        self.0.f64() < probability
    }

    /// Returns an index below `count`, which is more than 0.
    pub fn index(&mut self, count: usize) -> usize {
        self.0.usize(..count)
    }
}

/// Returns well mixed bits (the finaliser of SplitMix64), so that neighboring seeds have unrelated streams.
pub(crate) fn mix(seed: u64) -> u64 {
    let mut bits = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_normal_number_has_its_median_and_variation() {
        let mut draw = Draw::new(1, 2);
        let mut numbers: Vec<f64> = (0..20_000).map(|_| draw.log_normal(200.0, 0.4)).collect();
        numbers.sort_by(f64::total_cmp);
        let median = numbers[numbers.len() / 2];
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        let variance = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        let variation = (variance / numbers.len() as f64).sqrt() / mean;
        assert!((median - 200.0).abs() < 4.0, "{median}");
        assert!((variation - 0.4).abs() < 0.02, "{variation}");
    }

    #[test]
    fn purposes_and_seeds_have_streams_of_their_own() {
        let first = |seed, purpose| Draw::new(seed, purpose).between(0.0, 1.0);
        assert_ne!(first(1, 0), first(2, 0));
        assert_ne!(first(1, 0), first(1, 1));
        assert_eq!(first(3, 4), first(3, 4));
    }
}
