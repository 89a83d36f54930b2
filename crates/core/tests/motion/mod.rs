//! Movements of simulated fingertips, and the noise of their positions.

/// Returns the part of a movement of minimum jerk that is done at a part of its time; 0 before it and 1 after it.
pub fn minimum_jerk(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
}

/// Returns a nearly normal number with mean 0 and standard deviation 1: the sum of twelve uniform numbers.
pub fn normal(random: &mut fastrand::Rng) -> f32 {
    (0..12).map(|_| random.f32()).sum::<f32>() - 6.0
}
