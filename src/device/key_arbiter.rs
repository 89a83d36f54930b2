//! What should be down: one account for all controls of a layout.

mod action;
mod locks;
mod one_shots;

pub use self::action::{KeyAction, Latch, TextId};

use arrayvec::ArrayVec;

use self::locks::Locks;
use self::one_shots::OneShots;
use super::{EventKind, Events, KeyCode, OutputEvent, Request};
use crate::contact::{TargetId, Touch};
use crate::hand::{Finger, Side};
use crate::time::Timestamp;

/// There are eight modifier keys.
pub(super) const MODIFIERS: usize = 8;

/// Ten fingers, and 30 controls that stay on, such as toggle switches. One more is refused.
const MOST_PRESSES: usize = 40;

/// A code for each press, and the modifiers around them.
const MOST_DOWN: usize = MOST_PRESSES + MODIFIERS;

/// Takes presses from every control and works out which codes are down.
///
/// Every press belongs to its owner: nothing else ends it. A code that two presses hold goes down with
/// the first and comes up with the last. A press keeps what it did when it began, whatever the layer is
/// by then. A press that finds no room is refused; a release never is.
#[derive(Clone, Debug, Default)]
pub struct KeyArbiter {
    texts: Vec<String>,
    /// In order of pressing.
    presses: ArrayVec<Press, MOST_PRESSES>,
    one_shots: OneShots,
    locks: Locks,
    /// In order of going down.
    down: ArrayVec<Down, MOST_DOWN>,
    /// The latest time that an event went out with; times never go back.
    time: Timestamp,
    /// By side, the hands whose fingers press no keys.
    only_point: [bool; Side::COUNT],
    /// The presses that were dropped because of that.
    dropped: u64,
}

/// Who presses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PressSource {
    /// A fingertip on a target.
    Touch(Side, Finger, TargetId),
    /// A part of a control, such as the left end of a lever.
    Part(TargetId, u8),
}

impl PressSource {
    /// The fingertip and target of a touch.
    pub fn from_touch(touch: &Touch) -> Self {
        Self::Touch(touch.side, touch.finger, touch.target)
    }
}

#[derive(Clone, Copy, Debug)]
struct Press {
    owner: PressSource,
    action: KeyAction,
    /// For a one-shot or lock: whether another key was pressed meanwhile, so that it acts as held.
    is_used: bool,
    /// For a one-shot or lock: whether a tap puts it in force; not when it was in force and the
    /// press took that back.
    arms: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Down {
    code: KeyCode,
    is_modifier: bool,
}

impl KeyArbiter {
    /// One on which nothing is pressed; text `i` of a [`TextId`] is `texts[i]`.
    pub fn new(texts: Vec<String>) -> Self {
        Self {
            texts,
            ..Self::default()
        }
    }

    /// The layer whose key was pressed last of those still pressed, else the one that was tapped; 0 for
    /// the base layer.
    pub fn active_layer(&self) -> usize {
        let pressed = self
            .presses
            .iter()
            .rev()
            .find_map(|press| match press.action {
                KeyAction::Layer(layer, _) => Some(layer),
                _ => None,
            });
        let tapped = self.one_shots.layer.or(self.locks.layer);
        pressed.or(tapped).unwrap_or(0)
    }

    /// Whether something is pressed that does this.
    pub fn is_pressed(&self, action: KeyAction) -> bool {
        self.presses.iter().any(|press| press.action == action)
    }

    /// Which hands, by side, only point: keys that their fingers press from now on are dropped. Where a press
    /// waits for a time or for another key, the frame in which it begins may be that of another hand.
    pub fn set_pointing_hands(&mut self, sides: [bool; Side::COUNT]) {
        self.only_point = sides;
    }

    /// How many presses were dropped because of that since this was asked last.
    pub fn take_dropped_presses(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
    }

    /// Whether this owner presses something.
    pub fn has_press_from(&self, owner: PressSource) -> bool {
        self.presses.iter().any(|press| press.owner == owner)
    }

    /// The latest time that something went out with.
    pub fn last_event_time(&self) -> Timestamp {
        self.time
    }

    /// Whether a press may go out: after it, and the modifiers around it, there must be room left
    /// to let go of all that is down. So a press may be dropped, a release never.
    pub fn has_room(&self, events: &Events) -> bool {
        let at_most_down = self.down.len() + 1 + MODIFIERS;
        !self.presses.is_full() && events.remaining_capacity() >= 1 + MODIFIERS + at_most_down
    }

