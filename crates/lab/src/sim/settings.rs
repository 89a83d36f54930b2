//! Settings of a simulated person.

use std::time::Duration;

use super::motor::TypingKeys;
use crate::layout::Person;

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
    /// Seed of the noise and of the errors of the person.
    pub seed: u64,
    /// The person.
    pub person: Person,
    /// The keys by which the fingers find theirs.
    pub keys: TypingKeys,
}
