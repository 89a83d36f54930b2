//! Contact with discs, rotated targets, several surfaces and moving surfaces.

use ademan::contact::surface::{Anchor, Scene, Shape};
use ademan::contact::{ContactTracker, Phase, Touches};
use ademan::hand::{Finger, Joint, Side};
use ademan::kinematics::HandPose;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Rotation, Vec2, Vec3};

use crate::rig::board::{HALF, key_target};
use crate::rig::fingers::TIP_RADIUS;

const KEY: Shape = Shape::Box(Vec2::splat(HALF));

/// An index finger over a scene; each step is 10 ms.
struct IndexFinger {
    scene: Scene,
    tracker: ContactTracker,
    time: u64,
}

impl IndexFinger {
    fn over(scene: Scene) -> Self {
        Self {
            tracker: ContactTracker::new(&scene),
            scene,
            time: 0,
        }
    }

    /// Moves the center of the fingertip, and the wrist if it is known, in millimetres. Returns the touches.
    fn step(&mut self, tip: [f32; 3], wrist: Option<[f32; 3]>) -> String {
        self.time += 10_000;
        let mut pose = HandPose::new(Timestamp(self.time), Side::Right, TIP_RADIUS);
        let at = |point: [f32; 3]| Pose::from_translation(Vec3::from_array(point) * 1e-3);
        pose.set(Joint::tip(Finger::Index), at(tip));
        if let Some(wrist) = wrist {
            pose.set(Joint::Wrist, at(wrist));
        }
        let mut touches = Touches::new();
        self.tracker.update(&self.scene, &pose, &mut touches);
        let words = touches
            .iter()
            .map(|touch| format!("{}:{}={:.2}", touch.phase, touch.target.0, touch.depth));
        words.collect::<Vec<_>>().join(" ")
    }
}

fn scene_of(targets: Vec<(Shape, Pose)>, anchor: Anchor) -> Scene {
    let targets = targets
        .into_iter()
        .map(|(shape, pose)| key_target(shape, pose));
    let mut scene = Scene::new();
    scene.add_surface(anchor, Pose::IDENTITY, targets.collect());
    scene
}

#[test]
fn a_disc_has_no_corners() {
    let disc = || scene_of(vec![(Shape::Disc(HALF), Pose::IDENTITY)], Anchor::World);
    let mut index = IndexFinger::over(disc());
    assert_eq!(index.step([5.5, 5.5, 15.0], None), "");
    assert_eq!(
        index.step([5.5, 5.5, 2.0], None),
        "touched:0=0.00 pressed:0=0.50 moved:0=0.75"
    );
    assert_eq!(
        index.step([6.9, 6.9, 2.0], None),
        "moved:0=0.75",
        "within the margin"
    );
    assert_eq!(index.step([7.2, 7.2, 2.0], None), "cancelled:0=0.00");
    let mut corner = IndexFinger::over(disc());
    assert_eq!(corner.step([5.8, 5.8, 15.0], None), "");
    assert_eq!(corner.step([5.8, 5.8, 2.0], None), "");
}

#[test]
fn a_rotated_target_is_pressed_from_its_front() {
    // Faces +X.
    let rotated = Pose::from_parts(
        Vec3::ZERO,
        Rotation::from_rotation_y(std::f32::consts::FRAC_PI_2),
    );
    let mut index = IndexFinger::over(scene_of(vec![(KEY, rotated)], Anchor::World));
    assert_eq!(index.step([15.0, 0.0, 0.0], None), "");
    assert_eq!(
        index.step([2.0, 0.0, 0.0], None),
        "touched:0=0.00 pressed:0=0.50 moved:0=0.75"
    );
    assert_eq!(
        index.step([15.0, 0.0, 0.0], None),
        "released:0=0.25 left:0=0.00"
    );
    assert_eq!(index.step([0.0, 0.0, 15.0], None), "");
    assert_eq!(index.step([0.0, 0.0, 0.0], None), "", "along its face");
}

#[test]
fn a_step_can_leave_one_target_and_press_another() {
    // A valley: the left slope faces right and up, the right one left and up.
    let slope = |x: f32, angle: f32| {
        Pose::from_parts(
            Vec3::new(x * 1e-3, 0.0, 0.0),
            Rotation::from_rotation_y(angle.to_radians()),
        )
    };
    let valley = vec![(KEY, slope(-20.0, 80.0)), (KEY, slope(20.0, -80.0))];
    let mut index = IndexFinger::over(scene_of(valley, Anchor::World));
    assert_eq!(index.step([0.0, 0.0, 0.0], None), "");
    assert_eq!(
        index.step([-18.0, 0.0, 0.0], None),
        "touched:0=0.00 pressed:0=0.50 moved:0=0.76"
    );
    assert_eq!(
        index.step([19.0, 0.0, 0.0], None),
        "released:0=0.25 left:0=0.00 touched:1=0.00 pressed:1=0.50 moved:1=1.00"
    );
}

#[test]
fn a_front_crossed_before_the_finger_is_free_does_not_count() {
    let facing = |x: f32, angle: f32| {
        Pose::from_parts(
            Vec3::new(x * 1e-3, 0.0, 0.0),
            Rotation::from_rotation_y(angle.to_radians()),
        )
    };
    // Two fronts back to back; the finger comes out through the left one, inside the right one.
    let backs = vec![(KEY, facing(-20.0, 90.0)), (KEY, facing(-22.0, -90.0))];
    let mut index = IndexFinger::over(scene_of(backs, Anchor::World));
    index.step([-10.0, 0.0, 0.0], None);
    index.step([-29.0, 0.0, 0.0], None);
    assert_eq!(
        index.step([0.0, 0.0, 0.0], None),
        "released:0=0.25 left:0=0.00"
    );
}