    /// Begins a press; `false`, and nothing happens, when there is no room, which only a pause does without. What
    /// it holds down goes out with the next [`settle`](Self::settle).
    pub fn press(
        &mut self,
        owner: PressSource,
        action: KeyAction,
        time: Timestamp,
        events: &mut Events,
    ) -> bool {
        if matches!(owner, PressSource::Touch(side, ..) if self.only_point[side.index()])
            && action.is_typing()
        {
            self.dropped += 1;
            return true;
        }
        if !self.has_room(events) {
            const PAUSE: Request = Request::Pause;
            return action == KeyAction::Ask(PAUSE)
                && self.emit(time, EventKind::Ask(PAUSE), events);
        }
        match action {
            KeyAction::Text(text) if !self.write(text, time, events) => return false,
            KeyAction::Ask(request) => {
                self.send(time, EventKind::Ask(request), events);
            }
            _ => {}
        }
        let was_one_shot = self.one_shots.take_back(action);
        let was_locked = self.locks.take_back(action);
        if let KeyAction::Key(_) = action {
            self.use_up(owner);
        }
        self.presses.push(Press {
            owner,
            action,
            is_used: false,
            arms: !was_one_shot && !was_locked,
        });
        true
    }

    /// Ends the presses of those owners, who let go: a tap. What they held comes up with the next
    /// [`settle`](Self::settle).
    pub fn release(&mut self, is_owner: impl Fn(PressSource) -> bool) {
        self.end_as(is_owner, true);
    }

    /// Ends the presses of those owners, who were lost or slid off: nothing counts as tapped.
    pub fn cancel(&mut self, is_owner: impl Fn(PressSource) -> bool) {
        self.end_as(is_owner, false);
    }

    /// Sends what leads from what is down to what should be: releases first. A release that finds no
    /// room is tried again next time.
    pub fn emit_changes(&mut self, time: Timestamp, events: &mut Events) {
        let wanted = self.wanted();
        self.release_unless(&wanted, time, events);
        for key in wanted {
            let is_down = self.down.iter().any(|other| other.code == key.code);
            if is_down || self.down.is_full() {
                continue;
            }
            if self.send(time, EventKind::KeyDown(key.code), events) {
                self.down.push(key);
            }
        }
    }

    /// Ends every press and forgets what was tapped.
    pub fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        self.presses.clear();
        self.one_shots = OneShots::default();
        self.locks = Locks::default();
        self.time = self.time.max(time);
        self.release_unless(&[], time, events);
    }

    /// Tells of something that is neither down nor up; `false` when that would take the room that
    /// releases need.
    pub fn emit(&mut self, time: Timestamp, action: EventKind, events: &mut Events) -> bool {
        events.remaining_capacity() > self.down.len() && self.send(time, action, events)
    }

    /// What waits for the next key is for this press.
    fn use_up(&mut self, owner: PressSource) {
        self.one_shots.pass_to(owner);
        for press in &mut self.presses {
            press.is_used = true;
        }
    }

    /// Writes a text, or nothing where there is no room for all of it.
    fn write(&mut self, TextId(text): TextId, time: Timestamp, events: &mut Events) -> bool {
        let time = self.time.max(time);
        let Some(text) = self.texts.get(usize::from(text)) else {
            return false;
        };
        let room = events.remaining_capacity();
        if room <= text.chars().count() + self.down.len() + 1 + MODIFIERS {
            return false;
        }
        events.extend(text.chars().map(|character| OutputEvent {
            time,
            kind: EventKind::Character(character),
        }));
        self.time = time;
        true
    }

    fn end_as(&mut self, is_owner: impl Fn(PressSource) -> bool, is_tap: bool) {
        let (one_shots, locks) = (&mut self.one_shots, &mut self.locks);
        self.presses.retain(|press| {
            if !is_owner(press.owner) {
                return true;
            }
            one_shots.end_of(press, is_tap);
            locks.end_of(press, is_tap);
            false
        });
    }

    /// The codes that should be down now, modifiers first.
    fn wanted(&self) -> ArrayVec<Down, MOST_DOWN> {
        let mut wanted = ArrayVec::new();
        let mut add = |code: KeyCode, is_modifier: bool| {
            if !wanted.iter().any(|other: &Down| other.code == code) {
                let _ = wanted.try_push(Down { code, is_modifier });
            }
        };
        for press in &self.presses {
            match press.action {
                KeyAction::Modifier(code, Latch::Momentary | Latch::Lock) => add(code, true),
                KeyAction::Modifier(code, Latch::OneShot) if press.is_used => add(code, true),
                _ => {}
            }
        }
        for &code in self.locks.modifiers.iter().chain(&self.one_shots.in_force) {
            add(code, true);
        }
        for press in &self.presses {
            if let KeyAction::Key(code) = press.action {
                add(code, false);
            }
        }
        wanted
    }

    /// Releases what is down but not wanted: the last first, modifiers after all others.
    fn release_unless(&mut self, wanted: &[Down], time: Timestamp, events: &mut Events) {
        for is_modifier in [false, true] {
            for place in (0..self.down.len()).rev() {
                let key = self.down[place];
                let stays = wanted.iter().any(|other| other.code == key.code);
                if stays || key.is_modifier != is_modifier {
                    continue;
                }
                if self.send(time, EventKind::KeyUp(key.code), events) {
                    self.down.remove(place);
                }
            }
        }
    }

    fn send(&mut self, time: Timestamp, action: EventKind, events: &mut Events) -> bool {
        let time = self.time.max(time);
        let is_sent = events.try_push(OutputEvent { time, kind: action }).is_ok();
        if is_sent {
            self.time = time;
        }
        is_sent
    }
}
