//! A film of a hand for the fake camera of a browser: its palm faces the camera, and its index finger bends.
//!
//! The hand is drawn by sphere tracing of capsules that melt into each other, with the creases of fingers and palm, by which MediaPipe
//! tells a right hand from a left one.

use std::f32::consts::PI;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use glam::{Vec2, Vec3};

const WIDTH: usize = 320;
const HEIGHT: usize = 240;

/// Images per second of the film.
const RATE: usize = 15;

/// Distance of the camera, and the wrist relative to its axis, in metres.
const DISTANCE: f32 = 0.45;
const WRIST: Vec3 = Vec3::new(0.0, -0.09, 0.0);

/// Distance over which two parts melt into each other.
const MELTING: f32 = 0.012;

/// Knuckle, direction, lengths of the bones and radii of their ends, from index to little finger.
const FINGERS: [(Vec3, Vec3, [f32; 3], [f32; 4]); 4] = [
    (
        Vec3::new(0.027, 0.090, 0.0),
        Vec3::new(0.10, 1.0, 0.0),
        [0.040, 0.024, 0.020],
        [0.0100, 0.0095, 0.0086, 0.0078],
    ),
    (
        Vec3::new(0.005, 0.094, 0.0),
        Vec3::new(0.02, 1.0, 0.0),
        [0.044, 0.028, 0.021],
        [0.0104, 0.0097, 0.0088, 0.0079],
    ),
    (
        Vec3::new(-0.016, 0.088, 0.0),
        Vec3::new(-0.08, 1.0, 0.0),
        [0.040, 0.026, 0.021],
        [0.0099, 0.0092, 0.0083, 0.0074],
    ),
    (
        Vec3::new(-0.034, 0.076, 0.0),
        Vec3::new(-0.20, 1.0, 0.0),
        [0.031, 0.019, 0.018],
        [0.0087, 0.0080, 0.0072, 0.0065],
    ),
];

const THUMB: [(Vec3, f32); 4] = [
    (Vec3::new(0.018, 0.018, 0.006), 0.018),
    (Vec3::new(0.046, 0.050, 0.016), 0.0135),
    (Vec3::new(0.064, 0.078, 0.018), 0.0112),
    (Vec3::new(0.076, 0.102, 0.017), 0.0092),
];

/// The balls of thumb and hand, the middle of the palm, and the forearm: ends and radii.
const PALM: [(Vec3, Vec3, f32, f32); 4] = [
    (
        Vec3::new(0.016, 0.024, 0.010),
        Vec3::new(0.034, 0.046, 0.012),
        0.017,
        0.012,
    ),
    (
        Vec3::new(-0.020, 0.018, 0.006),
        Vec3::new(-0.030, 0.060, 0.004),
        0.017,
        0.013,
    ),
    (
        Vec3::new(0.0, 0.02, -0.002),
        Vec3::new(0.0, 0.07, -0.002),
        0.018,
        0.017,
    ),
    (
        Vec3::new(0.0, -0.30, 0.0),
        Vec3::new(0.0, 0.008, 0.0),
        0.034,
        0.024,
    ),
];

/// The lines of the palm: center, radius, first and last angle in degrees.
const LINES: [(Vec2, f32, f32, f32); 3] = [
    (Vec2::new(0.045, 0.028), 0.038, 100.0, 215.0),
    (Vec2::new(0.012, 0.145), 0.080, 205.0, 285.0),
    (Vec2::new(-0.012, 0.118), 0.040, 200.0, 330.0),
];

/// A hand: its parts, and the creases across its fingers, each with a point, the direction of the finger and a radius.
struct Hand {
    parts: Vec<(Vec3, Vec3, f32, f32)>,
    creases: Vec<(Vec3, Vec3, f32)>,
}

impl Hand {
    /// Creates a right hand whose index finger is bent by an angle in radians at its knuckle, and less beyond it.
    fn new(bend: f32) -> Self {
        let (mut parts, mut creases) = (PALM.to_vec(), Vec::new());
        for (number, (knuckle, direction, lengths, radii)) in FINGERS.into_iter().enumerate() {
            let bend = if number == 0 { bend } else { 0.05 };
            parts.push((
                Vec3::new(knuckle.x * 0.6, 0.014, -0.002),
                knuckle,
                0.015,
                radii[0] + 0.004,
            ));
            let (mut from, mut angle) = (knuckle, 0.0_f32);
            for bone in 0..3 {
                // A tap bends the knuckle most.
                angle += if bone == 0 { bend } else { 0.05 + 0.25 * bend };
                let along = direction.normalize() * angle.cos() + Vec3::Z * angle.sin();
                let to = from + along * lengths[bone];
                parts.push((from, to, radii[bone], radii[bone + 1]));
                let crease = if bone == 0 { from.lerp(to, 0.35) } else { from };
                creases.push((crease, along, radii[bone] * 1.6));
                from = to;
            }
        }
        for pair in THUMB.windows(2) {
            let ((from, first), (to, second)) = (pair[0], pair[1]);
            parts.push((from, to, first, second));
            creases.push((to, (to - from).normalize(), 0.018));
        }
        Self { parts, creases }
    }

    /// Returns the distance of a point from the skin.
    fn distance(&self, point: Vec3) -> f32 {
        let mut nearest = f32::MAX;
        for &(from, to, first, second) in &self.parts {
            let (offset, along) = (point - from, to - from);
            let t = (offset.dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let distance = (offset - along * t).length() - (first + (second - first) * t);
            let both = (MELTING - (nearest - distance).abs()).max(0.0) / MELTING;
            nearest = nearest.min(distance) - both * both * MELTING * 0.25;
        }
        nearest
    }

    fn normal(&self, point: Vec3) -> Vec3 {
        const STEP: f32 = 4e-4;
        let slope =
            |axis: Vec3| self.distance(point + axis * STEP) - self.distance(point - axis * STEP);
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).normalize_or_zero()
    }

