//! The thread that writes the feedback of one glove.

use std::io;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, bounded, select};

use crate::capture::Haptics;
use crate::capture::feedback::{
    ConnectionId, Feedback, FeedbackConnection, FeedbackDevice, FeedbackFormat, Pulse,
};
use crate::session::latest::LatestSender;
use ademan_core::hand::Finger;
use ademan_core::time::NO_DEADLINE;

/// Shortest time between two messages. A message that frees all fingers does not wait.
const MIN_INTERVAL: Duration = Duration::from_millis(20);

/// Time until a message that the device has not read is written again.
const RETRY_INTERVAL: Duration = Duration::from_millis(100);

/// Longest time that a finger is held, whatever the others do: a servo that holds becomes hot, and the loop may hang.
const MAX_HOLD: Duration = Duration::from_secs(2);

/// Longest time for the last message.
const END_TIMEOUT: Duration = Duration::from_millis(200);

/// The forces of free fingers.
const NO_FORCE: [f32; Finger::COUNT] = [0.0; Finger::COUNT];

/// The feedback of a glove.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FeedbackState {
    /// Force of each finger, as in [`Feedback`].
    pub forces: [f32; Finger::COUNT],
    /// The latest pulse.
    pulse: Pulse,
    /// Number of pulses so far, to recognize a new pulse that equals the last one.
    pulses: u32,
}

impl FeedbackState {
    /// Starts a pulse. Of several in one step the strongest counts, which is the last one.
    pub fn start_pulse(&mut self, pulse: Pulse) {
        self.pulse = pulse;
        self.pulses = self.pulses.wrapping_add(1);
    }

    /// Frees a finger, and ends a pulse.
    pub fn release_finger(&mut self, finger: Finger) {
        self.forces[finger.index()] = 0.0;
        self.pulse = Pulse::Off;
    }

    /// Frees all fingers, and ends a pulse.
    pub fn release(&mut self) {
        self.forces = NO_FORCE;
        self.pulse = Pulse::Off;
    }

    fn is_released(&self) -> bool {
        self.forces == NO_FORCE && self.pulse == Pulse::Off
    }
}

/// The thread of a glove. Dropping it frees all fingers, and waits for that for at most 0.2 s.
pub(super) struct FeedbackThread {
    /// `None` once all fingers are freed for the last time.
    states: Option<LatestSender<FeedbackState>>,
    /// Disconnected when the thread has ended.
    ended: Receiver<()>,
}

impl FeedbackThread {
    /// Starts the thread, which frees all fingers.
    pub fn start(haptics: Haptics, device: FeedbackDevice) -> io::Result<Self> {
        let (states, receiver) = LatestSender::new();
        let (end, ended) = bounded::<()>(0);
        let mut writer = FeedbackWriter::new(haptics, device);
        thread::Builder::new()
            .name("haptics".into())
            .spawn(move || {
                let _disconnects_at_the_end = end;
                writer.run(&receiver);
            })?;
        Ok(Self {
            states: Some(states),
            ended,
        })
    }

    /// Sends a new state. Does not wait.
    pub fn send(&self, state: FeedbackState) {
        if let Some(states) = &self.states {
            states.send(state);
        }
    }

    /// Frees all fingers without waiting for that, and ends the thread.
    pub fn release(&mut self) {
        self.states = None;
    }
}

impl Drop for FeedbackThread {
    fn drop(&mut self) {
        self.release();
        let _ = self.ended.recv_timeout(END_TIMEOUT);
    }
}

/// The force that holds a finger, and the time since which it does.
#[derive(Clone, Copy)]
struct Hold {
    force: f32,
    since: Instant,
}

/// The writing side.
struct FeedbackWriter {
    haptics: Haptics,
    device: FeedbackDevice,
    /// The latest state, in which fingers that were held for [`MAX_HOLD`] are free.
    wanted: FeedbackState,
    /// The hold of each finger in the latest state, also after it has ended.
    holds: [Option<Hold>; Finger::COUNT],
    /// The state that the present connection has received; `None` if that is not known.
    sent: Option<FeedbackState>,
    attempted_at: Option<Instant>,
    /// The connection of the latest message.
    last_connection: ConnectionId,
    /// The form of that message.
    last_format: &'static FeedbackFormat,
    /// The rest of that message, which the device has not accepted yet.
    rest: Vec<u8>,
}

impl FeedbackWriter {
    fn new(haptics: Haptics, device: FeedbackDevice) -> Self {
        Self {
            haptics,
            last_format: device.format(),
            device,
            wanted: FeedbackState::default(),
            holds: [None; Finger::COUNT],
            sent: None,
            attempted_at: None,
            last_connection: ConnectionId::default(),
            rest: Vec::new(),
        }
    }

    fn run(&mut self, states: &Receiver<FeedbackState>) {
        let changes = self.device.changes().clone();
        loop {
            let timeout = self.update();
            select! {
                recv(states) -> state => match state {
                    Ok(state) => self.want(state, Instant::now()),
                    Err(_) => break,
                },
                recv(changes) -> _ => {}
                default(timeout) => {}
            }
        }
        self.end();
    }

    /// Applies a new state. A finger whose force has not changed is held as before.
    fn want(&mut self, state: FeedbackState, now: Instant) {
        for (hold, &force) in self.holds.iter_mut().zip(&state.forces) {
            if !hold.is_some_and(|it| it.force == force) {
                *hold = (force > 0.0).then_some(Hold { force, since: now });
            }
        }
        self.wanted = state;
    }

