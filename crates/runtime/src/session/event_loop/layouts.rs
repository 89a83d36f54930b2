//! Operations on layouts: requests to the layout manager, and the swap of a layout or an estimator between two readings.

use std::time::{Duration, Instant};

use crossbeam_channel::{Sender, bounded, select};

use super::wait::HEARTBEAT_PERIOD;
use super::{Next, SessionLoop};
use crate::session::SessionError;
use crate::session::estimator_swap::EstimatorSwap;
use crate::session::layout_link::{LayoutOperation, LayoutRequest, LayoutSwap};
use crate::session::reply::{ReplySender, RequestError};
use crate::text;
use ademan_core::command::Command;
use ademan_core::pipeline::CommandError;

/// Longest time that a replay waits for the layout manager to execute a command of the layout.
const LAYOUT_TIMEOUT: Duration = Duration::from_secs(10);

impl SessionLoop<'_> {
    /// Executes a command that the pipeline has not executed itself.
    pub(super) fn execute_layout_command(
        &mut self,
        command: Command,
    ) -> Result<Next, SessionError> {
        match LayoutOperation::from_command(&command) {
            _ if command == Command::Stop => Ok(Next::End),
            Some(operation) if self.capture.is_live() => {
                // The layout manager reports the outcome.
                let _ = self.forward(operation, None, None);
                Ok(Next::Continue)
            }
            Some(operation) => {
                self.run_layout_operation(operation)?;
                Ok(Next::Continue)
            }
            None => Ok(Next::Continue),
        }
    }

    /// Waits for the layout manager, which reports the outcome, so that a replay gives the same events at any speed. With an output
    /// that has an effect, a long wait is a stall, as the reading that would release a key waits too. `Stop` ends the wait.
    fn run_layout_operation(&mut self, operation: LayoutOperation) -> Result<(), SessionError> {
        let Some(link) = self.commands.layouts() else {
            return Ok(());
        };
        let (done, handled) = bounded(0);
        if self.forward(operation, None, Some(done)).is_err() {
            return Ok(());
        }
        let swaps = link.swaps().clone();
        let start = Instant::now();
        while !self.commands.is_stopped() && start.elapsed() < LAYOUT_TIMEOUT {
            select! {
                recv(swaps) -> swap => match swap {
                    Ok(swap) => self.swap_layout(swap)?,
                    Err(_) => return Ok(()),
                },
                recv(handled) -> _ => return Ok(()),
                default(HEARTBEAT_PERIOD) => {
                    self.now = Instant::now();
                    if self.time_to_stall().is_zero() {
                        self.stall(None)?;
                    }
                    self.keep_output_alive()?;
                }
            }
        }
        Ok(())
    }

    /// Passes an operation to the layout manager, which disconnects `done` once it is handled.
    pub(super) fn forward(
        &self,
        operation: LayoutOperation,
        reply: Option<ReplySender>,
        done: Option<Sender<()>>,
    ) -> Result<(), RequestError> {
        let link = self.commands.layouts().ok_or_else(|| {
            RequestError::Layout("this session cannot change its layouts".to_owned())
        })?;
        let operation = match operation {
            LayoutOperation::Save(_) => {
                LayoutOperation::Save(self.pipeline.board_poses().collect())
            }
            LayoutOperation::SaveLearned(_) => {
                let filter = self.pipeline.layout().filter();
                let known = filter.and_then(text::learned);
                let mut learned = known.ok_or(CommandError::NoTextDecoder)?;
                let others = self.pipeline.other_text_filters();
                others
                    .filter_map(text::learned)
                    .for_each(|other| learned.add_words(other));
                LayoutOperation::SaveLearned(Box::new(learned))
            }
            operation => operation,
        };
        link.forward(LayoutRequest {
            operation,
            profile: self.pipeline.active_profile(),
            replaced: link.replaced(),
            reply,
            done,
        })
    }

    /// Replaces the estimator of the first hand, and returns the old one to its thread.
    pub(super) fn swap_estimator(&mut self, swap: EstimatorSwap) -> Result<(), SessionError> {
        let EstimatorSwap {
            mut estimator,
            retired,
        } = swap;
        self.events.clear();
        self.pipeline
            .exchange_estimator(&mut estimator, &mut self.events);
        self.send_events()?;
        self.publish_state(None);
        let _ = retired.try_send(estimator);
        Ok(())
    }

    /// Replaces the layout of a profile, and returns the old one to its thread.
    pub(super) fn swap_layout(&mut self, swap: LayoutSwap) -> Result<(), SessionError> {
        let LayoutSwap {
            mut layout,
            profile,
            keep_board_poses,
            retired,
        } = swap;
        if keep_board_poses {
            self.pipeline.keep_board_poses(profile, &mut layout);
        }
        self.events.clear();
        self.pipeline
            .replace_profile(profile, &mut layout, &mut self.events);
        self.send_events()?;
        self.publish_state(None);
        self.update_target_names();
        if let Some(link) = self.commands.layouts().filter(|_| !keep_board_poses) {
            link.count_replaced();
        }
        let _ = retired.try_send(layout);
        Ok(())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::thread::{self, JoinHandle};
    use std::time::Instant;

    use super::*;
    use crate::capture::{CaptureError, Source, SourceEvent, SourceUri};
    use crate::output::{OutputError, Sink};
    use crate::session::command_channel::{CommandReceiver, command_channel};
    use crate::session::event_loop::capture::Capture;
    use crate::session::layout_link::LayoutLink;
    use crate::setup::Setup;
    use ademan_core::device::{Events, OutputEvent};
    use ademan_core::pipeline::Pipeline;
    use ademan_core::snapshot::StepView;

    /// A recording without readings.
    pub struct EmptyRecording;

    impl Source for EmptyRecording {
        fn next(&mut self) -> Result<SourceEvent, CaptureError> {
            Ok(SourceEvent::End)
        }

        fn name(&self) -> &str {
            "an empty recording"
        }

        fn is_live(&self) -> bool {
            false
        }
    }

    /// An output that counts its calls.
    #[derive(Default)]
    pub struct CountingSink(Arc<AtomicU64>);

    impl Sink for CountingSink {
        fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
            self.0.fetch_add(1, Ordering::Relaxed);
            Ok(())
        }

        fn close(&mut self) -> Result<(), OutputError> {
            Ok(())
        }
    }

    /// Returns a pipeline that has accepted a reading of a simulated hand and is armed.
    pub fn tracking_pipeline() -> Pipeline {
        let uri: SourceUri = "typist:a".parse().unwrap();
        let setup = Setup {
            source: Some(uri.clone()),
            arm_immediately: true,
            ..Setup::default()
        };
        let setup = setup.load_files().unwrap();
        let mut source = setup.open_source(&uri).unwrap();
        let mut pipeline = setup.pipeline();
        while !pipeline.expects_readings() {
            let SourceEvent::Reading(reading) = source.next().unwrap() else {
                panic!("no reading of the hand was accepted");
            };
            // The first readings may be rejected.
            let _ = pipeline.step(&reading, &mut Events::new());
        }
        pipeline
    }

    /// Starts a layout manager that handles a request after the output was called three times. It returns the number of calls.
    fn start_slow_manager(manager: LayoutLink, calls: Arc<AtomicU64>) -> JoinHandle<u64> {
        thread::spawn(move || {
            let request = manager
                .requests()
                .recv_timeout(10 * LAYOUT_TIMEOUT)
                .unwrap();
            let start = Instant::now();
            while calls.load(Ordering::Relaxed) < 3 && start.elapsed() < LAYOUT_TIMEOUT / 2 {
                thread::yield_now();
            }
            drop(request);
            calls.load(Ordering::Relaxed)
        })
    }

    #[test]
    fn a_replay_that_waits_for_the_layout_manager_keeps_calling_its_output() {
        let mut commands = CommandReceiver::disconnected();
        let calls = Arc::new(AtomicU64::new(0));
        let manager = start_slow_manager(commands.link_layouts(), Arc::clone(&calls));
        let mut pipeline = Setup::default().load_files().unwrap().pipeline();
        let mut sink = CountingSink(calls);
        let observer = &mut |_: &StepView, _: Instant, _: &Pipeline| {};
        let capture = Capture::start(EmptyRecording).unwrap();
        let mut session = SessionLoop::new(capture, &commands, &mut pipeline, &mut sink, observer);
        session
            .run_layout_operation(LayoutOperation::Reload)
            .unwrap();
        assert!(manager.join().unwrap() >= 3);
    }

    #[test]
    fn a_replay_that_waits_long_for_the_layout_manager_releases_everything() {
        let mut commands = CommandReceiver::disconnected();
        let calls = Arc::new(AtomicU64::new(0));
        let manager = start_slow_manager(commands.link_layouts(), Arc::clone(&calls));
        let mut pipeline = tracking_pipeline();
        let mut sink = CountingSink(calls);
        let observer = &mut |_: &StepView, _: Instant, _: &Pipeline| {};
        let capture = Capture::start(EmptyRecording).unwrap();
        let mut session = SessionLoop::new(capture, &commands, &mut pipeline, &mut sink, observer);
        session.last_reading_at = session.now.checked_sub(Duration::from_secs(1));
        session
            .run_layout_operation(LayoutOperation::Reload)
            .unwrap();
        assert!(manager.join().unwrap() >= 3);
        assert_eq!(session.pipeline.stalls(), 1);
        assert!(!session.pipeline.expects_readings());
    }

    #[test]
    fn a_replay_that_is_stopped_does_not_wait_for_the_layout_manager() {
        let (sender, mut commands) = command_channel();
        let manager = commands.link_layouts();
        sender.send(Command::Stop).unwrap();
        let mut pipeline = Setup::default().load_files().unwrap().pipeline();
        let calls = Arc::new(AtomicU64::new(0));
        let mut sink = CountingSink(Arc::clone(&calls));
        let observer = &mut |_: &StepView, _: Instant, _: &Pipeline| {};
        let capture = Capture::start(EmptyRecording).unwrap();
        let mut session = SessionLoop::new(capture, &commands, &mut pipeline, &mut sink, observer);
        session
            .run_layout_operation(LayoutOperation::Reload)
            .unwrap();
        assert_eq!(manager.requests().len(), 1, "nothing handles the request");
        assert_eq!(
            calls.load(Ordering::Relaxed),
            0,
            "a loop that waits calls its output"
        );
    }
}
