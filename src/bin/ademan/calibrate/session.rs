//! The guided session: readings in, poses out, on the screen of a terminal or as lines.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use ademan::calibrate::{
    CalibrationError, CalibrationPose, CaptureState, PoseMark, Procedure, ProcedureState,
};
use ademan::capture::Channels;
use ademan::estimate::ChannelMap;
use ademan::hand::Side;
use ademan::message::escape;
use ademan::time::Timestamp;
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;

use super::feed::{Feed, FeedEvent};
use super::screen::Screen;
use crate::failure::Failure;
use crate::view::look::Look;
use crate::view::terminal::{self, Output};
use crate::{messages, pause_signals, signals, view};

/// Shortest time between two pictures.
const PICTURE_PERIOD: Duration = Duration::from_millis(34);

/// The readings of a session: the times and the counts of all channels.
pub type Readings = Vec<(Timestamp, Channels)>;

/// The time without a reading after which a message says so.
const SILENCE: Duration = Duration::from_secs(2);

/// The message about a source that has sent readings and sends none now.
const SILENT: &str = "no readings arrive: check that the glove is connected and on; the pose starts again with the next one";

/// Readings that are kept, some 60 MB: a person may leave the glove for hours before a pose.
const MAX_READINGS: usize = 400_000;

/// The end of a session.
pub enum Outcome {
    /// All poses were taken or skipped.
    Finished,
    /// The person quit, or a signal ended the program.
    Quit,
}

/// A guided session.
pub struct Session<'a> {
    pub glove: &'a str,
    pub side: Side,
    /// The channels of the glove; `None` if they are not known.
    pub map: Option<&'a ChannelMap>,
    pub procedure: Procedure,
    pub readings: Readings,
    feed: Feed,
    state: CaptureState,
    message: String,
    /// `true` once the source was lost.
    was_lost: bool,
    /// The time at which the latest reading came.
    heard_at: Option<Instant>,
}

impl<'a> Session<'a> {
    pub fn new(
        glove: &'a str,
        side: Side,
        map: Option<&'a ChannelMap>,
        procedure: Procedure,
        feed: Feed,
    ) -> Self {
        Self {
            glove,
            side,
            map,
            procedure,
            readings: Readings::new(),
            message: format!("waiting for readings of {}", feed.name()),
            feed,
            state: CaptureState::Moving,
            was_lost: false,
            heard_at: None,
        }
    }

    /// Leads through the poses, on the terminal if standard output is one.
    pub fn run(&mut self) -> Result<Outcome, Failure> {
        if is_on_terminal() {
            self.run_on_terminal()
        } else {
            self.run_in_lines()
        }
    }

    fn run_on_terminal(&mut self) -> Result<Outcome, Failure> {
        signals::before_exit(view::abandon);
        pause_signals::install_without_session()?;
        terminal::take_over()?;
        messages::hold();
        let outcome = self.show();
        terminal::end_output();
        view::abandon();
        outcome
    }

    fn show(&mut self) -> Result<Outcome, Failure> {
        let look = Look::from_environment();
        let mut screen = new_screen()?;
        let mut takeover = terminal::takeover();
        let mut drawn_at: Option<Instant> = None;
        loop {
            if signals::is_stop_requested() {
                return Ok(Outcome::Quit);
            }
            for key in terminal::typed_keys()? {
                match key {
                    b'r' => self.procedure.repeat(),
                    b'b' => self.go_back(),
                    b's' => self.procedure.skip(),
                    b'q' => return Ok(Outcome::Quit),
                    _ => {}
                }
            }
            if self.advance()?.is_some() {
                return Ok(Outcome::Finished);
            }
            if drawn_at.is_none_or(|drawn_at| drawn_at.elapsed() >= PICTURE_PERIOD) {
                drawn_at = Some(Instant::now());
                if takeover != terminal::takeover() {
                    // The process was stopped, and nothing of the picture is left.
                    takeover = terminal::takeover();
                    screen = new_screen()?;
                }
                match screen.draw(|frame| self.screen(look).draw(frame.buffer_mut())) {
                    // Ctrl-Z gives the terminal back before it accepts the picture.
                    Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                    drawn => _ = drawn?,
                }
            }
        }
    }

