//! The output gate: the last check of events before they leave the pipeline.
//!
//! It suppresses releases of keys that are not pressed, events that the role of the source does not permit, presses
//! beyond the rate limit, and keys that act on the system. It never suppresses the release of a pressed key.

use super::Suppressed;
use super::permissions::{EventClass, SourcePermissions, SourceRole};
use super::rate_limit::TokenBucket;
use crate::device::pressed_keys::PressedKeys;
use crate::device::{EventKind, Events, KeyCode};
use crate::time::Timestamp;

/// The permissions of a source and its remaining presses.
#[derive(Clone, Copy, Debug)]
struct SourceState {
    role: SourceRole,
    bucket: TokenBucket,
}

impl SourceState {
    fn new(permissions: SourcePermissions) -> Self {
        Self {
            role: permissions.role,
            bucket: TokenBucket::new(permissions.rate_limit),
        }
    }
}

/// The gate that every event passes.
#[derive(Clone, Debug)]
pub(super) struct OutputGate {
    /// One or two. If both hands share a source, the last entry stands for both.
    sources: Vec<SourceState>,
    allow_system_keys: bool,
    pressed: PressedKeys,
    suppressed: Suppressed,
}

impl OutputGate {
    /// Creates a gate for one source. System keys are those of [`KeyCode::is_system_key`], and keys that act on the
    /// system together with Control and Alt.
    pub(super) fn new(permissions: SourcePermissions, allow_system_keys: bool) -> Self {
        Self {
            sources: vec![SourceState::new(permissions)],
            allow_system_keys,
            pressed: PressedKeys::default(),
            suppressed: Suppressed::default(),
        }
    }

    /// Adds a source; its index is the number of sources before it.
    pub(super) fn add_source(&mut self, permissions: SourcePermissions) {
        self.sources.push(SourceState::new(permissions));
    }

    /// Removes forbidden events from `events`, starting at index `first`. Returns `false` if the rate limit was
    /// exceeded; the caller must then release everything.
    pub(super) fn filter(&mut self, source: usize, first: usize, events: &mut Events) -> bool {
        let source = source.min(self.sources.len() - 1);
        let mut is_within_limit = true;
        let mut kept = first;
        let mut last_character = None;
        for index in first..events.len() {
            let event = events[index];
            let is_allowed = match event.kind {
                EventKind::KeyUp(key) => self.pressed.release(key),
                kind if !self.check_role(source, kind) => false,
                EventKind::KeyDown(key) if self.is_forbidden_system_key(key) => {
                    self.suppressed.system_keys += 1;
                    false
                }
                // The characters of one key have one time stamp and count as one press.
                EventKind::Character(_)
                    if is_within_limit && last_character == Some(event.time) =>
                {
                    true
                }
                EventKind::KeyDown(_) | EventKind::Character(_) => {
                    let is_allowed = is_within_limit && self.take_press(source, event.time);
                    self.suppressed.rate_limited += u64::from(!is_allowed);
                    is_within_limit &= is_allowed;
                    is_allowed
                }
                _ => true,
            };
            match event.kind {
                EventKind::KeyDown(key) if is_allowed => _ = self.pressed.press(key),
                EventKind::Character(_) => last_character = Some(event.time),
                _ => {}
            }
            if is_allowed {
                events[kept] = event;
                kept += 1;
            }
        }
        events.truncate(kept);
        is_within_limit
    }

    /// Returns whether a source may cause keys.
    pub(super) fn allows_keys(&self, source: usize) -> bool {
        let last = self.sources.len() - 1;
        self.sources[source.min(last)].role.allows_keys()
    }

    /// Counts key presses that a device dropped because of the role of a source.
    pub(super) fn add_suppressed_keys(&mut self, count: u64) {
        self.suppressed.keys_by_role += count;
    }

    /// Returns the numbers of suppressed events.
    pub(super) fn suppressed(&self) -> Suppressed {
        self.suppressed
    }

