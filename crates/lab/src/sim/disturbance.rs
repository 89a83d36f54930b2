//! Controls that a simulated hand leaves alone: they end or pause the session, resume it against the will of a person, or change
//! the layout under the hand.

use std::collections::BTreeSet;

use crate::command::Command;
use crate::contact::TargetId;
use crate::device::KeyAction;
use crate::device::radial_menu::{Choice, Sector};
use crate::device::toggle::ToggleOutput;
use crate::layout::{Control, ControlKind, Key, Layout};

/// Returns the keys, controls and triggers with such an action in any layer.
pub(super) fn targets(layout: &Layout) -> BTreeSet<TargetId> {
    let keys = layout.keys.iter().filter(|key| is_key_disturbing(key));
    let keys = keys.map(|key| key.face.target);
    let controls = layout.controls.iter().flat_map(control_targets);
    let triggers = layout.triggers.iter().map(|(_, trigger)| trigger);
    let triggers = triggers.filter(|trigger| trigger.action.is_some_and(disturbs));
    let triggers = triggers.map(|trigger| trigger.target);
    keys.chain(controls).chain(triggers).collect()
}

/// Returns `true` if a target in space has such an action. The arm passes through targets that it does not aim at.
pub(super) fn is_in_space(layout: &Layout) -> bool {
    let spaces = layout.spaces.iter();
    let mut actions = spaces.flat_map(|targets| targets.space.actions.iter().flatten());
    actions.any(|action| disturbs(*action))
}

fn disturbs(action: KeyAction) -> bool {
    match action {
        KeyAction::Command(command) => !matches!(
            command,
            Command::State
                | Command::Recenter
                // They change what is typed, not the session.
                | Command::Text { .. }
                | Command::Candidate { .. }
        ),
        _ => false,
    }
}

fn is_key_disturbing(key: &Key) -> bool {
    let actions = key.actions.iter().flatten().copied();
    actions.chain(key.hold_action()).any(disturbs)
}

fn control_targets(control: &Control) -> Vec<TargetId> {
    match &control.kind {
        ControlKind::Toggle(toggle) if is_output_disturbing(toggle.output) => vec![toggle.target],
        ControlKind::Radio(radio) => {
            let options = radio.options.iter();
            let options = options.filter(|option| is_output_disturbing(option.output));
            options.map(|option| option.target).collect()
        }
        ControlKind::RadialMenu(menu) if menu.sectors.iter().any(is_sector_disturbing) => {
            vec![menu.target]
        }
        _ => Vec::new(),
    }
}

fn is_output_disturbing(output: ToggleOutput) -> bool {
    match output {
        ToggleOutput::Hold(action) | ToggleOutput::Tap(action) => disturbs(action),
        ToggleOutput::ValueOnly => false,
    }
}

fn is_sector_disturbing(sector: &Sector) -> bool {
    let is_disturbing = |choice: &Choice| disturbs(choice.action);
    match sector {
        Sector::Choice(choice) => is_disturbing(choice),
        Sector::Menu { choices, .. } => choices.iter().any(is_disturbing),
    }
}
