//! Poses from files: landmarks or attributes, one pose per line.

use std::borrow::Cow;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use ademan::document::BYTE_ORDER_MARK;
use ademan::estimate::arm_attributes::{HALF_POSE_ROWS, HalfPose, ImageSize};
use ademan::files;
use ademan::message::{escape_line, escape_path};
use glam::DVec3;
use serde_json::Value;

use super::npy;
use super::values::Line;
use crate::failure::Failure;

/// The number of landmarks of a whole pose, and the first of those that a half pose has.
const POSE_ROWS: usize = 33;
const FIRST_ROW: usize = 11;

/// The longest line, in bytes.
const MAX_LINE_BYTES: u64 = 1 << 16;

/// The fields that hold landmarks, in world coordinates before normalized ones. The names in camel case are those of MediaPipe for
/// JavaScript.
const LANDMARK_FIELDS: [&str; 5] = [
    "pose_world_landmarks",
    "worldLandmarks",
    "body_landmarks",
    "pose_landmarks",
    "landmarks",
];

/// A pose of a file.
pub struct Pose {
    /// Time in microseconds, if the line states it.
    pub time_us: Option<u64>,
    pub half: HalfPose,
}

/// Returns the name of a file in messages, `-` for standard input.
pub fn name(path: &Path) -> Cow<'_, str> {
    if path.as_os_str() == "-" {
        "the standard input".into()
    } else {
        escape_path(path).into()
    }
}

/// Reads the poses of a file, `-` for standard input.
pub fn read(path: &Path, image: Option<ImageSize>) -> Result<Vec<Pose>, Failure> {
    let (mut poses, mut without_person) = (Vec::new(), 0);
    for (number, text) in lines(path)? {
        match parse(&text, image).map_err(|reason| at_line(path, number, &reason))? {
            Some(pose) => poses.push(pose),
            None => without_person += 1,
        }
    }
    if without_person > 0 {
        let count = poses.len() + without_person;
        complain!(
            "{without_person} of {count} lines of {} show nobody and are left out",
            name(path)
        );
    }
    if poses.is_empty() {
        Err(Failure::wrong_use(format!(
            "{} holds no pose; write one per line: landmarks as JSON or CSV, or attributes as `ademan arm attributes` prints them",
            name(path)
        )))
    } else {
        Ok(poses)
    }
}

/// Returns the failure of a line of a file.
pub fn at_line(path: &Path, number: usize, reason: &str) -> Failure {
    let (name, reason) = (name(path), escape_line(reason));
    Failure::wrong_use(format!("{name}:{number}: {reason}"))
}

/// Returns the lines of a file that are not blank, with their numbers. The poses of an array of NumPy are lines of JSON.
pub fn lines(path: &Path) -> Result<Vec<(usize, String)>, Failure> {
    let cannot_read =
        |reason: String| Failure::wrong_use(format!("cannot read {}: {reason}", name(path)));
    let mut reader: Box<dyn BufRead> = if path.as_os_str() == "-" {
        Box::new(std::io::stdin().lock())
    } else {
        let file = files::open_regular(path).map_err(|error| cannot_read(error.to_string()))?;
        Box::new(BufReader::new(file))
    };
    let start = reader
        .fill_buf()
        .map_err(|error| cannot_read(error.to_string()))?;
    if start.starts_with(BYTE_ORDER_MARK.as_bytes()) {
        reader.consume(BYTE_ORDER_MARK.len());
    } else if start.starts_with(npy::MAGIC) {
        reader.consume(npy::MAGIC.len());
        let poses =
            npy::read(reader).map_err(|reason| cannot_read(escape_line(&reason).to_string()))?;
        return Ok((1..).zip(poses).collect());
    }
    let mut found = Vec::new();
    for number in 1.. {
        let mut bytes = Vec::new();
        let read = (&mut reader)
            .take(MAX_LINE_BYTES)
            .read_until(b'\n', &mut bytes);
        match read.map_err(|error| cannot_read(error.to_string()))? {
            0 => break,
            // The limit may cut a character.
            length if length as u64 == MAX_LINE_BYTES => {
                return Err(cannot_read(format!("line {number} is longer than 64 KiB")));
            }
            _ => {}
        }
        let line = String::from_utf8(bytes);
        let line = line.map_err(|_| cannot_read(format!("line {number} is not UTF-8 text")))?;
        if !line.trim().is_empty() {
            found.push((number, line));
        }
    }
    Ok(found)
}