    fn screen(&self, look: Look) -> Screen<'_> {
        Screen {
            glove: self.glove,
            side: self.side,
            source: self.feed.name(),
            map: self.map,
            full_scale: self.full_scale(),
            procedure: &self.procedure,
            state: self.state,
            message: &self.message,
            look,
        }
    }

    /// Returns the largest count of a channel; 0 before the first reading.
    pub fn full_scale(&self) -> u16 {
        let first = self.readings.first();
        first.map_or(0, |(_, channels)| channels.full_scale)
    }

    fn run_in_lines(&mut self) -> Result<Outcome, Failure> {
        let mut announced: Option<CalibrationPose> = None;
        loop {
            if signals::is_stop_requested() {
                return Ok(Outcome::Quit);
            }
            if announced != self.procedure.pose()
                && let Some(pose) = self.procedure.pose()
            {
                announced = Some(pose);
                let (number, count) = (self.procedure.index() + 1, self.procedure.poses().len());
                let instruction = pose.instruction();
                let mut out = io::stdout();
                // Without a reader the session continues: the glove file is still written, and the error of the report is shown.
                let _ = writeln!(out, "pose {number} of {count}: {pose}: {instruction}");
            }
            if self.advance()?.is_some() {
                return Ok(Outcome::Finished);
            }
        }
    }

    /// Handles the next event of the source. Returns `Some` at the end.
    fn advance(&mut self) -> Result<Option<()>, Failure> {
        match self.feed.next(self.procedure.pose())? {
            FeedEvent::Channels(time, channels) => {
                self.check_shape(&channels)?;
                self.message.clear();
                self.heard_at = Some(Instant::now());
                let state = self.procedure.push(time, &channels);
                if self.readings.len() >= MAX_READINGS {
                    let marks = self.procedure.marks();
                    forget_waiting(&mut self.readings, marks, MAX_READINGS / 2);
                }
                self.readings.push((time, *channels));
                match state {
                    ProcedureState::Pose(_, state) => self.state = state,
                    ProcedureState::Finished => return Ok(Some(())),
                }
            }
            FeedEvent::Idle => self.show_warning(),
            FeedEvent::Lost(reason) => {
                self.message = reason;
                self.was_lost = true;
            }
            FeedEvent::End => {
                return Err(Failure::job(format!(
                    "{} ended at pose {} of {}; start again when it sends readings",
                    escape(self.feed.name()),
                    self.procedure.index() + 1,
                    self.procedure.poses().len()
                )));
            }
        }
        // The last pose may have been skipped.
        Ok(self.procedure.pose().is_none().then_some(()))
    }

    /// Shows that no more readings come, or why the first one does not, as far as the source has found out. The screen holds back its
    /// warnings.
    fn show_warning(&mut self) {
        let is_silent = |heard_at: Instant| heard_at.elapsed() >= SILENCE;
        if self.heard_at.is_some_and(is_silent) && self.message.is_empty() {
            self.message = SILENT.to_owned();
        }
        if !self.readings.is_empty() || self.was_lost {
            return;
        }
        if let Some(warning) = messages::latest(1).pop() {
            self.message = warning;
        }
    }

    fn check_shape(&self, channels: &Channels) -> Result<(), Failure> {
        let found = channels.full_scale;
        match self.map.map(ChannelMap::full_scale) {
            Some(expected) if expected != found => {
                Err(CalibrationError::OtherFullScale { found, expected }.into())
            }
            _ => Ok(()),
        }
    }

    /// Returns to the pose before the present one.
    fn go_back(&mut self) {
        if !matches!(self.state, CaptureState::Preparing(_)) {
            self.procedure.repeat();
        }
        self.procedure.repeat();
    }
}

/// Removes the readings that belong to no pose, but the latest ones.
fn forget_waiting(readings: &mut Readings, marks: &[PoseMark], latest: usize) {
    let mut older = readings.len().saturating_sub(latest);
    readings.retain(|(time, _)| {
        let is_late = older == 0;
        older = older.saturating_sub(1);
        is_late || marks.iter().any(|it| (it.start..=it.end).contains(time))
    });
}

fn new_screen() -> io::Result<Terminal<CrosstermBackend<Output>>> {
    Terminal::new(CrosstermBackend::new(Output::open()?))
}

/// Returns `true` if the session is shown on a terminal, which needs keys too.
pub fn is_on_terminal() -> bool {
    view::is_possible() && io::stdin().is_terminal()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_of_a_pose_stay_and_those_before_it_are_forgotten() {
        let channels = || Channels {
            full_scale: 255,
            counts: Default::default(),
            unsent: Default::default(),
        };
        let all = (0..10).map(|time| (Timestamp(time), channels()));
        let mut readings: Readings = all.collect();
        let mark = PoseMark {
            pose: CalibrationPose::Flat,
            start: Timestamp(2),
            end: Timestamp(3),
        };
        forget_waiting(&mut readings, &[mark], 4);
        let times: Vec<u64> = readings.iter().map(|(time, _)| time.0).collect();
        assert_eq!(times, [2, 3, 6, 7, 8, 9]);
    }
}
