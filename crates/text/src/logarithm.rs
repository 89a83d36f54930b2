//! Logarithms that are alike on every machine: the mathematical libraries of systems differ in the last bit, and models are compared
//! byte by byte.

/// Returns the natural logarithm of a positive finite number, computed with exactly rounded operations only.
pub fn ln(value: f64) -> f64 {
    let bits = value.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i64 - 1023;
    let mantissa = f64::from_bits(bits & 0x000f_ffff_ffff_ffff | 1023 << 52);
    // ln m = 2 artanh((m − 1) / (m + 1)), with m between 1/√2 and √2.
    let (mantissa, exponent) = if mantissa > std::f64::consts::SQRT_2 {
        (mantissa / 2.0, exponent + 1)
    } else {
        (mantissa, exponent)
    };
    let ratio = (mantissa - 1.0) / (mantissa + 1.0);
    let square = ratio * ratio;
    let (mut power, mut sum) = (ratio, 0.0);
    for odd in (1..30).step_by(2) {
        sum += power / f64::from(odd);
        power *= square;
    }
    2.0 * sum + exponent as f64 * std::f64::consts::LN_2
}

/// Returns e to the power of a number between −700 and 700, computed with exactly rounded operations only.
pub fn exp(value: f64) -> f64 {
    // e^x = 2^n · e^r, with r between −ln 2 / 2 and ln 2 / 2.
    let exponent = (value / std::f64::consts::LN_2).round();
    let rest = value - exponent * std::f64::consts::LN_2;
    let (mut term, mut sum) = (1.0, 1.0);
    for factor in 1..20 {
        term *= rest / f64::from(factor);
        sum += term;
    }
    sum * f64::from_bits(((exponent as i64 + 1023) as u64) << 52)
}

/// The nats of one step of a stored log-probability.
pub const NATS_PER_STEP: f32 = 0.1;

/// Returns the byte that stores a log-probability: 1 for 1 and the most likely, 255 for the least likely.
pub fn quantize(log_probability: f64) -> u8 {
    (-log_probability / f64::from(NATS_PER_STEP))
        .round()
        .clamp(1.0, 255.0) as u8
}

/// Returns the log-probability of a stored byte.
pub fn nats(byte: u8) -> f32 {
    f32::from(byte) * -NATS_PER_STEP
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_agrees_with_the_library_of_the_system() {
        for value in [
            1e-9, 0.003, 0.5, 0.999, 1.0, 1.4, 1.5, 2.0, 12345.678, 1e12_f64,
        ] {
            let error = (ln(value) - value.ln()).abs();
            assert!(
                error < 1e-13 * value.ln().abs().max(1.0),
                "{value}: {error}"
            );
        }
    }

    #[test]
    fn powers_agree_with_the_library_of_the_system() {
        for value in [-700.0, -99.0, -1.5, -0.3, 0.0, 0.34, 0.35, 2.0, 700.0_f64] {
            let error = exp(value) / value.exp() - 1.0;
            assert!(error.abs() < 1e-13, "{value}: {error}");
        }
    }

    #[test]
    fn a_stored_probability_is_off_by_half_a_step() {
        for probability in [0.9_f64, 0.1, 1e-3, 1e-8] {
            let stored = nats(quantize(probability.ln()));
            assert!(
                (f64::from(stored) - probability.ln()).abs() <= 0.051,
                "{probability}"
            );
        }
        assert_eq!(quantize(-1e9), 255);
    }
}
