//! Boards: keys, other controls and fingertips.

use ademan::contact::TargetId;
use ademan::hand::Side;
use ademan::layout::{Cell, Grid, Handle, KeySize, Layout};
use ademan::message::escape;
use ademan::session::view::Fingertip;
use parry3d::math::Vec2;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::symbols::border;
use ratatui::widgets::{Block, Widget};

use super::Picture;
use super::parts::{Part, PartKind};
use super::values::{label_of, value_of};
use crate::view::look::finger_mark;

/// Returns the boards of a layout: the left hand's first, then from left to right.
pub fn parts(layout: &Layout, key_size: KeySize) -> Vec<Part> {
    let grids = layout.grids(key_size).into_iter().enumerate();
    let mut parts: Vec<Part> = grids
        .filter(|(_, grid)| grid.columns > 0)
        .map(|(index, grid)| {
            let (columns, rows) = (grid.columns, grid.rows);
            Part::new(PartKind::Board(index, grid), columns, rows)
        })
        .collect();
    let surfaces = layout.scene.surfaces();
    parts.sort_by_key(|part| match part.kind {
        PartKind::Board(index, _) => match surfaces.get(index).and_then(|surface| surface.side()) {
            Some(Side::Left) => 0,
            None => 1,
            Some(Side::Right) => 2,
        },
        _ => 3,
    });
    parts
}

/// Draws a board.
pub fn draw(picture: &Picture, board: usize, grid: &Grid, buffer: &mut Buffer, area: Rect) {
    let state = &picture.view.state;
    let is_lit = |cell: &Cell| {
        state.pressed.contains(&cell.target) || is_on(&picture.view.layout, cell.target, picture)
    };
    for cell in grid.cells.iter().filter(|cell| !is_lit(cell)) {
        draw_cell(picture, cell, buffer, area, Style::new());
    }
    let tips = state.fingertips.iter().filter(|tip| tip.board == board);
    for tip in tips {
        draw_fingertip(picture, grid, tip, buffer, area);
    }
    // A pressed key is drawn over the fingertip that presses it.
    for cell in grid.cells.iter().filter(|cell| is_lit(cell)) {
        draw_cell(picture, cell, buffer, area, picture.look.pressed());
    }
}

/// Draws the keys of a board, each in its own style.
pub fn draw_keys(
    picture: &Picture,
    grid: &Grid,
    buffer: &mut Buffer,
    area: Rect,
    style: impl Fn(TargetId) -> Style,
) {
    for cell in &grid.cells {
        draw_cell(picture, cell, buffer, area, style(cell.target));
    }
}

fn handle(layout: &Layout, target: TargetId) -> Option<Handle> {
    let (control, _) = layout.control_at(target)?;
    Some(control.kind.handle())
}

/// Returns `true` if a target is a switch that is on.
fn is_on(layout: &Layout, target: TargetId, picture: &Picture) -> bool {
    let is_switch = handle(layout, target) == Some(Handle::Switch);
    let mut values = picture.view.state.values.iter();
    is_switch && values.any(|(known, value)| *known == target && *value > 0.5)
}

fn draw_cell(picture: &Picture, cell: &Cell, buffer: &mut Buffer, board: Rect, style: Style) {
    let Some(face) = picture.view.layout.face(cell.target) else {
        return;
    };
    let area = Rect::new(
        board.x + cell.column as u16,
        board.y + cell.row as u16,
        cell.width as u16,
        cell.height as u16,
    );
    let area = area.intersection(board).intersection(buffer.area);
    if area.is_empty() {
        return;
    }
    let is_bordered = area.width >= 3 && area.height >= 3;
    let inside = if is_bordered {
        let corners = if cell.round {
            border::ROUNDED
        } else {
            border::PLAIN
        };
        let block = Block::bordered().border_set(corners).style(style);
        let inside = block.inner(area);
        block.render(area, buffer);
        inside
    } else {
        buffer.set_style(area, style);
        area
    };
    // A symbol such as ⇧ for Shift is not in every locale.
    let is_drawable = picture.look.is_unicode || face.label.is_ascii();
    let label = if is_drawable { &face.label } else { &face.name };
    let highlighted = label_of(picture.view, cell.target);
    let highlighted = highlighted.filter(|text| picture.look.is_unicode || text.is_ascii());
    let label = highlighted.unwrap_or(label);
    let slider = slider_value(picture, cell.target);
    let pad = pad_values(picture, cell.target);
    if slider.is_none() && pad.is_none() {
        draw_label(label, inside, is_bordered, buffer, style);
        draw_rim_mark(picture, cell.target, area, buffer, style);
        return;
    }
    // The handle needs the inside, so the label is in the border.
    let top = Rect {
        height: 1,
        y: area.y,
        ..inside
    };
    draw_label(label, top, is_bordered, buffer, style);
    if let Some(value) = slider {
        draw_handle(value, inside, buffer, style);
    }
    if let Some([x, y]) = pad {
        draw_mark(picture, inside, [x, 1.0 - y], buffer, style);
    }
}

