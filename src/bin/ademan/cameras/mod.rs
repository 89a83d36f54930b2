//! `ademan cameras`: the calibration of cameras, marks in their pictures, and what they see as lines of markers.

mod colors;
mod frames;
mod labels;
mod markers;
mod picture;

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Path, PathBuf};

use ademan::cameras::{
    Calibration, Camera, CamerasFile, CamerasFileError, CamerasFormat, Frame, from_points,
    from_wand, refine,
};
use ademan::document::Document;
use ademan::files;
use ademan::message::{escape, escape_line, escape_path};
use glam::{DVec2, DVec3};
use serde::Deserialize;

use crate::arm::{OutputArgs, poses};
use crate::failure::Failure;
use crate::new_file;

/// Largest file of cameras or known points, in MiB.
const MAX_MIB: u64 = 1;

/// Pixels beyond the edge of an image that the noise of a mark explains.
const EDGE_PX: f64 = 2.0;

/// Most cameras.
const MAX_CAMERAS: usize = 16;

/// Calibrate cameras that see markers, find marks in their pictures, and print lines for `protocol=markers`
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan cameras calibrate wand.jsonl --wand 500 --size 1280x720 --output cameras.ron\n  ademan cameras markers left right --cameras cameras.ron | ademan run --source 'stdin:?protocol=markers'\n  ademan cameras lines markers.jsonl --cameras cameras.ron --output session.jsonl"
)]
pub enum Args {
    Calibrate(CalibrateArgs),
    Lines(LinesArgs),
    Markers(markers::Args),
}

/// Calibrate cameras with a wand, with points at known places, or with all that they see
///
/// A line is what each camera sees at one instant: `{"cameras":[{"name":"left","markers":[{"label":"a","image":[u,v]}]}]}`, in pixels
/// of the image as it is. A wand has the labels `a` and `b` at its ends; the world is then the frame of the first camera, with Y up.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan cameras calibrate wand.jsonl --wand 500 --size 1280x720 --output cameras.ron\n  ademan cameras calibrate frame.jsonl --points places.ron --size 1280x720 --output cameras.toml\n  ademan cameras calibrate walk.jsonl --refine --cameras Calib.toml --output better.toml"
)]
#[command(group = clap::ArgGroup::new("target").required(true).args(["wand", "points", "refine"]))]
pub struct CalibrateArgs {
    /// Files with one line per instant; `-` for standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Distance of the labels `a` and `b`, in millimetres
    #[arg(long, value_name = "MM", value_parser = length)]
    wand: Option<f64>,
    /// RON file of the places of labels in metres: `{"corner": (0.0, 0.0, 1.2), …}`
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
    /// Improve the cameras of `--cameras` by all labels that two of them see
    #[arg(long, requires = "cameras")]
    refine: bool,
    /// File with the initial lenses, `.ron` or `.toml`
    #[arg(long, value_name = "FILE")]
    cameras: Option<PathBuf>,
    /// Width and height of all images, without a file of cameras
    #[arg(long, value_name = "WIDTHxHEIGHT", conflicts_with = "cameras", value_parser = size)]
    size: Option<DVec2>,
    /// Keep focal lengths, centers and distortions
    #[arg(long, requires = "cameras")]
    keep_lenses: bool,
    /// File to create, `.ron` or `.toml` as Pose2Sim and Anipose read it; an existing file is not overwritten
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
}

/// Print what calibrated cameras see as lines for `protocol=markers`, without the distortion of the lenses
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan cameras lines markers.jsonl --cameras cameras.ron --output session.jsonl"
)]
pub struct LinesArgs {
    /// Files with one line per instant; `-` for standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// File of the cameras, `.ron` or `.toml`
    #[arg(long, value_name = "FILE")]
    cameras: PathBuf,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args {
        Args::Calibrate(args) => calibrate(&args),
        Args::Lines(args) => print_lines(&args),
        Args::Markers(args) => markers::run(&args),
    }
}

/// The view of all cameras at one instant.
#[derive(Deserialize)]
struct Line {
    /// The file with the number of the line.
    #[serde(skip)]
    place: String,
    time_us: Option<u64>,
    cameras: Vec<View>,
}

/// The view of one camera.
#[derive(Deserialize)]
struct View {
    name: String,
    markers: Vec<SeenMark>,
}

#[derive(Deserialize)]
struct SeenMark {
    label: Option<String>,
    image: [f64; 2],
}

