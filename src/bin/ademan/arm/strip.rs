//! A strip of pictures of a movement: above in the space of the attributes, below the landmarks moved in straight lines.

use std::fmt::Write;

use ademan::estimate::arm_attributes::{ArmLandmarks, HalfPose};
use glam::DVec3;

use crate::failure::Failure;

/// The number of pictures between two postures.
const STEPS: usize = 6;

/// The width and the largest height of a pose, in pixels.
const SIZE: [f64; 2] = [150.0, 190.0];

/// The height of a line of text, and the free edge of a pose, in pixels.
const EDGE: f64 = 22.0;

/// Draws a movement through postures. `pose_at` returns the pose on the way, in numbers of postures.
pub fn draw(
    postures: &[HalfPose],
    pose_at: impl Fn(f64) -> Result<HalfPose, Failure>,
) -> Result<String, Failure> {
    let count = (postures.len() - 1) * STEPS;
    let ways = (0..=count).map(|index| index as f64 / STEPS as f64);
    let mut rows = [Vec::new(), Vec::new()];
    for way in ways {
        rows[0].push(pose_at(way)?);
        rows[1].push(straight(postures, way));
    }
    let view = View::of(rows.iter().flatten());
    let mut svg = String::new();
    let (width, height) = (
        (SIZE[0] + EDGE) * (count + 1) as f64,
        2.0 * view.row_height(),
    );
    // A string takes all text.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>"
    );
    let titles = [
        "attributes: the bones keep their lengths",
        "landmarks in straight lines: the bones shrink",
    ];
    for (row, (poses, title)) in rows.iter().zip(titles).enumerate() {
        let top = row as f64 * view.row_height();
        let _ = writeln!(
            svg,
            "<text x=\"8\" y=\"{}\" fill=\"#222\">{title}</text>",
            top + 15.0
        );
        for (index, pose) in poses.iter().enumerate() {
            let corner = [index as f64 * (SIZE[0] + EDGE), top + 1.2 * EDGE];
            add_pose(&mut svg, &view, corner, pose, &postures[0]);
        }
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// Returns the landmarks moved in straight lines.
fn straight(postures: &[HalfPose], way: f64) -> HalfPose {
    let segment = (way.floor() as usize).min(postures.len() - 2);
    let (start, end) = (postures[segment].rows(), postures[segment + 1].rows());
    let fraction = way - segment as f64;
    HalfPose::from_rows(&std::array::from_fn(|row| {
        start[row].lerp(end[row], fraction)
    }))
}

/// The part of space that the pictures show.
struct View {
    low: DVec3,
    pixels_per_unit: f64,
    /// The height of a pose, in pixels.
    height: f64,
}

impl View {
    fn of<'a>(poses: impl Iterator<Item = &'a HalfPose>) -> Self {
        let points: Vec<DVec3> = poses.flat_map(HalfPose::rows).collect();
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = (high - low).max(DVec3::splat(1e-9));
        let fits = |axis: usize| SIZE[axis] / size[axis];
        let pixels_per_unit = fits(0).min(fits(1));
        Self {
            low,
            pixels_per_unit,
            height: size.y * pixels_per_unit,
        }
    }

    /// Returns the height of a row of poses with its texts.
    fn row_height(&self) -> f64 {
        self.height + 3.0 * EDGE
    }

    fn place(&self, corner: [f64; 2], point: DVec3) -> String {
        let at = (point - self.low) * self.pixels_per_unit;
        format!(
            "{:.1},{:.1}",
            corner[0] + EDGE / 2.0 + at.x,
            corner[1] + at.y
        )
    }
}

fn add_pose(svg: &mut String, view: &View, corner: [f64; 2], pose: &HalfPose, start: &HalfPose) {
    let trunk = pose.trunk();
    let outline = [
        trunk.shoulders[0],
        trunk.shoulders[1],
        trunk.hips[1],
        trunk.hips[0],
    ];
    let points: Vec<String> = outline
        .iter()
        .map(|&point| view.place(corner, point))
        .collect();
    let _ = writeln!(
        svg,
        "<polygon points=\"{}\" fill=\"#e6e6ec\" stroke=\"#99a\"/>",
        points.join(" ")
    );
    let mut upper_arm_percent = Vec::new();
    for (arm, first) in pose.arms.iter().zip(&start.arms) {
        add_line(
            svg,
            view,
            corner,
            &[arm.shoulder, arm.elbow, arm.wrist],
            "#1f5fbf",
            4.0,
        );
        for finger in [arm.little, arm.index, arm.thumb] {
            add_line(svg, view, corner, &[arm.wrist, finger], "#c0501f", 2.0);
        }
        upper_arm_percent.push(100.0 * upper_arm(arm) / upper_arm(first));
    }
    let shortest = upper_arm_percent.into_iter().fold(f64::INFINITY, f64::min);
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"#555\">upper arm {shortest:.0} %</text>",
        corner[0] + 8.0,
        corner[1] + view.height + 1.1 * EDGE
    );
}

fn upper_arm(arm: &ArmLandmarks) -> f64 {
    arm.shoulder.distance(arm.elbow)
}

fn add_line(
    svg: &mut String,
    view: &View,
    corner: [f64; 2],
    points: &[DVec3],
    color: &str,
    width: f64,
) {
    let points: Vec<String> = points
        .iter()
        .map(|&point| view.place(corner, point))
        .collect();
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"/>",
        points.join(" ")
    );
}
