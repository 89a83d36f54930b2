//! The waveforms of the clicks, which are computed: no file of sound comes with the program.

use std::f32::consts::TAU;

use super::click::Click;

/// Samples per second, in one channel.
pub const SAMPLE_RATE: u32 = 48_000;

/// Peak of the first swing. It leaves room for a second click while the first one fades.
const AMPLITUDE: f32 = 0.45 * i16::MAX as f32;

/// Time constants until a strike has faded to 0.2 %, below what is heard.
const FADED: f32 = 6.0;

/// A strike on something that rings and fades, one or several times.
struct Strike {
    frequency_hz: f32,
    /// Time in which the swing fades to 1/e.
    decay_ms: f32,
    /// Times of the strikes.
    at_ms: &'static [f32],
}

const fn strike(click: Click) -> Strike {
    match click {
        // Short and bright, as the tactile point of a key.
        Click::Key => Strike {
            frequency_hz: 2_100.0,
            decay_ms: 1.6,
            at_ms: &[0.0],
        },
        // An octave lower and longer: a heavier key.
        Click::Modifier => Strike {
            frequency_hz: 1_050.0,
            decay_ms: 3.0,
            at_ms: &[0.0],
        },
        // Two low strikes, so that it cannot be mistaken for a key.
        Click::Suppressed => Strike {
            frequency_hz: 330.0,
            decay_ms: 6.0,
            at_ms: &[0.0, 55.0],
        },
    }
}

/// Returns the samples of a click.
pub fn samples(click: Click) -> Vec<i16> {
    let strike = strike(click);
    let last_ms = strike.at_ms.last().copied().unwrap_or_default();
    let length_ms = last_ms + FADED * strike.decay_ms;
    let count = (length_ms * 1e-3 * SAMPLE_RATE as f32) as usize;
    let value = |index: usize| {
        let ms = index as f32 * 1e3 / SAMPLE_RATE as f32;
        let swings = strike.at_ms.iter().map(|&at| strike.swing(ms - at));
        (AMPLITUDE * swings.sum::<f32>()) as i16
    };
    (0..count).map(value).collect()
}

impl Strike {
    /// Returns the swing at a time after a strike, −1..=1. It starts at 0, since a jump would crackle.
    fn swing(&self, ms: f32) -> f32 {
        if ms < 0.0 {
            0.0
        } else {
            (TAU * self.frequency_hz * ms * 1e-3).sin() * (-ms / self.decay_ms).exp()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_click_is_heard_and_short_and_ends_in_silence() {
        for click in Click::ALL {
            let samples = samples(*click);
            let ms = samples.len() as f32 * 1e3 / SAMPLE_RATE as f32;
            assert!((5.0..100.0).contains(&ms), "{click}: {ms} ms");
            let peak = samples.iter().map(|it| it.unsigned_abs()).max();
            let is_heard = peak.is_some_and(|peak| (6_000..16_000).contains(&peak));
            assert!(is_heard, "{click}: {peak:?}");
            let rest = samples[samples.len() - 48..].iter();
            let rest = rest.map(|it| it.unsigned_abs()).max();
            assert!(rest.is_some_and(|rest| rest < 100), "{click}: {rest:?}");
            assert_eq!(samples[0], 0);
        }
    }

    #[test]
    fn clicks_differ_in_pitch() {
        let crossings = |click| {
            let samples = samples(click);
            let window = &samples[..SAMPLE_RATE as usize / 200];
            let is_crossing = |pair: &&[i16]| (pair[0] < 0) != (pair[1] < 0);
            window.windows(2).filter(is_crossing).count()
        };
        let [key, modifier, suppressed] =
            [Click::Key, Click::Modifier, Click::Suppressed].map(crossings);
        assert!(
            key > modifier && modifier > suppressed,
            "{key} {modifier} {suppressed}"
        );
    }
}
