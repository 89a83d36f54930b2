//! A checked layout in SI units.

use std::ops::Range;
use std::time::Duration;

use parry3d::math::Vec2;

use super::board_shape::BoardShape;
use super::controls::{ControlModel, Handle, with_control_devices};
use super::fit::Fit;
use super::outline::Outline;
use super::shape::Shape;
use crate::command::TextMode;
use crate::contact::board_pose::AutoRecenter;
use crate::contact::surface::{Anchor, Scene};
use crate::contact::{TargetId, TargetNames};
use crate::device::keyboard::{Activation, Chord, KeyBinding, TapHold, action_in_layer};
use crate::device::pointer::{AnchoredFrame, PointerSettings, SelectionSpace};
use crate::device::signals::Signals;
use crate::device::trigger::{Measure, Trigger};
use crate::device::value_output::{NamedValue, ValueOutput};
use crate::device::{KeyAction, Multitap, MultitapId, Multitaps, Sequence, SequenceId, TextId};
use crate::hand::{BodyPoint, Side};

/// The maximum number of targets of a layout: keys, other controls, triggers, and targets in space.
pub const MAX_TARGETS: usize = 10_000;

/// The maximum number of layers of a layout, including the base layer.
pub const MAX_LAYERS: usize = 32;

/// The name of the layer that is active at the start.
pub const BASE_LAYER: &str = "base";

/// The name of the pointer among the targets.
pub const POINTER: &str = "pointer";

/// Boards with keys and other controls, triggers, a pointer, and targets in space.
///
/// Target ids are assigned in this order: faces board by board, triggers, pointer, targets in space, values of controls that have
/// several.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The name.
    pub name: String,
    /// One line for lists; may be empty.
    pub description: String,
    /// The file, as its user named it.
    pub file: String,
    /// The text of the file. A recording keeps it, so that a replay uses the same layout.
    pub text: String,
    /// The hands that the boards, volumes and their sizes fit.
    pub fit: Fit,
    /// The targets of the boards: surface `i` is board `i`.
    pub scene: Scene,
    /// The boards, in file order.
    pub boards: Vec<Board>,
    /// The keys, sorted by target.
    pub keys: Vec<Key>,
    /// The other controls, in the order of their boards.
    pub controls: Vec<Control>,
    /// Names of the layers, [`BASE_LAYER`] first.
    pub layers: Vec<String>,
    /// Names of the layers that no action activates.
    pub idle_layers: Vec<String>,
    /// Names of the profiles that keys activate with [`Command::Profile`](crate::command::Command::Profile).
    pub profiles: Vec<String>,
    /// Texts that keys and sequences write, indexed by [`TextId`].
    pub texts: Vec<String>,
    /// Sequences that presses start, indexed by [`SequenceId`].
    pub sequences: Vec<Sequence>,
    /// Letters of multitap keys.
    pub multitaps: Multitaps,
    /// Key combinations with an action of their own.
    pub chords: Vec<Chord>,
    /// Maximum time between the first and the last key press of a chord.
    pub chord_timeout: Duration,
    /// Hand postures with an action or value, with their names.
    pub triggers: Vec<(String, Trigger)>,
    /// The meshes that move with the values of triggers, with their targets.
    pub shapes: Vec<(TargetId, Shape)>,
    /// The arm as a pointer.
    pub pointer: Option<PointerSettings>,
    /// Targets in space.
    pub spaces: Vec<SpaceTargets>,
    /// The messages of controls to music and stage programs.
    pub signals: Signals,
    /// The mode in which the text decoder starts, unless the person states another one.
    pub text_mode: Option<TextMode>,
    /// A key, gesture or other control takes candidates of the text decoder or changes its mode.
    pub has_text_commands: bool,
}

/// A group of keys and controls that moves as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Board {
    /// The name in the editor and in messages, if it has one.
    pub name: Option<String>,
    /// Indices of its keys in [`Layout::keys`].
    pub keys: Range<usize>,
    /// Indices of its other controls in [`Layout::controls`].
    pub controls: Range<usize>,
    /// Distance between the centers of adjacent keys of a row, in metres.
    pub pitch: f32,
    /// Flat or curved.
    pub shape: BoardShape,
    /// The path of a finger over its letters is a word, for a text decoder.
    pub swipe: bool,
    /// Slow motion towards a resting hand, if enabled.
    pub auto_recenter: Option<AutoRecenter>,
}

