//! A pointer in words, for the drawing of a layout.

use crate::device::pointer::{ClickMethod, CursorOutput, Gesture, PointerSettings, PointingMode};
use crate::layout::model::action_label;

/// Describes a pointer in one line, which ends with a line break.
pub(in crate::layout) fn describe(settings: &PointerSettings) -> String {
    let mode = match settings.mode {
        PointingMode::Joint(_) => "joint angles",
        PointingMode::Direct(_) => "index fingertip in a box",
        PointingMode::Ray(_) => "ray from the hand",
        PointingMode::Rate(_) => "rate control",
    };
    let output = match settings.output {
        CursorOutput::Absolute => ", absolute",
        CursorOutput::Relative => ", relative",
        CursorOutput::None => "",
    };
    let mut line = format!("pointer: {mode}{output}");
    for &(method, action) in &settings.clicks {
        let method = match method {
            ClickMethod::Gesture(gesture) => self::gesture(gesture),
            ClickMethod::Push(_) => "push".into(),
        };
        line += &format!(", {method} {}", action_label(action, &[], &[]));
    }
    if let Some((_, action)) = settings.dwell {
        line += &format!(", dwell {}", action_label(action, &[], &[]));
    }
    if let Some(scroll) = settings.scroll {
        line += &format!(", {} scrolls", gesture(scroll.gesture));
    }
    if let Some(clutch) = settings.clutch {
        line += &format!(", moves during {}", gesture(clutch));
    }
    if let Some(precision) = settings.precision_gesture {
        line += &format!(", slow during {}", gesture(precision));
    }
    line + "\n"
}

fn gesture(gesture: Gesture) -> String {
    match gesture {
        Gesture::Pinch(finger) => format!("{finger} pinch"),
        Gesture::Flexion(dof, angle) => format!("{dof} {:.0}°", angle.to_degrees()),
    }
}
