//! Radial menus: a press opens sectors around the fingertip, and a release over one of them taps its action.

use std::f32::consts::TAU;

use arrayvec::ArrayVec;
use parry3d::math::Vec2;

use super::grips::Grips;
use super::pending_returns::PendingReturns;
use super::steps::snap;
use super::target_index::TargetIndex;
use super::value_output::{ValueEmitter, ValueOutput};
use super::{
    Capabilities, Capability, DeviceInput, DeviceOutput, KeyAction, KeyCode, Latch, PressSource,
    VirtualDevice,
};
use crate::contact::{Phase, TargetId, Touch};
use crate::time::Timestamp;

/// The largest number of sectors of a menu: more are narrower than the tremor of a hand.
pub const MAX_SECTORS: usize = 8;

/// The largest number of modifiers that a choice holds: Control, Shift, Alt and Meta.
pub const MAX_MODIFIERS: usize = 4;

/// The radius within which a fingertip re-enters a dead zone, as a fraction of the radius of the dead zone. The hysteresis keeps the
/// highlighted sector the same while a fingertip trembles at the edge.
const REENTRY_FRACTION: f32 = 0.8;

/// A radial menu. It opens around the position at which a fingertip presses its hub.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialMenu {
    /// The target that is its front.
    pub target: TargetId,
    /// Radius of the front, in metres, more than 0. At this distance from the center of the menu a fingertip opens a nested menu.
    pub radius: f32,
    /// Radius of the hub and of the dead zone around the fingertip, in metres, less than the radius of the front.
    pub hub_radius: f32,
    /// The sectors, clockwise; the middle of the first one is away from the wearer. 2 to [`MAX_SECTORS`].
    pub sectors: Vec<Sector>,
    /// The state with which it is drawn.
    pub shown: MenuState,
}

/// A sector of a radial menu.
#[derive(Clone, Debug, PartialEq)]
pub enum Sector {
    /// An action.
    Choice(Choice),
    /// A nested menu.
    Menu {
        /// The text drawn on it.
        label: String,
        /// The sectors, 2 to [`MAX_SECTORS`].
        choices: Vec<Choice>,
    },
}

/// An action of a radial menu.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The text drawn on it.
    pub label: String,
    /// The action that is tapped.
    pub action: KeyAction,
    /// The modifiers that are held during the tap.
    pub modifiers: ArrayVec<KeyCode, MAX_MODIFIERS>,
}

/// The highlighted part of a menu.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MenuState {
    /// Closed, or the fingertip is in the dead zone: a release fires nothing.
    #[default]
    Idle,
    /// The sector with this index is highlighted.
    Sector(usize),
    /// The nested menu of the sector with this index is open, and the fingertip is in its dead zone.
    Nested(usize),
    /// A choice of the nested menu of a sector is highlighted: their indices.
    Choice(usize, usize),
}

impl Sector {
    /// Returns the text drawn on it.
    pub fn label(&self) -> &str {
        match self {
            Self::Choice(choice) => &choice.label,
            Self::Menu { label, .. } => label,
        }
    }

    /// Returns its nested menu; empty if it has none.
    pub fn nested(&self) -> &[Choice] {
        match self {
            Self::Choice(_) => &[],
            Self::Menu { choices, .. } => choices,
        }
    }
}

impl RadialMenu {
    /// Returns all states in the order of their values: idle, the sectors, each nested menu with its choices.
    fn states(&self) -> impl Iterator<Item = MenuState> {
        let sectors = (0..self.sectors.len()).map(MenuState::Sector);
        let nested = self.sectors.iter().enumerate();
        let nested = nested.filter(|(_, sector)| !sector.nested().is_empty());
        let nested = nested.flat_map(|(index, sector)| {
            let choices = 0..sector.nested().len();
            let choices = choices.map(move |choice| MenuState::Choice(index, choice));
            [MenuState::Nested(index)].into_iter().chain(choices)
        });
        [MenuState::Idle].into_iter().chain(sectors).chain(nested)
    }

