//! Drawings with box characters.

use parry3d::math::Vec2;

use crate::contact::TargetId;
use crate::contact::surface::Shape;
use crate::layout::model::{Board, Face, Layout};
use crate::layout::render::{CellMark, words};
use crate::message::escape;

/// The size of a key as large as the pitch of its board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeySize {
    /// 3 rows, and 5 to 10 columns, so that the labels fit.
    Labelled,
    /// 5 × 3 characters, with room for a border.
    Bordered,
    /// 3 × 1 characters.
    Compact,
}

impl KeySize {
    /// Returns width and height in characters.
    const fn characters(self) -> Vec2 {
        match self {
            Self::Labelled | Self::Bordered => Vec2::new(5.0, 3.0),
            Self::Compact => Vec2::new(3.0, 1.0),
        }
    }
}

/// The largest width, in characters, of a key as large as the pitch. Keys are only as wide as their labels need.
const MAX_KEY_COLUMNS: f32 = 10.0;

/// The width of a terminal, in characters. A board is not made wider than this for the sake of its labels.
const TERMINAL_COLUMNS: usize = 80;

/// The maximum size of a drawing, in characters. A larger board is drawn at a smaller scale.
const MAX_COLUMNS: f32 = 200.0;
const MAX_ROWS: f32 = 80.0;

/// The largest overlap of two enlarged keys, in metres, from which they are enlarged less. Smaller ones are rounding errors.
const OVERLAP_TOLERANCE: f32 = 1e-4;

/// A board on a grid of characters, with straight rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Width in characters.
    pub columns: usize,
    /// Height in characters.
    pub rows: usize,
    /// The keys, then the other controls, in file order.
    pub cells: Vec<Cell>,
    /// The left far corner in row coordinates, in metres.
    corner: Vec2,
    /// Metres per character.
    character_size: Vec2,
}

/// A key or other control on a [`Grid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The target.
    pub target: TargetId,
    /// Characters from the left of the grid.
    pub column: usize,
    /// Characters from the top of the grid.
    pub row: usize,
    /// Width in characters including the border, at least 1.
    pub width: usize,
    /// Height in characters including the border, at least 1.
    pub height: usize,
    /// `true` if the box has round corners.
    pub round: bool,
}

impl Grid {
    fn new(board: &Board, faces: &[&Face], key_size: KeySize) -> Self {
        let characters = key_size.characters();
        let usual = Self::with_key_characters(board, faces, characters);
        match key_size {
            KeySize::Labelled => Self::widened(board, faces, characters, usual),
            KeySize::Bordered | KeySize::Compact => usual,
        }
    }

    /// Returns the narrowest grid on which every label fits, or the one of the usual size if that is wider than a terminal.
    fn widened(board: &Board, faces: &[&Face], mut characters: Vec2, usual: Self) -> Self {
        let mut grid = usual.clone();
        while grid.cuts_a_label(faces) {
            characters.x += 1.0;
            if characters.x > MAX_KEY_COLUMNS {
                return usual;
            }
            grid = Self::with_key_characters(board, faces, characters);
            if grid.columns > TERMINAL_COLUMNS {
                return usual;
            }
        }
        grid
    }

    fn cuts_a_label(&self, faces: &[&Face]) -> bool {
        let mut cells = self.cells.iter().zip(faces);
        cells.any(|(cell, face)| face.label.chars().count() + 2 > cell.width)
    }

    fn with_key_characters(board: &Board, faces: &[&Face], characters: Vec2) -> Self {
        let half = |face: &Face| board.row_half_extents(face);
        let min_half_width = faces
            .iter()
            .map(|face| half(face).x)
            .fold(f32::INFINITY, f32::min);
        // Keys are enlarged by half of the gap between them, so that neighbors touch on the grid.
        let gap = (board.pitch / 2.0 - min_half_width).max(0.0);
        let halves: Vec<Vec2> = faces.iter().map(|face| half(face)).collect();
        let added = enlargements(faces, &halves, gap);
        let halves = halves.into_iter().zip(added);
        let halves: Vec<Vec2> = halves.map(|(own, more)| own + more).collect();
        let sized = || faces.iter().zip(&halves);
        let min = sized()
            .map(|(face, own)| face.row_position - *own)
            .reduce(Vec2::min);
        let max = sized()
            .map(|(face, own)| face.row_position + *own)
            .reduce(Vec2::max);
        let (min, max) = (min.unwrap_or_default(), max.unwrap_or_default());
        let size = max - min;
        let character_size = Vec2::new(
            (board.pitch / characters.x).max(size.x / MAX_COLUMNS),
            (board.pitch / characters.y).max(size.y / MAX_ROWS),
        );
        let mut grid = Self {
            columns: 0,
            rows: 0,
            cells: Vec::with_capacity(faces.len()),
            corner: Vec2::new(min.x, max.y),
            character_size,
        };
        for (face, own) in sized() {
            grid.add(face, *own);
        }
        grid
    }

