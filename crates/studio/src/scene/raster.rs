//! Skin as an image: triangles with a depth buffer, so that the nearer of two surfaces is seen at each pixel.

use std::ops::Range;

use parry3d::math::{Vec2, Vec3};

use crate::picture::{Color, Image};

/// Pixels per point. The window averages four of them, which smooths edges.
const DENSITY: f32 = 2.0;

/// The largest number of pixels. A larger image has fewer pixels per point.
const MAX_PIXELS: f32 = 800_000.0;

/// Distance up to which the surfaces of two limbs that grow together blend, in metres.
const SEAM: f32 = 0.004;

/// The smallest opacity of a surface that hides what is behind it.
const MIN_OPACITY: f32 = 0.02;

/// A corner of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Position in points.
    pub position: Vec2,
    /// Distance from the eye, in metres.
    pub depth: f32,
    /// Color; opaque.
    pub color: Color,
    /// Opacity, 0..=1.
    pub opacity: f32,
    /// The surface faces the eye.
    pub is_front: bool,
}

/// Surfaces of limbs. Surfaces of the same limb do not blend with each other.
#[derive(Debug, Default)]
pub(super) struct Mesh {
    triangles: Vec<([Corner; 3], u8)>,
    limbs: u8,
}

impl Mesh {
    /// Starts another limb, to which the triangles from now on belong.
    pub fn start_limb(&mut self) {
        self.limbs = self.limbs.saturating_add(1);
    }

    /// Adds a triangle.
    pub fn add(&mut self, corners: [Corner; 3]) {
        self.triangles.push((corners, self.limbs));
    }

    /// Draws the surfaces on a picture of this size in points, with an opacity of the whole. Returns `None` if nothing is on it.
    pub fn draw(&self, size: Vec2, opacity: f32) -> Option<Image> {
        let corners = self.triangles.iter().flat_map(|(corners, _)| corners);
        let bounds = corners.fold((Vec2::MAX, Vec2::MIN), |(low, high), corner| {
            (low.min(corner.position), high.max(corner.position))
        });
        let (low, high) = (bounds.0.max(Vec2::ZERO).floor(), bounds.1.min(size).ceil());
        let extent = high - low;
        if extent.min_element().is_nan() || extent.min_element() < 1.0 {
            return None;
        }
        let density = (MAX_PIXELS / (extent.x * extent.y)).sqrt().min(DENSITY);
        let mut buffer = Buffer::new(low, extent, density);
        for (triangle, limb) in &self.triangles {
            buffer.fill(triangle, *limb);
        }
        Some(buffer.into_image(opacity))
    }
}

/// A triangle as the pixels read it: each value at the three corners.
struct Surface {
    nearness: Vec3,
    opacity: Vec3,
    red: Vec3,
    green: Vec3,
    blue: Vec3,
    /// Most of it faces the eye.
    is_front: bool,
    limb: u8,
}

impl Surface {
    fn new(corners: &[Corner; 3], limb: u8) -> Self {
        let channel =
            |channel: usize| Vec3::from(corners.map(|corner| f32::from(corner.color.0[channel])));
        Self {
            nearness: Vec3::from(corners.map(|corner| corner.depth.recip())),
            opacity: Vec3::from(corners.map(|corner| corner.opacity)),
            red: channel(0),
            green: channel(1),
            blue: channel(2),
            is_front: corners.iter().filter(|corner| corner.is_front).count() >= 2,
            limb,
        }
    }

    /// Returns the color at a point, by the weights of the corners; opaque.
    fn color(&self, weights: Vec3) -> Color {
        Color::rgb(
            (self.red.dot(weights) + 0.5) as u8,
            (self.green.dot(weights) + 0.5) as u8,
            (self.blue.dot(weights) + 0.5) as u8,
        )
    }
}

/// The pixels so far.
struct Buffer {
    origin: Vec2,
    density: f32,
    size: [usize; 2],
    /// The reciprocal of the depth, which is linear on the screen; 0 without a surface.
    nearness: Vec<f32>,
    /// The limb of the surface; 0 without one.
    limbs: Vec<u8>,
    colors: Vec<Color>,
}

