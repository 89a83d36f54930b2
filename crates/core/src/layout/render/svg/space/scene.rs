//! The figures of a layout in space: arms, boards, pointer, and targets.

use parry3d::math::{Pose, Vec2, Vec3};

use super::figure::{ALL, Figure, LABEL_SIZE, Note, Scene, View, disc};
use crate::contact::board_pose::BoardPose;
use crate::contact::surface::{Shape, Surface};
use crate::contact::volume::VolumeShape;
use crate::device::pointer::mode::{DirectPointing, Displacement, JointPointing, RayPointing};
use crate::device::pointer::{AnchoredFrame, PointingMode};
use crate::hand::{Finger, Joint};
use crate::kinematics::HandPose;
use crate::layout::model::{Layout, SpaceTargets};
use crate::layout::render::svg::text::width_em;
use crate::layout::render::wearer::Wearer;
use crate::layout::render::words;

/// Returns the figures around the wearer.
pub fn around_wearer(layout: &Layout, wearer: &Wearer) -> Scene {
    let mut scene = Scene::default();
    for index in 0..layout.boards.len() {
        scene.add_board(layout, index, wearer);
    }
    for hand in &wearer.hands {
        scene.add_arm(hand);
    }
    match layout.pointer.as_ref().map(|pointer| &pointer.mode) {
        // Its targets are in the space of the cursor.
        Some(PointingMode::Joint(_)) => return scene,
        Some(PointingMode::Direct(direct)) => scene.add_pointer_box(direct, wearer),
        Some(PointingMode::Ray(ray)) => scene.add_ray(ray, wearer),
        Some(PointingMode::Rate(rate)) => {
            if let Displacement::Fingertip(frame, full) = &rate.displacement {
                let center = wearer.world_from_frame(frame).translation;
                scene.add("volume", Figure::Ball(center, *full));
                scene.add("volume", Figure::Ball(center, full * rate.dead_zone));
                scene.note(center, "rest", 0.0, ALL);
            }
        }
        Some(PointingMode::Arm(_)) | None => {}
    }
    for space in &layout.spaces {
        let world_from_space = wearer.world_from_frame(&space.space.frame);
        scene.add_targets(space, &world_from_space);
    }
    scene
}

/// Returns the range of a pointer by joint angles, with its targets, around the middle of the range.
pub fn around_cursor(joint: &JointPointing, spaces: &[SpaceTargets]) -> Scene {
    let mut scene = Scene::default();
    let depth = joint.z.map_or(0.0, |mapping| mapping.extent);
    let size = Vec3::new(joint.x.extent, joint.y.extent, depth);
    scene.add(
        "volume",
        Figure::Solid(corners(&Pose::IDENTITY, size / 2.0)),
    );
    let text = format!(
        "range of the cursor {:.0} × {:.0} × {:.0} mm",
        size.x * 1e3,
        size.y * 1e3,
        size.z * 1e3
    );
    let near_edge = Vec3::Z * size.z / 2.0;
    scene.note(near_edge, &text, -2.5, &[View::Above]);
    for space in spaces {
        scene.add_targets(space, &Pose::IDENTITY);
    }
    scene
}

impl Scene {
    fn add(&mut self, class: &'static str, figure: Figure) {
        self.figures.push((class, figure));
    }

    /// Adds a text `y` millimetres below a point on the page.
    fn note(&mut self, at: Vec3, text: &str, y: f32, views: &'static [View]) {
        self.notes.push(Note {
            at,
            text: text.to_owned(),
            offset: Vec2::Y * y,
            views,
        });
    }

    fn add_arm(&mut self, hand: &HandPose) {
        let at = |joint: Joint| hand.position(joint);
        let forearm: Vec<Vec3> = [Joint::Elbow, Joint::Wrist]
            .into_iter()
            .filter_map(at)
            .collect();
        self.add("arm", Figure::Line(forearm));
        for &finger in Finger::ALL {
            let wrist = std::iter::once(Joint::Wrist);
            let points = wrist.chain(joints(finger)).filter_map(at).collect();
            self.add("bone", Figure::Line(points));
        }
        for (joint, name) in [(Joint::Elbow, "elbow"), (Joint::Wrist, "wrist")] {
            if let Some(position) = at(joint) {
                self.add("joint", Figure::Ball(position, 0.006));
                self.notes.push(Note {
                    at: position,
                    text: name.to_owned(),
                    offset: Vec2::new(7.0, 1.5),
                    views: &[View::Above],
                });
                self.note(position, name, 4.0, &[View::Right]);
            }
        }
    }

