//! The bar of a channel: count, calibrated range, and the limits of its joints.

use eframe::egui::{self, Color32, Pos2, Rect, Shape, Stroke};

use crate::sensors::{ChannelState, SensorRow, SensorTable};
use crate::texts::text_with;
use ademan_core::estimate::CountRange;

/// Height of the bar, in points.
const HEIGHT: f32 = 10.0;

/// Size of the mark of a limit, in points.
const MARK: f32 = 4.0;

/// The bar of a channel.
pub struct CountBar<'a> {
    /// The channels.
    pub table: &'a SensorTable,
    /// The channel.
    pub row: &'a SensorRow,
    /// A range that is shaded.
    pub range: Option<CountRange>,
}

impl CountBar<'_> {
    /// Draws the bar with a width in points.
    pub fn show(&self, ui: &mut egui::Ui, width: f32) -> egui::Response {
        let size = egui::vec2(width, HEIGHT + MARK);
        let (area, response) = ui.allocate_exact_size(size, egui::Sense::hover());
        let name = self.name();
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::accesskit::Role::ProgressIndicator, true, &name)
        });
        let bar = area.with_min_y(area.min.y + MARK);
        let painter = ui.painter_at(area.expand(MARK));
        let visuals = ui.visuals();
        painter.rect_filled(bar, 2.0, visuals.extreme_bg_color);
        let x = |count: f64| bar.min.x + self.table.fraction(count) * bar.width();
        if let Some((low, high)) = self.range {
            let range = Rect::from_x_y_ranges(x(low)..=x(high), bar.y_range());
            painter.rect_filled(range, 0.0, visuals.weak_text_color().gamma_multiply(0.35));
        }
        if let Some(count) = self.row.count {
            let end = x(f64::from(count)).max(bar.min.x + 1.0);
            let filled = bar.with_max_x(end).shrink2(egui::vec2(0.0, 2.0));
            painter.rect_filled(filled, 1.0, state_color(self.table.state(self.row)));
        }
        painter.rect_stroke(
            bar,
            2.0,
            Stroke::new(1.0, visuals.weak_text_color()),
            egui::StrokeKind::Inside,
        );
        let limits = self.row.joints.iter().flat_map(|joint| joint.limits);
        for count in limits.flatten() {
            painter.add(mark(Pos2::new(x(count), bar.min.y), visuals.text_color()));
        }
        response
    }

    fn name(&self) -> String {
        let channel = ("channel", self.row.channel.into());
        match self.row.count {
            Some(count) => text_with("sensor-count-name", &[channel, ("count", count.into())]),
            None => text_with("sensor-no-count", &[channel]),
        }
    }
}

/// Returns a triangle that points down at a limit.
fn mark(tip: Pos2, color: Color32) -> Shape {
    let corners = vec![
        tip,
        tip + egui::vec2(-MARK * 0.8, -MARK),
        tip + egui::vec2(MARK * 0.8, -MARK),
    ];
    Shape::convex_polygon(corners, color, Stroke::NONE)
}

/// Returns the color of a state, which text and a sign repeat.
pub(super) fn state_color(state: ChannelState) -> Color32 {
    match state {
        ChannelState::Good => Color32::from_rgb(0x3b, 0x82, 0xc4),
        ChannelState::Stuck => Color32::from_rgb(0xc2, 0x84, 0x1e),
        ChannelState::Missing | ChannelState::AtLowEnd | ChannelState::AtHighEnd => {
            Color32::from_rgb(0xd9, 0x4f, 0x4f)
        }
    }
}
