//! The thread that releases the keys of a lost client. A display that hangs blocks this thread and not the main loop.

use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, bounded};

use super::ClientLoss;
use super::record::{Record, SharedRecord};
use crate::advice;
use crate::output::character_key::KEYMAP_LIFETIME;
use crate::output::desktop::injector::Injector;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};

/// Time for which keys are released again after the display has responded: requests that a dead client had sent are
/// executed after it.
const SETTLE_TIME: Duration = Duration::from_millis(300);

/// Longest time in which a display that does not hang answers a query and releases all keys.
const RESPONSE_TIME: Duration = Duration::from_millis(50);

/// Delay before the next query.
const POLL_INTERVAL: Duration = Duration::from_millis(5);

/// An injector that only releases keys, and centers axes.
pub trait Releaser: Injector {
    /// Centers the axes of all devices.
    fn center_axes(&mut self);
}

/// The thread. Dropping it without [`finish`](Self::finish) detaches the thread.
pub struct ReleaseThread {
    faults: Sender<()>,
    /// The thread, which returns `true` if everything was released when the client had exited.
    thread: JoinHandle<bool>,
}

impl ReleaseThread {
    /// Starts the thread and waits until it is connected. `connect` makes the connection, and another one after a
    /// failure; `log` must not block.
    pub fn start<R: Releaser>(
        record: Arc<SharedRecord>,
        connect: impl Fn() -> Result<R, String> + Send + 'static,
        log: impl Fn(&str) + Send + 'static,
    ) -> Result<Self, String> {
        let (faults, received) = bounded(1);
        let (connected, connection) = bounded(1);
        let run = move || {
            // Here, as a connection cannot always move to another thread.
            let releaser = match connect() {
                Ok(releaser) => releaser,
                Err(reason) => {
                    let _ = connected.send(Err(reason));
                    return false;
                }
            };
            let _ = connected.send(Ok(()));
            let mut state = ReleaseState {
                releaser,
                record,
                connect,
                log,
            };
            state.run(&received)
        };
        let thread = thread::Builder::new().name("releases".into()).spawn(run);
        let thread = thread.map_err(|error| advice::no_thread(&error).to_string())?;
        match connection.recv() {
            Ok(result) => result.map(|()| Self { faults, thread }),
            Err(_) => Err("connecting to the display panicked".into()),
        }
    }

    /// Requests the release of everything in the record, because the client hangs.
    pub fn release(&self) {
        // A fault that waits already has the same effect.
        let _ = self.faults.try_send(());
    }

    /// Releases everything in the record, because the client has exited, and waits until that is confirmed. Returns `true` if
    /// nothing stays pressed or in the keymap.
    pub fn finish(self) -> bool {
        drop(self.faults);
        self.thread.join().unwrap_or(false)
    }
}

struct ReleaseState<R, C, L> {
    releaser: R,
    record: Arc<SharedRecord>,
    connect: C,
    log: L,
}

impl<R: Releaser, C: Fn() -> Result<R, String>, L: Fn(&str)> ReleaseState<R, C, L> {
    /// Handles losses of the client until it has exited. Returns `true` if everything was released then.
    fn run(&mut self, faults: &Receiver<()>) -> bool {
        while faults.recv().is_ok() {
            self.handle(ClientLoss::Hung);
        }
        let is_released = self.handle(ClientLoss::Exited);
        self.remove_added_keys() && is_released
    }

    /// Removes what the client has added to the keymap, after receivers had time to look it up. Returns `true` if nothing is left.
    fn remove_added_keys(&mut self) -> bool {
        let added = self.record.lock().added_keys.clone();
        if added.as_slice().is_empty() {
            return true;
        }
        thread::sleep(KEYMAP_LIFETIME);
        if self
            .releaser
            .remove_character_keys(added.as_slice())
            .is_ok()
        {
            return true;
        }
        // A display that is gone has no keymap.
        let Ok(releaser) = (self.connect)() else {
            return false;
        };
        self.releaser = releaser;
        self.releaser
            .remove_character_keys(added.as_slice())
            .is_ok()
    }

    /// Releases everything in the record. Returns `true` if that was confirmed.
    fn handle(&mut self, loss: ClientLoss) -> bool {
        let record = self.record.lock().clone();
        if record.is_empty() {
            return true;
        }
        let reason = match loss {
            ClientLoss::Exited => "the program exited",
            ClientLoss::Hung => "the program does not respond",
        };
        let count = record.pressed.count();
        let released = self.release_until_settled(loss);
        match &released {
            Ok(()) => (self.log)(&format!("{reason}; released its keys ({count})")),
            Err(failure) => (self.log)(&format!(
                "{reason}; keys may still be pressed: {failure}; press and release them on your keyboard"
            )),
        }
        released.is_ok()
    }

