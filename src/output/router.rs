//! One stream of events to several outputs.

use super::reach::{OutputKind, route};
use super::{OutputError, Sink};
use crate::contact::TargetNames;
use crate::device::{Capability, EventKind, Events, OutputEvent, TimedCommand};

/// Sends each kind of action to the first of its outputs that can carry it.
///
/// Which one that is depends on the kind alone, so that a release goes where its press went. Two
/// things are told to all: what no output has to carry, such as depths and values, and everything to
/// [records](Reach::Record). An output that fails does not keep the others from their events, least
/// of all from releases; the first error is told.
pub struct Router {
    sinks: Vec<Box<dyn Sink>>,
    reaches: Vec<OutputKind>,
    part: Events,
}

impl Router {
    /// Of these outputs; the first that can carry something gets it.
    pub fn new(sinks: Vec<Box<dyn Sink>>) -> Self {
        let reaches = sinks.iter().map(|sink| sink.kind()).collect();
        Self {
            sinks,
            reaches,
            part: Events::new(),
        }
    }

    fn each(
        &mut self,
        mut call: impl FnMut(&mut dyn Sink) -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        let mut outcome = Ok(());
        for sink in &mut self.sinks {
            outcome = outcome.and(call(sink.as_mut()));
        }
        outcome
    }
}

impl Sink for Router {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut outcome = Ok(());
        for (place, sink) in self.sinks.iter_mut().enumerate() {
            self.part.clear();
            for event in events {
                if !hears(&self.reaches, place, event.kind) {
                    continue;
                }
                if self.part.is_full() {
                    outcome = outcome.and(sink.send(&self.part));
                    self.part.clear();
                }
                self.part.push(*event);
            }
            outcome = outcome.and(sink.send(&self.part));
        }
        outcome
    }

    fn log_commands(&mut self, commands: &[TimedCommand]) -> Result<(), OutputError> {
        self.each(|sink| sink.log_commands(commands))
    }

    fn set_target_names(&mut self, names: &TargetNames) {
        for sink in &mut self.sinks {
            sink.set_target_names(names);
        }
    }

    /// Closes every output, one after the other.
    fn close(&mut self) -> Result<(), OutputError> {
        self.each(|sink| sink.close())
    }

    fn dropped_presses(&self) -> u64 {
        self.sinks.iter().map(|sink| sink.dropped_presses()).sum()
    }

    fn coalesced_motions(&self) -> u64 {
        let counts = self.sinks.iter().map(|sink| sink.coalesced_motions());
        counts.sum()
    }
}

fn hears(reaches: &[OutputKind], place: usize, action: EventKind) -> bool {
    let Some(need) = Capability::required_by(action) else {
        return true;
    };
    reaches[place] == OutputKind::Log || route(reaches, need) == Some(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::TargetId;
    use crate::device::Axis;
    use crate::output::tests::{down, event, up};
    use std::sync::{Arc, Mutex};

    type Log = Arc<Mutex<Vec<String>>>;

    struct Listed {
        name: &'static str,
        reach: OutputKind,
        fails: bool,
        log: Log,
    }

    impl Listed {
        fn note(&self, what: &str) -> Result<(), OutputError> {
            let line = format!("{} {what}", self.name);
            self.log.lock().unwrap().push(line);
            if !self.fails {
                return Ok(());
            }
            Err(OutputError::Send {
                output: self.name.into(),
                reason: "gone".into(),
            })
        }
    }

    impl Sink for Listed {
        fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
            let of_event = |event: &OutputEvent| match event.kind {
                EventKind::KeyDown(key) => format!("+{key}"),
                EventKind::KeyUp(key) => format!("-{key}"),
                EventKind::Character(character) => character.into(),
                EventKind::Scroll(..) => "scroll".into(),
                EventKind::Axis(axis, _) => axis.name().into(),
                EventKind::Value(..) => "value".into(),
                _ => "other".into(),
            };
            let events: Vec<_> = events.iter().map(of_event).collect();
            self.note(&events.join(" "))
        }

        fn kind(&self) -> OutputKind {
            self.reach
        }

        fn close(&mut self) -> Result<(), OutputError> {
            self.note("closed")
        }

        fn dropped_presses(&self) -> u64 {
            2
        }

        fn coalesced_motions(&self) -> u64 {
            3
        }
    }

    fn router(outputs: &[(&'static str, OutputKind, bool)]) -> (Router, Log) {
        let log = Log::default();
        let listed = |&(name, reach, fails): &(&'static str, OutputKind, bool)| {
            let log = Arc::clone(&log);
            let listed = Listed {
                name,
                reach,
                fails,
                log,
            };
            Box::new(listed) as Box<dyn Sink>
        };
        let router = Router::new(outputs.iter().map(listed).collect());
        (router, log)
    }

    fn lines(log: &Log) -> Vec<String> {
        std::mem::take(&mut *log.lock().unwrap())
    }

    #[test]
    fn each_action_goes_to_the_first_that_can_carry_it_and_a_record_hears_all() {
        let (mut router, log) = router(&[
            ("record", OutputKind::Log, false),
            ("uinput", OutputKind::Uinput, false),
            ("desktop", OutputKind::Desktop, false),
        ]);
        let frame = [
            down(1, "A"),
            down(1, "PadSouth"),
            event(1, EventKind::Character('é')),
            event(1, EventKind::Scroll(0, 120)),
            event(1, EventKind::Axis(Axis::LeftX, 1.0)),
            event(1, EventKind::Value(TargetId(0), 0.5)),
            up(1, "A"),
        ];
        router.send(&frame).unwrap();
        let expected = [
            "record +A +PadSouth é scroll LeftX value -A",
            "uinput +A +PadSouth scroll LeftX value -A",
            "desktop é value",
        ];
        assert_eq!(lines(&log), expected);
        assert_eq!(router.dropped_presses(), 6);
        assert_eq!(router.coalesced_motions(), 9);
    }

    #[test]
    fn an_output_that_fails_does_not_keep_the_others_from_releases() {
        let (mut router, log) = router(&[
            ("record", OutputKind::Log, true),
            ("desktop", OutputKind::Desktop, true),
            ("uinput", OutputKind::Uinput, false),
        ]);
        let error = router.send(&[up(1, "A"), up(1, "PadSouth")]).unwrap_err();
        assert_eq!(error.to_string(), "the output `record` failed: gone");
        let expected = ["record -A -PadSouth", "desktop -A", "uinput -PadSouth"];
        assert_eq!(lines(&log), expected);
        let error = router.close().unwrap_err();
        assert_eq!(error.to_string(), "the output `record` failed: gone");
        let expected = ["record closed", "desktop closed", "uinput closed"];
        assert_eq!(lines(&log), expected);
    }

    #[test]
    fn a_frame_of_any_length_arrives_whole_and_in_order() {
        let (mut router, log) = router(&[("desktop", OutputKind::Desktop, false)]);
        let frame: Vec<_> = (0..70).flat_map(|_| [down(1, "A"), up(1, "A")]).collect();
        router.send(&frame).unwrap();
        let words: Vec<_> = lines(&log)
            .iter()
            .flat_map(|line| {
                line.split(' ')
                    .skip(1)
                    .map(str::to_owned)
                    .collect::<Vec<_>>()
            })
            .collect();
        assert_eq!(words, ["+A", "-A"].repeat(70));
    }
}
