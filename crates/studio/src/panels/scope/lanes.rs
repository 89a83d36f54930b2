//! The rows of the scope: angles, heights, latency, presses by finger, and the keys and values that were sent.

use eframe::egui::{Align2, Color32, Pos2, Rangef, Rect};

use super::Rows;
use super::canvas::{Canvas, LABEL_MARGIN};
use crate::history::{History, Moment};
use crate::joint_names::{self, finger_of_side, joint_name};
use crate::texts::text;
use ademan_core::hand::{Dof, Finger, Side};
use ademan_core::time::Timestamp;

/// Height of the presses of one finger, in points.
const FINGER_ROW: f32 = 10.0;

/// Height of the names of the lines of a plot, in points.
const LEGEND: f32 = 14.0;

/// Height of the row of events, in points.
const EVENT_ROW: f32 = 15.0;

/// Heights that the row of fingertips shows at least, in millimetres.
const HEIGHTS_MM: (f32, f32) = (-15.0, 60.0);

/// Draws all rows that are chosen. Presses and events have a fixed height; the plots share the rest.
pub fn draw(canvas: &Canvas, angles: &[bool; Dof::COUNT], rows: Rows) {
    let mut rest = canvas.area;
    if rows.events {
        let row = take_bottom(&mut rest, EVENT_ROW);
        draw_events(canvas, row);
    }
    if rows.presses {
        for (side, finger) in pressing_fingers(canvas.history).into_iter().rev() {
            let row = take_bottom(&mut rest, FINGER_ROW);
            draw_presses(canvas, row, side, finger);
        }
    }
    let has_angles = angles.contains(&true);
    let plots = [has_angles, rows.heights, rows.latency];
    let count = plots.iter().filter(|is_shown| **is_shown).count();
    let height = rest.height() / count.max(1) as f32;
    let draws: [&dyn Fn(Rect); 3] = [
        &|row| draw_angles(canvas, row, angles),
        &|row| draw_heights(canvas, row),
        &|row| draw_latency(canvas, row),
    ];
    for (draw, _) in draws.iter().zip(plots).filter(|(_, is_shown)| *is_shown) {
        draw(take_top(&mut rest, height));
    }
}

/// Returns the lines that describe a time: its values in all rows that are chosen.
pub fn values_at(
    history: &History,
    time: Timestamp,
    angles: &[bool; Dof::COUNT],
    rows: Rows,
) -> Vec<String> {
    let (Some(moment), Some(end)) = (history.at(time), history.end()) else {
        return Vec::new();
    };
    let age = end.since(moment.time).as_secs_f64();
    let mut lines = vec![format!("−{age:.3} s")];
    for dof in shown(angles) {
        let degrees = moment.degrees[dof.index()];
        if !degrees.is_nan() {
            lines.push(format!("{}: {degrees:.1}°", joint_name(dof)));
        }
    }
    if rows.heights {
        for (side, finger) in fingers() {
            let height = moment.heights_mm[side.index()][finger.index()];
            if !height.is_nan() {
                let press = if moment.pressing[side.index()].contains(finger) {
                    " ▬"
                } else {
                    ""
                };
                lines.push(format!(
                    "{}: {height:.1} mm{press}",
                    finger_of_side(side, finger)
                ));
            }
        }
    }
    if rows.latency && !moment.latency_ms.is_nan() {
        let latency = moment.latency_ms;
        lines.push(format!("{}: {latency:.2} ms", text("scope-latency")));
    }
    lines
}