    /// Returns the value of a state: its index among all states as a fraction of the last index; 0 is idle.
    pub fn value(&self, state: MenuState) -> f32 {
        let index = self.states().position(|other| other == state).unwrap_or(0);
        index as f32 / self.last_index()
    }

    /// Returns the state with a value.
    pub fn state(&self, value: f32) -> MenuState {
        let index = (value * self.last_index()).round().max(0.0) as usize;
        self.states().nth(index).unwrap_or_default()
    }

    fn last_index(&self) -> f32 {
        (self.states().count() - 1) as f32
    }

    /// Returns the label of the highlighted sector, or of the nested menu that is open; `None` if the menu is idle.
    pub fn label(&self, state: MenuState) -> Option<&str> {
        match state {
            MenuState::Idle => None,
            MenuState::Sector(index) | MenuState::Nested(index) => {
                Some(self.sectors.get(index)?.label())
            }
            MenuState::Choice(index, choice) => {
                Some(&self.sectors.get(index)?.nested().get(choice)?.label)
            }
        }
    }

    /// Returns the choice that a release fires.
    fn choice(&self, state: MenuState) -> Option<&Choice> {
        match state {
            MenuState::Idle | MenuState::Nested(_) => None,
            MenuState::Sector(index) => match self.sectors.get(index)? {
                Sector::Choice(choice) => Some(choice),
                Sector::Menu { .. } => None,
            },
            MenuState::Choice(index, choice) => self.sectors.get(index)?.nested().get(choice),
        }
    }

    /// Returns the sector of `count` at an offset from the center of a menu, in metres; `None` in the dead zone. The sector that is
    /// highlighted, and the dead zone, have hysteresis at their borders.
    fn sector_at(&self, offset: Vec2, count: usize, highlighted: Option<usize>) -> Option<usize> {
        let dead_radius = match highlighted {
            Some(_) => self.hub_radius * REENTRY_FRACTION,
            None => self.hub_radius,
        };
        if offset.length() <= dead_radius || count == 0 {
            return None;
        }
        let turn = offset.x.atan2(offset.y) / TAU;
        let turn = highlighted.map_or(turn, |highlighted| {
            let current = highlighted as f32 / count as f32;
            let difference = turn - current;
            let nearest = current + difference - difference.round();
            snap(nearest, Some(count as u16), current)
        });
        let index = (turn * count as f32).round() as isize;
        Some(index.rem_euclid(count as isize) as usize)
    }
}

/// A fingertip in an open menu.
#[derive(Clone, Copy, Debug)]
struct OpenMenu {
    /// Center of the menu on the front, in metres: the position of the press.
    center: Vec2,
    /// Center of the nested menu on the front, in metres; unused while none is open.
    nested_center: Vec2,
    state: MenuState,
}

impl OpenMenu {
    /// Moves the fingertip to a position on the front, in metres.
    fn move_to(&mut self, position: Vec2, menu: &RadialMenu) {
        if !position.is_finite() {
            return;
        }
        let offset = position - self.center;
        let (index, choice) = match self.state {
            MenuState::Idle => return self.move_in_outer(offset, None, position, menu),
            MenuState::Sector(index) => {
                return self.move_in_outer(offset, Some(index), position, menu);
            }
            MenuState::Nested(index) => (index, None),
            MenuState::Choice(index, choice) => (index, Some(choice)),
        };
        if offset.length() <= menu.hub_radius * REENTRY_FRACTION {
            self.state = MenuState::Idle;
            return;
        }
        let count = menu.sectors.get(index).map_or(0, |it| it.nested().len());
        let choice = menu.sector_at(position - self.nested_center, count, choice);
        self.state = choice.map_or(MenuState::Nested(index), |choice| {
            MenuState::Choice(index, choice)
        });
    }

    fn move_in_outer(
        &mut self,
        offset: Vec2,
        highlighted: Option<usize>,
        position: Vec2,
        menu: &RadialMenu,
    ) {
        let sector = menu.sector_at(offset, menu.sectors.len(), highlighted);
        self.state = sector.map_or(MenuState::Idle, MenuState::Sector);
        let nested = sector.and_then(|index| menu.sectors.get(index));
        let is_beyond = offset.length() >= menu.radius;
        if let (Some(index), Some(Sector::Menu { .. }), true) = (sector, nested, is_beyond) {
            self.state = MenuState::Nested(index);
            self.nested_center = position;
        }
    }
}

