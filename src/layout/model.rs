//! A keyboard layout, checked, in SI units.

use std::ops::Range;
use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use super::controls::pointer::POINTER;
use super::controls::space::SpaceTargets;
use super::controls::{self, Control};
use super::outline::Outline;
use super::placement::BoardShape;
use super::{builder, ranged};
use crate::command::Command;
use crate::contact::TargetId;
use crate::contact::TargetNames;
use crate::contact::board_pose::AutoRecenter;
use crate::contact::surface::Scene;
use crate::device::keyboard::{Activation, Chord, KeyBinding, TapHold};
use crate::device::pointer::PointerSettings;
use crate::device::trigger::Trigger;
use crate::device::{Capabilities, KeyAction, TextId, VirtualDevice};
use crate::document::DocumentError;
use crate::document::{self, Document};
use crate::hand::Side;

/// The most targets that a layout has: keys and other controls.
pub const MAX_TARGETS: usize = 10_000;

/// The most layers that a layout has, with the base layer.
pub const MAX_LAYERS: usize = 32;

/// What the layer that is in force at first is called.
pub const BASE_LAYER: &str = "base";

/// Boards with keys, and what the keys do.
#[derive(Clone, Debug)]
pub struct Layout {
    /// What it is called.
    pub name: String,
    /// One line for lists; may be empty.
    pub description: String,
    /// The file that it comes from, as its user named it.
    pub file: String,
    /// What is in the file: a recording keeps it, so that it can be replayed with the same layout.
    pub text: String,
    /// Where the keys are in space: surface `i` is board `i`.
    pub scene: Scene,
    /// The boards, in the order of the file.
    pub boards: Vec<Board>,
    /// The keys, in the order of their targets.
    pub keys: Vec<Key>,
    /// The other controls, in the order of the boards that they are on.
    pub controls: Vec<Control>,
    /// Names of the layers, [`BASE_LAYER`] first.
    pub layers: Vec<String>,
    /// The names of other layouts of the setup that keys put in force, in the order of
    /// Named by [`Command::Profile`].
    pub profiles: Vec<String>,
    /// The texts that keys write, in the order of their [`TextId`]s.
    pub texts: Vec<String>,
    /// What keys do together.
    pub chords: Vec<Chord>,
    /// How long after the first of its keys a chord's last one is pressed at most.
    pub chord_timeout: Duration,
    /// Postures of the hand that do something, each with its name; their targets come after those of
    /// the scene, in this order.
    pub triggers: Vec<(String, Trigger)>,
    /// The arm as a pointer; its target comes after all others but those in space.
    pub pointer: Option<PointerSettings>,
    /// Targets in space, each list with its names; they come last.
    pub spaces: Vec<SpaceTargets>,
}

/// A group of keys that moves as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Board {
    /// Its keys, as places in [`Layout::keys`].
    pub keys: Range<usize>,
    /// Its other controls, as places in [`Layout::controls`].
    pub controls: Range<usize>,
    /// From key to key in a row, in metres.
    pub pitch: f32,
    /// How it is bent.
    pub shape: BoardShape,
    /// How it creeps under a resting hand, if at all.
    pub auto_recenter: Option<AutoRecenter>,
}

/// What is seen of a control: the front of one of its targets.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// What it is called in layers and messages; no two of a layout have the same name.
    pub name: String,
    /// What is drawn on it.
    pub label: String,
    /// Its target in the scene.
    pub target: TargetId,
    /// Where its middle is along and across the rows, in metres, as the file says, times the scale of its
    /// board: x along its row, y away from the wearer.
    pub row_position: Vec2,
    /// Where that is in the plane of the board, which a cylinder has where it is unrolled; differs from
    /// `at` where rows are arcs.
    pub outline: Outline,
}

/// One key.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// What is seen of it.
    pub face: Face,
    /// What pressing it does in each layer, base layer first; see [`KeyBinding::actions`].
    pub actions: Vec<Option<KeyAction>>,
    /// Whether the depth of the press goes out too.
    pub analog: bool,
    /// When what it does takes effect.
    pub fires: Activation,
    /// For how long after it came up it does not press again.
    pub debounce: Duration,
}

