//! Marks in images: bright or colored discs, with their centers to a fraction of a pixel.
//!
//! The center of the first pixel is (0, 0), as in OpenCV.

use glam::DVec2;

/// Number of levels between the threshold and the brightest pixel at which a shape is tested for several marks.
const LEVELS: usize = 24;

/// An image whose pixels have values from 0 to 1: the degree to which they belong to a mark.
#[derive(Clone, Debug)]
pub struct MarkImage {
    width: usize,
    values: Vec<f32>,
}

/// The limits of a mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkSettings {
    /// Smallest value of a pixel of a mark, above 0 and below 1.
    pub threshold: f32,
    /// Fewest pixels of a mark.
    pub min_px: usize,
    /// Most pixels of a mark.
    pub max_px: usize,
    /// Largest ratio of length to width, 1 or more; 1 is a disc.
    pub max_elongation: f64,
}

/// A mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundMark {
    /// The centroid, in pixels. A mark on its own is weighted with the pixels around it, by their values above the surroundings; a mark
    /// of a divided shape by its values above the level of the division.
    pub center: DVec2,
    /// Number of its pixels at or above the threshold or, for a mark of a divided shape, the level of the division.
    pub pixels: usize,
}

/// The marks of an image, and the numbers of shapes that are not marks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FoundMarks {
    /// The marks, from the left to the right.
    pub marks: Vec<FoundMark>,
    /// Shapes at the edge of the image, whose center cannot be seen.
    pub cut: usize,
    /// Shapes that are too long: marks that touch each other, or reflections.
    pub long: usize,
    /// Shapes with fewer or more pixels than a mark.
    pub other_size: usize,
    /// The largest value of a pixel.
    pub brightest: f32,
}

impl MarkImage {
    /// Creates an image from values from 0 to 1, row by row. Values that are not finite count as 0. `None` if `values` is empty or the
    /// last row is not complete.
    pub fn new(width: usize, mut values: Vec<f32>) -> Option<Self> {
        if width == 0 || values.is_empty() || !values.len().is_multiple_of(width) {
            return None;
        }
        for value in &mut values {
            if !value.is_finite() {
                *value = 0.0;
            }
        }
        Some(Self { width, values })
    }

    fn neighbors(&self, pixel: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.width, self.values.len() / self.width);
        let (x, y) = (pixel % width, pixel / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        rows.flat_map(move |row| {
            let columns = x.saturating_sub(1)..=(x + 1).min(width - 1);
            columns.map(move |column| row * width + column)
        })
    }

    fn is_at_edge(&self, pixel: usize) -> bool {
        let (x, y) = (pixel % self.width, pixel / self.width);
        x == 0 || y == 0 || x + 1 == self.width || (y + 1) * self.width == self.values.len()
    }

    /// Returns the centroid of a shape with its edge, weighted by the values above the surroundings. Pixels at the edge that a mark
    /// covers in part are below the threshold: without them the center would be off by a tenth of a pixel.
    fn centroid(&self, shape: &[usize], level: f32) -> DVec2 {
        let mut inside = shape.to_vec();
        inside.sort_unstable();
        let is_other = |pixel: usize, own: &[usize]| {
            self.values[pixel] >= level && own.binary_search(&pixel).is_err()
        };
        // The edge of a neighboring mark belongs to the neighbor.
        let mut edge = self.around(&inside);
        edge.retain(|&pixel| !self.neighbors(pixel).any(|pixel| is_other(pixel, &inside)));
        let shape_pixels = inside.len();
        inside.extend(edge);
        let mut all = inside.clone();
        all.sort_unstable();
        let mut surroundings: Vec<f32> = self
            .around(&all)
            .into_iter()
            .map(|pixel| self.values[pixel])
            .filter(|value| *value < level)
            .collect();
        surroundings.sort_unstable_by(f32::total_cmp);
        let background = surroundings.get(surroundings.len() / 2);
        let background = f64::from(background.copied().unwrap_or(0.0));
        let (mut sum, mut total) = (DVec2::ZERO, 0.0);
        for (index, pixel) in inside.into_iter().enumerate() {
            let above = f64::from(self.values[pixel]) - background;
            // A pixel darker than the surroundings is noise, and counts at the edge only.
            let weight = if index < shape_pixels {
                above.max(1e-6)
            } else {
                above
            };
            sum += weight * DVec2::new((pixel % self.width) as f64, (pixel / self.width) as f64);
            total += weight;
        }
        sum / total
    }

