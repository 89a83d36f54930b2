//! One picture of the demo: boards, pressed keys, fingertips, and the text so far.

use ademan::contact::TargetId;
use ademan::hand::Finger;
use ademan::layout::{Cell, Face, Grid, Hover, Layout};
use ademan::message::escape;
use ademan::pipeline::PipelineState;
use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style, Stylize};
use ratatui::text::Line;
use ratatui::widgets::{Block, BorderType, Paragraph, Widget};

const TITLE_ROWS: u16 = 1;
/// Three lines and their border.
const TEXT_ROWS: u16 = 5;

/// The parts that all pictures share.
pub struct Scene {
    pub layout: Layout,
    pub grids: Vec<Grid>,
    /// Goal of the hand in one line.
    pub goal: String,
}

/// The parts that change from picture to picture.
pub struct Picture {
    /// Result so far in one line.
    pub result: String,
    pub state: PipelineState,
    pub pressed: Vec<TargetId>,
    pub fingertips: Vec<Hover>,
}

impl Scene {
    /// Draws all boards one below the other. The text has priority where there is no room for both.
    pub fn draw(&self, frame: &mut Frame, picture: &Picture) {
        let window = frame.area();
        let (columns, rows) = self.size();
        let room = window.height.saturating_sub(TITLE_ROWS + TEXT_ROWS);
        let board = Rect {
            x: window.x + window.width.saturating_sub(columns) / 2,
            y: window.y + TITLE_ROWS.min(window.height),
            width: columns.min(window.width),
            height: rows.min(room),
        };
        let text = Rect {
            y: board.bottom(),
            height: TEXT_ROWS,
            ..window
        };
        let cut = (columns > window.width || rows > room)
            .then_some((columns, rows + TITLE_ROWS + TEXT_ROWS));
        self.draw_title(frame, picture, cut);
        self.draw_boards(frame.buffer_mut(), board, picture);
        self.draw_text(frame, text.intersection(window), &picture.result);
    }

    /// Columns and rows of all boards.
    fn size(&self) -> (u16, u16) {
        let columns = self.grids.iter().map(|grid| grid.columns).max();
        let rows: usize = self.grids.iter().map(|grid| grid.rows + 1).sum();
        let count = |length: usize| u16::try_from(length).unwrap_or(u16::MAX);
        (count(columns.unwrap_or(0)), count(rows))
    }

    fn draw_title(&self, frame: &mut Frame, picture: &Picture, cut: Option<(u16, u16)>) {
        let mut title = format!(" {} · {}", escape(&self.layout.name), picture.state);
        if let Some((columns, rows)) = cut {
            title += &format!(" · needs a window of {columns}×{rows}");
        }
        let line = Rect {
            height: TITLE_ROWS,
            ..frame.area()
        };
        let line = line.intersection(frame.area());
        frame.render_widget(Line::from(title).bold(), line);
    }

    fn draw_boards(&self, buffer: &mut Buffer, area: Rect, picture: &Picture) {
        let mut corner = area;
        for (index, grid) in self.grids.iter().enumerate() {
            let is_lit = |cell: &Cell| picture.pressed.contains(&cell.target);
            let (lit, unlit): (Vec<Cell>, Vec<Cell>) =
                grid.cells.iter().partition(|cell| is_lit(cell));
            self.draw_keys(buffer, corner, &unlit, false);
            let tips = picture.fingertips.iter();
            for tip in tips.filter(|tip| tip.board == index) {
                draw_fingertip(buffer, corner, grid, tip);
            }
            // A pressed key is drawn over the fingertip that presses it.
            self.draw_keys(buffer, corner, &lit, true);
            let below = corner.height.min(grid.rows as u16 + 1);
            corner.y += below;
            corner.height -= below;
        }
    }

    fn draw_keys(&self, buffer: &mut Buffer, area: Rect, cells: &[Cell], lit: bool) {
        for cell in cells {
            if let (Some(face), Some(area)) =
                (self.layout.face(cell.target), area_within(area, cell))
            {
                draw_face(buffer, area, face, lit);
            }
        }
    }

