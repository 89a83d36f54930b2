//! The pictures of a camera, one after the other: the files of a folder, or the frames of a film.

use std::cmp::Ordering;
use std::fs;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

use ademan::files;
use ademan::message::{escape_line, escape_path};

use super::picture::Picture;
use crate::failure::Failure;

/// Longest file of a picture, in bytes.
const MAX_BYTES: u64 = 1 << 28;

/// Ends of the names of pictures.
const PICTURES: [&str; 3] = ["png", "jpg", "jpeg"];

/// The pictures of a camera.
pub enum Frames {
    /// Files of a folder, in the order of their names.
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
        let cannot_read = |error: std::io::Error| {
            Failure::wrong_use(format!("cannot read {}: {error}", escape_path(path)))
        };
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
        Ok(Self::Folder(pictures.into_iter()))
    }

    /// Returns the next picture; `None` at the end.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, Failure> {
        match self {
            Self::Folder(paths) => Ok(paths.next().map(|path| Frame {
                name: escape_path(&path).to_string(),
                picture: read(&path).and_then(|bytes| Picture::decode(&bytes)),
            })),
            Self::Film(film) => film.next_frame(),
        }
    }
}

impl Film {
    fn open(path: &Path, rate_hz: Option<f64>) -> Result<Self, Failure> {
        // Also refuses devices and pipes.
        files::open_regular(path).map_err(|error| {
            Failure::wrong_use(format!("cannot read {}: {error}", escape_path(path)))
        })?;
        let mut command = Command::new("ffmpeg");
        command
            .args(["-nostdin", "-v", "error", "-i"])
            .arg(input(path));
        if let Some(rate_hz) = rate_hz {
            command.args(["-vf", &format!("fps={rate_hz}")]);
        }
        command.args(["-f", "image2pipe", "-c:v", "ppm", "-"]);
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
        // It has ended, or nobody reads the rest.
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
        .arg(input(path));
    let output = command.stdin(Stdio::null()).output();
    let output = output.map_err(|error| no_ffmpeg(path, &error))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let rate = text.trim().split_once('/').and_then(|(frames, seconds)| {
        let rate = frames.parse::<f64>().ok()? / seconds.parse::<f64>().ok()?;
        (rate.is_finite() && rate > 0.0).then_some(rate)
    });
    rate.ok_or_else(|| {
        Failure::wrong_use(format!(
            "{} is neither a folder of pictures nor a film that ffmpeg reads: {}",
            escape_path(path),
            escape_line(String::from_utf8_lossy(&output.stderr).trim())
        ))
    })
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

fn read(path: &Path) -> Result<Vec<u8>, String> {
    let file = files::open_regular(path).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    let read = file.take(MAX_BYTES).read_to_end(&mut bytes);
    match read.map_err(|error| error.to_string())? as u64 {
        MAX_BYTES => Err("it is longer than 256 MiB".to_owned()),
        _ => Ok(bytes),
    }
}

fn name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
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
