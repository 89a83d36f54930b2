//! Faces on the board that is being built.

use parry3d::math::Vec2;

use super::LayoutBuilder;
use crate::contact::TargetId;
use crate::contact::board_pose::AutoRecenter;
use crate::contact::surface::{Anchor, Shape, Share, TREMOR_MARGIN, Target};
use crate::device::keyboard::Activation;
use crate::document::{DocumentError, Spanned, line_number};
use crate::hand::{Finger, FingerSet, Side};
use crate::layout::board_shape::BoardShape;
use crate::layout::fit::PoseFit;
use crate::layout::gaps::Neighborhood;
use crate::layout::model::{Board, Face};
use crate::layout::outline::{Outline, overlapping_pairs};
use crate::layout::placement::KeyPose;
use crate::layout::quantity::{Offset, PressAt, ReleaseAt, Travel, metres, position};
use crate::layout::schema::{ContactSchema, Label, OutlineSchema, PressSchema};

/// The settings of a board that its keys and controls use.
#[derive(Clone, Copy)]
pub(in crate::layout) struct BoardSettings {
    /// Flat or curved.
    pub shape: BoardShape,
    /// Scale of positions and sizes, including the scale of the fit.
    pub scale: f32,
    /// Fit to the hand.
    pub fit: PoseFit,
    /// Default outline.
    pub size: OutlineSchema,
    /// Default travel.
    pub travel: Travel,
    /// Default press point.
    pub press_at: PressAt,
    /// Default release point.
    pub release_at: ReleaseAt,
    /// The way in which fingers press the keys.
    pub contact: ContactSchema,
    /// The moment and the place of a press.
    pub press: PressSchema,
    /// See [`Board::swipe`].
    pub swipe: bool,
    /// The largest share of a key in the gaps around it, in metres.
    pub max_share: f32,
}

/// The largest share of a key on a board beside others of the same hand, in metres: half the gap between keys of a desktop
/// keyboard. The boards may move against each other, and a thumb that presses a key of the one must not press one of the other.
pub(in crate::layout) const SHARE_BESIDE_BOARDS: f32 = 1e-3;

/// The part of a key by which the keys at the edge of a board reach for strokes: a stroke is made on purpose.
const STROKE_SHARE: f32 = 1.0;

/// The margin of keys, in metres: a fingertip slides by 1 to 4 mm under pressure, and more at the end of a fast stroke.
const SLIP_MARGIN: f32 = 0.006;

/// The largest number of overlaps of one board that are reported: each searches the text for its line.
const MAX_OVERLAPS: usize = 200;

/// The board that is being built.
pub(super) struct BoardDraft<'a> {
    settings: BoardSettings,
    targets: Vec<Target>,
    /// The fingers that press the targets by bending, in their order.
    bent_by: Vec<Finger>,
    /// The faces in the plane of the board, with the ids of their targets.
    outlines: Vec<(Outline, TargetId, Source<'a>)>,
    /// The keys in the plane of the board: indices of their targets and outlines.
    keys_in_plane: Vec<(usize, usize)>,
    first_key: usize,
    first_control: usize,
    /// Number of parts that failed before this board.
    failed_before: usize,
}

/// A target for messages.
#[derive(Clone, Copy)]
struct Source<'a> {
    kind: &'static str,
    name: &'a str,
    slice: &'a str,
}

/// The face of a target on the current board, as written.
pub(in crate::layout) struct FaceSpec<'a> {
    /// Kind of control, for messages.
    pub kind: &'static str,
    /// Name of the target.
    pub name: &'a str,
    /// Position in the file: a slice of the document.
    pub source: &'a str,
    /// Text drawn on it.
    pub label: String,
    /// Center.
    pub at_mm: (Offset, Offset),
    /// Offset from `at_mm` along the row, in metres before scaling.
    pub row_offset: f32,
    /// Displacement by the fit, in metres on the board.
    pub fit_offset: Vec2,
    /// Rotation in the plane of the board, in radians, counter-clockwise.
    pub rotation: f32,
    /// Outline.
    pub size: OutlineSchema,
    /// Travel.
    pub travel: Travel,
    /// Press point.
    pub press_at: PressAt,
    /// Release point.
    pub release_at: ReleaseAt,
    /// See [`Target::margin`].
    pub margin: f32,
    /// `true` if it has a share of the gaps around it.
    pub is_key: bool,
}

