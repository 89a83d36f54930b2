//! The look of the window: colors, and what marks the focus.

use eframe::egui::{self, Color32, Role, Stroke, ThemePreference, Visuals, WidgetInfo};

use super::PanelState;
use crate::scene::SceneColors;
use crate::settings::{Settings, Theme};
use crate::texts::{self, text};

/// Width of the line around what has the focus, in points.
pub(super) const FOCUS_WIDTH: f32 = 2.0;

/// Applies theme, contrast and language where they have changed.
pub(super) fn apply(context: &egui::Context, state: &mut PanelState) {
    let settings = &state.settings;
    if let Some(language) = settings.language {
        texts::set_language(language);
    }
    let wanted = (settings.theme, settings.has_high_contrast);
    if state.applied_look == Some(wanted) {
        return;
    }
    // The context follows the system until another theme is chosen.
    let is_start = state.applied_look.is_none();
    state.applied_look = Some(wanted);
    if !(is_start && settings.theme == Theme::System) {
        set_theme(context, settings.theme);
    }
    for theme in [egui::Theme::Light, egui::Theme::Dark] {
        context.set_visuals_of(theme, visuals(theme, settings));
    }
}

fn set_theme(context: &egui::Context, theme: Theme) {
    context.set_theme(match theme {
        Theme::System => ThemePreference::System,
        Theme::Light => ThemePreference::Light,
        Theme::Dark => ThemePreference::Dark,
    });
}

pub(super) fn visuals(theme: egui::Theme, settings: &Settings) -> Visuals {
    let is_dark = theme == egui::Theme::Dark;
    let mut visuals = if is_dark {
        Visuals {
            // The red of egui is hard to read on both.
            error_fg_color: Color32::from_rgb(0xff, 0x70, 0x70),
            ..Visuals::dark()
        }
    } else {
        Visuals {
            error_fg_color: Color32::from_rgb(0xb4, 0x00, 0x1e),
            // The orange of egui is hard to read on white.
            warn_fg_color: Color32::from_rgb(0xa8, 0x48, 0x00),
            // So is its weak text.
            weak_text_color: Some(Color32::from_gray(0x5c)),
            ..Visuals::light()
        }
    };
    if settings.has_high_contrast {
        increase_contrast(&mut visuals);
    }
    let stroke = Stroke::new(FOCUS_WIDTH, focus_color(is_dark));
    visuals.widgets.active.bg_stroke = stroke;
    visuals
}

/// Returns the colors of drawings that suit the colors of the window.
pub(super) fn scene_colors(visuals: &Visuals) -> SceneColors {
    let has_high_contrast = visuals.override_text_color.is_some();
    SceneColors::new(visuals.dark_mode, has_high_contrast)
}

fn increase_contrast(visuals: &mut Visuals) {
    let (paper, ink, mark) = if visuals.dark_mode {
        (Color32::BLACK, Color32::WHITE, Color32::from_gray(0x5c))
    } else {
        (Color32::WHITE, Color32::BLACK, Color32::from_gray(0x94))
    };
    visuals.override_text_color = Some(ink);
    visuals.weak_text_color = Some(ink);
    visuals.panel_fill = paper;
    visuals.window_fill = paper;
    visuals.extreme_bg_color = paper;
    visuals.faint_bg_color = paper;
    visuals.window_stroke = Stroke::new(1.5, ink);
    let widgets = &mut visuals.widgets;
    for widget in [
        &mut widgets.noninteractive,
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
        &mut widgets.open,
    ] {
        widget.bg_stroke = Stroke::new(1.0, ink);
        widget.fg_stroke = Stroke::new(1.5, ink);
        widget.weak_bg_fill = paper;
    }
    // A menu draws no lines around what is below the mouse or has the focus.
    for widget in [&mut widgets.hovered, &mut widgets.active] {
        widget.weak_bg_fill = mark;
        widget.bg_fill = mark;
    }
    // Nor around a box or a circle that is not checked.
    widgets.inactive.bg_fill = mark;
}

/// Draws fields and buttons of a menu with their lines in high contrast: without a line, a field is not seen.
pub(super) fn draw_lines(ui: &mut egui::Ui) {
    if ui.visuals().override_text_color.is_some() {
        ui.reset_style();
    }
}

/// Returns the color of a line around what has the focus, or what the tour explains.
pub(super) fn focus_color(is_dark: bool) -> Color32 {
    if is_dark {
        Color32::from_rgb(0x7f, 0xbf, 0xff)
    } else {
        Color32::from_rgb(0x00, 0x50, 0xb0)
    }
}

