//! The figures of a layout that does not type.

use std::borrow::Cow;

use crate::measures::{Interval, PointingSummary, Summary};

/// A figure with its name and unit, the factor to that unit, and the digits after the point.
pub type Row = (Cow<'static, str>, Interval, f64, usize);

/// Returns the figures of tasks and of a pointer, as far as there are any.
pub fn task_rows(summary: &Summary) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    if let Some(pointing) = &summary.pointing {
        add_pointing(pointing, &mut rows);
    }
    let none = Interval::default();
    if summary.tasks_done == none && summary.task_seconds == none && summary.pointing.is_some() {
        return rows;
    }
    rows.extend([
        ("tasks done, %".into(), summary.tasks_done, 100.0, 1),
        (
            "presses of others, % of tries".into(),
            summary.tasks_wrong,
            100.0,
            1,
        ),
        ("time of a task, s".into(), summary.task_seconds, 1.0, 2),
    ]);
    if summary.value_seconds != none {
        rows.extend([
            (
                "time to set a value, s".into(),
                summary.value_seconds,
                1.0,
                2,
            ),
            (
                "error of a value, % of the range".into(),
                summary.task_error,
                100.0,
                1,
            ),
        ]);
    }
    rows
}

fn add_pointing(pointing: &PointingSummary, rows: &mut Vec<Row>) {
    rows.push((
        "effective throughput, bit/s".into(),
        pointing.throughput,
        1.0,
        2,
    ));
    if let Some(of_ideal) = pointing.of_ideal {
        rows.push(("  of an ideal cursor's, %".into(), of_ideal, 100.0, 0));
    }
    for (width, throughput, slips) in &pointing.by_width {
        rows.push((
            format!("  with targets of {width:.0} px").into(),
            *throughput,
            1.0,
            2,
        ));
        rows.push(("    clicks that slip off, %".into(), *slips, 100.0, 1));
    }
    rows.extend([
        (
            "time from click to click, s".into(),
            pointing.movement_s,
            1.0,
            2,
        ),
        (
            "clicks beside the target, %".into(),
            pointing.misses,
            100.0,
            1,
        ),
        (
            "way of the cursor, % straight".into(),
            pointing.path_efficiency,
            100.0,
            0,
        ),
        (
            "distance from the task axis, px".into(),
            pointing.axis_deviation_px,
            1.0,
            1,
        ),
        (
            "target re-entries by click".into(),
            pointing.reentries,
            1.0,
            2,
        ),
        ("targets given up, %".into(), pointing.given_up, 100.0, 1),
    ]);
}
