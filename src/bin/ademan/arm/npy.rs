//! Arrays of NumPy: poses as a file of `numpy.save`.

use std::io::Read;

/// First bytes of a file.
pub const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest header, in bytes; the header of an array of numbers takes about 100.
const MAX_HEADER_BYTES: usize = 1 << 16;

/// Most numbers of a file: two hours of 33 landmarks at 60 Hz.
const MAX_NUMBERS: usize = 1 << 26;

/// Most numbers of a landmark: x, y and z, and the visibility and the presence of some models.
const MAX_COORDINATES: usize = 5;

/// The types of numbers that are read.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Float32,
    Float64,
}

/// Reads the poses of an array after its first bytes, as lines of JSON: of shape (poses, landmarks, coordinates), or (landmarks,
/// coordinates) for one pose. An error states what is not read.
pub fn read(mut file: impl Read) -> Result<Vec<String>, String> {
    let mut version = [0; 2];
    fill(&mut file, &mut version)?;
    let length = match version[0] {
        1 => {
            let mut length = [0; 2];
            fill(&mut file, &mut length)?;
            usize::from(u16::from_le_bytes(length))
        }
        2 | 3 => {
            let mut length = [0; 4];
            fill(&mut file, &mut length)?;
            u32::from_le_bytes(length) as usize
        }
        version => return Err(format!("format {version} of `.npy`; 1 to 3 are read")),
    };
    if length > MAX_HEADER_BYTES {
        return Err(format!("a header of {length} bytes"));
    }
    let mut header = vec![0; length];
    fill(&mut file, &mut header)?;
    let (kind, shape) = parse_header(&String::from_utf8_lossy(&header))?;
    let [poses, rows, columns] = match shape[..] {
        [rows, columns] => [1, rows, columns],
        [poses, rows, columns] => [poses, rows, columns],
        _ => {
            let message = "an array of poses has the shape (poses, landmarks, coordinates)";
            return Err(format!("{message}, not {} dimensions", shape.len()));
        }
    };
    let count = [poses, rows, columns]
        .iter()
        .try_fold(1_usize, |product, &number| product.checked_mul(number));
    let count = count.filter(|&count| count <= MAX_NUMBERS);
    let count = count.ok_or_else(|| format!("more than {MAX_NUMBERS} numbers"))?;
    // The rows of an array of flat poses would be taken for landmarks.
    if columns > MAX_COORDINATES {
        return Err(format!(
            "landmarks of {columns} numbers, which have {MAX_COORDINATES} at most; save flat poses as `array.reshape(-1, 33, 3)`"
        ));
    }
    let numbers = numbers(&mut file, kind, count)?;
    if count == 0 {
        return Ok(Vec::new());
    }
    let line = |pose: &[f64]| {
        let coordinates: Vec<&[f64]> = pose.chunks(columns).collect();
        serde_json::to_string(&coordinates).expect("numbers are JSON")
    };
    Ok(numbers.chunks(rows * columns).map(line).collect())
}