impl Board {
    /// Where a point in the plane of the board is along and across its rows, in metres: the inverse
    /// of what bends [`Front::at`] into the middle of [`Front::outline`].
    pub fn row_position(&self, point: Vec2) -> Vec2 {
        let BoardShape::Arc(at_zero) = self.shape else {
            return point;
        };
        let from_centre = point + Vec2::Y * at_zero;
        let radius = from_centre.length();
        Vec2::new(
            from_centre.x.atan2(from_centre.y) * radius,
            radius - at_zero,
        )
    }

    /// Half the width and height of the rectangle along and across the rows around a front, in metres.
    pub fn row_half_extents(&self, front: &Face) -> Vec2 {
        let of_row = match self.shape {
            BoardShape::Arc(at_zero) => -front.row_position.x / (at_zero + front.row_position.y),
            _ => 0.0,
        };
        let straightened = Outline {
            rotation: front.outline.rotation - of_row,
            ..front.outline
        };
        straightened.aabb_half_extents()
    }

    /// Where a point in the board's frame is along and across its rows, and how far in front of the
    /// board; in metres.
    pub fn unbend(&self, point: Vec3) -> Vec3 {
        let unrolled = |along: f32, radius: f32| {
            let from_axis = Vec2::new(along, radius - point.z);
            (
                from_axis.x.atan2(from_axis.y) * radius,
                radius - from_axis.length(),
            )
        };
        match self.shape {
            BoardShape::Flat | BoardShape::Arc(_) => {
                self.row_position(point.truncate()).extend(point.z)
            }
            BoardShape::Rows(radius) => {
                let (x, height) = unrolled(point.x, radius);
                Vec3::new(x, point.y, height)
            }
            BoardShape::Columns(radius) => {
                let (y, height) = unrolled(point.y, radius);
                Vec3::new(point.x, y, height)
            }
        }
    }
}

impl Key {
    /// What it does in a layer, or in the base layer where that one says nothing.
    pub fn action(&self, layer: usize) -> Option<KeyAction> {
        let own = self.actions.get(layer).copied().flatten();
        own.or_else(|| self.actions.first().copied().flatten())
    }

    /// What it does when it is held, if that is something else than what a tap does.
    pub fn hold_action(&self) -> Option<KeyAction> {
        match self.fires {
            Activation::TapHold(TapHold {
                hold_action: action,
                ..
            }) => Some(action),
            Activation::OnPress | Activation::OnRelease | Activation::Dwell(_) => None,
        }
    }
}

impl Layout {
    /// Reads and checks the file at a path, or the shipped layout of that name: `qwerty-flat`,
    /// `keyboards/qwerty-flat`, with or without `.ron`.
    pub fn load(name_or_path: &str) -> Result<Self, DocumentError> {
        Self::from_document(Document::open(name_or_path)?)
    }

    /// Reads and checks a text; `file` names it in errors.
    pub fn parse(text: &str, file: &str) -> Result<Self, DocumentError> {
        Self::from_document(Document::new(file, text))
    }

    /// Checks a file that was read.
    pub fn from_document(document: Document) -> Result<Self, DocumentError> {
        builder::layout(document)
    }

    /// The shipped layouts by name, each with what is in it, folder by folder.
    pub fn shipped() -> Result<Vec<(&'static str, Self)>, DocumentError> {
        document::shipped_layouts()
            .map(|name| Ok((name, Self::from_document(Document::shipped(name)?)?)))
            .collect()
    }

    /// What the keys do, for the keyboard device.
    pub fn key_bindings(&self) -> Vec<KeyBinding> {
        self.keys
            .iter()
            .map(|key| KeyBinding {
                target: key.face.target,
                actions: key.actions.clone(),
                reports_depth: key.analog,
                activation: key.fires,
                debounce: key.debounce,
            })
            .collect()
    }

    /// What is seen of the keys and then of the other controls of a board.
    pub fn faces(&self, board: &Board) -> impl Iterator<Item = &Face> {
        let keys = self.keys[board.keys.clone()].iter().map(|key| &key.face);
        let controls = self.controls[board.controls.clone()].iter();
        keys.chain(controls.flat_map(|control| &control.faces))
    }

    /// What is seen of a target.
    pub fn face(&self, target: TargetId) -> Option<&Face> {
        if let Some(key) = self.key_at(target) {
            return Some(&key.face);
        }
        let mut fronts = self.controls.iter().flat_map(|control| &control.faces);
        fronts.find(|front| front.target == target)
    }

