//! Filters of presses: stages between the devices and the output gate that may hold, replace or add key events.
//!
//! A filter sees the events of a step before the output gate, with the evidence of the presses that caused them, and
//! changes the list. What it returns is checked here, so that no filter can leave a key down or hold a release:
//!
//! - A release that the devices emit leaves in the same step. A filter that drops it does not hold it back.
//! - A key that a filter presses while no control holds it is released at once.
//! - A pause, a loss and a stall [reset](PressFilter::reset) the filters: what they hold is never emitted.
//! - Presses that a filter adds do not count against the rate limit of the source.

use std::any::Any;

use arrayvec::{ArrayString, ArrayVec};

use crate::command::TextMode;
use crate::contact::Press;
use crate::contact::surface::Scene;
use crate::device::pressed_keys::PressedKeys;
use crate::device::{EventKind, Events, OutputEvent};
use crate::hand::Side;
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// The input of a filter in addition to the events: one hand in one step.
#[derive(Clone, Copy, Debug)]
pub struct FilterInput<'a> {
    /// The time of the step.
    pub time: Timestamp,
    /// The hand.
    pub side: Side,
    /// `true` if the source of the hand may cause keys and characters. What a filter emits in a step of another hand is suppressed.
    pub may_type: bool,
    /// The presses of the fingertips in this step, with their evidence. An event may belong to an earlier press, such as the
    /// press of a chord.
    pub presses: &'a [Press],
    /// The keys that the devices hold before the events of this step.
    pub held: &'a PressedKeys,
    /// The hand and the targets, for the path of a finger; `None` if the events come from elsewhere.
    pub contact: Option<(&'a HandPose, &'a Scene)>,
}

/// The step of one hand that filters see.
#[derive(Clone, Copy)]
pub(super) struct FilteredStep<'a> {
    pub(super) pose: &'a HandPose,
    pub(super) scene: &'a Scene,
    pub(super) presses: &'a [Press],
    /// See [`FilterInput::may_type`].
    pub(super) may_type: bool,
}

/// A stage that may hold, replace or add key events.
///
/// It is called for each accepted reading while output is armed, also without events, so that it can emit what it holds. Like every
/// stage it neither allocates nor blocks, and it holds no press longer than 250 ms.
pub trait PressFilter: Send {
    /// Changes the events of a step.
    fn filter(&mut self, input: &FilterInput, events: &mut Events);

    /// Forgets the presses that it holds.
    fn reset(&mut self);

    /// Forgets the presses that it holds, because this hand is lost. What a finger of the other hand has begun may end first.
    fn lose_hand(&mut self, _side: Side) {
        self.reset();
    }

    /// Sets the mode, if it decodes text.
    fn set_mode(&mut self, _: TextMode) {}

    /// Forgets what it has learned about the person, and what is pending.
    fn forget(&mut self) {}

    /// Replaces the word that is being typed by candidate `number`, counted from 1, in the next step that [may type](FilterInput::may_type).
    fn choose(&mut self, _number: u8) {}

    /// Returns `true` if a finger of this hand swipes over the keys, so that its hand presses none, takes no candidate and changes no
    /// mode.
    fn ignores_presses(&self, _side: Side) -> bool {
        false
    }

    /// Returns what displays show of it, if it decodes text.
    fn text_state(&self) -> Option<&TextState> {
        None
    }

    /// Returns `true` if the text before the cursor ends inside a word; `None` if it does not know.
    fn is_inside_word(&self) -> Option<bool> {
        None
    }

    /// Returns `true` if it finds the letters of multitap keys from the words: each tap is a letter then.
    fn finds_letters(&self) -> bool {
        false
    }

    /// Continues after text that another filter has seen; `is_inside` is `true` if the text ends inside a word.
    fn set_inside_word(&mut self, _is_inside: bool) {}

    /// Copies the mode, and what is known about the person, from the filter of the layout that this one replaces. May allocate.
    fn take_over(&mut self, _before: &dyn PressFilter) {}

    /// Returns itself, for a filter of its own type that [takes over](Self::take_over).
    fn as_any(&self) -> Option<&dyn Any> {
        None
    }
}

/// Maximum number of candidates that displays show.
pub const MAX_CANDIDATES: usize = 3;

/// A candidate for the word that is typed, cut to its capacity of 48 bytes.
pub type CandidateText = ArrayString<48>;

/// The state of a text decoder for displays.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextState {
    /// The mode.
    pub mode: TextMode,
    /// The candidates for the word that is typed, the most probable one first.
    pub candidates: ArrayVec<CandidateText, MAX_CANDIDATES>,
}

