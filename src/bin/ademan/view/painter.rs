//! The thread that draws.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::pipeline::PipelineState;
use ademan::session::view::{View, ViewState};
use crossbeam_channel::RecvTimeoutError;
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::look::Look;
use super::picture::Picture;
use super::terminal::{self, Output};
use super::{TaskLines, Views};
use crate::messages;

/// Shortest time between two pictures: 30 pictures a second.
const PERIOD: Duration = Duration::from_millis(34);

/// Longest time until a message or another size of the window is seen.
const POLL_PERIOD: Duration = Duration::from_millis(100);

/// Messages of a picture.
const MAX_MESSAGES: usize = 8;

static IS_ENDING: AtomicBool = AtomicBool::new(false);

/// Lets a painter run.
pub fn begin() {
    IS_ENDING.store(false, Ordering::Relaxed);
}

/// Makes the painter end, even if the terminal accepts nothing.
pub fn end() {
    IS_ENDING.store(true, Ordering::Relaxed);
    terminal::end_output();
}

pub struct Painter {
    terminal: Terminal<CrosstermBackend<Output>>,
    views: Views,
    task: TaskLines,
    look: Look,
    /// The number of the takeover of the terminal in which it was drawn last. All of it has to be drawn after another one.
    takeover: u32,
}

/// Returns a terminal that draws all of the first picture.
fn new_terminal() -> io::Result<Terminal<CrosstermBackend<Output>>> {
    Terminal::new(CrosstermBackend::new(Output::open()?))
}

/// Returns the view that stays on the screen: the final one, with the hands where they were seen last.
fn last_view(view: View, tracked: Option<View>) -> View {
    let Some(tracked) = tracked.filter(|tracked| Arc::ptr_eq(&tracked.layout, &view.layout)) else {
        return view;
    };
    let (last, seen) = (&view.state, &tracked.state);
    let state = ViewState {
        fingertips: seen.fingertips.clone(),
        bends: seen.bends.clone(),
        pointer: seen.pointer,
        in_spaces_mm: seen.in_spaces_mm.clone(),
        ..ViewState::clone(last)
    };
    View {
        state: Arc::new(state),
        ..view
    }
}

/// The content of a picture.
#[derive(PartialEq)]
struct Content {
    task: Vec<String>,
    messages: Vec<String>,
    size: (u16, u16),
}

impl Painter {
    pub fn new(views: Views, task: TaskLines, look: Look) -> io::Result<Self> {
        Ok(Self {
            terminal: new_terminal()?,
            views,
            task,
            look,
            takeover: terminal::takeover(),
        })
    }

    /// Draws until the views end, and returns the last picture as text.
    pub fn run(mut self) -> io::Result<Option<String>> {
        let painted = self.paint();
        // The terminal shows its cursor when it is dropped, and must not wait for that.
        terminal::end_output();
        if painted.is_err() {
            super::abandon();
        }
        painted
    }

    fn paint(&mut self) -> io::Result<Option<String>> {
        let mut latest: Option<View> = None;
        let mut tracked: Option<View> = None;
        let mut drawn: Option<Content> = None;
        while !IS_ENDING.load(Ordering::Relaxed) {
            let is_new = match self.views.receiver().recv_timeout(POLL_PERIOD) {
                Ok(view) => {
                    if view.state.state == PipelineState::Running {
                        tracked = Some(view.clone());
                    }
                    latest = Some(view);
                    true
                }
                Err(RecvTimeoutError::Timeout) => false,
                Err(RecvTimeoutError::Disconnected) => break,
            };
            terminal::check_keys()?;
            let started = Instant::now();
            let Some(view) = &latest else {
                continue;
            };
            let content = self.content(view)?;
            let is_new = is_new || self.takeover != terminal::takeover();
            if terminal::is_covered() && (is_new || drawn.as_ref() != Some(&content)) {
                match self.draw(view, &content) {
                    // The view ends before the terminal accepts the picture.
                    Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                    result => result?,
                }
                drawn = Some(content);
                thread::sleep(PERIOD.saturating_sub(started.elapsed()));
            }
        }
        let latest = self.views.receiver().try_recv().ok().or(latest);
        Ok(latest.map(|view| self.last_picture(&last_view(view, tracked))))
    }

    fn content(&self, view: &View) -> io::Result<Content> {
        Ok(Content {
            task: self.task.get(),
            messages: match &self.views {
                // Messages of the session, and of the program around it.
                Views::Session(_) => messages::latest(MAX_MESSAGES),
                Views::Remote(_) => view.messages.to_vec(),
            },
            size: ratatui::crossterm::terminal::size()?,
        })
    }

    fn draw(&mut self, view: &View, content: &Content) -> io::Result<()> {
        let look = self.look;
        let takeover = terminal::takeover();
        if self.takeover != takeover {
            self.takeover = takeover;
            // Its function `clear` would ask the terminal for the position of the cursor, and wait for the answer.
            self.terminal = new_terminal()?;
        }
        self.terminal.draw(|frame| {
            let picture = Picture {
                view,
                task: &content.task,
                messages: &content.messages,
                look,
            };
            let area = frame.area();
            picture.draw(frame.buffer_mut(), area);
        })?;
        Ok(())
    }

    /// Returns the last picture without messages, which are printed too, and without colors.
    fn last_picture(&self, view: &View) -> String {
        let (columns, rows) = ratatui::crossterm::terminal::size().unwrap_or((80, 24));
        let area = Rect::new(0, 0, columns, rows);
        let mut buffer = Buffer::empty(area);
        let picture = Picture {
            view,
            task: &self.task.get(),
            messages: &[],
            look: self.look,
        };
        picture.draw(&mut buffer, area);
        let lines = (0..area.height).map(|row| {
            let cells = (0..area.width).map(|column| buffer[(column, row)].symbol());
            cells.collect::<String>().trim_end().to_owned()
        });
        let text = lines.collect::<Vec<_>>().join("\n");
        format!("{}\n", text.trim_end())
    }
}
