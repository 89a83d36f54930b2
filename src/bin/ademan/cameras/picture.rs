//! Pictures of cameras as pixels: PNG, JPEG, and the frames that `ffmpeg` writes.

use std::io::{BufRead, Cursor};

use ademan::cameras::MarkImage;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::colors::Color;

/// Most pixels of a picture.
const MAX_PIXELS: usize = 1 << 26;

/// Rows of pixels with eight bits for each of red, green and blue.
pub struct Picture {
    pub width: usize,
    pub height: usize,
    /// Numbers for each pixel: 1 or 2 for gray, 3 or 4 for red, green and blue, with a transparency that is ignored.
    samples: usize,
    bytes: Vec<u8>,
}

impl Picture {
    /// Decodes a PNG or JPEG by its first bytes.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => Self::decode_png(bytes),
            [0xff, 0xd8, ..] => Self::decode_jpeg(bytes),
            _ => Err("it is neither a PNG nor a JPEG".to_owned()),
        }
    }

    fn decode_png(bytes: &[u8]) -> Result<Self, String> {
        let damaged = |error: png::DecodingError| format!("the PNG is damaged: {error}");
        let mut decoder = png::Decoder::new(Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(damaged)?;
        let (width, height) = reader.info().size();
        let [width, height] = checked([width as usize, height as usize])?;
        let size = reader.output_buffer_size();
        let mut pixels = vec![0; size.ok_or("it is too large")?];
        let frame = reader.next_frame(&mut pixels).map_err(damaged)?;
        pixels.truncate(frame.buffer_size());
        let samples = frame.color_type.samples();
        Self::new([width, height], samples, pixels)
    }

    fn decode_jpeg(bytes: &[u8]) -> Result<Self, String> {
        let damaged = |error| format!("the JPEG is damaged: {error:?}");
        let options = DecoderOptions::default()
            .set_strict_mode(true)
            .jpeg_set_out_colorspace(ColorSpace::RGB);
        let cursor = zune_jpeg::zune_core::bytestream::ZCursor::new(bytes);
        let mut decoder = zune_jpeg::JpegDecoder::new_with_options(cursor, options);
        decoder.decode_headers().map_err(damaged)?;
        let (width, height) = decoder.dimensions().ok_or("the JPEG has no size")?;
        let size = checked([width, height])?;
        let pixels = decoder.decode().map_err(damaged)?;
        Self::new(size, 3, pixels)
    }

    /// Reads the next frame in the format PPM, `P6`; `None` at the end.
    pub fn read_ppm(input: &mut impl BufRead) -> Result<Option<Self>, String> {
        let cut = |error: std::io::Error| format!("the film ends within a frame: {error}");
        if input.fill_buf().map_err(cut)?.is_empty() {
            return Ok(None);
        }
        let mut word = || -> Result<String, String> {
            let mut word = String::new();
            loop {
                let mut byte = [0];
                input.read_exact(&mut byte).map_err(cut)?;
                match byte[0] {
                    b' ' | b'\n' | b'\r' | b'\t' if word.is_empty() => {}
                    b' ' | b'\n' | b'\r' | b'\t' => return Ok(word),
                    byte if word.len() < 16 => word.push(byte.into()),
                    _ => return Err("ffmpeg sent no picture".to_owned()),
                }
            }
        };
        let [magic, width, height, depth] = [word()?, word()?, word()?, word()?];
        if magic != "P6" || depth != "255" {
            return Err("ffmpeg sent no picture".to_owned());
        }
        let number = |digits: String| {
            digits
                .parse()
                .map_err(|_| "ffmpeg sent no picture".to_owned())
        };
        let [width, height] = checked([number(width)?, number(height)?])?;
        let mut bytes = vec![0; 3 * width * height];
        input.read_exact(&mut bytes).map_err(cut)?;
        Self::new([width, height], 3, bytes).map(Some)
    }

    fn new([width, height]: [usize; 2], samples: usize, bytes: Vec<u8>) -> Result<Self, String> {
        if bytes.len() == width * height * samples {
            Ok(Self {
                width,
                height,
                samples,
                bytes,
            })
        } else {
            Err("it has fewer pixels than its size says".to_owned())
        }
    }

    /// Returns how much of a color each pixel has.
    pub fn of_color(&self, color: Color) -> Option<MarkImage> {
        let pixels = self.bytes.chunks_exact(self.samples);
        let values = pixels.map(|pixel| {
            let [red, green, blue] = match pixel {
                [red, green, blue, ..] => [*red, *green, *blue],
                [gray, ..] => [*gray; 3],
                [] => [0; 3],
            };
            color.value([red, green, blue].map(|byte| f32::from(byte) / 255.0))
        });
        MarkImage::new(self.width, values.collect())
    }
}

