//! Presses that do nothing until it is known what they are: a tap, a hold, or nothing.

use super::{Fires, Hold, KeyAction, Keyboard, Latch, Owner};
use crate::device::Events;
use crate::time::Timestamp;

/// What a press waits for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    /// When it becomes a hold, and of what.
    hold: Option<(Timestamp, KeyAction)>,
}

impl Waiting {
    /// What a press at `time` waits for; `None` if it is in force at once.
    pub(super) fn of(action: KeyAction, fires: Fires, time: Timestamp) -> Option<Self> {
        let hold = match (action, fires) {
            (KeyAction::Modifier(..) | KeyAction::Layer(..), _) | (_, Fires::Press) => return None,
            (KeyAction::Key(_), Fires::Release) => None,
            (KeyAction::Key(_), Fires::TapOrHold(Hold { action, after })) => {
                Some((time + after, while_pressed(action)))
            }
        };
        Some(Self { hold })
    }
}

fn while_pressed(action: KeyAction) -> KeyAction {
    match action {
        KeyAction::Key(code) => KeyAction::Key(code),
        KeyAction::Modifier(code, _) => KeyAction::Modifier(code, Latch::Held),
        KeyAction::Layer(layer, _) => KeyAction::Layer(layer, Latch::Held),
    }
}

impl Keyboard {
    /// Whether the press of this owner waits, or would if it began now.
    pub(super) fn is_waiting(&self, owner: Owner) -> bool {
        match self.presses.iter().find(|press| press.owner == owner) {
            Some(press) => press.waiting.is_some(),
            None => {
                let binding = self.binding(owner.target);
                binding.is_some_and(|binding| binding.fires != Fires::Press)
            }
        }
    }

    /// Holds what has been pressed long enough by `time`.
    pub(super) fn hold_by(&mut self, time: Timestamp, events: &mut Events) {
        for place in 0..self.presses.len() {
            if let Some((due, action)) = self.hold_at(place)
                && due <= time
            {
                self.decide(place, action, due, events);
            }
        }
    }

    /// Another key is pressed at `time`: what can be held is held from now on.
    pub(super) fn hold_for_another_key(&mut self, time: Timestamp, events: &mut Events) {
        for place in 0..self.presses.len() {
            if let Some((due, action)) = self.hold_at(place) {
                self.decide(place, action, due.min(time), events);
            }
        }
    }

    /// Fires the press of a finger that lets go at `time`, if it waits: a tap, or a hold that was
    /// due since the frame before.
    pub(super) fn fire(&mut self, owner: Owner, time: Timestamp, events: &mut Events) {
        let mut presses = self.presses.iter();
        let Some(place) = presses.position(|press| press.owner == owner) else {
            return;
        };
        if self.presses[place].waiting.is_none() {
            return;
        }
        match self.hold_at(place) {
            Some((due, action)) if due <= time => self.decide(place, action, due, events),
            _ => self.decide(place, self.presses[place].action, time, events),
        }
    }

    fn hold_at(&self, place: usize) -> Option<(Timestamp, KeyAction)> {
        self.presses[place].waiting?.hold
    }

    /// Puts an action in force for a press that waits. Without room it waits on.
    fn decide(&mut self, place: usize, action: KeyAction, time: Timestamp, events: &mut Events) {
        if !self.has_room(events) {
            return;
        }
        self.take_effect(self.presses[place].owner, action);
        let press = &mut self.presses[place];
        press.waiting = None;
        press.action = action;
        self.settle(time, events);
    }
}
