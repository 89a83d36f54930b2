use ademan::contact::hit_test::pressed_by;
use ademan::contact::surface::{Shape, TREMBLE, Target};
use parry3d::math::{Pose, Vec2, Vec3};
use serde_json::Value;

use super::{assert_close, list, number, numbers, text};

/// Contact is computed in `f32`: a micrometre per metre, here in scene units of at most 10.
const F32: f64 = 1e-5;

pub fn press(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["absolute"]) + F32;
    let mut cases = 0;
    for case in list(&file["cases"]) {
        let height = number(&case["height"]);
        let buttons: Vec<Target> = list(&case["buttons_xz"])
            .iter()
            .map(|place| button(&numbers(place), number(&case["half_extent"]), height))
            .collect();
        for sample in list(&case["samples"]) {
            let tips: Vec<Vec3> = list(&sample["tips"])
                .iter()
                .map(|tip| place(&numbers(tip)))
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

/// The pad's Y is up; ours is Z, so that its X and −Z lie on the board.
fn place(xyz: &[f64]) -> Vec3 {
    Vec3::new(xyz[0] as f32, -xyz[2] as f32, xyz[1] as f32)
}

fn button(xz: &[f64], half: f64, height: f64) -> Target {
    let middle = place(&[xz[0], height, xz[1]]);
    Target {
        shape: Shape::Box(Vec2::splat(half as f32)),
        surface_from_target: Pose::from_translation(middle),
        travel: height as f32,
        press_share: 0.5,
        release_share: 0.25,
        margin: TREMBLE,
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
    let (finger, depth, pressure) = match pressed_by(button, tips) {
        Some(press) => (
            Some(press.pad as u64),
            f64::from(press.depth),
            f64::from(press.pressure),
        ),
        None => (None, 0.0, 0.0),
    };
    assert_eq!(
        finger.is_some(),
        wanted[0].as_bool().expect("pressed"),
        "{name}"
    );
    assert_eq!(finger, wanted[1].as_u64(), "{name}");
    assert_close(1.0 - pressure, number(&wanted[2]), tolerance, name);
    assert_close(depth, number(&wanted[3]), tolerance * height, name);
    assert_close(pressure, number(&wanted[4]), tolerance, name);
}
