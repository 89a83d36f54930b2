//! The thread of an output that may be slow: it executes requests, repeats failed ones, and releases every key at the
//! end.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, never, select};

use super::burst::{self, Stroke};
#[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
use super::composing::Composing;
use super::direct_keys::{ConnectionNumber, DirectAnswers};
use super::followed_focus::FollowedFocus;
use super::injector::{Injector, WindowId};
use super::key_reporter::KeyReporter;
use super::loop_monitor::LoopMonitor;
use super::pending_motion::StatelessAction;
use super::press_ticket::{MAX_PRESS_AGE, PressTicket};
use super::worker_status::WorkerStatus;
use crate::output::pressed_key_file::PressedKeyFile;
use crate::output::watchdog::{HEARTBEAT_INTERVAL, WatchdogClient};
use crate::output::{RETRIES, RETRY_DELAY};
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};

/// A request from the loop to the thread.
#[derive(Clone, Copy)]
pub enum WorkerRequest {
    Press(KeyCode, PressTicket),
    /// A part of a burst. All parts have one ticket, and the last one has the burst executed.
    Stroke {
        stroke: Stroke,
        is_last: bool,
        ticket: PressTicket,
        /// The generation of the field of the text before the burst: a burst replaces nothing in another one.
        field: u32,
    },
    Release(KeyCode),
    /// Text for the focused field.
    #[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
    Compose(Composing, PressTicket),
    Perform(StatelessAction, PressTicket),
    /// The loop has written a key event to a connection of its own, whose answers the thread reads.
    Confirm(KeyCode, KeyDirection, ConnectionNumber, PressTicket),
}

/// Time after the last request for which heartbeats continue, so that the next press need not wait for a reply.
const ACTIVE_TIME: Duration = Duration::from_secs(1);

/// Interval at which an idle thread checks the connection to the display.
const CHECK_INTERVAL: Duration = Duration::from_millis(400);

/// The state of the thread: the pressed keys and the connection.
pub struct Worker<'a> {
    injector: Box<dyn Injector>,
    pressed: PressedKeys,
    /// The parts of a burst so far.
    burst: Vec<Stroke>,
    focus: FollowedFocus,
    status: &'a WorkerStatus,
    watchdog: Option<WatchdogClient>,
    reporter: KeyReporter,
    direct: DirectAnswers,
    /// `true` if the watchdog did not accept a message, or has exited.
    is_watchdog_lost: bool,
    liveness: Liveness,
}

/// Times of the last signs of life.
struct Liveness {
    /// The last heartbeat, or the time at which one was due.
    last_heartbeat: Instant,
    loop_monitor: LoopMonitor,
    last_request: Instant,
}

impl<'a> Worker<'a> {
    /// Creates a worker with no key pressed. Every press and release is reported to the watchdog.
    pub fn new(
        mut injector: Box<dyn Injector>,
        watchdog: Option<WatchdogClient>,
        mut direct: DirectAnswers,
        status: &'a WorkerStatus,
    ) -> Self {
        let now = Instant::now();
        let file = watchdog.as_ref().and_then(|_| PressedKeyFile::create());
        let reporter = KeyReporter::new(watchdog.as_ref(), file);
        direct.open(|| injector.open_direct_connection(), &reporter);
        injector.watch_focus();
        Self {
            injector,
            pressed: PressedKeys::default(),
            burst: Vec::new(),
            focus: FollowedFocus::default(),
            status,
            watchdog,
            reporter,
            direct,
            is_watchdog_lost: false,
            liveness: Liveness {
                last_heartbeat: now,
                loop_monitor: LoopMonitor::default(),
                last_request: now,
            },
        }
    }

    /// Executes requests until the queue is closed, then releases every key.
    pub fn run(
        mut self,
        queue: &Receiver<WorkerRequest>,
        connect: impl FnMut() -> Result<Box<dyn Injector>, String>,
    ) {
        let mut watchdog_exited = self
            .watchdog
            .as_ref()
            .map_or_else(never, |watchdog| watchdog.exited().clone());
        loop {
            select! {
                recv(queue) -> request => match request {
                    // A panic in the display library must not keep keys pressed.
                    Ok(request) => {
                        if catch_unwind(AssertUnwindSafe(|| self.execute(request))).is_err() {
                            self.fail("the connection to the display panicked");
                        }
                        self.status.executed.fetch_add(1, Ordering::Release);
                        self.liveness.last_request = Instant::now();
                    }
                    Err(_) => break,
                },
                recv(watchdog_exited) -> _ => self.is_watchdog_lost = true,
                default(self.poll_timeout()) => self.check_connection(),
            }
            self.send_heartbeat_if_due();
            if self.is_watchdog_lost {
                watchdog_exited = self.restart_watchdog();
            }
        }
        self.finish(connect);
    }

