//! What the demo shows while it types: the board with keys lit, fingertips over it, the text so far.

use std::io::IsTerminal;
use std::thread::JoinHandle;
use std::time::Duration;

use ademan::contact::{Phase, TargetId};
use ademan::hand::Finger;
use ademan::layout::{Cell, Grid, Key, Layout, OverBoard};
use ademan::monitor::{Snapshot, State};
use ademan::time::Timestamp;
use crossbeam_channel::{Receiver, Sender, bounded};
use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout as Split, Rect};
use ratatui::style::{Color, Modifier, Style, Stylize};
use ratatui::text::Line;
use ratatui::widgets::{Block, BorderType, Paragraph, Widget};
use ratatui::{DefaultTerminal, Frame};

use crate::failure::Failure;

/// Time between two pictures where nothing new is pressed.
const PERIOD: Duration = Duration::from_millis(33);

/// Shows frames in the terminal, from a thread of its own; on anything else than a terminal, nothing.
pub struct Screen {
    pictures: Option<Sender<Picture>>,
    painter: Option<JoinHandle<std::io::Result<()>>>,
    layout: Layout,
    pressed: Vec<TargetId>,
    last: Timestamp,
}

/// All that one picture needs.
struct Picture {
    typed: String,
    state: State,
    pressed: Vec<TargetId>,
    fingertips: Vec<OverBoard>,
}

impl Screen {
    /// Takes over the terminal, if there is one.
    pub fn open(layout: &Layout, presented: &str) -> Result<Self, Failure> {
        let mut screen = Self {
            pictures: None,
            painter: None,
            layout: layout.clone(),
            pressed: Vec::new(),
            last: Timestamp(0),
        };
        if std::io::stdout().is_terminal() {
            let (pictures, waiting) = bounded(1);
            let terminal = ratatui::try_init()?;
            let painter = Painter {
                terminal,
                layout: layout.clone(),
                grids: layout.grids(),
                presented: presented.to_owned(),
            };
            screen.pictures = Some(pictures);
            screen.painter = Some(std::thread::spawn(move || painter.paint(&waiting)));
        }
        Ok(screen)
    }

    /// Shows a frame; never waits: a picture that the terminal has no time for is left out.
    pub fn show(&mut self, frame: &Snapshot, typed: &str) {
        let Some(pictures) = &self.pictures else {
            return;
        };
        for touch in &frame.touches {
            match touch.phase {
                Phase::Pressed => self.pressed.push(touch.target),
                Phase::Released | Phase::Left | Phase::Cancelled => {
                    self.pressed.retain(|target| *target != touch.target);
                }
                Phase::Touched | Phase::Held => {}
            }
        }
        let Some(pose) = &frame.pose else {
            return;
        };
        if frame.events.is_empty() && pose.time.since(self.last) < PERIOD {
            return;
        }
        self.last = pose.time;
        let picture = Picture {
            typed: typed.to_owned(),
            state: frame.state,
            pressed: self.pressed.clone(),
            fingertips: self.layout.over_boards(pose),
        };
        // A full channel means that the terminal still draws the last one.
        let _ = pictures.try_send(picture);
    }

    /// Gives the terminal back.
    pub fn close(mut self) {
        self.pictures = None;
        if let Some(painter) = self.painter.take()
            && !matches!(painter.join(), Ok(Ok(())))
        {
            tracing::warn!("the terminal could not be drawn on");
        }
    }
}

struct Painter {
    terminal: DefaultTerminal,
    layout: Layout,
    grids: Vec<Grid>,
    presented: String,
}

impl Painter {
    fn paint(mut self, pictures: &Receiver<Picture>) -> std::io::Result<()> {
        let painted = pictures.iter().try_for_each(|picture| {
            let (layout, grids, presented) = (&self.layout, &self.grids, &self.presented);
            let drawn = self
                .terminal
                .draw(|frame| draw(frame, &picture, layout, grids, presented));
            drawn.map(|_| ())
        });
        ratatui::try_restore()?;
        painted
    }
}

fn draw(frame: &mut Frame, picture: &Picture, layout: &Layout, grids: &[Grid], presented: &str) {
    let [title, board, text] = Split::vertical([
        Constraint::Length(1),
        Constraint::Fill(1),
        Constraint::Length(5),
    ])
    .areas(frame.area());
    let title_line = format!(" {} · {} ", layout.name, picture.state);
    frame.render_widget(Line::from(title_line).bold(), title);
    let mut corner = board;
    for (number, grid) in grids.iter().enumerate() {
        draw_board(frame.buffer_mut(), corner, picture, layout, (number, grid));
        let below = grid.rows as u16 + 1;
        corner = Rect {
            y: corner.y.saturating_add(below).min(board.bottom()),
            height: corner.height.saturating_sub(below),
            ..corner
        };
    }
    let lines = vec![
        Line::from(format!("to type  {presented:?}")).dim(),
        Line::from(format!("typed    {:?}", picture.typed)).bold(),
    ];
    let block = Block::bordered().border_type(BorderType::Rounded);
    frame.render_widget(Paragraph::new(lines).block(block), text);
}

fn draw_board(
    buffer: &mut Buffer,
    area: Rect,
    picture: &Picture,
    layout: &Layout,
    board: (usize, &Grid),
) {
    let (number, grid) = board;
    for cell in &grid.cells {
        if let (Some(key), Some(place)) = (layout.key_of(cell.target), within(area, cell)) {
            draw_key(buffer, place, key, picture.pressed.contains(&cell.target));
        }
    }
    for tip in picture.fingertips.iter().filter(|tip| tip.board == number) {
        let Some((column, row)) = grid.character_at(tip.along_rows) else {
            continue;
        };
        let spot = (area.x + column as u16, area.y + row as u16);
        if area.contains(spot.into()) {
            let style = Style::new().fg(if tip.finger == Finger::Index {
                Color::Yellow
            } else {
                Color::DarkGray
            });
            let mark = if tip.height < 0.0 { "●" } else { "○" };
            buffer.set_string(spot.0, spot.1, mark, style);
        }
    }
}

fn draw_key(buffer: &mut Buffer, place: Rect, key: &Key, lit: bool) {
    let style = match lit {
        true => Style::new()
            .fg(Color::Black)
            .bg(Color::Green)
            .add_modifier(Modifier::BOLD),
        false => Style::new(),
    };
    let block = Block::bordered().style(style);
    let inside = block.inner(place);
    block.render(place, buffer);
    Line::from(key.label.as_str())
        .style(style)
        .centered()
        .render(inside, buffer);
}

/// Where a key is on the screen; `None` when the window is too small for it.
fn within(area: Rect, cell: &Cell) -> Option<Rect> {
    let place = Rect {
        x: area.x + cell.column as u16,
        y: area.y + cell.row as u16,
        width: cell.width as u16,
        height: cell.height as u16,
    };
    (area.intersection(place) == place).then_some(place)
}
