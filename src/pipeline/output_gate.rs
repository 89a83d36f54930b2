//! The last look at what goes out: what is down, what its source may do, how many presses there are in a second,
//! and keys that act on the system.

use std::time::Duration;

use super::permissions::{Part, SourcePermissions, SourceRole};
use crate::device::{EventKind, Events, KeyCode, OutputEvent};
use crate::output::pressed_keys::PressedKeys;
use crate::snapshot::Suppressed;
use crate::time::Timestamp;

/// What one press costs.
const PRESS: u64 = 1_000_000;

/// How many presses may come in a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PressRateLimit {
    /// For as long as one likes; half as many may come at once.
    pub per_second: u32,
}

impl PressRateLimit {
    /// For sources at this machine: 720 words a minute, more than anybody types.
    pub const LOCAL: Self = Self { per_second: 60 };

    /// For sources on the network: an intruder is slower than a good typist.
    pub const NETWORK: Self = Self { per_second: 20 };

    /// What can be saved up, in the unit of [`PRESS`].
    fn most(self) -> u64 {
        u64::from(self.per_second / 2).max(1) * PRESS
    }
}

/// Presses that a source may still make: a bucket into which they drip, and which holds half a second of them.
#[derive(Clone, Copy, Debug)]
struct Allowance {
    limit: PressRateLimit,
    level: u64,
    since: Timestamp,
}

impl Allowance {
    fn new(limit: PressRateLimit) -> Self {
        Self {
            limit,
            level: limit.most(),
            since: Timestamp::default(),
        }
    }

    /// Whether there may be one more at this time.
    fn take(&mut self, time: Timestamp) -> bool {
        let passed: Duration = time.since(self.since);
        self.since = self.since.max(time);
        let gained = (passed.as_micros() as u64).saturating_mul(self.limit.per_second.into());
        self.level = self.level.saturating_add(gained).min(self.limit.most());
        let may = self.level >= PRESS;
        self.level -= if may { PRESS } else { 0 };
        may
    }
}

/// What is known of a source.
#[derive(Clone, Copy, Debug)]
struct Origin {
    role: SourceRole,
    allowance: Allowance,
}

impl Origin {
    fn new(rights: SourcePermissions) -> Self {
        Self {
            role: rights.role,
            allowance: Allowance::new(rights.rate_limit),
        }
    }
}

/// Lets events out, or not: releases always.
#[derive(Clone, Debug)]
pub(super) struct Gate {
    /// At least one.
    sources: Vec<Origin>,
    lets_system_keys: bool,
    down: PressedKeys,
    withheld: Suppressed,
}

impl Gate {
    /// For one source; system keys are those of [`KeyCode::is_of_system`] and what some keys become with
    /// Control and Alt.
    pub(super) fn new(rights: SourcePermissions, lets_system_keys: bool) -> Self {
        Self {
            sources: vec![Origin::new(rights)],
            lets_system_keys,
            down: PressedKeys::default(),
            withheld: Suppressed::default(),
        }
    }

    /// The same with another source; the place of it is the number of those before it.
    pub(super) fn add_source(&mut self, rights: SourcePermissions) {
        self.sources.push(Origin::new(rights));
    }

    /// Takes out of the events from number `first` on what must not go out. `false` when presses came too
    /// fast; everything has to be let go of then.
    pub(super) fn pass(&mut self, source: usize, first: usize, events: &mut Events) -> bool {
        let mut is_within = true;
        let mut kept = first;
        let mut written = None;
        for place in first..events.len() {
            let event = events[place];
            let may = match event.kind {
                EventKind::KeyUp(key) => self.down.release(key),
                action if !self.is_of_role(source, action) => false,
                EventKind::KeyDown(key) if self.acts_on_system(key) => {
                    self.withheld.system_keys += 1;
                    false
                }
                // The text of one key is one press.
                EventKind::Character(_) if is_within && written == Some(event.time) => true,
                EventKind::KeyDown(_) | EventKind::Character(_) => {
                    let may = is_within && self.has_room(source, &event);
                    self.withheld.rate_limited += u64::from(!may);
                    is_within &= may;
                    may
                }
                _ => true,
            };
            match event.kind {
                EventKind::KeyDown(key) if may => _ = self.down.press(key),
                EventKind::Character(_) => written = Some(event.time),
                _ => {}
            }
            if may {
                events[kept] = event;
                kept += 1;
            }
        }
        events.truncate(kept);
        is_within
    }

    /// Whether keys may come of a source.
    pub(super) fn types(&self, source: usize) -> bool {
        let last = self.sources.len() - 1;
        self.sources[source.min(last)].role.allows_keys()
    }

    /// Adds keys that were withheld by the role of a source before they came here.
    pub(super) fn count_keys(&mut self, dropped: u64) {
        self.withheld.keys_by_role += dropped;
    }

    /// The account of what was not let out.
    pub(super) fn withheld(&self) -> Suppressed {
        self.withheld
    }