    /// Releases every key, on a new connection if this one has failed: the display keeps a key pressed although the
    /// connection that pressed it is gone.
    fn finish(&mut self, mut connect: impl FnMut() -> Result<Box<dyn Injector>, String>) {
        self.release_all();
        if !self.pressed.is_empty()
            && let Ok(injector) = connect()
        {
            self.injector = injector;
            self.release_all();
        }
        self.injector.restore_keymap(&mut self.reporter);
        let stuck: Vec<_> = self.pressed.release_order().map(KeyCode::name).collect();
        if !stuck.is_empty() {
            let _ = self.status.stuck_keys.set(stuck.join(", "));
            self.reporter.abandon_file();
        }
    }

    /// Returns the time until the next heartbeat or check is due.
    fn poll_timeout(&self) -> Duration {
        if self.watchdog.is_some() && self.is_active(Instant::now()) {
            HEARTBEAT_INTERVAL.saturating_sub(self.liveness.last_heartbeat.elapsed())
        } else {
            CHECK_INTERVAL
        }
    }

    /// Returns `true` if a key is pressed, or something was requested a short time ago.
    fn is_active(&self, now: Instant) -> bool {
        !self.pressed.is_empty() || now - self.liveness.last_request < ACTIVE_TIME
    }

    /// Fails if the display is gone, which otherwise shows only at the next request, and follows the field.
    fn check_connection(&mut self) {
        if self.status.failure.get().is_some() {
            return;
        }
        if let Err(reason) = self.injector.check_connection() {
            return self.fail(&reason);
        }
        let is_other = self.focus.update_from_answer(self.injector.poll_focus());
        self.status.update_field(is_other, &mut *self.injector);
    }

    /// Updates the window that has the focus, and the generation of the field.
    fn follow_focus(&mut self, window: Option<WindowId>) {
        let is_other = self.focus.set(window);
        self.status.update_field(is_other, &mut *self.injector);
    }

    /// Sends a heartbeat every 50 ms, unless the loop hangs: then releases every key.
    fn send_heartbeat_if_due(&mut self) {
        let now = Instant::now();
        let is_due = now - self.liveness.last_heartbeat >= HEARTBEAT_INTERVAL;
        if self.watchdog.is_none() || !is_due || !self.is_active(now) {
            return;
        }
        self.liveness.last_heartbeat = now;
        let calls = self.status.loop_calls.load(Ordering::Relaxed);
        let is_key_pressed = !self.pressed.is_empty();
        if self.liveness.loop_monitor.check(calls, is_key_pressed) {
            // The loop finds that the output has stalled if it continues. If a release fails, the watchdog follows.
            self.status.tickets.void();
            self.release_all();
        } else if let Some(watchdog) = &mut self.watchdog {
            self.is_watchdog_lost |= watchdog.send_heartbeat().is_err();
        }
    }

    /// Releases every key and restarts the watchdog. Returns the channel that closes when the new one exits.
    fn restart_watchdog(&mut self) -> Receiver<()> {
        self.status.tickets.void();
        // The loop reports its presses to the lost watchdog.
        self.direct.close();
        self.release_all();
        // The lost watchdog did not accept the reports of these releases.
        self.is_watchdog_lost = false;
        let Some(watchdog) = &mut self.watchdog else {
            return never();
        };
        match watchdog.restart() {
            Ok(()) => {
                let exited = watchdog.exited().clone();
                self.reporter.set_watchdog(self.watchdog.as_ref());
                self.direct
                    .open(|| self.injector.open_direct_connection(), &self.reporter);
                exited
            }
            Err(reason) => {
                self.watchdog = None;
                self.reporter.set_watchdog(None);
                self.fail(&reason);
                never()
            }
        }
    }

    /// Reports a key to the watchdog. Returns `false` if it did not accept the report.
    fn report_key(&mut self, key: KeyCode, direction: KeyDirection) -> bool {
        let is_accepted = self.reporter.report(key, direction);
        self.is_watchdog_lost |= !is_accepted;
        is_accepted
    }

