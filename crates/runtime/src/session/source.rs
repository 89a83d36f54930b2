//! The sources of a session: opened, paced, or awaited, and the notice about their roles.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use crossbeam_channel::{RecvTimeoutError, bounded};

use super::Session;
use super::notice::Notice;
use crate::capture::{BackOff, CaptureError, PacedSource, Source, SourceUri, StreamUri};
use crate::network::parse_loopback;
use crate::output;
use crate::setup::SetupError;
use ademan_core::pipeline::SourceRole;

/// Longest time after which a session that waits for a server notices that it was stopped.
const STOP_INTERVAL: Duration = Duration::from_millis(50);

impl Session {
    /// If a layout has keys, reports the sources that may not press them, as the default for sources on the network surprises users, and
    /// the sources that let another machine press them without a credential. A session that discards all events, as `record` and `share`
    /// do, lets no machine type.
    pub(super) fn report_source_roles(&self) {
        if !self.setup.required_capabilities().include_typing() {
            return;
        }
        let has_control_socket = self.options.control_socket.path().is_some();
        for source in self.setup.named_sources() {
            let Some(uri) = source.uri.filter(|uri| uri.is_remote()) else {
                continue;
            };
            if source.permissions.role == SourceRole::Pointer {
                self.report_status(Notice::PointerOnly {
                    source: uri.clone(),
                    remedy: source.way_to_type(has_control_socket),
                });
            } else if is_unprotected(uri) && !self.discards_events() {
                self.report_status(Notice::Unprotected(uri.clone()));
            }
        }
    }

    /// Returns `true` if no output types or logs an event.
    fn discards_events(&self) -> bool {
        match &self.options.output {
            Some(sink) => !sink.has_effect() && !sink.is_log(),
            None => output::discards_all(&self.setup.setup.output),
        }
    }

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
            self.open_unless_stopped(&uri)?
        };
        Ok(source.map(|source| self.paced(source)))
    }

    /// Opens a source of the setup, on a thread if it is on the network, where a server may not answer. For outputs with an effect,
    /// a recording may not raise the stall timeout of the setup. Returns `None` if the session was stopped during the wait.
    fn open_unless_stopped(&self, uri: &SourceUri) -> Result<Option<Box<dyn Source>>, SetupError> {
        let has_effect = (self.options.output.as_ref()).is_none_or(|output| output.has_effect());
        let (setup, opened_uri) = (Arc::clone(&self.setup), uri.clone());
        let open = move || {
            if has_effect {
                setup.open_source_for_outputs(&opened_uri)
            } else {
                setup.open_source(&opened_uri)
            }
        };
        let mut uris = self.setup.named_sources().filter_map(|named| named.uri);
        if !uris.any(SourceUri::is_remote) {
            return open().map(Some);
        }
        let (sender, opened) = bounded(1);
        let opening = open.clone();
        let thread = thread::Builder::new().name("open".into());
        let spawned = thread.spawn(move || _ = sender.send(opening()));
        if spawned.is_err() {
            return open().map(Some);
        }
        loop {
            match opened.recv_timeout(STOP_INTERVAL) {
                Ok(source) => return source.map(Some),
                Err(RecvTimeoutError::Timeout) if self.commands.is_stopped() => return Ok(None),
                Err(RecvTimeoutError::Timeout) => {}
                // The thread has panicked.
                Err(RecvTimeoutError::Disconnected) => return open().map(Some),
            }
        }
    }

    /// Plays a source that is not live at the speed of the options. A live source keeps its own pace.
    fn paced(&self, source: Box<dyn Source>) -> Box<dyn Source> {
        match self.options.speed {
            Some(speed) if !source.is_live() => Box::new(PacedSource::new(source, speed)),
            _ => source,
        }
    }

    /// Tries again with increasing intervals while a device cannot be opened. Reports each reason once.
    fn wait_for(&self, uri: &SourceUri) -> Result<Option<Box<dyn Source>>, SetupError> {
        let notices = self.notices.sender();
        let mut reported: Option<(SourceUri, String)> = None;
        let mut back_off = BackOff::default();
        loop {
            let opened = self.open_unless_stopped(uri);
            let failure = opened.as_ref().err();
            let Some(absent) = failure.and_then(|error| absent_device(error, uri)) else {
                if let (Some((device, _)), Ok(Some(_))) = (reported, &opened) {
                    notices.send(Notice::SourceFound(device));
                }
                return opened;
            };
            if reported.as_ref() != Some(&absent) {
                notices.send(Notice::WaitingForSource(absent.1.clone()));
                reported = Some(absent);
            }
            if self.commands.wait_for_stop(back_off.next_interval()) {
                return Ok(None);
            }
        }
    }
}

/// Returns `true` if readings come from another machine without a credential and without encryption.
fn is_unprotected(uri: &SourceUri) -> bool {
    let SourceUri::Stream(StreamUri {
        transport, address, ..
    }) = uri
    else {
        return false;
    };
    let is_own = parse_loopback(address).is_some() || address.starts_with("localhost:");
    transport.scheme.name == "tcp" && !is_own
}

/// Returns the device that could not be opened, and the error. `None` for an error that a wait does not end, as of a file. Any of several
/// sources may be the device, and each has the name of its URI; another name stands for all of them, and for `first`.
fn absent_device(failure: &SetupError, first: &SourceUri) -> Option<(SourceUri, String)> {
    let SetupError::Capture(error @ CaptureError::Open { source_name, .. }) = failure else {
        return None;
    };
    let named = source_name.parse::<SourceUri>();
    let named = named.unwrap_or_else(|_| first.clone());
    named.is_device().then(|| (named, error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_bytes_of_another_machine_are_unprotected() {
        let table = [
            ("tcp:192.168.1.7:4001", true),
            ("tcp:[fd00::2]:4001", true),
            ("tcp:desk:4001", true),
            ("tcp:127.0.0.1:4001", false),
            ("tcp:[::1]:4001", false),
            ("tcp:localhost:4001", false),
            ("tcp+tls:desk:8443?token_file=desk.token", false),
            ("udp:127.0.0.1:9000?protocol=text-line", false),
            ("ws:127.0.0.1:9001?protocol=hand-landmarks", false),
            ("serial:/dev/ttyUSB0", false),
            ("typist:a", false),
        ];
        for (text, expected) in table {
            let uri: SourceUri = text.parse().unwrap();
            assert_eq!(is_unprotected(&uri), expected, "{text}");
        }
    }

    #[test]
    fn only_a_device_is_awaited_whatever_the_first_source_is() {
        let absent = |name: &str, first: &str| {
            let failure = SetupError::Capture(CaptureError::Open {
                source_name: name.into(),
                reason: "it is absent".into(),
            });
            absent_device(&failure, &first.parse::<SourceUri>().unwrap()).map(|(device, _)| device)
        };
        let glove = "serial:/dev/no-such-glove";
        let device: SourceUri = glove.parse().unwrap();
        assert_eq!(absent(glove, "typist:a"), Some(device.clone()));
        assert_eq!(absent("both hands", glove), Some(device));
        for other in [
            "recording:hand.mcap",
            "udp:127.0.0.1:9000?protocol=text-line",
        ] {
            assert_eq!(absent(other, glove), None);
            assert_eq!(absent("both hands", other), None);
        }
    }
}