/// Parses one pose; `None` if no person was seen. An error states what it could be and is not.
fn parse(text: &str, image: Option<ImageSize>) -> Result<Option<Pose>, String> {
    let Ok(value) = json(text) else {
        let rows = csv_rows(text).ok_or(
            "neither JSON nor comma-separated numbers of 14 or 33 landmarks; \
             `ademan arm attributes --help` lists the formats",
        )?;
        return half_pose(&rows, image, None).map(Some);
    };
    if value.get("trunk").is_some() {
        let line: Line = serde_json::from_value(value).map_err(|error| error.to_string())?;
        let half = line.pose()?;
        return Ok(Some(Pose {
            time_us: line.time_us,
            half,
        }));
    }
    let time_us = time_us(&value)?;
    let fields = || LANDMARK_FIELDS.iter().filter_map(|name| value.get(name));
    let field = fields().find(|field| !field.is_null()).or(fields().next());
    if field.is_none() {
        check_one_pose(&value)?;
    }
    let Some(list) = landmarks(field.unwrap_or(&value))? else {
        return Ok(None);
    };
    half_pose(&list.iter().map(row).collect::<Vec<_>>(), image, time_us).map(Some)
}

/// Refuses a list of several poses, of which only the first one would count.
fn check_one_pose(list: &Value) -> Result<(), String> {
    let is_landmark = |value: &Value| value.is_array() || value.is_object();
    let is_pose = |value: &&Value| {
        let points = value.as_array();
        points.is_some_and(|all| all.iter().any(is_landmark))
    };
    let poses = list.as_array().into_iter().flatten().filter(is_pose);
    match poses.count() {
        0 | 1 => Ok(()),
        count => Err(format!(
            "a list of {count} poses; write each pose on a line of its own"
        )),
    }
}

/// Parses a line of JSON. `NaN`, which Python writes for a number that is missing and JSON does not have, becomes `null`.
pub fn json(text: &str) -> Result<Value, serde_json::Error> {
    serde_json::from_str(text).or_else(|error| {
        // No name that is read here has these letters.
        serde_json::from_str(&text.replace("NaN", "null")).map_err(|_| error)
    })
}

/// Returns the reason why a line is not what it should be, with its column. The line is the first one of its own text, not of its file.
pub fn json_reason(error: &serde_json::Error) -> String {
    error
        .to_string()
        .replace(" at line 1 column ", " at column ")
}

/// Returns the time that a line states, in microseconds.
pub fn time_us(line: &Value) -> Result<Option<u64>, String> {
    match line.get("time_us") {
        None | Some(Value::Null) => Ok(None),
        Some(time) => time.as_u64().map(Some).ok_or_else(|| {
            format!("`time_us` is {time}; it is a whole number of microseconds, 0 or more")
        }),
    }
}

/// Returns the landmarks of the first person in a field; `None` if it has none.
pub fn landmarks(field: &Value) -> Result<Option<&[Value]>, String> {
    if field.is_null() {
        return Ok(None);
    }
    let list = field.as_array().ok_or_else(|| {
        format!(
            "a pose is a list of landmarks, or an object with one of `{}`",
            LANDMARK_FIELDS.join("`, `")
        )
    })?;
    // The bridge emits one list for each person.
    let of_person = list.first().and_then(Value::as_array);
    let is_landmark = |value: &Value| value.is_array() || value.is_object();
    let is_nested = of_person.is_some_and(|person| person.iter().any(is_landmark));
    let list = of_person.filter(|_| is_nested).unwrap_or(list);
    Ok(Some(list.as_slice()).filter(|list| !list.is_empty()))
}

