//! The filter: its choice, and one angle before and after it with the lag between both.

use std::ops::RangeInclusive;
use std::time::Duration;

use eframe::egui::{self, Color32, DragValue, Pos2, Stroke};

use super::named_number;
use crate::filter_trace::{FilterSample, FilterTrace, SECONDS};
use crate::joint_names::joint_name;
use crate::panels::{PanelContext, is_other_number, typed_number};
use crate::sensor_control::SensorControl;
use crate::texts::{text, text_with};
use ademan_core::estimate::{OneEuroSettings, Smoothing};

/// Height of the plot, in points.
const PLOT_HEIGHT: f32 = 90.0;

/// Smallest range of the plot, in degrees.
const MIN_RANGE: f64 = 10.0;

/// Ranges of a cutoff in Hz, and of its increase with the speed, as a setup file has them: no filter of a setup is beyond them.
const CUTOFFS_HZ: RangeInclusive<f64> = 1e-3..=1e4;
const BETAS: RangeInclusive<f64> = 0.0..=1e4;

/// Decimals of a number that is shown.
const DECIMALS: usize = 3;

const RAW: Color32 = Color32::from_rgb(0x8a, 0x93, 0xa3);
const FILTERED: Color32 = Color32::from_rgb(0x2f, 0x8f, 0xd0);

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    let sensors = &mut *context.sensors;
    let old = sensors.smoothing();
    let new = show_choice(ui, old);
    if new != old {
        sensors.set_smoothing(new);
    }
    if !context.session.sensors.is_seen() {
        return;
    }
    show_joints(ui, sensors);
    ui.horizontal_wrapped(|ui| {
        ui.colored_label(RAW, format!("┄ {}", text("filter-raw")));
        ui.colored_label(FILTERED, format!("— {}", text("filter-filtered")));
        ui.strong(match sensors.lag() {
            Some(lag) => lag_text(lag),
            None => text("filter-no-lag").to_owned(),
        });
    });
    show_plot(ui, sensors.trace());
    if new != Smoothing::default() {
        let setting = setup_setting(new);
        ui.horizontal(|ui| {
            let copy = ui
                .button(text("filter-copy"))
                .on_hover_text(text("filter-copy-hint"));
            if copy.clicked() {
                ui.ctx().copy_text(setting.clone());
            }
            ui.add(egui::Label::new(egui::RichText::new(&setting).monospace()).truncate());
        });
    }
}

fn lag_text(lag: Duration) -> String {
    let milliseconds = format!("{:.1}", lag.as_secs_f64() * 1e3);
    text_with("filter-lag", &[("ms", milliseconds.into())])
}

/// Shows the filters that the estimator has, and returns the chosen one.
fn show_choice(ui: &mut egui::Ui, smoothing: Smoothing) -> Smoothing {
    let mut new = smoothing;
    let one_euro = match smoothing {
        Smoothing::OneEuro(_) => smoothing,
        _ => Smoothing::default(),
    };
    ui.horizontal_wrapped(|ui| {
        let choices = [
            (one_euro, text("filter-one-euro")),
            (Smoothing::RecursiveAverage, text("filter-average")),
            (Smoothing::Off, text("filter-off")),
        ];
        for (choice, name) in choices {
            ui.radio_value(&mut new, choice, name);
        }
    });
    if let Smoothing::OneEuro(settings) = &mut new {
        let old = *settings;
        ui.horizontal_wrapped(|ui| {
            let cutoff = DragValue::new(&mut settings.min_cutoff_hz)
                .range(CUTOFFS_HZ)
                .custom_parser(typed_number)
                .speed(0.02)
                .max_decimals(DECIMALS)
                .suffix(" Hz");
            named_number(ui, "filter-cutoff", "filter-cutoff-hint", cutoff);
            let beta = DragValue::new(&mut settings.beta)
                .range(BETAS)
                .custom_parser(typed_number)
                .speed(0.05)
                .max_decimals(DECIMALS);
            named_number(ui, "filter-beta", "filter-beta-hint", beta);
        });
        // A field that is left without a change rounds its number to what it shows.
        if !is_other_number(old.min_cutoff_hz, settings.min_cutoff_hz, DECIMALS) {
            settings.min_cutoff_hz = old.min_cutoff_hz;
        }
        if !is_other_number(old.beta, settings.beta, DECIMALS) {
            settings.beta = old.beta;
        }
    }
    new
}

fn show_joints(ui: &mut egui::Ui, sensors: &mut SensorControl) {
    let Some(editor) = &sensors.editor else {
        return;
    };
    let traced = sensors.traced();
    let rows = editor.map().rows();
    let names: Vec<_> = rows.iter().map(|row| joint_name(row.dof)).collect();
    let mut chosen = traced;
    let shown = names.get(traced).cloned().unwrap_or_default();
    let choice = egui::ComboBox::from_label(text("filter-joint")).selected_text(shown);
    choice.show_ui(ui, |ui| {
        for (row, name) in names.into_iter().enumerate() {
            ui.selectable_value(&mut chosen, row, name);
        }
    });
    sensors.set_traced(chosen);
}

fn show_plot(ui: &mut egui::Ui, trace: &FilterTrace) {
    let size = egui::vec2(ui.available_width(), PLOT_HEIGHT);
    let (area, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::accesskit::Role::Image, true, text("filter-plot"))
    });
    let painter = ui.painter_at(area);
    painter.rect_filled(area, 4.0, ui.visuals().extreme_bg_color);
    let values = trace.iter().flat_map(|(_, it)| [it.raw, it.filtered]);
    let bounds = values.fold((f64::MAX, f64::MIN), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if bounds.0 > bounds.1 {
        return;
    }
    let middle = (bounds.0 + bounds.1) / 2.0;
    let half = ((bounds.1 - bounds.0) * 0.55).max(MIN_RANGE / 2.0);
    let point = |age: f64, degrees: f64| {
        let x = f64::from(area.max.x) - age / SECONDS * f64::from(area.width());
        let t = (degrees - middle) / half;
        Pos2::new(x as f32, area.center().y - t as f32 * area.height() / 2.0)
    };
    let line = |value: fn(&FilterSample) -> f64| {
        let points = trace.iter().map(|(age, sample)| point(age, value(sample)));
        points.collect::<Vec<_>>()
    };
    painter.line(line(|sample| sample.raw), Stroke::new(1.0, RAW));
    painter.line(line(|sample| sample.filtered), Stroke::new(1.8, FILTERED));
    let font = egui::FontId::proportional(10.0);
    for (t, align) in [
        (-1.0, egui::Align2::LEFT_BOTTOM),
        (1.0, egui::Align2::LEFT_TOP),
    ] {
        let at = Pos2::new(area.min.x + 4.0, area.center().y - t * area.height() / 2.0);
        let degrees = format!("{:.0}°", middle + f64::from(t) * half);
        painter.text(
            at,
            align,
            degrees,
            font.clone(),
            ui.visuals().weak_text_color(),
        );
    }
}

/// Returns the filter as a setting of the setup file.
fn setup_setting(smoothing: Smoothing) -> String {
    match smoothing {
        Smoothing::Off => "smoothing: Off".to_owned(),
        Smoothing::RecursiveAverage => "smoothing: RecursiveAverage".to_owned(),
        Smoothing::OneEuro(OneEuroSettings {
            min_cutoff_hz,
            beta,
            derivative_cutoff_hz,
        }) => format!(
            "smoothing: OneEuro(min_cutoff_hz: {min_cutoff_hz}, beta: {beta}, derivative_cutoff_hz: {derivative_cutoff_hz})"
        ),
    }
}
