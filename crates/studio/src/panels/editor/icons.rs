//! Buttons with a drawn sign: bars that are aligned or apart.

use eframe::egui::{self, Rect, Sense, pos2, vec2};

use crate::editor::{AlignEdge, BoardAxis};

/// Side of a button, in points.
const SIDE: f32 = 22.0;

/// A bar of a sign: left, top, right and bottom as fractions of the button.
type Bar = [f32; 4];

/// Returns two bars at a line, which is the third.
pub(super) const fn alignment(edge: AlignEdge) -> [Bar; 3] {
    match edge {
        AlignEdge::Left => [
            [0.22, 0.26, 0.8, 0.44],
            [0.22, 0.56, 0.56, 0.74],
            [0.14, 0.16, 0.18, 0.84],
        ],
        AlignEdge::Right => [
            [0.2, 0.26, 0.78, 0.44],
            [0.44, 0.56, 0.78, 0.74],
            [0.82, 0.16, 0.86, 0.84],
        ],
        AlignEdge::CenterX => [
            [0.2, 0.26, 0.8, 0.44],
            [0.32, 0.56, 0.68, 0.74],
            [0.48, 0.14, 0.52, 0.86],
        ],
        AlignEdge::Top => transposed(alignment(AlignEdge::Left)),
        AlignEdge::Bottom => transposed(alignment(AlignEdge::Right)),
        AlignEdge::CenterY => transposed(alignment(AlignEdge::CenterX)),
    }
}

/// Returns three bars with equal gaps.
pub(super) const fn distribution(axis: BoardAxis) -> [Bar; 3] {
    let bars = [
        [0.16, 0.24, 0.28, 0.76],
        [0.44, 0.24, 0.56, 0.76],
        [0.72, 0.24, 0.84, 0.76],
    ];
    match axis {
        BoardAxis::X => bars,
        BoardAxis::Y => transposed(bars),
    }
}

/// The sign of a mirror image.
pub(super) const fn mirror(axis: BoardAxis) -> [Bar; 3] {
    let bars = [
        [0.14, 0.28, 0.38, 0.72],
        [0.47, 0.12, 0.53, 0.88],
        [0.62, 0.28, 0.86, 0.72],
    ];
    match axis {
        BoardAxis::X => bars,
        BoardAxis::Y => transposed(bars),
    }
}

const fn transposed([a, b, c]: [Bar; 3]) -> [Bar; 3] {
    const fn bar([left, top, right, bottom]: Bar) -> Bar {
        [top, left, bottom, right]
    }
    [bar(a), bar(b), bar(c)]
}

/// Shows a button with a sign; the hint is its name for screen readers. Returns `true` if it was clicked.
pub(super) fn button(ui: &mut egui::Ui, bars: [Bar; 3], hint: &str, is_enabled: bool) -> bool {
    let sense = if is_enabled {
        Sense::click()
    } else {
        Sense::hover()
    };
    let (area, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), sense);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_enabled, hint));
    let visuals = if is_enabled {
        *ui.style().interact(&response)
    } else {
        ui.visuals().widgets.noninteractive
    };
    let color = if is_enabled {
        visuals.text_color()
    } else {
        ui.visuals().weak_text_color().gamma_multiply(0.6)
    };
    if is_enabled {
        ui.painter()
            .rect_filled(area, visuals.corner_radius, visuals.weak_bg_fill);
    }
    let at = |x: f32, y: f32| pos2(area.min.x + x * SIDE, area.min.y + y * SIDE);
    for [left, top, right, bottom] in bars {
        let bar = Rect::from_min_max(at(left, top), at(right, bottom));
        ui.painter().rect_filled(bar, 0.0, color);
    }
    response.on_hover_text(hint).clicked() && is_enabled
}
