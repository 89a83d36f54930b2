//! The pictures of a camera, one after the other: the files of a folder, or the frames of a film.

use std::cmp::Ordering;
use std::fs;
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

use ademan::files;
use ademan::message::{escape_line, escape_path};

use super::picture::Picture;
use crate::failure::Failure;

/// Largest file of a picture, in MiB.
const MAX_MIB: u64 = 256;

/// The formats of films that `ffmpeg` may find in a file, whatever its name. Playlists are none: they name other files, on other machines
/// too, and may never end.
const FILM_FORMATS: &str = "mov,mp4,matroska,webm,avi,mpegts,mpeg,mpegvideo,m4v,h264,hevc,av1,obu,ivf,ogg,flv,asf,dv,mxf,gif,apng,mjpeg,\
    mpjpeg,image2,png_pipe,jpeg_pipe,yuv4mpegpipe,nut,wtv,rm";

/// Ends of the names of pictures.
const PICTURES: [&str; 3] = ["png", "jpg", "jpeg"];

/// The pictures of a camera.
pub enum Frames {
    /// Files of a folder, in the order of their names. Where a picture is missing, the name leads to no file.
    Folder(std::vec::IntoIter<PathBuf>),
    /// Frames of a film, from `ffmpeg`.
    Film(Box<Film>),
}

/// A film that is decoded.
pub struct Film {
    path: PathBuf,
    child: Child,
    frames: BufReader<ChildStdout>,
    count: usize,
}

/// A picture with its name, or the reason why it cannot be read.
pub struct Frame {
    pub name: String,
    pub picture: Result<Picture, String>,
}

impl Frames {
    /// Opens a folder, or a film at `rate_hz` frames per second, or at its own rate.
    pub fn open(path: &Path, rate_hz: Option<f64>) -> Result<Self, Failure> {
        if !path.is_dir() {
            return Film::open(path, rate_hz).map(|film| Self::Film(Box::new(film)));
        }
        let cannot_read = |error: std::io::Error| Failure::cannot_read(path, error);
        let mut pictures = Vec::new();
        for entry in fs::read_dir(path).map_err(cannot_read)? {
            let picture = entry.map_err(cannot_read)?.path();
            let end = picture.extension().and_then(|end| end.to_str());
            if end.is_some_and(|end| PICTURES.iter().any(|it| it.eq_ignore_ascii_case(end))) {
                pictures.push(picture);
            }
        }
        if pictures.is_empty() {
            return Err(Failure::wrong_use(format!(
                "there is no PNG or JPEG in {}; name a folder of pictures, or a film",
                escape_path(path)
            )));
        }
        pictures.sort_by(|one, other| by_number(&name(one), &name(other)));
        Ok(Self::Folder(with_missing(pictures).into_iter()))
    }

    /// Returns the next picture; `None` at the end.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, Failure> {
        match self {
            Self::Folder(paths) => Ok(paths.next().map(|path| Frame {
                name: escape_path(&path).to_string(),
                picture: files::read_regular(&path, MAX_MIB)
                    .map_err(|error| error.to_string())
                    .and_then(|bytes| Picture::decode(&bytes)),
            })),
            Self::Film(film) => film.next_frame(),
        }
    }
}