/// Returns the position of a landmark; not a number for one that is missing.
pub fn row(value: &Value) -> DVec3 {
    let number = |index: usize, name: &str| {
        let number = value.get(index).or_else(|| value.get(name));
        number.and_then(Value::as_f64).unwrap_or(f64::NAN)
    };
    DVec3::new(number(0, "x"), number(1, "y"), number(2, "z"))
}

/// Returns the landmarks of a line of numbers.
fn csv_rows(text: &str) -> Option<Vec<DVec3>> {
    let text = text.trim();
    // As spreadsheets of many languages write `0,5;0,25`.
    let with_decimal_commas = rows(text.replace(',', ".").split([';', '\t']));
    let by_any = || rows(text.split([',', ';', '\t']));
    // As `numpy.savetxt` separates numbers.
    let by_blanks = || rows(text.split_whitespace());
    with_decimal_commas.or_else(by_any).or_else(by_blanks)
}

/// Returns the landmarks of fields with three or four numbers each.
fn rows<'a>(fields: impl Iterator<Item = &'a str>) -> Option<Vec<DVec3>> {
    let numbers: Vec<f64> = fields
        .map(str::trim)
        .map(|field| {
            if field.is_empty() {
                Some(f64::NAN)
            } else {
                field.parse().ok()
            }
        })
        .collect::<Option<_>>()?;
    // With or without the visibility of each landmark.
    let width = [3, 4].into_iter().find(|width| {
        [HALF_POSE_ROWS, POSE_ROWS].contains(&(numbers.len() / width))
            && numbers.len().is_multiple_of(*width)
    })?;
    let points = numbers.chunks(width);
    Some(
        points
            .map(|row| DVec3::new(row[0], row[1], row[2]))
            .collect(),
    )
}

fn half_pose(
    rows: &[DVec3],
    image: Option<ImageSize>,
    time_us: Option<u64>,
) -> Result<Pose, String> {
    let rows = match rows.len() {
        HALF_POSE_ROWS => rows,
        POSE_ROWS => &rows[FIRST_ROW..FIRST_ROW + HALF_POSE_ROWS],
        count => {
            return Err(format!(
                "{count} landmarks; a pose has {POSE_ROWS}, a half pose {HALF_POSE_ROWS}"
            ));
        }
    };
    let placed = |row: &DVec3| image.map_or(*row, |image| image.to_pixels(*row));
    let rows: Vec<DVec3> = rows.iter().map(placed).collect();
    let rows = rows.try_into().expect("the number of rows was checked");
    Ok(Pose {
        time_us,
        half: HalfPose::from_rows(&rows),
    })
}

/// Parses the size of an image, such as `1280x720` or `1280,720`.
pub fn image_size(text: &str) -> Result<ImageSize, String> {
    let number = |part: &str| part.trim().parse::<f64>().ok();
    let size = text.split_once([',', 'x']);
    match size.map(|(width, height)| (number(width), number(height))) {
        Some((Some(width), Some(height))) if width >= 1.0 && height >= 1.0 => {
            Ok(ImageSize { width, height })
        }
        _ => Err("write the width and the height in pixels, such as 1280x720".into()),
    }
}

/// Writes the landmarks of a pose as a line of the protocol `body-landmarks`.
pub fn landmark_line(pose: &HalfPose, time_us: Option<u64>) -> String {
    let mut points = vec![[0.0; 4]; POSE_ROWS];
    for (point, row) in points[FIRST_ROW..].iter_mut().zip(pose.rows()) {
        *point = [row.x, row.y, row.z, 1.0];
    }
    let mut line = serde_json::json!({ "pose_world_landmarks": points });
    if let Some(time_us) = time_us {
        line["time_us"] = time_us.into();
    }
    line.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_is_too_long_is_named_also_if_the_limit_cuts_a_character() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("poses.csv");
        let before = "0".repeat(MAX_LINE_BYTES as usize - 1);
        std::fs::write(&path, before + "é").unwrap();
        let error = lines(&path).unwrap_err().to_string();
        assert!(error.ends_with("line 1 is longer than 64 KiB"), "{error}");
    }
}
