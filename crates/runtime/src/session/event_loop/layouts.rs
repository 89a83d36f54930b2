//! Operations on layouts: requests to the layout manager, and the swap of a layout or an estimator between two readings.

use std::time::Duration;

use crossbeam_channel::{bounded, select};

use super::{Next, SessionLoop};
use crate::session::SessionError;
use crate::session::estimator_swap::EstimatorSwap;
use crate::session::layout_link::{LayoutOperation, LayoutRequest, LayoutSwap};
use crate::session::reply::{ReplySender, RequestError};
use ademan_core::command::Command;

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
                let _ = self.forward(operation, None);
                Ok(Next::Continue)
            }
            Some(operation) => {
                self.run_layout_operation(operation)?;
                Ok(Next::Continue)
            }
            None => Ok(Next::Continue),
        }
    }

    /// Waits for the layout manager, so that a replay gives the same events at any speed.
    fn run_layout_operation(&mut self, operation: LayoutOperation) -> Result<(), SessionError> {
        let Some(link) = self.commands.layouts() else {
            return Ok(());
        };
        let (reply, replies) = bounded(1);
        if self.forward(operation, Some(reply)).is_err() {
            return Ok(());
        }
        let swaps = link.swaps().clone();
        loop {
            let swap = select! {
                recv(swaps) -> swap => swap,
                recv(replies) -> _ => return Ok(()),
                default(LAYOUT_TIMEOUT) => return Ok(()),
            };
            let Ok(swap) = swap else {
                return Ok(());
            };
            self.swap_layout(swap)?;
        }
    }

    /// Hands an operation to the layout manager.
    pub(super) fn forward(
        &self,
        operation: LayoutOperation,
        reply: Option<ReplySender>,
    ) -> Result<(), RequestError> {
        let link = self.commands.layouts().ok_or_else(|| {
            RequestError::Layout("this session cannot change its layouts".to_owned())
        })?;
        let operation = match operation {
            LayoutOperation::Save(_) => {
                LayoutOperation::Save(self.pipeline.board_poses().collect())
            }
            operation => operation,
        };
        link.forward(LayoutRequest {
            operation,
            profile: self.pipeline.active_profile(),
            reply,
        })
    }

    pub(super) fn swap_estimator(&mut self, swap: EstimatorSwap) -> Result<(), SessionError> {
        let EstimatorSwap {
            mut estimator,
            retired,
        } = swap;
        self.events.clear();
        self.pipeline
            .exchange_estimator(&mut estimator, &mut self.events);
        self.send_events()?;
        self.publish(None, false, None);
        let _ = retired.try_send(estimator);
        Ok(())
    }

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
        self.publish(None, false, None);
        self.update_target_names();
        let _ = retired.try_send(layout);
        Ok(())
    }
}
