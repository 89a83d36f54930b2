//! The lines of one step, each encoded once for all clients.

use std::convert::Infallible;
use std::sync::Arc;

use super::frame::text_frame;
use super::kinds::{KindSet, LineKind, ShareKind};
use super::step::SharedStep;
use super::target::ShareFormat;
use crate::capture::protocol::text_line;
use crate::trace::{Stage, angles_json, pose_json};
use ademan_core::contact::Phase;
use ademan_core::estimate::JointAngles;
use ademan_core::hand::{FingerSet, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;
use ademan_core::objects::layout_object;
use ademan_core::time::Timestamp;

/// The kinds of lines without requests.
const PLAIN_KINDS: [LineKind; 4] = [
    LineKind::Plain(ShareFormat::TextLine),
    LineKind::TimedTextLine,
    LineKind::Plain(ShareFormat::Angles),
    LineKind::Plain(ShareFormat::Pose),
];

/// A line of a step.
pub(super) struct Line {
    /// The kind.
    pub kind: LineKind,
    /// `true` if the next line of the kind replaces it.
    pub is_continuous: bool,
    /// The bytes, with the line end.
    pub bytes: Arc<[u8]>,
    /// The frame of a WebSocket, if a client wants it.
    pub frame: Option<Arc<[u8]>>,
}

/// The kinds that at least one client wants.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wanted {
    /// As lines or frames.
    pub kinds: KindSet,
    /// As frames.
    pub frames: KindSet,
}

/// The encoder of the steps of a session.
pub(super) struct LineEncoder {
    /// The first hand of the session.
    first: Side,
    /// `true` once a text line has shown an angle of a finger.
    has_fingers: bool,
    lines: Vec<Line>,
    /// The active layout and its line.
    layout: Arc<Layout>,
    layout_line: Option<Line>,
    /// The number of layouts so far.
    layouts: u64,
    buffer: Vec<u8>,
}

impl LineEncoder {
    /// Creates an encoder for a session whose first hand is `first`.
    pub fn new(first: Side, layout: Arc<Layout>) -> Self {
        Self {
            first,
            has_fingers: false,
            lines: Vec::new(),
            layout,
            layout_line: None,
            layouts: 1,
            buffer: Vec::new(),
        }
    }

    /// Encodes the wanted lines of a step.
    pub fn encode(&mut self, step: &SharedStep, wanted: &Wanted) -> &[Line] {
        self.lines.clear();
        if let Some(layout) = &step.layout
            && !Arc::ptr_eq(layout, &self.layout)
        {
            self.change_layout(layout);
        }
        for kind in PLAIN_KINDS {
            if wanted.kinds.contains(kind) && self.write_plain(step, kind) {
                self.add(kind, true, wanted);
            }
        }
        for &kind in ShareKind::ALL {
            if wanted.kinds.contains(LineKind::Object(kind)) {
                self.add_objects(step, kind, wanted);
            }
        }
        &self.lines
    }

    fn change_layout(&mut self, layout: &Arc<Layout>) {
        self.layout = Arc::clone(layout);
        let before = self.layout_line.take();
        // A reload of a file may change nothing that clients see.
        let is_same = before.is_some_and(|before| before.bytes == self.layout().bytes);
        if !is_same {
            self.layouts += 1;
        }
    }

    /// Returns the line of the active layout.
    pub fn layout(&mut self) -> &Line {
        self.layout_line.get_or_insert_with(|| {
            let bytes = layout_object(&self.layout);
            let frame = text_frame(&bytes);
            Line {
                kind: LineKind::Object(ShareKind::Layout),
                is_continuous: false,
                bytes: bytes.into(),
                frame: Some(frame),
            }
        })
    }

    /// Returns the number of the active layout. No other layout has the same number.
    pub fn layout_number(&self) -> u64 {
        self.layouts
    }

    /// Writes the line of a kind without requests into the buffer. Returns `false` if the step has none.
    fn write_plain(&mut self, step: &SharedStep, kind: LineKind) -> bool {
        let Some((angles, pose)) = step.hand() else {
            return false;
        };
        match kind {
            LineKind::Plain(ShareFormat::TextLine) => self.write_text_line(angles, pose, None),
            LineKind::TimedTextLine => self.write_text_line(angles, pose, Some(step.shared_at)),
            LineKind::Plain(ShareFormat::Angles) => {
                angles_json(pose, angles, &mut self.buffer);
                self.buffer.push(b'\n');
                true
            }
            _ => {
                pose_json(pose, &mut self.buffer);
                self.buffer.push(b'\n');
                true
            }
        }
    }

    /// Writes a text line, which shows the first hand. Returns `false` while that hand is lost: a line has a number for each angle, so
    /// a receiver would take them for a hand that is still there.
    fn write_text_line(
        &mut self,
        angles: &JointAngles,
        pose: &HandPose,
        time: Option<Timestamp>,
    ) -> bool {
        if pose.side != self.first || self.is_lost(angles, pose) {
            return false;
        }
        self.buffer.clear();
        text_line::write(angles, time, &mut self.buffer);
        true
    }

    /// Returns `true` if the hand is nowhere, or if none of the fingers that were measured is trusted.
    fn is_lost(&mut self, angles: &JointAngles, pose: &HandPose) -> bool {
        self.has_fingers |= angles.known().any(|(dof, _)| dof.finger().is_some());
        let has_lost_fingers = self.has_fingers && pose.untrusted == FingerSet::ALL;
        pose.known().next().is_none() || has_lost_fingers
    }

    fn add_objects(&mut self, step: &SharedStep, kind: ShareKind, wanted: &Wanted) {
        let line_kind = LineKind::Object(kind);
        if kind == ShareKind::Scene {
            self.buffer.clear();
            step.scene.write(&mut self.buffer);
            // A step without a reading changes the state.
            self.add(line_kind, step.snapshot.reading.is_some(), wanted);
            return;
        }
        let Some(stage) = kind.stage() else {
            return;
        };
        let mut touches = step.snapshot.touches.iter();
        let mut object = Vec::new();
        let Ok(()) = stage.for_each_json(&step.snapshot, &mut object, |_, object| {
            let is_continuous = match stage {
                Stage::Touches => touches.next().is_some_and(|it| it.phase == Phase::Moved),
                Stage::Presses | Stage::Events | Stage::Commands => false,
                _ => true,
            };
            self.buffer.clear();
            let kind = kind.name();
            self.buffer.extend_from_slice(br#"{"kind":""#);
            self.buffer.extend_from_slice(kind.as_bytes());
            self.buffer.push(b'"');
            self.buffer.push(b',');
            self.buffer.extend_from_slice(&object[1..]);
            self.buffer.push(b'\n');
            self.add(line_kind, is_continuous, wanted);
            Ok::<_, Infallible>(())
        });
    }

    /// Adds the line in the buffer.
    fn add(&mut self, kind: LineKind, is_continuous: bool, wanted: &Wanted) {
        let is_framed = wanted.frames.contains(kind);
        self.lines.push(Line {
            kind,
            is_continuous,
            bytes: self.buffer.as_slice().into(),
            frame: is_framed.then(|| text_frame(&self.buffer)),
        });
    }
}
