//! Key presses for the desktop that the user sits at, through `enigo`.
//!
//! A connection to a display can be slow or hang, so it lives on a thread of its own; the loop only
//! puts orders into a queue. On X11 a key outlives whoever pressed it: the server keeps it down until
//! somebody lets go of it. So the thread lets go of everything when its queue is closed, however that
//! comes about: [`close`](Sink::close), a drop, or a panic of the loop.

use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};
use enigo::{Direction, Enigo, InputResult, NewConError, Settings};

use super::held::Held;
use super::worker::{Injector, Order, Report, Worker};
use super::{OutputError, Sink, platform};
use crate::device::{Action, KeyCode, OutputEvent};

const OUTPUT: &str = "desktop";

/// Half of it is for presses. The other half is more than there are keys, so that a release always
/// finds room: no more keys are down than there are.
const QUEUE: usize = 4 * Held::CAPACITY;

/// How long a display may take to answer before it counts as not there.
const CONNECT_LIMIT: Duration = Duration::from_secs(5);

/// How long [`Desktop::close`](Sink::close) waits.
const CLOSE_LIMIT: Duration = Duration::from_secs(1);

/// An output that presses keys on the desktop.
///
/// A press is refused, and [counted](Sink::refused_presses), while more than half of the queue is
/// full; its release is then ignored. A release is never refused.
pub struct Desktop {
    orders: Option<Sender<Order>>,
    accepted: Held,
    refused: u64,
    report: Arc<Report>,
    thread: Option<JoinHandle<()>>,
    ended: Receiver<()>,
}

impl Desktop {
    /// Connects to `display`, an X11 display name; without one, to the desktop of the session.
    pub fn open(display: Option<&str>) -> Result<Self, OutputError> {
        let display = display.map(str::to_owned);
        Self::start(move || Display::connect(display.as_deref()))
    }

    /// Runs the thread and waits until it is connected.
    fn start<C: Injector>(
        mut connect: impl FnMut() -> Result<C, String> + Send + 'static,
    ) -> Result<Self, OutputError> {
        let (orders, queue) = bounded(QUEUE);
        let (ready, readiness) = bounded(1);
        let (end, ended) = bounded::<()>(0);
        let report = Arc::new(Report::default());
        let of_thread = Arc::clone(&report);
        let thread = thread::Builder::new()
            .name("desktop output".into())
            .spawn(move || {
                let _end = end;
                let injector = match connect() {
                    Ok(injector) => injector,
                    Err(reason) => return drop(ready.send(Err(reason))),
                };
                if ready.send(Ok(())).is_ok() {
                    Worker::new(injector, &of_thread).work(&queue, connect);
                }
            })
            .map_err(|error| refuse(format!("no thread for it: {error}")))?;
        match readiness.recv_timeout(CONNECT_LIMIT) {
            Ok(Ok(())) => {}
            Ok(Err(reason)) => return Err(refuse(reason)),
            Err(RecvTimeoutError::Timeout) => {
                return Err(refuse("the display does not answer".into()));
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(refuse("connecting to the display panicked".into()));
            }
        }
        Ok(Self {
            orders: Some(orders),
            accepted: Held::default(),
            refused: 0,
            report,
            thread: Some(thread),
            ended,
        })
    }

    fn press(&mut self, key: KeyCode) -> Result<(), OutputError> {
        let Some(orders) = &self.orders else {
            return Err(failed("it is closed"));
        };
        if orders.len() >= QUEUE / 2 {
            self.refused += 1;
            return Ok(());
        }
        if self.accepted.press(key) {
            self.order(key, Direction::Press)?;
        }
        Ok(())
    }

    fn release(&mut self, key: KeyCode) -> Result<(), OutputError> {
        if self.accepted.release(key) {
            self.order(key, Direction::Release)?;
        }
        Ok(())
    }

    fn order(&self, key: KeyCode, direction: Direction) -> Result<(), OutputError> {
        let Some(orders) = &self.orders else {
            return Err(failed("it is closed"));
        };
        match orders.try_send(Order { key, direction }) {
            Ok(()) => Ok(()),
            Err(TrySendError::Full(_)) => Err(failed("its queue is full")),
            Err(TrySendError::Disconnected(_)) => Err(failed("its thread has ended")),
        }
    }

    fn outcome(&self) -> Result<(), OutputError> {
        match (self.report.failure.get(), self.report.stuck.get()) {
            (None, None) => Ok(()),
            (Some(failure), None) => Err(failed(failure)),
            (failure, Some(stuck)) => {
                let failure = failure.map_or("a release failed", String::as_str);
                Err(failed(&format!("{failure}; may still be down: {stuck}")))
            }
        }
    }
}

