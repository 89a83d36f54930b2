//! Seeded random cases in the forms of the reference vectors, checked by what the results mean: numbers that no file of
//! vectors has.

use ademan::capture::bvh::{Bvh, BvhWriter, Channel, Node, PositionChannels, Skeleton};
use ademan::capture::markers::{Ray, TriangulationError, closest_points, triangulate};
use ademan::capture::protocol::text_line;
use ademan::geometry::rotation_between;
use glam::{DMat4, DVec3};

use crate::vectors::markers::pairs_of_rays;

const ROUNDS: usize = 2000;

struct Random(fastrand::Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    fn within(&mut self, range: std::ops::Range<f64>) -> f64 {
        range.start + (range.end - range.start) * self.0.f64()
    }

    /// Returns a point of a cube about the origin.
    fn point(&mut self, half: f64) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.within(-half..half)))
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            if let Some(direction) = self.point(1.0).try_normalize() {
                return direction;
            }
        }
    }

    /// Returns a camera 2 m to 4 m away from the origin.
    fn camera(&mut self) -> DVec3 {
        self.direction() * self.within(2.0..4.0)
    }
}

#[test]
fn exact_rays_of_random_cameras_meet_in_the_marker() {
    let mut random = Random::new(1);
    for round in 0..ROUNDS {
        let marker = random.point(0.5);
        let cameras = random.0.usize(2..7);
        let mut rays: Vec<Ray> = (0..cameras)
            .map(|_| {
                let camera = random.camera();
                let scale = random.within(0.01..10.0);
                Ray {
                    origin: camera,
                    direction: (marker - camera) * scale,
                }
            })
            .collect();
        let found = triangulate(&rays).unwrap_or_else(|error| panic!("{round}: {error}"));
        // Two cameras in line with the marker see it under a small angle, which enlarges rounding.
        assert!(found.point.distance(marker) < 1e-6, "{round}: {found:?}");
        assert!(found.gap < 1e-6, "{round}: {found:?}");
        let behind = random.0.usize(0..cameras);
        rays[behind].direction *= -1.0;
        assert_eq!(triangulate(&rays), Err(TriangulationError::Behind(behind)));
    }
}

#[test]
fn the_closest_points_of_random_rays_are_closer_than_all_points_beside_them() {
    let mut random = Random::new(2);
    for round in 0..ROUNDS {
        let mut ray = || Ray {
            origin: random.point(3.0),
            direction: random.direction(),
        };
        let [first, second] = [ray(), ray()];
        let found = closest_points(&first, &second).expect("random rays are not parallel");
        let between = found.points[1] - found.points[0];
        for line in [&first, &second] {
            assert!(
                between.dot(line.direction).abs() < 1e-6,
                "{round}: {found:?}"
            );
        }
        let [k, l] = found.parameters;
        for step in [-0.01, 0.01] {
            assert!(first.at(k + step).distance(second.at(l)) >= found.gap());
            assert!(first.at(k).distance(second.at(l + step)) >= found.gap());
        }
        assert!((found.midpoint() - found.points[0] - between / 2.0).length() < 1e-9);
    }
}

#[test]
fn the_point_of_noisy_rays_has_the_least_squares_of_all_points_around_it() {
    let mut random = Random::new(3);
    for round in 0..ROUNDS {
        let marker = random.point(0.5);
        let rays: Vec<Ray> = (0..random.0.usize(3..7))
            .map(|_| Ray::through(random.camera(), marker + random.point(0.005)))
            .collect();
        let found = triangulate(&rays).expect("a point");
        let squares = |point: DVec3| {
            let distances = rays
                .iter()
                .map(|ray| ray.at(ray.nearest(point)).distance(point));
            distances.map(|distance| distance * distance).sum::<f64>()
        };
        let least = squares(found.point);
        for _ in 0..10 {
            let beside = found.point + random.direction() * 0.001;
            assert!(squares(beside) >= least, "{round}: {found:?}");
        }
    }
}

#[test]
fn random_markers_are_matched_at_no_greater_cost_than_the_true_pairs() {
    const MAX_GAP: f64 = 0.01;
    let mut random = Random::new(4);
    for round in 0..ROUNDS {
        let markers: Vec<DVec3> = (0..random.0.usize(1..12))
            .map(|_| random.point(0.5))
            .collect();
        let cameras = [random.camera(), random.camera()];
        let mut order: Vec<usize> = (0..markers.len()).collect();
        random.0.shuffle(&mut order);
        let first: Vec<Ray> = markers
            .iter()
            .map(|&it| Ray::through(cameras[0], it))
            .collect();
        let through = |&index: &usize| Ray::through(cameras[1], markers[index]);
        let second: Vec<Ray> = order.iter().map(through).collect();
        let pairs = pairs_of_rays(&first, &second, MAX_GAP);
        // The true pairs have no gap, so all markers have a pair.
        let total: f64 = pairs
            .iter()
            .enumerate()
            .map(|(row, column)| {
                let column = column.unwrap_or_else(|| panic!("{round}: {pairs:?}"));
                closest_points(&first[row], &second[column])
                    .expect("a pair")
                    .gap()
            })
            .sum();
        assert!(total < 1e-9, "{round}: {total}");
    }
}

