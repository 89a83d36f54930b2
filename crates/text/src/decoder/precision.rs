//! The precision of the last taps, from the first tap of a person on.
//!
//! The touch model learns from committed text, and until then believes in the scatter of an average person. A person who taps more
//! precisely hits the middle of key after key, whatever the keys mean. What is not known is then only the scale of the prior's
//! covariance, whose belief (an inverse gamma distribution) needs a few taps. It only shrinks: wide scatter is indistinguishable
//! from an even distribution over the keys.

use crate::keyboard::Millimetres;
use crate::touch::Prior;

/// The number of taps that the prior is worth.
const PRIOR_TAPS: f32 = 3.0;
/// The share of a tap that is left after one more tap.
const MEMORY: f32 = 0.98;
/// The variance around the middle of the likeliest key, relative to the variance around the meant one, at the scatter of the
/// prior: a tap that strays far is nearer to another key.
const FOLDED: f32 = 0.8;
/// The change of the scale for which the keys are worth computing again.
const NOTABLE: f32 = 0.1;

/// The scale of the prior's covariance that the last taps make believable.
#[derive(Clone, Copy, Debug)]
pub struct Precision {
    variance: Millimetres,
    taps: f32,
    squares: f32,
    used: f32,
}

impl Precision {
    pub fn new(prior: &Prior) -> Self {
        let [x, y, _] = prior.covariance;
        Self {
            variance: [x, y],
            taps: 0.0,
            squares: 0.0,
            used: 1.0,
        }
    }

    /// Adds the distance of a tap from the mean of the likeliest key.
    pub fn add(&mut self, residual: Millimetres) {
        let squares = (0..2).map(|axis| residual[axis] * residual[axis] / self.variance[axis]);
        self.taps = self.taps * MEMORY + 1.0;
        self.squares = self.squares * MEMORY + squares.sum::<f32>() / 2.0 / FOLDED;
    }

    fn scale(&self) -> f32 {
        ((self.squares + PRIOR_TAPS) / (self.taps + PRIOR_TAPS)).min(1.0)
    }

    /// Returns `true` if the scale has changed notably since it was taken.
    pub fn has_changed(&self) -> bool {
        (self.scale() / self.used - 1.0).abs() > NOTABLE
    }

    /// Returns the precision of these taps for keys that were computed with another one.
    pub fn for_keys_of(self, other: &Self) -> Self {
        Self {
            used: other.used,
            ..self
        }
    }

    /// Returns the scale.
    pub fn take(&mut self) -> f32 {
        self.used = self.scale();
        self.used
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale_after(taps: usize, distance: f32) -> f32 {
        let mut precision = Precision::new(&Prior::default());
        for _ in 0..taps {
            precision.add([distance, -distance]);
        }
        precision.take()
    }

    #[test]
    fn central_taps_shrink_the_prior_within_a_word() {
        assert_eq!(scale_after(0, 0.0), 1.0);
        assert!(scale_after(5, 0.2) < 0.4);
        assert!(scale_after(200, 0.2) < 0.1);
    }

    #[test]
    fn wide_taps_leave_the_prior_as_it_is() {
        assert_eq!(scale_after(100, 9.0), 1.0);
        assert_eq!(scale_after(100, 5.0), 1.0);
    }

    #[test]
    fn a_change_is_notable_once() {
        let mut precision = Precision::new(&Prior::default());
        assert!(!precision.has_changed());
        precision.add([0.1; 2]);
        assert!(precision.has_changed());
        precision.take();
        assert!(!precision.has_changed());
    }
}
