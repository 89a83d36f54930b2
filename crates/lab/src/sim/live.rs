//! Simulated hands that plan one step of their task after the other, for a layout that may change.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use super::action::HandAction;
use super::action_error::ActionErrorKind;
use super::motor::TypingKeys;
use super::movement::Movement;
use super::planner::HandState;
use super::sensed_hand::{SensedHand, hand_for};
use super::simulated_hand::{Progress, SimulatedHand};
use super::task::{HandTask, TaskStep};
use crate::contact::TargetId;
use crate::contact::surface::Scene;
use crate::hand::Side;
use crate::layout::Layout;
use crate::message::escape;

/// Most messages about one layout.
const MAX_MESSAGES: usize = 8;

/// A task that is planned while it is performed. Steps that the layout does not permit are skipped.
pub(super) struct LiveTask {
    task: HandTask,
    /// The text or script for the layout.
    resolved: HandTask,
    steps: Vec<TaskStep>,
    /// Index of the step that is planned next.
    next: usize,
    layout: Arc<Layout>,
    states: Vec<HandState>,
    /// Movements of the present step that have not begun, with the index of their hand.
    movements: VecDeque<(usize, Vec<Movement>)>,
    /// The hand of the last action.
    hand: usize,
    has_returned: bool,
    period: Duration,
    /// The messages about this layout.
    said: BTreeSet<String>,
    unsaid: Vec<String>,
}

impl LiveTask {
    /// Starts at the first step that the hands can do; they are shown above its target first.
    pub(super) fn start(
        task: HandTask,
        layout: Arc<Layout>,
        hands: &mut [SensedHand],
        period: Duration,
    ) -> Self {
        let mut live = Self::new(task, layout, 0, hands, period);
        let scene = &live.layout.scene;
        let sides = sides(hands);
        let first = live.steps.iter().find(|step| {
            let mut actions = step.actions.iter();
            let mut states = live.states.clone();
            let can_do = |action: &HandAction| {
                let hand = hand_for(action, scene, &sides, 0);
                states[hand]
                    .add(std::slice::from_ref(action), scene, period)
                    .is_ok()
            };
            step.actions.iter().any(|it| it.target().is_some()) && actions.all(can_do)
        });
        let actions = first.map_or(Vec::new(), |step| step.actions.clone());
        let actions = if actions.is_empty() {
            vec![HandAction::Lift]
        } else {
            actions
        };
        for (index, hand) in hands.iter_mut().enumerate() {
            let is_own = |action: &&HandAction| hand_for(action, scene, &sides, 0) == index;
            let own: Vec<HandAction> = actions.iter().filter(is_own).cloned().collect();
            let state = &mut live.states[index];
            let own = if own.is_empty() {
                vec![HandAction::Lift]
            } else {
                own
            };
            let movements = state.begin(&own, scene, period);
            hand.hand.set_posture(&state.values);
            hand.hand.append(movements);
        }
        live
    }

    /// Continues at the step with the index `next`, from the present postures of the hands.
    pub(super) fn resume(
        task: HandTask,
        layout: Arc<Layout>,
        next: usize,
        hands: &mut [SensedHand],
        period: Duration,
    ) -> Self {
        let mut live = Self::new(task, layout, next, hands, period);
        for (state, hand) in live.states.iter_mut().zip(hands) {
            hand.hand.stop();
            state.displace(hand.hand.values());
        }
        live
    }

    fn new(
        task: HandTask,
        layout: Arc<Layout>,
        next: usize,
        hands: &[SensedHand],
        period: Duration,
    ) -> Self {
        let resolved = task.resolve(&layout);
        let keys = TypingKeys::new(&layout);
        let state = |hand: &SensedHand| {
            let mut state = hand.hand.state();
            state.motor.keys.clone_from(&keys);
            state
        };
        Self {
            steps: resolved.steps(&layout),
            task,
            resolved,
            next,
            states: hands.iter().map(state).collect(),
            layout,
            movements: VecDeque::new(),
            hand: 0,
            has_returned: false,
            period,
            said: BTreeSet::new(),
            unsaid: Vec::new(),
        }
    }

    /// Returns the targets of the layout.
    pub(super) fn scene(&self) -> &Scene {
        &self.layout.scene
    }

    /// Continues with another layout. `hands` may be anywhere, but press nothing that they need.
    pub(super) fn set_layout(self, layout: Arc<Layout>, hands: &mut [SensedHand]) -> Self {
        let next = if self.has_returned || self.is_step_done(hands) {
            self.next
        } else {
            rewound(&self.steps, self.next.saturating_sub(1), hands)
        };
        let resolved = self.task.resolve(&layout);
        let next = if resolved.is_same(&self.resolved) {
            next
        } else {
            0
        };
        let mut live = Self::resume(self.task, layout, next, hands, self.period);
        for (state, old) in live.states.iter_mut().zip(&self.states) {
            state.keep_habits(old);
        }
        live
    }

    /// Returns `true` if the hands are between two steps, and press nothing.
    pub(super) fn is_between_steps(&self, hands: &[SensedHand]) -> bool {
        let is_idle = |hand: &SensedHand| !hand.hand.has_movements() && !hand.hand.is_down();
        self.movements.is_empty() && hands.iter().all(is_idle)
    }

    /// Continues with other hands in the same postures, between two steps.
    pub(super) fn set_hands(&mut self, hands: &[SensedHand]) {
        for (state, hand) in self.states.iter_mut().zip(hands) {
            state.set_person(hand.hand.state());
        }
    }

