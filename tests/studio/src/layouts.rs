//! All layouts that come with the program.

use ademan::contact::TargetId;
use ademan::contact::surface::{Anchor, Shape};
use ademan::document::shipped_layouts;
use ademan::studio::camera::{Camera, Viewpoint};
use ademan::studio::model::StudioModel;
use ademan::studio::picture::{Color, Picture};
use ademan::studio::scene::{self, SceneColors, SceneOptions};
use ademan::studio::texts::text;
use egui::{Pos2, Vec2, pos2};
use image::RgbaImage;

use crate::picture;
use crate::window::Opening;

/// The largest difference of a color channel from a scene without the control, at which the control is not seen.
const UNSEEN: i32 = 10;

/// Points of a control that are looked at, as fractions of its half extents.
const SAMPLES: [(f32, f32); 6] = [
    (0.0, 0.0),
    (0.0, 0.5),
    (0.6, 0.6),
    (-0.6, 0.6),
    (0.6, -0.6),
    (-0.6, -0.6),
];

/// The color that a point of the view has without a control on it: the plate of the board or what is behind, below the hand.
fn without_control(scene: &Picture, at: Pos2, below: Color) -> [i32; 3] {
    let color = |Color([red, green, blue, _]): Color| [red, green, blue].map(i32::from);
    let Some(image) = &scene.skin else {
        return color(below);
    };
    let [low, high] = image.corners;
    let size = (high - low).to_array();
    let t = [(at.x - low.x) / size[0], (at.y - low.y) / size[1]];
    if t.iter().any(|t| !(0.0..1.0).contains(t)) {
        return color(below);
    }
    let [column, row] = [0, 1].map(|axis| (t[axis] * image.size[axis] as f32) as usize);
    let skin = image.pixels[row * image.size[0] + column];
    let opacity = i32::from(skin.0[3]);
    let (skin, below) = (color(skin), color(below));
    std::array::from_fn(|channel| {
        (skin[channel] * opacity + below[channel] * (255 - opacity)) / 255
    })
}

/// Returns the points of a control in the view, in points from its upper left corner.
fn points(
    model: &StudioModel,
    camera: &Camera,
    size: Vec2,
    board: usize,
    target: TargetId,
) -> Vec<Pos2> {
    let world_from_board = model.world_from_board(board).expect("the hand is known");
    let surface = &model.view.layout.scene.surfaces()[board];
    let mut targets = surface.targets();
    let (_, found) = targets.find(|(id, _)| *id == target).expect("a target");
    let half = match found.shape {
        Shape::Box(half) => half.to_array(),
        Shape::Disc(radius) => [radius; 2],
    };
    let pose = world_from_board * found.surface_from_target;
    let size = [size.x, size.y].into();
    let at = |(x, y): (f32, f32)| {
        let mut local = pose.translation;
        (local.x, local.y, local.z) = (x * half[0], y * half[1], 0.0);
        let projected = camera.project(pose * local, size).expect("before the eye");
        pos2(projected.position.x, projected.position.y)
    };
    SAMPLES.into_iter().map(at).collect()
}

fn is_seen(picture: &RgbaImage, at: Pos2, empty: [i32; 3]) -> bool {
    let (x, y) = (at.x as u32, at.y as u32);
    let pixel = picture
        .get_pixel(x.min(picture.width() - 1), y.min(picture.height() - 1))
        .0;
    let differences = empty.iter().zip(pixel);
    let differences = differences.map(|(empty, found)| (empty - i32::from(found)).abs());
    differences.max().is_some_and(|largest| largest > UNSEEN)
}

#[test]
fn every_control_of_every_shipped_layout_is_drawn() {
    let colors = SceneColors::DARK;
    for layout in shipped_layouts() {
        let mut window = Opening::on_layout(layout).open();
        let Some(picture) = picture::draw(&mut window, &format!("layout-{layout}")) else {
            return;
        };
        let name = format!("{}: {}", text("panel-word"), text("panel-space"));
        let view = window.rect_of(&name);
        let model = window.model();
        let mut camera = Camera::default();
        let bearing = scene::bearing(model);
        let aspect = view.width() / view.height();
        let framed = scene::points_of_interest(model);
        camera.frame(&framed, bearing, Viewpoint::Eye, aspect);
        let size = [view.width(), view.height()].into();
        let drawn = scene::draw(model, &camera, size, &colors, SceneOptions::default());
        let surfaces = model.view.layout.scene.surfaces().iter().enumerate();
        for (board, surface) in surfaces {
            // It is nowhere until the open hand is shown.
            if surface.anchor() == Anchor::Start {
                assert!(model.world_from_board(board).is_none(), "{layout}");
                continue;
            }
            for (target, _) in surface.targets() {
                let points = points(model, &camera, view.size(), board, target);
                let is_drawn = |at: &Pos2| {
                    let on_screen = view.min + at.to_vec2();
                    let empty = [colors.board, colors.background];
                    let mut empty = empty
                        .iter()
                        .map(|below| without_control(&drawn, *at, *below));
                    empty.all(|empty| is_seen(&picture, on_screen, empty))
                };
                let names = model.view.layout.target_names();
                let name = names.get(target);
                assert!(
                    points.iter().any(is_drawn),
                    "{layout}: {name} at {:?}",
                    points[0]
                );
            }
        }
    }
}