#[test]
fn a_finger_that_slid_off_does_not_press_a_lower_neighbor() {
    let at = |x: f32, z: f32| Pose::from_translation(Vec3::new(x, 0.0, z) * 1e-3);
    let stairs = vec![
        (KEY, at(0.0, 0.0)),
        (KEY, at(19.0, -6.0)),
        (KEY, at(76.0, -6.0)),
    ];
    let slid_off = || {
        let mut index = IndexFinger::over(scene_of(stairs.clone(), Anchor::World));
        index.step([0.0, 0.0, 10.0], None);
        index.step([0.0, 0.0, 2.0], None);
        assert_eq!(index.step([19.0, 0.0, 2.0], None), "cancelled:0=0.00");
        index
    };
    let mut index = slid_off();
    assert_eq!(
        index.step([19.0, 0.0, -6.0], None),
        "",
        "through its front, but from the position to which it slid"
    );
    assert_eq!(index.step([19.0, 0.0, 6.0], None), "");
    assert!(
        index
            .step([19.0, 0.0, -6.0], None)
            .starts_with("touched:1=0.00 pressed:1=0.50")
    );

    let mut far = slid_off();
    assert_eq!(far.step([76.0, 0.0, 2.0], None), "");
    assert!(
        far.step([76.0, 0.0, -6.0], None).starts_with("touched:2"),
        "it counts again far from the position to which it slid"
    );
}

#[test]
fn a_finger_is_on_one_of_two_overlapping_targets() {
    let at = |x: f32| Pose::from_translation(Vec3::new(x * 1e-3, 0.0, 0.0));
    let mut index = IndexFinger::over(scene_of(
        vec![(KEY, at(0.0)), (KEY, at(6.0))],
        Anchor::World,
    ));
    index.step([4.0, 0.0, 10.0], None);
    assert_eq!(
        index.step([4.0, 0.0, 2.0], None),
        "touched:1=0.00 pressed:1=0.50 moved:1=0.75"
    );
    assert_eq!(
        index.step([2.0, 0.0, 2.0], None),
        "moved:1=0.75",
        "it stays on the target that it entered"
    );
    assert_eq!(
        index.step([2.0, 0.0, 10.0], None),
        "released:1=0.25 left:1=0.00"
    );
    assert_eq!(
        index.step([2.0, 0.0, 2.0], None),
        "touched:0=0.00 pressed:0=0.50 moved:0=0.75"
    );
}

#[test]
fn the_first_of_two_surfaces_wins() {
    let mut scene = scene_of(vec![(KEY, Pose::IDENTITY)], Anchor::World);
    let higher = Pose::from_translation(Vec3::new(0.0, 0.0, 0.002));
    scene.add_surface(Anchor::World, higher, vec![key_target(KEY, Pose::IDENTITY)]);
    let mut index = IndexFinger::over(scene);
    index.step([0.0, 0.0, 15.0], None);
    assert_eq!(
        index.step([0.0, 0.0, 2.0], None),
        "touched:1=0.00 pressed:1=0.50 moved:1=1.00"
    );
    assert_eq!(
        index.step([0.0, 0.0, 15.0], None),
        "released:1=0.25 left:1=0.00"
    );
}

#[test]
fn contact_with_an_anchored_surface_is_relative_to_its_anchor() {
    let mut index = IndexFinger::over(scene_of(
        vec![(KEY, Pose::IDENTITY)],
        Anchor::Joint(Joint::Wrist),
    ));
    assert_eq!(index.step([0.0, 0.0, 10.0], Some([0.0, 0.0, 0.0])), "");
    assert_eq!(
        index.step([300.0, 50.0, -190.0], Some([300.0, 50.0, -200.0])),
        "",
        "finger and board move together"
    );
    assert_eq!(
        index.step([300.0, 50.0, -190.0], Some([300.0, 50.0, -192.0])),
        "touched:0=0.00 pressed:0=0.50 moved:0=0.75",
        "the board moves to the finger"
    );
    assert_eq!(
        index.step([0.0, 0.0, 0.0], Some([0.0, 0.0, 0.0])),
        "moved:0=1.00"
    );
    assert_eq!(
        index.step([0.0, 0.0, 2.0], None),
        "cancelled:0=0.00",
        "the wrist is unknown"
    );
    assert_eq!(index.step([0.0, 0.0, 1.0], Some([0.0, 0.0, 0.0])), "");
}

#[test]
fn touches_of_a_surface_without_a_finite_anchor_are_cancelled() {
    let mut scene = Scene::new();
    let key = vec![key_target(KEY, Pose::IDENTITY)];
    scene.add_surface(Anchor::Joint(Joint::Wrist), Pose::IDENTITY, key);
    let mut tracker = ContactTracker::new(&scene);
    let mut touches = Touches::new();
    let steps = [(10.0, 0.0), (2.0, 0.0), (2.0, f32::NAN)];
    for (number, (tip, wrist)) in (1..).zip(steps) {
        let mut pose = HandPose::new(Timestamp(number * 1_000), Side::Right, TIP_RADIUS);
        let at = |height: f32| Pose::from_translation(Vec3::Z * height * 1e-3);
        pose.set(Joint::tip(Finger::Index), at(tip));
        pose.set(Joint::Wrist, at(wrist));
        touches.clear();
        tracker.update(&scene, &pose, &mut touches);
    }
    let [touch] = touches[..] else {
        panic!("{touches:?}")
    };
    assert_eq!(
        (touch.phase, touch.time),
        (Phase::Cancelled, Timestamp(3_000))
    );
}