    /// Frees the fingers that were held for [`MAX_HOLD`]. Returns the time until the next one is free.
    fn end_holds(&mut self, now: Instant) -> Duration {
        let mut next = NO_DEADLINE;
        for (hold, force) in self.holds.iter().zip(&mut self.wanted.forces) {
            let Some(hold) = hold else { continue };
            let left = MAX_HOLD.saturating_sub(now.saturating_duration_since(hold.since));
            if left.is_zero() {
                *force = 0.0;
            } else {
                next = next.min(left);
            }
        }
        next
    }

    /// Writes the wanted state if it is due. Returns the time until the next attempt.
    fn update(&mut self) -> Duration {
        let now = Instant::now();
        let next_end = self.end_holds(now);
        let Some(connection) = self.connection() else {
            return NO_DEADLINE;
        };
        if self.sent != Some(self.wanted) {
            let wait = self.time_to_message(now);
            if !wait.is_zero() {
                return wait;
            }
            self.attempted_at = Some(now);
            if !self.write(&connection) {
                return RETRY_INTERVAL;
            }
        }
        next_end
    }

    /// Returns the time until a message may be written.
    fn time_to_message(&self, now: Instant) -> Duration {
        let interval = match &self.sent {
            Some(_) if self.wanted.is_released() => Duration::ZERO,
            Some(_) => MIN_INTERVAL,
            None => RETRY_INTERVAL,
        };
        self.attempted_at.map_or(Duration::ZERO, |last| {
            interval.saturating_sub(now.saturating_duration_since(last))
        })
    }

    /// Returns the present connection. Forgets what an earlier one has received, and what was sent in another form.
    fn connection(&mut self) -> Option<FeedbackConnection> {
        let connection = self.device.connection()?;
        let id = connection.id();
        if id != self.last_connection {
            self.last_connection = id;
            self.attempted_at = None;
            self.sent = None;
            self.rest.clear();
        }
        let format = self.device.format();
        if !std::ptr::eq(format, self.last_format) {
            self.last_format = format;
            self.sent = None;
        }
        Some(connection)
    }

    /// Writes the rest of the last message, then the wanted state. Returns `false` if the device does not read.
    fn write(&mut self, connection: &FeedbackConnection) -> bool {
        let message = self.message();
        self.sent = None;
        if !self.flush(connection) {
            return false;
        }
        (self.last_format.encode)(&message, &mut self.rest);
        let length = self.rest.len();
        let is_written = self.flush(connection);
        self.sent = is_written.then_some(self.wanted);
        if self.rest.len() == length {
            // None of it was written, so that a newer message may replace it.
            self.rest.clear();
        }
        is_written
    }

    fn flush(&mut self, connection: &FeedbackConnection) -> bool {
        let written = connection.write(&self.rest);
        self.rest.drain(..written);
        self.rest.is_empty()
    }

    fn message(&self) -> Feedback {
        let wanted = &self.wanted;
        let is_new_pulse = self
            .sent
            .is_none_or(|sent| (sent.pulse, sent.pulses) != (wanted.pulse, wanted.pulses));
        let is_pulse = self.haptics.has_pulses() && is_new_pulse;
        Feedback {
            forces: self.haptics.has_force().then_some(wanted.forces),
            pulse: is_pulse.then_some(wanted.pulse),
        }
    }

    /// Frees all fingers.
    fn end(&mut self) {
        let deadline = Instant::now() + END_TIMEOUT;
        self.wanted.release();
        while let Some(connection) = self.connection()
            && self.sent != Some(self.wanted)
            && Instant::now() < deadline
            && !self.write(&connection)
        {
            thread::sleep(MIN_INTERVAL);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static FORMAT: FeedbackFormat = FeedbackFormat {
        curl: |_, _| None,
        encode: |_, _| {},
    };

    #[test]
    fn a_finger_is_freed_in_time_although_the_others_go_on_typing() {
        let mut writer = FeedbackWriter::new(Haptics::Both, FeedbackDevice::new(&FORMAT));
        let (index, little) = (Finger::Index.index(), Finger::Little.index());
        let start = Instant::now();
        let at = |millis| start + Duration::from_millis(millis);
        let mut state = FeedbackState::default();
        state.forces[little] = 0.5;
        let mut freed_at = None;
        for millis in (0..5_000).step_by(100) {
            state.start_pulse(Pulse::Press);
            state.forces[index] = if millis % 200 == 0 { 0.7 } else { 0.0 };
            writer.want(state, at(millis));
            writer.end_holds(at(millis));
            assert_eq!(writer.wanted.forces[index], state.forces[index]);
            if writer.wanted.forces[little] == 0.0 {
                freed_at = freed_at.or(Some(millis));
            }
        }
        assert_eq!(freed_at, Some(2_000));
        assert_eq!(writer.wanted.forces[little], 0.0, "it stays free");
        state.forces[little] = 0.0;
        writer.want(state, at(5_000));
        // The next press.
        state.forces[little] = 0.5;
        writer.want(state, at(5_100));
        assert_eq!(writer.end_holds(at(5_600)), Duration::from_millis(1_500));
        assert_eq!(writer.wanted.forces[little], 0.5);
    }
}
