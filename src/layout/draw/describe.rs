//! What cannot be drawn on a board, in words.

use crate::contact::volume::{Volume, VolumeShape};
use crate::device::pointer::{ClickMethod, CursorOutput, Gesture, PointerSettings, PointingMode};
use crate::layout::controls::space::SpaceTargets;
use crate::layout::model::label;

/// A pointer in one line, with the line break.
pub(super) fn pointer(settings: &PointerSettings) -> String {
    let mode = match settings.mode {
        PointingMode::Joint(_) => "by joint angles",
        PointingMode::Direct(_) => "by the index fingertip in a box",
        PointingMode::Ray(_) => "by a ray from the hand",
        PointingMode::Rate(_) => "by displacement from rest",
    };
    let moves = match settings.output {
        CursorOutput::Absolute => ", to places on the screen",
        CursorOutput::Relative => ", by pixels",
        CursorOutput::None => "",
    };
    let mut line = format!("pointer {mode}{moves}");
    for &(by, action) in &settings.clicks {
        let by = match by {
            ClickMethod::Gesture(gesture) => self::gesture(gesture),
            ClickMethod::Push(_) => "push".into(),
        };
        line += &format!(", {by} {}", label(action, &[], &[]));
    }
    if let Some((_, action)) = settings.dwell {
        line += &format!(", dwell {}", label(action, &[], &[]));
    }
    if let Some(scroll) = settings.scroll {
        line += &format!(", {} scrolls", gesture(scroll.gesture));
    }
    if let Some(clutch) = settings.clutch {
        line += &format!(", moves while {}", gesture(clutch));
    }
    if let Some(slow) = settings.precision_gesture {
        line += &format!(", slow while {}", gesture(slow));
    }
    line + "\n"
}

fn gesture(gesture: Gesture) -> String {
    match gesture {
        Gesture::Pinch(finger) => format!("{finger} pinch"),
        Gesture::Flexion(dof, at) => format!("{dof} {:.0}°", at.to_degrees()),
    }
}

/// Targets in space, one a line: name, shape, and where the middle is.
pub(super) fn space(scenery: &SpaceTargets) -> String {
    let volumes = scenery.space.volumes.iter();
    let lines = scenery.names.iter().zip(volumes).map(|(name, volume)| {
        let Volume {
            center: middle,
            shape: form,
        } = volume;
        let at = *middle * 1e3;
        let form = match *form {
            VolumeShape::Ball(radius) => format!("ball {:.0} mm", radius * 2e3),
            VolumeShape::Box(half) => {
                let size = half * 2e3;
                format!("box {:.0} × {:.0} × {:.0} mm", size.x, size.y, size.z)
            }
        };
        format!(
            "{name}: {form} at ({:.0}, {:.0}, {:.0}) mm\n",
            at.x, at.y, at.z
        )
    });
    lines.collect()
}
