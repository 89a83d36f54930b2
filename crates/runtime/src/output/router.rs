//! One stream of events to several outputs.

use super::{DesktopPart, LogFailureReceiver, OutputError, Sink, TextField};
use ademan_core::contact::TargetNames;
use ademan_core::device::signals::Signals;
use ademan_core::device::{Capabilities, Capability, EventKind, Events, OutputEvent, TimedCommand};
use ademan_core::pipeline::TextState;

/// The properties of an output that decide which events it receives.
#[derive(Clone, Debug)]
pub(super) struct Route {
    /// The capabilities of the output.
    pub capabilities: Capabilities,
    /// See [`Backend::is_log`](super::Backend::is_log).
    pub is_log: bool,
}

/// Returns the index of the output that carries `capability`: the first that supports it. A log carries it only if
/// all outputs are logs.
pub(super) fn route(routes: &[Route], capability: Capability) -> Option<usize> {
    let only_logs = routes.iter().all(|route| route.is_log);
    routes
        .iter()
        .position(|route| (only_logs || !route.is_log) && route.capabilities.contains(capability))
}

/// A sink that sends each event to the first of its outputs that supports it.
///
/// The output depends on the kind of the event only, so a release goes to the output that received the press. Events
/// that require no capability, such as depths and values, go to all outputs, and logs receive every event. A failed
/// output does not keep events from the others; the first error is returned.
///
/// A log next to an output with an effect may fail, as on a full disk, without ending the others: its error is
/// [reported](Sink::on_log_failure) at once, and returned by [`close`](Sink::close). A closed pipe is returned at once, because its
/// reader has asked for the end.
pub struct Router {
    sinks: Vec<Box<dyn Sink>>,
    routes: Vec<Route>,
    buffer: Events,
    has_effect: bool,
    /// For each output, `true` if it is a log that has failed.
    failed_logs: Vec<bool>,
    on_log_failure: Option<LogFailureReceiver>,
    /// The part of the desktop for absolute positions, except in logs.
    part: DesktopPart,
}

impl Router {
    /// Creates a router; earlier sinks take precedence. Logs next to a sink with an effect
    /// [drop lines](Sink::drop_when_full) rather than delay its releases.
    pub fn new(mut sinks: Vec<Box<dyn Sink>>) -> Self {
        let has_effect = sinks.iter().any(|sink| sink.has_effect());
        if has_effect {
            sinks.iter_mut().for_each(|sink| sink.drop_when_full());
        }
        let route = |sink: &dyn Sink| Route {
            capabilities: sink.capabilities(),
            is_log: sink.is_log(),
        };
        Self {
            routes: sinks.iter().map(|sink| route(&**sink)).collect(),
            failed_logs: vec![false; sinks.len()],
            sinks,
            buffer: Events::new(),
            has_effect,
            on_log_failure: None,
            part: DesktopPart::default(),
        }
    }

    /// Sets the part of the desktop for absolute positions. Logs write the positions of the layout.
    pub(super) fn in_part(self, part: DesktopPart) -> Self {
        Self { part, ..self }
    }

    /// Sends the buffer to the output at `index`. The error of a log that may fail is reported.
    fn send_buffer(&mut self, index: usize) -> Result<(), OutputError> {
        let sent = self.sinks[index].send(&self.buffer);
        let may_fail = self.has_effect && self.routes[index].is_log;
        match sent {
            Err(error) if may_fail && !matches!(error, OutputError::BrokenPipe { .. }) => {
                self.failed_logs[index] = true;
                if let Some(report) = &self.on_log_failure {
                    report(&error);
                }
                Ok(())
            }
            sent => sent,
        }
    }
}

