//! The edits of a layout, as functions from a text to replacements in it.

use super::add::NewPart;
use super::arrange::{AlignEdge, BoardAxis, PlaceTo};
use super::bind::{Binding, Slot, bind};
use super::draft::{Draft, Edited};
use super::error::EditError;
use super::part::Part;
use super::patch::Patch;
use super::{
    add, along_arc, arrange, clipboard, delete, duplicate, fields, geometry, in_space, rename,
    scale,
};

/// An edit of a layout. Lengths in millimetres and angles in degrees of the file.
///
/// A key of a row has no position and options of its own: if the whole row is among the parts, the row is edited; otherwise its
/// key becomes a single key first, and the row is split around it. Deleting it, and binding it to another key, only change
/// the row.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Moves parts: to the right, away from the wearer, and up. A control moves along its row and board, and only a key can
    /// move off the board.
    Move {
        /// Keys, controls, rows, boards, spaces or targets in space.
        parts: Vec<Part>,
        /// Distances.
        by_mm: [f64; 3],
    },
    /// Moves parts along the axes of the world: to the right, away from the wearer, and up, whatever their bearings are.
    MoveInSpace {
        /// Boards or targets in space.
        parts: Vec<Part>,
        /// Distances.
        by_mm: [f64; 3],
    },
    /// Changes width and depth. A round part has the width as its diameter.
    Resize {
        /// Keys, controls, rows or targets in space.
        parts: Vec<Part>,
        /// Additional width and depth.
        by_mm: [f64; 2],
        /// The point that stays, from (−1, −1) at the left near corner to (1, 1); (0, 0) is the center.
        fixed: [f64; 2],
    },
    /// Scales positions and sizes of controls of one board about a point of their common outline. A round one stays round, and gets
    /// the smaller factor; a turned one keeps its angle.
    Scale {
        /// Keys, controls or rows.
        parts: Vec<Part>,
        /// Factors along the rows and away from the wearer.
        factors: [f64; 2],
        /// The point that stays, from (−1, −1) at the left near corner to (1, 1); (0, 0) is the center.
        fixed: [f64; 2],
    },
    /// Turns parts about their centers, and boards about their anchors, counter-clockwise.
    Turn {
        /// Keys, sliders, levers, boards or spaces.
        parts: Vec<Part>,
        /// Angle.
        degrees: f64,
    },
    /// Turns boards where they are, counter-clockwise as seen from above: a board on arcs about the center of its arcs, any other
    /// about its (0, 0).
    TurnInSpace {
        /// Boards.
        parts: Vec<Part>,
        /// Angle.
        degrees: f64,
    },
    /// Lifts the far side of boards, spaces or keys.
    Tilt {
        /// Boards, spaces or keys.
        parts: Vec<Part>,
        /// Angle.
        degrees: f64,
    },
    /// Aligns controls of one board along their outlines.
    Align {
        /// The controls, at least two.
        parts: Vec<Part>,
        /// Common line.
        edge: AlignEdge,
    },
    /// Makes the gaps between controls of one board equal. The outermost stay.
    Distribute {
        /// The controls, at least three.
        parts: Vec<Part>,
        /// Direction of the gaps.
        axis: BoardAxis,
    },
    /// Mirrors controls of one board about the middle of their common outline.
    Mirror {
        /// Keys, controls or rows.
        parts: Vec<Part>,
        /// Direction in which positions are exchanged.
        axis: BoardAxis,
    },
    /// Moves the centers of controls to a grid.
    Snap {
        /// Keys, controls or rows.
        parts: Vec<Part>,
        /// Distance of its lines.
        grid_mm: f64,
    },
    /// Sets positions and sizes of several controls to the same value, each number that is given.
    Place {
        /// Keys, controls or rows.
        parts: Vec<Part>,
        /// Place and size.
        place: PlaceTo,
    },
    /// Copies parts in columns and rows at equal distances. The selected parts are the first of both.
    Repeat {
        /// Keys and other controls.
        parts: Vec<Part>,
        /// Columns and rows, with the first.
        count: [usize; 2],
        /// Distances to the right and away from the wearer.
        pitch_mm: [f64; 2],
    },
    /// Copies controls along an arc of a circle, turned with it where they can be turned. The selected ones are the first; the
    /// center of the circle is towards the wearer from their middle.
    RepeatAlongArc {
        /// Keys, controls or rows.
        parts: Vec<Part>,
        /// Their number, with the first.
        count: usize,
        /// Angle from one to the next, to the right.
        step_deg: f64,
        /// Radius; a negative one has its center on the far side.
        radius_mm: f64,
    },
    /// Adds copies of controls, or of boards, triggers and targets in space, from a text that [`copied`](super::copied) has made, with
    /// their labels and signals.
    Paste {
        /// The board that gets controls. A layout without boards gets one.
        board: usize,
        /// The text.
        text: String,
        /// Offset from their places in the text, as for [`Duplicate`](Self::Duplicate).
        by_mm: [f64; 2],
    },
    /// Copies parts under new names, with their labels, signals and entries in layers. The keys of a row, and of the rows of a
    /// board, become single keys. A copied board is offset along the axes of the world, whatever its bearing is.
    Duplicate {
        /// Keys, controls, rows, boards, triggers or targets in space.
        parts: Vec<Part>,
        /// Offset of the copies, to the right and away from the wearer.
        by_mm: [f64; 2],
    },
    /// Deletes parts, with their signals. With a key, also its label, its entries in layers, and the chords that it takes part in. A radio
    /// group without its `initial` option has none.
    Delete {
        /// Any parts but the layout.
        parts: Vec<Part>,
    },
    /// Sets the action of a part.
    Bind {
        /// A key or another part with actions.
        part: Part,
        /// The action that is set.
        slot: Slot,
        /// `None` removes the action.
        binding: Option<Binding>,
    },
    /// Sets a field by its name in the file, such as `travel_mm`, `pose.tilt_deg` or `when.on_mm`.
    SetField {
        /// Parts with that field.
        parts: Vec<Part>,
        /// Name, with the fields that contain it.
        field: String,
        /// RON text, such as `4.5`, `"x"` or `Box(17, 17)`. `None` removes the field, so that its default applies.
        value: Option<String>,
    },
    /// Changes the name of a part, and every mention of it.
    Rename {
        /// A part with a name.
        part: Part,
        /// New name.
        name: String,
    },
    /// Adds a part with default settings.
    Add(NewPart),
    /// Replaces bytes of the text.
    ReplaceText(Patch),
}