    fn execute(&mut self, request: WorkerRequest) {
        match request {
            WorkerRequest::Release(key) => self.release(key),
            WorkerRequest::Confirm(key, direction, connection, ticket) => {
                self.confirm(key, direction, connection, ticket);
            }
            _ if self.status.failure.get().is_some() => {}
            WorkerRequest::Press(key, ticket) => {
                if !self.may_send(ticket, 1) {
                    return;
                }
                // The watchdog could not release a key that it does not know.
                if !self.report_key(key, KeyDirection::Press) {
                    self.drop_presses(ticket, 1);
                } else {
                    // Added first: a press that failed may have arrived.
                    self.pressed.press(key);
                    self.inject(key, KeyDirection::Press);
                    self.refresh_direct_connection();
                }
            }
            WorkerRequest::Stroke {
                stroke,
                is_last,
                ticket,
                field,
            } => {
                self.burst.push(stroke);
                if is_last {
                    self.type_burst(ticket, field);
                }
            }
            #[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
            WorkerRequest::Compose(composing, ticket) => self.compose(&composing, ticket),
            WorkerRequest::Perform(action, ticket) => self.perform(action, ticket),
        }
    }

    /// Waits until the display has executed a key event that the loop has written. If it does not, a press is revoked, and
    /// the key released on the connection of this thread: the event may have arrived.
    fn confirm(
        &mut self,
        key: KeyCode,
        direction: KeyDirection,
        connection: ConnectionNumber,
        ticket: PressTicket,
    ) {
        let is_press = direction == KeyDirection::Press;
        if is_press {
            self.pressed.press(key);
        }
        let deadline = self.status.tickets.deadline(ticket);
        let is_executed = self.direct.wait(connection, deadline);
        if is_executed {
            self.follow_focus(self.direct.focus());
        }
        if is_executed && !is_press {
            self.pressed.release(key);
            self.report_key(key, direction);
        }
        if !is_executed {
            if is_press {
                self.drop_presses(ticket, 1);
            }
            self.release(key);
            self.refresh_direct_connection();
        }
    }

    /// Executes the burst if its ticket is valid, and drops it if it was not executed. It is not repeated, as a burst that failed
    /// may have arrived.
    fn type_burst(&mut self, ticket: PressTicket, field: u32) {
        let burst = std::mem::take(&mut self.burst);
        let count = burst::count_presses(&burst) as u64;
        if !self.may_send(ticket, count) {
            return;
        }
        let is_elsewhere = self.status.field.load(Ordering::Acquire) != field;
        if is_elsewhere && burst::replaces(&burst) {
            return self.drop_presses(ticket, count);
        }
        let executed = if self.report_presses(&burst) {
            self.injector.type_burst(&burst, &mut self.reporter)
        } else {
            Ok(false)
        };
        match executed {
            // Its keys may be down, and are released at the end.
            Err(reason) => self.fail(&reason),
            Ok(is_executed) => {
                self.report_releases(&burst, is_executed);
                if !is_executed {
                    self.drop_presses(ticket, count);
                }
            }
        }
        // A change of the keymap is sent to every connection.
        self.refresh_direct_connection();
    }

    /// Reports the keys of a burst before it is executed. Returns `false` if the watchdog did not accept a report: it could not
    /// release a key that it does not know.
    fn report_presses(&mut self, burst: &[Stroke]) -> bool {
        let mut keys = burst.iter().filter_map(Stroke::pressed_key);
        // Added first: a burst that failed may have arrived.
        keys.all(|key| !self.pressed.press(key) || self.report_key(key, KeyDirection::Press))
    }

    /// Reports that the reported keys of a burst are up, but for those that it leaves down, if it was executed.
    fn report_releases(&mut self, burst: &[Stroke], is_executed: bool) {
        for key in burst.iter().filter_map(Stroke::pressed_key) {
            let is_down = is_executed && burst::leaves_down(burst, key);
            if !is_down && self.pressed.release(key) {
                self.report_key(key, KeyDirection::Release);
            }
        }
    }