    /// Returns the brightness of the skin at a point, 0 to 1.
    fn shade(&self, point: Vec3) -> f32 {
        let normal = self.normal(point);
        let light = normal.dot(Vec3::new(-0.4, 0.6, 0.7).normalize()).max(0.0);
        let open = (self.distance(point + normal * 0.01) / 0.01).clamp(0.2, 1.0);
        let mut albedo = 1.0;
        if normal.z > 0.0 {
            for &(at, along, radius) in &self.creases {
                let offset = point - at;
                let height = offset.dot(along);
                if (offset - along * height).length() < radius {
                    albedo -= 0.3 * (-(height / 0.0012).powi(2)).exp();
                }
            }
        }
        if normal.z > 0.2 {
            for (center, radius, first, last) in LINES {
                let offset = point.truncate() - center;
                let angle = (offset.to_angle() * 180.0 / PI).rem_euclid(360.0);
                if (first..=last).contains(&angle) {
                    albedo -= 0.32 * (-((offset.length() - radius) / 0.0012).powi(2)).exp();
                }
            }
        }
        let all = light * 0.7 + 0.45 + 0.15 * normal.y;
        all * (0.6 + 0.4 * open) * 0.85 * f32::max(albedo, 0.4)
    }
}

/// Returns an image in Y'CbCr 4:2:0 of a hand, or of the wall without one.
fn picture(hand: Option<&Hand>) -> Vec<u8> {
    const SKIN: Vec3 = Vec3::new(228.0, 175.0, 150.0);
    let focal = WIDTH as f32 / 2.0 / 30_f32.to_radians().tan();
    let mut pixels = Vec::with_capacity(WIDTH * HEIGHT);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let wall = 70.0 + 40.0 * y as f32 / HEIGHT as f32;
            let right = (x as f32 - WIDTH as f32 / 2.0) / focal;
            let up = (HEIGHT as f32 / 2.0 - y as f32) / focal;
            let ray = Vec3::new(right, up, -1.0).normalize();
            let hit = hand.and_then(|hand| Some((hand, trace(hand, ray)?)));
            let color = hit.map(|(hit_hand, point)| SKIN * hit_hand.shade(point));
            let color = color.unwrap_or(Vec3::new(0.95, 1.0, 1.02) * wall);
            pixels.push(color.clamp(Vec3::ZERO, Vec3::splat(255.0)));
        }
    }
    to_yuv(&pixels)
}

/// Returns the point of the skin in a direction from the camera.
fn trace(hand: &Hand, ray: Vec3) -> Option<Vec3> {
    let eye = Vec3::Z * DISTANCE - WRIST;
    let mut at = DISTANCE * 0.7;
    for _ in 0..70 {
        let point = eye + ray * at;
        let distance = hand.distance(point);
        if distance < 2e-4 {
            return Some(point);
        }
        at += distance * 0.9;
        if at > DISTANCE * 1.3 {
            return None;
        }
    }
    None
}

fn to_yuv(pixels: &[Vec3]) -> Vec<u8> {
    let luma = |color: &Vec3| color.dot(Vec3::new(0.299, 0.587, 0.114));
    let mut bytes: Vec<u8> = pixels.iter().map(|color| luma(color) as u8).collect();
    for channel in [Vec3::Z * 0.564, Vec3::X * 0.713] {
        for y in (0..HEIGHT).step_by(2) {
            for x in (0..WIDTH).step_by(2) {
                let color = pixels[y * WIDTH + x];
                let value = color.dot(channel) - luma(&color) * channel.element_sum();
                bytes.push((value + 128.0) as u8);
            }
        }
    }
    bytes
}

/// Writes a film: the open hand for six seconds; then its index finger bends and stretches three times; then it bends slowly, so that
/// it holds a key for several images of a slow machine, and the hand is gone for two seconds. A browser plays it again and again.
pub fn write_film(path: &Path) -> io::Result<()> {
    let open = picture(Some(&Hand::new(0.05)));
    let bent = [0.35, 0.6, 0.85, 1.05, 1.2].map(|bend| picture(Some(&Hand::new(bend))));
    let mut images: Vec<&[u8]> = vec![&open; 6 * RATE];
    for _ in 0..3 {
        images.extend(bent.iter().flat_map(|it| [it.as_slice(); 2]));
        images.extend([bent[4].as_slice(); 6]);
        images.extend(bent.iter().rev().flat_map(|it| [it.as_slice(); 2]));
        images.extend([open.as_slice(); 8]);
    }
    let slowly: Vec<_> = (1..=24)
        .map(|step| picture(Some(&Hand::new(0.05 * step as f32))))
        .collect();
    images.extend(slowly.iter().flat_map(|it| [it.as_slice(); 5]));
    images.extend([bent[4].as_slice(); 6]);
    let wall = picture(None);
    images.extend(vec![wall.as_slice(); 2 * RATE]);
    let mut file = BufWriter::new(File::create(path)?);
    writeln!(
        file,
        "YUV4MPEG2 W{WIDTH} H{HEIGHT} F{RATE}:1 Ip A1:1 C420jpeg"
    )?;
    for image in images {
        file.write_all(b"FRAME\n")?;
        file.write_all(image)?;
    }
    file.flush()
}
