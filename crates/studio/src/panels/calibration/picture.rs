//! The pictures of a pose: the hand from above or below, and from the side.

use eframe::egui::{self, Align2, FontId};
use parry3d::math::Vec2;

use super::pose::instruction;
use crate::camera::Viewpoint;
use crate::panels::space;
use crate::pose_picture::PosePicture;
use crate::scene::SceneColors;
use crate::texts::text;
use ademan_core::calibrate::CalibrationPose;

/// Shows a pose in an area of this size, from above or below in the left or upper half, and from the side in the other.
pub(super) fn show(
    ui: &mut egui::Ui,
    pose: CalibrationPose,
    picture: Option<&PosePicture>,
    (size, colors): (egui::Vec2, &SceneColors),
) {
    let (area, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::accesskit::Role::Image, true, instruction(pose))
    });
    let Some(picture) = picture else {
        return;
    };
    let is_wide = size.x > 1.2 * size.y;
    let halves = if is_wide {
        area.split_left_right_at_fraction(0.5)
    } else {
        area.split_top_bottom_at_fraction(0.5)
    };
    let fingers = picture.finger_viewpoint();
    let name = match fingers {
        Viewpoint::Below => text("calibration-below"),
        _ => text("calibration-above"),
    };
    let views = [
        (halves.0, fingers, name),
        (halves.1, Viewpoint::Side, text("calibration-side")),
    ];
    for (part, viewpoint, title) in views {
        let part = part.shrink(3.0);
        let painter = ui.painter_at(part);
        let part_size = Vec2::new(part.width(), part.height());
        let drawn = picture.draw(viewpoint, part_size, colors);
        space::paint(&painter, part, &drawn, colors.background);
        painter.text(
            part.left_top() + egui::vec2(8.0, 6.0),
            Align2::LEFT_TOP,
            title,
            FontId::proportional(13.0),
            ui.visuals().weak_text_color(),
        );
    }
}