    fn add_board(&mut self, layout: &Layout, index: usize, wearer: &Wearer) {
        let surface = &layout.scene.surfaces()[index];
        let world_from_surface = wearer.world_from_surface(surface);
        for (_, target) in surface.targets() {
            let world_from_target = world_from_surface * target.surface_from_target;
            let outline: Vec<Vec2> = match target.shape {
                Shape::Box(half) => rectangle(half).to_vec(),
                Shape::Disc(radius) => disc(radius).collect(),
            };
            let corners = outline
                .iter()
                .map(|corner| world_from_target * corner.extend(0.0));
            self.add("board", Figure::Polygon(corners.collect()));
        }
        for area in wearer.areas.iter().filter(|area| area.board == index) {
            let in_world = |point: &Vec2| world_from_surface * point.extend(0.0);
            let outlines = area.outlines.iter();
            let outlines = outlines.map(|outline| outline.iter().map(in_world).collect());
            let outlines: Vec<Vec<Vec3>> = outlines.collect();
            self.add("reach", Figure::Area(outlines.clone()));
            self.add("reach-edge", Figure::Area(outlines));
        }
        self.add_angles(surface, wearer);
    }

    /// Adds the line from the anchor of a board to its origin, the direction straight ahead, bearing and tilt.
    fn add_angles(&mut self, surface: &Surface, wearer: &Wearer) {
        if !wearer.has(surface.anchor()) {
            return;
        }
        let pose = BoardPose::from_pose(&surface.anchor_from_surface());
        let anchor = wearer.anchor_of(surface);
        let origin = wearer.world_from_surface(surface) * Vec3::ZERO;
        self.add("dashed", Figure::Line(vec![anchor, origin]));
        let center = wearer.world_from_surface(surface) * surface.center();
        let degrees = pose.bearing.to_degrees().round();
        if degrees != 0.0 {
            let direction = if degrees > 0.0 { "right" } else { "left" };
            let bearing = format!("{:.0}° {direction}", degrees.abs());
            let ahead = Vec3::NEG_Z * (origin - anchor).length() * 0.6;
            let line = Figure::LineFromAbove(vec![anchor, anchor + ahead]);
            self.add("dashed", line);
            // On the side away from the board.
            let side = -pose.bearing.signum();
            self.notes.push(Note {
                at: anchor + ahead,
                offset: Vec2::X * side * (width_em(&bearing) * LABEL_SIZE / 2.0 + 1.5),
                text: bearing,
                views: &[View::Above],
            });
        }
        self.note(center, &words::tilt(pose.tilt), 4.5, &[View::Right]);
    }

    fn add_pointer_box(&mut self, direct: &DirectPointing, wearer: &Wearer) {
        let world_from_box = wearer.world_from_frame(&direct.frame);
        let corners = corners(&world_from_box, direct.size / 2.0);
        self.add("volume", Figure::Solid(corners));
        self.add_anchor_line(&direct.frame, wearer);
    }

    fn add_ray(&mut self, ray: &RayPointing, wearer: &Wearer) {
        let world_from_rectangle = wearer.world_from_frame(&ray.frame);
        let in_world = |corner: Vec2| world_from_rectangle * corner.extend(0.0);
        let corners = rectangle(ray.size / 2.0).map(in_world);
        self.add("volume", Figure::Polygon(corners.to_vec()));
        let center = world_from_rectangle.translation;
        let knuckle = wearer.hands.first();
        let knuckle = knuckle.and_then(|hand| hand.position(Joint::IndexPhalanxProximal));
        if let Some(knuckle) = knuckle {
            self.add("dashed", Figure::Line(vec![knuckle, center]));
        }
    }

    /// Adds the line from an anchor to the center of a frame.
    fn add_anchor_line(&mut self, frame: &AnchoredFrame, wearer: &Wearer) {
        if wearer.has(frame.anchor) {
            let center = wearer.world_from_frame(frame).translation;
            let anchor = center - frame.anchor_from_frame.translation;
            self.add("dashed", Figure::Line(vec![anchor, center]));
        }
    }

    fn add_targets(&mut self, targets: &SpaceTargets, world_from_space: &Pose) {
        for (name, volume) in targets.names.iter().zip(targets.space.volumes.iter()) {
            let center = *world_from_space * volume.center;
            match volume.shape {
                VolumeShape::Ball(radius) => self.add("volume", Figure::Ball(center, radius)),
                VolumeShape::Box(half) => {
                    let world_from_box = Pose::from_parts(center, world_from_space.rotation);
                    self.add("volume", Figure::Solid(corners(&world_from_box, half)));
                }
            }
            self.note(center, name, 0.0, ALL);
        }
    }
}

/// Returns the joints of a finger, from its base to its tip.
fn joints(finger: Finger) -> impl Iterator<Item = Joint> {
    let base = match finger {
        Finger::Thumb => Joint::ThumbMetacarpal,
        Finger::Index => Joint::IndexMetacarpal,
        Finger::Middle => Joint::MiddleMetacarpal,
        Finger::Ring => Joint::RingMetacarpal,
        Finger::Little => Joint::LittleMetacarpal,
    };
    let joints = &Joint::ALL[base.index()..=Joint::tip(finger).index()];
    joints.iter().copied()
}

fn rectangle(half: Vec2) -> [Vec2; 4] {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec2::new(x, y) * half)
}

/// Returns the corners of a box.
fn corners(world_from_box: &Pose, half: Vec3) -> Vec<Vec3> {
    let sides = [-half.z, half.z].into_iter();
    let corners = sides.flat_map(|z| rectangle(half.truncate()).map(|corner| corner.extend(z)));
    corners.map(|corner| *world_from_box * corner).collect()
}
