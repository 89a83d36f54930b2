//! Drives a pipeline, live or from a recording: one loop for both.

mod call;
mod inbox;

use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, TryRecvError, never};
use hdrhistogram::Histogram;

use crate::capture::{Arrival, CaptureError, Captured, Counts, Reading, Source, on_thread};
use crate::contact::{TargetNames, Touches};
use crate::device::Events;
use crate::monitor::{Snapshot, Tally};
use crate::output::{OutputError, Sink};
use crate::pipeline::{Controls, Frame, Pipeline};
use crate::time::FOR_EVER;

use self::inbox::{Inbox, Message};
pub use crate::pipeline::Refusal;
pub use call::{Answer, Call, Calls, Order, Places, RunState, calls};

/// No source is so slow that it would have to be waited for longer, whatever a recording says: three frames at
/// 1200 baud take 1.7 s.
const SLOWEST: Duration = Duration::from_secs(2);

/// While readings are expected, an output hears so often that the loop is alive: it may have to tell a guardian,
/// which waits for 200 ms.
const SIGN_OF_LIFE: Duration = Duration::from_millis(50);

/// Why a run ended before its source did.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
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
    pub tally: Tally,
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
    pub controls: Box<Controls>,
    /// The place of the layout whose controls they are.
    pub profile: usize,
    /// Whether their boards go where those in force are; else they go where their file says.
    pub keeps_places: bool,
    /// Takes the old ones, let go of, when the new ones are in force: whoever holds the other end frees
    /// them, so that the loop need not. Should have room for them; where it has none they are freed in
    /// the loop.
    pub replaced: Sender<Box<Controls>>,
}

/// Takes readings from `source` through `pipeline` to `sink`, until the source ends or `commands` say
/// so.
///
/// `observe` sees a copy of every frame; it must not wait. Whatever the end, also a panic, the sink
/// is closed, which lets go of everything. A live source whose readings stay away for longer than the
/// stall limit (at least three of its frame periods, but those count up to 2 s) stalls the pipeline.
pub fn drive(
    source: impl Source + 'static,
    pipeline: &mut Pipeline,
    sink: &mut dyn Sink,
    commands: impl Into<Commands>,
    observe: &mut dyn FnMut(&Snapshot),
) -> Result<Summary, RunError> {
    let captured = on_thread(source)?;
    let inbox = Inbox::open(commands.into()).map_err(|error| CaptureError::Open {
        source_name: captured.name().to_owned(),
        reason: format!("no thread for commands: {error}; close other programs"),
    })?;
    let period = captured.frame_period().unwrap_or(Duration::ZERO);
    let three_frames = period.saturating_mul(3).min(SLOWEST);
    pipeline.set_stall_limit(pipeline.stall_limit().max(three_frames));
    let mut run = Run {
        captured,
        profile: pipeline.profile(),
        names: pipeline.names().clone(),
        pipeline,
        sink: Closing(sink),
        observe,
        events: Events::new(),
        fed_at: None,
        source: Counts::default(),
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
        tally: run.tally(),
        latency_ns: run.latency_ns,
    })
}

/// Closes the sink also when the loop panics.
struct Closing<'a>(&'a mut dyn Sink);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        if std::thread::panicking()
            && let Err(error) = self.0.close()
        {
            tracing::error!("{error}");
        }
    }
}

struct Run<'a> {
    captured: Captured,
    pipeline: &'a mut Pipeline,
    /// The place of the layout that the sink was told of last, and what its targets are called.
    profile: usize,
    names: TargetNames,
    sink: Closing<'a>,
    observe: &'a mut dyn FnMut(&Snapshot),
    events: Events,
    fed_at: Option<Instant>,
    source: Counts,
    /// Readings that were too old when they were taken.
    late: u64,
    /// Readings that still waited when the run ended.
    untaken: u64,
    latency_ns: Histogram<u64>,
}