    /// Releases everything in the record, and again until no press of the client can follow; on a new connection if this one
    /// fails.
    fn release_until_settled(&mut self, loss: ClientLoss) -> Result<(), String> {
        let mut record = self.record.lock().clone();
        let mut responded_at = self.release_all(&record)?;
        let mut has_failed = false;
        loop {
            let is_over = loss == ClientLoss::Hung && !self.record.is_client_lost();
            if is_over || responded_at.elapsed() >= SETTLE_TIME {
                return Ok(());
            }
            record.clone_from(&self.record.lock());
            let start = Instant::now();
            match self.release_reported(&record.pressed) {
                Ok(true) => {}
                // The order of all requests is known: nothing can follow.
                Ok(false) => return Ok(()),
                // A press of the client may still follow.
                Err(_) if !has_failed => {
                    has_failed = true;
                    self.releaser = (self.connect)()?;
                    responded_at = self.release_all(&record)?;
                }
                Err(failure) => return Err(failure),
            }
            // While the display did not respond, requests of the client waited for it too.
            if start.elapsed() > RESPONSE_TIME {
                responded_at = Instant::now();
            }
            thread::sleep(POLL_INTERVAL);
        }
    }

    /// Releases each of the keys that the display reports as pressed. Returns `false` if it does not report keys.
    fn release_reported(&mut self, keys: &PressedKeys) -> Result<bool, String> {
        let Some(pressed) = self.releaser.query_pressed(keys)? else {
            return Ok(false);
        };
        self.release_keys(&pressed)?;
        Ok(true)
    }

    /// Releases everything once, on a new connection if this one fails. Returns the time at which the display responded.
    fn release_all(&mut self, record: &Record) -> Result<Instant, String> {
        if record.are_axes_deflected {
            self.releaser.center_axes();
        }
        if self.release_keys(&record.pressed).is_err() {
            self.releaser = (self.connect)()?;
            self.release_keys(&record.pressed)?;
        }
        Ok(Instant::now())
    }

