//! Notifications of pauses, losses and their ends (`org.freedesktop.Notifications`), each in place of the previous notification.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use zbus::blocking::Connection;
use zbus::zvariant::Value;

use super::super::TrayState;
use super::words::{Condition, condition, heading, sentence};

pub const SERVICE: &str = "org.freedesktop.Notifications";
const PATH: &str = "/org/freedesktop/Notifications";

/// The shortest time between two notifications. Only the last state in that time is shown.
const MIN_PERIOD: Duration = Duration::from_secs(2);

/// Levels of the hint `urgency`.
const LOW: u8 = 0;
const NORMAL: u8 = 1;

/// The time after which the desktop hides a notification; −1 for its own default.
const DEFAULT_TIMEOUT: i32 = -1;

/// The id of the notification on the screen, 0 for none. KDE Plasma shows nothing in place of one that was closed.
#[derive(Clone, Debug, Default)]
pub struct ShownId(Arc<AtomicU32>);

impl ShownId {
    /// Notes that a notification was closed.
    pub fn close(&self, id: u32) {
        let _ = self
            .0
            .compare_exchange(id, 0, Ordering::Relaxed, Ordering::Relaxed);
    }

    /// Forgets the notification: another program shows them now, and counts by itself.
    pub fn forget(&self) {
        self.0.store(0, Ordering::Relaxed);
    }
}

pub struct Notifications {
    connection: Connection,
    pace: Pace,
    shown: ShownId,
    has_failed: bool,
}

impl Notifications {
    pub fn new(connection: &Connection, shown: ShownId) -> Self {
        Self {
            connection: connection.clone(),
            pace: Pace::default(),
            shown,
            has_failed: false,
        }
    }

    /// Sets the present state.
    pub fn push(&mut self, state: TrayState) {
        self.pace.push(state);
    }

    /// Returns the time of the next notification, if one waits.
    pub fn due(&self) -> Option<Instant> {
        self.pace.due()
    }

    /// Sends a notification if one is due. Of all errors, only the first one is returned.
    pub fn send(&mut self, now: Instant) -> Result<(), String> {
        let Some(state) = self.pace.take(now) else {
            return Ok(());
        };
        match self.notify(&state) {
            Ok(id) => {
                self.shown.0.store(id, Ordering::Relaxed);
                Ok(())
            }
            Err(_) if std::mem::replace(&mut self.has_failed, true) => Ok(()),
            Err(error) => Err(format!("no notification is shown: {error}")),
        }
    }

    fn notify(&self, state: &TrayState) -> zbus::Result<u32> {
        // GNOME shows no banner for a low urgency.
        let needs_attention = matches!(condition(state), Condition::Paused | Condition::Lost);
        let urgency = if needs_attention { NORMAL } else { LOW };
        let hints = HashMap::from([
            ("urgency", Value::from(urgency)),
            ("transient", Value::from(true)),
            ("desktop-entry", Value::from("ademan")),
        ]);
        let actions: Vec<&str> = Vec::new();
        let body = (
            "Ademán",
            self.shown.0.load(Ordering::Relaxed),
            super::icon::name(state),
            heading(state),
            sentence(state),
            actions,
            hints,
            DEFAULT_TIMEOUT,
        );
        let reply =
            self.connection
                .call_method(Some(SERVICE), PATH, Some(SERVICE), "Notify", &body)?;
        reply.body().deserialize()
    }
}

/// Chooses the states that are shown, and their times.
#[derive(Default)]
struct Pace {
    /// The last state that a person has to know; at the start an armed run, which needs no notification.
    state: Option<TrayState>,
    shown: Option<TrayState>,
    last_taken: Option<Instant>,
}

impl Pace {
    fn push(&mut self, state: TrayState) {
        match condition(&state) {
            Condition::Waiting => {}
            Condition::Armed if self.state.is_none() => {
                (self.state, self.shown) = (Some(state), Some(state));
            }
            _ => self.state = Some(state),
        }
    }

    fn due(&self) -> Option<Instant> {
        self.waiting()?;
        Some(self.last_taken? + MIN_PERIOD)
    }

    /// Returns the latest state if its text differs from the text that is shown.
    fn waiting(&self) -> Option<TrayState> {
        let words = |state: &TrayState| (heading(state), sentence(state));
        let state = self.state?;
        (self.shown.as_ref().map(words) != Some(words(&state))).then_some(state)
    }

    /// Returns the state to show, if one is due.
    fn take(&mut self, now: Instant) -> Option<TrayState> {
        let state = self.waiting()?;
        if self.last_taken.is_some_and(|last| now < last + MIN_PERIOD) {
            return None;
        }
        (self.shown, self.last_taken) = (Some(state), Some(now));
        Some(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::command::CommandOrigin;
    use ademan_core::pipeline::PipelineState;

    const ARMED: TrayState = TrayState {
        state: PipelineState::Running,
        ..TrayState::STARTING
    };
    const DISARMED: TrayState = TrayState {
        state: PipelineState::Paused,
        ..TrayState::STARTING
    };
    const PAUSED: TrayState = TrayState {
        paused_by: Some(CommandOrigin::Client),
        ..DISARMED
    };
    const STALLED: TrayState = TrayState {
        state: PipelineState::Stalled,
        ..TrayState::STARTING
    };

    #[test]
    fn the_first_arming_is_not_shown_and_of_a_burst_the_last_state_is() {
        let mut pace = Pace::default();
        let start = Instant::now();
        for state in [TrayState::STARTING, DISARMED, ARMED] {
            pace.push(state);
            assert_eq!(pace.take(start), None, "{state:?}");
        }
        pace.push(PAUSED);
        assert_eq!(pace.take(start), Some(PAUSED));
        assert_eq!((pace.take(start), pace.due()), (None, None));
        let (soon, later) = (start + MIN_PERIOD / 2, start + MIN_PERIOD);
        for state in [DISARMED, ARMED, PAUSED, ARMED, STALLED] {
            pace.push(state);
            assert_eq!(pace.take(soon), None, "{state:?}");
        }
        assert_eq!(pace.due(), Some(later));
        assert_eq!(pace.take(later), Some(STALLED));
    }

    #[test]
    fn a_burst_that_ends_as_it_began_shows_nothing() {
        let mut pace = Pace::default();
        let start = Instant::now();
        pace.push(PAUSED);
        assert_eq!(pace.take(start), Some(PAUSED));
        for state in [ARMED, STALLED, DISARMED, PAUSED] {
            pace.push(state);
        }
        assert_eq!(
            (pace.take(start + 2 * MIN_PERIOD), pace.due()),
            (None, None)
        );
    }

    #[test]
    fn another_profile_is_no_news() {
        let mut pace = Pace::default();
        pace.push(ARMED);
        pace.push(TrayState {
            profile: 1,
            ..ARMED
        });
        assert_eq!(pace.take(Instant::now()), None);
    }
}
