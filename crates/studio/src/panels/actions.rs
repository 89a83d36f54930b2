//! The actions with their keys: one table for the toolbar, the keyboard and the list of keys.

use eframe::egui::{Context, Event, InputState, Key, KeyboardShortcut, Modifiers, Ui};

use super::editor::{self, EditorPanel};
use super::table::{SCOPE, SENSORS};
use super::{PanelContext, PanelState, Workspace};
use crate::camera::Viewpoint;
use crate::model::StudioModel;
use crate::texts::text;
use ademan_core::command::Command;

/// An action of the person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    Pause,
    Recenter,
    Zero,
    Look(Viewpoint),
    Bones,
    Opaque,
    Trails,
    Reach,
    Fingertip,
    Devices,
    /// Shows or hides a panel.
    Show(&'static str),
    NextPanel,
    PreviousPanel,
    Keys,
}

/// An action with its key, and the keys of its words.
pub(super) struct ActionSpec {
    pub action: Action,
    pub name: &'static str,
    pub hint: &'static str,
    shortcut: KeyboardShortcut,
    /// The shortcut acts while words are edited, and during a calibration.
    is_global: bool,
}

const fn spec(
    action: Action,
    (modifiers, key): (Modifiers, Key),
    name: &'static str,
    hint: &'static str,
) -> ActionSpec {
    ActionSpec {
        action,
        name,
        hint,
        shortcut: KeyboardShortcut::new(modifiers, key),
        is_global: false,
    }
}

const fn global(spec: ActionSpec) -> ActionSpec {
    ActionSpec {
        is_global: true,
        ..spec
    }
}

const fn plain(key: Key) -> (Modifiers, Key) {
    (Modifiers::NONE, key)
}

/// All actions. A shortcut with more modifiers stands before one with fewer.
pub(super) const ACTIONS: [ActionSpec; 17] = [
    spec(Action::Pause, plain(Key::P), "button-pause", "hint-pause"),
    spec(
        Action::Recenter,
        plain(Key::C),
        "button-recenter",
        "hint-recenter",
    ),
    spec(Action::Zero, plain(Key::Z), "button-zero", "hint-zero"),
    spec(
        Action::Look(Viewpoint::Eye),
        plain(Key::Num1),
        "view-eye",
        "hint-view",
    ),
    spec(
        Action::Look(Viewpoint::Above),
        plain(Key::Num2),
        "view-above",
        "hint-view",
    ),
    spec(
        Action::Look(Viewpoint::Side),
        plain(Key::Num3),
        "view-side",
        "hint-view",
    ),
    spec(Action::Bones, plain(Key::B), "view-bones", "hint-view"),
    spec(Action::Opaque, plain(Key::O), "view-opaque", "hint-view"),
    spec(Action::Trails, plain(Key::T), "view-trails", "hint-view"),
    spec(Action::Reach, plain(Key::R), "view-reach", "hint-view"),
    spec(
        Action::Fingertip,
        plain(Key::M),
        "button-fingertip",
        "hint-fingertip",
    ),
    global(spec(
        Action::Devices,
        plain(Key::F9),
        "menu-devices",
        "devices-hint",
    )),
    global(spec(
        Action::Show(SENSORS),
        plain(Key::F7),
        SENSORS,
        "hint-panel",
    )),
    global(spec(
        Action::Show(SCOPE),
        plain(Key::F8),
        SCOPE,
        "hint-panel",
    )),
    global(spec(
        Action::PreviousPanel,
        (Modifiers::SHIFT, Key::F6),
        "keys-previous-panel",
        "hint-panel",
    )),
    global(spec(
        Action::NextPanel,
        plain(Key::F6),
        "keys-next-panel",
        "hint-panel",
    )),
    global(spec(
        Action::Keys,
        plain(Key::F1),
        "keys-title",
        "hint-panel",
    )),
];

/// The other key of the list of keys.
const HELP: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::Questionmark);

/// Keys of panels and of the toolkit: names of the keys, and the key of the words.
pub(super) const OTHER_KEYS: [(&str, &str); 9] = [
    ("←↑↓→", "keys-orbit"),
    ("Shift+←↑↓→", "keys-pan"),
    ("+, −", "keys-zoom"),
    ("Tab, Shift+Tab", "keys-tab"),
    ("Space, Enter", "keys-operate"),
    ("Esc", "keys-escape"),
    ("Ctrl+K", "keys-palette"),
    ("Ctrl+Plus, Ctrl+Minus", "keys-scale"),
    ("Ctrl+0", "keys-normal-scale"),
];