impl BoardSettings {
    /// Converts a length on the board from millimetres to metres, including the scale.
    pub fn metres(&self, millimetres: f64) -> f32 {
        (millimetres * f64::from(self.scale) * 1e-3) as f32
    }
}

impl Default for BoardDraft<'_> {
    fn default() -> Self {
        let settings = BoardSettings {
            shape: BoardShape::Flat,
            scale: 1.0,
            fit: PoseFit::NONE,
            size: OutlineSchema::default(),
            travel: Travel::default(),
            press_at: PressAt::default(),
            release_at: ReleaseAt::default(),
            contact: ContactSchema::default(),
            press: PressSchema::Plane,
            swipe: false,
            max_share: 0.0,
        };
        Self {
            settings,
            targets: Vec::new(),
            bent_by: Vec::new(),
            outlines: Vec::new(),
            keys_in_plane: Vec::new(),
            first_key: 0,
            first_control: 0,
            failed_before: 0,
        }
    }
}

impl<'a> LayoutBuilder<'a> {
    /// Starts a board. Faces, keys and controls are added to it until [`end_board`](Self::end_board).
    pub fn begin_board(&mut self, settings: BoardSettings) {
        self.board = BoardDraft {
            settings,
            first_key: self.keys.len(),
            first_control: self.controls.len(),
            failed_before: self.failed,
            ..BoardDraft::default()
        };
    }

    /// Returns the settings of the board that was started last.
    pub fn board(&self) -> BoardSettings {
        self.board.settings
    }

    /// Completes the board. Rejects a board without keys and controls, and reports faces that overlap. The board is added in any
    /// case, so that boards have the indices of the file.
    pub fn end_board(
        &mut self,
        name: Option<&str>,
        side: Option<Side>,
        anchor: Anchor,
        anchor_from_board: parry3d::math::Pose,
        pitch_mm: f64,
        auto_recenter: Option<AutoRecenter>,
    ) -> Result<(), DocumentError> {
        // With more overlaps the layout is not used, and each key may be the neighbor of all others.
        if self.report_overlaps() < MAX_OVERLAPS {
            self.board.share_gaps();
        }
        let draft = std::mem::take(&mut self.board);
        let board = Board {
            name: name.map(str::to_owned),
            keys: draft.first_key..self.keys.len(),
            controls: draft.first_control..self.controls.len(),
            pitch: metres(pitch_mm) * draft.settings.scale,
            shape: draft.settings.shape,
            swipe: draft.settings.swipe,
            auto_recenter,
        };
        let is_empty = board.keys.is_empty() && board.controls.is_empty();
        let checked = if is_empty {
            self.empty_board(&draft)
        } else {
            self.check_contact(side, &draft)
        };
        // A board with faults has keys without a finger, which can be drawn all the same.
        let all_bent = draft.bent_by.len() == draft.targets.len();
        match draft.settings.contact {
            ContactSchema::Bend if all_bent => {
                let targets = draft.bent_by.into_iter().zip(draft.targets);
                self.scene
                    .add_bend_surface(side, anchor, anchor_from_board, targets)
            }
            _ => {
                let targets = draft.targets;
                self.scene
                    .add_surface_for(side, anchor, anchor_from_board, targets)
            }
        };
        let struck_by = match (draft.settings.contact, draft.settings.press) {
            (ContactSchema::Bend, _) | (_, PressSchema::Plane) => FingerSet::NONE,
            (_, PressSchema::ThumbStroke) => FingerSet::NONE.with(Finger::Thumb),
            (_, PressSchema::Stroke) => FingerSet::ALL,
        };
        if !struck_by.is_empty() {
            self.strike_keys(board.keys.clone(), struck_by);
        }
        self.boards.push(board);
        checked
    }