/// Reads the numbers piece by piece, so that a header alone takes no memory.
fn numbers(file: &mut impl Read, kind: Kind, count: usize) -> Result<Vec<f64>, String> {
    let mut numbers = Vec::new();
    for _ in 0..count {
        numbers.push(match kind {
            Kind::Float32 => {
                let mut bytes = [0; 4];
                fill(file, &mut bytes)?;
                f64::from(f32::from_le_bytes(bytes))
            }
            Kind::Float64 => {
                let mut bytes = [0; 8];
                fill(file, &mut bytes)?;
                f64::from_le_bytes(bytes)
            }
        });
    }
    match file.read(&mut [0]) {
        Ok(0) => Ok(numbers),
        Ok(_) => Err("bytes after the last number".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

fn fill(file: &mut impl Read, bytes: &mut [u8]) -> Result<(), String> {
    file.read_exact(bytes)
        .map_err(|error| format!("the array is not complete: {error}"))
}

/// Reads the dictionary of a header, such as `{'descr': '<f8', 'fortran_order': False, 'shape': (10, 33, 3), }`.
fn parse_header(text: &str) -> Result<(Kind, Vec<usize>), String> {
    let value = |key: &str| {
        let (_, rest) = text.split_once(&format!("'{key}':"))?;
        Some(rest.trim_start())
    };
    let missing = |key: &str| format!("the header has no `{key}`");
    let descr = value("descr").ok_or_else(|| missing("descr"))?;
    let kind = match descr.get(..5) {
        Some("'<f4'") => Kind::Float32,
        Some("'<f8'") => Kind::Float64,
        _ => {
            let found = descr.split(',').next().unwrap_or_default();
            return Err(format!(
                "numbers of the type {found}; save `float32` or `float64` with `array.astype('<f8')`"
            ));
        }
    };
    let order = value("fortran_order").ok_or_else(|| missing("fortran_order"))?;
    if !order.starts_with("False") {
        return Err("an array in Fortran order; save `numpy.ascontiguousarray(array)`".to_owned());
    }
    let shape = value("shape").ok_or_else(|| missing("shape"))?;
    let shape = shape
        .strip_prefix('(')
        .and_then(|rest| rest.split_once(')'));
    let (shape, _) = shape.ok_or_else(|| missing("shape"))?;
    let numbers = shape
        .split(',')
        .map(str::trim)
        .filter(|number| !number.is_empty());
    let numbers: Result<Vec<usize>, _> = numbers.map(str::parse).collect();
    Ok((kind, numbers.map_err(|_| missing("shape"))?))
}

#[cfg(test)]
mod tests {
    /// Returns the bytes after the first six of an array.
    fn array(version: u8, header: &str, numbers: &[u8]) -> Vec<u8> {
        let mut bytes = vec![version, 0];
        match version {
            1 => bytes.extend((header.len() as u16).to_le_bytes()),
            _ => bytes.extend((header.len() as u32).to_le_bytes()),
        }
        bytes.extend(header.as_bytes());
        bytes.extend(numbers);
        bytes
    }

    #[test]
    fn arrays_of_both_types_are_lines_and_others_are_refused_with_a_remedy() {
        let double: Vec<u8> = [1.5_f64, -2.0, 0.1]
            .iter()
            .flat_map(|n| n.to_le_bytes())
            .collect();
        let single: Vec<u8> = [1.5_f32, -2.0, 0.25]
            .iter()
            .flat_map(|n| n.to_le_bytes())
            .collect();
        let header = |descr: &str, order: &str, shape: &str| {
            format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}     \n")
        };
        let read = |bytes: Vec<u8>| super::read(&bytes[..]);
        for version in [1, 2, 3] {
            let three = array(version, &header("<f8", "False", "(3, 1, 1)"), &double);
            assert_eq!(read(three).unwrap(), ["[[1.5]]", "[[-2.0]]", "[[0.1]]"]);
        }
        let one = array(1, &header("<f4", "False", "(1, 3)"), &single);
        assert_eq!(read(one).unwrap(), ["[[1.5,-2.0,0.25]]"]);
        for (descr, order, shape, reason) in [
            (">f8", "False", "(1, 3)", "'>f8'; save"),
            ("<i8", "False", "(1, 3)", "'<i8'; save"),
            ("|O", "False", "(1, 3)", "save `float32`"),
            ("<f8", "True", "(1, 3)", "ascontiguousarray"),
            ("<f8", "False", "(3,)", "not 1 dimensions"),
            ("<f8", "False", "(1, 4)", "not complete"),
            ("<f8", "False", "(1, 2)", "after the last"),
            ("<f8", "False", "(99999999999, 99999999999)", "more than"),
            ("<f8", "False", "(33, 99)", "landmarks of 99 numbers"),
            ("<f8", "False", "(-1, 3)", "no `shape`"),
        ] {
            let error = read(array(1, &header(descr, order, shape), &double)).unwrap_err();
            assert!(error.contains(reason), "{reason}: {error}");
        }
        for (bytes, reason) in [
            (array(1, "{}", &double), "no `descr`"),
            (array(9, "{}", &double), "format 9"),
            (vec![1], "not complete"),
        ] {
            let error = read(bytes).unwrap_err();
            assert!(error.contains(reason), "{reason}: {error}");
        }
    }
}