fn checked([width, height]: [usize; 2]) -> Result<[usize; 2], String> {
    match width.checked_mul(height) {
        Some(1..=MAX_PIXELS) => Ok([width, height]),
        _ => Err(format!("it has {width} × {height} pixels")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan::cameras::{MarkSettings, find_marks};

    /// A JPEG of 24 × 16 pixels: a white square from (14, 5) to (19, 10) on black.
    const JPEG: &str = concat!(
        "ffd8ffe000104a46494600010200000100010000ffdb0043000810101310131616161616161a181a1b1b1b1a1a1a1a1b",
        "1b1b1d1d1d2222221d1d1d1b1b1d1d2020222225262523232223262628282830302e2e38383a454553ffc40058000101",
        "010000000000000000000000000000050801010000000000000000000000000000000010000201050100030100000000",
        "0000000001021105040313120052513122110100000000000000000000000000000000ffc00011080010001803011200",
        "021200031200ffda000c03010002110311003f00cffe7802c585964a8dce3b6c4515f27505c90bfca96325431fc1f5e5",
        "85ee4a75ce3b9c4119f1f501c12bfd2953214a9fc3f7e00b156a25cd1f56f7c2dbbbe759731c7333d227c8444f956add",
        "cd6356f4c2ba7be758713df333d3bfc44447803fffd9",
    );

    fn jpeg() -> Vec<u8> {
        let digits = JPEG.as_bytes().chunks_exact(2);
        let byte =
            |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
        digits.map(byte).collect()
    }

    /// Encodes a PNG.
    fn png(color: png::ColorType, depth: png::BitDepth, size: [u32; 2], pixels: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == png::ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 255, 0, 0]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(pixels).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn a_square_in_a_jpeg_is_where_it_is() {
        let picture = Picture::decode(&jpeg()).unwrap();
        assert_eq!([picture.width, picture.height], [24, 16]);
        let settings = MarkSettings {
            threshold: 0.5,
            min_px: 4,
            max_px: 100,
            max_elongation: 1.3,
        };
        let found = find_marks(&picture.of_color(Color::White).unwrap(), &settings);
        let [mark] = found.marks[..] else {
            panic!("{found:?}");
        };
        assert!(
            mark.center.distance(glam::DVec2::new(16.5, 7.5)) < 0.1,
            "{mark:?}"
        );
    }

    #[test]
    fn every_form_of_png_has_its_colors() {
        use png::{BitDepth, ColorType};
        let red = |bytes: &[u8]| {
            Picture::decode(bytes)
                .unwrap()
                .of_color(Color::Red)
                .unwrap()
        };
        let rgb = png(
            ColorType::Rgb,
            BitDepth::Eight,
            [2, 1],
            &[0, 0, 0, 255, 0, 0],
        );
        let rgba = png(
            ColorType::Rgba,
            BitDepth::Eight,
            [2, 1],
            &[0, 0, 0, 255, 255, 0, 0, 9],
        );
        let deep = png(
            ColorType::Rgb,
            BitDepth::Sixteen,
            [2, 1],
            &[0, 0, 0, 0, 0, 0, 255, 255, 0, 0, 0, 0],
        );
        let indexed = png(ColorType::Indexed, BitDepth::One, [2, 1], &[0b0100_0000]);
        for bytes in [rgb, rgba, deep, indexed] {
            let expected = MarkImage::new(2, vec![0.0, 1.0]);
            assert_eq!(format!("{:?}", Some(red(&bytes))), format!("{expected:?}"));
        }
        let gray = png(
            ColorType::GrayscaleAlpha,
            BitDepth::Eight,
            [2, 1],
            &[255, 0, 0, 0],
        );
        let gray = Picture::decode(&gray)
            .unwrap()
            .of_color(Color::Dark)
            .unwrap();
        assert_eq!(
            format!("{gray:?}"),
            format!("{:?}", MarkImage::new(2, vec![0.0, 1.0]).unwrap())
        );
    }

    #[test]
    fn damaged_pictures_are_refused_at_every_length() {
        let whole = png(
            png::ColorType::Grayscale,
            png::BitDepth::Eight,
            [40, 30],
            &[7; 1200],
        );
        for bytes in [whole, jpeg()] {
            for length in 0..bytes.len() - 12 {
                assert!(Picture::decode(&bytes[..length]).is_err(), "{length}");
            }
            let mut random = fastrand::Rng::with_seed(3);
            for _ in 0..2000 {
                let mut bytes = bytes.clone();
                let place = random.usize(2..bytes.len());
                bytes[place] ^= 1 << random.u32(0..8);
                // No panic, and no size without its pixels.
                let _ = Picture::decode(&bytes);
            }
        }
        assert!(Picture::decode(b"GIF89a").is_err());
    }

    #[test]
    fn frames_of_a_film_are_read_to_its_end() {
        let mut film = &b"P6\n2 1\n255\n\x00\x00\x00\xff\x00\x00P6 1 1 255\n\x00\x00"[..];
        let first = Picture::read_ppm(&mut film).unwrap().unwrap();
        assert_eq!([first.width, first.height], [2, 1]);
        assert!(
            Picture::read_ppm(&mut film).is_err_and(|error| error.contains("ends within a frame"))
        );
        assert!(matches!(Picture::read_ppm(&mut &b""[..]), Ok(None)));
        for wrong in [
            "P5 1 1 255\n0",
            "P6 9999999 9999999 255\n",
            "P6 1 1 65535\n",
        ] {
            assert!(Picture::read_ppm(&mut wrong.as_bytes()).is_err());
        }
    }
}
