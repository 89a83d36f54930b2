//! The values of controls and axes.

use ademan::contact::TargetId;
use ademan::layout::{Control, Handle, Layout};
use ademan::message::escape;
use ademan::session::view::View;
use ratatui::text::{Line, Span};

use super::cut::cut;

/// Columns of a value, of its name and of its bar.
const COLUMNS: usize = 26;
const NAME_COLUMNS: usize = 12;
const BAR_COLUMNS: usize = 6;
const LABEL_COLUMNS: usize = COLUMNS - NAME_COLUMNS - 1;

/// Returns the value of a control, which is the initial one until the control is moved.
pub fn value_of(view: &View, target: TargetId) -> Option<f32> {
    let mut values = view.state.values.iter();
    let value = values.find(|(known, _)| *known == target);
    value
        .map(|(_, value)| *value)
        .or_else(|| view.layout.initial_value(target))
}

/// Returns the label of the value of a control, such as the highlighted sector of a radial menu; `None` without one.
pub fn label_of(view: &View, target: TargetId) -> Option<&str> {
    let (control, _) = view.layout.value_at(target)?;
    control.kind.value_label(value_of(view, target)?)
}

/// Returns the values of all controls that have one, several in a line.
pub fn lines(view: &View, width: u16) -> Vec<Line<'static>> {
    let names = view.layout.target_names();
    let controls = view.layout.controls.iter();
    let mut targets: Vec<TargetId> = controls
        .flat_map(Control::value_targets)
        .filter(|target| view.layout.initial_value(*target).is_some())
        .collect();
    for (target, _) in &view.state.values {
        if !targets.contains(target) {
            targets.push(*target);
        }
    }
    let values = targets.iter().filter_map(|&target| {
        let name = names.get(target).to_string();
        let shown = value_of(view, target)?;
        Some(match label_of(view, target) {
            Some(label) => cell(&name, &cut(&escape(label), LABEL_COLUMNS as u16)),
            None => value(&name, shown, range(&view.layout, target)),
        })
    });
    let axes = view.state.axes.iter();
    let axes = axes.map(|(axis, position)| value(axis.name(), *position, Range::Signed));
    let cells: Vec<String> = values.chain(axes).collect();
    let in_line = (usize::from(width) / COLUMNS).max(1);
    let lines = cells.chunks(in_line);
    lines
        .map(|run| Line::from(Span::raw(run.concat())))
        .collect()
}

/// The range of a value.
#[derive(Clone, Copy)]
enum Range {
    /// 0..=1.
    Fraction,
    /// −1..=1.
    Signed,
    /// A number of turns.
    Turns,
    /// Off and on.
    Switch,
}

fn range(layout: &Layout, target: TargetId) -> Range {
    let control = layout.value_at(target);
    match control.map(|(control, _)| control.kind.handle()) {
        Some(Handle::Switch) => Range::Switch,
        Some(Handle::Turn {
            is_endless: true, ..
        }) => Range::Turns,
        _ => Range::Fraction,
    }
}

fn value(name: &str, value: f32, range: Range) -> String {
    let shown = match range {
        Range::Switch => if value > 0.5 { "on" } else { "off" }.to_owned(),
        Range::Turns => format!("{value:.2} turns"),
        Range::Fraction => format!("▕{}▏{value:.2}", bar(value)),
        Range::Signed => format!("▕{}▏{value:.2}", bar((value + 1.0) / 2.0)),
    };
    cell(name, &shown)
}

fn cell(name: &str, shown: &str) -> String {
    let name = escape(name);
    let name = cut(&name, NAME_COLUMNS as u16);
    format!("{name:NAME_COLUMNS$} {shown:LABEL_COLUMNS$}")
}

fn bar(fraction: f32) -> String {
    let filled = (fraction.clamp(0.0, 1.0) * BAR_COLUMNS as f32).round() as usize;
    "█".repeat(filled) + &"░".repeat(BAR_COLUMNS - filled)
}