    /// Makes strokes of fingers press the keys, except keys that wait for a fingertip to dwell.
    fn strike_keys(&mut self, keys: std::ops::Range<usize>, fingers: FingerSet) {
        for key in &self.keys[keys] {
            if !matches!(key.activation, Activation::Dwell(_)) {
                self.scene.set_struck(key.face.target, fingers);
            }
        }
    }

    fn empty_board(&self, draft: &BoardDraft) -> Result<(), DocumentError> {
        if self.failed > draft.failed_before {
            return Err(self.consequence());
        }
        let message = format!("board {} has no keys", self.boards.len() + 1);
        Err(self.error(self.name.text, message))
    }

    /// Returns a face with the defaults of the board.
    pub fn face_spec(
        &self,
        kind: &'static str,
        name: Spanned<'a>,
        label: &Option<Label>,
        at_mm: (Offset, Offset),
    ) -> FaceSpec<'a> {
        let board = self.board();
        FaceSpec {
            kind,
            name: name.text,
            source: name.text,
            label: Label::or_name(label, name),
            at_mm,
            row_offset: 0.0,
            fit_offset: Vec2::ZERO,
            rotation: 0.0,
            size: board.size,
            travel: board.travel,
            press_at: board.press_at,
            release_at: board.release_at,
            margin: TREMOR_MARGIN,
            is_key: false,
        }
    }

    /// Adds a face in the plane of the board.
    pub fn add_face(&mut self, spec: FaceSpec<'a>) -> Result<Face, DocumentError> {
        self.add_posed_face(spec, KeyPose::default())
    }

    /// Adds a face that may stand out of the board or be inclined.
    pub fn add_posed_face(
        &mut self,
        spec: FaceSpec<'a>,
        pose: KeyPose,
    ) -> Result<Face, DocumentError> {
        let target = self.add_target(spec.kind, spec.name, spec.source)?;
        let board = self.board();
        let row_position = position(spec.at_mm) + Vec2::X * spec.row_offset;
        // A face that does not fit is reported and drawn all the same.
        if let Err(error) = self.check_face(&spec, row_position) {
            self.report(error, &[target]);
        }
        let shape = spec.size.shape(board.scale);
        let row_position = row_position * board.scale + spec.fit_offset;
        let mut outline = board.shape.outline(row_position, shape).unwrap_or_else(|| {
            let error = self.error(spec.source, out_of_shape(&spec, board.shape));
            self.report(error, &[target]);
            Outline {
                center: row_position,
                rotation: 0.0,
                shape,
            }
        });
        outline.rotation += spec.rotation + pose.rotation.z;
        let target_pose = board.shape.surface_from_tangent(&outline) * pose.tangent_from_target();
        if pose.is_in_plane() {
            let source = Source {
                kind: spec.kind,
                name: spec.name,
                slice: spec.source,
            };
            self.board.outlines.push((outline, target, source));
            if spec.is_key {
                let target_index = self.board.targets.len();
                let outline_index = self.board.outlines.len() - 1;
                self.board.keys_in_plane.push((target_index, outline_index));
            }
        }
        let margin = if spec.is_key {
            SLIP_MARGIN.min(smallest_half(shape)).max(TREMOR_MARGIN)
        } else {
            spec.margin
        };
        self.board.targets.push(Target {
            shape,
            share: Share::NONE,
            surface_from_target: target_pose,
            travel: metres(spec.travel.get()),
            press_at: spec.press_at.get() as f32,
            release_at: spec.release_at.get() as f32,
            margin,
        });
        Ok(Face {
            name: spec.name.to_owned(),
            label: spec.label,
            target,
            row_position,
            outline,
        })
    }

    fn check_face(&self, spec: &FaceSpec, row_position: Vec2) -> Result<(), DocumentError> {
        let FaceSpec { kind, name, .. } = spec;
        let max = *Offset::RANGE.end();
        if row_position.abs().max_element() > metres(max) {
            let message =
                format!("the {kind} `{name}` is more than {max} mm from the center of its board");
            return Err(self.error(spec.source, message));
        }
        let (press_at, release_at) = (spec.press_at.get(), spec.release_at.get());
        if press_at <= release_at {
            let message = format!(
                "press_at {press_at} of the {kind} `{name}` must be greater than release_at {release_at}"
            );
            return Err(self.error(spec.source, message));
        }
        Ok(())
    }

    /// Adds the finger of the key that was added last, on a board whose keys are pressed by bending.
    pub fn add_bent_finger(&mut self, name: &'a str, finger: Finger) -> Result<(), DocumentError> {
        if self.board.bent_by.contains(&finger) {
            let message = format!(
                "the key `{name}` is the second one of the {finger} finger: a finger that bends presses one key, use chords and layers"
            );
            return Err(self.error(name, message));
        }
        self.board.bent_by.push(finger);
        Ok(())
    }

    /// Rejects keys without a finger on a board that is pressed by bending, and such a board beside others of the same hand: a
    /// finger that touches a key bends too.
    fn check_contact(&self, side: Option<Side>, draft: &BoardDraft) -> Result<(), DocumentError> {
        let name = self.name.text;
        let is_bent = draft.settings.contact == ContactSchema::Bend;
        if self.failed > draft.failed_before {
            return Err(self.consequence());
        }
        if is_bent && draft.bent_by.len() != draft.targets.len() {
            let message = "a board with `contact: Bend` has only `keys`, each with a `finger`";
            return Err(self.error(name, message));
        }
        let mut others = self.scene.surfaces().iter();
        let conflicts = others.any(|other| {
            let shares_hand = side.is_none() || other.side().is_none() || other.side() == side;
            is_bent != other.is_bent() || is_bent && shares_hand
        });
        if conflicts {
            let message = "beside a board with `contact: Bend` there can only be another such board, for the other `hand`";
            return Err(self.error(name, message));
        }
        Ok(())
    }

    /// Reports faces that overlap, at most [`MAX_OVERLAPS`] pairs. Returns the number of pairs.
    fn report_overlaps(&mut self) -> usize {
        let faces = std::mem::take(&mut self.board.outlines);
        let outlines: Vec<Outline> = faces.iter().map(|(it, _, _)| *it).collect();
        let pairs = overlapping_pairs(&outlines, MAX_OVERLAPS);
        for &(first, second) in &pairs {
            let (outline, target, first) = faces[first];
            let (other, other_target, second) = faces[second];
            let line = line_number(&self.document.text, first.slice);
            let depth_mm = (f64::from(outline.overlap_depth(&other)) * 1e5).round() / 1e2;
            let message = format!(
                "the {} `{}` overlaps the {} `{}` of line {line} by {depth_mm} mm",
                second.kind, second.name, first.kind, first.name
            );
            let error = self.error(second.slice, message);
            self.report(error, &[other_target, target]);
        }
        self.board.outlines = faces;
        pairs.len()
    }
}