    /// Returns the pixels that touch a sorted list of pixels and are not in it, in order.
    fn around(&self, sorted: &[usize]) -> Vec<usize> {
        let neighbors = sorted.iter().flat_map(|&pixel| self.neighbors(pixel));
        let is_outside = |pixel: &usize| sorted.binary_search(pixel).is_err();
        let mut around: Vec<usize> = neighbors.filter(is_outside).collect();
        around.sort_unstable();
        around.dedup();
        around
    }

    /// Returns the centroid of a shape, weighted by the values above `level`, and its length as a multiple of its width.
    fn moments(&self, shape: &[usize], level: f32) -> (DVec2, f64) {
        let weighted = || {
            shape.iter().map(|&pixel| {
                let place = DVec2::new((pixel % self.width) as f64, (pixel / self.width) as f64);
                // A flat mark at the threshold has a center too.
                (place, f64::from(self.values[pixel] - level) + 1e-6)
            })
        };
        let total: f64 = weighted().map(|(_, weight)| weight).sum();
        let center = weighted()
            .map(|(place, weight)| place * weight)
            .sum::<DVec2>()
            / total;
        let mut spread = [0.0; 3];
        for (place, weight) in weighted() {
            let DVec2 { x, y } = place - center;
            spread[0] += weight * x * x / total;
            spread[1] += weight * x * y / total;
            spread[2] += weight * y * y / total;
        }
        // The variance of a pixel, so that a row of pixels has a width.
        let pixel = 1.0 / 12.0;
        let [xx, xy, yy] = spread;
        let (mean, half) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
        (
            center,
            ((mean + half + pixel) / (mean - half + pixel)).sqrt(),
        )
    }
}

/// The pixels of an image that belong to no shape yet. Pixels that touch at a corner are connected.
struct OpenPixels<'a> {
    image: &'a MarkImage,
    is_open: Vec<bool>,
}

impl<'a> OpenPixels<'a> {
    /// Opens the pixels with at least the value `level`.
    fn new(image: &'a MarkImage, level: f32) -> Self {
        let is_open = image.values.iter().map(|value| *value >= level);
        Self {
            image,
            is_open: is_open.collect(),
        }
    }

    /// Takes the shape of a pixel into `shape`, whose memory serves for all shapes of the image: noise has as many of them as pixels.
    /// Returns `false` if the pixel is not open.
    fn take_shape(&mut self, start: usize, shape: &mut Vec<usize>) -> bool {
        shape.clear();
        if !std::mem::take(&mut self.is_open[start]) {
            return false;
        }
        shape.push(start);
        let mut next = 0;
        while let Some(&pixel) = shape.get(next) {
            next += 1;
            for neighbor in self.image.neighbors(pixel) {
                if std::mem::take(&mut self.is_open[neighbor]) {
                    shape.push(neighbor);
                }
            }
        }
        true
    }

    /// Returns the parts of a shape with at least the value `level` that have `min_px` pixels or more. No other pixel next to the
    /// shape is open, so that the parts close what is opened here, and nothing else.
    fn parts(&mut self, shape: &[usize], level: f32, min_px: usize) -> Vec<Vec<usize>> {
        for &pixel in shape {
            self.is_open[pixel] = self.image.values[pixel] >= level;
        }
        let (mut parts, mut part) = (Vec::new(), Vec::new());
        for &start in shape {
            if self.take_shape(start, &mut part) && part.len() >= min_px {
                parts.push(part.clone());
            }
        }
        parts
    }
}

/// Finds the marks of an image.
///
/// A shape that is longer than a mark is divided at the lowest level at which it falls into several marks. If there is no such level, it
/// is left out and counted, because the center of marks that overlap is not known. A shape of more than `max_px` pixels is not divided.
pub fn find_marks(image: &MarkImage, settings: &MarkSettings) -> FoundMarks {
    let mut found = FoundMarks {
        brightest: image.values.iter().copied().fold(0.0, f32::max),
        ..FoundMarks::default()
    };
    let mut open = OpenPixels::new(image, settings.threshold);
    let mut shape = Vec::new();
    for start in 0..image.values.len() {
        if !open.take_shape(start, &mut shape) {
            continue;
        }
        if shape.len() < settings.min_px || shape.len() > settings.max_px {
            found.other_size += 1;
        } else if shape.iter().any(|&pixel| image.is_at_edge(pixel)) {
            found.cut += 1;
        } else {
            add_shape(&mut open, &shape, settings, &mut found);
        }
    }
    let by_place = |one: &FoundMark, other: &FoundMark| {
        let x = one.center.x.total_cmp(&other.center.x);
        x.then(one.center.y.total_cmp(&other.center.y))
    };
    found.marks.sort_by(by_place);
    found
}

