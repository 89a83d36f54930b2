//! The values of a channel: gain and offset of its joints, direction and range.

use std::ops::RangeInclusive;

use eframe::egui::{self, DragValue};

use super::named_number;
use crate::glove_editor::{GloveEditor, MAX_FULL_RANGE_DEG, MIN_FULL_RANGE_DEG};
use crate::joint_names::joint_name;
use crate::panels::{PanelContext, is_other_number, typed_number};
use crate::sensor_control::SensorControl;
use crate::sensors::{ChannelJoint, SensorRow};
use crate::texts::text;

/// Decimals of a number that is shown.
const DECIMALS: usize = 1;

/// Creates a number with a range. A value of the file beyond the range stays until it is changed.
fn number(value: &mut f64, range: RangeInclusive<f64>) -> DragValue<'_> {
    DragValue::new(value)
        .range(range)
        .clamp_existing_to_range(false)
        .custom_parser(typed_number)
        .max_decimals(DECIMALS)
}

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext, row: &SensorRow) {
    let full_scale = f64::from(context.session.sensors.full_scale());
    let sensors = &mut *context.sensors;
    egui::Frame::group(ui.style()).show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        let grid = egui::Grid::new("values").num_columns(2);
        grid.spacing([12.0, 4.0]).show(ui, |ui| {
            for joint in &row.joints {
                show_joint(ui, sensors, joint, full_scale, row.joints.len() > 1);
            }
            show_inversion(ui, sensors, row.channel);
            show_range(ui, sensors, row.channel, full_scale);
        });
        if ui.button(text("value-plot")).clicked()
            && let Some(joint) = row.joints.first()
        {
            sensors.set_traced(joint.row);
        }
    });
    // The next movement of the mouse, or the next typed number, is undone on its own.
    if !ui.input(|input| input.pointer.any_down()) {
        sensors.edit(GloveEditor::close_edit);
    }
}

fn show_joint(
    ui: &mut egui::Ui,
    sensors: &mut SensorControl,
    joint: &ChannelJoint,
    full_scale: f64,
    is_named: bool,
) {
    let Some(editor) = &sensors.editor else {
        return;
    };
    let row = joint.row;
    let old = (editor.full_range_deg(row).abs(), editor.zero_count(row));
    let (mut range, mut zero) = old;
    if is_named {
        ui.strong(joint_name(joint.dof));
        ui.end_row();
    }
    let value = number(&mut range, MIN_FULL_RANGE_DEG..=MAX_FULL_RANGE_DEG)
        .speed(0.5)
        .suffix("°");
    named_number(ui, "value-gain", "value-gain-hint", value);
    if is_other_number(old.0, range, DECIMALS) {
        sensors.edit(|edited| edited.set_full_range_deg(row, range));
    }
    ui.end_row();
    let zero_value = number(&mut zero, -full_scale..=2.0 * full_scale).speed(0.2);
    named_number(ui, "value-offset", "value-offset-hint", zero_value);
    if is_other_number(old.1, zero, DECIMALS) {
        sensors.edit(|edited| edited.set_zero_count(row, zero));
    }
    ui.end_row();
}

fn show_inversion(ui: &mut egui::Ui, sensors: &mut SensorControl, channel: usize) {
    let Some(editor) = &sensors.editor else {
        return;
    };
    let mut is_inverted = editor.is_inverted(channel);
    ui.label("");
    let checkbox = ui.checkbox(&mut is_inverted, text("value-inverted"));
    if checkbox
        .on_hover_text(text("value-inverted-hint"))
        .changed()
    {
        sensors.edit(|edited| edited.invert(channel));
    }
    ui.end_row();
}

fn show_range(ui: &mut egui::Ui, sensors: &mut SensorControl, channel: usize, full_scale: f64) {
    let Some(editor) = &sensors.editor else {
        return;
    };
    let range = editor.map().range(channel);
    let mut has_range = range.is_some();
    let checkbox = ui.checkbox(&mut has_range, text("value-range"));
    let label = checkbox.id;
    let mut new = match (
        checkbox.on_hover_text(text("value-range-hint")).changed(),
        has_range,
    ) {
        (true, true) => Some((0.0, full_scale)),
        (true, false) => None,
        (false, _) => range,
    };
    if let Some((low, high)) = &mut new {
        ui.horizontal(|ui| {
            ui.add(end(low, full_scale)).labelled_by(label);
            ui.label("–");
            ui.add(end(high, full_scale)).labelled_by(label);
        });
    }
    ui.end_row();
    let is_changed = match (range, new) {
        (Some((low, high)), Some((new_low, new_high))) => {
            is_other_number(low, new_low, DECIMALS) || is_other_number(high, new_high, DECIMALS)
        }
        _ => new != range,
    };
    if is_changed {
        sensors.edit(|edited| edited.set_range(channel, new));
    }
}

fn end(count: &mut f64, full_scale: f64) -> DragValue<'_> {
    number(count, 0.0..=full_scale).speed(0.2)
}