impl BoardDraft<'_> {
    /// Gives each key in the plane of the board its share of the gaps around it.
    fn share_gaps(&mut self) {
        let max = self.settings.max_share;
        if max <= 0.0 {
            return;
        }
        let outlines: Vec<Outline> = self.outlines.iter().map(|(it, _, _)| *it).collect();
        let neighbors = Neighborhood::new(&outlines);
        let part = match self.settings.press {
            PressSchema::Plane | PressSchema::ThumbStroke => 0.5,
            PressSchema::Stroke => STROKE_SHARE,
        };
        for &(target, outline) in &self.keys_in_plane {
            self.targets[target].share = neighbors.share(outline, part, max);
        }
    }
}

fn smallest_half(shape: Shape) -> f32 {
    match shape {
        Shape::Box(half) => half.min_element(),
        Shape::Disc(radius) => radius,
    }
}

/// Returns the message for a face that does not fit on a curved board.
fn out_of_shape(spec: &FaceSpec, shape: BoardShape) -> String {
    let FaceSpec { kind, name, .. } = spec;
    match shape {
        BoardShape::CurvedRows(_) | BoardShape::CurvedColumns(_) => {
            format!("the {kind} `{name}` is more than half a turn around its cylinder")
        }
        BoardShape::Flat | BoardShape::Arc(_) => {
            format!("the {kind} `{name}` is beyond the ends of its arc")
        }
    }
}
