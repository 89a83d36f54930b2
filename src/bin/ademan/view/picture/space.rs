//! The range of the pointer and targets in space, as the wearer sees them: to the right, up.

use ademan::contact::volume::{Volume, VolumeShape};
use ademan::layout::KeySize;
use ademan::message::escape;
use ademan::session::view::View;
use parry3d::math::Vec3;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::widgets::{Block, Widget};

use super::Picture;
use super::parts::{Part, PartKind};

/// Returns the range of the pointer, if the layout has one, and its spaces.
pub fn parts(view: &View, key_size: KeySize) -> Vec<Part> {
    let (width, height) = match key_size {
        KeySize::Labelled | KeySize::Bordered => (38, 11),
        KeySize::Compact => (26, 6),
    };
    let range = view.layout.pointer.as_ref().map(|_| PartKind::Range);
    let spaces = (0..view.layout.spaces.len()).map(PartKind::Space);
    let kinds = range.into_iter().chain(spaces);
    kinds.map(|kind| Part::new(kind, width, height)).collect()
}

/// Draws the range of the pointer with its cursor.
pub fn draw_range(picture: &Picture, buffer: &mut Buffer, area: Rect) {
    let cursor = picture.view.state.pointer.map(Vec3::from_array);
    let title = match cursor {
        Some(position) => format!(
            " pointer {:.2} {:.2} {:.2} ",
            position.x, position.y, position.z
        ),
        None => " pointer ".to_owned(),
    };
    let inside = draw_box(&title, area, buffer);
    if let Some(cursor) = cursor {
        draw_cursor(picture, cursor, inside, buffer);
    }
}

/// Draws the targets of a space and the cursor among them.
pub fn draw_space(picture: &Picture, index: usize, buffer: &mut Buffer, area: Rect) {
    let view = picture.view;
    let cursor = view.state.in_spaces_mm.get(index).copied().flatten();
    let title = match cursor {
        Some([x, y, z]) => format!(" {x:.0} {y:.0} {z:.0} mm "),
        None => " targets in space ".to_owned(),
    };
    let inside = draw_box(&title, area, buffer);
    let targets = &view.layout.spaces[index];
    let volumes: Vec<&Volume> = targets.space.volumes.iter().collect();
    let Some((min, max)) = bounds(&volumes) else {
        return;
    };
    let fractions = |point: Vec3| (point - min) / (max - min);
    let first = targets.space.first_target.0;
    for (number, (volume, name)) in volumes.iter().zip(&targets.names).enumerate() {
        let target = first + number as u32;
        let is_selected = view
            .state
            .selected
            .iter()
            .any(|selected| selected.0 == target);
        let style = if is_selected {
            picture.look.pressed()
        } else {
            Style::new()
        };
        let (x, y) = position_in(fractions(volume.center), inside);
        // The center is a dot, which the cursor may cover without covering the name.
        let name = format!("·{}", escape(name));
        let room = usize::from(inside.right().saturating_sub(x));
        // A name that does not fit begins further left instead.
        let missing = name.chars().count().saturating_sub(room) as u16;
        let x = x.saturating_sub(missing).max(inside.x);
        if inside.contains((x, y).into()) {
            buffer.set_stringn(x, y, name, usize::from(inside.right() - x), style);
        }
    }
    if let Some(cursor) = cursor {
        draw_cursor(
            picture,
            fractions(Vec3::from_array(cursor) * 1e-3),
            inside,
            buffer,
        );
    }
}

fn draw_box(title: &str, area: Rect, buffer: &mut Buffer) -> Rect {
    let area = area.intersection(buffer.area);
    let block = Block::bordered().title(title);
    let inside = block.inner(area);
    block.render(area, buffer);
    inside
}

/// Draws the cursor; at the border if it is outside.
fn draw_cursor(picture: &Picture, fractions: Vec3, inside: Rect, buffer: &mut Buffer) {
    if inside.is_empty() {
        return;
    }
    let position = position_in(fractions, inside);
    buffer[position]
        .set_char('✛')
        .set_style(picture.look.pressed());
}

/// Returns the column and row of a position, 0..=1 to the right and up.
fn position_in(fractions: Vec3, inside: Rect) -> (u16, u16) {
    let offset = |fraction: f32, length: u16| {
        let last = f32::from(length.saturating_sub(1));
        (fraction.clamp(0.0, 1.0) * last).round() as u16
    };
    let x = inside.x + offset(fractions.x, inside.width);
    let y = inside.y + offset(1.0 - fractions.y, inside.height);
    (x, y)
}

/// Returns the corners of the box around all volumes, with a volume of its own.
fn bounds(volumes: &[&Volume]) -> Option<(Vec3, Vec3)> {
    let half = |volume: &Volume| match volume.shape {
        VolumeShape::Ball(radius) => Vec3::splat(radius),
        VolumeShape::Box(half) => half,
    };
    let min = volumes.iter().map(|volume| volume.center - half(volume));
    let max = volumes.iter().map(|volume| volume.center + half(volume));
    let (min, max) = (min.reduce(Vec3::min)?, max.reduce(Vec3::max)?);
    Some((min, max.max(min + Vec3::splat(1e-3))))
}
