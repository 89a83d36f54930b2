//! Settings of a simulated person.

use std::time::Duration;

/// Settings of a simulated person.
#[derive(Clone, Debug, PartialEq)]
pub struct TypistSettings {
    /// Name of the source.
    pub name: String,
    /// Time between two packets of the sensor.
    pub packet_period: Duration,
    /// Standard deviation of the noise of each value, 0 for none: counts of a glove, millimetres of positions, degrees of
    /// angles.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
}