    fn draw_text(&self, frame: &mut Frame, area: Rect, result: &str) {
        let lines = vec![
            Line::from(self.goal.as_str()).dim(),
            Line::from(result).bold(),
            Line::from("○ fingertip  ● inside a key  green: pressed  Ctrl-C ends").dim(),
        ];
        let block = Block::bordered().border_type(BorderType::Rounded);
        frame.render_widget(Paragraph::new(lines).block(block), area);
    }
}

fn draw_fingertip(buffer: &mut Buffer, area: Rect, grid: &Grid, tip: &Hover) {
    let Some((column, row)) = grid.cell_at(tip.row_position) else {
        return;
    };
    let position = (area.x + column as u16, area.y + row as u16);
    if !area.contains(position.into()) {
        return;
    }
    let style = Style::new().fg(match tip.finger {
        Finger::Index => Color::Yellow,
        _ => Color::DarkGray,
    });
    let mark = if tip.height < 0.0 { "●" } else { "○" };
    buffer.set_string(position.0, position.1, mark, style);
}

fn draw_face(buffer: &mut Buffer, area: Rect, face: &Face, lit: bool) {
    let style = match lit {
        true => Style::new()
            .fg(Color::Black)
            .bg(Color::Green)
            .add_modifier(Modifier::BOLD),
        false => Style::new(),
    };
    let block = Block::bordered().style(style);
    let inside = block.inner(area);
    block.render(area, buffer);
    Line::from(escape(&face.label))
        .style(style)
        .centered()
        .render(inside, buffer);
}

/// The area of a key on the screen; `None` if the window is too small for it.
fn area_within(board: Rect, cell: &Cell) -> Option<Rect> {
    let key = Rect {
        x: board.x + cell.column as u16,
        y: board.y + cell.row as u16,
        width: cell.width as u16,
        height: cell.height as u16,
    };
    (board.intersection(key) == key).then_some(key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan::layout::KeySize;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    /// A terminal with a picture of the pressed key `W`.
    fn drawn(columns: u16, rows: u16) -> Terminal<TestBackend> {
        let layout = Layout::load("qwerty-flat").unwrap();
        let scene = Scene {
            grids: layout.grids(KeySize::Bordered),
            goal: "to type  \"to be typed\"".into(),
            layout,
        };
        let down = scene.layout.key("W").unwrap();
        let picture = Picture {
            result: "typed    \"to be\"".into(),
            state: PipelineState::Running,
            pressed: vec![down.face.target],
            fingertips: vec![Hover {
                finger: Finger::Index,
                board: 0,
                row_position: down.face.row_position,
                height: -0.003,
            }],
        };
        let mut terminal = Terminal::new(TestBackend::new(columns, rows)).unwrap();
        terminal.draw(|frame| scene.draw(frame, &picture)).unwrap();
        terminal
    }

    fn shown(columns: u16, rows: u16) -> String {
        drawn(columns, rows).backend().to_string()
    }

    #[test]
    fn a_pressed_key_is_lit_and_its_label_stays_readable() {
        let terminal = drawn(120, 40);
        let cells = terminal.backend().buffer().content().iter();
        let lit = cells.filter(|cell| cell.bg == Color::Green);
        let lit: String = lit.map(|cell| cell.symbol()).collect();
        assert_eq!(lit, "┌───┐│ W │└───┘");
    }

    #[test]
    fn a_large_window_shows_board_and_text() {
        let picture = shown(120, 40);
        assert!(picture.contains("QWERTY, 19 mm · running"), "{picture}");
        assert!(picture.contains("│ Q ││ W │"), "{picture}");
        assert!(picture.contains("typed    \"to be\""), "{picture}");
        assert!(!picture.contains("needs a window"), "{picture}");
    }

    #[test]
    fn a_small_window_shows_the_text_and_the_size_that_it_needs() {
        let picture = shown(64, 14);
        assert!(picture.contains("needs a window of 66×22"), "{picture}");
        assert!(picture.contains("typed    \"to be\""), "{picture}");
    }

    #[test]
    fn drawing_works_in_windows_of_any_size() {
        for (columns, rows) in [(0, 0), (1, 1), (5, 3), (300, 2), (2, 300)] {
            drawn(columns, rows);
        }
    }
}
