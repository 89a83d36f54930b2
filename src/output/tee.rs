//! One stream of events to several outputs.

use super::{OutputError, Sink};
use crate::contact::TargetNames;
use crate::device::OutputEvent;

/// Sends every event to each of its outputs.
///
/// An output that fails does not keep the others from their events, least of all from releases; the
/// first error is told.
pub struct Tee(Vec<Box<dyn Sink>>);

impl Tee {
    /// Of these outputs, in this order.
    pub fn new(sinks: Vec<Box<dyn Sink>>) -> Self {
        Self(sinks)
    }

    fn each(
        &mut self,
        mut call: impl FnMut(&mut dyn Sink) -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        let mut outcome = Ok(());
        for sink in &mut self.0 {
            outcome = outcome.and(call(sink.as_mut()));
        }
        outcome
    }
}

impl Sink for Tee {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        self.each(|sink| sink.send(events))
    }

    fn rename(&mut self, names: &TargetNames) {
        for sink in &mut self.0 {
            sink.rename(names);
        }
    }

    /// Closes every output, one after the other.
    fn close(&mut self) -> Result<(), OutputError> {
        self.each(|sink| sink.close())
    }

    fn refused_presses(&self) -> u64 {
        self.0.iter().map(|sink| sink.refused_presses()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::{down, up};
    use std::sync::{Arc, Mutex};

    struct Listed {
        name: &'static str,
        fails: bool,
        log: Arc<Mutex<Vec<String>>>,
    }

    impl Listed {
        fn note(&self, what: &str) -> Result<(), OutputError> {
            self.log
                .lock()
                .unwrap()
                .push(format!("{} {what}", self.name));
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
            self.note(&events.len().to_string())
        }

        fn close(&mut self) -> Result<(), OutputError> {
            self.note("closed")
        }

        fn refused_presses(&self) -> u64 {
            2
        }
    }

    #[test]
    fn an_output_that_fails_does_not_keep_the_others_from_releases() {
        let log = Arc::new(Mutex::new(Vec::new()));
        let listed = |name, fails| {
            let log = Arc::clone(&log);
            Box::new(Listed { name, fails, log }) as Box<dyn Sink>
        };
        let mut tee = Tee::new(vec![
            listed("a", false),
            listed("b", true),
            listed("c", true),
        ]);
        let error = tee.send(&[down(1, "A"), up(1, "A")]).unwrap_err();
        assert_eq!(error.to_string(), "the output `b` failed: gone");
        let error = tee.close().unwrap_err();
        assert_eq!(error.to_string(), "the output `b` failed: gone");
        let lines = ["a 2", "b 2", "c 2", "a closed", "b closed", "c closed"];
        assert_eq!(*log.lock().unwrap(), lines);
        assert_eq!(tee.refused_presses(), 6);
    }
}
