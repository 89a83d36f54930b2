//! The loop of a session: readings through the pipeline to the output, live or from a recording.

mod layouts;

use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::TryRecvError;
use hdrhistogram::Histogram;

use super::close_on_panic::CloseOnPanic;
use super::command_channel::{CommandReceiver, Message, QueuedCommand};
use super::layout_link::LayoutOperation;
use super::reply::{Reply, RequestError, SessionStatus};
use super::{SessionError, Summary};
use crate::capture::{
    CaptureError, CaptureEvent, CaptureThread, Reading, Source, SourceStats, spawn,
};
use crate::command::{Command, CommandOrigin};
use crate::contact::TargetNames;
use crate::device::{Events, TimedCommand};
use crate::names::UnknownName;
use crate::output::Sink;
use crate::pipeline::{CommandError, Pipeline, PipelineState, StepOutput};
use crate::snapshot::{Snapshot, Stats};
use crate::time::{NO_DEADLINE, Timestamp};

/// Upper limit of the stall timeout that follows from a source's packet period. Three packets at 1200 baud take 1.7 s; a
/// recording may claim any period.
const MAX_STALL_TIMEOUT: Duration = Duration::from_secs(2);

/// Longest time without a call of the output while readings are expected. The watchdog releases all keys after 200 ms
/// without a heartbeat.
const HEARTBEAT_PERIOD: Duration = Duration::from_millis(50);

/// Runs as [`run_pipeline`](super::run_pipeline) does. `observe` sees the pipeline after every step, too.
pub(super) fn run_observed(
    source: impl Source + 'static,
    pipeline: &mut Pipeline,
    sink: &mut dyn Sink,
    commands: &CommandReceiver,
    observe: &mut dyn FnMut(&Snapshot, &Pipeline),
) -> Result<Summary, SessionError> {
    let capture = spawn(source)?;
    commands.attach();
    let packet_period = capture.packet_period().unwrap_or(Duration::ZERO);
    let three_packets = packet_period.saturating_mul(3).min(MAX_STALL_TIMEOUT);
    pipeline.set_stall_timeout(pipeline.stall_timeout().max(three_packets));
    let mut session = SessionLoop {
        capture,
        commands,
        profile: pipeline.active_profile(),
        target_names: pipeline.target_names().clone(),
        pipeline,
        sink: CloseOnPanic(sink),
        observe,
        events: Events::new(),
        executed: None,
        last_reading_at: None,
        source_stats: SourceStats::default(),
        expired: 0,
        unprocessed: 0,
        latency_ns: new_histogram(),
    };
    session.update_target_names();
    let ended = session.run();
    let closed = session.finish();
    ended?;
    closed?;
    Ok(Summary {
        stats: session.stats(),
        latency_ns: session.latency_ns,
        record_error: None,
    })
}

/// The continuation of the loop.
#[derive(PartialEq)]
enum Next {
    Continue,
    End,
}

struct SessionLoop<'a> {
    capture: CaptureThread,
    commands: &'a CommandReceiver,
    pipeline: &'a mut Pipeline,
    /// Index of the profile whose target names the sink and observers use.
    profile: usize,
    target_names: TargetNames,
    sink: CloseOnPanic<'a>,
    observe: &'a mut dyn FnMut(&Snapshot, &Pipeline),
    events: Events,
    /// The command from outside the layout that was executed in this step.
    executed: Option<TimedCommand>,
    /// Arrival of the last accepted reading; `None` after a stall.
    last_reading_at: Option<Instant>,
    source_stats: SourceStats,
    /// Readings that were older than the stall timeout when the loop received them.
    expired: u64,
    /// Readings that still waited when the loop ended.
    unprocessed: u64,
    latency_ns: Histogram<u64>,
}

