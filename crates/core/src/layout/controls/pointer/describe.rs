//! A pointer in words, for the drawing of a layout.

use crate::device::pointer::mode::{Displacement, HandPoint, RateControl, RayOrigin};
use crate::device::pointer::{ClickMethod, CursorOutput, Gesture, PointerSettings, PointingMode};
use crate::layout::render::drawing::Words;

/// Describes a pointer: what moves it, and the effect of each gesture.
pub(in crate::layout) fn describe(
    settings: &PointerSettings,
    words: &Words,
) -> Vec<(String, String)> {
    let mode = match settings.mode {
        PointingMode::Joint(_) => "joint angles".to_owned(),
        PointingMode::Direct(direct) => {
            let point = match direct.point {
                HandPoint::Index => "index fingertip",
                HandPoint::Knuckle => "index knuckle",
                HandPoint::Wrist => "wrist",
            };
            let size = direct.size * 1e3;
            let (x, y, z) = (size.x, size.y, size.z);
            format!("{point} in a box of {x:.0} × {y:.0} × {z:.0} mm")
        }
        PointingMode::Ray(ray) => {
            let origin = match ray.from {
                RayOrigin::Hand => "hand",
                RayOrigin::Index => "index finger",
            };
            let (x, y) = (ray.size.x * 1e3, ray.size.y * 1e3);
            format!("ray from the {origin} through a rectangle of {x:.0} × {y:.0} mm")
        }
        PointingMode::Rate(RateControl {
            displacement: Displacement::Stick,
            ..
        }) => "stick of the glove, rate control".to_owned(),
        PointingMode::Rate(_) => "rate control".to_owned(),
        PointingMode::Arm(_) => "motion of the hand".to_owned(),
    };
    let output = match settings.output {
        CursorOutput::Absolute => ", absolute",
        CursorOutput::Relative => ", relative",
        CursorOutput::None => "",
    };
    let subject = match settings.mode {
        PointingMode::Arm(_) => "axes",
        _ => "cursor",
    };
    let axes = settings.axes.axes.iter();
    let axes: String = axes.map(|axis| format!(", {}", axis.axis)).collect();
    let mut rows = vec![(subject.to_owned(), format!("{mode}{output}{axes}"))];
    for &(method, action) in &settings.clicks {
        let method = match method {
            ClickMethod::Gesture(gesture) => self::gesture(gesture),
            ClickMethod::Push(distance) => format!("push of {:.0} mm", distance * 1e3),
        };
        rows.push((method, button(words.action(action))));
    }
    if let Some((dwell, action)) = settings.dwell {
        let time = format!("rest of {} ms", dwell.duration.as_millis());
        rows.push((time, button(words.action(action))));
    }
    if let Some(scroll) = settings.scroll {
        rows.push((gesture(scroll.gesture), "scrolls".into()));
    }
    if let Some(clutch) = settings.clutch {
        rows.push((gesture(clutch), format!("moves the {subject}")));
    }
    if let Some(precision) = settings.precision_gesture {
        rows.push((gesture(precision), format!("slows the {subject}")));
    }
    rows
}

fn button(label: String) -> String {
    match label.as_str() {
        "Left" | "Middle" | "Right" => format!("{} mouse button", label.to_lowercase()),
        _ => label,
    }
}

fn gesture(gesture: Gesture) -> String {
    match gesture {
        Gesture::Pinch(finger) => format!("{finger} pinch"),
        Gesture::Input(input) => format!("glove {input}"),
        Gesture::Flexion(dof, angle) => format!("{dof} {:.0}°", angle.to_degrees()),
    }
}