/// Returns the values of an XY pad, 0..=1 each: to the right, away from the wearer; `None` for any other target.
fn pad_values(picture: &Picture, target: TargetId) -> Option<[f32; 2]> {
    let (control, _) = picture.view.layout.control_at(target)?;
    if !matches!(control.kind.handle(), Handle::Pad { .. }) {
        return None;
    }
    let values = control.value_targets().into_iter();
    let values = values.filter_map(|own| value_of(picture.view, own));
    let values: Vec<f32> = values.map(|value| value.clamp(0.0, 1.0)).collect();
    values.try_into().ok()
}

/// Returns the value of a slider, 0..=1; `None` for any other target.
fn slider_value(picture: &Picture, target: TargetId) -> Option<f32> {
    let handle = handle(&picture.view.layout, target);
    let is_slider = matches!(handle, Some(Handle::Line { .. }));
    let value = value_of(picture.view, target).filter(|_| is_slider)?;
    Some(value.clamp(0.0, 1.0))
}

/// Draws a mark at the value of a knob or ring on its edge.
fn draw_rim_mark(
    picture: &Picture,
    target: TargetId,
    area: Rect,
    buffer: &mut Buffer,
    style: Style,
) {
    let Some(Handle::Turn { start, turns, .. }) = handle(&picture.view.layout, target) else {
        return;
    };
    let Some(value) =
        value_of(picture.view, target).filter(|_| area.width >= 3 && area.height >= 3)
    else {
        return;
    };
    let (sin, cos) = ((start + turns * value) * std::f32::consts::TAU).sin_cos();
    let at = [(1.0 + sin) / 2.0, (1.0 - cos) / 2.0];
    draw_mark(picture, area, at, buffer, style);
}

/// Draws a round mark at a part of an area, 0..=1 each: from the left, from the top.
fn draw_mark(picture: &Picture, area: Rect, at: [f32; 2], buffer: &mut Buffer, style: Style) {
    let offset =
        |length: u16, part: f32| (part * f32::from(length.saturating_sub(1))).round() as u16;
    let at = (
        area.x + offset(area.width, at[0]),
        area.y + offset(area.height, at[1]),
    );
    let mark = if picture.look.is_unicode { "●" } else { "o" };
    if let Some(cell) = buffer.cell_mut(at) {
        cell.set_symbol(mark).set_style(style);
    }
}

/// Draws the handle of a slider on its track.
fn draw_handle(value: f32, inside: Rect, buffer: &mut Buffer, style: Style) {
    // Characters are twice as high as wide.
    let is_wide = inside.width >= 2 * inside.height;
    let length = if is_wide { inside.width } else { inside.height };
    let offset = (value * f32::from(length.saturating_sub(1))).round() as u16;
    let handle = if is_wide {
        Rect {
            x: inside.x + offset,
            width: 1,
            ..inside
        }
    } else {
        Rect {
            y: inside.bottom().saturating_sub(1 + offset),
            height: 1,
            ..inside
        }
    };
    for position in handle.intersection(buffer.area).positions() {
        buffer[position]
            .set_symbol(if is_wide { "┃" } else { "━" })
            .set_style(style);
    }
}

/// Draws the label in the middle; one that is too long is cut at its end.
fn draw_label(label: &str, inside: Rect, is_bordered: bool, buffer: &mut Buffer, style: Style) {
    if inside.is_empty() {
        return;
    }
    let label = escape(label);
    // A compact key leaves a gap to the next one.
    let room = if is_bordered || inside.width < 2 {
        inside.width
    } else {
        inside.width - 1
    };
    let width = label.chars().count().min(usize::from(room)) as u16;
    let x = inside.x + (room - width) / 2;
    let y = inside.y + (inside.height - 1) / 2;
    buffer.set_stringn(x, y, label, usize::from(room), style);
}

fn draw_fingertip(
    picture: &Picture,
    grid: &Grid,
    tip: &Fingertip,
    buffer: &mut Buffer,
    area: Rect,
) {
    let Some((column, row)) = grid.cell_at(Vec2::new(tip.x_mm, tip.y_mm) * 1e-3) else {
        return;
    };
    let y = area.y + row as u16;
    let area = area.intersection(buffer.area);
    let is_label = |x: u16| {
        let symbol = buffer[(x, y)].symbol();
        symbol
            .chars()
            .any(|character| !" ─│┌┐└┘╭╮╰╯".contains(character))
    };
    // A label stays readable: the mark stands beside it.
    let x = i32::from(area.x) + column as i32;
    let beside = [0, 1, -1, 2, -2, 3, -3].into_iter();
    let beside = beside.filter_map(|offset| u16::try_from(x + offset).ok());
    let mut inside = beside.filter(|&at| area.contains((at, y).into()));
    let Some(mark_x) = inside
        .clone()
        .find(|&at| !is_label(at))
        .or_else(|| inside.next())
    else {
        return;
    };
    let mark = finger_mark(tip.finger, tip.height_mm < 0.0);
    buffer[(mark_x, y)]
        .set_char(mark)
        .set_style(picture.look.fingertip(tip.finger));
}
