//! Pictures of boards, without a window.

use std::sync::Arc;

use parry3d::math::{Pose, Vec2, Vec3};

use super::*;
use crate::contact::surface::Surface;
use crate::files::Load;
use crate::hand::Side;
use crate::layout::Layout;
use crate::session::view::{View, ViewState};
use crate::studio::camera::Viewpoint;
use crate::studio::model::Contact;
use crate::studio::sensors::SensorTable;
use crate::time::Timestamp;

const SIZE: Vec2 = Vec2::new(900.0, 500.0);

/// Returns a shipped layout below an elbow, and a camera that shows it.
fn scene(layout: &str) -> (StudioModel, Camera) {
    let layout = Layout::load(layout).unwrap();
    let surfaces = layout.scene.surfaces().iter();
    let view = View {
        boards: surfaces.map(Surface::anchor_from_surface).collect(),
        layout: Arc::new(layout),
        state: Arc::new(ViewState::starting("", "", "")),
        messages: Arc::default(),
        missed: 0,
    };
    let mut model = StudioModel::new(view, SensorTable::default());
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
    for layout in crate::document::shipped_layouts() {
        let (model, camera) = scene(layout);
        for point in points_of_interest(&model) {
            let at = camera.project(point, SIZE).unwrap().position;
            let is_inside = at.cmpge(Vec2::ZERO).all() && at.cmple(SIZE).all();
            assert!(is_inside, "{layout}: {at}");
        }
    }
}