    /// Returns whether the role of the source permits an event, and counts it if not.
    fn check_role(&mut self, source: usize, kind: EventKind) -> bool {
        let Some(class) = EventClass::of(kind) else {
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

    /// Returns whether a key acts on the system, together with the pressed modifiers, and may not.
    fn is_forbidden_system_key(&self, key: KeyCode) -> bool {
        if self.allow_system_keys {
            return false;
        }
        let is_pressed = |names: [&str; 2]| {
            let mut pressed = self.pressed.release_order();
            pressed.any(|key| names.contains(&key.name()))
        };
        key.is_system_key()
            || (key.is_system_key_with_ctrl_alt()
                && is_pressed(["ControlLeft", "ControlRight"])
                && is_pressed(["AltLeft", "AltRight"]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::PressRateLimit;
    use super::*;
    use crate::contact::TargetId;
    use crate::device::{Axis, OutputEvent};

    /// Parses an event: `down KEY`, `up KEY` or `write CHARACTER`.
    fn event(milliseconds: u64, line: &str) -> OutputEvent {
        let (verb, name) = line.split_once(' ').unwrap();
        let kind = match verb {
            "down" => EventKind::KeyDown(name.parse().unwrap()),
            "up" => EventKind::KeyUp(name.parse().unwrap()),
            "write" => EventKind::Character(name.chars().next().unwrap()),
            _ => panic!("{verb}"),
        };
        OutputEvent {
            time: Timestamp(milliseconds * 1_000),
            kind,
        }
    }

    fn filter(gate: &mut OutputGate, milliseconds: u64, lines: &[&str]) -> (bool, Vec<String>) {
        let mut events: Events = lines.iter().map(|line| event(milliseconds, line)).collect();
        let is_within_limit = gate.filter(0, 0, &mut events);
        let lines = events.iter().map(|event| match event.kind {
            EventKind::KeyDown(key) => format!("down {key}"),
            EventKind::KeyUp(key) => format!("up {key}"),
            EventKind::Character(character) => format!("write {character}"),
            _ => panic!("{event:?}"),
        });
        (is_within_limit, lines.collect())
    }

    fn permissions(role: SourceRole, per_second: u32) -> SourcePermissions {
        SourcePermissions {
            role,
            rate_limit: PressRateLimit { per_second },
        }
    }

    fn gate(per_second: u32) -> OutputGate {
        OutputGate::new(permissions(SourceRole::Both, per_second), false)
    }

    #[test]
    fn a_burst_of_half_a_second_passes_and_then_the_sustained_rate() {
        let mut gate = gate(20);
        let taps = |gate: &mut OutputGate, milliseconds, count: usize| {
            (0..count)
                .map(|_| filter(gate, milliseconds, &["down A", "up A"]))
                .filter(|(is_within_limit, _)| *is_within_limit)
                .count()
        };
        assert_eq!(taps(&mut gate, 1_000, 12), 10);
        assert_eq!(taps(&mut gate, 1_049, 1), 0);
        assert_eq!(taps(&mut gate, 1_050, 2), 1);
        assert_eq!(taps(&mut gate, 60_000, 12), 10);
        assert_eq!(gate.suppressed().rate_limited, 2 + 1 + 1 + 2);
    }

    #[test]
    fn the_release_of_a_suppressed_press_is_suppressed_and_no_other() {
        let mut gate = gate(2);
        let (is_within_limit, passed) = filter(&mut gate, 1, &["down A", "down B", "down C"]);
        assert_eq!(
            (is_within_limit, passed),
            (false, vec!["down A".to_owned()])
        );
        let (is_within_limit, passed) = filter(&mut gate, 1, &["up C", "up B", "up A", "up A"]);
        assert_eq!((is_within_limit, passed), (true, vec!["up A".to_owned()]));
    }

    #[test]
    fn the_text_of_one_key_counts_as_one_press() {
        let mut gate = gate(4);
        let hello: Vec<_> = "hello".chars().map(|c| format!("write {c}")).collect();
        let hello: Vec<_> = hello.iter().map(String::as_str).collect();
        assert_eq!(filter(&mut gate, 1, &hello).1.len(), 5);
        assert_eq!(filter(&mut gate, 2, &hello).1.len(), 5);
        let (is_within_limit, passed) = filter(&mut gate, 3, &hello);
        assert_eq!((is_within_limit, passed.len()), (false, 0));
    }

    #[test]
    fn system_keys_are_suppressed_unless_they_are_allowed() {
        let mut gate = gate(60);
        assert_eq!(filter(&mut gate, 1, &["down MetaLeft"]).1.len(), 0);
        assert_eq!(filter(&mut gate, 1, &["up MetaLeft"]).1.len(), 0);
        let chord = ["down ControlRight", "down F2", "up F2", "down AltLeft"];
        assert_eq!(filter(&mut gate, 1, &chord).1, chord);
        for key in ["F2", "Delete", "Backspace"] {
            let press = format!("down {key}");
            assert_eq!(filter(&mut gate, 1, &[&press]).1.len(), 0, "{key}");
        }
        assert_eq!(filter(&mut gate, 1, &["down A"]).1, ["down A"]);
        assert_eq!(gate.suppressed().system_keys, 4);
        let mut gate = OutputGate::new(SourcePermissions::LOCAL, true);
        assert_eq!(
            filter(&mut gate, 1, &["down MetaLeft"]).1,
            ["down MetaLeft"]
        );
    }

    #[test]
    fn each_source_has_its_own_rate_limit() {
        let mut gate = gate(2);
        gate.add_source(permissions(SourceRole::Both, 4));
        let mut tap = |source| {
            let mut events: Events = ["down A", "up A"]
                .map(|line| event(1, line))
                .into_iter()
                .collect();
            gate.filter(source, 0, &mut events)
        };
        let outcomes = [0, 0, 1, 1, 1].map(&mut tap);
        assert_eq!(outcomes, [true, false, true, true, false]);
    }

    /// Returns the events that pass for a source with this role, and the suppressed ones.
    fn filter_for(role: SourceRole, kinds: &[EventKind]) -> (Vec<EventKind>, Suppressed) {
        let permissions = SourcePermissions {
            role,
            ..SourcePermissions::LOCAL
        };
        let mut gate = OutputGate::new(permissions, false);
        let event = |&kind| OutputEvent {
            time: Timestamp(1),
            kind,
        };
        let mut events: Events = kinds.iter().map(event).collect();
        let is_within_limit = gate.filter(0, 0, &mut events);
        assert!(is_within_limit, "the role does not affect the rate limit");
        let passed = events.iter().map(|event| event.kind).collect();
        (passed, gate.suppressed())
    }

    #[test]
    fn a_pointer_source_presses_no_keys_and_a_key_source_does_not_point() {
        let code = |name: &str| name.parse().unwrap();
        let keys = [
            EventKind::KeyDown(code("A")),
            EventKind::KeyDown(code("ShiftLeft")),
            EventKind::Character('ñ'),
        ];
        let pointing = [
            EventKind::KeyDown(code("MouseLeft")),
            EventKind::KeyDown(code("PadSouth")),
            EventKind::MoveBy(3, -4),
            EventKind::MoveTo(0.5, 0.5),
            EventKind::Scroll(0, 120),
            EventKind::Axis(Axis::LeftX, 0.4),
        ];
        let all = [&keys[..], &pointing].concat();
        let suppressed = |keys_by_role, pointing_by_role| Suppressed {
            keys_by_role,
            pointing_by_role,
            ..Suppressed::default()
        };
        let (passed, count) = filter_for(SourceRole::Pointer, &all);
        assert_eq!((&passed[..], count), (&pointing[..], suppressed(3, 0)));
        let (passed, count) = filter_for(SourceRole::Keys, &all);
        assert_eq!((&passed[..], count), (&keys[..], suppressed(0, 6)));
        assert_eq!(filter_for(SourceRole::Both, &all), (all, suppressed(0, 0)));
    }

    #[test]
    fn reports_and_returns_to_zero_pass_for_every_role() {
        let target = TargetId(0);
        let kinds = [
            EventKind::Axis(Axis::MoveZ, 0.0),
            EventKind::Axis(Axis::MoveZ, -0.0),
            EventKind::Depth(target, 1.0),
            EventKind::Value(target, 1.0),
            EventKind::Select(target),
            EventKind::Unselect(target),
        ];
        for role in SourceRole::ALL {
            let none = Suppressed::default();
            assert_eq!(filter_for(role, &kinds), (kinds.to_vec(), none));
        }
    }

    #[test]
    fn each_source_has_its_own_role_and_releases_need_none() {
        let mut gate = OutputGate::new(permissions(SourceRole::Keys, 60), false);
        gate.add_source(permissions(SourceRole::Pointer, 60));
        let mut passed = |source, lines: &[&str]| {
            let mut events: Events = lines.iter().map(|line| event(1, line)).collect();
            gate.filter(source, 0, &mut events);
            events.len()
        };
        assert_eq!(passed(0, &["down A", "down MouseLeft"]), 1);
        assert_eq!(passed(1, &["down B", "down MouseLeft"]), 1);
        assert_eq!(passed(0, &["up MouseLeft"]), 1);
        assert_eq!(passed(1, &["up B", "up A"]), 1);
        assert_eq!(gate.suppressed().keys_by_role, 1);
        assert_eq!(gate.suppressed().pointing_by_role, 1);
    }

    #[test]
    fn events_suppressed_by_role_do_not_count_as_presses() {
        let mut gate = OutputGate::new(permissions(SourceRole::Pointer, 2), false);
        let keys = ["down A", "write b", "down C"];
        assert_eq!(filter(&mut gate, 1, &keys), (true, vec![]));
        assert_eq!(
            filter(&mut gate, 1, &["down MouseLeft"]),
            (true, vec!["down MouseLeft".to_owned()])
        );
        assert_eq!(gate.suppressed().rate_limited, 0);
    }

    #[test]
    fn events_before_the_first_index_are_not_filtered() {
        let mut gate = gate(60);
        let mut events: Events = ["up Q", "up Q"]
            .map(|line| event(1, line))
            .into_iter()
            .collect();
        gate.filter(0, 1, &mut events);
        assert_eq!(events.len(), 1);
    }
}
