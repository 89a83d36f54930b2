//! The loop of a session: readings through the pipeline to the output, live or from a recording.

mod capture;
mod consent;
mod layouts;
mod output;
mod publish;
mod text_field;
mod wait;

use std::time::{Duration, Instant};

use crossbeam_channel::TryRecvError;
use hdrhistogram::Histogram;

use self::capture::Capture;
use self::text_field::FollowedField;
use super::close_on_panic::CloseOnPanic;
use super::command_channel::{CommandReceiver, Message, QueuedCommand};
use super::layout_link::LayoutOperation;
use super::observer::Observer;
use super::reply::{Reply, RequestError};
use super::{SessionError, Summary};
use crate::capture::{CaptureError, CaptureEvent, Reading, Source, SourceStats};
use crate::output::Sink;
use ademan_core::command::{Command, CommandOrigin};
use ademan_core::contact::TargetNames;
use ademan_core::device::{Events, TimedCommand};
use ademan_core::message::escape;
use ademan_core::names::UnknownName;
use ademan_core::pipeline::{CommandError, Pipeline};
use ademan_core::snapshot::{Stats, StepView};
use ademan_core::time::Timestamp;

/// Upper limit of the stall timeout that follows from a source's packet period. Three packets at 1200 baud take 1.7 s; a
/// recording may claim any period.
const MAX_STALL_TIMEOUT: Duration = Duration::from_secs(2);

/// Runs a session as [`run_pipeline`](super::run_pipeline) does, and passes the pipeline to `observer` after every step.
pub(super) fn run_observed(
    source: impl Source + 'static,
    pipeline: &mut Pipeline,
    sink: &mut dyn Sink,
    commands: &CommandReceiver,
    observer: &mut dyn Observer,
) -> Result<Summary, SessionError> {
    let capture = Capture::start(source)?;
    commands.attach(capture.wake_target());
    let packet_period = capture.packet_period().unwrap_or(Duration::ZERO);
    let three_packets = packet_period.saturating_mul(3).min(MAX_STALL_TIMEOUT);
    pipeline.set_stall_timeout(pipeline.stall_timeout().max(three_packets));
    let mut session = SessionLoop::new(capture, commands, pipeline, sink, observer);
    let ended = session.run();
    let closed = session.finish();
    ended?;
    closed?;
    Ok(Summary {
        stats: session.stats,
        latency_ns: session.latency_ns,
        record_error: None,
    })
}

/// Calls `body` with a function that passes a reading through the loop as if it came from `source`: for benchmarks of the
/// loop without the thread of a source.
#[doc(hidden)]
pub fn with_loop_step(
    source: impl Source + 'static,
    pipeline: &mut Pipeline,
    sink: &mut dyn Sink,
    mut observe: &mut dyn FnMut(&StepView, Instant, &Pipeline),
    body: impl FnOnce(&mut dyn FnMut(&Reading)),
) -> Result<(), SessionError> {
    let commands = CommandReceiver::disconnected();
    let capture = Capture::start(source)?;
    let mut session = SessionLoop::new(capture, &commands, pipeline, sink, &mut observe);
    body(&mut |reading| {
        session.now = Instant::now();
        // A reading that fails is measured, too.
        let _ = session.step(reading, session.now);
    });
    session.finish()
}

/// The action of the loop after a message or an event.
#[derive(PartialEq)]
enum Next {
    Continue,
    End,
}

struct SessionLoop<'a> {
    // Declared before `capture`: a panic releases the keys before it closes the source, which may take a second.
    sink: CloseOnPanic<'a>,
    capture: Capture,
    commands: &'a CommandReceiver,
    pipeline: &'a mut Pipeline,
    /// Index of the profile whose target names the sink and observers use.
    profile: usize,
    target_names: TargetNames,
    text_field: FollowedField,
    observer: &'a mut dyn Observer,
    events: Events,
    /// The command from outside the layout that was executed in this step.
    executed: Option<TimedCommand>,
    /// Time of the latest message or capture event. A clock costs as much as a stage of the pipeline, so it is read once for
    /// each of them.
    now: Instant,
    /// Arrival of the last accepted reading; `None` after a stall. For a source that is not live, the time of its latest event.
    last_reading_at: Option<Instant>,
    /// Statistics up to the present step, which observers see.
    stats: Stats,
    /// Readings that this loop dropped: they were older than the stall timeout, or still waited when it ended.
    dropped: u64,
    latency_ns: Histogram<u64>,
    /// Latency of this step, if it has events.
    latency: Option<Duration>,
}