/// Makes a panel reachable with F6, names it for screen readers, and draws a line around it while it has the focus. Returns `true` if
/// it has.
pub(super) fn mark_panel(ui: &mut egui::Ui, state: &mut PanelState, key: &'static str) -> bool {
    let area = ui.max_rect();
    state.tour.see(key, area);
    let id = egui::Id::unique(("panel", key));
    let response = ui.interact(area, id, egui::Sense::focusable_noninteractive());
    response.widget_info(|| {
        WidgetInfo::labeled(
            Role::Group,
            true,
            format!("{}: {}", text("panel-word"), text(key)),
        )
    });
    state.panel_ids.push(id);
    if response.has_focus() {
        let color = focus_color(ui.visuals().dark_mode);
        let line = Stroke::new(FOCUS_WIDTH, color);
        let painter = ui.ctx().layer_painter(egui::LayerId::new(
            egui::Order::Foreground,
            egui::Id::unique("focus"),
        ));
        painter.rect_stroke(area.shrink(1.0), 2.0, line, egui::StrokeKind::Inside);
    }
    response.has_focus()
}

/// Leaves the arrow keys to what has the focus: otherwise they move it.
pub(super) fn keep_arrow_keys(ui: &egui::Ui) {
    let arrows = egui::EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..egui::EventFilter::default()
    };
    ui.memory_mut(|memory| {
        if let Some(id) = memory.focused() {
            memory.set_focus_lock_filter(id, arrows);
        }
    });
}

/// Names an area that is drawn, for screen readers.
pub(super) fn name_image(response: &egui::Response, name: &str) {
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contrast of two opaque colors as WCAG 2.1 defines it, 1 to 21.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [red, green, blue, _] = egui::Rgba::from(color).to_array();
            0.2126 * red + 0.7152 * green + 0.0722 * blue
        };
        let [a, b] = [luminance(a), luminance(b)].map(|it| it + 0.05);
        a.max(b) / a.min(b)
    }

    #[test]
    fn what_the_mouse_is_over_or_has_the_focus_is_seen_without_a_line_in_high_contrast() {
        let settings = Settings {
            has_high_contrast: true,
            ..Settings::default()
        };
        for theme in [egui::Theme::Light, egui::Theme::Dark] {
            let strong = visuals(theme, &settings);
            let ink = strong.text_color();
            for widget in [strong.widgets.hovered, strong.widgets.active] {
                let beside = contrast(widget.weak_bg_fill, strong.window_fill);
                assert!(beside > 3.0, "{theme:?}: {beside}");
                let of_words = contrast(widget.weak_bg_fill, ink);
                assert!(of_words > 4.5, "{theme:?}: {of_words}");
            }
            let of_box = contrast(strong.widgets.inactive.bg_fill, strong.window_fill);
            assert!(of_box > 3.0, "{theme:?}: {of_box}");
        }
    }

    #[test]
    fn a_field_in_a_menu_has_a_line_in_high_contrast() {
        for has_high_contrast in [false, true] {
            let context = egui::Context::default();
            let settings = Settings {
                has_high_contrast,
                ..Settings::default()
            };
            context.set_visuals_of(egui::Theme::Dark, visuals(egui::Theme::Dark, &settings));
            context.set_theme(egui::Theme::Dark);
            let output = context.run_ui(egui::RawInput::default(), |ui| {
                egui::containers::menu::menu_style(ui.style_mut());
                draw_lines(ui);
                let line = ui.visuals().widgets.inactive.bg_stroke;
                assert_eq!(line.width > 0.0, has_high_contrast);
            });
            output.drop_without_applying_deltas();
        }
    }

    #[test]
    fn errors_can_be_read_on_light_and_dark() {
        for theme in [egui::Theme::Light, egui::Theme::Dark] {
            let shown = visuals(theme, &Settings::default());
            for fill in [shown.panel_fill, shown.extreme_bg_color] {
                let found = contrast(shown.error_fg_color, fill);
                assert!(found > 4.5, "{theme:?}: {found}");
            }
        }
    }

    #[test]
    fn weak_texts_and_warnings_can_be_read_on_light() {
        let light = visuals(egui::Theme::Light, &Settings::default());
        for color in [light.weak_text_color(), light.warn_fg_color] {
            let found = contrast(color, light.panel_fill);
            assert!(found > 4.5, "{color:?}: {found}");
        }
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 0.01);
    }
}
