//! The output gate: the last check of events before they leave the pipeline.
//!
//! It suppresses presses of keys that are down and releases of keys that are not, events that the role of the source does not
//! permit, presses beyond the rate limit, and keys that act on the system. It never suppresses the release of a pressed key.
//!
//! Some keys act on the system only together with Control and Alt. The gate never lets all three be down, in any order
//! and from any controls: a press of such a key is suppressed while Control and Alt are down,
//! and a press of the missing modifier releases such a key first. The modifier itself is not suppressed, because a
//! control may hold it for long, and later keys must not act without it.

use super::permissions::{EventClass, SourcePermissions, SourceRole};
use super::rate_limit::TokenBucket;
use super::release_order::move_releases_first;
use super::{PressRateLimit, Suppressed};
use crate::device::pressed_keys::PressedKeys;
use crate::device::{EventKind, Events, KeyCode, OutputEvent};
use crate::hand::Side;
use crate::time::Timestamp;

/// The permissions of a source and its remaining presses.
#[derive(Clone, Copy, Debug)]
struct SourceState {
    role: SourceRole,
    configured_role: SourceRole,
    bucket: TokenBucket,
}

impl SourceState {
    fn new(permissions: SourcePermissions) -> Self {
        Self {
            role: permissions.role,
            configured_role: permissions.role,
            bucket: TokenBucket::new(permissions.rate_limit),
        }
    }
}

/// The gate that every event passes.
#[derive(Clone, Debug)]
pub(super) struct OutputGate {
    /// One or two sources. If both hands share one, the last entry stands for both.
    sources: Vec<SourceState>,
    allow_system_keys: bool,
    pressed: PressedKeys,
    /// The keys whose press the last call of [`filter`](Self::filter) suppressed, or that it released early.
    suppressed_keys: PressedKeys,
    /// The keys whose release has not fitted into a list of events yet.
    overdue: PressedKeys,
    suppressed: Suppressed,
}

impl OutputGate {
    /// Creates a gate for one source. System keys are the keys of [`KeyCode::is_system_key`], and keys that act on
    /// the system together with Control and Alt.
    pub(super) fn new(permissions: SourcePermissions, allow_system_keys: bool) -> Self {
        Self {
            sources: vec![SourceState::new(permissions)],
            allow_system_keys,
            pressed: PressedKeys::default(),
            suppressed_keys: PressedKeys::default(),
            overdue: PressedKeys::default(),
            suppressed: Suppressed::default(),
        }
    }

    /// Adds a source; its index is the number of sources before it.
    pub(super) fn add_source(&mut self, permissions: SourcePermissions) {
        self.sources.push(SourceState::new(permissions));
    }

    /// Removes forbidden events from `events`, starting at index `first`. `hand_of` returns the index of the hand that causes a press or
    /// another event, whose source must permit it. Presses and characters that a filter `added` do not count against the rate limit.
    /// Returns for each hand `false` if it exceeded its rate limit; the caller must then release what it holds.
    pub(super) fn filter(
        &mut self,
        hand_of: impl Fn(EventKind) -> usize,
        first: usize,
        mut added: usize,
        events: &mut Events,
    ) -> [bool; Side::COUNT] {
        self.suppressed_keys = PressedKeys::default();
        let mut is_within_limit = [true; Side::COUNT];
        let (mut index, mut kept) = (first, first);
        let mut last_character = None;
        let mut has_early_release = false;
        while index < events.len() {
            let event = events[index];
            let hand = hand_of(event.kind).min(Side::COUNT - 1);
            let source = hand.min(self.sources.len() - 1);
            if self.insert_early_release(source, index, events) {
                // The next turn handles the release, a later one the press after it.
                has_early_release = true;
                continue;
            }
            index += 1;
            let is_added = added > 0 && event.kind.is_press();
            added -= usize::from(is_added);
            let is_allowed = match event.kind {
                EventKind::KeyUp(key) => self.pressed.release(key),
                EventKind::KeyDown(key) if self.pressed.contains(key) => false,
                kind if !self.check_role(source, kind) => false,
                EventKind::KeyDown(key) if self.is_forbidden_system_key(key) => {
                    self.suppressed.system_keys += 1;
                    false
                }
                _ if is_added => is_within_limit[hand],
                // The characters of one key have one time stamp and count as one press.
                EventKind::Character(_)
                    if is_within_limit[hand] && last_character == Some(event.time) =>
                {
                    true
                }
                EventKind::KeyDown(_) | EventKind::Character(_) => {
                    let is_allowed = is_within_limit[hand] && self.take_press(source, event.time);
                    self.suppressed.rate_limited += u64::from(!is_allowed);
                    is_within_limit[hand] &= is_allowed;
                    is_allowed
                }
                _ => true,
            };
            match event.kind {
                EventKind::KeyDown(key) if is_allowed => _ = self.pressed.press(key),
                EventKind::KeyDown(key) => _ = self.suppressed_keys.press(key),
                EventKind::Character(_) if !is_added => last_character = Some(event.time),
                _ => {}
            }
            if is_allowed {
                events[kept] = event;
                kept += 1;
            }
        }
        events.truncate(kept);
        if has_early_release {
            move_releases_first(&mut events[first..]);
        }
        is_within_limit
    }

