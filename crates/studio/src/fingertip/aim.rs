//! The movements of a fingertip as the mouse moves.

use crossbeam_channel::Sender;

use super::source::PointerMove;
use crate::model::StudioModel;
use ademan_core::contact::ray::{FrontHit, Ray};
use ademan_core::hand::Side;
use ademan_lab::sim::Pointed;

/// Distance from a front up to which the mouse still means it, in metres.
const REACH_M: f32 = 0.006;

/// The longest drag, from the point at which the press began, in metres.
const MAX_DRAG_M: f32 = 0.3;

/// The mouse over the 3D view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mouse {
    /// The ray through the point of the mouse. `None` beside the view, over something else in it, and without the focus.
    pub ray: Option<Ray>,
    /// The button went down since the last frame, and not for the camera.
    pub is_pressed: bool,
    /// The button is down.
    pub is_down: bool,
}

/// The last press of the mouse.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Grip {
    /// The button is up, or moves the camera.
    None,
    /// A finger presses: its hand, the front where it went down, and the point where it is.
    Pressing(Side, FrontHit, Pointed),
    /// The finger was lifted before the button.
    Lifted,
}

/// Makes a fingertip follow the mouse.
pub struct Aim {
    /// The hand for boards that both may touch.
    first_side: Side,
    moves: Sender<PointerMove>,
    grip: Grip,
    /// The mouse was followed since the last frame.
    is_followed: bool,
}

impl Aim {
    /// Creates the aim of hands that rest.
    pub(super) fn new(first_side: Side, moves: Sender<PointerMove>) -> Self {
        Self {
            first_side,
            moves,
            grip: Grip::None,
            is_followed: false,
        }
    }

    /// Returns `true` if the button that is down belongs to the fingertip, so that it moves no camera.
    pub fn has_button(&self) -> bool {
        self.grip != Grip::None
    }

    /// Follows the mouse. Returns `true` if it is over a front.
    pub fn follow(&mut self, model: &StudioModel, mouse: Mouse) -> bool {
        self.is_followed = true;
        let front = mouse.ray.and_then(|ray| self.front(model, &ray));
        if mouse.is_pressed
            && let Some((side, hit)) = front
        {
            let pointed = pointed(&hit, true);
            self.send(PointerMove::To(side, pointed));
            self.grip = Grip::Pressing(side, hit, pointed);
        }
        match self.grip {
            Grip::Pressing(side, hit, last) => self.drag(mouse, side, hit, last),
            Grip::Lifted if !mouse.is_down => self.grip = Grip::None,
            Grip::Lifted => {}
            Grip::None => {
                if let Some((side, hit)) = front {
                    self.send(PointerMove::To(side, pointed(&hit, false)));
                }
            }
        }
        front.is_some()
    }

    /// Ends a frame. The finger lifts if the view was not drawn in it.
    pub fn end_picture(&mut self) {
        if !std::mem::take(&mut self.is_followed) {
            self.lift();
        }
    }

    /// Moves a pressing finger with the mouse, in the plane of the front on which it went down.
    fn drag(&mut self, mouse: Mouse, side: Side, hit: FrontHit, last: Pointed) {
        let Some(ray) = mouse.ray else {
            self.lift();
            return;
        };
        let point = ray.on_plane(hit.point, hit.normal);
        let point = point.filter(|it| it.distance(hit.point) <= MAX_DRAG_M);
        let moved = Pointed {
            point: point.unwrap_or(last.point),
            is_down: mouse.is_down,
            ..last
        };
        self.send(PointerMove::To(side, moved));
        self.grip = if mouse.is_down {
            Grip::Pressing(side, hit, moved)
        } else {
            Grip::None
        };
    }

    fn lift(&mut self) {
        if matches!(self.grip, Grip::Pressing(..)) {
            self.send(PointerMove::Lift);
            self.grip = Grip::Lifted;
        }
    }

    fn send(&self, change: PointerMove) {
        // A session that has ended has no hand.
        let _ = self.moves.send(change);
    }