    fn add(&mut self, face: &Face, half: Vec2) {
        let count = |length: f32| length.round().max(0.0) as usize;
        let in_characters =
            |corner: Vec2| (face.row_position + corner - self.corner) / self.character_size;
        let from = in_characters(Vec2::new(-half.x, half.y));
        let to = in_characters(Vec2::new(half.x, -half.y));
        let (column, row) = (count(from.x), count(-from.y));
        let cell = Cell {
            target: face.target,
            column,
            row,
            width: count(to.x).saturating_sub(column).max(1),
            height: count(-to.y).saturating_sub(row).max(1),
            round: matches!(face.outline.shape, Shape::Disc(_)),
        };
        self.columns = self.columns.max(cell.column + cell.width);
        self.rows = self.rows.max(cell.row + cell.height);
        self.cells.push(cell);
    }

    /// Returns the column and row of the character at a position in row coordinates, in metres. Returns `None` beyond the edges.
    pub fn cell_at(&self, row_position: Vec2) -> Option<(usize, usize)> {
        let position = (row_position - self.corner) / self.character_size;
        if position.x < 0.0 || position.y > 0.0 {
            return None;
        }
        let (column, row) = (position.x as usize, -position.y as usize);
        (column < self.columns && row < self.rows).then_some((column, row))
    }

    fn to_text(&self, layout: &Layout) -> String {
        let mut canvas = vec![vec![' '; self.columns]; self.rows];
        for cell in &self.cells {
            let label = layout.face(cell.target).map_or("", |face| &face.label);
            cell.draw(label, &cell.marks(layout, |_| None), &mut canvas);
        }
        let line =
            |row: Vec<char>| row.into_iter().collect::<String>().trim_end().to_owned() + "\n";
        canvas.into_iter().map(line).collect()
    }
}

/// Returns the length by which each key is enlarged to all sides, in metres: `largest`, or half of the distance to a neighbor that is
/// nearer, so that keys which do not overlap do not overlap on the grid. `halves` are the half extents of the keys.
fn enlargements(faces: &[&Face], halves: &[Vec2], largest: f32) -> Vec<f32> {
    let mut lengths = vec![largest; faces.len()];
    let left = |index: usize| faces[index].row_position.x - halves[index].x;
    let mut order: Vec<usize> = (0..faces.len()).collect();
    order.sort_by(|&one, &other| left(one).total_cmp(&left(other)));
    for (place, &one) in order.iter().enumerate() {
        let reach = faces[one].row_position.x + halves[one].x + 2.0 * largest;
        let neighbors = order[place + 1..].iter().copied();
        for other in neighbors.take_while(|&other| left(other) < reach) {
            let offset = faces[other].row_position - faces[one].row_position;
            let apart = offset.abs() - halves[one] - halves[other];
            let room = apart.max_element() / 2.0;
            if (-OVERLAP_TOLERANCE..largest - OVERLAP_TOLERANCE).contains(&room) {
                for index in [one, other] {
                    lengths[index] = lengths[index].min(room.max(0.0));
                }
            }
        }
    }
    lengths
}

impl Cell {
    fn draw(&self, label: &str, marks: &[CellMark], canvas: &mut [Vec<char>]) {
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
        let inside = self.column + 1..(self.column + right).max(self.column + 1);
        for mark in marks {
            match mark {
                CellMark::Row(row) => canvas[*row][inside.clone()].fill('━'),
                CellMark::Column(column) => {
                    let rows = &mut canvas[self.row + 1..self.row + bottom];
                    rows.iter_mut().for_each(|row| row[*column] = '┃');
                }
                CellMark::Point { column, row } | CellMark::Rim { column, row } => {
                    canvas[*row][*column] = '●';
                }
                CellMark::Label { column, row, text } => write(text, &mut canvas[*row][*column..]),
            }
        }
        if marks
            .iter()
            .any(|mark| matches!(mark, CellMark::Label { .. }))
        {
            return;
        }
        let has_handle = marks.iter().any(CellMark::needs_inside);
        let row = if has_handle { 0 } else { bottom / 2 };
        let max_length = self.width.saturating_sub(2).max(1);
        let label: String = escape(label).chars().take(max_length).collect();
        let start = self.column + (self.width - label.chars().count()) / 2;
        write(&label, &mut canvas[self.row + row][start..]);
    }
}

/// Writes a text over the first characters of a part of a row.
fn write(text: &str, row: &mut [char]) {
    for (place, character) in row.iter_mut().zip(text.chars()) {
        *place = character;
    }
}

