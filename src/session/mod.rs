//! Drives a pipeline, live or from a recording: one loop for both.

mod call;
pub mod control_socket;
mod inbox;
pub mod panic_keys;
pub mod reload;

use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, TryRecvError, never};
use hdrhistogram::Histogram;

use crate::capture::{
    CaptureError, CaptureEvent, CaptureThread, Reading, Source, SourceStats, spawn,
};
use crate::contact::{TargetNames, Touches};
use crate::device::{Events, TimedCommands};
use crate::output::{OutputError, Sink};
use crate::pipeline::{LayoutInstance, Pipeline, StepOutput};
use crate::snapshot::{Snapshot, Stats};
use crate::time::NO_DEADLINE;

use self::inbox::{Inbox, Message};
pub use crate::pipeline::CommandError;
pub use call::{Answer, BoardPoses, Call, Calls, Order, SessionStatus, calls};

/// No source is so slow that it would have to be waited for longer, whatever a recording says: three frames at
/// 1200 baud take 1.7 s.
const MAX_STALL_LIMIT: Duration = Duration::from_secs(2);

/// While readings are expected, an output hears so often that the loop is alive: it may have to tell a guardian,
/// which waits for 200 ms.
const HEARTBEAT_PERIOD: Duration = Duration::from_millis(50);

/// Why a run ended before its source did.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// No more readings can be had.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// Events cannot be delivered.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// What happened in a run.
#[derive(Clone, Debug)]
pub struct Summary {
    /// The account of all readings.
    pub stats: Stats,
    /// From the last byte of a frame to its events handed to the output, in nanoseconds; frames with
    /// events only.
    pub latency_ns: Histogram<u64>,
}

/// What a run hears from outside, between two frames.
///
/// A receiver of stops alone is one of these: nothing is replaced then.
#[derive(Clone, Debug)]
pub struct Commands {
    /// Whatever comes in here ends the run.
    pub stop: Receiver<()>,
    /// Other controls, put in force after those that are were let go of.
    pub replace: Receiver<Replacement>,
    /// Orders that are answered.
    pub calls: Receiver<Call>,
}

impl From<&Receiver<()>> for Commands {
    fn from(stop: &Receiver<()>) -> Self {
        Self {
            stop: stop.clone(),
            replace: never(),
            calls: never(),
        }
    }
}

/// Controls that are ready to be put in force.
pub struct Replacement {
    /// The new ones.
    pub controls: Box<LayoutInstance>,
    /// The place of the layout whose controls they are.
    pub profile: usize,
    /// Whether their boards go where those in force are; else they go where their file says.
    pub keep_board_poses: bool,
    /// Takes the old ones, let go of, when the new ones are in force: whoever holds the other end frees
    /// them, so that the loop need not. Should have room for them; where it has none they are freed in
    /// the loop.
    pub retired: Sender<Box<LayoutInstance>>,
}

/// Takes readings from `source` through `pipeline` to `sink`, until the source ends or `commands` say
/// so.
///
/// `observe` sees a copy of every frame; it must not wait. Whatever the end, also a panic, the sink
/// is closed, which lets go of everything. A live source whose readings stay away for longer than the
/// stall limit (at least three of its frame periods, but those count up to 2 s) stalls the pipeline.
pub fn run_pipeline(
    source: impl Source + 'static,
    pipeline: &mut Pipeline,
    sink: &mut dyn Sink,
    commands: impl Into<Commands>,
    observe: &mut dyn FnMut(&Snapshot),
) -> Result<Summary, SessionError> {
    let captured = spawn(source)?;
    let inbox = Inbox::open(commands.into()).map_err(|error| CaptureError::Open {
        source_name: captured.name().to_owned(),
        reason: format!("no thread for commands: {error}; close other programs"),
    })?;
    let period = captured.packet_period().unwrap_or(Duration::ZERO);
    let three_frames = period.saturating_mul(3).min(MAX_STALL_LIMIT);
    pipeline.set_stall_timeout(pipeline.stall_timeout().max(three_frames));
    let mut run = SessionLoop {
        captured,
        profile: pipeline.active_profile(),
        names: pipeline.target_names().clone(),
        pipeline,
        sink: CloseOnPanic(sink),
        observe,
        events: Events::new(),
        fed_at: None,
        source: SourceStats::default(),
        late: 0,
        untaken: 0,
        latency_ns: new_histogram(),
    };
    run.rename();
    let ended = run.until_over(&inbox);
    let closed = run.finish();
    ended?;
    closed?;
    Ok(Summary {
        stats: run.tally(),
        latency_ns: run.latency_ns,
    })
}

/// Closes the sink also when the loop panics.
struct CloseOnPanic<'a>(&'a mut dyn Sink);

impl Drop for CloseOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking()
            && let Err(error) = self.0.close()
        {
            tracing::error!("{error}");
        }
    }
}

