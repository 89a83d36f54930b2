//! A keyboard: touches of keys become key events, with modifiers and layers.

mod binding;
mod bounces;
mod depths;
mod locks;
mod one_shots;
mod waiting;

pub use self::binding::{Fires, Hold, KeyAction, KeyBinding, Latch};

use arrayvec::ArrayVec;

use self::bounces::Bounces;
use self::depths::Depths;
use self::locks::Locks;
use self::one_shots::OneShots;
use self::waiting::Waiting;
use super::{Action, Events, KeyCode, OutputEvent, VirtualDevice};
use crate::contact::{MOST_TOUCHES, Phase, TargetId, Touch};
use crate::hand::{Finger, FingerSet};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// Turns touches into key events.
///
/// What a key does is settled when it is pressed; it comes up as what it went down, whatever the
/// layer is by then. Every press belongs to its finger and target: nothing else ends it. A code
/// that two presses hold goes down with the first and comes up with the last.
///
/// After every touch the keyboard works out which codes should be down and compares that with
/// those that are: releases first, then presses. In a frame, what was down before comes up first,
/// then presses follow in order of time, then the ends of presses of the same frame. Where that
/// order is not the order of time, the later event is dated forward; times never go back.
/// What fires when it is let go of counts as a press of that moment.
#[derive(Clone, Debug)]
pub struct Keyboard {
    bindings: Vec<KeyBinding>,
    /// For each target id the place of its binding.
    places: Vec<Option<u32>>,
    /// In order of pressing; a finger presses one target at a time.
    presses: ArrayVec<Press, { Finger::COUNT }>,
    one_shots: OneShots,
    locks: Locks,
    bounces: Bounces,
    /// In order of going down: a code for each finger, and the modifiers around it.
    down: ArrayVec<Down, { Finger::COUNT + MODIFIERS }>,
    depths: Depths,
    /// The latest time that an event went out with.
    time: Timestamp,
}

/// There are eight modifier keys.
const MODIFIERS: usize = 8;

#[derive(Clone, Copy, Debug)]
struct Press {
    owner: Owner,
    /// What is in force; while the press waits, what its tap will do.
    action: KeyAction,
    /// Set until it is known what the press does.
    waiting: Option<Waiting>,
    /// For a one-shot or lock: whether another key was pressed meanwhile, so that it acts as held.
    is_used: bool,
    /// For a one-shot or lock: whether a tap puts it in force; not when it was in force and the
    /// press took that back.
    arms: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Owner {
    finger: Finger,
    target: TargetId,
}

impl Owner {
    fn of(touch: &Touch) -> Self {
        Self {
            finger: touch.finger,
            target: touch.target,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Down {
    code: KeyCode,
    is_modifier: bool,
}

/// The codes that should be down, modifiers first.
type Wanted = ArrayVec<Down, { Finger::COUNT + MODIFIERS }>;

/// The touches of a frame, in the order in which a keyboard takes them.
type Sorted<'a> = ArrayVec<(Turn, Timestamp, usize, &'a Touch), MOST_TOUCHES>;

/// When in a frame a touch is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Turn {
    EndsOld,
    Begins,
    EndsNew,
}

impl Keyboard {
    /// A keyboard with nothing pressed. Of several bindings for one target the first counts;
    /// targets without a binding do nothing.
    pub fn new(bindings: Vec<KeyBinding>) -> Self {
        let count = bindings.iter().map(|binding| binding.target.0 as usize + 1);
        let mut places = vec![None; count.max().unwrap_or(0)];
        for (place, binding) in bindings.iter().enumerate().rev() {
            places[binding.target.0 as usize] = Some(place as u32);
        }
        Self {
            bounces: Bounces::new(bindings.len()),
            bindings,
            places,
            presses: ArrayVec::new(),
            one_shots: OneShots::default(),
            locks: Locks::default(),
            down: ArrayVec::new(),
            depths: Depths::default(),
            time: Timestamp::default(),
        }
    }