impl Sink for Desktop {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut outcome = Ok(());
        for event in events {
            let ordered = match event.action {
                Action::KeyDown(_) if self.report.failure.get().is_some() => Ok(()),
                Action::KeyDown(key) => self.press(key),
                Action::KeyUp(key) => self.release(key),
                _ => Ok(()),
            };
            outcome = outcome.and(ordered);
        }
        outcome.and(self.outcome())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.orders = None;
        if self.ended.recv_timeout(CLOSE_LIMIT) == Err(RecvTimeoutError::Timeout) {
            return Err(failed(
                "it did not take everything within a second; keys may still be down",
            ));
        }
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            return Err(failed("its thread panicked; keys may still be down"));
        }
        self.outcome()
    }

    fn refused_presses(&self) -> u64 {
        self.refused
    }
}

impl Drop for Desktop {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

/// A connection to a display.
struct Display(Enigo);

impl Display {
    fn connect(display: Option<&str>) -> Result<Self, String> {
        let settings = Settings {
            // The least that there is; it holds up clicks and scrolling only.
            linux_delay: 1,
            x11_display: display.map(str::to_owned),
            ..Settings::default()
        };
        platform::connect(settings)
            .map(Self)
            .map_err(|error| connect_reason(error, display))
    }
}

impl Injector for Display {
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String> {
        platform::inject(&mut self.0, key, direction)
            // Some texts of `enigo` have a placeholder that is never filled in.
            .map_err(|error| error.to_string().replace(": {e:?}", ""))
    }
}

fn connect_reason(error: NewConError, display: Option<&str>) -> String {
    match error {
        NewConError::EstablishCon(_) => platform::no_display(display),
        NewConError::NoPermission => "the system does not let this program press keys; allow it \
             under System Settings, Privacy & Security, Accessibility"
            .into(),
        NewConError::Reply | NewConError::NoEmptyKeycodes => error.to_string(),
    }
}

/// Presses the key in this place, whatever the keymap writes for it: X11 key codes, which Wayland
/// shares.
pub fn by_position(enigo: &mut Enigo, key: KeyCode, direction: Direction) -> InputResult<()> {
    enigo::Keyboard::raw(enigo, key.x11_code(), direction)
}

fn refuse(reason: String) -> OutputError {
    OutputError::Open {
        output: OUTPUT.into(),
        reason,
    }
}

fn failed(reason: &str) -> OutputError {
    OutputError::Send {
        output: OUTPUT.into(),
        reason: reason.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::RETRIES;
    use crate::output::tests::{down, up};
    use std::sync::Mutex;
    use std::time::Instant;

    /// A display that writes down what it is told.
    #[derive(Clone, Default)]
    struct Desk(Arc<Mutex<State>>);

    #[derive(Default)]
    struct State {
        lines: Vec<String>,
        failures: usize,
        first_is_broken: bool,
        takes_no_other: bool,
        connections: usize,
    }

    struct Connection {
        desk: Desk,
        number: usize,
        gate: Receiver<()>,
    }

    impl Desk {
        /// A sink on this display; each key waits until the returned gate is dropped.
        fn open(&self) -> (Desktop, Sender<()>) {
            let (gate, closed_gate) = bounded::<()>(0);
            let desk = self.clone();
            let sink = Desktop::start(move || {
                let mut state = desk.0.lock().unwrap();
                let number = state.connections;
                state.connections += 1;
                if state.takes_no_other {
                    return Err("no room".into());
                }
                Ok(Connection {
                    desk: desk.clone(),
                    number,
                    gate: closed_gate.clone(),
                })
            });
            (sink.unwrap(), gate)
        }

        fn lines(&self) -> Vec<String> {
            self.0.lock().unwrap().lines.clone()
        }
    }

    impl Injector for Connection {
        fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String> {
            let _ = self.gate.recv();
            let mut state = self.desk.0.lock().unwrap();
            if state.first_is_broken && self.number == 0 {
                return Err("the display is gone".into());
            }
            if state.failures > 0 {
                state.failures -= 1;
                return Err("busy".into());
            }
            let sign = if direction == Direction::Press {
                '+'
            } else {
                '-'
            };
            state.lines.push(format!("{sign}{key}"));
            Ok(())
        }
    }

    #[test]
    fn closing_delivers_what_waits_and_lets_go_with_modifiers_last() {
        let desk = Desk::default();
        let (mut sink, gate) = desk.open();
        sink.send(&[down(1, "ShiftLeft"), down(1, "A"), up(1, "B")])
            .unwrap();
        sink.send(&[up(2, "A"), down(2, "C")]).unwrap();
        drop(gate);
        sink.close().unwrap();
        sink.close().unwrap();
        let lines = ["+ShiftLeft", "+A", "-A", "+C", "-C", "-ShiftLeft"];
        assert_eq!(desk.lines(), lines);
        let error = sink.send(&[down(3, "A")]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the output `desktop` failed: it is closed"
        );
    }

    #[test]
    fn a_panic_of_whoever_holds_it_lets_go_of_everything() {
        let desk = Desk::default();
        let (mut sink, gate) = desk.open();
        drop(gate);
        let holder = thread::spawn(move || {
            sink.send(&[down(1, "A")]).unwrap();
            panic!("meant to happen");
        });
        assert!(holder.join().is_err());
        assert_eq!(desk.lines(), ["+A", "-A"]);
    }

    #[test]
    fn when_the_queue_fills_presses_are_refused_and_no_release_is() {
        let desk = Desk::default();
        let (mut sink, gate) = desk.open();
        sink.send(&[down(0, "ShiftLeft")]).unwrap();
        for time in 0..QUEUE as u64 {
            sink.send(&[down(time, "A"), up(time, "A")]).unwrap();
        }
        assert!(sink.refused_presses() > 0);
        sink.send(&[up(1, "ShiftLeft")]).unwrap();
        let refused = sink.refused_presses() as usize;
        drop(gate);
        sink.close().unwrap();
        let count = |line: &str| desk.lines().iter().filter(|found| *found == line).count();
        assert_eq!(count("+A"), QUEUE - refused);
        assert_eq!(count("-A"), count("+A"));
        assert_eq!(count("-ShiftLeft"), 1);
    }

    #[test]
    fn sending_does_not_wait_for_a_display_that_hangs_and_closing_waits_a_second() {
        let desk = Desk::default();
        let (mut sink, gate) = desk.open();
        sink.send(&[down(1, "A")]).unwrap();
        let start = Instant::now();
        let error = sink.close().unwrap_err();
        assert!(start.elapsed() < 3 * CLOSE_LIMIT);
        assert!(error.to_string().contains("may still be down"), "{error}");
        drop(gate);
        sink.close().unwrap();
        assert_eq!(desk.lines(), ["+A", "-A"]);
    }

    #[test]
    fn a_display_that_is_busy_three_times_loses_nothing() {
        let desk = Desk::default();
        let (mut sink, gate) = desk.open();
        desk.0.lock().unwrap().failures = RETRIES;
        sink.send(&[down(1, "A")]).unwrap();
        drop(gate);
        sink.close().unwrap();
        assert_eq!(desk.lines(), ["+A", "-A"]);
    }

    #[test]
    fn after_a_failure_nothing_is_pressed_and_what_may_be_down_is_let_go_of() {
        let desk = Desk::default();
        let (mut sink, gate) = desk.open();
        desk.0.lock().unwrap().failures = 1 + RETRIES;
        sink.send(&[down(1, "A"), down(2, "B")]).unwrap();
        drop(gate);
        let error = sink.close().unwrap_err();
        assert_eq!(error.to_string(), "the output `desktop` failed: busy");
        assert_eq!(desk.lines(), ["-A"]);
        assert!(sink.send(&[down(3, "C")]).is_err());
    }

    #[test]
    fn when_the_connection_is_lost_keys_are_let_go_of_through_a_new_one() {
        let desk = Desk::default();
        let (mut sink, gate) = desk.open();
        drop(gate);
        sink.send(&[down(1, "A")]).unwrap();
        while desk.lines().is_empty() {
            thread::yield_now();
        }
        desk.0.lock().unwrap().first_is_broken = true;
        sink.close().unwrap_err();
        assert_eq!(desk.lines(), ["+A", "-A"]);
        assert_eq!(desk.0.lock().unwrap().connections, 2);
    }

    #[test]
    fn what_cannot_be_let_go_of_is_named() {
        let desk = Desk::default();
        let (mut sink, gate) = desk.open();
        drop(gate);
        sink.send(&[down(1, "ShiftLeft"), down(1, "A")]).unwrap();
        while desk.lines().len() < 2 {
            thread::yield_now();
        }
        let mut state = desk.0.lock().unwrap();
        (state.first_is_broken, state.takes_no_other) = (true, true);
        drop(state);
        let error = sink.close().unwrap_err().to_string();
        let end = "the display is gone; may still be down: A, ShiftLeft";
        assert!(error.ends_with(end), "{error}");
    }

    #[test]
    fn without_a_display_the_error_says_what_to_do() {
        let error = Desktop::open(Some(":59000")).err().unwrap();
        let start = "cannot open the output `desktop`: no display answers at `:59000`";
        assert!(error.to_string().starts_with(start), "{error}");
    }
}
