//! A layout in the characters of a terminal.

mod describe;

use parry3d::math::Vec2;

use super::model::{Board, Face, Layout};
use crate::contact::TargetId;
use crate::contact::surface::Shape;

/// A key at the pitch of its board is this many characters wide and high.
const KEY_COLUMNS: f32 = 5.0;
const KEY_ROWS: f32 = 3.0;

/// The largest drawing; what would be larger is drawn smaller.
const MAX_COLUMNS: f32 = 200.0;
const MAX_ROWS: f32 = 80.0;

/// A board on a grid of characters, its rows straightened.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Width in characters.
    pub columns: usize,
    /// Height in characters.
    pub rows: usize,
    /// The keys, then the other controls, each in the order of the file.
    pub cells: Vec<Cell>,
    /// The left and far corner, in metres along and across the rows.
    corner: Vec2,
    /// Metres per character.
    step: Vec2,
}

/// A key or other control on a [`Grid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Its target.
    pub target: TargetId,
    /// Characters from the left of the grid.
    pub column: usize,
    /// Characters from the top of the grid.
    pub row: usize,
    /// Width in characters, with the border; at least 1.
    pub width: usize,
    /// Height in characters, with the border; at least 1.
    pub height: usize,
    /// Whether it is drawn with round corners.
    pub round: bool,
}

impl Grid {
    fn of(board: &Board, fronts: &[&Face]) -> Self {
        let half = |front: &Face| board.row_half_extents(front);
        let narrowest = fronts
            .iter()
            .map(|front| half(front).x)
            .fold(f32::INFINITY, f32::min);
        // Keys grow into the gaps between them, so that neighbours touch on the grid.
        let gap = (board.pitch / 2.0 - narrowest).max(0.0);
        let low = fronts
            .iter()
            .map(|front| front.row_position - half(front) - gap)
            .reduce(Vec2::min);
        let high = fronts
            .iter()
            .map(|front| front.row_position + half(front) + gap)
            .reduce(Vec2::max);
        let (low, high) = (low.unwrap_or_default(), high.unwrap_or_default());
        let size = high - low;
        let step = Vec2::new(
            (board.pitch / KEY_COLUMNS).max(size.x / MAX_COLUMNS),
            (board.pitch / KEY_ROWS).max(size.y / MAX_ROWS),
        );
        let mut grid = Self {
            columns: 0,
            rows: 0,
            cells: Vec::with_capacity(fronts.len()),
            corner: Vec2::new(low.x, high.y),
            step,
        };
        for front in fronts {
            grid.add(front, half(front) + gap);
        }
        grid
    }

    fn add(&mut self, front: &Face, half: Vec2) {
        let count = |length: f32| length.round().max(0.0) as usize;
        let from = (front.row_position + Vec2::new(-half.x, half.y) - self.corner) / self.step;
        let to = (front.row_position + Vec2::new(half.x, -half.y) - self.corner) / self.step;
        let (column, row) = (count(from.x), count(-from.y));
        let cell = Cell {
            target: front.target,
            column,
            row,
            width: count(to.x).saturating_sub(column).max(1),
            height: count(-to.y).saturating_sub(row).max(1),
            round: matches!(front.outline.shape, Shape::Disc(_)),
        };
        self.columns = self.columns.max(cell.column + cell.width);
        self.rows = self.rows.max(cell.row + cell.height);
        self.cells.push(cell);
    }

    /// The character, by column and row, in which a point along and across the rows lies (metres, as
    /// [`Front::at`]); `None` beyond the edges.
    pub fn cell_at(&self, at: Vec2) -> Option<(usize, usize)> {
        let place = (at - self.corner) / self.step;
        if place.x < 0.0 || place.y > 0.0 {
            return None;
        }
        let (column, row) = (place.x as usize, -place.y as usize);
        (column < self.columns && row < self.rows).then_some((column, row))
    }

    fn draw(&self, layout: &Layout) -> String {
        let mut canvas = vec![vec![' '; self.columns]; self.rows];
        for cell in &self.cells {
            let label = layout.face(cell.target).map_or("", |front| &front.label);
            cell.draw(label, &mut canvas);
        }
        let line =
            |row: Vec<char>| row.into_iter().collect::<String>().trim_end().to_owned() + "\n";
        canvas.into_iter().map(line).collect()
    }
}

impl Cell {
    fn draw(&self, label: &str, canvas: &mut [Vec<char>]) {
        let corners = if self.round {
            ['╭', '╮', '╰', '╯']
        } else {
            ['┌', '┐', '└', '┘']
        };
        let (right, bottom) = (self.width - 1, self.height - 1);
        for row in 0..self.height {
            for column in 0..self.width {
                canvas[self.row + row][self.column + column] = match (column, row) {
                    (0, 0) => corners[0],
                    (column, 0) if column == right => corners[1],
                    (0, row) if row == bottom => corners[2],
                    (column, row) if column == right && row == bottom => corners[3],
                    (_, row) if row == 0 || row == bottom => '─',
                    (column, _) if column == 0 || column == right => '│',
                    _ => ' ',
                };
            }
        }
        let room = self.width.saturating_sub(2).max(1);
        let length = label.chars().count().min(room);
        let start = self.column + (self.width - length) / 2;
        for (column, character) in label.chars().take(room).enumerate() {
            canvas[self.row + bottom / 2][start + column] = character;
        }
    }
}

impl Layout {
    /// The boards on grids of characters, for a display that draws the keys itself.
    pub fn grids(&self) -> Vec<Grid> {
        self.boards
            .iter()
            .map(|board| Grid::of(board, &self.faces(board).collect::<Vec<_>>()))
            .collect()
    }

    /// The layout for a terminal: each board with its labels at scale, rows along arcs straightened,
    /// then the pointer and the targets in space in words, then what the keys do in each further layer. Ends with a line break.
    pub fn to_text(&self) -> String {
        let mut parts: Vec<String> = self.grids().iter().map(|grid| grid.draw(self)).collect();
        parts.extend(self.pointer.as_ref().map(describe::pointer));
        parts.extend(self.spaces.iter().map(describe::space));
        let mut text = parts.join("\n");
        for (layer, name) in self.layers.iter().enumerate().skip(1) {
            let changes: Vec<String> = self
                .keys
                .iter()
                .filter_map(|key| {
                    Some(format!(
                        "{} {}",
                        key.face.label,
                        self.label_in_layer(key, layer)?
                    ))
                })
                .collect();
            text.push_str(&format!("\n{name}: {}\n", changes.join(", ")));
        }
        text
    }
}