impl Action {
    /// Returns the entry of the table.
    pub fn spec(self) -> &'static ActionSpec {
        const TABLE: &[ActionSpec] = &ACTIONS;
        let own = TABLE.iter().find(|spec| spec.action == self);
        own.expect("each action has an entry")
    }

    /// Returns the word on the button.
    pub fn name(self, model: &StudioModel) -> &'static str {
        match self {
            Self::Pause if model.view.state.paused_by.is_some() => text("button-resume"),
            _ => text(self.spec().name),
        }
    }

    /// Returns `true` unless the action is for a session and none is shown.
    pub fn is_enabled(self, context: &PanelContext) -> bool {
        if self == Self::Fingertip {
            return context.player.is_none() && !context.session.has_ended;
        }
        if self == Self::Devices {
            return context.can_open;
        }
        let is_command = matches!(self, Self::Pause | Self::Recenter | Self::Zero);
        !is_command || (!context.session.has_ended && !context.is_replay)
    }

    /// Performs the action.
    pub fn perform(self, ui: &Context, state: &mut PanelState, context: &mut PanelContext) {
        match self {
            Self::Pause if context.session.view.state.paused_by.is_some() => {
                context.sent.push(Command::Resume);
            }
            Self::Pause => context.sent.push(Command::Pause),
            Self::Recenter => context.sent.push(Command::Recenter),
            Self::Zero => context.sent.push(Command::Zero),
            Self::Look(viewpoint) => state.next_viewpoint = Some(viewpoint),
            Self::Bones => state.scene.bones = !state.scene.bones,
            Self::Opaque => state.scene.opaque = !state.scene.opaque,
            Self::Trails => state.scene.trails = !state.scene.trails,
            Self::Reach => state.scene.reach = !state.scene.reach,
            Self::Fingertip => state.is_fingertip = !state.is_fingertip,
            Self::Devices => state.devices.toggle(),
            Self::Show(panel) => state.toggle(panel),
            Self::NextPanel => move_focus(ui, state, 1),
            Self::PreviousPanel => move_focus(ui, state, -1),
            Self::Keys => state.shows_keys = !state.shows_keys,
        }
    }
}

impl ActionSpec {
    /// Returns the names of the keys.
    pub fn keys(&self, ui: &Context) -> String {
        ui.format_shortcut(&self.shortcut)
    }
}

/// An action that is offered, with its words and keys.
pub(super) type Offer = (Action, &'static str, String);

/// Returns the actions that can be performed now and act in every tab.
pub(super) fn offered(ui: &Context, context: &PanelContext) -> Vec<Offer> {
    const OFFERED: [Action; 5] = [
        Action::Pause,
        Action::Recenter,
        Action::Zero,
        Action::Devices,
        Action::Keys,
    ];
    let enabled = OFFERED.into_iter();
    let enabled = enabled.filter(|action| action.is_enabled(context));
    let offers = enabled.map(|action| {
        let name = action.name(context.session);
        (action, name, action.spec().keys(ui))
    });
    offers.collect()
}

/// Moves the focus to another panel.
fn move_focus(ui: &Context, state: &mut PanelState, step: isize) {
    let count = state.panel_ids.len() as isize;
    if count == 0 {
        return;
    }
    let index = state
        .focused_panel
        .map_or(-step.min(0), |index| index as isize + step);
    let index = index.rem_euclid(count) as usize;
    state.focused_panel = Some(index);
    ui.memory_mut(|memory| memory.request_focus(state.panel_ids[index]));
}

/// Performs the actions whose keys were pressed. Letters are left to words that are edited, and to a calibration that is shown. While a
/// question waits for an answer, only the pause acts.
pub(super) fn handle_keys(ui: &Ui, state: &mut PanelState, context: &mut PanelContext) {
    let is_editing = ui.ctx().text_edit_focused() || has_palette(state);
    if !is_editing {
        ui.input_mut(drop_held_clicks);
    }
    let is_calibrating =
        state.workspace == Workspace::Calibration && context.sensors.guide.is_some();
    let is_asked = editor::is_asked(ui);
    for spec in &ACTIONS {
        let is_left = (is_editing || is_calibrating) && !spec.is_global;
        if is_left || is_asked && spec.action != Action::Pause {
            continue;
        }
        let is_pressed = ui.input_mut(|input| {
            let is_help = spec.action == Action::Keys && !is_editing;
            take_press(input, &spec.shortcut) || is_help && take_press(input, &HELP)
        });
        if is_pressed && spec.action.is_enabled(context) {
            spec.action.perform(ui.ctx(), state, context);
        }
    }
}

/// Returns `true` while the palette of commands takes what is typed.
fn has_palette(state: &PanelState) -> bool {
    let editor = state
        .editor
        .as_ref()
        .and_then(|opened| opened.as_ref().ok());
    state.workspace == Workspace::Layout && editor.is_some_and(EditorPanel::has_palette)
}

/// Takes the presses of a shortcut. Returns `true` if the key went down: a key that is held repeats, and would resume what it has paused.
fn take_press(input: &mut InputState, shortcut: &KeyboardShortcut) -> bool {
    let goes_down = |event: &Event| match event {
        Event::Key {
            key,
            pressed: true,
            repeat: false,
            modifiers,
            ..
        } => *key == shortcut.logical_key && modifiers.matches_logically(shortcut.modifiers),
        _ => false,
    };
    let is_pressed = input.events.iter().any(goes_down);
    input.consume_shortcut(shortcut);
    is_pressed
}

/// Drops the repetitions of keys that operate a button: a key that is held clicks it once.
pub(super) fn drop_held_clicks(input: &mut InputState) {
    let is_held = |event: &Event| {
        matches!(
            event,
            Event::Key {
                key: Key::Space | Key::Enter,
                repeat: true,
                ..
            }
        )
    };
    input.events.retain(|event| !is_held(event));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shortcut_belongs_to_one_action() {
        for (index, spec) in ACTIONS.iter().enumerate() {
            let mut others = ACTIONS[index + 1..].iter();
            let same = others.find(|other| other.shortcut == spec.shortcut);
            assert!(same.is_none(), "{:?} twice", spec.shortcut);
        }
    }
}
