//! `ademan cameras markers`: marks in pictures and films of cameras, as lines of markers.

use std::io::Write;
use std::path::{Path, PathBuf};

use ademan::cameras::{Camera, FoundMarks, MarkImage, MarkSettings, find_marks};
use ademan::message::{escape, escape_line, escape_path};
use glam::DVec2;
use serde_json::{Value, json};

use super::colors::Color;
use super::frames::{Frame, Frames, film_rate};
use super::labels::LabelTracker;
use super::{MAX_CAMERAS, read_cameras, view_json};
use crate::arm::OutputArgs;
use crate::failure::Failure;
use crate::setup_args::number_in;

/// Most marks of a picture: lines for `protocol=markers` have no more.
const MAX_MARKS: usize = 64;

/// Pictures per second of folders without `--rate-hz`.
const RATE_HZ: f64 = 100.0;

/// Largest relative difference of equal rates: less than one picture in a day.
const SAME_RATE: f64 = 1e-7;

/// Find bright or colored marks in pictures or films, and print them as lines of markers
///
/// Each folder of PNG or JPEG pictures, in the order of their names, or film is one camera, with the name of the folder or film.
/// The cameras took their first pictures at the same time. With `--cameras`, the lines are those that `protocol=markers` reads;
/// without it, those that `cameras calibrate` and `cameras lines` read.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan cameras markers left right --label a,b --output wand.jsonl\n  ademan cameras markers left right --cameras cameras.ron | ademan run --source 'stdin:?protocol=markers'\n  ademan cameras markers left.mp4 right.mp4 --color red,green,blue --label RightArm,RightForeArm,RightHand --cameras cameras.ron"
)]
pub struct Args {
    /// Folders of pictures, or films, which ffmpeg decodes; one for each camera
    #[arg(required = true, value_name = "FOLDER|FILM", id = "pictures")]
    cameras: Vec<PathBuf>,
    /// Colors of the marks; `white` is anything bright
    #[arg(
        long,
        value_name = "COLORS",
        value_enum,
        value_delimiter = ',',
        default_value = "white"
    )]
    color: Vec<Color>,
    /// Labels of the marks: one for each color, or, with one color, from the left to the right in the first picture with as many marks
    #[arg(long, value_name = "LABELS", value_delimiter = ',')]
    label: Vec<String>,
    /// Smallest brightness or share of the color of a mark, 0.01 to 0.99. The default is 0.5, and 0.3 for colors
    #[arg(long, value_name = "FRACTION", value_parser = fraction)]
    threshold: Option<f32>,
    /// Fewest pixels of a mark
    #[arg(long, value_name = "PIXELS", default_value_t = 4)]
    min_px: usize,
    /// Most pixels of a mark
    #[arg(long, value_name = "PIXELS", default_value_t = 10_000)]
    max_px: usize,
    /// Largest length of a mark as a multiple of its width; longer shapes are marks that touch each other, or reflections
    #[arg(long, value_name = "RATIO", default_value = "1.3", value_parser = elongation)]
    max_elongation: f64,
    /// Largest distance of a mark from where it is expected, for its label, in pixels
    #[arg(long, value_name = "PIXELS", default_value = "30", value_parser = pixels)]
    max_jump_px: f64,
    /// File of the cameras, `.ron` or `.toml`, with the names of the folders or films
    #[arg(long = "cameras", value_name = "FILE")]
    calibrated: Option<PathBuf>,
    /// Pictures per second. The default is the rate of a film, and 100 for folders
    #[arg(long, value_name = "RATE", value_parser = rate)]
    rate_hz: Option<f64>,
    #[command(flatten)]
    output: OutputArgs,
}

/// A camera whose pictures are read.
struct Reader {
    name: String,
    frames: Frames,
    calibrated: Option<Camera>,
    /// Width and height of the first picture.
    size: Option<[usize; 2]>,
    labels: Option<LabelTracker>,
    report: Report,
}

/// The marks in the pictures of a camera.
#[derive(Default)]
struct Report {
    pictures: usize,
    marks: usize,
    without_marks: usize,
    cut: usize,
    long: usize,
    other_size: usize,
    doubtful: usize,
    too_many: usize,
    brightest: f32,
    damaged: Vec<String>,
    lost: Vec<String>,
}