    /// Sends text to the focused field if its ticket is valid, and drops it if the field has none of it. It is not repeated, as a
    /// text that failed may have arrived.
    #[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
    fn compose(&mut self, composing: &Composing, ticket: PressTicket) {
        let count = composing.characters() as u64;
        // The display has executed the keys before it by then.
        if !self.may_send(ticket, count) {
            return;
        }
        match self.injector.compose(composing) {
            // A word that is shown is typed again later.
            Ok(false) if count > 0 => self.drop_presses(ticket, count),
            Ok(_) => {}
            Err(reason) => self.fail(&reason),
        }
    }

    fn refresh_direct_connection(&mut self) {
        let connect = || self.injector.open_direct_connection();
        self.direct.refresh(connect, &self.reporter);
    }

    /// Returns `true` if this number of presses or characters may be sent, and counts them as dropped otherwise.
    fn may_send(&mut self, ticket: PressTicket, count: u64) -> bool {
        if !self.wait_for_display(ticket) {
            return false;
        }
        let is_valid = self.wait_for_watchdog(ticket) && self.status.tickets.is_valid(ticket);
        if !is_valid {
            self.drop_presses(ticket, count);
        }
        is_valid
    }

    /// Waits until the display responds, unless the ticket is void: a display that hangs executes a press when it continues,
    /// however late that is. Returns `false` if the connection has failed.
    fn wait_for_display(&mut self, ticket: PressTicket) -> bool {
        if !self.status.tickets.is_valid(ticket) {
            return true;
        }
        match self.injector.wait_until_responsive() {
            Ok(()) => self.follow_focus(self.injector.focus()),
            Err(reason) => {
                self.fail(&reason);
                return false;
            }
        }
        true
    }

    /// Waits until the watchdog has replied, unless it has a short time ago: it may be stopped, or have released keys. Returns
    /// `false` if it does not while the press is valid.
    fn wait_for_watchdog(&mut self, ticket: PressTicket) -> bool {
        let tickets = &self.status.tickets;
        let Some(watchdog) = self.watchdog.as_mut().filter(|_| tickets.is_valid(ticket)) else {
            return true;
        };
        let deadline = tickets.deadline(ticket).min(Instant::now() + MAX_PRESS_AGE);
        match watchdog.wait_for_fresh_reply(deadline) {
            Ok(has_reply) => has_reply,
            Err(_) => {
                self.is_watchdog_lost = true;
                false
            }
        }
    }

    /// Counts dropped presses or characters. Those that follow are dropped too, until the loop has noticed.
    fn drop_presses(&self, ticket: PressTicket, count: u64) {
        self.status.void_presses.fetch_add(count, Ordering::Relaxed);
        self.status.tickets.void_with(ticket);
    }

    /// Performs an action if its ticket is valid. It is not repeated, as one that failed may have arrived. Late motion of the pointer
    /// is performed, too: a click after it may be in time, and relies on its position.
    fn perform(&mut self, action: StatelessAction, ticket: PressTicket) {
        let is_wheel = matches!(action, StatelessAction::Scroll(..));
        let is_valid = if is_wheel {
            self.wait_for_display(ticket) && self.status.tickets.is_valid(ticket)
        } else {
            self.status.tickets.is_current(ticket)
        };
        if !is_valid {
            return;
        }
        if let Err(reason) = self.injector.perform(action) {
            self.fail(&reason);
        }
    }

    /// Records a failure; only the first is kept.
    fn fail(&self, reason: &str) {
        let _ = self.status.failure.set(reason.into());
    }

    fn release(&mut self, key: KeyCode) {
        if self.pressed.contains(key) && self.inject(key, KeyDirection::Release) {
            self.pressed.release(key);
            self.report_key(key, KeyDirection::Release);
        }
    }

    fn release_all(&mut self) {
        for key in self.pressed.clone().release_order() {
            self.release(key);
        }
    }

    /// Injects a key with retries and returns `true` if the display accepted it. After a failure there are no more
    /// retries, so that releasing all keys stays within the close timeout.
    fn inject(&mut self, key: KeyCode, direction: KeyDirection) -> bool {
        let retries = match self.status.failure.get() {
            None => RETRIES,
            Some(_) => 0,
        };
        let mut result = self.injector.inject(key, direction);
        for _ in 0..retries {
            if result.is_ok() {
                break;
            }
            thread::sleep(RETRY_DELAY);
            result = self.injector.inject(key, direction);
        }
        if let Err(reason) = &result {
            self.fail(reason);
        }
        result.is_ok()
    }
}
