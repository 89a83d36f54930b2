//! Joint angles that move a pointer: a dial with the range of each.

use std::f32::consts::FRAC_PI_2;

use parry3d::math::Vec2;

use crate::device::pointer::PointingMode;
use crate::device::pointer::mode::{AngleMapping, Displacement};
use crate::layout::render::svg::canvas::{Align, Canvas};
use crate::layout::render::svg::page::CAPTION_SIZE;

const RADIUS: f32 = 13.0;

/// The width of a dial with its texts, in millimetres.
const CELL_WIDTH: f32 = 46.0;

/// Draws a dial for each angle of a pointing mode. Returns `None` if it uses none.
pub fn draw(mode: &PointingMode) -> Option<Canvas> {
    let across = ("left", "right");
    let upright = ("down", "up");
    let angles: Vec<(&AngleMapping, (&str, &str))> = match mode {
        PointingMode::Joint(joint) => {
            let depth = joint.z.as_ref().map(|mapping| (mapping, ("far", "near")));
            let plane = [(&joint.x, across), (&joint.y, upright)];
            plane.into_iter().chain(depth).collect()
        }
        PointingMode::Rate(rate) => match &rate.displacement {
            Displacement::Angles(x, y) => vec![(x, across), (y, upright)],
            Displacement::Fingertip(..) | Displacement::Stick => return None,
        },
        PointingMode::Direct(_) | PointingMode::Ray(_) | PointingMode::Arm(_) => return None,
    };
    let mut gauges = Canvas::default();
    for (index, (mapping, ends)) in angles.into_iter().enumerate() {
        let center = Vec2::X * (index as f32 + 0.5) * CELL_WIDTH;
        draw_gauge(mapping, ends, center, &mut gauges);
    }
    Some(gauges)
}

fn draw_gauge(mapping: &AngleMapping, ends: (&str, &str), center: Vec2, canvas: &mut Canvas) {
    let middle = (mapping.from + mapping.to) / 2.0;
    // The middle of the range points up, so that the texts at its ends are on both sides.
    let on_page = |angle: f32| angle - middle - FRAC_PI_2;
    let (from, to) = (on_page(mapping.from), on_page(mapping.to));
    canvas.circle("faint", center, RADIUS);
    let mut sector = vec![center];
    sector.extend((0..=16).map(|step| {
        let angle = from + (to - from) * step as f32 / 16.0;
        center + Vec2::from_angle(angle) * RADIUS
    }));
    canvas.polygon("volume", &sector);
    for (angle, page_angle, name) in [(mapping.from, from, ends.0), (mapping.to, to, ends.1)] {
        let direction = Vec2::from_angle(page_angle);
        canvas.line("mark", [center, center + direction * RADIUS]);
        let align = match direction.x {
            x if x < 0.0 => Align::End,
            _ => Align::Start,
        };
        let text = format!("{name} {:.0}°", angle.to_degrees());
        let at = center + direction * (RADIUS + 2.0) - Vec2::Y;
        canvas.text("label", at, align, CAPTION_SIZE, &text);
    }
    canvas.circle("joint", center, 1.2);
    let name = mapping.dof.to_string();
    let below = center + Vec2::Y * (RADIUS + 4.0);
    canvas.text("muted", below, Align::Middle, CAPTION_SIZE, &name);
}
