//! Pictures of boards, without a window.

use std::sync::Arc;

use parry3d::math::{Pose, Vec2, Vec3};

use super::*;
use crate::camera::Viewpoint;
use crate::model::Contact;
use crate::sensors::SensorTable;
use ademan_core::contact::surface::Surface;
use ademan_core::estimate::{Estimate, JointAngles};
use ademan_core::hand::{Dof, Finger, Side};
use ademan_core::kinematics::{ArmModel, BoneLengths};
use ademan_core::layout::Layout;
use ademan_core::time::Timestamp;
use ademan_runtime::files::Load;
use ademan_runtime::session::view::{View, ViewState};

const SIZE: Vec2 = Vec2::new(900.0, 500.0);

/// Returns what the window has of a session with a layout that has received no hand.
pub(crate) fn model_of(layout: Arc<Layout>) -> StudioModel {
    let surfaces = layout.scene.surfaces().iter();
    let view = View {
        boards: surfaces.map(Surface::anchor_from_surface).collect(),
        layout,
        state: Arc::new(ViewState::starting("", "", "")),
        messages: Arc::default(),
        missed: 0,
    };
    StudioModel::new(view, SensorTable::default())
}

/// Returns a shipped layout below an elbow, and a camera that shows it.
fn scene(layout: &str) -> (StudioModel, Camera) {
    scene_of(Layout::load(layout).unwrap())
}

/// Returns a layout below an elbow, and a camera that shows it.
fn scene_of(layout: Layout) -> (StudioModel, Camera) {
    let mut model = model_of(Arc::new(layout));
    let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
    pose.set(Joint::Elbow, Pose::from_translation(Vec3::ZERO));
    model.poses[Side::Right.index()] = Some(pose);
    let mut camera = Camera::default();
    let points = points_of_interest(&model);
    let bearing = bearing(&model);
    camera.frame(&points, bearing, Viewpoint::Eye, SIZE.x / SIZE.y);
    (model, camera)
}

fn picture(model: &StudioModel, camera: &Camera) -> Picture {
    draw(
        model,
        camera,
        SIZE,
        &SceneColors::DARK,
        SceneOptions::default(),
    )
}

#[test]
fn every_key_of_a_board_has_a_label_that_is_upright() {
    let (model, mut camera) = scene("qwerty-flat");
    let labels = picture(&model, &camera).labels;
    assert!(labels.len() >= 40, "{}", labels.len());
    for label in &labels {
        assert!(label.right.x > 0.9 * label.right.length(), "{label:?}");
        assert!(label.down.y > 0.0, "{label:?}");
    }
    camera.azimuth += std::f32::consts::PI;
    for label in picture(&model, &camera).labels {
        assert!(label.right.x > 0.0 && label.down.y > 0.0, "{label:?}");
    }
}

#[test]
fn a_key_has_an_edge_in_high_contrast() {
    let (model, near) = scene("piano");
    let mut far = near;
    far.distance *= 8.0;
    let triangles = |camera: &Camera, colors: &SceneColors| {
        let picture = draw(&model, camera, SIZE, colors, SceneOptions::default());
        picture.below.indices.len()
    };
    for (plain, strong) in [
        (SceneColors::LIGHT, SceneColors::LIGHT_CONTRAST),
        (SceneColors::DARK, SceneColors::DARK_CONTRAST),
    ] {
        for camera in [&near, &far] {
            assert!(triangles(camera, &strong) > triangles(camera, &plain));
        }
    }
}

#[test]
fn a_key_above_another_one_hides_the_label_below_it() {
    let layout = |lift: u32| {
        let text = format!(
            "Layout(name: \"a\", boards: [(pose: (anchor: elbow, forward_mm: 300), keys: [\
             (code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: ({}, 0), lift_mm: {lift})])])",
            if lift > 0 { 4 } else { 30 },
        );
        Layout::parse(&text, "a.ron").unwrap()
    };
    for (lift, expected) in [(0, "A B"), (8, "B")] {
        let (model, camera) = scene_of(layout(lift));
        let labels = picture(&model, &camera).labels.into_iter();
        let mut texts: Vec<String> = labels.map(|label| label.text).collect();
        texts.sort();
        assert_eq!(texts.join(" "), expected, "{lift}");
    }
}

#[test]
fn the_labels_of_neighbors_on_an_arc_have_the_same_quarter_turn() {
    let (model, mut camera) = scene("piano");
    let points = points_of_interest(&model);
    camera.frame(&points, 0.0, Viewpoint::Above, SIZE.x / SIZE.y);
    let start = camera.azimuth;
    for step in 0..36_u8 {
        camera.azimuth = start + f32::from(step) * 10_f32.to_radians();
        let labels = picture(&model, &camera).labels;
        let right = |name: &str| {
            let label = labels.iter().find(|it| it.text == name);
            label.expect("a label").right
        };
        let keys = [
            "C4", "D4", "E4", "F4", "G4", "A4", "B4", "C5", "D5", "E5", "F5",
        ];
        for pair in keys.windows(2) {
            let turn = right(pair[0]).angle_to(right(pair[1])).to_degrees();
            assert!(turn.abs() < 45.0, "{step} {pair:?}: {turn}");
        }
    }
}