/// Adds a shape as a mark or as several marks, or counts it as too long.
fn add_shape(
    open: &mut OpenPixels,
    shape: &[usize],
    settings: &MarkSettings,
    found: &mut FoundMarks,
) {
    let image = open.image;
    let mark_at = |part: &[usize], level: f32| {
        let (center, elongation) = image.moments(part, level);
        // A disc of few pixels is less round.
        let limit = settings.max_elongation + 1.0 / part.len() as f64;
        let pixels = part.len();
        (elongation <= limit).then_some(FoundMark { center, pixels })
    };
    if let Some(mark) = mark_at(shape, settings.threshold) {
        let center = image.centroid(shape, settings.threshold);
        found.marks.push(FoundMark { center, ..mark });
        return;
    }
    let values = || shape.iter().map(|&pixel| image.values[pixel]);
    let brightest = values().fold(0.0, f32::max);
    // Two marks have at least as many pixels.
    let fewest = settings.min_px.max(1).saturating_mul(2);
    for step in 1..LEVELS {
        let fraction = step as f32 / LEVELS as f32;
        let level = settings.threshold + (brightest - settings.threshold) * fraction;
        if values().filter(|value| *value >= level).count() < fewest {
            // A higher level leaves no more pixels.
            break;
        }
        let parts = open.parts(shape, level, settings.min_px);
        if parts.len() < 2 {
            continue;
        }
        let marks: Option<Vec<FoundMark>> = parts.iter().map(|part| mark_at(part, level)).collect();
        if let Some(marks) = marks {
            found.marks.extend(marks);
            return;
        }
    }
    found.long += 1;
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: MarkSettings = MarkSettings {
        threshold: 0.5,
        min_px: 4,
        max_px: 10_000,
        max_elongation: 1.3,
    };

    /// Draws discs with the share of each pixel that they cover, from 64 points of it, over a background with noise.
    fn draw(size: [usize; 2], discs: &[(DVec2, f64)], random: &mut fastrand::Rng) -> MarkImage {
        let mut values = Vec::new();
        for y in 0..size[1] {
            for x in 0..size[0] {
                let covered = (0..64).filter(|index| {
                    let [right, down] =
                        [index % 8, index / 8].map(|it| (f64::from(it) - 3.5) / 8.0);
                    let point = DVec2::new(x as f64 + right, y as f64 + down);
                    discs
                        .iter()
                        .any(|(center, radius)| point.distance(*center) < *radius)
                });
                let noise = (random.f64() + random.f64() + random.f64() - 1.5) * 0.06;
                let value = 0.1 + 0.8 * covered.count() as f64 / 64.0 + noise;
                values.push(value as f32);
            }
        }
        MarkImage::new(size[0], values).expect("whole rows")
    }

    #[test]
    fn centers_of_discs_with_noise_are_found_to_a_tenth_of_a_pixel() {
        let mut random = fastrand::Rng::with_seed(4);
        let (mut worst, mut squares, mut count) = ([0.0_f64; 3], 0.0, 0);
        for round in 0..150 {
            let [radius, index] = [[3.0, 0.0], [2.0, 1.0], [6.0, 2.0]][round % 3];
            let place = |generator: &mut fastrand::Rng, from: f64| from + 3.0 * generator.f64();
            let discs: Vec<(DVec2, f64)> = [10.0, 40.0, 70.0]
                .into_iter()
                .map(|x| {
                    (
                        DVec2::new(place(&mut random, x), place(&mut random, 15.0)),
                        radius,
                    )
                })
                .collect();
            let found = find_marks(&draw([90, 34], &discs, &mut random), &SETTINGS);
            assert_eq!(found.marks.len(), 3, "{found:?}");
            for (mark, (center, _)) in found.marks.iter().zip(&discs) {
                let error = mark.center.distance(*center);
                worst[index as usize] = worst[index as usize].max(error);
                if radius == 3.0 {
                    squares += error * error;
                    count += 1;
                }
            }
        }
        let rms = (squares / f64::from(count)).sqrt();
        println!(
            "largest error: {:.3} px at a radius of 3 px ({rms:.3} RMS), {:.3} at 2 px, {:.3} at 6 px",
            worst[0], worst[1], worst[2]
        );
        assert!(
            worst[0] <= 0.1 && worst[1] <= 0.15 && worst[2] <= 0.1,
            "{worst:?}"
        );
    }

    #[test]
    fn a_disc_at_the_edge_is_found_if_it_is_whole_and_counted_if_it_is_cut() {
        let mut random = fastrand::Rng::with_seed(5);
        let whole = DVec2::new(3.6, 44.3);
        let found = find_marks(&draw([40, 49], &[(whole, 3.0)], &mut random), &SETTINGS);
        assert!(found.marks[0].center.distance(whole) < 0.1, "{found:?}");
        for cut in [
            DVec2::new(1.5, 20.0),
            DVec2::new(20.0, 47.5),
            DVec2::new(39.0, 5.0),
        ] {
            let found_cut = find_marks(&draw([40, 49], &[(cut, 3.0)], &mut random), &SETTINGS);
            assert_eq!(
                (found_cut.marks.len(), found_cut.cut),
                (0, 1),
                "{found_cut:?}"
            );
        }
    }

    #[test]
    fn discs_that_touch_are_told_apart_by_their_middles_or_counted() {
        let mut random = fastrand::Rng::with_seed(6);
        let discs = |apart: f64| [DVec2::new(15.3, 20.1), DVec2::new(15.3 + apart, 20.4)];
        for apart in [2.5, 3.5, 5.0] {
            let both = discs(apart).map(|center| (center, 3.0));
            let found = find_marks(&draw([50, 40], &both, &mut random), &SETTINGS);
            assert_eq!(
                (found.marks.len(), found.long),
                (0, 1),
                "{apart}: {found:?}"
            );
        }
        // The pixel between them is darker.
        for (apart, error) in [(6.2, 0.3), (7.5, 0.15)] {
            let both = discs(apart).map(|center| (center, 3.0));
            let found = find_marks(&draw([50, 40], &both, &mut random), &SETTINGS);
            assert_eq!(found.marks.len(), 2, "{apart}: {found:?}");
            for (mark, (center, _)) in found.marks.iter().zip(both) {
                assert!(mark.center.distance(center) < error, "{apart}: {mark:?}");
            }
        }
        // Blurred marks whose edges run together have middles of their own.
        let centers = discs(7.0);
        let blurred = (0..50 * 40).map(|pixel| {
            let place = DVec2::new(f64::from(pixel % 50), f64::from(pixel / 50));
            let bright = centers
                .iter()
                .map(|it| (-place.distance_squared(*it) / 12.0).exp());
            bright.sum::<f64>().min(1.0) as f32
        });
        let found = find_marks(&MarkImage::new(50, blurred.collect()).unwrap(), &SETTINGS);
        assert_eq!(found.marks.len(), 2, "{found:?}");
        for (mark, center) in found.marks.iter().zip(centers) {
            assert!(mark.center.distance(center) < 0.3, "{mark:?}");
        }
    }

    #[test]
    fn an_image_of_noise_has_each_shape_once() {
        // Crosses of 5 pixels with darker arms, lines of 4 and single pixels, in a grid.
        let (width, cells) = (600, 60);
        let mut values = vec![0.0_f32; width * width];
        for cell in 0..cells * cells {
            let middle = (cell / cells * 10 + 5) * width + cell % cells * 10 + 5;
            match cell % 3 {
                0 => {
                    let arms = [middle - 1, middle + 1, middle - width, middle + width];
                    for pixel in arms {
                        values[pixel] = 0.8;
                    }
                    values[middle] = 1.0;
                }
                1 => values[middle - 2..middle + 2].fill(0.7),
                _ => values[middle] = 0.9,
            }
        }
        let found = find_marks(&MarkImage::new(width, values).unwrap(), &SETTINGS);
        assert_eq!(found.marks.len(), cells * cells / 3);
        assert_eq!(
            (found.long, found.other_size, found.cut),
            (cells * cells / 3, cells * cells / 3, 0)
        );
        let is_middle = |mark: &FoundMark| {
            let cells_of_marks = (mark.center.x - 5.0) / 30.0;
            (cells_of_marks - cells_of_marks.round()).abs() < 1e-6 && mark.pixels == 5
        };
        assert!(found.marks.iter().all(is_middle), "{:?}", found.marks[0]);
    }

    #[test]
    fn noise_lines_and_walls_are_no_marks() {
        let mut random = fastrand::Rng::with_seed(7);
        let found = find_marks(&draw([40, 40], &[], &mut random), &SETTINGS);
        assert!(found.marks.is_empty() && found.brightest < 0.3, "{found:?}");
        let mut values = vec![0.0; 400];
        values[105] = 1.0;
        values[203..215].fill(1.0);
        values[300] = f32::NAN;
        let found_long = find_marks(&MarkImage::new(20, values).unwrap(), &SETTINGS);
        assert_eq!(
            (
                found_long.marks.len(),
                found_long.other_size,
                found_long.long
            ),
            (0, 1, 1)
        );
        let settings = MarkSettings {
            max_px: 100,
            ..SETTINGS
        };
        let found_large = find_marks(&MarkImage::new(20, vec![0.9; 400]).unwrap(), &settings);
        assert_eq!(found_large.other_size, 1);
        assert!(MarkImage::new(0, vec![]).is_none() && MarkImage::new(3, vec![0.0; 4]).is_none());
    }
}