fn draw_angles(canvas: &Canvas, row: Rect, angles: &[bool; Dof::COUNT]) {
    let values = |dof: Dof| move |moment: &Moment| moment.degrees[dof.index()];
    let lowest = shown(angles).map(|dof| extremes(canvas.history, values(dof)));
    let range = lowest.fold((0.0_f32, 45.0_f32), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (mut legend, row) = Legend::split_off(canvas, row);
    canvas.draw_axis(row, range, "°");
    for (dof, color) in shown(angles).zip(canvas.colors.lines.into_iter().cycle()) {
        draw_line(canvas, row, range, color, values(dof));
        legend.add(&joint_name(dof), color);
    }
}

fn draw_heights(canvas: &Canvas, row: Rect) {
    let known = known_fingers(canvas.history);
    let height = |(side, finger): (Side, Finger)| {
        move |moment: &Moment| moment.heights_mm[side.index()][finger.index()]
    };
    let heights = known.iter().map(|it| extremes(canvas.history, height(*it)));
    let range = heights.fold(HEIGHTS_MM, |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (mut legend, row) = Legend::split_off(canvas, row);
    canvas.draw_axis(row, range, "mm");
    for &(side, finger) in &known {
        let color = canvas.colors.lines[finger.index()];
        draw_line(canvas, row, range, color, height((side, finger)));
        legend.add(&finger_name(&known, side, finger), color);
    }
}

fn draw_latency(canvas: &Canvas, row: Rect) {
    let latency = |moment: &Moment| moment.latency_ms;
    let (_, highest) = extremes(canvas.history, latency);
    let range = (0.0, highest.max(1.0));
    let (mut legend, row) = Legend::split_off(canvas, row);
    canvas.draw_axis(row, range, "ms");
    let color = canvas.colors.lines[4];
    draw_line(canvas, row, range, color, latency);
    legend.add(text("scope-latency"), color);
}

/// Draws a line through values, with a gap where readings are missing.
fn draw_line(
    canvas: &Canvas,
    row: Rect,
    range: (f32, f32),
    color: Color32,
    value: impl Fn(&Moment) -> f32,
) {
    let mut moments = canvas.history.moments().peekable();
    while moments.peek().is_some() {
        let until_gap = moments.by_ref().take_while(|moment| !moment.is_gap());
        let values = until_gap.map(|moment| (moment.time.seconds(), value(moment)));
        canvas.draw_line(row, range, color, values);
    }
}

/// Draws the presses of one finger as bars.
fn draw_presses(canvas: &Canvas, row: Rect, side: Side, finger: Finger) {
    let known = known_fingers(canvas.history);
    let at = Pos2::new(row.min.x - LABEL_MARGIN, row.center().y);
    let name = finger_name(&known, side, finger);
    canvas.text(at, Align2::RIGHT_CENTER, &name, canvas.weak);
    let bar = row.y_range().shrink(1.0);
    let mut start = None;
    for moment in canvas.history.moments() {
        let is_pressing = moment.pressing[side.index()].contains(finger);
        match (is_pressing, start) {
            (true, None) => start = Some(moment.time.seconds()),
            (false, Some(from)) => {
                canvas.draw_bar(bar, from, moment.time.seconds(), canvas.colors.press);
                start = None;
            }
            _ => {}
        }
    }
    if let (Some(from), Some(end)) = (start, canvas.history.end()) {
        canvas.draw_bar(bar, from, end.seconds(), canvas.colors.press);
    }
}

/// Distance of the name of a key from its tick, in points.
const NAME_GAP: f32 = 2.0;

/// An entry of the row of events.
struct Tick {
    time: Timestamp,
    name: String,
    /// It begins in the middle of the row: a release.
    is_short: bool,
}

/// Returns the keys and values that were sent in the part of the time that is shown, oldest first.
fn ticks(canvas: &Canvas) -> Vec<Tick> {
    let keys = canvas.history.events().map(|event| Tick {
        time: event.time,
        name: format!("{}{}", event.key, if event.is_press { '↓' } else { '↑' }),
        is_short: !event.is_press,
    });
    let values = canvas.history.values().map(|sent| Tick {
        time: sent.time,
        name: sent.to_string(),
        is_short: false,
    });
    let ticks = keys.chain(values);
    let mut shown: Vec<Tick> = ticks
        .filter(|tick| canvas.shows(tick.time.seconds()))
        .collect();
    shown.sort_by_key(|tick| tick.time);
    shown
}

/// Draws presses and values as ticks with the name of the key or control, and releases as short ticks. A name that has no room beside
/// its tick is left out; zooming makes room.
fn draw_events(canvas: &Canvas, row: Rect) {
    let label_at = Pos2::new(row.min.x - LABEL_MARGIN, row.center().y);
    canvas.text(
        label_at,
        Align2::RIGHT_CENTER,
        text("scope-events"),
        canvas.weak,
    );
    let mut shown = ticks(canvas).into_iter().peekable();
    let mut free_from = row.min.x;
    while let Some(event) = shown.next() {
        let time = event.time.seconds();
        let x = canvas.x_at(time);
        let top = if event.is_short {
            row.center().y
        } else {
            row.min.y
        };
        let (color, tick) = (canvas.strong, Rangef::new(top, row.max.y));
        canvas.draw_tick(tick, time, color.gamma_multiply(0.4));
        let name = event.name;
        let width = canvas.width_of(&name) + NAME_GAP;
        let next = shown.peek().map(|next| canvas.x_at(next.time.seconds()));
        let left = if x + width + NAME_GAP <= next.unwrap_or(row.max.x) {
            Some(x + NAME_GAP)
        } else {
            // A name at the end of the row would be cut off to the right of its tick.
            Some(x - width).filter(|left| next.is_none() && *left >= free_from)
        };
        free_from = x + NAME_GAP;
        if let Some(left) = left {
            let at = Pos2::new(left, row.center().y);
            canvas.text(at, Align2::LEFT_CENTER, &name, color);
            free_from = free_from.max(left + width);
        }
    }
}

/// The names of the lines of a plot, in one line at its top.
struct Legend<'a, 'b> {
    canvas: &'a Canvas<'b>,
    next: Pos2,
}

impl<'a, 'b> Legend<'a, 'b> {
    /// Returns a legend at the top of a row, and the rest of the row for the plot.
    fn split_off(canvas: &'a Canvas<'b>, row: Rect) -> (Self, Rect) {
        let next = row.min + [6.0, 1.0].into();
        let plot = row.with_min_y((row.min.y + LEGEND).min(row.max.y - 1.0));
        (Self { canvas, next }, plot)
    }

    fn add(&mut self, name: &str, color: Color32) {
        let drawn = self.canvas.text(self.next, Align2::LEFT_TOP, name, color);
        self.next.x = drawn.max.x + 10.0;
    }
}

fn shown(angles: &[bool; Dof::COUNT]) -> impl Iterator<Item = Dof> {
    let angles = Dof::ALL.iter().copied().zip(angles);
    angles.filter_map(|(dof, is_shown)| is_shown.then_some(dof))
}

fn fingers() -> impl Iterator<Item = (Side, Finger)> {
    let sides = Side::ALL.iter().copied();
    sides.flat_map(|side| Finger::ALL.iter().map(move |&finger| (side, finger)))
}

/// Returns the fingers whose height was known last.
fn known_fingers(history: &History) -> Vec<(Side, Finger)> {
    let last = history.last_known();
    let is_known = |(side, finger): &(Side, Finger)| {
        last.is_some_and(|last| !last.heights_mm[side.index()][finger.index()].is_nan())
    };
    fingers().filter(is_known).collect()
}

/// Returns the fingers that have pressed a target.
fn pressing_fingers(history: &History) -> Vec<(Side, Finger)> {
    let mut sets = [ademan_core::hand::FingerSet::NONE; Side::COUNT];
    for moment in history.moments() {
        for (set, pressing) in sets.iter_mut().zip(moment.pressing) {
            *set = set.union(pressing);
        }
    }
    let pressed = |(side, finger): &(Side, Finger)| sets[side.index()].contains(*finger);
    fingers().filter(pressed).collect()
}

/// Returns the name of a finger, with its side if both hands are known.
fn finger_name(known: &[(Side, Finger)], side: Side, finger: Finger) -> String {
    if known.iter().any(|(other, _)| *other != side) {
        finger_of_side(side, finger)
    } else {
        joint_names::finger_name(finger).to_owned()
    }
}

fn extremes(history: &History, value: impl Fn(&Moment) -> f32) -> (f32, f32) {
    let values = history.moments().map(value).filter(|value| !value.is_nan());
    values.fold((f32::MAX, f32::MIN), |(low, high), number| {
        (low.min(number), high.max(number))
    })
}

/// Returns the names beside the rows of presses and events.
pub fn row_names(history: &History, rows: Rows) -> Vec<String> {
    let known = known_fingers(history);
    let pressing = pressing_fingers(history).into_iter();
    let fingers = pressing.map(|(side, finger)| finger_name(&known, side, finger));
    let mut names: Vec<String> = fingers.filter(|_| rows.presses).collect();
    names.extend(rows.events.then(|| text("scope-events").to_owned()));
    names
}

/// Splits a row of this height off the lower edge.
fn take_bottom(rest: &mut Rect, height: f32) -> Rect {
    let top = (rest.max.y - height).max(rest.min.y);
    let row = rest.with_min_y(top);
    rest.max.y = top;
    row
}

/// Splits a row of this height off the upper edge.
fn take_top(rest: &mut Rect, height: f32) -> Rect {
    let bottom = (rest.min.y + height).min(rest.max.y);
    let row = rest.with_max_y(bottom);
    rest.min.y = bottom;
    row
}
