//! The hands of a simulated person, and which of them performs an action.

use super::action::HandAction;
use super::simulated_hand::SimulatedHand;
use crate::contact::surface::Scene;
use crate::hand::Side;

/// A hand with its side.
#[derive(Clone)]
pub(super) struct SensedHand {
    pub(super) side: Side,
    pub(super) hand: SimulatedHand,
}

/// Assigns each action to the hand for which the board of its target is made, otherwise to the first hand. An action
/// without a target goes to the hand of the action before it.
pub(super) fn assign_hands(actions: &[HandAction], scene: &Scene, sides: &[Side]) -> Vec<usize> {
    let mut hand = 0;
    let assign = |action: &HandAction| {
        hand = hand_for(action, scene, sides, hand);
        hand
    };
    actions.iter().map(assign).collect()
}

/// Returns the index of the hand that performs an action after one of the hand `previous`.
pub(super) fn hand_for(
    action: &HandAction,
    scene: &Scene,
    sides: &[Side],
    previous: usize,
) -> usize {
    let Some(target) = action.target() else {
        return previous;
    };
    let found = scene.target(target);
    let side = found.and_then(|(surface, _)| surface.side());
    let index = side.and_then(|side| sides.iter().position(|other| *other == side));
    index.unwrap_or(0)
}
