//! The terminal during the demo: pictures out, Ctrl-C in.

use std::io;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ademan::advice;
use ademan::contact::{Phase, TargetId};
use ademan::layout::{KeySize, Layout};
use ademan::snapshot::Snapshot;
use ademan::time::Timestamp;
use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded, never};
use ratatui::DefaultTerminal;

use super::draw::{Picture, Scene};
use super::interrupt;
use crate::signals;

/// Time between two pictures without events.
const PERIOD: Duration = Duration::from_millis(33);

/// Time between two checks for Ctrl-C while nothing is drawn.
const KEY_PERIOD: Duration = Duration::from_millis(50);

/// Longest time at the end in which the terminal accepts the last picture: one that is stopped by Ctrl-S never does.
const END_TIMEOUT: Duration = Duration::from_secs(1);

/// Draws snapshots in the terminal, on a thread of its own.
pub struct Screen {
    pictures: Option<Sender<Picture>>,
    painter: Option<JoinHandle<io::Result<()>>>,
    /// Disconnected when the painter has ended.
    ended: Receiver<()>,
    layout: Layout,
    pressed: Vec<TargetId>,
    last_drawn: Timestamp,
}

impl Screen {
    /// Takes over the terminal. Keys typed there have no effect, except Ctrl-C, which stops the demo. A terminal that
    /// cannot be taken over stays as it is.
    pub fn open(layout: &Layout, goal: String) -> Self {
        let mut screen = Self::closed(layout);
        // A second Ctrl-C ends the process without dropping the screen.
        signals::before_exit(restore);
        let terminal =
            match ratatui::try_init().and_then(|terminal| interrupt::enable().map(|()| terminal)) {
                Ok(terminal) => terminal,
                Err(error) => {
                    restore();
                    tracing::warn!("cannot draw in this terminal, continuing without: {error}");
                    return screen;
                }
            };
        let (pictures, queue) = bounded(1);
        let painter = Painter {
            terminal,
            scene: Scene {
                grids: layout.grids(KeySize::Bordered),
                layout: layout.clone(),
                goal,
            },
        };
        let thread = thread::Builder::new().name("screen".into());
        let (end, ended) = bounded::<()>(0);
        let paint = move || {
            let _end = end;
            painter.run(&queue)
        };
        match thread.spawn(paint) {
            Ok(painter) => {
                screen.ended = ended;
                screen.pictures = Some(pictures);
                screen.painter = Some(painter);
            }
            Err(error) => {
                ratatui::restore();
                let advice = advice::no_thread(&error);
                tracing::warn!("continuing without the drawing: {advice}");
            }
        }
        screen
    }

    /// Draws nothing, for a standard output that is no terminal or carries a transcript.
    pub fn closed(layout: &Layout) -> Self {
        Self {
            pictures: None,
            painter: None,
            ended: never(),
            layout: layout.clone(),
            pressed: Vec::new(),
            last_drawn: Timestamp(0),
        }
    }

    /// Draws a snapshot. Never waits: the terminal skips pictures that it has no time for.
    pub fn show(&mut self, snapshot: &Snapshot, result: impl FnOnce() -> String) {
        let Some(pictures) = &self.pictures else {
            return;
        };
        for touch in &snapshot.touches {
            match touch.phase {
                Phase::Pressed => self.pressed.push(touch.target),
                Phase::Released | Phase::Left | Phase::Cancelled => {
                    self.pressed.retain(|target| *target != touch.target);
                }
                Phase::Touched | Phase::Moved => {}
            }
        }
        let Some(pose) = &snapshot.pose else {
            return;
        };
        if snapshot.events.is_empty() && pose.time.since(self.last_drawn) < PERIOD {
            return;
        }
        self.last_drawn = pose.time;
        let picture = Picture {
            result: result(),
            state: snapshot.state,
            pressed: self.pressed.clone(),
            fingertips: self.layout.hovers(&self.layout.scene, pose),
        };
        // A full channel means that the terminal still draws the previous picture.
        let _ = pictures.try_send(picture);
    }
}

/// Restores the terminal.
impl Drop for Screen {
    fn drop(&mut self) {
        self.pictures = None;
        let Some(painter) = self.painter.take() else {
            return;
        };
        if self.ended.recv_timeout(END_TIMEOUT) == Err(RecvTimeoutError::Timeout) {
            // Anything else that is written to this terminal would block too.
            return;
        }
        let painted = painter.join();
        // The panic hook has restored it already; a second time would put the cursor on the message.
        if !std::thread::panicking() && painted.is_ok() {
            restore();
        }
        interrupt::discard_input();
        if !matches!(painted, Ok(Ok(()))) {
            tracing::warn!("cannot draw in this terminal");
        }
    }
}

/// Restores the terminal as far as it still exists. The function of the library reports a failure on standard error and
/// panics if that is gone too.
fn restore() {
    let _ = ratatui::try_restore();
}

struct Painter {
    terminal: DefaultTerminal,
    scene: Scene,
}

impl Painter {
    fn run(mut self, pictures: &Receiver<Picture>) -> io::Result<()> {
        let painted = self.paint(pictures);
        // A terminal that is dropped with a hidden cursor shows it, and panics if neither that nor a message about the
        // failure can be written, as when the window is closed.
        if self.terminal.show_cursor().is_err() {
            std::mem::forget(self.terminal);
        }
        painted
    }

    fn paint(&mut self, pictures: &Receiver<Picture>) -> io::Result<()> {
        loop {
            match pictures.recv_timeout(KEY_PERIOD) {
                Ok(picture) => {
                    self.terminal
                        .draw(|frame| self.scene.draw(frame, &picture))?;
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            interrupt::check()?;
        }
    }
}