    /// What the targets are called.
    pub fn target_names(&self) -> TargetNames {
        let fronts = self.boards.iter().flat_map(|board| self.faces(board));
        let fronts = fronts.map(|front| front.name.as_str());
        let triggers = self.triggers.iter().map(|(name, _)| name.as_str());
        let pointer = self.pointer.as_ref().map(|_| POINTER);
        let in_space = self.spaces.iter().flat_map(|scenery| &scenery.names);
        let in_space = in_space.map(String::as_str);
        let names = fronts.chain(triggers).chain(pointer).chain(in_space);
        TargetNames::new(names.map(str::to_owned))
    }

    /// Whether a board is there for this hand and not for the other.
    pub fn has_board_for(&self, side: Side) -> bool {
        let mut surfaces = self.scene.surfaces().iter();
        surfaces.any(|surface| surface.side() == Some(side))
    }

    /// Whether a target is a key that chords are played with.
    pub fn is_chord_key(&self, target: TargetId) -> bool {
        let mut chords = self.chords.iter();
        chords.any(|chord| chord.keys.contains(&target))
    }

    /// The devices that take the touches of the controls.
    pub fn devices(&self) -> Vec<Box<dyn VirtualDevice>> {
        controls::devices(self)
    }

    /// Everything that the layout can ever send, modifiers included.
    pub fn required_capabilities(&self) -> Capabilities {
        let mut needs = Capabilities::default();
        for device in self.devices() {
            device.add_capabilities(&mut needs);
        }
        needs
    }

    /// The key with this name.
    pub fn key(&self, name: &str) -> Option<&Key> {
        self.keys.iter().find(|key| key.face.name == name)
    }

    /// The key that a target stands for.
    pub fn key_at(&self, target: TargetId) -> Option<&Key> {
        let place = self
            .keys
            .binary_search_by_key(&target, |key| key.face.target);
        self.keys.get(place.ok()?)
    }

    /// The board that a key is on.
    pub fn board_of_key(&self, key: &Key) -> &Board {
        let target = key.face.target;
        let is_of = |board: &&Board| {
            self.keys[board.keys.clone()]
                .iter()
                .any(|key| key.face.target == target)
        };
        let found = self.boards.iter().find(is_of);
        found.expect("every key is made with its board")
    }

    /// What is drawn on a key while a layer is in force; `None` where the layer leaves the key as it is.
    pub fn label_in_layer<'a>(&'a self, key: &'a Key, layer: usize) -> Option<&'a str> {
        if layer == 0 {
            return Some(&key.face.label);
        }
        Some(label(
            (*key.actions.get(layer)?)?,
            &self.layers,
            &self.texts,
        ))
    }
}

/// What is drawn on a key that does this and says nothing else.
pub(super) fn label<'a>(action: KeyAction, layers: &'a [String], texts: &'a [String]) -> &'a str {
    let of = |list: &'a [String], place: usize| list.get(place).map_or("?", String::as_str);
    match action {
        KeyAction::Key(code) | KeyAction::Modifier(code, _) => code.label(),
        KeyAction::Layer(layer, _) => of(layers, layer),
        KeyAction::Text(TextId(text)) => of(texts, text.into()),
        KeyAction::Command(command) => command_label(command),
        KeyAction::Clutch => "Clutch",
        KeyAction::Precision => "Slow",
    }
}

/// Millimetres of a file in metres.
pub(super) fn metres(millimetres: f64) -> f32 {
    (millimetres * 1e-3) as f32
}

/// A place of a file in metres.
pub(super) fn metres2((x, y): (ranged::Distance, ranged::Distance)) -> Vec2 {
    Vec2::new(metres(x.get()), metres(y.get()))
}

/// Returns the label of a key that issues a command.
const fn command_label(command: Command) -> &'static str {
    match command {
        Command::Pause | Command::TogglePause => "Pause",
        Command::Resume => "Resume",
        Command::Profile { .. } | Command::NextProfile => "Profile",
        Command::Recenter => "Center",
        Command::Nudge { .. } => "Move",
        Command::Tilt { .. } => "Tilt",
        Command::Scale { .. } => "Size",
        Command::Save => "Save",
        Command::Reload => "Reload",
        Command::State => "State",
        Command::Stop => "Stop",
    }
}