impl Buffer {
    fn new(origin: Vec2, extent: Vec2, density: f32) -> Self {
        let pixels = (extent * density).ceil();
        let size = [pixels.x as usize, pixels.y as usize];
        let count = size[0] * size[1];
        Self {
            origin,
            density,
            size,
            nearness: vec![0.0; count],
            limbs: vec![0; count],
            colors: vec![Color([0; 4]); count],
        }
    }

    fn fill(&mut self, corners: &[Corner; 3], limb: u8) {
        let [a, b, c] = corners.map(|corner| (corner.position - self.origin) * self.density);
        let area = (b - a).perp_dot(c - a);
        if area.abs() < 1e-9 || !area.is_finite() {
            return;
        }
        let surface = Surface::new(corners, limb);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let columns = centers(low.x, high.x, self.size[0]);
        for row in centers(low.y, high.y, self.size[1]) {
            for column in columns.clone() {
                let at = Vec2::new(column as f32, row as f32) + 0.5;
                let u = (c - b).perp_dot(at - b) / area;
                let v = (a - c).perp_dot(at - c) / area;
                let w = 1.0 - u - v;
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    self.put(row * self.size[0] + column, &surface, Vec3::new(u, v, w));
                }
            }
        }
    }

    /// Puts a point of a surface on a pixel, if it is the nearest one there, and blends it with another limb close to it.
    fn put(&mut self, index: usize, surface: &Surface, weights: Vec3) {
        let nearness = surface.nearness.dot(weights);
        let (old, old_color) = (self.nearness[index], self.colors[index]);
        let is_other = surface.is_front && self.limbs[index] != surface.limb && old > 0.0;
        let gap = if is_other {
            (1.0 / old - 1.0 / nearness).abs() / SEAM
        } else {
            1.0
        };
        if nearness <= old && gap >= 1.0 {
            return;
        }
        let opacity = surface.opacity.dot(weights).clamp(0.0, 1.0);
        if opacity < MIN_OPACITY {
            return;
        }
        let own = surface.color(weights);
        let share = 0.5 + 0.5 * gap.min(1.0);
        let old_opacity = f32::from(old_color.0[3]) / 255.0;
        if nearness <= old {
            let mixed = own.mix(old_color, share);
            self.colors[index] = mixed.with_opacity(old_opacity);
            return;
        }
        // A surface does not blend with another surface of its own limb.
        self.colors[index] = if is_other {
            let mixed = old_color.mix(own, share * opacity);
            mixed.with_opacity(opacity + old_opacity * (1.0 - opacity))
        } else {
            own.with_opacity(opacity)
        };
        self.nearness[index] = nearness;
        self.limbs[index] = surface.limb;
    }

    fn into_image(mut self, opacity: f32) -> Image {
        // Most pixels around a hand are empty.
        for color in self.colors.iter_mut().filter(|color| color.0[3] > 0) {
            *color = color.with_opacity(f32::from(color.0[3]) / 255.0 * opacity);
        }
        let [width, height] = self.size;
        let extent = Vec2::new(width as f32, height as f32) / self.density;
        Image {
            corners: [self.origin, self.origin + extent],
            size: self.size,
            pixels: self.colors,
        }
    }
}