impl Sink for Router {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut result = Ok(());
        for index in 0..self.sinks.len() {
            if self.failed_logs[index] {
                continue;
            }
            self.buffer.clear();
            for event in events {
                if !receives(&self.routes, index, event.kind) {
                    continue;
                }
                if self.buffer.is_full() {
                    result = result.and(self.send_buffer(index));
                    self.buffer.clear();
                }
                let kind = if self.routes[index].is_log {
                    event.kind
                } else {
                    self.part.place(event.kind)
                };
                self.buffer.push(OutputEvent { kind, ..*event });
            }
            result = result.and(self.send_buffer(index));
        }
        result
    }

    fn log_commands(&mut self, commands: &[TimedCommand]) -> Result<(), OutputError> {
        let mut result = Ok(());
        for sink in &mut self.sinks {
            result = result.and(sink.log_commands(commands));
        }
        result
    }

    fn has_effect(&self) -> bool {
        self.has_effect
    }

    fn on_log_failure(&mut self, receiver: LogFailureReceiver) {
        self.on_log_failure = Some(receiver);
    }

    fn drop_when_full(&mut self) {
        for sink in &mut self.sinks {
            sink.drop_when_full();
        }
    }

    fn set_target_names(&mut self, names: &TargetNames) {
        for sink in &mut self.sinks {
            sink.set_target_names(names);
        }
    }

    fn set_signals(&mut self, signals: &Signals) {
        for sink in &mut self.sinks {
            sink.set_signals(signals);
        }
    }

    fn void_presses(&mut self) {
        for sink in &mut self.sinks {
            sink.void_presses();
        }
    }

    fn has_stalled(&self) -> bool {
        self.sinks.iter().any(|sink| sink.has_stalled())
    }

    /// Closes every output, one after the other.
    fn close(&mut self) -> Result<(), OutputError> {
        let mut result = Ok(());
        for sink in &mut self.sinks {
            result = result.and(sink.close());
        }
        result
    }

    fn dropped_presses(&self) -> u64 {
        self.sinks.iter().map(|sink| sink.dropped_presses()).sum()
    }

    fn coalesced_motions(&self) -> u64 {
        self.sinks.iter().map(|sink| sink.coalesced_motions()).sum()
    }

    fn text_field(&self) -> TextField {
        let fields = self.sinks.iter().map(|sink| sink.text_field());
        let is_known = |field: &TextField| *field != TextField::default();
        fields.into_iter().find(is_known).unwrap_or_default()
    }

    fn show_text(&mut self, state: Option<&TextState>) {
        for sink in &mut self.sinks {
            sink.show_text(state);
        }
    }

    fn take_choice(&mut self) -> Option<u8> {
        self.sinks.iter_mut().find_map(|sink| sink.take_choice())
    }
}