#[test]
fn a_label_on_a_key_that_is_turned_on_its_board_is_not_upside_down() {
    let text = "Layout(name: \"Turned\", boards: [(
        pose: (anchor: elbow, forward_mm: 320, height_mm: -45),
        keys: [
            (code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: (19, 0)), (code: \"C\", at_mm: (38, 0)),
            (code: \"D\", at_mm: (57, 0), rotation_deg: (0, 0, 180)),
        ],
    )])";
    let (model, camera) = scene_of(Layout::parse(text, "turned.ron").unwrap());
    let labels = picture(&model, &camera).labels;
    assert_eq!(labels.len(), 4);
    for label in labels {
        assert!(label.right.x > 0.9 * label.right.length(), "{label:?}");
    }
}

#[test]
fn keys_beyond_the_picture_are_not_drawn() {
    let (model, mut camera) = scene("qwerty-flat");
    let all = picture(&model, &camera).below.vertices.len();
    camera.pan(Vec2::X * 1.2 * SIZE.x, SIZE.y);
    let beside = picture(&model, &camera).below.vertices.len();
    assert!(beside < all / 10, "{beside} of {all}");
}

#[test]
fn keys_that_are_small_on_the_screen_have_neither_labels_nor_sides() {
    let (model, mut camera) = scene("qwerty-flat");
    let near = picture(&model, &camera).below.vertices.len();
    camera.zoom(8.0);
    let far = picture(&model, &camera);
    assert!(far.labels.is_empty());
    assert!(far.below.vertices.len() < near / 4);
    let keys = model.view.layout.keys.len();
    let corners_of_plate = far.below.vertices.len() - 4 * keys;
    assert!(corners_of_plate < 4 * keys, "{corners_of_plate}");
}

#[test]
fn a_pressed_key_is_lit_and_sinks() {
    let (mut model, camera) = scene("qwerty-flat");
    let before = picture(&model, &camera);
    let key = &model.view.layout.keys[0].face;
    let (target, text) = (key.target, key.label.clone());
    model.contacts[Side::Right.index()][0] = Some(Contact {
        target,
        depth: 1.0,
        is_pressed: true,
    });
    let after = picture(&model, &camera);
    let lit = |picture: &Picture| {
        let mut vertices = picture.below.vertices.iter();
        vertices.any(|(_, color)| *color == SceneColors::DARK.lit)
    };
    assert!(!lit(&before) && lit(&after));
    let position = |picture: &Picture| {
        let mut labels = picture.labels.iter();
        labels.find(|it| it.text == text).unwrap().position
    };
    assert!(position(&after).y > position(&before).y);
}

#[test]
fn every_shipped_layout_is_framed_within_the_picture() {
    for layout in ademan_core::document::shipped_layouts() {
        let (model, camera) = scene(layout);
        for point in points_of_interest(&model) {
            let at = camera.project(point, SIZE).unwrap().position;
            let is_inside = at.cmpge(Vec2::ZERO).all() && at.cmple(SIZE).all();
            assert!(is_inside, "{layout}: {at}");
        }
    }
}

/// Returns the largest opacity of the skin, 0..=255; 0 without skin.
fn skin_opacity(picture: &Picture) -> u8 {
    let pixels = picture.skin.iter().flat_map(|image| &image.pixels);
    pixels.map(|color| color.0[3]).max().unwrap_or(0)
}

/// Returns the opacity of the skin at a point of the world, 0..=255.
fn opacity_at(picture: &Picture, camera: &Camera, point: Vec3) -> u8 {
    let image = picture.skin.as_ref().expect("a hand");
    let at = camera.project(point, SIZE).unwrap().position;
    let [low, high] = image.corners;
    let size = Vec2::new(image.size[0] as f32, image.size[1] as f32);
    let pixel = ((at - low) / (high - low) * size).clamp(Vec2::ZERO, size - 1.0);
    image.pixels[pixel.y as usize * image.size[0] + pixel.x as usize].0[3]
}

/// Returns the model with a hand of average size and these angles, in degrees.
fn with_hand(mut model: StudioModel, degrees: &[(Dof, f64)]) -> StudioModel {
    let bones = BoneLengths::from_hand_and_forearm(0.19, 0.26).unwrap();
    let arm = ArmModel::anthropometric(Side::Right, &bones).unwrap();
    let mut angles = JointAngles::default();
    for &(dof, angle) in degrees {
        angles.set(dof, angle.to_radians());
    }
    let pose = arm.forward(&Estimate::new(Timestamp(0), angles));
    model.poses[Side::Right.index()] = Some(pose);
    model
}

