//! Streaming parser: texts of any length in bounded memory.

use glam::DVec3;

use super::error::{BvhError, error, shown};
use super::limits::{MAX_CHANNELS, MAX_DEPTH, MAX_FRAMES, MAX_NODES};
use super::skeleton::{Node, Skeleton, channel_named, number};
use super::tokens::Tokenizer;
use crate::document::BYTE_ORDER_MARK;

/// The part of a BVH text before its frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// The tree of joints.
    pub skeleton: Skeleton,
    /// Number of frames as written, at most [`MAX_FRAMES`].
    pub frame_count: u64,
    /// Seconds from frame to frame, 0 or more.
    pub frame_time: f64,
}

/// Parser of a BVH text that arrives in pieces of any size.
#[derive(Clone, Debug, Default)]
pub struct BvhParser {
    tokens: Tokenizer,
    reader: Reader,
}

impl BvhParser {
    /// Creates a parser at the start of a text.
    pub fn new() -> Self {
        Self::default()
    }

    /// Parses the next piece and calls `on_frame` with the values of each complete frame and the offset of the first byte
    /// after it. After an error, the parser is at no defined position.
    pub fn push(
        &mut self,
        piece: &[u8],
        on_frame: &mut dyn FnMut(&Motion, &[f64], u64),
    ) -> Result<(), BvhError> {
        let reader = &mut self.reader;
        self.tokens.push(piece, |token, line, end| {
            reader.token(token, line, end, on_frame)
        })
    }

    /// Ends the text. An error states what is missing.
    pub fn finish(
        &mut self,
        on_frame: &mut dyn FnMut(&Motion, &[f64], u64),
    ) -> Result<(), BvhError> {
        let reader = &mut self.reader;
        self.tokens
            .finish(|token, line, end| reader.token(token, line, end, on_frame))?;
        reader.check_complete(self.tokens.line())
    }

    /// Ends a text that may have been cut anywhere. A number that was cut is another number, so the word at the end counts only if the
    /// text is complete with it.
    pub fn finish_cut(
        &mut self,
        on_frame: &mut dyn FnMut(&Motion, &[f64], u64),
    ) -> Result<(), BvhError> {
        if !self.reader.awaits_last_word() {
            self.tokens.discard();
        }
        self.finish(on_frame)
    }

    /// Returns the skeleton, the number of frames and the frame time, once all of them are known.
    pub fn motion(&self) -> Option<&Motion> {
        matches!(self.reader.expected, Expected::Values).then_some(&self.reader.motion)
    }
}

/// The word that is expected next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Expected {
    #[default]
    Hierarchy,
    Root,
    Name,
    /// `Site` after `End`.
    Site,
    Brace,
    /// A keyword within a joint.
    Body,
    Offset(usize),
    ChannelCount,
    Channel(usize),
    Motion,
    Frames,
    FrameCount,
    Frame,
    Time,
    FrameTime,
    Values,
}

/// A joint whose closing brace has not been read.
#[derive(Clone, Debug)]
struct OpenNode {
    index: usize,
    has_offset: bool,
    has_channels: bool,
}

#[derive(Clone, Debug, Default)]
struct Reader {
    expected: Expected,
    motion: Motion,
    open: Vec<OpenNode>,
    /// Values of the frame so far.
    values: Vec<f64>,
    frames: u64,
}

impl Reader {
    fn token(
        &mut self,
        token: &[u8],
        line: u64,
        end: u64,
        on_frame: &mut dyn FnMut(&Motion, &[f64], u64),
    ) -> Result<(), BvhError> {
        if self.expected == Expected::Values {
            return self.value(token, line, end, on_frame);
        }
        match self.header(token) {
            Ok(expected) => {
                self.expected = expected;
                Ok(())
            }
            Err(reason) => Err(error(line, reason)),
        }
    }

    fn value(
        &mut self,
        token: &[u8],
        line: u64,
        end: u64,
        on_frame: &mut dyn FnMut(&Motion, &[f64], u64),
    ) -> Result<(), BvhError> {
        let channels = self.motion.skeleton.channel_count();
        if self.frames == self.motion.frame_count || channels == 0 {
            let reason = format!(
                "{} follows the last of {} frames with {channels} values each",
                shown(token),
                self.motion.frame_count
            );
            return Err(error(line, reason));
        }
        let Some(value) = number(token) else {
            let (value, frame) = (self.values.len() + 1, self.frames + 1);
            let reason = format!(
                "value {value} of frame {frame} is {}, not a finite number",
                shown(token)
            );
            return Err(error(line, reason));
        };
        self.values.push(value);
        if self.values.len() == channels {
            self.frames += 1;
            on_frame(&self.motion, &self.values, end);
            self.values.clear();
        }
        Ok(())
    }

