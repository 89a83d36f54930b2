//! The drawing area of the scope: its time axis, and lines and bars in rows of it.

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rangef, Rect, Stroke};

use super::colors::PlotColors;
use crate::history::History;
use crate::plot::{TimeWindow, decimate, grid_lines, grid_step};
use ademan_core::time::Timestamp;

/// Least width of the labels of the vertical axes, in points.
const AXIS_WIDTH: f32 = 58.0;

/// Space between a label and the edge of the scope, and between it and its row, in points.
pub const LABEL_MARGIN: f32 = 4.0;

/// Height of the labels of the time axis, in points.
const TIME_AXIS_HEIGHT: f32 = 15.0;

/// Space between two lines of the time grid, in points.
const GRID_SPACE: f32 = 90.0;

/// Size of the letters, in points.
const LETTERS: f32 = 10.5;

/// A part of the scope with its time axis.
pub struct Canvas<'a> {
    painter: egui::Painter,
    /// The area of the rows, without axes.
    pub area: Rect,
    pub history: &'a History,
    /// Time at the left edge, in seconds.
    from: f64,
    /// Time at the right edge, in seconds.
    to: f64,
    /// The latest time, in seconds.
    end: f64,
    pub weak: Color32,
    pub strong: Color32,
    pub colors: PlotColors,
}

impl<'a> Canvas<'a> {
    /// Draws the background, the grid and the time axis, with room for the names of rows. `None` if the area is too small.
    pub fn new(
        ui: &egui::Ui,
        area: Rect,
        history: &'a History,
        window: TimeWindow,
        names: &[String],
    ) -> Option<Self> {
        let axis_width = axis_width(ui, names);
        if area.width() < 2.0 * axis_width || area.height() < 2.0 * TIME_AXIS_HEIGHT {
            return None;
        }
        let end = history.end().unwrap_or_default().seconds();
        let to = end - window.age;
        let min = Pos2::new(area.min.x + axis_width, area.min.y);
        let max = Pos2::new(area.max.x - 6.0, area.max.y - TIME_AXIS_HEIGHT);
        let canvas = Self {
            painter: ui.painter_at(area),
            area: Rect::from_min_max(min, max),
            history,
            from: to - window.span,
            to,
            end,
            weak: ui.visuals().weak_text_color(),
            strong: ui.visuals().text_color(),
            colors: PlotColors::new(ui.visuals()),
        };
        let background = ui.visuals().extreme_bg_color;
        canvas.painter.rect_filled(canvas.area, 3.0, background);
        canvas.draw_time_grid();
        Some(canvas)
    }

    fn draw_time_grid(&self) {
        let count = (self.area.width() / GRID_SPACE) as usize;
        let step = grid_step(self.to - self.from, count);
        let digits = if step < 0.01 {
            3
        } else if step < 0.1 {
            2
        } else {
            usize::from(step < 1.0)
        };
        for age in grid_lines(self.from - self.end, self.to - self.end, step) {
            let x = self.x_at(self.end + age);
            let stroke = Stroke::new(0.5, self.weak.gamma_multiply(0.4));
            self.painter.vline(x, self.area.y_range(), stroke);
            let name = if age.abs() < step * 0.5 {
                "0 s".to_owned()
            } else {
                format!("−{:.digits$} s", -age)
            };
            let at = Pos2::new(x, self.area.max.y + 1.0);
            let is_at_end = x > self.area.max.x - 16.0;
            let align = if is_at_end {
                Align2::RIGHT_TOP
            } else {
                Align2::CENTER_TOP
            };
            self.text(at, align, &name, self.weak);
        }
    }

    /// Returns the horizontal position of a time in seconds.
    pub fn x_at(&self, seconds: f64) -> f32 {
        let fraction = (seconds - self.from) / (self.to - self.from);
        self.area.min.x + fraction as f32 * self.area.width()
    }

    /// Returns the time at a horizontal position, or `None` outside the rows.
    pub fn time_at(&self, x: f32) -> Option<Timestamp> {
        let fraction = f64::from((x - self.area.min.x) / self.area.width());
        let seconds = self.from + fraction * (self.to - self.from);
        self.area
            .x_range()
            .contains(x)
            .then(|| Timestamp::from_seconds(seconds))
    }

    /// Marks a time with a vertical line.
    pub fn mark(&self, time: Timestamp) {
        let stroke = Stroke::new(1.0, self.strong.gamma_multiply(0.6));
        let x = self.x_at(time.seconds());
        self.painter.vline(x, self.area.y_range(), stroke);
    }