#[test]
fn keys_are_seen_through_the_hand_unless_it_is_to_be_opaque() {
    for (layout, opaque, expected) in [
        ("qwerty-flat", false, 153),
        ("qwerty-flat", true, 255),
        ("direct", false, 255),
    ] {
        let (model, mut camera) = scene(layout);
        let model = with_hand(model, &[]);
        let points = points_of_interest(&model);
        camera.frame(&points, 0.0, Viewpoint::Eye, SIZE.x / SIZE.y);
        let options = SceneOptions {
            opaque,
            ..SceneOptions::default()
        };
        let picture = draw(&model, &camera, SIZE, &SceneColors::DARK, options);
        assert_eq!(skin_opacity(&picture), expected, "{layout}");
    }
}

#[test]
fn an_arm_that_passes_the_eye_fades_out_and_the_hand_before_it_stays() {
    let (model, mut camera) = scene("qwerty-flat");
    let model = with_hand(model, &[]);
    let pose = model.poses[Side::Right.index()].unwrap();
    let at = |joint: Joint| pose.position(joint).unwrap();
    let (elbow, wrist) = (at(Joint::Elbow), at(Joint::Wrist));
    let tip = at(Joint::MiddleTip);
    // The eye looks along the arm, from between elbow and wrist.
    let along = (tip - elbow).normalize();
    camera.target = tip;
    camera.azimuth = (-along.x).atan2(-along.z);
    camera.elevation = 0.5;
    camera.distance = 0.8 * tip.distance(wrist) + 0.4 * wrist.distance(elbow);
    assert!(camera.project(elbow, SIZE).is_none(), "behind the eye");
    let picture = picture(&model, &camera);
    for joint in [
        Joint::MiddlePhalanxProximal,
        Joint::MiddlePhalanxIntermediate,
    ] {
        let opacity = opacity_at(&picture, &camera, at(joint));
        assert!(opacity > 140, "{joint:?}: {opacity}");
    }
}

#[test]
fn the_skin_of_a_bent_finger_has_no_hole() {
    for bend in [30.0, 60.0, 90.0, 110.0] {
        let dofs = [Dof::IndexMcpFlexion, Dof::IndexPipFlexion];
        let (model, mut camera) = scene("direct");
        let model = with_hand(model, &dofs.map(|dof| (dof, bend)));
        let points = points_of_interest(&model);
        for viewpoint in [Viewpoint::Eye, Viewpoint::Above, Viewpoint::Side] {
            camera.frame(&points, 0.0, viewpoint, SIZE.x / SIZE.y);
            let pose = model.poses[Side::Right.index()].unwrap();
            let picture = picture(&model, &camera);
            let joints = Finger::Index.joints();
            // Points on the bones of the finger are within its skin.
            for pair in joints[1..].windows(2) {
                let [Some(from), Some(to)] = [pose.position(pair[0]), pose.position(pair[1])]
                else {
                    panic!("a joint of the index finger is unknown");
                };
                for step in 0..=20 {
                    let point = from.lerp(to, step as f32 / 20.0);
                    let opacity = opacity_at(&picture, &camera, point);
                    // But for rounding.
                    assert!(
                        opacity > 250,
                        "{bend}° {viewpoint:?} {:?} {step}: {opacity}",
                        pair[0]
                    );
                }
            }
        }
    }
}

/// Returns the number of pixels on which hands and shapes are seen.
fn skin_pixels(model: &StudioModel, camera: &Camera) -> usize {
    let image = picture(model, camera).skin;
    let pixels = image.iter().flat_map(|image| &image.pixels);
    pixels.filter(|color| color.0[3] > 0).count()
}

#[test]
fn a_shape_grows_with_the_value_of_its_trigger_and_is_on_the_hand_that_has_it() {
    let layout = Arc::new(Layout::load("claws").unwrap());
    let mut model = model_of(Arc::clone(&layout));
    // A wrist alone has no skin.
    let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
    let to_the_left = glam::Quat::from_rotation_y(std::f32::consts::PI);
    pose.set(Joint::Wrist, Pose::from_parts(Vec3::ZERO, to_the_left));
    model.poses[Side::Right.index()] = Some(pose);
    let mut camera = Camera::default();
    let corners = [Vec3::splat(-0.6), Vec3::splat(0.6)];
    camera.frame(&corners, 0.0, Viewpoint::Eye, SIZE.x / SIZE.y);
    assert_eq!(skin_pixels(&model, &camera), 0);

    let (target, _) = layout.shapes[1];
    let mut last = 0;
    for value in [0.3, 0.6, 1.0] {
        model.values.insert(target, value);
        let count = skin_pixels(&model, &camera);
        assert!(count > last, "{value}: {count}");
        last = count;
    }
}

#[test]
fn the_handle_of_an_xy_pad_moves_with_each_of_its_values() {
    let (mut model, camera) = scene("xy-pad");
    let names = model.view.layout.target_names();
    let mut pictures = vec![picture(&model, &camera).below.vertices];
    for name in ["Filter x", "Filter y"] {
        let target = names.find(name).expect("a value of the pad");
        model.values.insert(target, 0.9);
        let moved = picture(&model, &camera).below.vertices;
        assert!(!pictures.contains(&moved), "{name}");
        pictures.push(moved);
    }
}
