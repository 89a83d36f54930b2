//! A drag of the mouse on the plan: what it selects, moves, turns, tilts or bends.

use parry3d::math::Vec2;

use super::handles::{self, PlanHandle};
use super::{Plan, PlanItem, PlanView, WrittenPose};
use crate::canvas::Bounds;
use crate::canvas::bend;
use crate::canvas::snap::{Guide, SnapSettings, snap_move};
use crate::editor::{Edit, Part};

/// Distance beside an item at which it is hit, in points.
const HIT_REACH: f32 = 5.0;

/// Angle at which a board that is turned or tilted snaps, in degrees; without snapping, the step of angles.
const ANGLE_STEP: f64 = 5.0;
const FINE_ANGLE_STEP: f64 = 0.1;

/// A drag of the primary button, from its start to its end. It keeps what it starts from: the items change with it.
#[derive(Clone, Debug)]
pub enum PlanGesture {
    /// A rubber band from this point, in addition to what was selected before.
    Band {
        /// The start.
        from: Vec2,
        /// The parts to which it adds.
        before: Vec<Part>,
    },
    /// A motion of the selected items from this point.
    Move {
        /// The start.
        from: Vec2,
        /// The items.
        parts: Vec<Part>,
        /// The rectangle around them.
        bounds: Bounds,
        /// The rectangles of all other items.
        others: Vec<Bounds>,
        /// The position of the pressed item in its file, as far as the axes of the view are its axes.
        on_grid: Vec2,
    },
    /// A drag of a handle of the only selected board from this point.
    Handle {
        /// The start.
        from: Vec2,
        /// The handle.
        handle: PlanHandle,
        /// The board.
        item: Box<PlanItem>,
    },
}

/// The result of a gesture so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanChange {
    /// The edit; `None` if nothing changes.
    pub edit: Option<Edit>,
    /// Lines to which items have snapped.
    pub guides: Vec<Guide>,
    /// The rubber band.
    pub band: Option<Bounds>,
}

/// Selects what a press is on, and starts a gesture. `adds` keeps what is selected, as with Shift. `scale` is in points per
/// millimetre.
pub fn begin(
    plan: &Plan,
    selected: &mut Vec<Part>,
    view: PlanView,
    (point, scale): (Vec2, f32),
    adds: bool,
) -> PlanGesture {
    if let [part] = selected[..]
        && let Some(item) = plan.item(part)
        && let Some(handle) = handles::handle_at(item, view, point, scale)
    {
        return PlanGesture::Handle {
            from: point,
            handle,
            item: Box::new(item.clone()),
        };
    }
    let Some(item) = plan.item_at(view, (point, HIT_REACH / scale), selected) else {
        if !adds {
            selected.clear();
        }
        return PlanGesture::Band {
            from: point,
            before: selected.clone(),
        };
    };
    match (adds, selected.iter().position(|part| *part == item.part)) {
        (true, Some(index)) => _ = selected.remove(index),
        (true, None) => selected.push(item.part),
        // A drag of one of several selected items moves all of them.
        (false, Some(_)) => {}
        (false, None) => *selected = vec![item.part],
    }
    let is_moved = |part: Part| selected.contains(&part);
    // Edges that meet on a picture from an angle need not meet in space.
    let attracts = |part: Part| !view.is_free() && !is_moved(part);
    let others = plan.items.iter().filter(|other| attracts(other.part));
    PlanGesture::Move {
        from: point,
        parts: selected.clone(),
        bounds: plan.bounds(view, is_moved).unwrap_or(item.bounds(view)),
        others: others.map(|other| other.bounds(view)).collect(),
        on_grid: item.written.on_grid(view),
    }
}

impl PlanGesture {
    /// Returns the result with the mouse at a point.
    pub fn change(&self, view: PlanView, point: Vec2, snap: SnapSettings) -> PlanChange {
        match self {
            Self::Band { from, .. } => PlanChange {
                band: Some(Bounds::between(*from, point)),
                ..PlanChange::default()
            },
            Self::Move {
                from,
                parts,
                bounds,
                others,
                on_grid,
            } => {
                let offset = point - *from;
                if offset == Vec2::ZERO {
                    // A press alone moves nothing to the grid.
                    return PlanChange::default();
                }
                // An item that hardly moves is not attracted farther than it has moved.
                let snap = SnapSettings {
                    reach_mm: snap.reach_mm.min(offset.length()),
                    ..snap
                };
                let others = others.iter().copied();
                let snapped = snap_move(*bounds, offset, *on_grid, others, snap);
                PlanChange {
                    edit: moved(view, parts, snapped.offset),
                    guides: snapped.guides,
                    band: None,
                }
            }
            // A press beside the middle of a handle, and a drag that returns there.
            Self::Handle { from, .. } if *from == point => PlanChange::default(),
            Self::Handle { from, handle, item } => {
                let is_snapped = snap.grid_mm > 0.0;
                PlanChange {
                    edit: dragged(item, *handle, view, [*from, point], is_snapped),
                    ..PlanChange::default()
                }
            }
        }
    }

