use ademan::estimate::{OneEuroFilter, OneEuroSettings};
use serde_json::Value;

use super::check::{assert_close, list, number, numbers, text};

/// Checks the filter at the times of the samples. The first sample passes unchanged, and each later one has the time since the last
/// one, so the initial frequency of the reference has no effect.
pub fn filter(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["absolute"]);
    let cases = list(&file["cases"]);
    for case in cases {
        let settings = OneEuroSettings {
            min_cutoff_hz: number(&case["min_cutoff_hz"]),
            beta: number(&case["beta"]),
            derivative_cutoff_hz: number(&case["derivative_cutoff_hz"]),
        };
        let mut filter = OneEuroFilter::new(settings);
        let (times, values) = (numbers(&case["times"]), numbers(&case["values"]));
        let mut last = times.first().copied().unwrap_or_default();
        for ((time, value), wanted) in times.iter().zip(values).zip(numbers(&case["filtered"])) {
            let mut filtered = [value];
            filter.filter(&mut filtered, time - last);
            assert_close(filtered[0], wanted, tolerance, text(&case["name"]));
            last = *time;
        }
    }
    cases.len()
}