    /// Handles a word before the frames and returns what is expected after it.
    fn header(&mut self, token: &[u8]) -> Result<Expected, String> {
        match self.expected {
            Expected::Hierarchy => {
                let token = token
                    .strip_prefix(BYTE_ORDER_MARK.as_bytes())
                    .unwrap_or(token);
                keyword(token, "HIERARCHY", Expected::Root)
            }
            Expected::Root => keyword(token, "ROOT", Expected::Name),
            Expected::Name => {
                let name = String::from_utf8_lossy(token).into_owned();
                self.open_node(Some(name))?;
                Ok(Expected::Brace)
            }
            Expected::Site => {
                let next = keyword(token, "Site", Expected::Brace)?;
                self.open_node(None)?;
                Ok(next)
            }
            Expected::Brace => keyword(token, "{", Expected::Body),
            Expected::Body => self.body(token),
            Expected::Offset(axis) => self.offset(token, axis),
            Expected::ChannelCount => self.channel_count(token),
            Expected::Channel(left) => self.channel(token, left),
            Expected::Motion => keyword(token, "MOTION", Expected::Frames),
            Expected::Frames => match after_keyword(token, "Frames:") {
                Some([]) => Ok(Expected::FrameCount),
                Some(count) => self.frame_count(count),
                None => Err(expected("Frames:", token)),
            },
            Expected::FrameCount => self.frame_count(token),
            Expected::Frame => keyword(token, "Frame", Expected::Time),
            Expected::Time => match after_keyword(token, "Time:") {
                Some([]) => Ok(Expected::FrameTime),
                Some(time) => self.frame_time(time),
                None => Err(expected("Frame Time:", token)),
            },
            Expected::FrameTime => self.frame_time(token),
            Expected::Values => Ok(Expected::Values),
        }
    }

    fn body(&mut self, token: &[u8]) -> Result<Expected, String> {
        let Some(node) = self.open.last_mut() else {
            return Err(expected("MOTION", token));
        };
        let is = |keyword: &str| token.eq_ignore_ascii_case(keyword.as_bytes());
        let is_end_site = self.motion.skeleton.nodes()[node.index].name.is_none();
        if is("OFFSET") && !std::mem::replace(&mut node.has_offset, true) {
            return Ok(Expected::Offset(0));
        }
        if is("CHANNELS") && !is_end_site && !std::mem::replace(&mut node.has_channels, true) {
            return Ok(Expected::ChannelCount);
        }
        if !node.has_offset {
            let name = self.motion.skeleton.nodes()[node.index].name.as_deref();
            let name = shown(name.unwrap_or("End Site").as_bytes());
            return Err(format!(
                "{name} has no offset, write `OFFSET x y z` before {}",
                shown(token)
            ));
        }
        if is("}") {
            self.open.pop();
            return Ok(if self.open.is_empty() {
                Expected::Motion
            } else {
                Expected::Body
            });
        }
        if is("JOINT") && !is_end_site {
            return Ok(Expected::Name);
        }
        if is("End") && !is_end_site {
            return Ok(Expected::Site);
        }
        Err(if is_end_site {
            expected("}", token)
        } else {
            format!(
                "expected `CHANNELS` once, `JOINT`, `End Site` or `}}`, not {}",
                shown(token)
            )
        })
    }

    /// Adds a node below the innermost open one. Its channels follow the channels of all nodes before it.
    fn open_node(&mut self, name: Option<String>) -> Result<(), String> {
        if self.motion.skeleton.nodes().len() == MAX_NODES {
            return Err(format!("there are more than {MAX_NODES} joints"));
        }
        if self.open.len() == MAX_DEPTH {
            return Err(format!("joints are nested deeper than {MAX_DEPTH} levels"));
        }
        let index = self.motion.skeleton.push(Node {
            name,
            parent: self.open.last().map(|node| node.index),
            offset: DVec3::ZERO,
            channels: Vec::new(),
        });
        self.open.push(OpenNode {
            index,
            has_offset: false,
            has_channels: false,
        });
        Ok(())
    }

