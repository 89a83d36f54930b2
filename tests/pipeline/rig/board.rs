//! Keyboards in shorthand, for tests of keys.

use std::time::Duration;

use ademan::contact::surface::{Anchor, Scene, Shape, Share, TREMOR_MARGIN, Target};
use ademan::contact::{TargetId, TargetNames};
use ademan::device::keyboard::{Activation, KeyBinding, Keyboard, TapHold};
use ademan::device::{Capabilities, KeyAction, KeyCode, Latch, VirtualDevice};
use parry3d::math::{Pose, Rotation, Vec2, Vec3};

/// The distance from key to key, in metres.
pub const PITCH: f32 = 0.019;
/// Half the width of a key, in metres.
pub const HALF: f32 = 0.008;
/// The travel of a key, in metres.
pub const TRAVEL: f32 = 0.004;

/// A flat keyboard that is fixed in the world.
///
/// The shorthand is a text: keys in a row with blanks between them, rows with `/` between them.
///
/// | key | what it does |
/// |---|---|
/// | `a` | the key A; it is named `a` in scripts |
/// | `a\|1\|-` | A in the base layer, 1 in the first layer, nothing in the second |
/// | `shift`, `ctrl` | a modifier |
/// | `layer1` | activates the first layer; `layer0` is the base layer |
/// | `*shift` | one-shot |
/// | `!shift` | locks |
/// | `~a` | reports its depth |
/// | `^a` | acts on release |
/// | `a>shift` | A when tapped, Shift when held for 200 ms |
/// | `a%50` | ignores a second press within 50 ms |
/// | `*shift#S` | is named `S` in scripts |
pub struct Board {
    /// The board as a surface.
    pub scene: Scene,
    /// The device of its keys.
    pub keyboard: Keyboard,
    names: Vec<String>,
}

impl Board {
    /// Builds a keyboard of its shorthand.
    pub fn parse(keys: &str) -> Self {
        let (mut names, mut targets, mut bindings) = (Vec::new(), Vec::new(), Vec::new());
        for (row, row_keys) in keys.split('/').enumerate() {
            for (column, key) in row_keys.split_whitespace().enumerate() {
                let center = Vec3::new(column as f32 * PITCH, -(row as f32) * PITCH, 0.0);
                bindings.push(binding(key, TargetId(targets.len() as u32)));
                let pose = Pose::from_translation(center);
                targets.push(key_target(Shape::Box(Vec2::splat(HALF)), pose));
                names.push(name(key));
            }
        }
        let mut scene = Scene::new();
        scene.add_surface(Anchor::World, world_from_board(), targets);
        Self {
            scene,
            keyboard: Keyboard::new(bindings),
            names,
        }
    }

    /// The names of the keys.
    pub fn names(&self) -> TargetNames {
        TargetNames::new(self.names.iter().cloned())
    }

    /// Returns the capabilities that the keyboard requires.
    pub fn capabilities(&self) -> Capabilities {
        let mut capabilities = Capabilities::default();
        self.keyboard.add_capabilities(&mut capabilities);
        capabilities
    }
}

/// The pose of a keyboard in shorthand: flat, its +Z up.
pub fn world_from_board() -> Pose {
    Pose::from_parts(
        Vec3::new(0.05, -0.1, -0.2),
        Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2),
    )
}

/// A target that presses at half its travel and releases at a quarter.
pub fn key_target(shape: Shape, surface_from_target: Pose) -> Target {
    Target {
        shape,
        share: Share::NONE,
        surface_from_target,
        travel: TRAVEL,
        press_at: 0.5,
        release_at: 0.25,
        margin: TREMOR_MARGIN,
    }
}

fn name(key: &str) -> String {
    let name = key.rsplit('#').next().expect("a first part");
    let name = name.split(['|', '>', '%']).next().expect("a first part");
    name.trim_start_matches(['*', '!', '~', '^']).to_owned()
}

fn binding(key: &str, target: TargetId) -> KeyBinding {
    let (key, debounce) = key.split_once('%').unwrap_or((key, "0"));
    let (key, hold_action) = match key.split_once('>') {
        Some((key, hold)) => (key, action(hold)),
        None => (key, None),
    };
    let activation = match hold_action {
        Some(hold_action) => Activation::TapHold(TapHold {
            hold_action,
            hold_after: Duration::from_millis(200),
        }),
        None if key.starts_with('^') => Activation::OnRelease,
        None => Activation::OnPress,
    };
    let actions = key.trim_start_matches(['~', '^']).split('|');
    KeyBinding {
        target,
        actions: actions.map(action).collect(),
        reports_depth: key.starts_with('~'),
        reports_velocity: false,
        activation,
        debounce: Duration::from_millis(debounce.parse().expect("milliseconds")),
    }
}

fn action(key: &str) -> Option<KeyAction> {
    let key = key.split('#').next().expect("a first part");
    let (name, latch) = match key.split_at(1) {
        ("*", name) => (name, Latch::OneShot),
        ("!", name) => (name, Latch::Lock),
        _ => (key, Latch::Momentary),
    };
    if let Some(layer) = name.strip_prefix("layer") {
        return Some(KeyAction::Layer(layer.parse().expect("a layer"), latch));
    }
    Some(match name {
        "-" => return None,
        "shift" => KeyAction::Modifier(KeyCode::SHIFT_LEFT, latch),
        "ctrl" => KeyAction::Modifier("ControlLeft".parse().expect("a key"), latch),
        letter => KeyAction::Key(letter.to_uppercase().parse().expect("a key")),
    })
}