    /// Returns the parts that a rubber band selects at a point.
    pub fn selected(&self, plan: &Plan, view: PlanView, point: Vec2) -> Option<Vec<Part>> {
        let Self::Band { from, before } = self else {
            return None;
        };
        let band = Bounds::between(*from, point);
        let touched = plan.items.iter();
        let touched = touched.filter(|item| item.bounds(view).touches(band));
        let mut selected = before.clone();
        selected.extend(touched.map(|item| item.part));
        Some(selected)
    }
}

/// Returns the edit that moves parts by a distance on the picture, in millimetres; `None` if it is too short to be written.
pub fn moved(view: PlanView, parts: &[Part], offset: Vec2) -> Option<Edit> {
    let offset = offset.to_array().map(|mm| rounded(f64::from(mm), 0.01));
    (offset != [0.0; 2] && !parts.is_empty()).then(|| Edit::MoveInSpace {
        parts: parts.to_vec(),
        by_mm: view.motion(offset),
    })
}

/// Returns the edit of a drag of a handle between two points.
fn dragged(
    item: &PlanItem,
    handle: PlanHandle,
    view: PlanView,
    [from, to]: [Vec2; 2],
    is_snapped: bool,
) -> Option<Edit> {
    let board = item.board()?;
    let parts = vec![item.part];
    let step = if is_snapped {
        ANGLE_STEP
    } else {
        FINE_ANGLE_STEP
    };
    match handle {
        PlanHandle::Turn => {
            let turned = handles::turned_deg(board, view, [from, to])?;
            let old = item.written.bearing_deg;
            let new = rounded(old - f64::from(turned), step);
            let degrees = rounded(old - new, 0.01);
            (degrees != 0.0).then_some(Edit::TurnInSpace { parts, degrees })
        }
        PlanHandle::Tilt => {
            let tilt = handles::tilt_deg(board, view, to)?;
            let new = rounded(f64::from(tilt), step);
            let degrees = rounded(new - item.written.tilt_deg, 0.01);
            (degrees != 0.0).then_some(Edit::Tilt { parts, degrees })
        }
        PlanHandle::Bend => {
            let drawn = handles::drawn_radius_mm(board.shape)?;
            let old = board.radius_mm?;
            let (low, high) = bend::RADII;
            // The hands of the session may have a longer or shorter arm than the file.
            let longer = handles::radius_at(board, view, to) - drawn;
            let new = (old + f64::from(longer))
                .clamp(low.into(), high.into())
                .round();
            (new != old).then(|| Edit::SetField {
                parts,
                field: "shape.radius_mm".to_owned(),
                value: Some(new.to_string()),
            })
        }
    }
}

impl WrittenPose {
    /// Returns the position along those axes of a view that are axes of the frame in the file; 0 along the others.
    fn on_grid(&self, view: PlanView) -> Vec2 {
        let quarters = self.bearing_deg / 90.0;
        if quarters.fract() != 0.0 {
            // Up is up whatever the bearing is.
            let [_, _, up] = self.position_mm;
            return match view {
                PlanView::Above | PlanView::Free { .. } => Vec2::ZERO,
                PlanView::Front | PlanView::Side => Vec2::new(0.0, up as f32),
            };
        }
        let [right, forward, up] = self.position_mm;
        let [x, away] = match quarters.rem_euclid(4.0) as u8 {
            0 => [right, forward],
            1 => [forward, -right],
            2 => [-right, -forward],
            _ => [-forward, right],
        };
        let [x, away, up] = [x, away, up].map(|mm| mm as f32);
        match view {
            PlanView::Above => Vec2::new(x, away),
            PlanView::Front => Vec2::new(x, up),
            PlanView::Side => Vec2::new(away, up),
            PlanView::Free { .. } => Vec2::ZERO,
        }
    }
}

/// Rounds to a multiple of a step.
fn rounded(value: f64, step: f64) -> f64 {
    // The quotient by a reciprocal is exact where the product is not: 0.1 × 3.
    let per_unit = (1.0 / step).round();
    if per_unit >= 1.0 {
        (value * per_unit).round() / per_unit
    } else {
        (value / step).round() * step
    }
}
