//! A keyboard: touches of keys become key events, with modifiers and layers.

mod depths;
mod one_shots;

use arrayvec::ArrayVec;

use self::depths::Depths;
use self::one_shots::OneShots;
use super::{Action, Events, KeyCode, OutputEvent, VirtualDevice};
use crate::contact::{MOST_TOUCHES, Phase, TargetId, Touch};
use crate::hand::{Finger, FingerSet};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// What one key of a layout does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyBinding {
    /// The target that stands for the key.
    pub target: TargetId,
    /// What pressing it does in each layer, base layer first. `None`, or a list that ends before
    /// the layer, does what the base layer says.
    pub actions: Vec<Option<KeyAction>>,
    /// Whether the depth of the press goes out too.
    pub analogue: bool,
}

/// What pressing a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyAction {
    /// Holds a key down as long as it is pressed; the receiver repeats.
    Key(KeyCode),
    /// Holds a modifier key down.
    Modifier(KeyCode, Latch),
    /// Switches to another layer: its place, 0 for the base layer.
    Layer(usize, Latch),
}

/// How long a modifier or layer stays in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Latch {
    /// As long as its key is pressed.
    Held,
    /// A tap puts it in force for the next key only, a second tap takes that back; held while
    /// another key is pressed it is as `Held`.
    OneShot,
}

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
#[derive(Clone, Debug)]
pub struct Keyboard {
    bindings: Vec<KeyBinding>,
    /// For each target id the place of its binding.
    places: Vec<Option<u32>>,
    /// In order of pressing; a finger presses one target at a time.
    presses: ArrayVec<Press, { Finger::COUNT }>,
    one_shots: OneShots,
    /// In order of going down: a code for each finger, and the one-shot modifiers around it.
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
    action: KeyAction,
    /// For a one-shot: whether another key was pressed meanwhile, so that it acts as held.
    is_used: bool,
    /// For a one-shot: whether letting go of it arms it; not when its tap took the armed one back.
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
            bindings,
            places,
            presses: ArrayVec::new(),
            one_shots: OneShots::default(),
            down: ArrayVec::new(),
            depths: Depths::default(),
            time: Timestamp::default(),
        }
    }

    fn binding(&self, target: TargetId) -> Option<&KeyBinding> {
        let place = (*self.places.get(target.0 as usize)?)?;
        self.bindings.get(place as usize)
    }

    /// What a target does in the layer that is in force.
    fn action(&self, target: TargetId) -> Option<KeyAction> {
        let actions = &self.binding(target)?.actions;
        let own = actions.get(self.layer()).copied().flatten();
        own.or_else(|| actions.first().copied().flatten())
    }

    /// The layer whose key was pressed last of those still pressed, else the one that was tapped.
    fn layer(&self) -> usize {
        let pressed = self
            .presses
            .iter()
            .rev()
            .find_map(|press| match press.action {
                KeyAction::Layer(layer, _) => Some(layer),
                _ => None,
            });
        pressed.or(self.one_shots.layer).unwrap_or(0)
    }

    fn press(&mut self, touch: &Touch, events: &mut Events) {
        let owner = Owner::of(touch);
        // A finger that presses a second target has let go of the first, told or not.
        self.end(|press| press.owner.finger == owner.finger, false);
        let Some(action) = self.action(owner.target) else {
            return;
        };
        if !self.has_room(events) {
            return;
        }
        let arms = !self.one_shots.take_back(action);
        if let KeyAction::Key(_) = action {
            self.one_shots.pass_to(owner);
            for press in &mut self.presses {
                press.is_used = true;
            }
        }
        let press = Press {
            owner,
            action,
            is_used: false,
            arms,
        };
        // Each finger has one press at most, so there is room.
        let _ = self.presses.try_push(press);
    }

    /// Whether a press may go out: after it, and the modifiers around it, there must be room left
    /// to let go of all that is down. So a press may be dropped, a release never.
    fn has_room(&self, events: &Events) -> bool {
        let at_most_down = self.down.len() + 1 + MODIFIERS;
        events.remaining_capacity() >= 1 + MODIFIERS + at_most_down
    }

    /// Ends the presses that match; `is_tap` tells whether a one-shot among them counts as tapped.
    fn end(&mut self, matches: impl Fn(&Press) -> bool, is_tap: bool) {
        let one_shots = &mut self.one_shots;
        self.presses.retain(|press| {
            if !matches(press) {
                return true;
            }
            one_shots.end_of(press, is_tap);
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
        for press in &self.presses {
            match press.action {
                KeyAction::Modifier(code, Latch::Held) => add(code, true),
                KeyAction::Modifier(code, Latch::OneShot) if press.is_used => add(code, true),
                _ => {}
            }
        }
        for &code in &self.one_shots.in_force {
            add(code, true);
        }
        for press in &self.presses {
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
        for (.., touch) in sorted(touches) {
            match touch.phase {
                Phase::Pressed => self.press(touch, events),
                phase => {
                    let owner = Owner::of(touch);
                    self.end(|press| press.owner == owner, phase != Phase::Cancelled);
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
}

/// The beginnings and ends of presses, in the order in which they are taken; touches of one finger
/// keep their order.
fn sorted(touches: &[Touch]) -> Sorted<'_> {
    let mut begun = FingerSet::NONE;
    let mut sorted = Sorted::new();
    for (place, touch) in touches.iter().enumerate() {
        let turn = match touch.phase {
            Phase::Touched | Phase::Held => continue,
            Phase::Pressed => {
                begun = begun.with(touch.finger);
                Turn::Begins
            }
            _ if begun.contains(touch.finger) => Turn::EndsNew,
            _ => Turn::EndsOld,
        };
        let _ = sorted.try_push((turn, touch.time, place, touch));
    }
    sorted.sort_unstable_by_key(|&(turn, time, place, _)| (turn, time, place));
    sorted
}

impl VirtualDevice for Keyboard {
    fn update(&mut self, _pose: &HandPose, touches: &[Touch], events: &mut Events) {
        // Releases that found no room in the frame before.
        self.settle(self.time, events);
        // One frame of one hand is one chunk; a longer list must not lose a release either.
        for touches in touches.chunks(MOST_TOUCHES) {
            self.take_presses(touches, events);
        }
        self.take_depths(touches, events);
    }

    fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        self.presses.clear();
        self.one_shots = OneShots::default();
        self.release_unless(&[], time, events);
        self.depths.forget();
        self.time = self.time.max(time);
        self.depths.tell(self.time, events);
    }
}