/// The filters of a pipeline, in order.
#[derive(Default)]
pub(super) struct PressFilters {
    filters: Vec<Box<dyn PressFilter>>,
}

impl PressFilters {
    /// Adds a filter after the others.
    pub(super) fn add(&mut self, filter: Box<dyn PressFilter>) {
        self.filters.push(filter);
    }

    /// Forgets the presses that filters hold.
    pub(super) fn reset(&mut self) {
        for filter in &mut self.filters {
            filter.reset();
        }
    }

    /// Forgets the presses that filters hold, because a hand is lost.
    pub(super) fn lose_hand(&mut self, side: Side) {
        for filter in &mut self.filters {
            filter.lose_hand(side);
        }
    }

    /// Passes the events from index `first` through the filter of the active layout and then through the others. `held` returns
    /// the keys that the devices hold after these events. Returns the number of presses and characters that the filters added.
    pub(super) fn apply(
        &mut self,
        own: Option<&mut (dyn PressFilter + 'static)>,
        step: FilteredStep,
        held: impl FnOnce() -> PressedKeys,
        first: usize,
        events: &mut Events,
    ) -> usize {
        if self.filters.is_empty() && own.is_none() {
            return 0;
        }
        let emitted: Events = events.drain(first..).collect();
        let held = held();
        let input = FilterInput {
            time: step.pose.time,
            side: step.pose.side,
            may_type: step.may_type,
            presses: step.presses,
            held: &held_before(&held, &emitted),
            contact: Some((step.pose, step.scene)),
        };
        let mut filtered = emitted.clone();
        if let Some(own) = own {
            own.filter(&input, &mut filtered);
        }
        for filter in &mut self.filters {
            filter.filter(&input, &mut filtered);
        }
        for &event in emitted.iter().filter(|event| is_release(event)) {
            if !filtered.contains(&event) {
                // There was room for it before the filters.
                let _ = events.try_push(event);
            }
        }
        for (index, &event) in filtered.iter().enumerate() {
            let later = &filtered[index + 1..];
            push(event, later, &held, events);
        }
        let press_count =
            |list: &[OutputEvent]| list.iter().filter(|event| event.kind.is_press()).count();
        press_count(&events[first..]).saturating_sub(press_count(&emitted))
    }
}

/// Returns the keys that were held before events, from those that are held after them.
fn held_before(held: &PressedKeys, events: &[OutputEvent]) -> PressedKeys {
    let mut before = held.clone();
    for event in events.iter().rev() {
        match event.kind {
            EventKind::KeyDown(key) => _ = before.release(key),
            EventKind::KeyUp(key) => _ = before.press(key),
            _ => {}
        }
    }
    before
}

/// Appends an event, and its release if neither a control that holds the key nor a later event would release it. Events that are no
/// releases leave room for the releases after them.
fn push(event: OutputEvent, later: &[OutputEvent], held: &PressedKeys, events: &mut Events) {
    let releases = later.iter().filter(|it| is_release(it)).count();
    let EventKind::KeyDown(key) = event.kind else {
        if is_release(&event) || events.remaining_capacity() > releases {
            let _ = events.try_push(event);
        }
        return;
    };
    let is_released_later = later.iter().any(|it| it.kind == EventKind::KeyUp(key));
    let is_tap = !held.contains(key) && !is_released_later;
    if events.remaining_capacity() < 1 + usize::from(is_tap) + releases {
        return;
    }
    events.push(event);
    if is_tap {
        let kind = EventKind::KeyUp(key);
        events.push(OutputEvent { kind, ..event });
    }
}

fn is_release(event: &OutputEvent) -> bool {
    matches!(event.kind, EventKind::KeyUp(_))
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;
    use crate::device::KeyCode;

    /// A filter made of a function.
    struct Filter<F>(F);

    impl<F: FnMut(&FilterInput, &mut Events) + Send> PressFilter for Filter<F> {
        fn filter(&mut self, input: &FilterInput, events: &mut Events) {
            (self.0)(input, events);
        }

        fn reset(&mut self) {}
    }

    fn key(name: &str) -> KeyCode {
        name.parse().expect("the name of a key")
    }

    fn event(kind: EventKind) -> OutputEvent {
        let time = Timestamp(1_000);
        OutputEvent { time, kind }
    }

    fn down(key: KeyCode) -> OutputEvent {
        event(EventKind::KeyDown(key))
    }

    fn up(key: KeyCode) -> OutputEvent {
        event(EventKind::KeyUp(key))
    }

    /// Passes the events of several steps through one filter.
    fn filtered(
        filter: impl FnMut(&FilterInput, &mut Events) + Send + 'static,
        steps: &[&[OutputEvent]],
    ) -> Vec<Vec<OutputEvent>> {
        let mut filters = PressFilters::default();
        filters.add(Box::new(Filter(filter)));
        let mut held = PressedKeys::default();
        let apply = |step: &&[OutputEvent]| {
            for event in *step {
                match event.kind {
                    EventKind::KeyDown(key) => held.press(key),
                    EventKind::KeyUp(key) => held.release(key),
                    _ => false,
                };
            }
            let mut events = Events::from_iter(step.iter().copied());
            let pose = HandPose::new(Timestamp(1_000), Side::Right, 0.006);
            let input = FilteredStep {
                pose: &pose,
                scene: &Scene::new(),
                presses: &[],
                may_type: true,
            };
            filters.apply(None, input, || held.clone(), 0, &mut events);
            events.to_vec()
        };
        steps.iter().map(apply).collect()
    }

    #[test]
    fn a_filter_may_replace_a_press() {
        let to_b = |_: &FilterInput, events: &mut Events| {
            for event in events {
                if event.kind == EventKind::KeyDown(key("A")) {
                    event.kind = EventKind::KeyDown(key("B"));
                }
            }
        };
        let steps = filtered(to_b, &[&[down(key("A"))], &[up(key("A"))]]);
        // No control holds B, so it is tapped; the gate suppresses the release of A.
        assert_eq!(steps[0], [down(key("B")), up(key("B"))]);
        assert_eq!(steps[1], [up(key("A"))]);
    }

    #[test]
    fn a_release_is_not_held() {
        let steps = filtered(
            |_, events| events.clear(),
            &[&[down(key("A"))], &[up(key("A")), down(key("B"))]],
        );
        assert_eq!(steps, [vec![], vec![up(key("A"))]]);
    }

    #[test]
    fn a_press_that_is_held_beyond_its_release_becomes_a_tap() {
        let mut held = None;
        let delay = move |_: &FilterInput, events: &mut Events| {
            let press = events
                .iter()
                .position(|event| matches!(event.kind, EventKind::KeyDown(_)));
            match press {
                Some(index) => held = Some(events.remove(index)),
                None => events.extend(held.take()),
            }
        };
        let steps = filtered(delay, &[&[down(key("A")), up(key("A"))], &[]]);
        assert_eq!(steps[0], [up(key("A"))]);
        assert_eq!(steps[1], [down(key("A")), up(key("A"))]);
    }

    #[test]
    fn a_key_that_a_control_holds_stays_down() {
        let steps = filtered(|_, _| {}, &[&[down(key("A"))], &[], &[up(key("A"))]]);
        assert_eq!(steps, [vec![down(key("A"))], vec![], vec![up(key("A"))]]);
    }

    #[test]
    fn a_filter_sees_the_keys_that_were_held_before_the_step() {
        let (log, seen) = mpsc::channel();
        let look = move |input: &FilterInput, _: &mut Events| {
            let held = input.held.release_order().map(|key| key.to_string());
            log.send(held.collect::<Vec<_>>()).unwrap();
        };
        let steps: [&[OutputEvent]; 3] = [&[down(key("A"))], &[up(key("A")), down(key("B"))], &[]];
        filtered(look, &steps);
        let seen: Vec<_> = seen.try_iter().collect();
        assert_eq!(seen, [vec![], vec!["A"], vec!["B"]]);
    }

    #[test]
    fn a_full_list_drops_presses_and_no_release() {
        let flood = |_: &FilterInput, events: &mut Events| {
            while events.len() < events.capacity() {
                events.push(down(key("B")));
            }
        };
        let steps = filtered(flood, &[&[down(key("A"))], &[up(key("A"))]]);
        for step in steps {
            let count = |kind| step.iter().filter(|event| event.kind == kind).count();
            assert_eq!(
                count(EventKind::KeyDown(key("B"))),
                count(EventKind::KeyUp(key("B")))
            );
            assert!(step.len() > 180);
        }
    }

    #[test]
    fn characters_and_motions_leave_room_for_the_releases_after_them() {
        for filler in [EventKind::Character('ñ'), EventKind::MoveBy(1, 0)] {
            let flood = move |_: &FilterInput, events: &mut Events| {
                // It becomes a tap, which takes one event more.
                events.insert(0, down(key("B")));
                while events.len() < events.capacity() {
                    events.insert(1, event(filler));
                }
            };
            let steps = filtered(flood, &[&[down(key("A"))], &[up(key("A"))]]);
            assert_eq!(steps[1].last(), Some(&up(key("A"))), "{filler:?}");
            assert_eq!(steps[1][..2], [down(key("B")), up(key("B"))]);
        }
    }
}