fn calibrate(args: &CalibrateArgs) -> Result<(), Failure> {
    let format = format(&args.output)?;
    new_file::check(&args.output)?;
    let lines = read_lines(&args.files)?;
    let start = match (&args.cameras, args.size) {
        (Some(path), _) => read_cameras(path)?,
        (None, Some(size)) => named_cameras(&lines, size),
        (None, None) => {
            let message =
                "nothing is known about the images; add `--size 1280x720` or `--cameras FILE`";
            return Err(Failure::wrong_use(message));
        }
    };
    if start.len() > MAX_CAMERAS {
        let message = format!("{} cameras; {MAX_CAMERAS} can be calibrated", start.len());
        return Err(Failure::wrong_use(message));
    }
    for name in unknown_cameras(&start, &lines) {
        complain!(
            "no initial camera is called `{}`, so its marks are left out",
            escape(name)
        );
    }
    check_marks(&start, &lines)?;
    let frames: Vec<Frame> = lines.iter().map(|line| frame(&start, line)).collect();
    let calibration = match (args.wand, &args.points) {
        (Some(length), _) => from_wand(&start, &frames, length / 1000.0, args.keep_lenses),
        (None, Some(points)) => {
            from_points(&start, &frames, &read_points(points)?, args.keep_lenses)
        }
        (None, None) => refine(&start, &frames, args.keep_lenses),
    };
    let calibration = calibration.map_err(|error| {
        Failure::job(format!(
            "the cameras are not calibrated: {}",
            escape_line(&error.to_string())
        ))
    })?;
    let text = CamerasFile::new(&calibration.cameras).to_text(format);
    files::write_new(&args.output, text.as_bytes())
        .map_err(|error| Failure::cannot_create(&args.output, error))?;
    say!("wrote {}", escape_path(&args.output));
    report(&calibration);
    Ok(())
}

fn report(calibration: &Calibration) {
    for (camera, error) in calibration.cameras.iter().zip(&calibration.errors) {
        say!(
            "{}: {} marks, median error {:.2} px, root mean square {:.2} px",
            escape(&camera.name),
            error.marks,
            error.median_px,
            error.rms_px
        );
    }
}

fn print_lines(args: &LinesArgs) -> Result<(), Failure> {
    let cameras = read_cameras(&args.cameras)?;
    let lines = read_lines(&args.files)?;
    args.output
        .write(|out| write_lines(args, &cameras, &lines, out))
}

fn write_lines(
    args: &LinesArgs,
    cameras: &[Camera],
    lines: &[Line],
    out: &mut dyn Write,
) -> Result<(), Failure> {
    for line in lines {
        let mut views = Vec::new();
        for view in &line.cameras {
            let camera = cameras.iter().find(|camera| camera.name == view.name);
            let camera = camera.ok_or_else(|| no_camera(&args.cameras, &view.name))?;
            let marks = view.markers.iter();
            let marks = marks.map(|mark| (mark.label.as_deref(), DVec2::from(mark.image)));
            views.push(view_json(camera, marks));
        }
        let line = match line.time_us {
            Some(time_us) => serde_json::json!({"time_us": time_us, "cameras": views}),
            None => serde_json::json!({"cameras": views}),
        };
        writeln!(out, "{line}")?;
    }
    Ok(())
}

/// Returns what a calibrated camera sees for `protocol=markers`, without the distortion of its lens.
fn view_json<'a>(
    camera: &Camera,
    marks: impl Iterator<Item = (Option<&'a str>, DVec2)>,
) -> serde_json::Value {
    let marks = marks.map(|(label, image)| {
        let image = camera.focal * camera.ideal(image) + camera.center;
        mark_json(label, image)
    });
    serde_json::json!({
        "position": camera.position().to_array(),
        "orientation": camera.rotation.inverse().to_array(),
        "focal_px": camera.focal.to_array(),
        "center_px": camera.center.to_array(),
        "markers": marks.collect::<Vec<_>>(),
    })
}

fn mark_json(label: Option<&str>, image: DVec2) -> serde_json::Value {
    match label {
        Some(label) => serde_json::json!({"label": label, "image": image.to_array()}),
        None => serde_json::json!({"image": image.to_array()}),
    }
}

fn no_camera(file: &Path, name: &str) -> Failure {
    let (file, name) = (escape_path(file), escape(name));
    Failure::wrong_use(format!("{file} has no camera `{name}`"))
}

fn read_lines(paths: &[PathBuf]) -> Result<Vec<Line>, Failure> {
    let mut lines = Vec::new();
    for path in paths {
        for (number, text) in poses::lines(path)? {
            let place = format!("{}:{number}", escape_path(path));
            let refused =
                |reason: &str| Failure::wrong_use(format!("{place}: {}", escape_line(reason)));
            let mut line: Line = serde_json::from_str(&text)
                .map_err(|error| refused(&poses::json_reason(&error)))?;
            let mut marks = line.cameras.iter().flat_map(|view| &view.markers);
            if marks.any(|mark| mark.image.iter().any(|pixel| pixel.abs() > 1e6)) {
                return Err(refused("a pixel beyond a million"));
            }
            line.place = place;
            lines.push(line);
        }
    }
    if lines.is_empty() {
        Err(Failure::wrong_use(
            "the files are empty; write one line per instant",
        ))
    } else {
        Ok(lines)
    }
}

