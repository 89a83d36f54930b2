//! Boards: keys, other controls and fingertips.

use ademan::contact::TargetId;
use ademan::hand::Side;
use ademan::layout::{Cell, CellMark, Grid, Handle, KeySize, Layout};
use ademan::message::escape;
use ademan::session::view::Fingertip;
use parry3d::math::Vec2;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::symbols::border;
use ratatui::widgets::{Block, Clear, Widget};

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
    for cell in &grid.cells {
        hide_below(cell, buffer, area);
        if !is_lit(cell) {
            draw_cell(picture, cell, buffer, area, Style::new());
        }
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
        hide_below(cell, buffer, area);
        draw_cell(picture, cell, buffer, area, style(cell.target));
    }
}

/// Hides the labels and frames of keys below a key, which is drawn after them.
fn hide_below(cell: &Cell, buffer: &mut Buffer, board: Rect) {
    let area = area_of(cell, board).intersection(buffer.area);
    Clear.render(area, buffer);
}

/// Returns the part of a board that a key takes.
fn area_of(cell: &Cell, board: Rect) -> Rect {
    let area = Rect::new(
        board.x + cell.column as u16,
        board.y + cell.row as u16,
        cell.width as u16,
        cell.height as u16,
    );
    area.intersection(board)
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
    let area = area_of(cell, board).intersection(buffer.area);
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
    let is_drawable = |text: &str| picture.look.is_unicode || text.is_ascii();
    let label = if is_drawable(&face.label) {
        &face.label
    } else {
        &face.name
    };
    let highlighted = label_of(picture.view, cell.target).filter(|text| is_drawable(text));
    let mut marks = cell.marks(&picture.view.layout, |target| {
        value_of(picture.view, target)
    });
    let is_label = |mark: &CellMark| matches!(mark, CellMark::Label { .. });
    if highlighted.is_some() {
        // The last label of a menu is its hub, which says what is highlighted.
        let _ = marks.pop_if(|mark| is_label(mark));
    }
    marks.retain(|mark| match mark {
        CellMark::Label { text, .. } => is_drawable(text),
        _ => true,
    });
    let has_labels = highlighted.is_none() && marks.iter().any(is_label);
    let label = highlighted.unwrap_or(label);
    if marks.iter().any(CellMark::needs_inside) {
        // The handle needs the inside, so the label is in the border.
        let top = Rect {
            height: 1,
            y: area.y,
            ..inside
        };
        draw_label(label, top, is_bordered, buffer, style);
    } else if !has_labels {
        draw_label(label, inside, is_bordered, buffer, style);
    }
    for mark in &marks {
        draw_mark(picture, mark, (board, inside), buffer, style);
    }
}

/// Draws a mark of a control on its board.
fn draw_mark(
    picture: &Picture,
    mark: &CellMark,
    (board, inside): (Rect, Rect),
    buffer: &mut Buffer,
    style: Style,
) {
    let at = |column: usize, row: usize| (board.x + column as u16, board.y + row as u16);
    match mark {
        CellMark::Row(row) => {
            let (y, height) = (board.y + *row as u16, 1);
            let handle = Rect {
                y,
                height,
                ..inside
            };
            fill(handle, "━", buffer, style);
        }
        CellMark::Column(column) => {
            let (x, width) = (board.x + *column as u16, 1);
            let handle = Rect { x, width, ..inside };
            fill(handle, "┃", buffer, style);
        }
        CellMark::Point { column, row } | CellMark::Rim { column, row } => {
            let symbol = if picture.look.is_unicode { "●" } else { "o" };
            if let Some(cell) = buffer.cell_mut(at(*column, *row)) {
                cell.set_symbol(symbol).set_style(style);
            }
        }
        CellMark::Label { column, row, text } => {
            let (x, y) = at(*column, *row);
            if inside.contains((x, y).into()) {
                let room = usize::from(inside.right() - x);
                buffer.set_stringn(x, y, escape(text), room, style);
            }
        }
    }
}

/// Fills an area with a symbol.
fn fill(area: Rect, symbol: &str, buffer: &mut Buffer, style: Style) {
    for position in area.intersection(buffer.area).positions() {
        buffer[position].set_symbol(symbol).set_style(style);
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