/// Returns what an edit changes in a text. The text need not be a valid layout, but its brackets must be balanced.
pub fn edit(text: &str, edit: &Edit) -> Result<Edited, EditError> {
    if let Edit::ReplaceText(patch) = edit {
        let (text, _) = patch.apply(text).ok_or(EditError::Overlap)?;
        return Ok(Edited {
            patches: vec![patch.clone()],
            text,
            parts: Vec::new(),
        });
    }
    changed(text, |draft| apply(draft, edit))
}

/// Returns what [`Edit::Move`] changes. A program that calls only this and its siblings, such as a page, contains no other edits.
pub fn move_parts(text: &str, parts: &[Part], by_mm: [f64; 3]) -> Result<Edited, EditError> {
    changed(text, |draft| geometry::shift(draft, parts, by_mm))
}

/// Returns what [`Edit::Duplicate`] changes.
pub fn duplicate_parts(text: &str, parts: &[Part], by_mm: [f64; 2]) -> Result<Edited, EditError> {
    changed(text, |draft| duplicate::duplicate(draft, parts, by_mm))
}

/// Returns what [`Edit::Delete`] changes.
pub fn delete_parts(text: &str, parts: &[Part]) -> Result<Edited, EditError> {
    changed(text, |draft| delete::delete(draft, parts))
}

fn changed(
    text: &str,
    change: impl FnOnce(&mut Draft) -> Result<Vec<Part>, EditError>,
) -> Result<Edited, EditError> {
    let mut draft = Draft::new(text)?;
    let parts = change(&mut draft)?;
    draft.finish(parts)
}

fn apply(draft: &mut Draft, edit: &Edit) -> Result<Vec<Part>, EditError> {
    match edit {
        Edit::Move { parts, by_mm } => geometry::shift(draft, parts, *by_mm),
        Edit::MoveInSpace { parts, by_mm } => in_space::shift(draft, parts, *by_mm),
        Edit::Resize {
            parts,
            by_mm,
            fixed,
        } => geometry::resize(draft, parts, *by_mm, *fixed),
        Edit::Scale {
            parts,
            factors,
            fixed,
        } => scale::scale(draft, parts, *factors, *fixed),
        Edit::Turn { parts, degrees } => geometry::turn(draft, parts, *degrees),
        Edit::TurnInSpace { parts, degrees } => in_space::turn(draft, parts, *degrees),
        Edit::Tilt { parts, degrees } => geometry::tilt(draft, parts, *degrees),
        Edit::Align { parts, edge } => arrange::align(draft, parts, *edge),
        Edit::Distribute { parts, axis } => arrange::distribute(draft, parts, *axis),
        Edit::Mirror { parts, axis } => arrange::mirror(draft, parts, *axis),
        Edit::Snap { parts, grid_mm } => arrange::snap(draft, parts, *grid_mm),
        Edit::Place { parts, place } => arrange::place(draft, parts, place),
        Edit::Repeat {
            parts,
            count,
            pitch_mm,
        } => duplicate::repeat(draft, parts, *count, *pitch_mm),
        Edit::RepeatAlongArc {
            parts,
            count,
            step_deg,
            radius_mm,
        } => along_arc::repeat_along_arc(draft, parts, *count, *step_deg, *radius_mm),
        Edit::Paste { board, text, by_mm } => clipboard::paste(draft, *board, text, *by_mm),
        Edit::Duplicate { parts, by_mm } => duplicate::duplicate(draft, parts, *by_mm),
        Edit::Delete { parts } => delete::delete(draft, parts),
        Edit::Bind {
            part,
            slot,
            binding,
        } => bind(draft, *part, slot, binding.as_ref()),
        Edit::SetField {
            parts,
            field,
            value,
        } => fields::set_field(draft, parts, field, value.as_deref()),
        Edit::Rename { part, name } => rename::rename(draft, *part, name),
        Edit::Add(new) => add::add(draft, new),
        Edit::ReplaceText(_) => Ok(Vec::new()),
    }
}