    /// What is known of a source; where both hands come from one it has both numbers.
    fn source(&mut self, number: usize) -> &mut Origin {
        let last = self.sources.len() - 1;
        &mut self.sources[number.min(last)]
    }

    /// Whether the role of the source allows this; counted where not.
    fn is_of_role(&mut self, source: usize, action: EventKind) -> bool {
        let Some(part) = Part::of(action) else {
            return true;
        };
        let may = self.source(source).role.has(part);
        let count = match part {
            Part::Keys => &mut self.withheld.keys_by_role,
            Part::Pointing => &mut self.withheld.pointing_by_role,
        };
        *count += u64::from(!may);
        may
    }

    fn has_room(&mut self, source: usize, event: &OutputEvent) -> bool {
        self.source(source).allowance.take(event.time)
    }

    /// Whether this key would do something to the system, together with what is down.
    fn acts_on_system(&self, key: KeyCode) -> bool {
        if self.lets_system_keys {
            return false;
        }
        let is_down = |names: [&str; 2]| {
            let mut held = self.down.release_order();
            held.any(|held| names.contains(&held.name()))
        };
        key.is_system_key()
            || (key.is_system_key_with_ctrl_alt()
                && is_down(["ControlLeft", "ControlRight"])
                && is_down(["AltLeft", "AltRight"]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::TargetId;
    use crate::device::Axis;

    fn event(milliseconds: u64, line: &str) -> OutputEvent {
        let (what, name) = line.split_once(' ').unwrap();
        let action = match what {
            "down" => EventKind::KeyDown(name.parse().unwrap()),
            "up" => EventKind::KeyUp(name.parse().unwrap()),
            "write" => EventKind::Character(name.chars().next().unwrap()),
            _ => panic!("{what}"),
        };
        OutputEvent {
            time: Timestamp(milliseconds * 1_000),
            kind: action,
        }
    }

    fn pass(gate: &mut Gate, milliseconds: u64, lines: &[&str]) -> (bool, Vec<String>) {
        let mut events: Events = lines.iter().map(|line| event(milliseconds, line)).collect();
        let is_within = gate.pass(0, 0, &mut events);
        let written = events.iter().map(|event| match event.kind {
            EventKind::KeyDown(key) => format!("down {key}"),
            EventKind::KeyUp(key) => format!("up {key}"),
            EventKind::Character(character) => format!("write {character}"),
            _ => panic!("{event:?}"),
        });
        (is_within, written.collect())
    }

    fn rights(per_second: u32) -> SourcePermissions {
        SourcePermissions {
            role: SourceRole::Both,
            rate_limit: PressRateLimit { per_second },
        }
    }

    fn gate(per_second: u32) -> Gate {
        Gate::new(rights(per_second), false)
    }

    #[test]
    fn half_a_second_of_presses_may_come_at_once_and_then_they_drip() {
        let mut gate = gate(20);
        let taps = |gate: &mut Gate, milliseconds, count: usize| {
            (0..count)
                .map(|_| pass(gate, milliseconds, &["down A", "up A"]))
                .filter(|(is_within, _)| *is_within)
                .count()
        };
        assert_eq!(taps(&mut gate, 1_000, 12), 10);
        assert_eq!(taps(&mut gate, 1_049, 1), 0);
        assert_eq!(taps(&mut gate, 1_050, 2), 1);
        assert_eq!(taps(&mut gate, 60_000, 12), 10);
        assert_eq!(gate.withheld().rate_limited, 2 + 1 + 1 + 2);
    }

    #[test]
    fn the_release_of_a_press_that_was_withheld_is_too_and_no_other() {
        let mut gate = gate(2);
        let (is_within, out) = pass(&mut gate, 1, &["down A", "down B", "down C"]);
        assert_eq!((is_within, out), (false, vec!["down A".to_owned()]));
        let (is_within, out) = pass(&mut gate, 1, &["up C", "up B", "up A", "up A"]);
        assert_eq!((is_within, out), (true, vec!["up A".to_owned()]));
    }

    #[test]
    fn the_text_of_one_key_is_one_press() {
        let mut gate = gate(4);
        let hello: Vec<_> = "hello".chars().map(|c| format!("write {c}")).collect();
        let hello: Vec<_> = hello.iter().map(String::as_str).collect();
        assert_eq!(pass(&mut gate, 1, &hello).1.len(), 5);
        assert_eq!(pass(&mut gate, 2, &hello).1.len(), 5);
        let (is_within, out) = pass(&mut gate, 3, &hello);
        assert_eq!((is_within, out.len()), (false, 0));
    }

    #[test]
    fn keys_that_act_on_the_system_do_not_go_out_unless_they_may() {
        let mut gate = gate(60);
        assert_eq!(pass(&mut gate, 1, &["down MetaLeft"]).1.len(), 0);
        assert_eq!(pass(&mut gate, 1, &["up MetaLeft"]).1.len(), 0);
        let chord = ["down ControlRight", "down F2", "up F2", "down AltLeft"];
        assert_eq!(pass(&mut gate, 1, &chord).1, chord);
        for key in ["F2", "Delete", "Backspace"] {
            let down = format!("down {key}");
            assert_eq!(pass(&mut gate, 1, &[&down]).1.len(), 0, "{key}");
        }
        assert_eq!(pass(&mut gate, 1, &["down A"]).1, ["down A"]);
        assert_eq!(gate.withheld().system_keys, 4);
        let mut gate = Gate::new(SourcePermissions::LOCAL, true);
        assert_eq!(pass(&mut gate, 1, &["down MetaLeft"]).1, ["down MetaLeft"]);
    }

    #[test]
    fn each_source_has_presses_of_its_own() {
        let mut gate = gate(2);
        gate.add_source(rights(4));
        let mut presses = |source| {
            let mut events: Events = ["down A", "up A"]
                .map(|line| event(1, line))
                .into_iter()
                .collect();
            gate.pass(source, 0, &mut events)
        };
        let outcomes = [0, 0, 1, 1, 1].map(&mut presses);
        assert_eq!(outcomes, [true, false, true, true, false]);
    }

    /// What goes out of this, at once, by each role.
    fn let_out(role: SourceRole, actions: &[EventKind]) -> (Vec<EventKind>, Suppressed) {
        let rights = SourcePermissions {
            role,
            ..SourcePermissions::LOCAL
        };
        let mut gate = Gate::new(rights, false);
        let event = |&action| OutputEvent {
            time: Timestamp(1),
            kind: action,
        };
        let mut events: Events = actions.iter().map(event).collect();
        assert!(gate.pass(0, 0, &mut events), "a role is no haste");
        let out = events.iter().map(|event| event.kind).collect();
        (out, gate.withheld())
    }

    #[test]
    fn a_pointer_presses_no_keys_and_what_is_for_keys_does_not_point() {
        let code = |name: &str| name.parse().unwrap();
        let typing = [
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
        let all = [&typing[..], &pointing].concat();
        let withheld = |keys_by_role, pointing_by_role| Suppressed {
            keys_by_role,
            pointing_by_role,
            ..Suppressed::default()
        };
        let (out, count) = let_out(SourceRole::Pointer, &all);
        assert_eq!((&out[..], count), (&pointing[..], withheld(3, 0)));
        let (out, count) = let_out(SourceRole::Keys, &all);
        assert_eq!((&out[..], count), (&typing[..], withheld(0, 6)));
        assert_eq!(let_out(SourceRole::Both, &all), (all, withheld(0, 0)));
    }

    #[test]
    fn what_any_source_may_do_is_up_to_no_role() {
        let target = TargetId(0);
        let actions = [
            EventKind::Axis(Axis::MoveZ, 0.0),
            EventKind::Axis(Axis::MoveZ, -0.0),
            EventKind::Depth(target, 1.0),
            EventKind::Value(target, 1.0),
            EventKind::Select(target),
            EventKind::Unselect(target),
        ];
        for role in SourceRole::ALL {
            let nothing = Suppressed::default();
            assert_eq!(let_out(role, &actions), (actions.to_vec(), nothing));
        }
    }

    #[test]
    fn each_source_has_a_role_of_its_own_and_releases_have_none() {
        let with = |role| SourcePermissions {
            role,
            ..SourcePermissions::LOCAL
        };
        let mut gate = Gate::new(with(SourceRole::Keys), false);
        gate.add_source(with(SourceRole::Pointer));
        let mut pass = |source, lines: &[&str]| {
            let mut events: Events = lines.iter().map(|line| event(1, line)).collect();
            gate.pass(source, 0, &mut events);
            events.len()
        };
        assert_eq!(pass(0, &["down A", "down MouseLeft"]), 1);
        assert_eq!(pass(1, &["down B", "down MouseLeft"]), 1);
        assert_eq!(pass(0, &["up MouseLeft"]), 1);
        assert_eq!(pass(1, &["up B", "up A"]), 1);
        assert_eq!(gate.withheld().keys_by_role, 1);
        assert_eq!(gate.withheld().pointing_by_role, 1);
    }

    #[test]
    fn what_a_role_withholds_costs_no_press() {
        let mut gate = Gate::new(
            SourcePermissions {
                role: SourceRole::Pointer,
                ..rights(2)
            },
            false,
        );
        let keys = ["down A", "write b", "down C"];
        assert_eq!(pass(&mut gate, 1, &keys), (true, vec![]));
        assert_eq!(
            pass(&mut gate, 1, &["down MouseLeft"]),
            (true, vec!["down MouseLeft".to_owned()])
        );
        assert_eq!(gate.withheld().rate_limited, 0);
    }

    #[test]
    fn what_came_before_is_left_alone() {
        let mut gate = gate(60);
        let mut events: Events = ["up Q", "up Q"]
            .map(|line| event(1, line))
            .into_iter()
            .collect();
        gate.pass(0, 1, &mut events);
        assert_eq!(events.len(), 1);
    }
}