/// A mark with its label.
struct LabelledMark {
    label: Option<String>,
    at: DVec2,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    check(args)?;
    let mut readers = open(args)?;
    let rate_hz = match args.rate_hz {
        Some(rate_hz) => rate_hz,
        None => common_rate(args)?,
    };
    args.output.write(|out| {
        write_lines(args, &mut readers, rate_hz, out)?;
        for reader in &mut readers {
            reader.finish();
            reader.report.say(&reader.name);
        }
        if readers.iter().all(|reader| reader.report.marks == 0) {
            Err(nothing_found(args, &readers))
        } else {
            Ok(())
        }
    })
}

/// Writes a line for each instant that all cameras have taken.
fn write_lines(
    args: &Args,
    readers: &mut [Reader],
    rate_hz: f64,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    for index in 0_u64.. {
        let mut frames = Vec::new();
        for reader in readers.iter_mut() {
            frames.push(reader.frames.next_frame()?);
        }
        let ended = frames.iter().filter(|frame| frame.is_none()).count();
        if ended > 0 {
            if ended < frames.len() {
                say_shorter(readers, &frames);
            }
            break;
        }
        let mut views = Vec::new();
        for (reader, frame) in readers.iter_mut().zip(frames.into_iter().flatten()) {
            views.push(reader.view(frame, args)?);
        }
        let time_us = (index as f64 * 1e6 / rate_hz).round() as u64;
        writeln!(out, "{}", json!({"time_us": time_us, "cameras": views}))?;
    }
    Ok(())
}

fn check(args: &Args) -> Result<(), Failure> {
    let refused = |message: String| Err(Failure::wrong_use(message));
    let (colors, labels) = (args.color.len(), args.label.len());
    if colors > 1 && labels > 0 && labels != colors {
        return refused(format!(
            "{labels} labels for {colors} colors; `--label` has one for each color"
        ));
    }
    if labels > MAX_MARKS {
        return refused(format!(
            "{labels} labels; a picture has at most {MAX_MARKS} marks"
        ));
    }
    let twice = |index: usize| args.label[..index].contains(&args.label[index]);
    if let Some(index) = (0..labels).find(|&index| twice(index)) {
        return refused(format!(
            "label `{}` is given twice",
            escape(&args.label[index])
        ));
    }
    if args.min_px == 0 || args.min_px > args.max_px {
        return refused("`--min-px` is from 1 to `--max-px`".to_owned());
    }
    if args.cameras.len() <= MAX_CAMERAS {
        Ok(())
    } else {
        refused(format!(
            "{} cameras; {MAX_CAMERAS} can be read",
            args.cameras.len()
        ))
    }
}

/// Returns the pictures per second of all films, and of the folders beside them.
fn common_rate(args: &Args) -> Result<f64, Failure> {
    let mut first: Option<(String, f64)> = None;
    for film in args.cameras.iter().filter(|path| !path.is_dir()) {
        let (name, rate) = (camera_name(film), film_rate(film)?);
        match &first {
            None => first = Some((name, rate)),
            Some((first_name, first_rate)) if (rate / first_rate - 1.0).abs() > SAME_RATE => {
                return Err(Failure::wrong_use(format!(
                    "`{}` has {} pictures per second, and `{}` {}, so that their pictures are not taken at the same times; resample the films with \
                     `--rate-hz {}`",
                    escape(first_name),
                    rounded(*first_rate),
                    escape(&name),
                    rounded(rate),
                    rounded(first_rate.min(rate))
                )));
            }
            Some(_) => {}
        }
    }
    Ok(first.map_or(RATE_HZ, |(_, rate)| rate))
}

/// Returns a rate with six decimals, which differ for films that are not in step.
fn rounded(rate: f64) -> f64 {
    (rate * 1e6).round() / 1e6
}

