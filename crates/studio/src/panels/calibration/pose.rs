//! A pose of the calibration: instruction, pictures, progress, live channels and buttons.

use eframe::egui::{self, Key, RichText};

use super::{button, live, picture, quit};
use crate::guide::{Guide, PoseProgress};
use crate::panels::PanelContext;
use crate::pose_picture::PosePicture;
use crate::scene::SceneColors;
use crate::texts::{text, text_with};
use ademan_core::calibrate::{CalibrationPose, CaptureState};

/// Width of the live channels, in points.
const LIVE_WIDTH: f32 = 400.0;

/// Height of the row of buttons, in points.
const BUTTONS_HEIGHT: f32 = 48.0;

pub(super) fn show(ui: &mut egui::Ui, colors: &SceneColors, context: &mut PanelContext) {
    let Some(guide) = &context.sensors.guide else {
        return;
    };
    let Some(pose) = guide.pose() else {
        return;
    };
    show_progress(ui, guide);
    ui.add_space(6.0);
    ui.label(RichText::new(instruction(pose)).size(22.0).strong());
    ui.add_space(6.0);
    show_state(ui, guide.state());
    ui.add_space(8.0);
    let height = (ui.available_height() - BUTTONS_HEIGHT).max(100.0);
    let width = ui.available_width();
    ui.allocate_ui_with_layout(
        egui::vec2(width, height),
        egui::Layout::left_to_right(egui::Align::Min),
        |ui| {
            let live_width = LIVE_WIDTH.min(width * 0.45);
            let size = egui::vec2(width - live_width - 12.0, height);
            let picture = PosePicture::new(pose, guide.side());
            picture::show(ui, pose, picture.as_ref(), (size, colors));
            ui.allocate_ui_with_layout(
                egui::vec2(live_width, height),
                egui::Layout::top_down(egui::Align::Min),
                |ui| live::show(ui, guide),
            );
        },
    );
    ui.add_space(8.0);
    show_buttons(ui, context);
}

/// Shows the number of the pose, and a sign for each pose.
fn show_progress(ui: &mut egui::Ui, guide: &Guide) {
    ui.horizontal(|ui| {
        let (index, count) = (guide.procedure().index(), guide.poses().count());
        let values = [("number", (index + 1).into()), ("count", count.into())];
        ui.label(RichText::new(text_with("calibration-pose", &values)).size(15.0));
        let signs: String = guide.poses().map(|(_, progress)| sign(progress)).collect();
        ui.label(RichText::new(signs).size(15.0).monospace());
        if guide.is_demonstration() {
            ui.weak(text("calibration-is-demo"));
        }
    });
}

fn sign(progress: PoseProgress) -> char {
    match progress {
        PoseProgress::Taken => '●',
        PoseProgress::Present => '▶',
        PoseProgress::Skipped => '–',
        PoseProgress::ToCome => '○',
    }
}

/// Shows the countdown, or the time for which the hand has been still, as words and a bar.
fn show_state(ui: &mut egui::Ui, state: CaptureState) {
    let (words, fraction) = match state {
        CaptureState::Preparing(left) if left.is_zero() => {
            (text("calibration-take").to_owned(), 0.0)
        }
        CaptureState::Preparing(left) => {
            let seconds = left.as_secs_f32().ceil();
            let words = text_with("calibration-prepare", &[("seconds", seconds.into())]);
            (words, 0.0)
        }
        CaptureState::Moving => (text("calibration-moving").to_owned(), 0.0),
        CaptureState::Holding(fraction) => (text("calibration-holding").to_owned(), fraction),
        CaptureState::Captured => (text("calibration-done").to_owned(), 1.0),
    };
    let bar = egui::ProgressBar::new(fraction)
        .desired_width(ui.available_width().min(500.0))
        .desired_height(26.0)
        .corner_radius(4.0);
    ui.add(bar.text(RichText::new(words).size(16.0).strong()));
}

fn show_buttons(ui: &mut egui::Ui, context: &mut PanelContext) {
    let Some(guide) = &mut context.sensors.guide else {
        return;
    };
    let mut is_over = false;
    ui.horizontal(|ui| {
        let hint = text("calibration-repeat-hint");
        if button(ui, text("calibration-repeat"), Key::R, hint) {
            guide.repeat();
        }
        if button(ui, text("calibration-skip"), Key::S, "") {
            guide.skip();
        }
        is_over = button(ui, text("calibration-quit"), Key::Q, "");
    });
    if is_over {
        quit(context);
    }
}

/// Returns the instruction of a pose.
pub(super) fn instruction(pose: CalibrationPose) -> &'static str {
    text(match pose {
        CalibrationPose::Rest => "pose-rest",
        CalibrationPose::Flat => "pose-flat",
        CalibrationPose::Fist => "pose-fist",
        CalibrationPose::Spread => "pose-spread",
        CalibrationPose::Pinch => "pose-pinch",
        CalibrationPose::ElbowStraight => "pose-elbow-straight",
        CalibrationPose::ElbowBent => "pose-elbow-bent",
        CalibrationPose::WristUp => "pose-wrist-up",
        CalibrationPose::WristDown => "pose-wrist-down",
        CalibrationPose::WristIn => "pose-wrist-in",
        CalibrationPose::WristOut => "pose-wrist-out",
        CalibrationPose::PalmUp => "pose-palm-up",
        CalibrationPose::PalmDown => "pose-palm-down",
        CalibrationPose::ThumbBent => "pose-thumb-bent",
        CalibrationPose::IndexBent => "pose-index-bent",
        CalibrationPose::MiddleBent => "pose-middle-bent",
        CalibrationPose::RingBent => "pose-ring-bent",
        CalibrationPose::LittleBent => "pose-little-bent",
    })
}