/// The radial menus of a layout.
///
/// A fingertip that presses a hub opens its menu around the fingertip. Beyond the dead zone the sector in its direction is
/// highlighted, and the release of the press taps the action of that sector. The release in a dead zone, or over a sector with a
/// nested menu, fires nothing. A fingertip that slides over a sector with a nested menu by the radius of the front opens that menu
/// around the fingertip; back in the dead zone of the outer menu, it closes the nested one. A fingertip that slides off the front,
/// lifts [in a gap](crate::kinematics::HandPose::is_after_gap) or is lost fires nothing, nor does [`VirtualDevice::release_all`].
/// Other fingertips on the same menu are ignored.
///
/// The value tells which part is highlighted, see [`RadialMenu::value`].
#[derive(Clone, Debug)]
pub struct RadialMenus {
    menus: Vec<(RadialMenu, ValueEmitter)>,
    index: TargetIndex,
    grips: Grips<OpenMenu>,
    pending_returns: PendingReturns,
}

impl RadialMenus {
    /// Creates the menus, all closed.
    pub fn new(menus: Vec<RadialMenu>) -> Self {
        let with_emitter = |menu: RadialMenu| {
            let emitter = ValueEmitter::new(menu.target, ValueOutput::ValueOnly, 0.0);
            (menu, emitter.with_rest(Some(0.0)))
        };
        Self {
            index: TargetIndex::new(menus.iter().map(|menu| menu.target)),
            grips: Grips::new(),
            pending_returns: PendingReturns::with_capacity(menus.len()),
            menus: menus.into_iter().map(with_emitter).collect(),
        }
    }

    fn open(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.close(touch, out);
        let Some(index) = self.index.get(touch.target) else {
            return;
        };
        let (menu, _) = &self.menus[index];
        let is_on_hub = touch.position.length() <= menu.hub_radius;
        if !is_on_hub || self.grips.on_control(index).is_some() {
            return;
        }
        self.pending_returns.cancel(index);
        let open = OpenMenu {
            center: touch.position,
            nested_center: touch.position,
            state: MenuState::Idle,
        };
        self.grips.grab(touch, index, open);
    }

    fn follow(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.get_mut(touch) else {
            return;
        };
        let (menu, emitter) = &mut self.menus[grip.control];
        grip.state.move_to(touch.position, menu);
        emitter.set(menu.value(grip.state.state), touch.time, out);
    }

    /// Fires what is highlighted. The position of the release is ignored: a fingertip slips when it lifts. After a gap nothing is
    /// fired: the fingertip may have left the sector before it lifted.
    fn fire(&mut self, touch: &Touch, is_after_gap: bool, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.get_mut(touch) else {
            return;
        };
        let (menu, _) = &self.menus[grip.control];
        if let Some(choice) = menu.choice(grip.state.state).filter(|_| !is_after_gap) {
            tap(choice, touch, out);
        }
        self.close(touch, out);
    }

    /// Closes the menu of a fingertip, if it has one open.
    fn close(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        if let Some(grip) = self.grips.release(touch) {
            self.close_menu(grip.control, touch.time, out);
        }
    }

    fn close_menu(&mut self, index: usize, time: Timestamp, out: &mut DeviceOutput) {
        let (_, emitter) = &mut self.menus[index];
        self.pending_returns.start(index, emitter, time, out);
    }
}

/// Taps a choice. Taps nothing if not all of its events fit, or if the hand may only point and the choice has modifiers, because the
/// modifiers alone or the action alone would have another meaning.
fn tap(choice: &Choice, touch: &Touch, out: &mut DeviceOutput) {
    let source = PressSource::from_touch(touch);
    let mut modifiers = choice.modifiers.iter();
    let modifier = |&code: &KeyCode| KeyAction::Modifier(code, Latch::Momentary);
    if modifiers
        .clone()
        .any(|code| out.arbiter.drops(source, modifier(code)))
    {
        return;
    }
    let fits = modifiers.all(|code| {
        out.arbiter
            .press(source, modifier(code), touch.time, out.events)
    });
    if choice.modifiers.is_empty() || (fits && out.arbiter.has_room(out.events)) {
        out.tap(source, choice.action, touch.time);
    } else {
        out.cancel(source, touch.time);
    }
}