impl<'a> SessionLoop<'a> {
    fn new(
        capture: Capture,
        commands: &'a CommandReceiver,
        pipeline: &'a mut Pipeline,
        sink: &'a mut dyn Sink,
        observer: &'a mut dyn Observer,
    ) -> Self {
        let mut session = Self {
            capture,
            commands,
            profile: pipeline.active_profile(),
            target_names: pipeline.target_names().clone(),
            text_field: FollowedField::new(pipeline.profile_count()),
            pipeline,
            sink: CloseOnPanic(sink),
            observer,
            events: Events::new(),
            executed: None,
            now: Instant::now(),
            last_reading_at: None,
            stats: Stats::default(),
            dropped: 0,
            latency_ns: new_histogram(),
            latency: None,
        };
        session.update_target_names();
        session
    }
}

impl SessionLoop<'_> {
    /// Handles one message and one capture event per turn, so that neither can delay the other.
    fn run(&mut self) -> Result<(), SessionError> {
        while !self.commands.is_stopped() {
            self.follow_text_field()?;
            let message = self.commands.try_next();
            let had_message = message.is_some();
            if let Some(message) = message
                && self.handle_message(message)? == Next::End
            {
                return Ok(());
            }
            match self.capture.try_next() {
                Ok(event) => {
                    if self.handle_capture(event)? == Next::End {
                        return Ok(());
                    }
                }
                // The capture thread ended after `End` or `Failed`, which ended this loop.
                Err(TryRecvError::Disconnected) => return Ok(()),
                Err(TryRecvError::Empty) if had_message => self.capture.receive(),
                Err(TryRecvError::Empty) => self.wait()?,
            }
        }
        Ok(())
    }

    fn handle_message(&mut self, message: Message) -> Result<Next, SessionError> {
        self.now = Instant::now();
        let next = match message {
            Message::Command(queued) => self.execute(queued)?,
            Message::LayoutSwap(swap) => {
                self.swap_layout(swap)?;
                Next::Continue
            }
            Message::EstimatorSwap(swap) => {
                self.swap_estimator(swap)?;
                Next::Continue
            }
        };
        // A client that sends commands without pause must not delay a stall.
        self.stall_if_overdue()?;
        Ok(next)
    }

    fn handle_capture(&mut self, event: CaptureEvent) -> Result<Next, SessionError> {
        self.now = Instant::now();
        match event {
            CaptureEvent::Reading {
                reading,
                received_at,
                stats,
            } => {
                self.follow_source(&stats)?;
                return self.step(&reading, received_at);
            }
            CaptureEvent::Readings {
                readings,
                received_at,
                stats,
            } => return self.step_through(&readings, received_at, &stats),
            CaptureEvent::Command(command) => self.replay_command(command)?,
            CaptureEvent::Elapsed(time) => self.pass_gap(time)?,
            CaptureEvent::Noise(stats) => self.follow_source(&stats)?,
            CaptureEvent::Lost(error) => {
                self.stats.source.losses += 1;
                self.lose(error)?;
            }
            CaptureEvent::Failed(error) => return Err(error.into()),
            CaptureEvent::End(stats) => {
                self.set_source_stats(&stats);
                return Ok(Next::End);
            }
        }
        Ok(Next::Continue)
    }

    /// Steps through readings that came together. `stats` are the statistics after the last one.
    fn step_through(
        &mut self,
        readings: &[Reading],
        received_at: Instant,
        stats: &SourceStats,
    ) -> Result<Next, SessionError> {
        self.follow_source(stats)?;
        for (reading, left) in readings.iter().zip((0..readings.len() as u64).rev()) {
            self.stats.source.readings = stats.readings - left;
            // Readings that have waited may be meant for the previous text field.
            self.follow_text_field()?;
            if self.commands.is_stopped() || self.step(reading, received_at)? == Next::End {
                self.stats.source.readings = stats.readings;
                self.drop_readings(left);
                return Ok(Next::End);
            }
        }
        Ok(Next::Continue)
    }

    fn step(&mut self, reading: &Reading, received_at: Instant) -> Result<Next, SessionError> {
        if self.capture.is_live() && self.now > received_at + self.pipeline.stall_timeout() {
            // This process was stopped or starved: the reading shows a hand of the past.
            self.drop_readings(1);
            self.stall(None)?;
            return Ok(Next::Continue);
        }
        self.events.clear();
        let output = self.pipeline.step(reading, &mut self.events);
        let is_accepted = output.is_ok();
        let has_commands = output.is_ok_and(|output| !output.commands.is_empty());
        if is_accepted {
            // The readings of a source that is not live may have waited for this loop.
            let is_live = self.capture.is_live();
            self.last_reading_at = Some(if is_live { received_at } else { self.now });
        }
        if has_commands {
            let commands = &self.pipeline.output_for(reading).commands;
            self.sink.0.log_commands(commands)?;
        }
        self.send_events()?;
        if !self.events.is_empty() {
            let latency = received_at.elapsed();
            self.latency = Some(latency);
            self.latency_ns.saturating_record(latency.as_nanos() as u64);
        }
        self.publish_reading(reading, is_accepted);
        if has_commands {
            self.execute_layout_commands(reading)
        } else {
            Ok(Next::Continue)
        }
    }

    /// Executes the commands that the devices issued in the step of a reading.
    fn execute_layout_commands(&mut self, reading: &Reading) -> Result<Next, SessionError> {
        let mut index = 0;
        while let Some(issued) = self.pipeline.output_for(reading).commands.get(index) {
            if self.execute_layout_command(issued.command)? == Next::End {
                return Ok(Next::End);
            }
            index += 1;
        }
        Ok(Next::Continue)
    }

    /// Executes a command from outside the pipeline and sends the reply, if one is expected.
    fn execute(&mut self, queued: QueuedCommand) -> Result<Next, SessionError> {
        let QueuedCommand {
            command,
            origin,
            reply,
        } = queued;
        let result = match command {
            Command::Stop => return Ok(Next::End),
            Command::State => Ok(Reply::State(self.status())),
            _ => match LayoutOperation::from_command(&command) {
                Some(operation) => match self.forward(operation, reply.clone(), None) {
                    Ok(()) => return Ok(Next::Continue),
                    Err(error) => Err(error),
                },
                None => self.execute_in_pipeline(command, origin)?,
            },
        };
        if let Some(reply) = reply {
            // The client may have gone away.
            let _ = reply.try_send(result);
        }
        Ok(Next::Continue)
    }

    fn execute_in_pipeline(
        &mut self,
        command: Command,
        origin: CommandOrigin,
    ) -> Result<Result<Reply, RequestError>, SessionError> {
        if matches!(command, Command::Recenter | Command::Zero) {
            // A hand that is overdue is neither recentered on nor zeroed.
            self.stall_if_overdue()?;
        }
        self.events.clear();
        let result = self.pipeline.execute(&command, origin, &mut self.events);
        self.send_events()?;
        self.publish_command(command, result.is_ok());
        Ok(result
            .map(|()| self.reply(&command))
            .map_err(|error| self.explain(error)))
    }

    fn reply(&self, command: &Command) -> Reply {
        if *command == Command::Zero {
            Reply::zeroed(self.pipeline.zeroed())
        } else {
            Reply::Done
        }
    }

    /// Repeats a command of a recording. One that lets sources press keys is repeated only if no output has an effect.
    fn replay_command(&mut self, command: Command) -> Result<(), SessionError> {
        self.events.clear();
        let (origin, events) = (CommandOrigin::Client, &mut self.events);
        // A command that cannot be executed has no effect: another layout or glove may replace the recorded one.
        let result = if command.is_permission() && !self.sink.0.has_effect() {
            self.pipeline.execute(&command, origin, events)
        } else {
            self.pipeline.replay(&command, events)
        };
        self.send_events()?;
        self.publish_command(command, result.is_ok());
        Ok(())
    }

    /// Adds the nearest name of a profile to the error, or all names if none is similar.
    fn explain(&self, error: CommandError) -> RequestError {
        let CommandError::UnknownProfile(name) = error else {
            return error.into();
        };
        let unknown = UnknownName::new("profile", &name, self.pipeline.profile_names());
        RequestError::UnknownProfile(match unknown.nearest {
            Some(_) => unknown.to_string(),
            None => {
                let names: Vec<_> = self.pipeline.profile_names().map(escape).collect();
                format!("{unknown}; available: {}", names.join(", "))
            }
        })
    }

    fn stall_if_overdue(&mut self) -> Result<(), SessionError> {
        if !self.time_to_stall().is_zero() {
            return Ok(());
        }
        // A reading that waits prevents the stall.
        self.capture.receive();
        if !self.capture.has_events() {
            self.stall(None)?;
        }
        Ok(())
    }

    /// Handles the wait of a replay for its next reading: stalls if the recording has a gap, and keeps the output alive.
    fn pass_gap(&mut self, time: Timestamp) -> Result<(), SessionError> {
        self.events.clear();
        let is_stalled = self.pipeline.stall_if_overdue(time, &mut self.events);
        self.send_events()?;
        self.last_reading_at = self.last_reading_at.map(|_| self.now);
        if is_stalled {
            self.last_reading_at = None;
            self.publish_state(None);
        }
        Ok(())
    }

    /// Releases what the lost source held.
    fn lose(&mut self, error: CaptureError) -> Result<(), SessionError> {
        let CaptureError::PartLost { side, part, .. } = error else {
            return self.stall(Some(&error));
        };
        self.events.clear();
        self.pipeline.lose(side, part, &mut self.events);
        if !self.pipeline.expects_readings() {
            self.last_reading_at = None;
        }
        self.send_events()?;
        self.publish_state(Some(&error));
        Ok(())
    }

    fn stall(&mut self, source_error: Option<&CaptureError>) -> Result<(), SessionError> {
        self.events.clear();
        self.pipeline.stall(&mut self.events);
        self.last_reading_at = None;
        self.send_events()?;
        self.publish_state(source_error);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), SessionError> {
        self.count_unread();
        if self.commands.is_stopped() {
            self.sink.0.void_presses();
        }
        self.events.clear();
        self.pipeline.stop(&mut self.events);
        let sent = self.send_events();
        let closed = self.sink.0.close();
        // After the releases, as it may wait.
        self.capture.stop();
        self.count_unread();
        self.publish_state(None);
        sent?;
        Ok(closed?)
    }

    /// Counts the readings that wait as dropped, and adopts the latest statistics of the source.
    fn count_unread(&mut self) {
        let mut dropped = 0;
        while let Ok(event) = self.capture.try_next() {
            let (stats, readings) = match event {
                CaptureEvent::Reading { stats, .. } => (stats, 1),
                CaptureEvent::Readings {
                    readings, stats, ..
                } => (stats, readings.len() as u64),
                CaptureEvent::Noise(stats) => (stats, 0),
                _ => continue,
            };
            dropped += readings;
            self.set_source_stats(&stats);
        }
        self.drop_readings(dropped);
    }
}

/// Returns a histogram for 1 ns to 1 min with three significant digits. It does not allocate after its creation.
pub(super) fn new_histogram() -> Histogram<u64> {
    Histogram::new_with_bounds(1, 60_000_000_000, 3).expect("the bounds are valid")
}