    /// Releases every key that is down. A release for which `events` has no room is left to
    /// [`release_overdue`](Self::release_overdue).
    pub(super) fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        self.overdue.clone_from(&self.pressed);
        self.release_overdue(time, events);
    }

    /// Releases the keys that [`release_all`](Self::release_all) could not release, as far as `events` has room. No device
    /// holds these keys any more, so no device releases them.
    pub(super) fn release_overdue(&mut self, time: Timestamp, events: &mut Events) {
        let next = |keys: &PressedKeys| keys.release_order().next();
        while let Some(key) = next(&self.overdue) {
            let kind = EventKind::KeyUp(key);
            if self.pressed.contains(key) && events.try_push(OutputEvent { time, kind }).is_err() {
                return;
            }
            self.pressed.release(key);
            self.overdue.release(key);
        }
    }

    /// Iterates over the keys that are up because the last call of [`filter`](Self::filter) suppressed their press or released them
    /// early.
    pub(super) fn suppressed_keys(&self) -> impl Iterator<Item = KeyCode> + '_ {
        let keys = self.suppressed_keys.release_order();
        keys.filter(|&key| !self.pressed.contains(key))
    }

    /// Changes the role of all sources. Everything must have been released before.
    pub(super) fn set_role(&mut self, role: SourceRole) {
        for source in &mut self.sources {
            source.role = role;
        }
    }

    /// Returns `true` if a source may cause more than its configured role permits.
    pub(super) fn exceeds_configured_roles(&self) -> bool {
        let exceeds = |source: &SourceState| {
            source.role == SourceRole::Both && source.role != source.configured_role
        };
        self.sources.iter().any(exceeds)
    }

    /// Returns all sources to their configured roles. Everything must have been released before.
    pub(super) fn restore_roles(&mut self) {
        for source in &mut self.sources {
            source.role = source.configured_role;
        }
    }

    /// Returns `true` if a source may cause keys.
    pub(super) fn allows_keys(&self, source: usize) -> bool {
        let last = self.sources.len() - 1;
        self.sources[source.min(last)].role.allows_keys()
    }

    /// Returns the rate limit of a source.
    pub(super) fn rate_limit(&self, source: usize) -> PressRateLimit {
        let last = self.sources.len() - 1;
        self.sources[source.min(last)].bucket.limit()
    }

    /// Counts key presses that a device dropped because of the role of a source.
    pub(super) fn add_suppressed_keys(&mut self, count: u64) {
        self.suppressed.keys_by_role += count;
    }

    /// Returns the numbers of suppressed events.
    pub(super) fn suppressed(&self) -> Suppressed {
        self.suppressed
    }

    /// Returns `true` if the role of the source permits an event, and counts it if not.
    fn check_role(&mut self, source: usize, kind: EventKind) -> bool {
        let Some(class) = EventClass::from_kind(kind) else {
            return true;
        };
        let is_allowed = self.sources[source].role.allows(class);
        let count = match class {
            EventClass::Keys => &mut self.suppressed.keys_by_role,
            EventClass::Pointing => &mut self.suppressed.pointing_by_role,
        };
        *count += u64::from(!is_allowed);
        is_allowed
    }

    fn take_press(&mut self, source: usize, time: Timestamp) -> bool {
        self.sources[source].bucket.try_take(time)
    }

    /// Returns `true` if a key may not be pressed because it acts on the system, alone or with the pressed keys.
    fn is_forbidden_system_key(&self, key: KeyCode) -> bool {
        !self.allow_system_keys && (key.is_system_key() || self.completes_system_chord(key))
    }

    /// Returns `true` if Control, Alt and a key that acts on the system with both would be down after a press.
    fn completes_system_chord(&self, key: KeyCode) -> bool {
        let is_down = |is_part: fn(KeyCode) -> bool| {
            is_part(key) || self.pressed.release_order().any(is_part)
        };
        is_down(KeyCode::is_control)
            && is_down(KeyCode::is_alt)
            && is_down(KeyCode::is_system_key_with_ctrl_alt)
    }

    /// Inserts, before the press of a modifier that would complete a system chord, the release of the key that acts on the
    /// system. Returns `false` if there is none to insert, or no room; then the modifier is suppressed.
    fn insert_early_release(&mut self, source: usize, index: usize, events: &mut Events) -> bool {
        let OutputEvent { time, kind } = events[index];
        let EventKind::KeyDown(key) = kind else {
            return false;
        };
        let completes_chord = !self.allow_system_keys && self.completes_system_chord(key);
        let is_suppressed = !key.is_modifier() || !self.sources[source].role.allows_keys();
        if !completes_chord || is_suppressed {
            return false;
        }
        let mut pressed = self.pressed.release_order();
        let Some(acting) = pressed.find(|held| held.is_system_key_with_ctrl_alt()) else {
            return false;
        };
        let release = OutputEvent {
            time,
            kind: EventKind::KeyUp(acting),
        };
        let is_inserted = events.try_insert(index, release).is_ok();
        if is_inserted {
            self.suppressed.system_keys += 1;
            self.suppressed_keys.press(acting);
        }
        is_inserted
    }
}

#[cfg(test)]
mod tests;