    /// Returns the front that a ray means, and the hand for it.
    fn front(&self, model: &StudioModel, ray: &Ray) -> Option<(Side, FrontHit)> {
        let surfaces = model.view.layout.scene.surfaces().iter().enumerate();
        let hits = surfaces.filter_map(|(index, surface)| {
            let hit = ray.front_of(surface, &model.world_from_board(index)?, REACH_M)?;
            Some((surface.side().unwrap_or(self.first_side), hit))
        });
        hits.reduce(|a, b| if b.1.precedes(&a.1) { b } else { a })
    }
}

fn pointed(hit: &FrontHit, is_down: bool) -> Pointed {
    Pointed {
        point: hit.point,
        normal: hit.normal,
        travel: hit.travel,
        is_down,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crossbeam_channel::{Receiver, unbounded};
    use parry3d::math::{Pose, Vec2, Vec3};

    use super::*;
    use crate::camera::{Camera, Viewpoint};
    use crate::scene::tests::model_of;
    use crate::scene::{bearing, points_of_interest};
    use ademan_core::contact::TargetId;
    use ademan_core::hand::Joint;
    use ademan_core::kinematics::HandPose;
    use ademan_core::layout::Layout;
    use ademan_core::time::Timestamp;
    use ademan_runtime::files::Load;

    const SIZE: Vec2 = Vec2::new(900.0, 500.0);

    /// A layout below an elbow, a camera that shows it, and the fingertip.
    struct Scene {
        model: StudioModel,
        camera: Camera,
        aim: Aim,
        moves: Receiver<PointerMove>,
    }

    impl Scene {
        fn new(layout: &str) -> Self {
            let mut model = model_of(Arc::new(Layout::load(layout).unwrap()));
            for side in [Side::Right, Side::Left] {
                let mut pose = HandPose::new(Timestamp(0), side, 0.005);
                let elbow = Vec3::new(if side == Side::Right { 0.2 } else { -0.2 }, 1.0, 0.0);
                pose.set(Joint::Elbow, Pose::from_translation(elbow));
                model.poses[side.index()] = Some(pose);
            }
            let mut camera = Camera::default();
            let points = points_of_interest(&model);
            camera.frame(&points, bearing(&model), Viewpoint::Eye, SIZE.x / SIZE.y);
            let (sender, moves) = unbounded();
            Self {
                model,
                camera,
                aim: Aim::new(Side::Right, sender),
                moves,
            }
        }

        /// Returns a target's point on the screen and in the world.
        fn place(&self, target: TargetId, on_front: Vec3) -> (Vec2, Vec3) {
            let surfaces = self.model.view.layout.scene.surfaces().iter();
            let mut boards = surfaces.enumerate();
            let (index, surface) = boards.find(|(_, it)| it.target(target).is_some()).unwrap();
            let own = surface.target(target).unwrap().surface_from_target * on_front;
            let point = self.model.world_from_board(index).unwrap() * own;
            (self.camera.project(point, SIZE).unwrap().position, point)
        }

        fn mouse(&self, at: Vec2, is_pressed: bool, is_down: bool) -> Mouse {
            Mouse {
                ray: Some(self.camera.projection(SIZE).ray(at)),
                is_pressed,
                is_down,
            }
        }

        fn follow(&mut self, mouse: Mouse) -> Vec<PointerMove> {
            self.aim.follow(&self.model, mouse);
            self.aim.end_picture();
            self.moves.try_iter().collect()
        }

        fn at_key(&self, name: &str) -> (Vec2, Vec3) {
            let key = self.model.view.layout.key(name).unwrap().face.target;
            self.place(key, Vec3::ZERO)
        }
    }

    fn single(moves: &[PointerMove]) -> (Side, Pointed) {
        match moves {
            [PointerMove::To(side, pointed)] => (*side, *pointed),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_fingertip_is_where_the_picture_shows_the_front_on_flat_and_bent_boards() {
        for layout in ["qwerty-flat", "qwerty-arc", "mixer"] {
            let mut scene = Scene::new(layout);
            let ids: Vec<TargetId> = {
                let surface = &scene.model.view.layout.scene.surfaces()[0];
                surface.targets().map(|(id, _)| id).collect()
            };
            for id in ids {
                let (at, point) = scene.place(id, Vec3::new(0.001, -0.002, 0.0));
                let (_, pointed) = single(&scene.follow(scene.mouse(at, false, false)));
                assert!(!pointed.is_down);
                assert!(pointed.point.distance(point) < 1e-4, "{layout} {id:?}");
            }
        }
    }

    #[test]
    fn each_hand_points_at_its_own_board() {
        let mut scene = Scene::new("qwerty-two-flat");
        for (key, side) in [("A", Side::Left), ("J", Side::Right)] {
            let (at, _) = scene.at_key(key);
            let (found, _) = single(&scene.follow(scene.mouse(at, false, false)));
            assert_eq!(found, side, "{key}");
        }
    }

    #[test]
    fn a_press_is_dragged_in_its_plane_and_lifts_with_the_button() {
        let mut scene = Scene::new("mixer");
        let controls = scene.model.view.layout.controls.iter();
        let mut faces = controls.flat_map(|control| &control.faces);
        let fader = faces.find(|face| face.name == "Fader 2").unwrap().target;
        let (from, start) = scene.place(fader, Vec3::ZERO);
        let (_, pointed) = single(&scene.follow(scene.mouse(from, false, false)));
        assert!(!pointed.is_down);
        let pressed = scene.follow(scene.mouse(from, true, true));
        assert!(
            pressed
                .iter()
                .all(|it| matches!(it, PointerMove::To(_, it) if it.is_down))
        );
        // Beyond the ends of the fader.
        let (to, end) = scene.place(fader, Vec3::new(0.06, 0.0, 0.0));
        let (_, dragged) = single(&scene.follow(scene.mouse(to, false, true)));
        assert!(dragged.is_down && scene.aim.has_button());
        assert!(dragged.point.distance(end) < 1e-4 && end.distance(start) > 0.05);
        let (_, lifted) = single(&scene.follow(scene.mouse(to, false, false)));
        assert!(!lifted.is_down && !scene.aim.has_button());
    }

    #[test]
    fn a_finger_that_leaves_the_view_lifts_and_comes_back_up() {
        let mut scene = Scene::new("qwerty-flat");
        let (at, _) = scene.at_key("G");
        let outside = Mouse {
            ray: None,
            is_pressed: false,
            is_down: true,
        };
        scene.follow(scene.mouse(at, true, true));
        assert_eq!(scene.follow(outside), [PointerMove::Lift]);
        assert!(scene.aim.has_button(), "the drag moves no camera");
        assert_eq!(scene.follow(scene.mouse(at, false, true)), []);
        scene.follow(scene.mouse(at, false, false));
        assert!(!scene.aim.has_button());
        let (_, pointed) = single(&scene.follow(scene.mouse(at, false, false)));
        assert!(!pointed.is_down);
    }

    #[test]
    fn a_finger_lifts_when_the_view_is_not_drawn() {
        let mut scene = Scene::new("qwerty-flat");
        let (at, _) = scene.at_key("G");
        scene.follow(scene.mouse(at, true, true));
        scene.aim.end_picture();
        let moves: Vec<PointerMove> = scene.moves.try_iter().collect();
        assert_eq!(moves, [PointerMove::Lift]);
    }

    #[test]
    fn a_press_beside_the_boards_is_for_the_camera() {
        let mut scene = Scene::new("qwerty-flat");
        let beside = Vec2::new(2.0, 2.0);
        assert_eq!(scene.follow(scene.mouse(beside, true, true)), []);
        assert!(!scene.aim.has_button());
        let (at, _) = scene.at_key("G");
        let (_, pointed) = single(&scene.follow(scene.mouse(at, false, true)));
        assert!(!pointed.is_down, "nothing is pressed on the way");
    }
}
