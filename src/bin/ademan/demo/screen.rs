//! The terminal while the demo plays: pictures go out, Ctrl-C comes in.

use std::io;
use std::thread::JoinHandle;
use std::time::Duration;

use ademan::contact::{Phase, TargetId};
use ademan::layout::Layout;
use ademan::snapshot::Snapshot;
use ademan::time::Timestamp;
use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyModifiers};

use super::draw::{Picture, Stage};
use crate::signals::Stopper;

/// Time between two pictures where nothing new is pressed.
const PERIOD: Duration = Duration::from_millis(33);
/// How long Ctrl-C may go unnoticed where nothing is drawn.
const GLANCE: Duration = Duration::from_millis(50);

/// Shows frames in the terminal, from a thread of its own.
pub struct Screen {
    pictures: Option<Sender<Picture>>,
    painter: Option<JoinHandle<io::Result<()>>>,
    layout: Layout,
    pressed: Vec<TargetId>,
    last: Timestamp,
}

impl Screen {
    /// Takes over the terminal; what is typed there goes nowhere, but for Ctrl-C, which asks `stopper`.
    ///
    /// A terminal that cannot be taken over shows nothing.
    pub fn open(layout: &Layout, task: String, stopper: Stopper) -> Self {
        let mut screen = Self::closed(layout);
        let terminal = match ratatui::try_init() {
            Ok(terminal) => terminal,
            Err(error) => {
                ratatui::restore();
                tracing::warn!("cannot draw on this terminal, going on without: {error}");
                return screen;
            }
        };
        let (pictures, waiting) = bounded(1);
        let painter = Painter {
            terminal,
            stage: Stage {
                grids: layout.grids(),
                layout: layout.clone(),
                task,
            },
            stopper,
        };
        screen.pictures = Some(pictures);
        screen.painter = Some(std::thread::spawn(move || painter.paint(&waiting)));
        screen
    }

    /// Shows nothing: for an output that is no terminal, or that something else is written to.
    pub fn closed(layout: &Layout) -> Self {
        Self {
            pictures: None,
            painter: None,
            layout: layout.clone(),
            pressed: Vec::new(),
            last: Timestamp(0),
        }
    }

    /// Shows a frame; never waits: a picture that the terminal has no time for is left out.
    pub fn show(&mut self, frame: &Snapshot, outcome: impl FnOnce() -> String) {
        let Some(pictures) = &self.pictures else {
            return;
        };
        for touch in &frame.touches {
            match touch.phase {
                Phase::Pressed => self.pressed.push(touch.target),
                Phase::Released | Phase::Left | Phase::Cancelled => {
                    self.pressed.retain(|target| *target != touch.target);
                }
                Phase::Touched | Phase::Moved => {}
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
            outcome: outcome(),
            state: frame.state,
            pressed: self.pressed.clone(),
            fingertips: self.layout.hovers(pose),
        };
        // A full channel means that the terminal still draws the last one.
        let _ = pictures.try_send(picture);
    }
}

/// Gives the terminal back, whatever the end.
impl Drop for Screen {
    fn drop(&mut self) {
        self.pictures = None;
        let Some(painter) = self.painter.take() else {
            return;
        };
        let painted = painter.join();
        // A panic has given it back already; twice would put the cursor on top of the message.
        if !std::thread::panicking() && painted.is_ok() {
            ratatui::restore();
        }
        if !matches!(painted, Ok(Ok(()))) {
            tracing::warn!("the terminal could not be drawn on");
        }
    }
}

struct Painter {
    terminal: DefaultTerminal,
    stage: Stage,
    stopper: Stopper,
}

impl Painter {
    fn paint(mut self, pictures: &Receiver<Picture>) -> io::Result<()> {
        loop {
            match pictures.recv_timeout(GLANCE) {
                Ok(picture) => {
                    self.terminal
                        .draw(|frame| self.stage.draw(frame, &picture))?;
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            self.heed_keys()?;
        }
    }

    /// The terminal makes no signal of Ctrl-C while it is drawn on.
    fn heed_keys(&self) -> io::Result<()> {
        while event::poll(Duration::ZERO)? {
            if !is_ctrl_c(&event::read()?) {
                continue;
            }
            if self.stopper.is_asked() {
                ratatui::restore();
            }
            self.stopper.ask();
        }
        Ok(())
    }
}

fn is_ctrl_c(event: &Event) -> bool {
    event.as_key_press_event().is_some_and(|key| {
        key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL)
    })
}