fn open(args: &Args) -> Result<Vec<Reader>, Failure> {
    let calibrated = args.calibrated.as_deref().map(read_cameras).transpose()?;
    let mut readers: Vec<Reader> = Vec::new();
    for path in &args.cameras {
        let name = camera_name(path);
        if readers.iter().any(|reader| reader.name == name) {
            let message = format!(
                "two cameras have the name `{}`; rename a folder or film",
                escape(&name)
            );
            return Err(Failure::wrong_use(message));
        }
        let camera = match (&calibrated, &args.calibrated) {
            (Some(cameras), Some(file)) => {
                let camera = cameras.iter().find(|camera| camera.name == name);
                Some(
                    camera
                        .cloned()
                        .ok_or_else(|| super::no_camera(file, &name))?,
                )
            }
            _ => None,
        };
        // With several colors, each has its label.
        let labels = (args.color.len() == 1 && !args.label.is_empty())
            .then(|| LabelTracker::new(&args.label, args.max_jump_px));
        readers.push(Reader {
            name,
            frames: Frames::open(path, args.rate_hz)?,
            calibrated: camera,
            size: None,
            labels,
            report: Report::default(),
        });
    }
    Ok(readers)
}

/// Returns the name of a folder, or of a film without the end of its name.
fn camera_name(path: &Path) -> String {
    // A folder may be named as `.` or `../left/`.
    let full = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let name = if full.is_dir() {
        full.file_name()
    } else {
        full.file_stem()
    };
    name.unwrap_or_default().to_string_lossy().into_owned()
}

impl Reader {
    /// Returns what the camera sees in a picture. A damaged picture shows nothing, and is reported at the end.
    fn view(&mut self, frame: Frame, args: &Args) -> Result<Value, Failure> {
        self.report.pictures += 1;
        let picture = match frame.picture {
            Ok(picture) => picture,
            Err(reason) => {
                self.report
                    .damaged
                    .push(format!("{}: {}", frame.name, escape_line(&reason)));
                return Ok(self.view_of(&[]));
            }
        };
        let size = [picture.width, picture.height];
        self.check_size(size, &frame.name, args)?;
        let mut found = Vec::new();
        for &color in &args.color {
            let image = picture.of_color(color);
            let image =
                image.ok_or_else(|| Failure::wrong_use(format!("{} has no pixels", frame.name)))?;
            found.push((color, self.find(&image, color, args)));
        }
        let mut marks = self.label(&found, args);
        if marks.len() > MAX_MARKS {
            self.report.too_many += 1;
            marks.truncate(MAX_MARKS);
        }
        self.report.marks += marks.len();
        self.report.without_marks += usize::from(marks.is_empty());
        Ok(self.view_of(&marks))
    }

    fn check_size(&mut self, size: [usize; 2], name: &str, args: &Args) -> Result<(), Failure> {
        let [width, height] = size;
        let [first_width, first_height] = *self.size.get_or_insert(size);
        if size != [first_width, first_height] {
            return Err(Failure::wrong_use(format!(
                "{name} has {width} × {height} pixels, and the first picture of `{}` {first_width} × {first_height}; the pictures of a camera \
                 have one size",
                escape(&self.name)
            )));
        }
        if let (Some(camera), Some(file)) = (&self.calibrated, &args.calibrated)
            && camera.size != DVec2::new(width as f64, height as f64)
        {
            return Err(Failure::wrong_use(format!(
                "{name} has {width} × {height} pixels, and camera `{}` of {} {} × {}; calibrate the camera with pictures of this size",
                escape(&self.name),
                escape_path(file),
                camera.size.x,
                camera.size.y
            )));
        }
        Ok(())
    }

    fn find(&mut self, image: &MarkImage, color: Color, args: &Args) -> FoundMarks {
        let settings = MarkSettings {
            threshold: args.threshold.unwrap_or_else(|| color.threshold()),
            min_px: args.min_px,
            max_px: args.max_px,
            max_elongation: args.max_elongation,
        };
        let found = find_marks(image, &settings);
        self.report.cut += found.cut;
        self.report.long += found.long;
        self.report.other_size += found.other_size;
        self.report.brightest = self.report.brightest.max(found.brightest);
        found
    }

    /// Returns the marks of all colors with their labels.
    fn label(&mut self, found: &[(Color, FoundMarks)], args: &Args) -> Vec<LabelledMark> {
        let mut labelled = Vec::new();
        for (index, (color, of_color)) in found.iter().enumerate() {
            let centers: Vec<DVec2> = of_color.marks.iter().map(|mark| mark.center).collect();
            let labels = match &mut self.labels {
                Some(tracker) => tracker.update(&centers),
                None if args.color.len() == 1 => vec![None; centers.len()],
                None => {
                    let label = args
                        .label
                        .get(index)
                        .cloned()
                        .unwrap_or_else(|| color.name());
                    // Which of several marks has the label is not known.
                    let is_doubtful = centers.len() > 1;
                    self.report.doubtful += usize::from(is_doubtful);
                    vec![(!is_doubtful).then_some(label); centers.len()]
                }
            };
            let marks = labels.into_iter().zip(centers);
            labelled.extend(marks.map(|(label, at)| LabelledMark { label, at }));
        }
        labelled
    }

