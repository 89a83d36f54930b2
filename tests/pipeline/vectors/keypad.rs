use ademan::contact::TargetId;
use ademan::contact::hit_test::penetration_depth;
use ademan::contact::surface::{Scene, Shape, Share, TREMOR_MARGIN, Target};
use ademan::hand::Side;
use ademan::kinematics::HandPose;
use ademan::layout::Layout;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Vec2, Vec3};
use serde_json::Value;

use super::check::{assert_close, list, number, numbers, text};

/// The rounding error of `f32` contact tests, for coordinates of at most 10 units.
const F32: f64 = 1e-5;

pub fn press(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["absolute"]) + F32;
    let mut cases = 0;
    for case in list(&file["cases"]) {
        let height = number(&case["height"]);
        let buttons: Vec<Target> = list(&case["buttons_xz"])
            .iter()
            .map(|center| button(&numbers(center), number(&case["half_extent"]), height))
            .collect();
        for sample in list(&case["samples"]) {
            let tips: Vec<Vec3> = list(&sample["tips"])
                .iter()
                .map(|tip| position(&numbers(tip)))
                .collect();
            let clamped = sample.get("clamped").unwrap_or(&sample["as_coded"]);
            for (button, wanted) in buttons.iter().zip(list(clamped)) {
                assert_button(
                    button,
                    &tips,
                    wanted,
                    height,
                    tolerance,
                    text(&case["name"]),
                );
            }
            cases += 1;
        }
    }
    cases
}

/// The scale of the layout in millimetres per unit of the vectors, so that every pad is a valid board.
const MILLIMETRES: f64 = 10.0;

/// The distance from an edge, in units, below which a fingertip may be on either side: the board is rotated into the
/// world in `f32`.
const EDGE: f64 = 1e-5;

/// Checks the same pads as layout files.
pub fn press_through_layouts(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["absolute"]) + F32;
    let mut cases = 0;
    for case in list(&file["cases"]) {
        let (height, half) = (number(&case["height"]), number(&case["half_extent"]));
        let buttons: Vec<Vec<f64>> = list(&case["buttons_xz"]).iter().map(numbers).collect();
        let layout = layout(&buttons, half, height);
        for sample in list(&case["samples"]) {
            let tips: Vec<Vec<f64>> = list(&sample["tips"]).iter().map(numbers).collect();
            let clamped = sample.get("clamped").unwrap_or(&sample["as_coded"]);
            let wanted = list(clamped);
            for (number, (button, expected)) in buttons.iter().zip(wanted).enumerate() {
                if tips
                    .iter()
                    .any(|tip| is_at_an_edge(tip, button, half, height))
                {
                    continue;
                }
                let (target, tips) = on_board(&layout.scene, number as u32, &tips);
                let target = in_units(target);
                assert_button(
                    &target,
                    &tips,
                    expected,
                    height,
                    tolerance,
                    text(&case["name"]),
                );
            }
            cases += 1;
        }
    }
    cases
}

fn is_at_an_edge(tip: &[f64], button: &[f64], half: f64, height: f64) -> bool {
    let is_at_edge = |x: f64, center: f64| ((x - center).abs() - half).abs() < EDGE;
    is_at_edge(tip[0], button[0]) || is_at_edge(tip[2], button[1]) || (tip[1] - height).abs() < EDGE
}

/// Builds a layout with one board for each button, because the buttons of one board must not overlap.
fn layout(buttons: &[Vec<f64>], half: f64, height: f64) -> Layout {
    let boards = buttons.iter().enumerate().map(|(number, xz)| {
        format!(
            "(pose: (anchor: world, height_mm: {}), travel_mm: {}, reports_depth: true, keys: [\
             (code: \"F{}\", at_mm: ({}, {}), size_mm: Box({size}, {size}))])",
            height * MILLIMETRES,
            height * MILLIMETRES,
            number + 1,
            xz[0] * MILLIMETRES,
            -xz[1] * MILLIMETRES,
            size = 2.0 * half * MILLIMETRES,
        )
    });
    let boards: Vec<String> = boards.collect();
    let text = format!("Layout(name: \"pad\", boards: [{}])", boards.join(", "));
    Layout::parse(&text, "pad.ron").unwrap_or_else(|error| panic!("{error}"))
}

/// Returns a target, and the fingertips in the frame of its surface, in units.
fn on_board(scene: &Scene, number: u32, tips: &[Vec<f64>]) -> (Target, Vec<Vec3>) {
    let (surface, target) = scene.target(TargetId(number)).expect("a button");
    let pose = HandPose::new(Timestamp(0), Side::Right, 0.0);
    let world_from_surface = surface
        .world_from_surface(&pose)
        .expect("a board in the world");
    let metres = MILLIMETRES as f32 * 1e-3;
    let in_surface = |tip: &Vec<f64>| {
        let tip = Vec3::new(tip[0] as f32, tip[1] as f32, tip[2] as f32) * metres;
        world_from_surface.inverse_transform_point(tip) / metres
    };
    (*target, tips.iter().map(in_surface).collect())
}

/// Converts a target to the units of the vectors.
fn in_units(target: Target) -> Target {
    let units = 1e3 / MILLIMETRES as f32;
    let Shape::Box(half) = target.shape else {
        panic!("a button is a box");
    };
    Target {
        shape: Shape::Box(half * units),
        surface_from_target: Pose::from_translation(target.surface_from_target.translation * units),
        travel: target.travel * units,
        ..target
    }
}

/// Converts coordinates: +Y of the vectors is +Z of the board, and −Z is +Y.
fn position(xyz: &[f64]) -> Vec3 {
    Vec3::new(xyz[0] as f32, -xyz[2] as f32, xyz[1] as f32)
}

fn button(xz: &[f64], half: f64, height: f64) -> Target {
    let center = position(&[xz[0], height, xz[1]]);
    Target {
        shape: Shape::Box(Vec2::splat(half as f32)),
        share: Share::NONE,
        surface_from_target: Pose::from_translation(center),
        travel: height as f32,
        press_at: 0.5,
        release_at: 0.25,
        margin: TREMOR_MARGIN,
    }
}

fn assert_button(
    button: &Target,
    tips: &[Vec3],
    wanted: &Value,
    height: f64,
    tolerance: f64,
    name: &str,
) {
    let depths = tips.iter().map(|&tip| {
        let pad = button.surface_from_target.inverse_transform_point(tip);
        penetration_depth(button, pad).map(f64::from)
    });
    let depths: Vec<Option<f64>> = depths.collect();
    let deepest = depths.iter().flatten().copied().reduce(f64::max);
    // Fingertips of the same depth may differ by rounding.
    let is_deepest = |depth: &Option<f64>| depth.is_some_and(|own| Some(own + F32) >= deepest);
    let finger = depths.iter().position(is_deepest);
    let depth = deepest.unwrap_or(0.0);
    let pressure = depth / f64::from(button.travel);
    assert_eq!(
        finger.is_some(),
        wanted[0].as_bool().expect("pressed"),
        "{name}"
    );
    let wanted_finger = wanted[1].as_u64().map(|index| index as usize);
    assert_eq!(finger, wanted_finger, "{name}");
    assert_close(1.0 - pressure, number(&wanted[2]), tolerance, name);
    assert_close(depth, number(&wanted[3]), tolerance * height, name);
    assert_close(pressure, number(&wanted[4]), tolerance, name);
}