    fn offset(&mut self, token: &[u8], axis: usize) -> Result<Expected, String> {
        let Some(value) = number(token) else {
            return Err(format!(
                "an offset is three finite numbers, and {} is none",
                shown(token)
            ));
        };
        let node = self.open.last().map(|node| node.index);
        if let Some(node) = node {
            self.motion.skeleton.set_offset(node, axis, value);
        }
        Ok(match axis {
            2 => Expected::Body,
            _ => Expected::Offset(axis + 1),
        })
    }

    fn channel_count(&mut self, token: &[u8]) -> Result<Expected, String> {
        let free = MAX_CHANNELS - self.motion.skeleton.channel_count();
        match whole_number(token) {
            Some(0) => Ok(Expected::Body),
            Some(count) if count <= free as u64 => Ok(Expected::Channel(count as usize)),
            Some(_) => Err(format!("there are more than {MAX_CHANNELS} channels")),
            None => Err(format!("{} is not a number of channels", shown(token))),
        }
    }

    fn channel(&mut self, token: &[u8], left: usize) -> Result<Expected, String> {
        let Some(channel) = channel_named(token) else {
            return Err(format!(
                "{} is not a channel; write as many of `Xposition`, `Yrotation` and the like as the number before them \
                 states",
                shown(token)
            ));
        };
        if let Some(node) = self.open.last() {
            self.motion.skeleton.add_channel(node.index, channel);
        }
        Ok(match left {
            1 => Expected::Body,
            _ => Expected::Channel(left - 1),
        })
    }

    fn frame_count(&mut self, token: &[u8]) -> Result<Expected, String> {
        match whole_number(token) {
            Some(count) if count <= MAX_FRAMES => {
                self.motion.frame_count = count;
                Ok(Expected::Frame)
            }
            _ => Err(format!(
                "{} is not a number of frames from 0 to {MAX_FRAMES}",
                shown(token)
            )),
        }
    }

    fn frame_time(&mut self, token: &[u8]) -> Result<Expected, String> {
        match number(token) {
            Some(seconds) if seconds >= 0.0 => {
                self.motion.frame_time = seconds;
                self.values
                    .reserve_exact(self.motion.skeleton.channel_count());
                Ok(Expected::Values)
            }
            _ => Err(format!("{} is not a frame time in seconds", shown(token))),
        }
    }

    /// Returns `true` if one more word completes the text.
    fn awaits_last_word(&self) -> bool {
        let motion = &self.motion;
        match self.expected {
            Expected::FrameTime => motion.frame_count == 0,
            Expected::Values => {
                self.frames + 1 == motion.frame_count
                    && self.values.len() + 1 == motion.skeleton.channel_count()
            }
            _ => false,
        }
    }

    fn check_complete(&self, line: u64) -> Result<(), BvhError> {
        let missing = match self.expected {
            Expected::Hierarchy => "`HIERARCHY` is missing".to_owned(),
            Expected::Root => "`ROOT` is missing".to_owned(),
            Expected::Motion => "`MOTION` is missing".to_owned(),
            Expected::Frames | Expected::FrameCount => "`Frames:` is missing".to_owned(),
            Expected::Frame | Expected::Time | Expected::FrameTime => {
                "`Frame Time:` is missing".to_owned()
            }
            Expected::Values => return self.check_frames(line),
            _ => format!("{} joints are not closed with `}}`", self.open.len()),
        };
        Err(error(line, format!("the text ends here and {missing}")))
    }

    fn check_frames(&self, line: u64) -> Result<(), BvhError> {
        let channels = self.motion.skeleton.channel_count();
        if self.frames == self.motion.frame_count || channels == 0 {
            return Ok(());
        }
        let reason = format!(
            "the text ends after {} frames and {} of {channels} values; `Frames:` states {}",
            self.frames,
            self.values.len(),
            self.motion.frame_count
        );
        Err(error(line, reason))
    }
}

fn keyword(token: &[u8], keyword: &str, next: Expected) -> Result<Expected, String> {
    if token.eq_ignore_ascii_case(keyword.as_bytes()) {
        Ok(next)
    } else {
        Err(expected(keyword, token))
    }
}

/// Returns the rest of a word after a keyword, compared without case.
fn after_keyword<'a>(token: &'a [u8], keyword: &str) -> Option<&'a [u8]> {
    let (start, rest) = token.split_at_checked(keyword.len())?;
    start
        .eq_ignore_ascii_case(keyword.as_bytes())
        .then_some(rest)
}

fn expected(keyword: &str, token: &[u8]) -> String {
    format!("expected `{keyword}`, not {}", shown(token))
}

fn whole_number(token: &[u8]) -> Option<u64> {
    std::str::from_utf8(token).ok()?.parse().ok()
}
