//! The parameters of one channel from its holds.

use super::holds::Hold;

/// The fewest holds of each kind for a parameter.
pub const MIN_CYCLES: usize = 3;

/// The fraction of the range at each end that counts as that end.
const END: f64 = 0.2;

/// The smallest range of a sensor that was bent, as a fraction of the full scale.
const MIN_RANGE: f64 = 0.03;

/// The parameters of a bend sensor. Their formulas are at the start of `calibrate/sensors/mod.rs`.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorParameters {
    /// The index of the channel.
    pub channel: usize,
    /// The number of holds of each kind.
    pub holds: HoldCounts,
    /// The mean counts at the low and the high end. `None` if the channel was not held still at both.
    pub ends: Option<(f64, f64)>,
    /// The standard deviation of a count while the hand is still, in counts. `None` without a hold.
    pub jitter: Option<f64>,
    /// The hysteresis in counts: the mean count of the half-bent pose approached from the high end, minus the mean approached from
    /// the low end.
    pub hysteresis: Option<f64>,
    /// The standard deviation of a pose that is taken again, in counts.
    pub repeatability: Option<f64>,
    /// The change of all poses with time.
    pub drift: Option<Drift>,
}

/// The change of the count of a pose with time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// The change, in counts per minute.
    pub per_minute: f64,
    /// The standard error of the change, in counts per minute.
    pub standard_error: f64,
}

/// The number of holds of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HoldCounts {
    /// Holds at the low end of the range.
    pub low: usize,
    /// Holds at the high end.
    pub high: usize,
    /// Holds half-way, from the low end.
    pub rising: usize,
    /// Holds half-way, from the high end.
    pub falling: usize,
}

/// The holds of one kind.
#[derive(Default)]
struct Group(Vec<Hold>);

impl Group {
    fn mean(&self, value: impl Fn(&Hold) -> f64) -> f64 {
        self.0.iter().map(value).sum::<f64>() / self.0.len() as f64
    }

    /// Returns Σ (t − t̄)² and Σ (t − t̄)(y − ȳ).
    fn moments(&self) -> (f64, f64) {
        let (minute, mean) = (self.mean(|hold| hold.minute), self.mean(|hold| hold.mean));
        let moments = self.0.iter().map(|hold| {
            let elapsed = hold.minute - minute;
            (elapsed * elapsed, elapsed * (hold.mean - mean))
        });
        moments.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1))
    }

    /// Returns the sum of squared deviations from a line of this slope.
    fn residuals(&self, slope: f64) -> f64 {
        let level = self.mean(|hold| hold.mean - slope * hold.minute);
        let deviations = self.0.iter();
        deviations
            .map(|hold| (hold.mean - slope * hold.minute - level).powi(2))
            .sum()
    }
}

/// The kind of a hold: its end of the range, if it is at one.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Level {
    Low,
    Middle,
    High,
}

impl SensorParameters {
    /// Returns the parameters of a channel. A parameter for which holds are missing is `None`.
    pub(super) fn new(channel: usize, full_scale: u16, holds: &[Hold]) -> Self {
        let degrees: usize = holds.iter().map(|hold| hold.degrees).sum();
        let squares: f64 = holds.iter().map(|hold| hold.squares).sum();
        let mut parameters = Self {
            channel,
            holds: HoldCounts::default(),
            ends: None,
            jitter: (degrees > 0).then(|| (squares / degrees as f64).sqrt()),
            hysteresis: None,
            repeatability: None,
            drift: None,
        };
        let [low, high, rising, falling] = groups(holds, full_scale);
        parameters.holds = HoldCounts {
            low: low.0.len(),
            high: high.0.len(),
            rising: rising.0.len(),
            falling: falling.0.len(),
        };
        if low.0.is_empty() || high.0.is_empty() {
            return parameters;
        }
        parameters.ends = Some((low.mean(|hold| hold.mean), high.mean(|hold| hold.mean)));
        if low.0.len().min(high.0.len()) < MIN_CYCLES {
            return parameters;
        }
        let is_half_way = rising.0.len().min(falling.0.len()) >= MIN_CYCLES;
        let ends = [&low, &high];
        let half_way = is_half_way.then_some([&rising, &falling]);
        let groups: Vec<&Group> = ends
            .into_iter()
            .chain(half_way.into_iter().flatten())
            .collect();
        let moments = groups.iter().map(|group| group.moments());
        let (times, products) =
            moments.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        let slope = products / times;
        let hold_count: usize = groups.iter().map(|group| group.0.len()).sum();
        let residuals: f64 = groups.iter().map(|group| group.residuals(slope)).sum();
        let deviation = (residuals / (hold_count - groups.len() - 1) as f64).sqrt();
        parameters.repeatability = Some(deviation);
        parameters.drift = Some(Drift {
            per_minute: slope,
            standard_error: deviation / times.sqrt(),
        });
        let level = |group: &Group| group.mean(|hold| hold.mean - slope * hold.minute);
        parameters.hysteresis = is_half_way.then(|| level(&falling) - level(&rising));
        parameters
    }

    /// Returns the difference between the counts at both ends, or `None` if the channel was not held at both.
    pub fn span(&self) -> Option<f64> {
        self.ends.map(|(low, high)| high - low)
    }

    /// Returns the missing holds in words, or `None` if there are enough for all parameters.
    pub fn missing(&self) -> Option<String> {
        let HoldCounts {
            low,
            high,
            rising,
            falling,
        } = self.holds;
        if low + high == 0 {
            return Some("it was not bent, or not held still".into());
        }
        let kinds = [
            (low, "at the low end"),
            (high, "at the high end"),
            (rising, "half-way from the low end"),
            (falling, "half-way from the high end"),
        ];
        let missing: Vec<String> = kinds
            .iter()
            .filter(|(count, _)| *count < MIN_CYCLES)
            .map(|(count, kind)| format!("{count} of {MIN_CYCLES} holds {kind}"))
            .collect();
        (!missing.is_empty()).then(|| missing.join(", "))
    }
}

/// Returns the holds at the low end, at the high end, half-way from the low end and half-way from the high end.
fn groups(holds: &[Hold], full_scale: u16) -> [Group; 4] {
    let mut groups: [Group; 4] = Default::default();
    let means = || holds.iter().map(|hold| hold.mean);
    let (low, high) = (
        means().fold(f64::INFINITY, f64::min),
        means().fold(f64::NEG_INFINITY, f64::max),
    );
    let range = high - low;
    if range.is_nan() || range < MIN_RANGE * f64::from(full_scale) {
        return groups;
    }
    let level = |hold: &Hold| match (hold.mean - low) / (high - low) {
        fraction if fraction <= END => Level::Low,
        fraction if fraction >= 1.0 - END => Level::High,
        _ => Level::Middle,
    };
    // The first hold has no previous one, so the side from which it was approached is unknown.
    for (index, hold) in holds.iter().enumerate().skip(1) {
        let before = level(&holds[index - 1]);
        let after = holds.get(index + 1).map(level);
        let group = match (before, level(hold), after) {
            (_, Level::Low, _) => 0,
            (_, Level::High, _) => 1,
            (Level::Low, Level::Middle, Some(Level::High)) => 2,
            (Level::High, Level::Middle, Some(Level::Low)) => 3,
            _ => continue,
        };
        groups[group].0.push(*hold);
    }
    groups
}