/// Refuses marks outside the images of the cameras.
fn check_marks(cameras: &[Camera], lines: &[Line]) -> Result<(), Failure> {
    for line in lines {
        for view in &line.cameras {
            let Some(camera) = cameras.iter().find(|camera| camera.name == view.name) else {
                continue;
            };
            let is_outside = |mark: &&SeenMark| {
                let (image, edge) = (DVec2::from(mark.image), DVec2::splat(EDGE_PX));
                image.cmplt(-edge).any() || image.cmpgt(camera.size + edge).any()
            };
            if let Some(mark) = view.markers.iter().find(is_outside) {
                let ([u, v], name, size) = (mark.image, escape(&view.name), camera.size);
                return Err(Failure::wrong_use(format!(
                    "{}: camera `{name}` has a mark at {u}, {v}, outside its image of {} × {} pixels; state the size of the images in which the \
                     marks were found, with `--size` or in the file of the cameras",
                    line.place, size.x, size.y
                )));
            }
        }
    }
    Ok(())
}

/// Returns the names in the lines that no camera has, each once.
fn unknown_cameras<'a>(cameras: &[Camera], lines: &'a [Line]) -> BTreeSet<&'a str> {
    let views = lines.iter().flat_map(|line| &line.cameras);
    let names = views.map(|view| view.name.as_str());
    names
        .filter(|name| cameras.iter().all(|camera| camera.name != *name))
        .collect()
}

/// Returns a camera for each name of the lines.
fn named_cameras(lines: &[Line], size: DVec2) -> Vec<Camera> {
    let names: BTreeSet<&String> = lines
        .iter()
        .flat_map(|line| &line.cameras)
        .map(|view| &view.name)
        .collect();
    names
        .into_iter()
        .map(|name| Camera::new(name.clone(), size))
        .collect()
}

/// Returns the labelled marks of a line by camera. Of a label that is twice in an image, none counts.
fn frame(cameras: &[Camera], line: &Line) -> Frame {
    let seen = |camera: &Camera| {
        let mut marks: BTreeMap<String, DVec2> = BTreeMap::new();
        let mut twice = Vec::new();
        let views = line.cameras.iter().filter(|view| view.name == camera.name);
        for mark in views.flat_map(|view| &view.markers) {
            if let Some(label) = &mark.label
                && marks
                    .insert(label.clone(), DVec2::from(mark.image))
                    .is_some()
            {
                twice.push(label);
            }
        }
        marks.retain(|label, _| !twice.contains(&label));
        marks
    };
    cameras.iter().map(seen).collect()
}

fn read_cameras(path: &Path) -> Result<Vec<Camera>, Failure> {
    let document = read_document(path)?;
    let file = CamerasFile::parse(&document, format(path)?);
    let file = file.map_err(|error| match error {
        CamerasFileError::Text(at_line) => Failure::from(at_line),
        CamerasFileError::Camera { .. } => Failure::wrong_use(format!(
            "{}: {}",
            escape_path(path),
            escape_line(&error.to_string())
        )),
    })?;
    Ok(file.cameras())
}

fn read_points(path: &Path) -> Result<BTreeMap<String, DVec3>, Failure> {
    let document = read_document(path)?;
    let points: BTreeMap<String, (f64, f64, f64)> = document.parse()?;
    let places: BTreeMap<_, _> = points
        .into_iter()
        .map(|(label, place)| (label, DVec3::from(place)))
        .collect();
    match places.iter().find(|(_, place)| !place.is_finite()) {
        Some((label, _)) => Err(Failure::wrong_use(format!(
            "{}: the place of `{}` is not three numbers; state its distances from the origin in metres",
            escape_path(path),
            escape(label)
        ))),
        None => Ok(places),
    }
}

fn read_document(path: &Path) -> Result<Document, Failure> {
    let text = files::read_regular_text(path, MAX_MIB);
    let text = text.map_err(|error| Failure::cannot_read(path, error))?;
    Ok(Document::new(path.to_string_lossy(), text))
}

/// Returns the form of a file by its name.
fn format(path: &Path) -> Result<CamerasFormat, Failure> {
    match path.extension().and_then(|end| end.to_str()) {
        Some("ron") => Ok(CamerasFormat::Ron),
        Some("toml") => Ok(CamerasFormat::Toml),
        _ => Err(Failure::wrong_use(format!(
            "{} ends neither in `.ron` nor in `.toml`, the formats of camera files",
            escape_path(path)
        ))),
    }
}

fn length(text: &str) -> Result<f64, String> {
    crate::setup_args::number_in(text, 10.0, 5000.0, "millimetres")
}

fn size(text: &str) -> Result<DVec2, String> {
    let size = poses::image_size(text)?;
    Ok(DVec2::new(size.width, size.height))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_whose_place_is_not_a_number_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.ron");
        for number in ["NaN", "inf", "-inf"] {
            let text = format!("{{\"a\": (0.0, 1.0, 2.0), \"b\": (0.0, {number}, 2.0)}}");
            std::fs::write(&path, text).unwrap();
            let error = read_points(&path).unwrap_err().to_string();
            assert!(
                error.contains("points.ron: the place of `b` is not three numbers"),
                "{error}"
            );
        }
    }
}
