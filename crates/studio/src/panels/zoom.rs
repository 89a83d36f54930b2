//! Zoom by the wheel and by fingers.

use eframe::egui;

/// Logarithm of the factor for one point of the wheel.
const WHEEL: f32 = 0.002;

/// Returns the factor by which this frame enlarges a view: by the wheel, by Ctrl with the wheel, and by two fingers that part.
pub(super) fn magnification(ui: &egui::Ui) -> f32 {
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    // Fingers that touch one point have no distance to compare with.
    let pinch = if pinch.is_normal() { pinch } else { 1.0 };
    (scroll * WHEEL).exp() * pinch
}
