//! Boards of several kinds and sizes, with the same keys below the hand.

use ademan::contact::surface::{Anchor, Scene, Shape, Share, TREMOR_MARGIN, Target};
use parry3d::math::{Pose, Rotation, Vec2, Vec3};

/// The distance of the centers of adjacent keys, in metres.
pub const PITCH: f32 = 0.019;

/// The kinds of boards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Rows and columns on one surface.
    Regular,
    /// Rows and columns at 30° to the axes of the surface, so that bounding boxes overlap.
    Turned,
    /// Each key on one of four surfaces in the same place, so that every fingertip is tested against each of them.
    FourSurfaces,
    /// Keys of several sizes and directions that overlap neither rows nor columns.
    Irregular,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 4] = [
        Self::Regular,
        Self::Turned,
        Self::FourSurfaces,
        Self::Irregular,
    ];

    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Regular => "regular",
            Self::Turned => "turned",
            Self::FourSurfaces => "four surfaces",
            Self::Irregular => "irregular",
        }
    }

    /// Returns a board whose keys surround the origin of the world, in the plane y = 0.
    pub fn scene(self, keys: usize) -> Scene {
        let world_from_board =
            Pose::from_rotation(Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2));
        let mut targets = match self {
            Self::Irregular => irregular(keys),
            _ => regular(keys),
        };
        let mut scene = Scene::new();
        match self {
            Self::Regular | Self::Irregular => {
                scene.add_surface(Anchor::World, world_from_board, targets);
            }
            Self::Turned => {
                let turn = Pose::from_rotation(Rotation::from_rotation_z(0.5));
                for target in &mut targets {
                    target.surface_from_target = turn.inverse() * target.surface_from_target;
                }
                scene.add_surface(Anchor::World, world_from_board * turn, targets);
            }
            Self::FourSurfaces => {
                for first in 0..4 {
                    let part = targets.iter().skip(first).step_by(4).copied().collect();
                    scene.add_surface(Anchor::World, world_from_board, part);
                }
            }
        }
        scene
    }
}

/// Returns keys at a pitch of 19 mm around the origin, the nearest first.
fn regular(keys: usize) -> Vec<Target> {
    // A block of this half size around the origin has more keys than needed.
    let half = ((keys as f32).sqrt() / 2.0).ceil() as i32 + 1;
    let columns = move |row| (-2 * half..=2 * half).map(move |column| (column, row));
    let mut cells: Vec<(i32, i32)> = (-half..=half).flat_map(columns).collect();
    // Twice as wide as deep.
    let distance = |&(column, row): &(i32, i32)| (column.abs(), 2 * row.abs());
    cells.sort_by_key(|cell| {
        let (along, across) = distance(cell);
        (along.max(across), *cell)
    });
    let keys = cells.into_iter().take(keys);
    keys.map(|(column, row)| {
        let center = Vec3::new(column as f32, row as f32, 0.0) * PITCH;
        key(Vec2::splat(0.008), Pose::from_translation(center))
    })
    .collect()
}

/// Returns keys of random sizes and directions, each within a cell of the regular board.
fn irregular(keys: usize) -> Vec<Target> {
    let mut random = fastrand::Rng::with_seed(5);
    let mut between = |low: f32, high: f32| low + (high - low) * random.f32();
    let mut keys = regular(keys);
    for target in &mut keys {
        // The diagonal is shorter than the pitch, so that no two keys overlap.
        let half = Vec2::new(between(0.003, 0.006), between(0.003, 0.006));
        let offset = Vec3::new(between(-1e-3, 1e-3), between(-1e-3, 1e-3), 0.0);
        let center = target.surface_from_target.translation + offset;
        let rotation = Rotation::from_rotation_z(between(-1.5, 1.5));
        *target = key(half, Pose::from_parts(center, rotation));
    }
    keys
}

fn key(half: Vec2, surface_from_target: Pose) -> Target {
    Target {
        shape: Shape::Box(half),
        share: Share::NONE,
        surface_from_target,
        travel: 0.004,
        press_at: 0.5,
        release_at: 0.25,
        margin: TREMOR_MARGIN,
    }
}