    pub fn text(&self, at: Pos2, align: Align2, text: &str, color: Color32) -> Rect {
        let font = FontId::proportional(LETTERS);
        self.painter.text(at, align, text, font, color)
    }

    /// Returns the width of a text, in points.
    pub fn width_of(&self, text: &str) -> f32 {
        let font = FontId::proportional(LETTERS);
        let laid_out = self
            .painter
            .layout_no_wrap(text.to_owned(), font, self.strong);
        laid_out.size().x
    }

    /// Draws the vertical axis of a row from `low` to `high` with its unit.
    pub fn draw_axis(&self, row: Rect, (low, high): (f32, f32), unit: &str) {
        let count = (row.height() / 22.0) as usize;
        let step = grid_step(f64::from(high - low), count.max(1));
        for value in grid_lines(f64::from(low), f64::from(high), step) {
            let y = y_at(value as f32, row, (low, high));
            let stroke = Stroke::new(0.5, self.weak.gamma_multiply(0.25));
            self.painter.hline(row.x_range(), y, stroke);
            if (row.min.y + 6.0..=row.max.y - 6.0).contains(&y) {
                let at = Pos2::new(row.min.x - LABEL_MARGIN, y);
                let label = format!("{value:.0} {unit}").replace('-', "−");
                self.text(at, Align2::RIGHT_CENTER, &label, self.weak);
            }
        }
        let stroke = Stroke::new(1.0, self.weak.gamma_multiply(0.5));
        self.painter.hline(row.x_range(), row.max.y, stroke);
    }

    /// Draws a line through values at times in seconds, with all its peaks.
    pub fn draw_line(
        &self,
        row: Rect,
        range: (f32, f32),
        color: Color32,
        values: impl Iterator<Item = (f64, f32)>,
    ) {
        let columns = decimate(values, self.from, self.to, row.width() as usize);
        let mut points = Vec::with_capacity(2 * columns.len());
        for column in columns {
            let x = row.min.x + column.index as f32 + 0.5;
            points.push(Pos2::new(x, y_at(column.min, row, range)));
            if column.max > column.min {
                points.push(Pos2::new(x, y_at(column.max, row, range)));
            }
        }
        if let [alone] = points[..] {
            points.push(alone + egui::vec2(1.0, 0.0));
        }
        let stroke = Stroke::new(1.5, color);
        self.painter.with_clip_rect(row).line(points, stroke);
    }

    /// Draws a bar from one time to another, in seconds.
    pub fn draw_bar(&self, row: Rangef, from: f64, to: f64, color: Color32) {
        let left = self.x_at(from).max(self.area.min.x);
        let right = self.x_at(to).max(left + 1.5).min(self.area.max.x);
        if right > left {
            let bar = Rect::from_x_y_ranges(Rangef::new(left, right), row);
            self.painter.rect_filled(bar, 1.0, color);
        }
    }

    /// Draws a vertical line at a time in seconds.
    pub fn draw_tick(&self, row: Rangef, time: f64, color: Color32) {
        if (self.from..=self.to).contains(&time) {
            let stroke = Stroke::new(1.0, color);
            self.painter.vline(self.x_at(time), row, stroke);
        }
    }

    /// Returns `true` if a time in seconds is within the window.
    pub fn shows(&self, seconds: f64) -> bool {
        (self.from..=self.to).contains(&seconds)
    }
}

/// Returns the width of the vertical axes: the width of the longest name beside a row, which differs between languages.
fn axis_width(ui: &egui::Ui, names: &[String]) -> f32 {
    let width = |name: &String| {
        let font = FontId::proportional(LETTERS);
        let color = Color32::PLACEHOLDER;
        let galley = ui.painter().layout_no_wrap(name.clone(), font, color);
        galley.size().x + 2.0 * LABEL_MARGIN
    };
    names.iter().map(width).fold(AXIS_WIDTH, f32::max)
}

fn y_at(value: f32, row: Rect, (low, high): (f32, f32)) -> f32 {
    row.max.y - (value - low) / (high - low) * row.height()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_has_room_for_every_name() {
        let context = egui::Context::default();
        let output = context.run_ui(egui::RawInput::default(), |ui| {
            assert_eq!(axis_width(ui, &[]), AXIS_WIDTH);
            let names = ["right little", "Teclas enviadas"].map(str::to_owned);
            let font = FontId::proportional(LETTERS);
            for name in &names {
                let galley =
                    ui.painter()
                        .layout_no_wrap(name.clone(), font.clone(), Color32::WHITE);
                assert!(
                    axis_width(ui, &names) >= galley.size().x + LABEL_MARGIN,
                    "{name}"
                );
            }
        });
        output.drop_without_applying_deltas();
    }
}
