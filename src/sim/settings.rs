//! Settings of a simulated person.

use std::time::Duration;

/// Settings of a simulated person.
#[derive(Clone, Debug, PartialEq)]
pub struct TypistSettings {
    /// Name of the source.
    pub name: String,
    /// Time between two packets of the glove.
    pub packet_period: Duration,
    /// Standard deviation of the noise of each channel, in counts; 0 for none.
    pub noise_counts: f64,
    /// Seed of the noise.
    pub seed: u64,
}
