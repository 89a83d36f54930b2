//! The devices of a step: what they may press, their events through the filters and the gate, and their commands.

use super::Pipeline;
use super::layout_instance::PressRules;
use super::permissions::EventClass;
use super::press_filter::FilteredStep;
use crate::command::{Command, CommandOrigin};
use crate::device::{EventKind, Events, OutputEvent};
use crate::hand::Side;

impl Pipeline {
    /// Returns the presses that the sources permit in a step of the hand with this index.
    fn press_rules(&self, index: usize) -> PressRules {
        let mut pointer_only = [false; Side::COUNT];
        for (other, hand) in self.hands.iter().enumerate() {
            pointer_only[hand.side().index()] = !self.gate.allows_keys(other);
        }
        PressRules {
            pointer_only,
            is_paused: self.is_paused(),
            sequence_gap: self.gate.rate_limit(index).sequence_gap(),
        }
    }

    /// Updates the devices for a step of a hand, passes their events through the filters and the output gate, and executes their commands.
    pub(super) fn run_devices(&mut self, index: usize, events: &mut Events) {
        let first = events.len();
        let rules = self.press_rules(index);
        let layout = &mut self.profiles[self.active_profile].layout;
        let output = &mut self.hands[index].output;
        let dropped = layout.update_devices(output, rules, events);
        let side = output.pose.side;
        if layout.filter().is_some_and(|it| it.ignores_presses(side)) {
            // A candidate would replace the word that is being swiped.
            let commands = &mut output.commands;
            commands.retain(|issued| !issued.command.is_typing());
        }
        layout.update_auto_recenter(&output.pose);
        self.gate.add_suppressed_keys(dropped);
        let replacing = layout.take_replacing_presses();
        if layout.has_lost_hand() && self.gate.allows_keys(index) {
            // The hand may be at another keyboard or mouse by now.
            self.filters.lose_hand(side);
            if let Some(decoder) = layout.filter_mut() {
                decoder.lose_hand(side);
            }
        }
        let (filter, scene, arbiter) = layout.filter_parts();
        let step = FilteredStep {
            pose: &output.pose,
            scene,
            presses: &output.presses,
            may_type: self.gate.allows_keys(index),
        };
        let has_decoder = filter.is_some();
        let held = || arbiter.pressed_keys();
        let added = self.filters.apply(filter, step, held, first, events) + replacing;
        let system_keys = self.gate.suppressed().system_keys;
        let (other, may_type) = (self.hands.len() - 1 - index, self.gate.allows_keys(index));
        let has_other = arbiter.has_press_of_other_hand();
        let hand_of = |kind: EventKind| {
            // Keys that a filter types in place of a press of the other hand count for that hand.
            let is_in_place =
                has_other && !may_type && EventClass::from_kind(kind) == Some(EventClass::Keys);
            if is_in_place || arbiter.is_of_other_hand(kind) {
                other
            } else {
                index
            }
        };
        let within_limit = self.gate.filter(hand_of, first, added, events);
        if !has_decoder && let Some(is_inside_word) = ends_inside_word(&events[first..]) {
            self.is_inside_word = Some(is_inside_word);
        }
        layout.suppress_keys(self.gate.suppressed_keys());
        if self.gate.suppressed().system_keys > system_keys {
            // The keys that follow would act without the suppressed one.
            layout.abandon_sequence();
        }
        self.stop_hands_beyond_limit(within_limit, events);
        self.execute_issued(index, events);
    }

    /// Suspends each hand that pressed faster than its rate limit, or pauses if no other hand is tracked.
    fn stop_hands_beyond_limit(&mut self, within_limit: [bool; Side::COUNT], events: &mut Events) {
        for (hand, is_within_limit) in within_limit.into_iter().enumerate() {
            if !is_within_limit {
                // The filters assume that all their events were sent.
                self.reset_filters();
                if !self.suspend(hand) {
                    self.pause(CommandOrigin::RateLimit, events);
                }
            }
        }
    }

    /// Executes the commands that the devices issued for a hand.
    fn execute_issued(&mut self, index: usize, events: &mut Events) {
        let mut next = 0;
        while let Some(issued) = self.hands[index].output.commands.get(next) {
            let command = match issued.command {
                // The rate limit or another command may have paused this step; a toggle must not resume it.
                Command::TogglePause => Command::Pause,
                command => command,
            };
            next += 1;
            // A command that cannot be executed has no effect; no caller waits for a reply.
            let _ = self.execute(&command, CommandOrigin::Layout, events);
        }
    }

    /// Updates the devices during a pause and discards their events. Only commands that end the pause are executed, and
    /// only if the layout itself has paused.
    pub(super) fn run_devices_paused(&mut self, index: usize) {
        let rules = self.press_rules(index);
        let layout = &mut self.profiles[self.active_profile].layout;
        let output = &mut self.hands[index].output;
        layout.update_devices(output, rules, &mut Events::new());
        layout.take_replacing_presses();
        let mut commands = std::mem::take(&mut output.commands).into_iter();
        let ends_pause = |command| matches!(command, Command::TogglePause | Command::Resume);
        if commands.any(|issued| ends_pause(issued.command)) {
            self.resume(CommandOrigin::Layout);
        }
    }
}

/// Returns `true` if the text before the cursor may end inside a word after these events, and `false` if it ends with a blank. `None` if
/// they press nothing that types or may move the cursor.
fn ends_inside_word(events: &[OutputEvent]) -> Option<bool> {
    let mut latest_first = events.iter().rev();
    let last = latest_first.find(|event| event.kind.is_press() && !is_modifier(event.kind))?;
    // A letter, or a key or button that may have moved the cursor.
    Some(!types_blank(last.kind))
}

/// Returns `true` for the press of a modifier, which types nothing and leaves the cursor where it is.
fn is_modifier(kind: EventKind) -> bool {
    matches!(kind, EventKind::KeyDown(key) if key.is_modifier())
}

/// Returns `true` for a press that types a space, a tab or a line break, whatever the keymap of the receiver is.
fn types_blank(kind: EventKind) -> bool {
    let typed = match kind {
        EventKind::KeyDown(key) => key.us_character(false),
        EventKind::Character(character) => Some(character),
        _ => None,
    };
    typed.is_some_and(char::is_whitespace)
}