    fn view_of(&self, marks: &[LabelledMark]) -> Value {
        let marks = marks.iter().map(|mark| (mark.label.as_deref(), mark.at));
        match &self.calibrated {
            Some(camera) => view_json(camera, marks),
            None => {
                let marks = marks.map(|(label, at)| super::mark_json(label, at));
                json!({"name": self.name, "markers": marks.collect::<Vec<_>>()})
            }
        }
    }

    fn finish(&mut self) {
        let lost = self.labels.iter().flat_map(LabelTracker::lost);
        self.report.lost = lost.map(str::to_owned).collect();
    }
}

impl Report {
    fn say(&self, name: &str) {
        let name = escape(name);
        let (marks, pictures) = (self.marks, self.pictures);
        say!("{name}: {marks} marks in {pictures} pictures");
        let left_out = [
            (self.without_marks, "pictures without a mark"),
            (self.cut, "shapes at the edge of a picture are left out"),
            (
                self.long,
                "shapes are left out because they are too long for a mark: marks that touch each other, or reflections",
            ),
            (
                self.other_size,
                "shapes are left out because of their size (`--min-px`, `--max-px`)",
            ),
            (
                self.doubtful,
                "times a color with one label has several marks, which are then without it",
            ),
            (
                self.too_many,
                "pictures have more than 64 marks, of which the first ones are kept: raise `--threshold` or `--min-px`",
            ),
        ];
        for (count, what) in left_out {
            if count > 0 {
                say!("{name}: {count} {what}");
            }
        }
        for damaged in self.damaged.iter().take(5) {
            say!("{name}: a damaged or missing picture shows nothing: {damaged}");
        }
        if self.damaged.len() > 5 {
            say!(
                "{name}: {} more damaged or missing pictures",
                self.damaged.len() - 5
            );
        }
        for label in &self.lost {
            let label = escape(label);
            say!(
                "{name}: label `{label}` was not given, or is lost; `--max-jump-px` limits how far a mark moves between two pictures"
            );
        }
    }
}

fn say_shorter(readers: &[Reader], frames: &[Option<Frame>]) {
    let ended = readers
        .iter()
        .zip(frames)
        .find(|(_, frame)| frame.is_none());
    if let Some((reader, _)) = ended {
        let (name, pictures) = (escape(&reader.name), reader.report.pictures);
        say!(
            "{name} has only {pictures} pictures; the other cameras have more, which are not read"
        );
    }
}

fn nothing_found(args: &Args, readers: &[Reader]) -> Failure {
    if readers
        .iter()
        .all(|reader| reader.report.damaged.len() == reader.report.pictures)
    {
        return Failure::wrong_use("no picture can be read; the reasons are above");
    }
    let reports = readers.iter().map(|reader| &reader.report);
    let brightest = reports.map(|it| it.brightest).fold(0.0, f32::max);
    let threshold = args.threshold.unwrap_or_else(|| args.color[0].threshold());
    Failure::job(if brightest < threshold {
        format!(
            "no mark was found: the largest value of a pixel is {brightest:.2}, below the threshold of {threshold:.2}; lower it with `--threshold`, or \
         name the `--color` of the marks"
        )
    } else {
        "no mark was found: every shape above the threshold is left out, for the reasons above; change `--threshold`, `--min-px`, \
     `--max-px` or `--max-elongation`"
    .to_owned()
    })
}

fn fraction(text: &str) -> Result<f32, String> {
    Ok(number_in(text, 0.01, 0.99, "of the brightness")? as f32)
}

fn elongation(text: &str) -> Result<f64, String> {
    number_in(text, 1.05, 10.0, "times the width")
}

fn pixels(text: &str) -> Result<f64, String> {
    number_in(text, 0.1, 10_000.0, "pixels")
}

fn rate(text: &str) -> Result<f64, String> {
    number_in(text, 0.1, 10_000.0, "pictures per second")
}