impl Layout {
    /// Returns the boards on grids of characters, for displays that draw keys themselves.
    pub fn grids(&self, key_size: KeySize) -> Vec<Grid> {
        self.boards
            .iter()
            .map(|board| Grid::new(board, &self.faces(board).collect::<Vec<_>>(), key_size))
            .collect()
    }

    /// Returns a drawing for a terminal, which ends with a line break: the boards to scale with straight rows, the changes of
    /// each layer, and lists of chords, controls, triggers, gestures and targets in space.
    pub fn to_text(&self) -> String {
        let grids = self.grids(KeySize::Labelled);
        let mut parts: Vec<String> = grids.iter().map(|grid| grid.to_text(self)).collect();
        parts.extend((1..self.layers.len()).map(|layer| self.layer_text(layer)));
        let chords = self.chords_text(0);
        if !chords.is_empty() {
            parts.push(format!("Chords\n{}", wrapped(&chords, " · ", 2)));
        }
        for list in words::lists(self) {
            parts.push(format!("{}\n{}", list.heading, table(&list.rows)));
        }
        parts.join("\n")
    }

    fn chords_text(&self, layer: usize) -> Vec<String> {
        let chords = words::chords(self, layer).into_iter();
        let chords =
            chords.map(|words| format!("{}: {}", escape(&words.keys), escape(&words.action)));
        chords.collect()
    }

    fn layer_text(&self, layer: usize) -> String {
        let changes = self.keys.iter().filter_map(|key| {
            let action = words::in_layer(self, key, layer)?;
            // Chords name their keys; the labels of such keys are their actions alone.
            let own = if self.is_chord_key(key.face.target) {
                &key.face.name
            } else {
                &key.face.label
            };
            Some(format!("{} {}", escape(own), escape(&action)))
        });
        let mut changes: Vec<String> = changes.collect();
        changes.extend(self.chords_text(layer));
        let name = escape(&self.layers[layer]).into_owned();
        format!("Layer {name}\n{}", wrapped(&changes, " · ", 2))
    }
}

/// Returns rows of names and descriptions, as wide as a terminal.
fn table(rows: &[(String, String)]) -> String {
    let longest = rows.iter().map(|(name, _)| name.chars().count()).max();
    let column = longest.unwrap_or_default().min(TERMINAL_COLUMNS / 2) + 4;
    let rows = rows.iter().map(|(name, description)| {
        let name = format!("  {}", escape(name));
        let description = escape(description);
        let words: Vec<String> = description.split(' ').map(str::to_owned).collect();
        let lines = wrapped(&words, " ", column);
        format!("{name:column$}{}", lines.trim_start())
    });
    rows.collect()
}

/// Returns texts with a separator between them, in lines as wide as a terminal, indented by some columns.
fn wrapped(texts: &[String], separator: &str, indent: usize) -> String {
    let length = |text: &str| text.chars().count();
    let mut lines: Vec<String> = Vec::new();
    for text in texts {
        match lines.last_mut() {
            Some(line)
                if indent + length(line) + length(separator) + length(text) <= TERMINAL_COLUMNS =>
            {
                line.push_str(separator);
                line.push_str(text);
            }
            _ => lines.push(text.clone()),
        }
    }
    let indented = lines.iter().map(|line| format!("{:indent$}{line}\n", ""));
    indented.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns `true` if two cells share a character.
    fn overlaps(one: &Cell, other: &Cell) -> bool {
        let is_before =
            |a: &Cell, b: &Cell| a.column + a.width <= b.column || a.row + a.height <= b.row;
        !is_before(one, other) && !is_before(other, one)
    }

    #[test]
    fn keys_of_different_widths_do_not_overlap_in_a_drawing() {
        let keys = "(code: \"A\", at_mm: (-8.5, 0), size_mm: Box(16, 30)), (code: \"B\", at_mm: (8.5, 0), size_mm: Box(16, 30)), \
                    (code: \"C\", at_mm: (0, 33), size_mm: Box(10, 30))";
        let text =
            format!("Layout(name: \"a\", boards: [(pose: (anchor: elbow), keys: [{keys}])])");
        let layout = Layout::parse(&text, "a.ron").unwrap();
        let expected = "   ┌─┐
   │ │
   │C│
   │ │
   └─┘
┌──┐┌───┐
│  ││   │
│A ││ B │
│  ││   │
└──┘└───┘
";
        assert_eq!(layout.to_text(), expected);
        for (name, shipped) in Layout::shipped().unwrap() {
            for grid in shipped.grids(KeySize::Labelled) {
                for (index, cell) in grid.cells.iter().enumerate() {
                    let mut others = grid.cells[index + 1..].iter();
                    let other = others.find(|other| overlaps(cell, other));
                    assert_eq!(other, None, "{name}: {cell:?}");
                }
            }
        }
    }
}