/// Returns the pixels of a row or column whose centers are between two positions.
fn centers(low: f32, high: f32, count: usize) -> Range<usize> {
    let first = (low - 0.5).ceil().max(0.0) as usize;
    let end = ((high - 0.5).floor() + 1.0).max(0.0) as usize;
    first..end.min(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color = Color::rgb(200, 0, 0);
    const BLUE: Color = Color::rgb(0, 0, 200);
    const SIZE: Vec2 = Vec2::new(20.0, 20.0);

    /// Returns a triangle over the upper left half of a square, with a depth at each corner.
    fn triangle(depths: [f32; 3], color: Color) -> [Corner; 3] {
        let at = [(0.0, 0.0), (20.0, 0.0), (0.0, 20.0)];
        std::array::from_fn(|index| Corner {
            position: Vec2::new(at[index].0, at[index].1),
            depth: depths[index],
            color,
            opacity: 1.0,
            is_front: true,
        })
    }

    fn draw(triangles: &[[Corner; 3]], opacity: f32) -> Image {
        let mut mesh = Mesh::default();
        for corners in triangles {
            mesh.start_limb();
            mesh.add(*corners);
        }
        mesh.draw(SIZE, opacity).expect("it is on the picture")
    }

    /// Returns the color at a point.
    fn color(image: &Image, x: f32, y: f32) -> Color {
        let [low, high] = image.corners;
        let [width, height] = image.size;
        let t = (Vec2::new(x, y) - low) / (high - low);
        let (column, row) = (t.x * width as f32, t.y * height as f32);
        image.pixels[row as usize * width + column as usize]
    }

    #[test]
    fn the_nearer_surface_is_seen_at_each_pixel() {
        // They cross in the middle.
        let falling = triangle([0.5, 1.5, 0.5], RED);
        let rising = triangle([1.5, 0.5, 1.5], BLUE);
        for surfaces in [[falling, rising], [rising, falling]] {
            let image = draw(&surfaces, 1.0);
            assert_eq!(color(&image, 1.0, 2.0), RED);
            assert_eq!(color(&image, 18.0, 1.0), BLUE);
            assert_eq!(color(&image, 18.0, 18.0).0[3], 0, "no surface is there");
        }
    }

    #[test]
    fn surfaces_that_cover_each_other_are_as_transparent_as_one() {
        let near = triangle([0.5; 3], RED);
        let far = triangle([0.8; 3], BLUE);
        let image = draw(&[far, near], 0.5);
        assert_eq!(color(&image, 3.0, 3.0), RED.with_opacity(0.5));
        let reversed = draw(&[near, far], 0.5);
        assert_eq!(color(&reversed, 3.0, 3.0), RED.with_opacity(0.5));
    }

    #[test]
    fn the_far_side_of_a_limb_is_not_seen_through_its_near_side() {
        let mut near = triangle([0.5; 3], RED);
        near.iter_mut().for_each(|corner| corner.opacity = 0.5);
        let far = triangle([0.8; 3], BLUE);
        for surfaces in [[near, far], [far, near]] {
            let mut mesh = Mesh::default();
            mesh.start_limb();
            surfaces.into_iter().for_each(|corners| mesh.add(corners));
            let image = mesh.draw(SIZE, 1.0).expect("an image");
            assert_eq!(color(&image, 3.0, 3.0), RED.with_opacity(0.5));
        }
        // Another limb that was drawn before is seen.
        let other = draw(&[far, near], 1.0);
        let Color([red, _, blue, opacity]) = color(&other, 3.0, 3.0);
        assert!(
            red > 80 && blue > 80 && opacity > 253,
            "{red} {blue} {opacity}"
        );
    }

    #[test]
    fn limbs_that_grow_together_blend() {
        let one = triangle([0.5; 3], RED);
        let other = triangle([0.5 + SEAM / 4.0; 3], BLUE);
        for surfaces in [[one, other], [other, one]] {
            let Color([red, _, blue, opacity]) = color(&draw(&surfaces, 1.0), 3.0, 3.0);
            assert!(red > 100 && blue > 40 && opacity == 255, "{red} {blue}");
        }
    }

    #[test]
    fn a_large_image_has_no_more_pixels_than_the_limit() {
        let mut corners = triangle([0.5; 3], RED);
        for corner in &mut corners {
            corner.position *= 1000.0;
        }
        let mut mesh = Mesh::default();
        mesh.add(corners);
        let image = mesh.draw(Vec2::splat(3000.0), 1.0).expect("an image");
        assert!(image.pixels.len() as f32 <= 1.01 * MAX_PIXELS);
        assert!(mesh.draw(Vec2::ZERO, 1.0).is_none());
    }
}