    /// Releases all keys, also those after one that fails.
    fn release_keys(&mut self, keys: &PressedKeys) -> Result<(), String> {
        let release = |key| self.releaser.inject(key, KeyDirection::Release);
        keys.release_order().map(release).fold(Ok(()), Result::and)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::character_key::{CharacterKey, KeymapChange};
    use crate::output::desktop::pending_motion::StatelessAction;
    use crate::output::tests::{key, wait_until};
    use crate::output::watchdog::WatchdogMessage;
    use ademan_core::device::KeyCode;
    use std::sync::Mutex;

    /// A display whose requests a test delays.
    #[derive(Clone, Default)]
    struct TestDisplay(Arc<Mutex<DisplayState>>);

    #[derive(Default)]
    struct DisplayState {
        pressed: PressedKeys,
        releases: usize,
        centerings: usize,
        /// A press of the dead client, which is executed after this number of releases.
        delayed_press: Option<(usize, KeyCode)>,
        reports_keys: bool,
        /// A key whose release always fails.
        refused: Option<KeyCode>,
        failures: usize,
        failed_queries: usize,
        removed: Vec<CharacterKey>,
    }

    impl Injector for TestDisplay {
        fn inject(&mut self, key: KeyCode, direction: KeyDirection) -> Result<(), String> {
            assert_eq!(direction, KeyDirection::Release);
            let mut state = self.0.lock().unwrap();
            if state.failures > 0 {
                state.failures -= 1;
                return Err("gone".into());
            }
            if state.refused == Some(key) {
                return Err("refused".into());
            }
            state.releases += 1;
            state.pressed.release(key);
            if let Some((releases, press)) = state.delayed_press
                && releases == state.releases
            {
                state.pressed.press(press);
            }
            Ok(())
        }

        fn perform(&mut self, _: StatelessAction) -> Result<(), String> {
            unreachable!()
        }

        fn remove_character_keys(&mut self, keys: &[CharacterKey]) -> Result<(), String> {
            self.0.lock().unwrap().removed.extend(keys);
            Ok(())
        }

        fn query_pressed(&mut self, keys: &PressedKeys) -> Result<Option<PressedKeys>, String> {
            let mut state = self.0.lock().unwrap();
            if state.failed_queries > 0 {
                state.failed_queries -= 1;
                return Err("gone".into());
            }
            let mut pressed = PressedKeys::default();
            for key in keys
                .release_order()
                .filter(|key| state.pressed.contains(*key))
            {
                pressed.press(key);
            }
            Ok(state.reports_keys.then_some(pressed))
        }
    }

    impl Releaser for TestDisplay {
        fn center_axes(&mut self) {
            self.0.lock().unwrap().centerings += 1;
        }
    }

    fn display(state: DisplayState) -> TestDisplay {
        TestDisplay(Arc::new(Mutex::new(state)))
    }

    fn start(
        display: &TestDisplay,
        messages: &[WatchdogMessage],
    ) -> (ReleaseThread, Arc<SharedRecord>) {
        let record = Arc::<SharedRecord>::default();
        for message in messages {
            record.lock().apply(*message);
        }
        record.set_client_lost(true);
        let display = display.clone();
        let connect = move || Ok(display.clone());
        let thread = ReleaseThread::start(Arc::clone(&record), connect, |_| {});
        (thread.unwrap(), record)
    }

    /// Returns a display that executes a press after its first release.
    fn display_with_late_press(key: KeyCode) -> TestDisplay {
        display(DisplayState {
            delayed_press: Some((1, key)),
            reports_keys: true,
            ..DisplayState::default()
        })
    }

    #[test]
    fn a_press_that_the_display_executes_after_the_release_is_released_too() {
        let a = key("A");
        let display = display_with_late_press(a);
        start(&display, &[WatchdogMessage::KeyDown(a)]).0.finish();
        let state = display.0.lock().unwrap();
        assert!(state.pressed.is_empty());
        assert_eq!(state.releases, 2);
    }

    #[test]
    fn a_press_that_the_display_executes_while_the_client_hangs_is_released_too() {
        let a = key("A");
        let display = display_with_late_press(a);
        let (thread, record) = start(&display, &[WatchdogMessage::KeyDown(a)]);
        thread.release();
        wait_until("a second release", || {
            display.0.lock().unwrap().releases == 2
        });
        record.lock().apply(WatchdogMessage::KeyUp(a));
        assert!(thread.finish());
        assert!(display.0.lock().unwrap().pressed.is_empty());
    }

    #[test]
    fn a_key_that_the_display_refuses_costs_neither_the_others_nor_the_keymap() {
        let (a, b) = (key("A"), key("B"));
        let mut pressed = PressedKeys::default();
        pressed.press(b);
        let display = display(DisplayState {
            pressed,
            refused: Some(a),
            ..DisplayState::default()
        });
        let added = CharacterKey {
            code: 93,
            keysym: 0xf1,
        };
        let messages = [
            WatchdogMessage::CharacterKey(added, KeymapChange::Added),
            WatchdogMessage::KeyDown(b),
            // The last pressed key is released first.
            WatchdogMessage::KeyDown(a),
        ];
        assert!(!start(&display, &messages).0.finish());
        let state = display.0.lock().unwrap();
        assert!(state.pressed.is_empty());
        assert_eq!(state.removed, [added]);
    }

    #[test]
    fn a_key_is_released_at_every_fault_until_the_client_reports_its_release() {
        let display = display(DisplayState::default());
        let pressed = [
            WatchdogMessage::KeyDown(key("A")),
            WatchdogMessage::AxesDeflected,
        ];
        let (thread, record) = start(&display, &pressed);
        let releases = || {
            let state = display.0.lock().unwrap();
            (state.releases, state.centerings)
        };
        for count in 1..=2 {
            thread.release();
            wait_until("a release", || releases() == (count, count));
        }
        record.lock().apply(WatchdogMessage::KeyUp(key("A")));
        record.lock().apply(WatchdogMessage::AxesCentered);
        thread.finish();
        assert_eq!(releases(), (2, 2));
    }

    #[test]
    fn keys_that_the_client_has_left_in_the_keymap_are_removed_once() {
        let display = display(DisplayState::default());
        let key = |code, keysym| CharacterKey { code, keysym };
        let changes = [
            (key(93, 0xf1), KeymapChange::Added),
            (key(97, 0xdf), KeymapChange::Added),
            (key(97, 0xdf), KeymapChange::Removed),
            (key(93, 0xfc), KeymapChange::Added),
        ];
        let messages = changes
            .map(|(character_key, change)| WatchdogMessage::CharacterKey(character_key, change));
        let (thread, record) = start(&display, &messages);
        assert!(record.lock().is_empty(), "no key is pressed");
        thread.release();
        thread.finish();
        assert_eq!(display.0.lock().unwrap().removed, [key(93, 0xfc)]);
    }

    #[test]
    fn keys_are_released_on_a_new_connection_if_the_first_fails() {
        let display = display(DisplayState {
            failures: 1,
            ..DisplayState::default()
        });
        start(&display, &[WatchdogMessage::KeyDown(key("A"))])
            .0
            .finish();
        assert_eq!(display.0.lock().unwrap().releases, 1);
    }

    #[test]
    fn a_late_press_is_released_although_the_connection_fails_while_it_settles() {
        let a = key("A");
        let display = display(DisplayState {
            // After the release on the new connection.
            delayed_press: Some((2, a)),
            reports_keys: true,
            failed_queries: 1,
            ..DisplayState::default()
        });
        let (thread, _) = start(&display, &[WatchdogMessage::KeyDown(a)]);
        assert!(thread.finish());
        let state = display.0.lock().unwrap();
        assert!(state.pressed.is_empty());
        assert_eq!(state.releases, 3);
    }

    #[test]
    fn a_display_that_fails_again_on_a_new_connection_is_an_error() {
        let a = key("A");
        let display = display(DisplayState {
            reports_keys: true,
            failed_queries: usize::MAX,
            ..DisplayState::default()
        });
        let (thread, _) = start(&display, &[WatchdogMessage::KeyDown(a)]);
        assert!(!thread.finish());
        assert_eq!(display.0.lock().unwrap().releases, 2);
    }
}
