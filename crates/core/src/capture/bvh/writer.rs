//! Writer of BVH texts.

use std::io::{Result, Seek, SeekFrom, Write};

use super::skeleton::{Node, Skeleton};

/// Width of the number of frames, which is known only at the end: the width of [`MAX_FRAMES`](super::MAX_FRAMES).
const COUNT_WIDTH: usize = 9;

/// Writer of a skeleton and its frames, one line per frame with six decimals.
///
/// The number of frames is filled in by [`complete_block`](Self::complete_block) and [`finish`](Self::finish). A text whose
/// writer stopped before has the frames of the last block.
#[derive(Debug)]
pub struct BvhWriter<W> {
    out: W,
    /// Position of the number of frames.
    count_at: u64,
    frames: u64,
    line: Vec<u8>,
}

impl<W: Write + Seek> BvhWriter<W> {
    /// Writes the skeleton to an empty file. `frame_time` is in seconds.
    pub fn new(mut out: W, skeleton: &Skeleton, frame_time: f64) -> Result<Self> {
        let mut line = Vec::new();
        let count_at = write_header(&mut line, skeleton, 0, frame_time);
        out.write_all(&line)?;
        Ok(Self {
            out,
            count_at: count_at as u64,
            frames: 0,
            line,
        })
    }

    /// Writes a frame: one value for each channel, in the order of the skeleton.
    pub fn write_frame(&mut self, values: &[f64]) -> Result<()> {
        self.line.clear();
        write_frame(&mut self.line, values);
        self.out.write_all(&self.line)?;
        self.frames += 1;
        Ok(())
    }

    /// Returns the number of frames written.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Writes the number of frames so far, after the frames. Returns the length of the text in bytes.
    pub fn complete_block(&mut self) -> Result<u64> {
        self.out.seek(SeekFrom::Start(self.count_at))?;
        write!(self.out, "{:<COUNT_WIDTH$}", self.frames)?;
        let length = self.out.seek(SeekFrom::End(0))?;
        self.out.flush()?;
        Ok(length)
    }

    /// Writes the number of frames and returns the file.
    pub fn finish(mut self) -> Result<W> {
        self.complete_block()?;
        Ok(self.out)
    }
}

/// Appends everything before the first frame. `frame_time` is in seconds. Returns the index of the number of frames.
pub fn write_header(
    text: &mut Vec<u8>,
    skeleton: &Skeleton,
    frames: u64,
    frame_time: f64,
) -> usize {
    write_hierarchy(text, skeleton);
    text.extend(b"MOTION\nFrames: ");
    let count_at = text.len();
    push(
        text,
        format_args!("{frames:<COUNT_WIDTH$}\nFrame Time: {frame_time}\n"),
    );
    count_at
}

/// Appends the line of a frame: one value for each channel, in the order of the skeleton.
pub fn write_frame(text: &mut Vec<u8>, values: &[f64]) {
    for (index, value) in values.iter().enumerate() {
        if index > 0 {
            text.push(b' ');
        }
        push(text, format_args!("{value:.6}"));
    }
    text.push(b'\n');
}

fn push(text: &mut Vec<u8>, arguments: std::fmt::Arguments) {
    text.write_fmt(arguments)
        .expect("memory accepts every text");
}

fn write_hierarchy(text: &mut Vec<u8>, skeleton: &Skeleton) {
    text.extend(b"HIERARCHY\n");
    let mut open: Vec<usize> = Vec::new();
    for (index, node) in skeleton.nodes().iter().enumerate() {
        while open.last().copied() != node.parent {
            open.pop();
            push(text, format_args!("{}}}\n", indent(open.len())));
        }
        write_node(text, node, &indent(open.len()));
        open.push(index);
    }
    while open.pop().is_some() {
        push(text, format_args!("{}}}\n", indent(open.len())));
    }
}

fn write_node(text: &mut Vec<u8>, node: &Node, indent: &str) {
    let kind = match node.parent {
        None => "ROOT",
        Some(_) => "JOINT",
    };
    match &node.name {
        Some(name) => push(text, format_args!("{indent}{kind} {name}\n")),
        None => push(text, format_args!("{indent}End Site\n")),
    }
    let [x, y, z] = node.offset.to_array();
    push(
        text,
        format_args!("{indent}{{\n{indent}  OFFSET {x:.6} {y:.6} {z:.6}\n"),
    );
    if node.name.is_none() {
        return;
    }
    push(
        text,
        format_args!("{indent}  CHANNELS {}", node.channels.len()),
    );
    for channel in &node.channels {
        push(text, format_args!(" {channel}"));
    }
    text.push(b'\n');
}

fn indent(depth: usize) -> String {
    "  ".repeat(depth)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::capture::bvh::Bvh;

    #[test]
    fn a_written_text_is_read_with_the_same_skeleton_and_frames() {
        let text = b"HIERARCHY ROOT hips { OFFSET 1 2 3 CHANNELS 2 Xposition Zrotation \
            JOINT a:b { OFFSET 0 0.5 0 CHANNELS 0 End Site { OFFSET 0 1 0 } End Site { OFFSET 0 2 0 } } \
            JOINT c { OFFSET 4 0 0 CHANNELS 1 Yrotation } } \
            MOTION Frames: 3 Frame Time: 0.008 1 2 3 -4.5 1e-3 6 7 8 9";
        let read = Bvh::parse(text).unwrap();
        let motion = read.motion();
        let mut writer =
            BvhWriter::new(Cursor::new(Vec::new()), &motion.skeleton, motion.frame_time).unwrap();
        for frame in 0..3 {
            writer.write_frame(read.frame(frame)).unwrap();
        }
        assert_eq!(writer.frames(), 3);
        let written = writer.finish().unwrap().into_inner();
        assert_eq!(Bvh::parse(&written), Ok(read), "{}", written.escape_ascii());
    }
}