struct SessionLoop<'a> {
    captured: CaptureThread,
    pipeline: &'a mut Pipeline,
    /// The place of the layout that the sink was told of last, and what its targets are called.
    profile: usize,
    names: TargetNames,
    sink: CloseOnPanic<'a>,
    observe: &'a mut dyn FnMut(&Snapshot),
    events: Events,
    fed_at: Option<Instant>,
    source: SourceStats,
    /// Readings that were too old when they were taken.
    late: u64,
    /// Readings that still waited when the run ended.
    untaken: u64,
    latency_ns: Histogram<u64>,
}

impl SessionLoop<'_> {
    fn until_over(&mut self, inbox: &Inbox) -> Result<(), SessionError> {
        loop {
            // Of each one: those who never cease to ask do not keep readings waiting, nor the other way round.
            let message = inbox.take();
            let is_asked = message.is_some();
            if let Some(message) = message
                && self.obey(message)?
            {
                return Ok(());
            }
            match self.captured.events().try_recv() {
                Ok(arrival) => {
                    if self.take(arrival)? {
                        return Ok(());
                    }
                }
                // Only after an end or a failure, and those were the last that was taken.
                Err(TryRecvError::Disconnected) => return Ok(()),
                Err(TryRecvError::Empty) if is_asked => {}
                Err(TryRecvError::Empty) => self.wait()?,
            }
        }
    }

    /// Parks until there is something to do.
    fn wait(&mut self) -> Result<(), SessionError> {
        thread::park_timeout(self.patience().min(self.sign_of_life()));
        if self.captured.events().is_empty() {
            self.sink.0.send(&[])?;
            self.stall_if_overdue()?;
        }
        Ok(())
    }

    /// Does what somebody asks for; whether that is to end.
    fn obey(&mut self, message: Message) -> Result<bool, SessionError> {
        match message {
            Message::Stop => return Ok(true),
            Message::Replace(replacement) => self.replace(replacement)?,
            Message::Call(call) => self.answer(call)?,
        }
        self.stall_if_overdue()?;
        Ok(false)
    }

    /// How long to wait for a reading until the output hears again.
    fn sign_of_life(&self) -> Duration {
        match self.pipeline.expects_readings() {
            true => HEARTBEAT_PERIOD,
            false => NO_DEADLINE,
        }
    }

    /// How long a live source may stay silent from now on until it has stalled.
    fn patience(&self) -> Duration {
        match self.fed_at {
            Some(fed_at) if self.captured.is_live() && self.pipeline.expects_readings() => {
                let deadline = fed_at + self.pipeline.stall_timeout();
                deadline.saturating_duration_since(Instant::now())
            }
            _ => NO_DEADLINE,
        }
    }

    /// Takes what the capture thread says; whether that was the last of it.
    fn take(&mut self, arrival: CaptureEvent) -> Result<bool, SessionError> {
        match arrival {
            CaptureEvent::Reading {
                reading,
                received_at: arrived,
                stats: counts,
            } => {
                self.source = counts;
                self.step(reading, arrived)?;
            }
            CaptureEvent::Noise(counts) => self.source = counts,
            CaptureEvent::Lost(error) => {
                tracing::warn!("{error}");
                self.source.losses += 1;
                self.stall()?;
            }
            CaptureEvent::Failed(error) => return Err(error.into()),
            CaptureEvent::End(counts) => {
                self.source = counts;
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn step(&mut self, reading: Reading, arrived: Instant) -> Result<(), SessionError> {
        if self.captured.is_live() && arrived.elapsed() > self.pipeline.stall_timeout() {
            // The program stood still: nobody types with a hand of back then.
            self.late += 1;
            return self.stall();
        }
        self.events.clear();
        let frame = self.pipeline.step(&reading, &mut self.events);
        let frame = frame.ok().cloned();
        if frame.is_some() {
            self.fed_at = Some(arrived);
        }
        if let Some(frame) = &frame
            && !frame.commands.is_empty()
        {
            self.sink.0.log_commands(&frame.commands)?;
        }
        self.deliver()?;
        if !self.events.is_empty() {
            self.latency_ns
                .saturating_record(arrived.elapsed().as_nanos() as u64);
        }
        self.show(Some(reading), frame);
        Ok(())
    }

    /// Also after every command: those who never cease to ask do not put off a stall.
    fn stall_if_overdue(&mut self) -> Result<(), SessionError> {
        // A reading that waits is no stall.
        if self.captured.events().is_empty() && self.patience().is_zero() {
            self.stall()?;
        }
        Ok(())
    }

    fn stall(&mut self) -> Result<(), SessionError> {
        self.events.clear();
        self.pipeline.stall(&mut self.events);
        self.fed_at = None;
        self.deliver()?;
        self.show(None, None);
        Ok(())
    }

    fn replace(&mut self, replacement: Replacement) -> Result<(), SessionError> {
        let mut controls = replacement.controls;
        if replacement.keep_board_poses {
            let profile = replacement.profile;
            self.pipeline.keep_board_poses(profile, &mut controls);
        }
        self.events.clear();
        self.pipeline
            .replace_profile(replacement.profile, &mut controls, &mut self.events);
        self.deliver()?;
        self.show(None, None);
        self.rename();
        let _ = replacement.retired.try_send(controls);
        Ok(())
    }

    fn answer(&mut self, call: Call) -> Result<(), SessionError> {
        let answer = match call.order {
            Order::State => Ok(Answer::State(self.state())),
            Order::Pause => self.pause().map(|()| Ok(Answer::Done))?,
            Order::Resume => {
                self.pipeline.resume();
                self.show(None, None);
                Ok(Answer::Done)
            }
            Order::Profile(place) => self.switch_to(place.into()).map(|()| Ok(Answer::Done))?,
            Order::NextProfile => {
                let next = (self.pipeline.active_profile() + 1) % self.pipeline.profile_count();
                self.switch_to(next).map(|()| Ok(Answer::Done))?
            }
            Order::Places => Ok(Answer::Places(BoardPoses {
                profile: self.pipeline.active_profile() as u8,
                boards: self.pipeline.board_poses().collect(),
            })),
            Order::Nudge(by) => self.shift(|pipeline, events| pipeline.nudge(by.into(), events))?,
            Order::Tilt(by) => self.shift(|pipeline, events| pipeline.tilt(by, events))?,
            Order::Recentre => {
                // It goes by the hand that is seen now.
                self.stall_if_overdue()?;
                self.shift(Pipeline::recenter)?
            }
        };
        // Nobody waits for whoever went away.
        let _ = call.answer.try_send(answer);
        Ok(())
    }

    fn pause(&mut self) -> Result<(), SessionError> {
        self.events.clear();
        self.pipeline.pause(&mut self.events);
        self.deliver()?;
        self.show(None, None);
        Ok(())
    }

    fn switch_to(&mut self, profile: usize) -> Result<(), SessionError> {
        self.events.clear();
        self.pipeline.switch_profile(profile, &mut self.events);
        self.deliver()?;
        self.show(None, None);
        Ok(())
    }

    /// Moves boards, if that can be.
    fn shift(
        &mut self,
        shift: impl FnOnce(&mut Pipeline, &mut Events) -> Result<(), CommandError>,
    ) -> Result<Result<Answer, CommandError>, SessionError> {
        self.events.clear();
        let shifted = shift(self.pipeline, &mut self.events);
        self.deliver()?;
        self.show(None, None);
        Ok(shifted.map(|()| Answer::Done))
    }

    fn state(&self) -> SessionStatus {
        SessionStatus {
            state: self.pipeline.state(),
            is_paused: self.pipeline.is_paused(),
            profile: self.pipeline.active_profile() as u8,
            stats: self.tally(),
            dropped_presses: self.sink.0.dropped_presses(),
        }
    }

    fn finish(&mut self) -> Result<(), SessionError> {
        for arrival in self.captured.events().try_iter() {
            match arrival {
                CaptureEvent::Reading { stats: counts, .. } => {
                    self.source = counts;
                    self.untaken += 1;
                }
                CaptureEvent::Noise(counts) => self.source = counts,
                _ => {}
            }
        }
        self.events.clear();
        self.pipeline.stop(&mut self.events);
        let sent = self.deliver();
        let closed = self.sink.0.close();
        self.show(None, None);
        sent?;
        Ok(closed?)
    }

    fn deliver(&mut self) -> Result<(), SessionError> {
        // Also without events: an output with a thread of its own tells at the next call that it failed.
        Ok(self.sink.0.send(&self.events)?)
    }

    fn tally(&self) -> Stats {
        let superseded = self.source.dropped + self.late + self.untaken;
        Stats {
            source: SourceStats {
                dropped: superseded,
                ..self.source
            },
            accepted: self.pipeline.accepted(),
            rejected: self.pipeline.rejected(),
            stalls: self.pipeline.stalls(),
            suppressed: self.pipeline.suppressed(),
        }
    }

    /// Shows what happened, and takes note when another layout is in force from now on.
    fn show(&mut self, reading: Option<Reading>, frame: Option<StepOutput>) {
        let (angles, pose, touches, commands) = match frame {
            Some(frame) => (
                Some(frame.estimate.angles),
                Some(frame.pose),
                frame.touches,
                frame.commands,
            ),
            None => (None, None, Touches::new(), TimedCommands::new()),
        };
        let snapshot = Snapshot {
            state: self.pipeline.state(),
            profile: self.profile,
            target_names: self.names.clone(),
            is_paused: self.pipeline.is_paused(),
            reading,
            angles,
            pose,
            touches,
            events: self.events.clone(),
            commands,
            stats: self.tally(),
        };
        (self.observe)(&snapshot);
        if self.profile != self.pipeline.active_profile() {
            self.rename();
        }
    }

    /// From now on what is told is of the layout in force.
    fn rename(&mut self) {
        self.profile = self.pipeline.active_profile();
        self.names = self.pipeline.target_names().clone();
        self.sink.0.set_target_names(&self.names);
    }
}

/// Up to a minute, to three digits: all buckets are there from the start.
fn new_histogram() -> Histogram<u64> {
    Histogram::new_with_bounds(1, 60_000_000_000, 3).expect("the bounds are valid")
}