    /// Returns `true` if the step before the next one is complete.
    fn is_step_done(&self, hands: &[SensedHand]) -> bool {
        let is_idle = hands.iter().all(|hand| !hand.hand.has_movements());
        let is_lifting = hands.iter().any(|hand| hand.hand.is_lifting());
        self.movements.is_empty() && (is_idle || is_lifting)
    }

    /// Moves the hands by one packet. Returns `false` at the end.
    pub(super) fn advance(&mut self, hands: &mut [SensedHand], repeats: bool) -> bool {
        if hands.iter().all(|hand| !hand.hand.has_movements()) && !self.plan_next(hands, repeats) {
            return false;
        }
        for hand in hands {
            let progress = hand.hand.advance(usize::MAX);
            debug_assert_ne!(progress, Progress::Waiting, "a live hand has no limit");
        }
        true
    }

    /// Assigns the movements of the next step to the hands, if it has any. Returns `false` at the end.
    fn plan_next(&mut self, hands: &mut [SensedHand], repeats: bool) -> bool {
        if self.movements.is_empty() && self.next < self.steps.len() {
            self.plan_step(&sides(hands));
        }
        if let Some((hand, movements)) = self.movements.pop_front() {
            hands[hand].hand.append(movements);
            return true;
        }
        if self.next < self.steps.len() {
            return true;
        }
        if self.has_returned && !repeats {
            return false;
        }
        if self.has_returned {
            self.next = 0;
            self.has_returned = false;
            return true;
        }
        self.has_returned = true;
        for (state, hand) in self.states.iter_mut().zip(hands) {
            hand.hand.append(state.end(&self.layout.scene, self.period));
        }
        true
    }

    fn plan_step(&mut self, sides: &[Side]) {
        let step = self.steps[self.next].clone();
        self.next += 1;
        if let Some(problem) = step.problem {
            return self.skip(&step.name, problem);
        }
        let before = self.states.clone();
        for action in &step.actions {
            let scene = &self.layout.scene;
            let hand = hand_for(action, scene, sides, self.hand);
            let added = self.states[hand].add(std::slice::from_ref(action), scene, self.period);
            match added {
                Ok(movements) => {
                    self.hand = hand;
                    self.movements.push_back((hand, movements));
                }
                Err(kind) => {
                    self.states = before;
                    self.movements.clear();
                    // The press before it was skipped.
                    if kind != ActionErrorKind::NotPressed {
                        let problem = describe(&kind, action, &self.layout);
                        self.skip(&step.name, problem);
                    }
                    return;
                }
            }
        }
    }

    fn skip(&mut self, name: &str, problem: String) {
        let file = escape(&self.layout.file);
        let message = format!("{file}: the simulated hand leaves out {name}: {problem}");
        if self.said.len() < MAX_MESSAGES && self.said.insert(message.clone()) {
            self.unsaid.push(message);
        }
    }

    /// Removes the messages that were not passed on yet.
    pub(super) fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.unsaid)
    }
}

/// Returns the index of the step from which an interrupted step `index` is done again: the step of the press, if the hand
/// presses and drags.
pub(super) fn rewound(steps: &[TaskStep], index: usize, hands: &[SensedHand]) -> usize {
    let is_down = hands.iter().any(|hand| hand.hand.is_down());
    let action = |step: &TaskStep| step.actions.first().cloned();
    let drags = |step: &TaskStep| {
        matches!(
            action(step),
            Some(HandAction::Slide(..) | HandAction::Arc(..))
        )
    };
    let presses = |step: &TaskStep| {
        matches!(
            action(step),
            Some(HandAction::Press(_) | HandAction::Push(..))
        )
    };
    let rest = steps.get(index..).unwrap_or_default();
    let ends =
        |step: &&TaskStep| matches!(action(step), Some(HandAction::Lift | HandAction::Tap(_)));
    let drags_on = rest.iter().take_while(|step| !ends(step)).any(drags);
    if is_down && drags_on {
        (0..=index.min(steps.len().saturating_sub(1)))
            .rev()
            .find(|&step| presses(&steps[step]))
            .unwrap_or(index)
    } else {
        index
    }
}

fn sides(hands: &[SensedHand]) -> Vec<Side> {
    hands.iter().map(|hand| hand.side).collect()
}

/// Returns the reason why an action is impossible, with the names of targets.
fn describe(kind: &ActionErrorKind, action: &HandAction, layout: &Layout) -> String {
    let names = layout.target_names();
    let name = |target: TargetId| {
        let name = names.get(target).to_string();
        escape(&name).to_string()
    };
    match kind {
        ActionErrorKind::OutOfReach {
            target: Some(target),
            metres,
        } if metres.is_finite() => {
            format!("`{}` is {:.0} mm out of reach", name(*target), metres * 1e3)
        }
        ActionErrorKind::OutOfReach {
            target: Some(target),
            ..
        } => format!("`{}` is reserved for the other hand", name(*target)),
        ActionErrorKind::WouldPress { finger, target } => {
            format!("the {} would press `{}`", finger.in_words(), name(*target))
        }
        ActionErrorKind::NotOnBoard => match action.target_point() {
            Some(point) => format!("`{}` is on no board", name(point.target)),
            None => kind.to_string(),
        },
        _ => kind.to_string(),
    }
}

impl SimulatedHand {
    /// Returns the state of the hand in its present posture.
    fn state(&self) -> HandState {
        let mut state = HandState::new(self.hand().clone(), self.motor().clone());
        state.values.copy_from_slice(self.values());
        state
    }
}