    /// The place of a target's binding.
    fn place(&self, target: TargetId) -> Option<usize> {
        let place = (*self.places.get(target.0 as usize)?)?;
        Some(place as usize)
    }

    fn binding(&self, target: TargetId) -> Option<&KeyBinding> {
        self.bindings.get(self.place(target)?)
    }

    /// What a target does in the layer that is in force.
    fn action(&self, target: TargetId) -> Option<KeyAction> {
        let actions = &self.binding(target)?.actions;
        let own = actions.get(self.layer()).copied().flatten();
        own.or_else(|| actions.first().copied().flatten())
    }

    /// The presses of which it is known what they do, in order of pressing.
    fn in_force(&self) -> impl DoubleEndedIterator<Item = &Press> {
        self.presses.iter().filter(|press| press.waiting.is_none())
    }

    /// The layer whose key was pressed last of those still pressed, else the one that was tapped.
    fn layer(&self) -> usize {
        let pressed = self.in_force().rev().find_map(|press| match press.action {
            KeyAction::Layer(layer, _) => Some(layer),
            _ => None,
        });
        let tapped = self.one_shots.layer.or(self.locks.layer);
        pressed.or(tapped).unwrap_or(0)
    }

    fn press(&mut self, touch: &Touch, events: &mut Events) {
        let owner = Owner::of(touch);
        // A finger that presses a second target has let go of the first, told or not.
        self.end(
            |press| press.owner.finger == owner.finger,
            Phase::Cancelled,
            touch.time,
        );
        let Some(place) = self.place(owner.target) else {
            return;
        };
        let KeyBinding { fires, repress, .. } = self.bindings[place];
        if self.bounces.is_bounce(place, touch.time, repress) {
            return;
        }
        self.hold_for_another_key(touch.time, events);
        let Some(action) = self.action(owner.target) else {
            return;
        };
        if !self.has_room(events) {
            return;
        }
        let was_one_shot = self.one_shots.take_back(action);
        let was_locked = self.locks.take_back(action);
        let waiting = Waiting::of(action, fires, touch.time);
        if waiting.is_none() {
            self.take_effect(owner, action);
        }
        let press = Press {
            owner,
            action,
            waiting,
            is_used: false,
            arms: !was_one_shot && !was_locked,
        };
        // Each finger has one press at most, so there is room.
        let _ = self.presses.try_push(press);
    }

    /// A press begins to do something: what waits for the next key is for it.
    fn take_effect(&mut self, owner: Owner, action: KeyAction) {
        if !matches!(action, KeyAction::Key(_)) {
            return;
        }
        self.one_shots.pass_to(owner);
        for press in &mut self.presses {
            press.is_used = true;
        }
    }

    /// Whether a press may go out: after it, and the modifiers around it, there must be room left
    /// to let go of all that is down. So a press may be dropped, a release never.
    fn has_room(&self, events: &Events) -> bool {
        let at_most_down = self.down.len() + 1 + MODIFIERS;
        events.remaining_capacity() >= 1 + MODIFIERS + at_most_down
    }

    /// Ends the presses that match; one that is cancelled does not count as tapped.
    fn end(&mut self, matches: impl Fn(&Press) -> bool, phase: Phase, time: Timestamp) {
        let (one_shots, locks) = (&mut self.one_shots, &mut self.locks);
        let (bounces, places) = (&mut self.bounces, &self.places);
        self.presses.retain(|press| {
            if !matches(press) {
                return true;
            }
            let is_tap = phase != Phase::Cancelled;
            one_shots.end_of(press, is_tap);
            locks.end_of(press, is_tap);
            if let Some(Some(place)) = places.get(press.owner.target.0 as usize) {
                bounces.came_up(*place as usize, time);
            }
            false
        });
    }