fn receives(routes: &[Route], index: usize, event: EventKind) -> bool {
    let Some(capability) = Capability::required_by(event) else {
        return true;
    };
    routes[index].is_log || route(routes, capability) == Some(index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::find_backend;
    use crate::output::tests::{down, event, key, up};
    use ademan_core::contact::TargetId;
    use ademan_core::device::Axis;
    use std::sync::{Arc, Mutex};

    type Log = Arc<Mutex<Vec<String>>>;

    /// A sink that writes its events to a log, with the capabilities of a backend.
    struct TestSink {
        name: &'static str,
        fails: bool,
        log: Log,
    }

    impl TestSink {
        fn write(&self, text: &str) -> Result<(), OutputError> {
            let line = format!("{} {text}", self.name);
            self.log.lock().unwrap().push(line);
            if self.fails {
                Err(OutputError::send(self.name, "gone"))
            } else {
                Ok(())
            }
        }
    }

    impl Sink for TestSink {
        fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
            let text = |event: &OutputEvent| match event.kind {
                EventKind::KeyDown(key) => format!("+{key}"),
                EventKind::KeyUp(key) => format!("-{key}"),
                EventKind::Character(character) => character.into(),
                EventKind::Scroll(..) => "scroll".into(),
                EventKind::Axis(axis, _) => axis.name().into(),
                EventKind::MoveTo(x, y) => format!("to {x} {y}"),
                EventKind::Value(..) => "value".into(),
                _ => "other".into(),
            };
            let events: Vec<_> = events.iter().map(text).collect();
            self.write(&events.join(" "))
        }

        fn capabilities(&self) -> Capabilities {
            (find_backend(self.name).unwrap().capabilities)()
        }

        fn is_log(&self) -> bool {
            find_backend(self.name).unwrap().is_log
        }

        fn close(&mut self) -> Result<(), OutputError> {
            self.write("closed")
        }

        fn dropped_presses(&self) -> u64 {
            2
        }

        fn coalesced_motions(&self) -> u64 {
            3
        }
    }

    fn router(outputs: &[(&'static str, bool)]) -> (Router, Log) {
        let log = Log::default();
        let sink = |&(name, fails): &(&'static str, bool)| {
            let log = Arc::clone(&log);
            Box::new(TestSink { name, fails, log }) as Box<dyn Sink>
        };
        let router = Router::new(outputs.iter().map(sink).collect());
        (router, log)
    }

    fn lines(log: &Log) -> Vec<String> {
        std::mem::take(&mut *log.lock().unwrap())
    }

    #[test]
    fn an_event_goes_to_the_first_output_that_supports_it_and_to_every_log() {
        let (mut router, log) =
            router(&[("transcript", false), ("uinput", false), ("desktop", false)]);
        let events = [
            down(1, "A"),
            down(1, "PadSouth"),
            event(1, EventKind::Character('é')),
            event(1, EventKind::Scroll(0, 120)),
            event(1, EventKind::Axis(Axis::LeftX, 1.0)),
            event(1, EventKind::Value(TargetId(0), 0.5)),
            up(1, "A"),
        ];
        router.send(&events).unwrap();
        let expected = [
            "transcript +A +PadSouth é scroll LeftX value -A",
            "uinput +A +PadSouth scroll LeftX value -A",
            "desktop é value",
        ];
        assert_eq!(lines(&log), expected);
        assert_eq!(router.dropped_presses(), 6);
        assert_eq!(router.coalesced_motions(), 9);
    }

    #[test]
    fn positions_are_within_the_part_of_the_desktop_and_logs_have_those_of_the_layout() {
        let (whole, log) = router(&[("transcript", false), ("desktop", false)]);
        let mut right_half = whole.in_part(DesktopPart {
            left: 0.5,
            ..DesktopPart::default()
        });
        let position = EventKind::MoveTo(0.5, 0.25);
        right_half
            .send(&[event(1, position), down(1, "A")])
            .unwrap();
        let expected = ["transcript to 0.5 0.25 +A", "desktop to 0.75 0.25 +A"];
        assert_eq!(lines(&log), expected);
    }

    #[test]
    fn a_failed_output_does_not_keep_releases_from_the_others() {
        let (mut router, log) =
            router(&[("transcript", true), ("desktop", true), ("uinput", false)]);
        let error = router.send(&[up(1, "A"), up(1, "PadSouth")]).unwrap_err();
        assert_eq!(error.to_string(), "the output `desktop` failed: gone");
        let expected = ["transcript -A -PadSouth", "desktop -A", "uinput -PadSouth"];
        assert_eq!(lines(&log), expected);
        let close_error = router.close().unwrap_err();
        assert_eq!(
            close_error.to_string(),
            "the output `transcript` failed: gone"
        );
        let expected_closes = ["transcript closed", "desktop closed", "uinput closed"];
        assert_eq!(lines(&log), expected_closes);
    }

    #[test]
    fn a_log_that_fails_next_to_a_desktop_is_reported_once_and_the_desktop_continues() {
        let (mut router, log) = router(&[("transcript", true), ("desktop", false)]);
        let reports = Log::default();
        let reported = Arc::clone(&reports);
        let report = move |error: &OutputError| reported.lock().unwrap().push(error.to_string());
        router.on_log_failure(Box::new(report));
        for event in [down(1, "A"), up(2, "A")] {
            router.send(&[event]).unwrap();
        }
        let expected = ["transcript +A", "desktop +A", "desktop -A"];
        assert_eq!(lines(&log), expected);
        let failed = "the output `transcript` failed: gone";
        assert_eq!(lines(&reports), [failed]);
        assert_eq!(router.close().unwrap_err().to_string(), failed);
    }

    #[test]
    fn a_long_list_of_events_arrives_complete_and_in_order() {
        let (mut router, log) = router(&[("desktop", false)]);
        let events: Vec<_> = (0..70).flat_map(|_| [down(1, "A"), up(1, "A")]).collect();
        router.send(&events).unwrap();
        let lines = lines(&log);
        let words = lines.iter().flat_map(|line| line.split(' ').skip(1));
        assert_eq!(words.collect::<Vec<_>>(), ["+A", "-A"].repeat(70));
    }

    #[test]
    fn a_log_carries_a_capability_only_if_all_outputs_are_logs() {
        let code = |name: &str| Capability::Key(key(name));
        let table = [
            ("desktop uinput", code("A"), Some(0)),
            ("uinput desktop", code("A"), Some(0)),
            ("desktop uinput", code("PadSouth"), Some(1)),
            ("uinput desktop", Capability::Text, Some(1)),
            ("transcript desktop", Capability::Text, Some(1)),
            ("transcript desktop", code("PadSouth"), None),
            ("transcript transcript", code("PadSouth"), Some(0)),
            ("uinput spacenav", Capability::Axis(Axis::TurnX), Some(1)),
            ("uinput spacenav", code("PadSouth"), Some(0)),
            ("desktop none", Capability::Axis(Axis::TurnX), Some(1)),
        ];
        for (names, capability, index) in table {
            let routes = names.split(' ').map(|name| Route {
                capabilities: (find_backend(name).unwrap().capabilities)(),
                is_log: find_backend(name).unwrap().is_log,
            });
            let routes: Vec<_> = routes.collect();
            assert_eq!(route(&routes, capability), index, "{capability}: {names}");
        }
    }
}
