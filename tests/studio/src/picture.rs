//! Pictures of windows: written, checked not to be blank, and compared with reviewed ones.

use std::collections::HashSet;
use std::env;
use std::fs::{self, File};
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use egui_kittest::wgpu::{create_render_state, default_wgpu_setup};
use egui_kittest::{SnapshotOptions, try_image_snapshot_options};
use image::RgbaImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};

use crate::window::StudioWindow;

/// The folder of reviewed pictures, which the documentation shows.
const PICTURES: &str = "../../docs/pictures";

/// The fewest colors of a picture that shows something.
const MIN_COLORS: usize = 40;

/// The largest difference of a pixel that is not seen, as a squared distance of colors.
const THRESHOLD: f32 = 1.0;

/// The number of pixels that another version of the driver may draw in another way.
const MAX_FAILED_PIXELS: usize = 200;

/// Draws the window, writes the picture to `target/studio/NAME.png`, and checks that it is not blank.
///
/// Returns `None`, and says that the test is skipped, without a Vulkan driver.
pub fn draw(window: &mut StudioWindow, name: &str) -> Option<RgbaImage> {
    if !has_driver() {
        println!("SKIPPED: there is no Vulkan driver; Debian's mesa-vulkan-drivers is one");
        return None;
    }
    let picture = window.harness.render().expect("the driver draws");
    save(
        &picture,
        &folder("../../target/studio")
            .join(name)
            .with_extension("png"),
    );
    let mut colors = HashSet::new();
    let has_content = picture.pixels().any(|pixel| {
        colors.insert(pixel.0);
        colors.len() > MIN_COLORS
    });
    assert!(has_content, "{name} is blank: {} colors", colors.len());
    Some(picture)
}

/// Draws the window and compares a panel with the reviewed picture `docs/pictures/NAME.png`, or replaces that if
/// `UPDATE_SNAPSHOTS` is set. The area of the panel is in points.
pub fn compare(window: &mut StudioWindow, name: &str, panel: egui::Rect) {
    compare_except(window, name, panel, &[]);
}

/// Does what [`compare`] does, but accepts any content of some areas, such as a measured time.
pub fn compare_except(
    window: &mut StudioWindow,
    name: &str,
    panel: egui::Rect,
    excepted: &[egui::Rect],
) {
    let Some(picture) = draw(window, name) else {
        return;
    };
    let mut picture = fewer_colors(&crop(&picture, panel));
    let path = folder(PICTURES).join(name).with_extension("png");
    if is_update() {
        save_small(&picture, &path);
        return;
    }
    for area in excepted {
        let area = area.translate(-panel.min.to_vec2());
        copy_area(&path, area, &mut picture);
    }
    let options = SnapshotOptions::new()
        .threshold(THRESHOLD)
        .max_failed_pixels(MAX_FAILED_PIXELS)
        .output_path(folder(PICTURES));
    if let Err(error) = try_image_snapshot_options(&picture, name, &options) {
        panic!("{error}");
    }
}

/// Returns an area of a picture of a window. A point is a pixel.
pub fn crop(picture: &RgbaImage, area: egui::Rect) -> RgbaImage {
    let (min, size) = (area.min.max(egui::Pos2::ZERO), area.size());
    let part = image::imageops::crop_imm(
        picture,
        min.x as u32,
        min.y as u32,
        size.x as u32,
        size.y as u32,
    );
    part.to_image()
}

/// Copies an area of a picture in a file to the same place of another one of the same size.
fn copy_area(path: &Path, area: egui::Rect, picture: &mut RgbaImage) {
    let reviewed = image::open(path).map(image::DynamicImage::into_rgba8);
    if let Ok(reviewed) = reviewed
        && reviewed.dimensions() == picture.dimensions()
    {
        let (x, y) = (area.min.x.max(0.0) as i64, area.min.y.max(0.0) as i64);
        image::imageops::replace(picture, &crop(&reviewed, area), x, y);
    }
}

/// Draws the window, and writes it to `docs/pictures/NAME.png` if `UPDATE_SNAPSHOTS` is set: a picture for the documentation, with
/// panels that have tests of their own.
pub fn document(window: &mut StudioWindow, name: &str) {
    if let Some(picture) = draw(window, name)
        && is_update()
    {
        let path = folder(PICTURES).join(name).with_extension("png");
        save_small(&fewer_colors(&picture), &path);
    }
}

/// Writes a picture as [`document`] does.
pub fn document_drawn(picture: &RgbaImage, name: &str) {
    if is_update() {
        let path = folder(PICTURES).join(name).with_extension("png");
        save_small(&fewer_colors(picture), &path);
    }
}

fn is_update() -> bool {
    env::var_os("UPDATE_SNAPSHOTS").is_some()
}

/// Returns the picture with 64 steps per color, which looks the same and makes a smaller file.
fn fewer_colors(picture: &RgbaImage) -> RgbaImage {
    let mut picture = picture.clone();
    for pixel in picture.pixels_mut() {
        pixel.0 = pixel.0.map(|value| (value & 0xfc) | (value >> 6));
    }
    picture
}

/// Writes a picture into a file to look at, which takes less time than a small file.
pub fn save(picture: &RgbaImage, path: &Path) {
    write(picture, path, CompressionType::Fast, FilterType::NoFilter);
}

/// Writes a picture of the documentation into a small file.
fn save_small(picture: &RgbaImage, path: &Path) {
    write(picture, path, CompressionType::Best, FilterType::Adaptive);
}

fn write(picture: &RgbaImage, path: &Path, compression: CompressionType, filter: FilterType) {
    let folder = path.parent().expect("a picture is in a folder");
    fs::create_dir_all(folder).expect("the folder can be created");
    let file = File::create(path).expect("the picture can be written");
    let encoder = PngEncoder::new_with_quality(file, compression, filter);
    let opaque = image::DynamicImage::ImageRgba8(picture.clone()).into_rgb8();
    opaque
        .write_with_encoder(encoder)
        .expect("the picture can be written");
}

/// Returns a folder relative to the folder of this package.
pub fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Returns `true` if pictures can be drawn.
pub fn has_driver() -> bool {
    static HAS_DRIVER: OnceLock<bool> = OnceLock::new();
    *HAS_DRIVER.get_or_init(|| {
        catch_unwind(|| create_render_state(default_wgpu_setup(), Default::default())).is_ok()
    })
}