/// The visible front of a target on a board.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// The name in layers and messages, unique within a layout.
    pub name: String,
    /// The text drawn on it.
    pub label: String,
    /// The target in the scene.
    pub target: TargetId,
    /// The center in row coordinates: x along its row, y away from the wearer, in metres, including the scale of the board.
    pub row_position: Vec2,
    /// The outline in the plane of the board. Its center differs from `row_position` on an arc.
    pub outline: Outline,
}

/// A key.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The front.
    pub face: Face,
    /// The action in each layer, base layer first; see [`KeyBinding::actions`].
    pub actions: Vec<Option<KeyAction>>,
    /// The depth of a press is reported as a value.
    pub reports_depth: bool,
    /// The velocity of a press is reported, for its signal.
    pub reports_velocity: bool,
    /// The output of the depth of a press, besides the action.
    pub output: ValueOutput,
    /// The part of a press that activates the action.
    pub activation: Activation,
    /// Time after a release during which the key ignores presses.
    pub debounce: Duration,
}

/// A control other than a key.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// The fronts of its targets.
    pub faces: Vec<Face>,
    /// The kind and settings.
    pub kind: ControlKind,
}

/// Declares the kinds of controls that have a device.
macro_rules! control_kind {
    ($($(#[$doc:meta])* $kind:ident: $module:ident::$settings:ident, $device:ident;)+) => {
        /// The kind and the settings of a control.
        #[derive(Clone, Debug, PartialEq)]
        pub enum ControlKind {
            $($(#[$doc])* $kind(crate::device::$module::$settings),)+
        }

        impl ControlKind {
            pub(super) fn model(&self) -> &dyn ControlModel {
                match self {
                    $(Self::$kind(settings) => settings,)+
                }
            }

            fn model_mut(&mut self) -> &mut dyn ControlModel {
                match self {
                    $(Self::$kind(settings) => settings,)+
                }
            }

            // These two do without the table of a trait object: it would carry the drawings into programs that draw in another way.
            pub(super) fn values(&self) -> &[NamedValue] {
                match self {
                    $(Self::$kind(settings) => settings.values(),)+
                }
            }

            pub(super) fn values_mut(&mut self) -> &mut [NamedValue] {
                match self {
                    $(Self::$kind(settings) => settings.values_mut(),)+
                }
            }
        }
    };
}
with_control_devices!(control_kind);

impl ControlKind {
    /// Returns the part that a finger moves, and its travel.
    pub fn handle(&self) -> Handle {
        self.model().handle()
    }

    /// Returns a value at the start, by its index in [`Control::value_targets`]; `None` if it has none until it is used.
    pub fn initial_value(&self, index: usize) -> Option<f32> {
        self.model().initial_value(index)
    }

    /// Returns the label of a value, such as the highlighted sector of a radial menu; `None` for a value that is a quantity or has
    /// no label.
    pub fn value_label(&self, value: f32) -> Option<&str> {
        self.model().value_label(value)
    }

    /// Returns the control as it is drawn with a value, by its index in [`Control::value_targets`]: 0..=1, a number of turns, or 1
    /// for on.
    pub fn with_value(mut self, index: usize, value: f32) -> Self {
        self.model_mut().set_value(index, value);
        self
    }
}

impl Control {
    /// Returns a target for each of its values: its fronts, or the values themselves if a front has several.
    pub fn value_targets(&self) -> Vec<TargetId> {
        match self.kind.values() {
            [] => self.faces.iter().map(|face| face.target).collect(),
            values => values.iter().map(|value| value.target).collect(),
        }
    }
}

/// Targets in space that move as one.
#[derive(Clone, Debug)]
pub struct SpaceTargets {
    /// Names of the targets, in the order of the volumes.
    pub names: Vec<String>,
    /// The frame, volumes and actions of the targets.
    pub space: SelectionSpace,
}

impl Board {
    /// Returns the half extents of the rectangle around a face in row coordinates, in metres.
    pub fn row_half_extents(&self, face: &Face) -> Vec2 {
        let straightened = Outline {
            rotation: face.outline.rotation - self.shape.row_rotation(face.row_position),
            ..face.outline
        };
        straightened.aabb_half_extents()
    }
}

impl Key {
    /// Returns the action in a layer, or in the base layer if that layer defines none.
    pub fn action(&self, layer: usize) -> Option<KeyAction> {
        action_in_layer(&self.actions, layer)
    }

    /// Returns the action of a tap-hold key when it is held.
    pub fn hold_action(&self) -> Option<KeyAction> {
        match self.activation {
            Activation::TapHold(TapHold { hold_action, .. }) => Some(hold_action),
            Activation::OnPress | Activation::OnRelease | Activation::Dwell(_) => None,
        }
    }
}

impl Layout {
    /// Returns `true` if a stick, trigger or button of a glove does something.
    pub fn uses_inputs(&self) -> bool {
        let mut triggers = self.triggers.iter();
        triggers.any(|(_, it)| it.held.is_some() || matches!(it.measure, Measure::Input(_)))
            || self
                .pointer
                .as_ref()
                .is_some_and(PointerSettings::uses_inputs)
    }

    /// Returns the hand of the trigger with this target; `None` for either hand.
    pub fn trigger_side(&self, target: TargetId) -> Option<Side> {
        let mut triggers = self.triggers.iter();
        triggers.find(|(_, it)| it.target == target)?.1.side
    }

    /// Returns `true` if an angle of the head, a foot or a knee does something.
    pub fn uses_body(&self) -> bool {
        let mut triggers = self.triggers.iter();
        triggers.any(|(_, it)| matches!(it.measure, Measure::Body(_)))
    }

    /// Returns `true` if a board, pointer or space is anchored at the other hand.
    pub fn follows_other_hand(&self) -> bool {
        self.scene.follows_other_hand() || self.has_frame_at(Anchor::OtherHand)
    }

    /// Returns `true` if a board, pointer or space is anchored at a point of the body.
    pub fn follows_body(&self) -> bool {
        self.followed_body_points().next().is_some()
    }

    /// Iterates over the points of the body at which a board, pointer or space is anchored.
    pub fn followed_body_points(&self) -> impl Iterator<Item = BodyPoint> {
        let points = BodyPoint::ALL.iter().copied();
        points.filter(|point| {
            let anchor = Anchor::Body(*point);
            let mut surfaces = self.scene.surfaces().iter();
            surfaces.any(|surface| surface.anchor() == anchor) || self.has_frame_at(anchor)
        })
    }

    /// Returns `true` if a pointer or space has this anchor.
    pub(crate) fn has_frame_at(&self, anchor: Anchor) -> bool {
        self.frames().any(|frame| frame.anchor == anchor)
    }

    /// Returns the bindings of the keys, for the keyboard device.
    pub fn key_bindings(&self) -> Vec<KeyBinding> {
        self.keys
            .iter()
            .map(|key| KeyBinding {
                target: key.face.target,
                actions: key.actions.clone(),
                reports_depth: key.reports_depth,
                reports_velocity: key.reports_velocity,
                activation: key.activation,
                debounce: key.debounce,
            })
            .collect()
    }

    /// Iterates over the frames of the pointer and of the targets in space.
    pub fn frames(&self) -> impl Iterator<Item = &AnchoredFrame> {
        let pointer = self.pointer.iter();
        let pointer = pointer.filter_map(|pointer| pointer.mode.frame());
        pointer.chain(self.spaces.iter().map(|space| &space.space.frame))
    }

    /// Returns the faces of a board: keys first, then the other controls.
    pub fn faces(&self, board: &Board) -> impl Iterator<Item = &Face> {
        let keys = self.keys[board.keys.clone()].iter().map(|key| &key.face);
        let controls = self.controls[board.controls.clone()].iter();
        keys.chain(controls.flat_map(|control| &control.faces))
    }

    /// Returns the corners of the rectangle around the faces of a board, in the plane of the board, in metres.
    pub fn extent(&self, board: &Board) -> (Vec2, Vec2) {
        let corners = self.faces(board).map(|face| {
            let half = face.outline.aabb_half_extents();
            (face.outline.center - half, face.outline.center + half)
        });
        let both = corners.reduce(|(min, max), (low, high)| (min.min(low), max.max(high)));
        both.unwrap_or_default()
    }

    /// Returns the control of a target and the index of its front; `None` if the target is a key or is on no board.
    pub fn control_at(&self, target: TargetId) -> Option<(&Control, usize)> {
        self.controls.iter().find_map(|control| {
            let mut faces = control.faces.iter();
            let index = faces.position(|face| face.target == target)?;
            Some((control, index))
        })
    }

    /// Returns the control of a value and the index of the value in [`Control::value_targets`]; `None` if the target is not a value.
    pub fn value_at(&self, target: TargetId) -> Option<(&Control, usize)> {
        self.controls.iter().find_map(|control| {
            let mut targets = control.value_targets().into_iter();
            Some((control, targets.position(|it| it == target)?))
        })
    }

    /// Returns the initial value of a control; `None` if the target is not a value, or has none at the start.
    pub fn initial_value(&self, target: TargetId) -> Option<f32> {
        let (control, index) = self.value_at(target)?;
        control.kind.initial_value(index)
    }

    /// Returns the face of a target.
    pub fn face(&self, target: TargetId) -> Option<&Face> {
        if let Some(key) = self.key_at(target) {
            return Some(&key.face);
        }
        let mut faces = self.controls.iter().flat_map(|control| &control.faces);
        faces.find(|face| face.target == target)
    }

    /// Returns the names of all targets.
    pub fn target_names(&self) -> TargetNames {
        let faces = self.boards.iter().flat_map(|board| self.faces(board));
        let faces = faces.map(|face| face.name.as_str());
        let triggers = self.triggers.iter().map(|(name, _)| name.as_str());
        let pointer = self.pointer.as_ref().map(|_| POINTER);
        let in_space = self.spaces.iter().flat_map(|space| &space.names);
        let in_space = in_space.map(String::as_str);
        let values = self.controls.iter();
        let values = values.flat_map(|control| control.kind.values());
        let values = values.map(|value| value.name.as_str());
        let names = faces
            .chain(triggers)
            .chain(pointer)
            .chain(in_space)
            .chain(values);
        TargetNames::new(names.map(str::to_owned))
    }

    /// Returns `true` if a board is reserved for this hand.
    pub fn has_board_for(&self, side: Side) -> bool {
        let mut surfaces = self.scene.surfaces().iter();
        surfaces.any(|surface| surface.side() == Some(side))
    }

    /// Returns `true` if this hand presses on a board of its own, or carries a board of the other hand.
    pub fn uses_hand(&self, side: Side) -> bool {
        let mut surfaces = self.scene.surfaces().iter();
        let is_carried = surfaces.any(|surface| {
            surface.anchor() == Anchor::OtherHand && surface.side() == Some(side.opposite())
        });
        // A pointer or space belongs to neither hand.
        is_carried || self.has_board_for(side) || self.has_frame_at(Anchor::OtherHand)
    }

    /// Returns the chords of fingers that bend; none if fingertips touch the keys.
    pub fn bend_chords(&self) -> &[Chord] {
        if self.scene.has_bend_targets() {
            &self.chords
        } else {
            &[]
        }
    }

    /// Returns `true` if a target is a key that takes part in a chord.
    pub fn is_chord_key(&self, target: TargetId) -> bool {
        let mut chords = self.chords.iter();
        chords.any(|chord| chord.keys.contains(&target))
    }

    /// Returns the key with this name.
    pub fn key(&self, name: &str) -> Option<&Key> {
        self.keys.iter().find(|key| key.face.name == name)
    }

    /// Returns the key with this target.
    pub fn key_at(&self, target: TargetId) -> Option<&Key> {
        let index = self
            .keys
            .binary_search_by_key(&target, |key| key.face.target);
        self.keys.get(index.ok()?)
    }

    /// Returns the label of a key with this action and without a label of its own.
    pub(super) fn action_label(&self, action: KeyAction) -> &str {
        let multitaps = &self.multitaps.keys;
        action_label(
            action,
            &self.layers,
            &self.texts,
            &self.sequences,
            multitaps,
        )
    }

    /// Returns the label of a key while a layer is active, or `None` if the layer does not change the key.
    pub fn label_in_layer<'a>(&'a self, key: &'a Key, layer: usize) -> Option<&'a str> {
        if layer == 0 {
            return Some(&key.face.label);
        }
        let action = (*key.actions.get(layer)?)?;
        Some(self.action_label(action))
    }
}

/// Returns the label of a key with this action and without a label of its own.
pub(super) fn action_label<'a>(
    action: KeyAction,
    layers: &'a [String],
    texts: &'a [String],
    sequences: &'a [Sequence],
    multitaps: &'a [Multitap],
) -> &'a str {
    let entry = |list: &'a [String], index: usize| list.get(index).map_or("?", String::as_str);
    match action {
        KeyAction::Key(code) | KeyAction::Modifier(code, _) => code.label(),
        KeyAction::Layer(layer, _) => entry(layers, layer),
        KeyAction::Text(TextId(text)) => entry(texts, text.into()),
        KeyAction::Sequence(SequenceId(index)) => {
            let sequence = sequences.get(usize::from(index));
            sequence.map_or("?", |sequence| &sequence.name)
        }
        KeyAction::Multitap(MultitapId(index)) => {
            let multitap = multitaps.get(usize::from(index));
            multitap.map_or("?", |multitap| &multitap.label)
        }
        KeyAction::Command(command) => command.spec().key_label,
        KeyAction::Clutch => "Clutch",
        KeyAction::Precision => "Slow",
    }
}