    /// The codes that should be down now.
    fn wanted(&self) -> Wanted {
        let mut wanted = Wanted::new();
        let mut add = |code: KeyCode, is_modifier: bool| {
            if !wanted.iter().any(|other: &Down| other.code == code) {
                let _ = wanted.try_push(Down { code, is_modifier });
            }
        };
        for press in self.in_force() {
            match press.action {
                KeyAction::Modifier(code, Latch::Held | Latch::Lock) => add(code, true),
                KeyAction::Modifier(code, Latch::OneShot) if press.is_used => add(code, true),
                _ => {}
            }
        }
        for &code in self.locks.modifiers.iter().chain(&self.one_shots.in_force) {
            add(code, true);
        }
        for press in self.in_force() {
            if let KeyAction::Key(code) = press.action {
                add(code, false);
            }
        }
        wanted
    }

    /// Sends what leads from what is down to what should be. A release that finds no room is tried
    /// again next time.
    fn settle(&mut self, time: Timestamp, events: &mut Events) {
        let wanted = self.wanted();
        self.release_unless(&wanted, time, events);
        for key in wanted {
            let is_down = self.down.iter().any(|other| other.code == key.code);
            if is_down || self.down.is_full() {
                continue;
            }
            if self.send(time, Action::KeyDown(key.code), events) {
                self.down.push(key);
            }
        }
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
                if self.send(time, Action::KeyUp(key.code), events) {
                    self.down.remove(place);
                }
            }
        }
    }

    fn send(&mut self, time: Timestamp, action: Action, events: &mut Events) -> bool {
        let time = self.time.max(time);
        let is_sent = events.try_push(OutputEvent { time, action }).is_ok();
        if is_sent {
            self.time = time;
        }
        is_sent
    }

    /// Takes at most as many touches as a frame can have.
    fn take_presses(&mut self, touches: &[Touch], events: &mut Events) {
        for (.., touch) in self.sorted(touches) {
            match touch.phase {
                Phase::Pressed => self.press(touch, events),
                phase => {
                    let owner = Owner::of(touch);
                    if phase != Phase::Cancelled {
                        self.fire(owner, touch.time, events);
                    }
                    self.end(|press| press.owner == owner, phase, touch.time);
                }
            }
            self.settle(touch.time, events);
        }
    }

    fn take_depths(&mut self, touches: &[Touch], events: &mut Events) {
        for touch in touches {
            let is_analogue = |binding: &KeyBinding| binding.analogue;
            if self.binding(touch.target).is_some_and(is_analogue) {
                self.depths.take(touch);
                self.time = self.time.max(touch.time);
            }
        }
        self.depths.tell(self.time, events);
    }

    /// The beginnings and ends of presses, in the order in which they are taken; touches of one
    /// finger keep their order.
    fn sorted<'a>(&self, touches: &'a [Touch]) -> Sorted<'a> {
        let mut begun = FingerSet::NONE;
        let mut sorted = Sorted::new();
        for (place, touch) in touches.iter().enumerate() {
            let turn = match touch.phase {
                Phase::Touched | Phase::Held => continue,
                Phase::Pressed => {
                    begun = begun.with(touch.finger);
                    Turn::Begins
                }
                // Nothing of it is down yet, and what it fires is a press.
                _ if self.is_waiting(Owner::of(touch)) => Turn::Begins,
                _ if begun.contains(touch.finger) => Turn::EndsNew,
                _ => Turn::EndsOld,
            };
            let _ = sorted.try_push((turn, touch.time, place, touch));
        }
        sorted.sort_unstable_by_key(|&(turn, time, place, _)| (turn, time, place));
        sorted
    }
}

impl VirtualDevice for Keyboard {
    fn update(&mut self, pose: &HandPose, touches: &[Touch], events: &mut Events) {
        // Releases that found no room in the frame before.
        self.settle(self.time, events);
        // One frame of one hand is one chunk; a longer list must not lose a release either.
        for touches in touches.chunks(MOST_TOUCHES) {
            self.take_presses(touches, events);
        }
        self.hold_by(pose.time, events);
        self.take_depths(touches, events);
    }

    fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        self.presses.clear();
        self.one_shots = OneShots::default();
        self.locks = Locks::default();
        self.bounces.forget();
        self.release_unless(&[], time, events);
        self.depths.forget();
        self.time = self.time.max(time);
        self.depths.tell(self.time, events);
    }
}