impl Run<'_> {
    fn until_over(&mut self, inbox: &Inbox) -> Result<(), RunError> {
        loop {
            // Of each one: those who never cease to ask do not keep readings waiting, nor the other way round.
            let message = inbox.take();
            let is_asked = message.is_some();
            if let Some(message) = message
                && self.obey(message)?
            {
                return Ok(());
            }
            match self.captured.arrivals().try_recv() {
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
    fn wait(&mut self) -> Result<(), RunError> {
        thread::park_timeout(self.patience().min(self.sign_of_life()));
        if self.captured.arrivals().is_empty() {
            self.sink.0.send(&[])?;
            self.stall_if_overdue()?;
        }
        Ok(())
    }

    /// Does what somebody asks for; whether that is to end.
    fn obey(&mut self, message: Message) -> Result<bool, RunError> {
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
        match self.pipeline.is_fed() {
            true => SIGN_OF_LIFE,
            false => FOR_EVER,
        }
    }

    /// How long a live source may stay silent from now on until it has stalled.
    fn patience(&self) -> Duration {
        match self.fed_at {
            Some(fed_at) if self.captured.is_live() && self.pipeline.is_fed() => {
                let deadline = fed_at + self.pipeline.stall_limit();
                deadline.saturating_duration_since(Instant::now())
            }
            _ => FOR_EVER,
        }
    }

    /// Takes what the capture thread says; whether that was the last of it.
    fn take(&mut self, arrival: Arrival) -> Result<bool, RunError> {
        match arrival {
            Arrival::Reading {
                reading,
                arrived,
                counts,
            } => {
                self.source = counts;
                self.step(reading, arrived)?;
            }
            Arrival::Noise(counts) => self.source = counts,
            Arrival::Lost(error) => {
                tracing::warn!("{error}");
                self.source.losses += 1;
                self.stall()?;
            }
            Arrival::Failed(error) => return Err(error.into()),
            Arrival::End(counts) => {
                self.source = counts;
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn step(&mut self, reading: Reading, arrived: Instant) -> Result<(), RunError> {
        if self.captured.is_live() && arrived.elapsed() > self.pipeline.stall_limit() {
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
        self.deliver()?;
        if !self.events.is_empty() {
            self.latency_ns
                .saturating_record(arrived.elapsed().as_nanos() as u64);
        }
        self.show(Some(reading), frame);
        Ok(())
    }

    /// Also after every command: those who never cease to ask do not put off a stall.
    fn stall_if_overdue(&mut self) -> Result<(), RunError> {
        // A reading that waits is no stall.
        if self.captured.arrivals().is_empty() && self.patience().is_zero() {
            self.stall()?;
        }
        Ok(())
    }

    fn stall(&mut self) -> Result<(), RunError> {
        self.events.clear();
        self.pipeline.stall(&mut self.events);
        self.fed_at = None;
        self.deliver()?;
        self.show(None, None);
        Ok(())
    }

    fn replace(&mut self, replacement: Replacement) -> Result<(), RunError> {
        let mut controls = replacement.controls;
        if replacement.keeps_places {
            let profile = replacement.profile;
            self.pipeline.keep_places(profile, &mut controls);
        }
        self.events.clear();
        self.pipeline
            .replace(replacement.profile, &mut controls, &mut self.events);
        self.deliver()?;
        self.show(None, None);
        self.rename();
        let _ = replacement.replaced.try_send(controls);
        Ok(())
    }

    fn answer(&mut self, call: Call) -> Result<(), RunError> {
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
                let next = (self.pipeline.profile() + 1) % self.pipeline.profiles();
                self.switch_to(next).map(|()| Ok(Answer::Done))?
            }
            Order::Places => Ok(Answer::Places(Places {
                profile: self.pipeline.profile() as u8,
                boards: self.pipeline.places().collect(),
            })),
            Order::Nudge(by) => self.shift(|pipeline, events| pipeline.nudge(by.into(), events))?,
            Order::Tilt(by) => self.shift(|pipeline, events| pipeline.tilt(by, events))?,
            Order::Recentre => {
                // It goes by the hand that is seen now.
                self.stall_if_overdue()?;
                self.shift(Pipeline::recentre)?
            }
        };
        // Nobody waits for whoever went away.
        let _ = call.answer.try_send(answer);
        Ok(())
    }

    fn pause(&mut self) -> Result<(), RunError> {
        self.events.clear();
        self.pipeline.pause(&mut self.events);
        self.deliver()?;
        self.show(None, None);
        Ok(())
    }

    fn switch_to(&mut self, profile: usize) -> Result<(), RunError> {
        self.events.clear();
        self.pipeline.switch_to(profile, &mut self.events);
        self.deliver()?;
        self.show(None, None);
        Ok(())
    }

    /// Moves boards, if that can be.
    fn shift(
        &mut self,
        shift: impl FnOnce(&mut Pipeline, &mut Events) -> Result<(), Refusal>,
    ) -> Result<Result<Answer, Refusal>, RunError> {
        self.events.clear();
        let shifted = shift(self.pipeline, &mut self.events);
        self.deliver()?;
        self.show(None, None);
        Ok(shifted.map(|()| Answer::Done))
    }

    fn state(&self) -> RunState {
        RunState {
            state: self.pipeline.state(),
            is_paused: self.pipeline.is_paused(),
            profile: self.pipeline.profile() as u8,
            tally: self.tally(),
            refused_presses: self.sink.0.refused_presses(),
        }
    }

    fn finish(&mut self) -> Result<(), RunError> {
        for arrival in self.captured.arrivals().try_iter() {
            match arrival {
                Arrival::Reading { counts, .. } => {
                    self.source = counts;
                    self.untaken += 1;
                }
                Arrival::Noise(counts) => self.source = counts,
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

    fn deliver(&mut self) -> Result<(), RunError> {
        // Also without events: an output with a thread of its own tells at the next call that it failed.
        Ok(self.sink.0.send(&self.events)?)
    }

    fn tally(&self) -> Tally {
        let superseded = self.source.superseded + self.late + self.untaken;
        Tally {
            source: Counts {
                superseded,
                ..self.source
            },
            accepted: self.pipeline.accepted(),
            rejected: self.pipeline.rejected(),
            stalls: self.pipeline.stalls(),
            withheld: self.pipeline.withheld(),
        }
    }

    /// Shows what happened, and takes note when another layout is in force from now on.
    fn show(&mut self, reading: Option<Reading>, frame: Option<Frame>) {
        let (angles, pose, touches) = match frame {
            Some(frame) => (Some(frame.angles), Some(frame.pose), frame.touches),
            None => (None, None, Touches::new()),
        };
        let snapshot = Snapshot {
            state: self.pipeline.state(),
            profile: self.profile,
            names: self.names.clone(),
            is_paused: self.pipeline.is_paused(),
            reading,
            angles,
            pose,
            touches,
            events: self.events.clone(),
            tally: self.tally(),
        };
        (self.observe)(&snapshot);
        if self.profile != self.pipeline.profile() {
            self.rename();
        }
    }

    /// From now on what is told is of the layout in force.
    fn rename(&mut self) {
        self.profile = self.pipeline.profile();
        self.names = self.pipeline.names().clone();
        self.sink.0.rename(&self.names);
    }
}

/// Up to a minute, to three digits: all buckets are there from the start.
fn new_histogram() -> Histogram<u64> {
    Histogram::new_with_bounds(1, 60_000_000_000, 3).expect("the bounds are valid")
}