impl SessionLoop<'_> {
    /// Handles one message and one capture event per turn, so that neither can delay the other.
    fn run(&mut self) -> Result<(), SessionError> {
        while !self.commands.is_stopped() {
            let message = self.commands.try_next();
            let had_message = message.is_some();
            if let Some(message) = message
                && self.handle_message(message)? == Next::End
            {
                return Ok(());
            }
            match self.capture.events().try_recv() {
                Ok(event) => {
                    if self.handle_capture(event)? == Next::End {
                        return Ok(());
                    }
                }
                // The capture thread ended after `End` or `Failed`, which ended this loop.
                Err(TryRecvError::Disconnected) => return Ok(()),
                Err(TryRecvError::Empty) if had_message => {}
                Err(TryRecvError::Empty) => self.wait()?,
            }
        }
        Ok(())
    }

    /// Parks until a message or a capture event wakes this thread, or a stall or heartbeat is due.
    fn wait(&mut self) -> Result<(), SessionError> {
        thread::park_timeout(self.time_to_stall().min(self.time_to_heartbeat()));
        if self.capture.events().is_empty() {
            self.sink.0.send(&[])?;
            self.stall_if_overdue()?;
        }
        Ok(())
    }

    fn time_to_heartbeat(&self) -> Duration {
        match self.pipeline.expects_readings() {
            true => HEARTBEAT_PERIOD,
            false => NO_DEADLINE,
        }
    }

    /// Time until a live source without readings counts as stalled.
    fn time_to_stall(&self) -> Duration {
        match self.last_reading_at {
            Some(last) if self.capture.is_live() && self.pipeline.expects_readings() => {
                let deadline = last + self.pipeline.stall_timeout();
                deadline.saturating_duration_since(Instant::now())
            }
            _ => NO_DEADLINE,
        }
    }

    fn handle_message(&mut self, message: Message) -> Result<Next, SessionError> {
        let next = match message {
            Message::Command(queued) => self.execute(queued)?,
            Message::LayoutSwap(swap) => {
                self.swap_layout(swap)?;
                Next::Continue
            }
        };
        // A client that sends commands without pause must not delay a stall.
        self.stall_if_overdue()?;
        Ok(next)
    }

    fn handle_capture(&mut self, event: CaptureEvent) -> Result<Next, SessionError> {
        match event {
            CaptureEvent::Reading {
                reading,
                received_at,
                stats,
            } => {
                self.source_stats = stats;
                return self.step(reading, received_at);
            }
            CaptureEvent::Command(command) => self.replay_command(command)?,
            CaptureEvent::Elapsed(time) => self.pass_gap(time)?,
            CaptureEvent::Noise(stats) => self.source_stats = stats,
            CaptureEvent::Lost(error) => {
                self.source_stats.losses += 1;
                self.lose(error)?;
            }
            CaptureEvent::Failed(error) => return Err(error.into()),
            CaptureEvent::End(stats) => {
                self.source_stats = stats;
                return Ok(Next::End);
            }
        }
        Ok(Next::Continue)
    }

    fn step(&mut self, reading: Reading, received_at: Instant) -> Result<Next, SessionError> {
        if self.capture.is_live() && received_at.elapsed() > self.pipeline.stall_timeout() {
            // This process was stopped or starved: the reading shows a hand of the past.
            self.expired += 1;
            self.stall(None)?;
            return Ok(Next::Continue);
        }
        self.events.clear();
        let step = self.pipeline.step(&reading, &mut self.events).ok().cloned();
        if step.is_some() {
            self.last_reading_at = Some(received_at);
        }
        self.send_events(step.as_ref())?;
        if !self.events.is_empty() {
            let latency = received_at.elapsed().as_nanos() as u64;
            self.latency_ns.saturating_record(latency);
        }
        self.publish(Some(reading), step.as_ref(), None);
        let commands = step.map(|step| step.commands).unwrap_or_default();
        for issued in commands {
            if self.execute_layout_command(issued.command)? == Next::End {
                return Ok(Next::End);
            }
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
                Some(operation) => match self.forward(operation, reply.clone()) {
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
        self.send_events(None)?;
        self.publish_command(command, result.is_ok());
        Ok(result
            .map(|()| self.reply(&command))
            .map_err(|error| self.explain(error)))
    }

    fn reply(&self, command: &Command) -> Reply {
        match self.pipeline.zeroed().filter(|_| *command == Command::Zero) {
            Some(zeroed) => Reply::Text(zeroed.to_string()),
            None => Reply::Done,
        }
    }

    /// Repeats a command of a recording.
    fn replay_command(&mut self, command: Command) -> Result<(), SessionError> {
        self.events.clear();
        // A command that cannot be executed has no effect: another layout or glove may replace the recorded one.
        let result = self.pipeline.replay(&command, &mut self.events);
        self.send_events(None)?;
        self.publish_command(command, result.is_ok());
        Ok(())
    }

    fn publish_command(&mut self, command: Command, is_executed: bool) {
        self.executed = is_executed.then_some(TimedCommand {
            time: self.pipeline.time(),
            command,
        });
        self.publish(None, None, None);
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
                let names: Vec<_> = self.pipeline.profile_names().collect();
                format!("{unknown}; available: {}", names.join(", "))
            }
        })
    }

    fn stall_if_overdue(&mut self) -> Result<(), SessionError> {
        // A reading that waits in the channel prevents the stall.
        if self.capture.events().is_empty() && self.time_to_stall().is_zero() {
            self.stall(None)?;
        }
        Ok(())
    }

    /// Handles the wait of a replay for its next reading: stalls if the recording has a gap, and keeps the output alive.
    fn pass_gap(&mut self, time: Timestamp) -> Result<(), SessionError> {
        self.events.clear();
        let is_stalled = self.pipeline.stall_if_overdue(time, &mut self.events);
        self.send_events(None)?;
        if is_stalled {
            self.last_reading_at = None;
            self.publish(None, None, None);
        }
        Ok(())
    }

    /// Releases what the lost source held.
    fn lose(&mut self, error: CaptureError) -> Result<(), SessionError> {
        let CaptureError::PartLost { side, part, .. } = error else {
            return self.stall(Some(error));
        };
        self.events.clear();
        self.pipeline.lose(side, part, &mut self.events);
        if !self.pipeline.expects_readings() {
            self.last_reading_at = None;
        }
        self.send_events(None)?;
        self.publish(None, None, Some(error));
        Ok(())
    }

    fn stall(&mut self, source_error: Option<CaptureError>) -> Result<(), SessionError> {
        self.events.clear();
        self.pipeline.stall(&mut self.events);
        self.last_reading_at = None;
        self.send_events(None)?;
        self.publish(None, None, source_error);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), SessionError> {
        for event in self.capture.events().try_iter() {
            match event {
                CaptureEvent::Reading { stats, .. } => {
                    self.source_stats = stats;
                    self.unprocessed += 1;
                }
                CaptureEvent::Noise(stats) => self.source_stats = stats,
                _ => {}
            }
        }
        if self.commands.is_stopped() {
            self.sink.0.void_presses();
        }
        self.events.clear();
        self.pipeline.stop(&mut self.events);
        let sent = self.send_events(None);
        let closed = self.sink.0.close();
        self.publish(None, None, None);
        sent?;
        Ok(closed?)
    }

    /// Hands the events of this step to the sink, even if there are none: a sink with its own thread reports an earlier
    /// failure at the next call.
    fn send_events(&mut self, step: Option<&StepOutput>) -> Result<(), SessionError> {
        if let Some(step) = step
            && !step.commands.is_empty()
        {
            self.sink.0.log_commands(&step.commands)?;
        }
        // A press that still waits in a queue must not follow the releases of a pause or stall.
        if matches!(
            self.pipeline.state(),
            PipelineState::Paused | PipelineState::Stalled
        ) {
            self.sink.0.void_presses();
        }
        Ok(self.sink.0.send(&self.events)?)
    }

    fn status(&self) -> SessionStatus {
        SessionStatus {
            state: self.pipeline.state(),
            paused_by: self.pipeline.paused_by(),
            profile: self.pipeline.active_profile(),
            stats: self.stats(),
            cursor: self.pipeline.layout().cursor(),
        }
    }

    fn stats(&self) -> Stats {
        Stats {
            source: SourceStats {
                dropped: self.source_stats.dropped + self.expired + self.unprocessed,
                ..self.source_stats
            },
            accepted: self.pipeline.accepted(),
            rejected: self.pipeline.rejected(),
            stalls: self.pipeline.stalls(),
            suppressed: self.pipeline.suppressed(),
            dropped_presses: self.sink.0.dropped_presses(),
        }
    }

    /// Shows this step to the observer. Its events belong to the profile that was active before them.
    fn publish(
        &mut self,
        reading: Option<Reading>,
        step: Option<&StepOutput>,
        source_error: Option<CaptureError>,
    ) {
        let snapshot = Snapshot {
            state: self.pipeline.state(),
            paused_by: self.pipeline.paused_by(),
            profile: self.profile,
            target_names: self.target_names.clone(),
            reading,
            source_error,
            angles: step.map(|step| step.estimate.angles),
            pose: step.map(|step| step.pose),
            touches: step.map(|step| step.touches.clone()).unwrap_or_default(),
            events: self.events.clone(),
            commands: step.map(|step| step.commands.clone()).unwrap_or_default(),
            executed: self.executed.take(),
            lost_hands: self.pipeline.lost_hands(),
            stats: self.stats(),
        };
        (self.observe)(&snapshot, self.pipeline);
        if self.profile != self.pipeline.active_profile() {
            self.update_target_names();
        }
    }

    fn update_target_names(&mut self) {
        self.profile = self.pipeline.active_profile();
        self.target_names = self.pipeline.target_names().clone();
        self.sink.0.set_target_names(&self.target_names);
    }
}

/// A histogram for 1 ns to 1 min with three significant digits, which never allocates later.
pub(super) fn new_histogram() -> Histogram<u64> {
    Histogram::new_with_bounds(1, 60_000_000_000, 3).expect("the bounds are valid")
}
