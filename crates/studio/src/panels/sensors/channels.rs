//! The channels: joints, bar, count and angle of each, and the values of the selected one.

use eframe::egui::{self, Align, RichText};

use super::bar::{CountBar, state_color};
use super::{ROW_HEIGHT, cell, values};
use crate::joint_names::joint_name;
use crate::panels::PanelContext;
use crate::sensors::{ChannelJoint, ChannelState, SensorRow};
use crate::texts::{text, text_with};

/// Width of the columns of counts and angles, in points.
const COUNT_WIDTH: f32 = 38.0;
const ANGLE_WIDTH: f32 = 52.0;

/// Width of the column of joints, as a fraction of the rest.
const JOINT_WIDTH: f32 = 0.70;

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    let table = &context.session.sensors;
    if !table.is_seen() {
        let is_waiting = context.session.stats.source.readings == 0;
        ui.label(if is_waiting {
            text("channel-no-reading")
        } else {
            text("channel-none")
        });
        return;
    }
    ui.spacing_mut().item_spacing.y = 2.0;
    let columns = Columns::new(ui);
    columns.show_names(ui);
    for row in table.rows() {
        columns.show_row(ui, context, row);
        if context.sensors.selected == Some(row.channel) {
            values::show(ui, context, row);
        }
    }
    ui.weak(text("sensor-bar-hint"));
}

/// The widths of the columns of joints and bars, in points.
struct Columns {
    joint: f32,
    bar: f32,
}

impl Columns {
    fn new(ui: &egui::Ui) -> Self {
        let gaps = 3.0 * ui.spacing().item_spacing.x;
        let rest = ui.available_width() - COUNT_WIDTH - ANGLE_WIDTH - gaps - 8.0;
        Self {
            joint: rest * JOINT_WIDTH,
            bar: rest * (1.0 - JOINT_WIDTH),
        }
    }

    fn show_names(&self, ui: &mut egui::Ui) {
        let [joint, bar] = [text("channel-joint"), text("sensor-bar")];
        let [count, angle] = [text("channel-count"), text("channel-angle")];
        ui.horizontal(|ui| {
            cell(ui, self.joint, Align::Min, |ui| _ = ui.weak(joint));
            cell(ui, self.bar, Align::Min, |ui| _ = ui.weak(bar));
            cell(ui, COUNT_WIDTH, Align::Max, |ui| _ = ui.weak(count));
            cell(ui, ANGLE_WIDTH, Align::Max, |ui| _ = ui.weak(angle));
        });
    }

    fn show_row(&self, ui: &mut egui::Ui, context: &mut PanelContext, row: &SensorRow) {
        let table = &context.session.sensors;
        let state = table.state(row);
        for (index, joint) in row.joints.iter().enumerate() {
            let is_first = index == 0;
            ui.horizontal(|ui| {
                cell(ui, self.joint, Align::Min, |ui| {
                    self.show_joint(ui, context, row, joint, is_first);
                });
                cell(ui, self.bar, Align::Min, |ui| {
                    if is_first {
                        let range = row.range;
                        CountBar { table, row, range }.show(ui, self.bar);
                    }
                });
                let count = row.count.filter(|_| is_first);
                cell(ui, COUNT_WIDTH, Align::Max, |ui| {
                    let count = count.map_or_else(String::new, |count| count.to_string());
                    ui.monospace(count);
                });
                let degrees = SensorRow::degrees(joint.dof, context.session.angles.as_ref());
                cell(ui, ANGLE_WIDTH, Align::Max, |ui| {
                    ui.monospace(degrees.map_or("–".to_owned(), |it| format!("{it:.0}°")));
                });
            });
        }
        if let Some((sign, text)) = sign_of(state) {
            let text = RichText::new(format!("    {sign} {text}"));
            ui.label(text.color(state_color(state)).strong());
        }
    }

    /// Adds the name of a joint. The name of the first joint selects the channel.
    fn show_joint(
        &self,
        ui: &mut egui::Ui,
        context: &mut PanelContext,
        row: &SensorRow,
        joint: &ChannelJoint,
        is_first: bool,
    ) {
        let name = joint_name(joint.dof);
        if !is_first {
            ui.add_space(ui.spacing().button_padding.x);
            ui.add(egui::Label::new(name).truncate());
            return;
        }
        let is_selected = context.sensors.selected == Some(row.channel);
        let button = egui::Button::selectable(is_selected, (name, egui::Atom::grow())).truncate();
        let response = ui.add_sized([self.joint, ROW_HEIGHT], button);
        let channel = ("channel", row.channel.into());
        let label = ("label", row.label.as_str().into());
        let hint = text_with("sensor-channel-hint", &[channel, label]);
        if response.on_hover_text(hint).clicked() {
            context.sensors.selected = (!is_selected).then_some(row.channel);
        }
    }
}

/// Returns a sign and the words for a fault, or `None` without one.
fn sign_of(state: ChannelState) -> Option<(&'static str, &'static str)> {
    match state {
        ChannelState::Good => None,
        ChannelState::Missing => Some(("×", text("sensor-missing"))),
        ChannelState::AtLowEnd => Some(("▼", text("sensor-low-end"))),
        ChannelState::AtHighEnd => Some(("▲", text("sensor-high-end"))),
        ChannelState::Stuck => Some(("■", text("sensor-stuck"))),
    }
}