#[test]
fn a_random_arm_is_turned_from_bone_to_bone() {
    let mut random = Random::new(5);
    for round in 0..ROUNDS {
        let [shoulder, elbow, wrist] = std::array::from_fn(|_| random.point(1.0));
        let (upper, fore) = (elbow - shoulder, wrist - elbow);
        let turn = rotation_between(upper, fore).expect("two bones");
        let turned = turn * upper.normalize();
        assert!(
            turned.distance(fore.normalize()) < 1e-9,
            "{round}: {turn:?}"
        );
        assert!((turn.determinant() - 1.0).abs() < 1e-9, "{round}");
        let axis = upper.cross(fore).normalize();
        assert!(
            (turn * axis).distance(axis) < 1e-9,
            "without twist: {round}"
        );
    }
}

/// Returns a random tree with joints that have random channels in random order.
fn skeleton(random: &mut Random) -> Skeleton {
    let mut skeleton = Skeleton::default();
    // The nodes from the root to the last one: a text lists them depth first.
    let mut open: Vec<usize> = Vec::new();
    for number in 0..random.0.usize(1..12) {
        open.truncate(random.0.usize(1..=open.len().max(1)));
        let mut channels = Channel::ALL.to_vec();
        random.0.shuffle(&mut channels);
        // A motion without any channel is no motion.
        let least = usize::from(number == 0);
        channels.truncate(random.0.usize(least..=channels.len()));
        let index = skeleton.push(Node {
            name: Some(format!("joint{number}")),
            parent: open.last().copied(),
            offset: random.point(50.0),
            channels,
        });
        open.push(index);
    }
    skeleton
}

/// Returns the world positions by 4 × 4 matrices.
fn positions(skeleton: &Skeleton, values: &[f64]) -> Vec<DVec3> {
    let mut world: Vec<DMat4> = Vec::new();
    let mut rest = values.iter();
    for node in skeleton.nodes() {
        let parent = node.parent.map_or(DMat4::IDENTITY, |parent| world[parent]);
        let (mut moved, mut turned) = (node.offset, DMat4::IDENTITY);
        for channel in &node.channels {
            let value = *rest.next().expect("a value for each channel");
            match channel {
                Channel::XPosition => moved.x += value,
                Channel::YPosition => moved.y += value,
                Channel::ZPosition => moved.z += value,
                Channel::XRotation => turned *= DMat4::from_rotation_x(value.to_radians()),
                Channel::YRotation => turned *= DMat4::from_rotation_y(value.to_radians()),
                Channel::ZRotation => turned *= DMat4::from_rotation_z(value.to_radians()),
            }
        }
        world.push(parent * DMat4::from_translation(moved) * turned);
    }
    world.iter().map(|pose| pose.w_axis.truncate()).collect()
}

#[test]
fn random_motion_captures_are_written_and_read_with_the_same_positions() {
    let mut random = Random::new(6);
    for round in 0..ROUNDS / 10 {
        let skeleton = skeleton(&mut random);
        let channels: usize = skeleton
            .nodes()
            .iter()
            .map(|node| node.channels.len())
            .sum();
        let frames: Vec<Vec<f64>> = (0..5)
            .map(|_| {
                (0..channels)
                    .map(|_| random.within(-400.0..400.0))
                    .collect()
            })
            .collect();
        let file = std::io::Cursor::new(Vec::new());
        let mut writer = BvhWriter::new(file, &skeleton, 0.01).expect("memory");
        for frame in &frames {
            writer.write_frame(frame).expect("memory");
        }
        let text = writer.finish().expect("memory").into_inner();
        let read = Bvh::parse(&text)
            .unwrap_or_else(|error| panic!("{round}: {error}\n{}", String::from_utf8_lossy(&text)));
        for (number, frame) in frames.iter().enumerate() {
            let found = read.positions(number as u64, PositionChannels::Add);
            for (point, expected) in found.iter().zip(positions(&skeleton, frame)) {
                // Six decimals of angles, along up to twelve bones of 800 units.
                assert!(
                    point.distance(expected) < 1e-3,
                    "{round}: {point} {expected}"
                );
            }
        }
    }
}

#[test]
fn random_text_lines_have_their_numbers_in_every_notation() {
    let mut random = Random::new(7);
    for _ in 0..ROUNDS {
        let values: [f64; text_line::VALUES] =
            std::array::from_fn(|_| random.within(-1.0..1.0) * 10_f64.powi(random.0.i32(-8..4)));
        let mut line = String::new();
        for value in values {
            line += &match random.0.u8(0..3) {
                0 => format!("{value}"),
                1 => format!("{value:e}"),
                _ => format!("{value:+E}"),
            };
            line += random.0.choice([" ", "\t", "  "]).expect("a separator");
        }
        line += random.0.choice(["", "\n", "\r\n"]).expect("a line end");
        assert_eq!(text_line::parse(&line), Ok(values), "{line}");
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let short = words[1..].join(" ");
        assert!(text_line::parse(&short).is_err(), "63 numbers");
    }
}
