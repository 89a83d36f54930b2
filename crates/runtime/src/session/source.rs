//! The source of a session: opened, paced, or awaited.

use super::Session;
use super::notice::Notice;
use crate::capture::{BackOff, CaptureError, PacedSource, Source, SourceUri};
use crate::setup::SetupError;

impl Session {
    /// Opens the source. Returns `None` if the session was stopped before the device appeared.
    pub(super) fn open_source(&mut self) -> Result<Option<Box<dyn Source>>, SetupError> {
        if let Some(source) = self.options.source.take() {
            return Ok(Some(self.paced(source)));
        }
        let Some(uri) = self.opened_uri().cloned() else {
            return Ok(None);
        };
        let source = if self.options.wait_for_source {
            self.wait_for(&uri)?
        } else {
            Some(self.open_uri(&uri)?)
        };
        Ok(source.map(|source| self.paced(source)))
    }

    /// Opens a source of the setup. Outputs do not hold a key for longer than the setup permits.
    fn open_uri(&self, uri: &SourceUri) -> Result<Box<dyn Source>, SetupError> {
        match &self.options.output {
            Some(output) if !output.has_effect() => self.setup.open_source(uri),
            _ => self.setup.open_source_for_outputs(uri),
        }
    }

    /// A live source has a pace of its own.
    fn paced(&self, source: Box<dyn Source>) -> Box<dyn Source> {
        match self.options.speed {
            Some(speed) if !source.is_live() => Box::new(PacedSource::new(source, speed)),
            _ => source,
        }
    }

    /// Tries again with increasing intervals while a device cannot be opened. Reports each reason once.
    fn wait_for(&self, uri: &SourceUri) -> Result<Option<Box<dyn Source>>, SetupError> {
        let notices = self.notices.sender();
        let mut reported = String::new();
        let mut back_off = BackOff::default();
        loop {
            let reason = match self.open_uri(uri) {
                Err(SetupError::Capture(error @ CaptureError::Open { .. })) if uri.is_device() => {
                    error.to_string()
                }
                opened => {
                    if !reported.is_empty() && opened.is_ok() {
                        notices.send(Notice::SourceFound(uri.clone()));
                    }
                    return opened.map(Some);
                }
            };
            if reason != reported {
                notices.send(Notice::WaitingForSource(reason.clone()));
                reported = reason;
            }
            if self.commands.wait_for_stop(back_off.next_interval()) {
                return Ok(None);
            }
        }
    }
}
