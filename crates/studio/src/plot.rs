//! The time axis of plots, and the reduction of lines to what a screen can show.

/// The shortest time that a plot shows, in seconds.
const MIN_SPAN: f64 = 0.05;

/// The part of the time axis that a plot shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeWindow {
    /// Length in seconds.
    pub span: f64,
    /// Time from the end of the window to the latest value, in seconds.
    pub age: f64,
}

impl TimeWindow {
    /// Returns a window of this length at the latest value.
    pub fn new(span: f64) -> Self {
        Self { span, age: 0.0 }
    }

    /// Changes the length by a factor. The time at `fraction` of the width stays where it is, but no window is longer or older
    /// than `longest` seconds.
    pub fn zoom(&mut self, factor: f64, fraction: f64, longest: f64) {
        let span = (self.span * factor).clamp(MIN_SPAN, longest);
        self.age += (self.span - span) * (1.0 - fraction);
        self.span = span;
        self.limit(longest);
    }

    /// Moves the window by a fraction of its length, to older times if positive.
    pub fn pan(&mut self, fraction: f64, longest: f64) {
        self.age += fraction * self.span;
        self.limit(longest);
    }

    fn limit(&mut self, longest: f64) {
        self.age = self.age.clamp(0.0, (longest - self.span).max(0.0));
    }
}

/// The values of a line within one column of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Index of the column.
    pub index: usize,
    /// The smallest value.
    pub min: f32,
    /// The largest value.
    pub max: f32,
}

/// Reduces a line to at most one [`Column`] per pixel, so that the cost of a frame does not depend on the rate of readings and
/// no peak is lost.
///
/// `values` are times in seconds, ascending, with a value; NaN is no value. The time `from` is at the left end of the first of
/// `columns` columns, and `to` at the right end of the last one.
pub fn decimate(
    values: impl Iterator<Item = (f64, f32)>,
    from: f64,
    to: f64,
    columns: usize,
) -> Vec<Column> {
    let mut reduced: Vec<Column> = Vec::new();
    let scale = columns as f64 / (to - from);
    for (time, value) in values {
        if !(from..=to).contains(&time) || value.is_nan() {
            continue;
        }
        let index = (((time - from) * scale) as usize).min(columns.saturating_sub(1));
        match reduced.last_mut() {
            Some(last) if last.index == index => {
                last.min = last.min.min(value);
                last.max = last.max.max(value);
            }
            _ => reduced.push(Column {
                index,
                min: value,
                max: value,
            }),
        }
    }
    reduced
}

/// Returns a step of 1, 2 or 5 times a power of ten that divides `length` into at most `count` parts.
pub fn grid_step(length: f64, count: usize) -> f64 {
    let rough = length / count.max(1) as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    let fits = |step: &f64| *step >= rough * (1.0 - 1e-9);
    steps.into_iter().find(fits).unwrap_or(10.0 * power)
}

/// Returns the multiples of `step` from `low` to `high`.
pub fn grid_lines(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(move |index| index as f64 * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_peak_is_lost() {
        let values = (0..10_000).map(|i| {
            let peak = if i == 5_003 { 90.0 } else { 0.0 };
            (f64::from(i) * 1e-3, peak)
        });
        let columns = decimate(values, 0.0, 10.0, 100);
        assert_eq!(columns.len(), 100);
        let peaks: Vec<_> = columns.iter().filter(|column| column.max > 0.0).collect();
        assert_eq!((peaks.len(), peaks[0].index, peaks[0].max), (1, 50, 90.0));
    }

    #[test]
    fn each_column_has_the_extremes_of_its_values() {
        let values = [
            (0.1, 3.0),
            (0.2, -1.0),
            (0.3, f32::NAN),
            (1.5, 7.0),
            (2.0, 8.0),
        ];
        let column = |index, min, max| Column { index, min, max };
        let reduced = decimate(values.into_iter(), 0.0, 2.0, 2);
        assert_eq!(reduced, [column(0, -1.0, 3.0), column(1, 7.0, 8.0)]);
    }

    #[test]
    fn values_outside_the_window_are_left_out() {
        let values = [(0.0, 1.0), (5.0, 2.0), (9.0, 3.0)];
        let reduced = decimate(values.into_iter(), 4.0, 6.0, 10);
        assert_eq!(reduced.len(), 1);
        assert_eq!(reduced[0].index, 5);
    }

    #[test]
    fn zooming_keeps_the_time_below_the_pointer() {
        let mut window = TimeWindow::new(20.0);
        window.pan(0.25, 30.0);
        // A quarter of the window from the left, 15 s before its end.
        let below = window.age + 15.0;
        window.zoom(0.5, 0.25, 30.0);
        assert_eq!(window.span, 10.0);
        assert!((window.age + 7.5 - below).abs() < 1e-9);
    }

    #[test]
    fn a_window_stays_within_the_values() {
        let mut window = TimeWindow::new(20.0);
        window.pan(9.0, 30.0);
        assert_eq!((window.age, window.span), (10.0, 20.0));
        window.zoom(100.0, 0.5, 30.0);
        assert_eq!((window.age, window.span), (0.0, 30.0));
        window.zoom(1e-9, 0.5, 30.0);
        assert_eq!(window.span, MIN_SPAN);
    }

    #[test]
    fn grids_have_round_steps() {
        let table = [
            (30.0, 6, 5.0),
            (30.0, 5, 10.0),
            (0.7, 5, 0.2),
            (200.0, 4, 50.0),
        ];
        for (length, count, step) in table {
            assert!(
                (grid_step(length, count) - step).abs() < 1e-9,
                "{length} {count}"
            );
        }
        let lines: Vec<f64> = grid_lines(-7.0, 11.0, 5.0).collect();
        assert_eq!(lines, [-5.0, 0.0, 5.0, 10.0]);
    }
}