impl VirtualDevice for RadialMenus {
    fn add_capabilities(&self, required: &mut Capabilities) {
        let sectors = self.menus.iter().flat_map(|(menu, _)| &menu.sectors);
        for sector in sectors {
            let choices = match sector {
                Sector::Choice(choice) => std::slice::from_ref(choice),
                Sector::Menu { choices, .. } => choices,
            };
            for choice in choices {
                required.extend(choice.action.required_capability());
                required.extend(choice.modifiers.iter().copied().map(Capability::Key));
            }
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        self.pending_returns
            .retry(&mut self.menus, input.pose.time, out);
        for touch in input.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.open(touch, out),
                Phase::Moved => self.follow(touch, out),
                Phase::Released => self.fire(touch, input.pose.is_after_gap, out),
                Phase::Left | Phase::Cancelled => self.close(touch, out),
            }
        }
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.grips.clear();
        for index in 0..self.menus.len() {
            self.close_menu(index, time, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::surface::Scene;
    use crate::device::{EventKind, Events, KeyArbiter, TimedCommands};
    use crate::hand::{Finger, JointAngles, Side};
    use crate::kinematics::HandPose;

    /// Returns the keys and buttons that a right hand presses and releases by choosing Control and a click.
    fn click_with_control(may_type: bool) -> Vec<EventKind> {
        let control: KeyCode = "ControlLeft".parse().expect("the name of a key");
        let choice = Choice {
            label: "Add".to_owned(),
            action: KeyAction::Key(KeyCode::MOUSE_LEFT),
            modifiers: ArrayVec::from_iter([control]),
        };
        let mut menus = RadialMenus::new(vec![RadialMenu {
            target: TargetId(0),
            radius: 0.03,
            hub_radius: 0.012,
            sectors: vec![Sector::Choice(choice.clone()), Sector::Choice(choice)],
            shown: MenuState::Idle,
        }]);
        let way = [
            (Phase::Pressed, 0.0),
            (Phase::Moved, 0.02),
            (Phase::Released, 0.02),
        ];
        let touches = way.map(|(phase, away)| Touch {
            time: Timestamp(0),
            side: Side::Right,
            finger: Finger::Index,
            target: TargetId(0),
            phase,
            depth: 1.0,
            position: Vec2::new(0.0, away),
        });
        let input = DeviceInput {
            scene: &Scene::new(),
            angles: &JointAngles::default(),
            bends: &Default::default(),
            inputs: &Default::default(),
            pose: &HandPose::new(Timestamp(0), Side::Right, 0.005),
            touches: &touches,
            presses: &[],
        };
        let mut arbiter = KeyArbiter::default();
        arbiter.begin_step(Side::Right, [!may_type; Side::COUNT]);
        let mut events = Events::new();
        let mut out = DeviceOutput {
            arbiter: &mut arbiter,
            events: &mut events,
            commands: &mut TimedCommands::new(),
        };
        menus.update(&input, &mut out);
        assert!(arbiter.is_idle());
        assert_eq!(arbiter.take_dropped_presses(), u64::from(!may_type));
        let kinds = events.iter().map(|event| event.kind);
        kinds
            .filter(|kind| matches!(kind, EventKind::KeyDown(_) | EventKind::KeyUp(_)))
            .collect()
    }

    #[test]
    fn a_hand_that_may_only_point_does_not_click_without_the_modifiers_of_a_choice() {
        let control = "ControlLeft".parse().expect("the name of a key");
        assert_eq!(
            click_with_control(true),
            [
                EventKind::KeyDown(control),
                EventKind::KeyDown(KeyCode::MOUSE_LEFT),
                EventKind::KeyUp(KeyCode::MOUSE_LEFT),
                EventKind::KeyUp(control),
            ]
        );
        assert_eq!(click_with_control(false), []);
    }
}