impl Film {
    fn open(path: &Path, rate_hz: Option<f64>) -> Result<Self, Failure> {
        // Also refuses devices and pipes.
        files::open_regular(path).map_err(|error| Failure::cannot_read(path, error))?;
        let mut command = Command::new("ffmpeg");
        command
            .args(["-nostdin", "-v", "error"])
            .args(["-format_whitelist", FILM_FORMATS, "-i"])
            .arg(input(path));
        if let Some(rate_hz) = rate_hz {
            command.args(["-vf", &format!("fps={rate_hz}")]);
        }
        // Otherwise a film with more than eight bits for each color, such as films of telephones, gives such pictures.
        command.args(["-f", "image2pipe", "-c:v", "ppm", "-pix_fmt", "rgb24", "-"]);
        let command = command.stdin(Stdio::null()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(|error| no_ffmpeg(path, &error))?;
        let stdout = child
            .stdout
            .take()
            .ok_or_else(|| Failure::job("ffmpeg has no output"))?;
        Ok(Self {
            path: path.to_owned(),
            child,
            frames: BufReader::with_capacity(1 << 16, stdout),
            count: 0,
        })
    }

    fn next_frame(&mut self) -> Result<Option<Frame>, Failure> {
        let failed = |reason: &str| {
            let (path, reason) = (escape_path(&self.path), escape_line(reason));
            Failure::wrong_use(format!("cannot read the film {path}: {reason}"))
        };
        let picture = Picture::read_ppm(&mut self.frames).map_err(|reason| failed(&reason))?;
        let Some(picture) = picture else {
            let status = self.child.wait()?;
            return if status.success() {
                Ok(None)
            } else {
                Err(failed("ffmpeg has failed; its message is above"))
            };
        };
        self.count += 1;
        Ok(Some(Frame {
            name: format!("frame {} of {}", self.count, escape_path(&self.path)),
            picture: Ok(picture),
        }))
    }
}

impl Drop for Film {
    fn drop(&mut self) {
        // It has ended, or the rest is not needed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns the frames per second of a film as `ffprobe` reports them.
pub fn film_rate(path: &Path) -> Result<f64, Failure> {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-select_streams", "v:0", "-of", "csv=p=0"]);
    command
        .args(["-show_entries", "stream=r_frame_rate"])
        .args(["-format_whitelist", FILM_FORMATS])
        .arg(input(path));
    let output = command.stdin(Stdio::null()).output();
    let output = output.map_err(|error| no_ffmpeg(path, &error))?;
    let text = String::from_utf8_lossy(&output.stdout);
    parse_rate(&text).ok_or_else(|| {
        Failure::wrong_use(format!(
            "{} is neither a folder of pictures nor a film that ffmpeg reads: {}",
            escape_path(path),
            escape_line(String::from_utf8_lossy(&output.stderr).trim())
        ))
    })
}

/// Reads the first fraction of a report. The rate is there twice for a stream of a program, and a comma follows it if the film states how
/// it is turned.
fn parse_rate(text: &str) -> Option<f64> {
    let mut words = text.split([',', '\r', '\n']).map(str::trim);
    let (frames, seconds) = words.find(|word| !word.is_empty())?.split_once('/')?;
    let rate = frames.parse::<f64>().ok()? / seconds.parse::<f64>().ok()?;
    (rate.is_finite() && rate > 0.0).then_some(rate)
}

/// Returns a path that `ffmpeg` takes for a file, whatever its name begins with.
fn input(path: &Path) -> std::ffi::OsString {
    let mut input = std::ffi::OsString::from("file:");
    input.push(path);
    input
}

fn no_ffmpeg(path: &Path, error: &std::io::Error) -> Failure {
    Failure::job(format!(
        "cannot start ffmpeg, which reads the film {}: {error}; install it (`sudo apt install ffmpeg`), or name a folder of PNG or JPEG pictures",
        escape_path(path)
    ))
}

fn name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// Adds the names of pictures that are missing between others, so that the cameras stay in step.
///
/// Pictures are numbered in steps of one size by the last number of their names. Names that differ otherwise, or lack more pictures than
/// there are, do not count pictures, and stay as they are.
fn with_missing(pictures: Vec<PathBuf>) -> Vec<PathBuf> {
    let Some(numbers) = numbers(&pictures) else {
        return pictures;
    };
    let steps = || {
        numbers
            .windows(2)
            .map(|pair| pair[1].saturating_sub(pair[0]))
    };
    let step = steps().min().unwrap_or(0);
    if step == 0 || steps().any(|difference| difference % step != 0) {
        return pictures;
    }
    let missing = steps().map(|difference| difference / step - 1);
    if missing.fold(0, u64::saturating_add) > pictures.len() as u64 {
        return pictures;
    }
    let mut all = Vec::new();
    for (index, picture) in pictures.iter().enumerate() {
        all.push(picture.clone());
        let next = numbers.get(index + 1).copied().unwrap_or(0);
        let skipped = (numbers[index] + step..next).step_by(step as usize);
        all.extend(skipped.map(|number| with_number(picture, number)));
    }
    all
}

/// Returns the last numbers of names that are otherwise the same.
fn numbers(pictures: &[PathBuf]) -> Option<Vec<u64>> {
    let mut numbers = Vec::new();
    let first = name(pictures.first()?);
    let before = &first[..last_number(&first)?.start];
    for picture in pictures {
        let name = name(picture);
        let digits = last_number(&name)?;
        if &name[..digits.start] != before {
            return None;
        }
        // The number after the last one is a number, too.
        numbers.push(
            name[digits]
                .parse()
                .ok()
                .filter(|&number| number < u64::MAX / 2)?,
        );
    }
    Some(numbers)
}

/// Returns a path with another last number, of as many digits or more.
fn with_number(picture: &Path, number: u64) -> PathBuf {
    let name = name(picture);
    let Some(digits) = last_number(&name) else {
        return picture.to_owned();
    };
    let (before, after, width) = (&name[..digits.start], &name[digits.end..], digits.len());
    picture.with_file_name(format!("{before}{number:0width$}{after}"))
}

/// Returns the place of the last number in a name, before its ending.
fn last_number(name: &str) -> Option<Range<usize>> {
    let (stem, _) = name.rsplit_once('.')?;
    let end = stem.rfind(|letter: char| letter.is_ascii_digit())? + 1;
    let start = stem[..end].trim_end_matches(|letter: char| letter.is_ascii_digit());
    Some(start.len()..end)
}

/// Compares names with their numbers as numbers: `9.png` is before `10.png`.
fn by_number(one: &str, other: &str) -> Ordering {
    let (mut one, mut other) = (one, other);
    loop {
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let (of_one, of_other) = (digits(one), digits(other));
        if of_one > 0 && of_other > 0 {
            let [a, b] = [&one[..of_one], &other[..of_other]].map(|it| it.trim_start_matches('0'));
            let order = a.len().cmp(&b.len()).then_with(|| a.cmp(b));
            if order != Ordering::Equal {
                return order;
            }
            (one, other) = (&one[of_one..], &other[of_other..]);
            continue;
        }
        let (mut left, mut right) = (one.chars(), other.chars());
        match (left.next(), right.next()) {
            (None, None) => return Ordering::Equal,
            (a, b) if a != b => return a.cmp(&b),
            _ => (one, other) = (left.as_str(), right.as_str()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_missing_pictures_are_added_where_names_count_pictures() {
        for (there, missing) in [
            ("img1.png img2.png img4.png", "img3.png"),
            (
                "left/008.jpg left/009.jpg left/012.jpg",
                "left/010.jpg left/011.jpg",
            ),
            ("f0-a.png f2-a.png f6-a.png", "f4-a.png"),
            ("a9.png a10.png a12.PNG", "a11.png"),
            // Times in milliseconds, other names, and pictures that are not consecutive.
            ("t33.png t66.png t100.png t167.png", ""),
            ("a1.png a2.png b4.png", ""),
            ("a.png b.png d.png", ""),
            ("1.jpg 1.png 3.png", ""),
            ("1.png 2.png 9000000000000000000.png", ""),
            ("99999999999999999999.png 1.png", ""),
            ("7.png", ""),
        ] {
            let paths = |text: &str| {
                text.split_whitespace()
                    .map(PathBuf::from)
                    .collect::<Vec<_>>()
            };
            let mut found = with_missing(paths(there));
            found.retain(|path| !paths(there).contains(path));
            assert_eq!(found, paths(missing), "{there}");
        }
    }

    #[test]
    fn a_rate_is_read_from_each_form_of_a_report() {
        for (text, rate) in [
            ("30/1\n", Some(30.0)),
            ("30000/1001\n", Some(30_000.0 / 1001.0)),
            ("60/1,\n", Some(60.0)),
            ("25/1\r\n\r\n25/1\r\n", Some(25.0)),
            ("0/0\n", None),
            ("N/A\n", None),
            ("", None),
        ] {
            assert_eq!(parse_rate(text), rate, "{text:?}");
        }
    }

    #[test]
    fn names_are_ordered_by_their_numbers() {
        let mut names = [
            "b2.png",
            "a10.png",
            "a9.png",
            "a010b.png",
            "a.png",
            "a2-7.png",
            "a2-11.png",
        ];
        names.sort_by(|one, other| by_number(one, other));
        let expected = [
            "a.png",
            "a2-7.png",
            "a2-11.png",
            "a9.png",
            "a10.png",
            "a010b.png",
            "b2.png",
        ];
        assert_eq!(names, expected);
    }
}
