//! Joysticks as written → checked.

use serde::Deserialize;

use super::{Control, ControlKind};
use crate::contact::surface::DRAG_MARGIN;
use crate::device::joystick;
use crate::device::{Axis, KeyAction};
use crate::document::DocumentError;
use crate::layout::builder::{Checked, Spot};
use crate::layout::model::metres2;
use crate::layout::ranged::{Curve, DeadZone, Distance, PointerSpeed, Reach, Size, Travel};
use crate::layout::schema::{Board, Does, Outline};
use crate::layout::text::{Label, Spanned};

/// The least travel of a joystick that can be pushed in, in millimetres: with less, every touch would be
/// a push.
const LEAST_PUSH_MM: f64 = 10.0;

/// A joystick as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joystick<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// What is drawn on it; else its name.
    #[serde(default)]
    pub label: Option<Label>,
    /// The middle of its cap.
    pub at_mm: (Distance, Distance),
    /// The diameter of its cap.
    pub diameter_mm: Size,
    /// How far it goes down; else as the board says.
    #[serde(default)]
    pub travel_mm: Option<Travel>,
    /// How far it goes to each side.
    #[serde(default)]
    pub reach_mm: Reach,
    /// The share of that within which it stands in the middle.
    #[serde(default)]
    pub dead_zone: DeadZone,
    /// The exponent of the way from there to the end.
    #[serde(default)]
    pub curve: Curve,
    /// What it drives to the right and away from the wearer.
    #[serde(borrow, default)]
    pub axes: Option<(Spanned<'a>, Spanned<'a>)>,
    /// What is pressed while it points to a side.
    #[serde(borrow, default)]
    pub keys: Option<Sides<'a>>,
    /// What is pressed while it is pushed in.
    #[serde(borrow, default)]
    pub press: Option<Does<'a>>,
    /// How fast it moves the pointer.
    #[serde(default)]
    pub moves_px_per_s: Option<PointerSpeed>,
}

/// What is pressed while a joystick points to a side.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sides<'a> {
    /// Away from the wearer.
    #[serde(borrow)]
    pub up: Does<'a>,
    /// Towards the wearer.
    #[serde(borrow)]
    pub down: Does<'a>,
    /// To the left.
    #[serde(borrow)]
    pub left: Does<'a>,
    /// To the right.
    #[serde(borrow)]
    pub right: Does<'a>,
}

impl<'a> Checked<'a> {
    /// Adds a joystick to the board that is being added.
    pub(in crate::layout) fn add_joystick(
        &mut self,
        board: &Board<'a>,
        written: &Joystick<'a>,
    ) -> Result<(), DocumentError> {
        let name = written.name;
        let axes = self.stick_axes(written)?;
        let keys = self.sides(written.keys)?;
        let press = match written.press {
            Some(does) => Some(self.action(does, None)?),
            None => None,
        };
        let speed = written.moves_px_per_s;
        let travel = written.travel_mm.unwrap_or(board.travel_mm);
        let refuse = |message: String| Err(self.document.error_at(name.0, message));
        if axes.is_none() && keys.is_none() && press.is_none() && speed.is_none() {
            return refuse(format!(
                "the joystick `{}` does nothing, give it `axes`, `keys`, `press` or `moves_px_per_s`",
                name.0
            ));
        }
        if press.is_some() && travel.get() < LEAST_PUSH_MM {
            return refuse(format!(
                "the joystick `{}` has a `press` and needs a `travel_mm` of at least {LEAST_PUSH_MM}, not {}: \
                 else every touch is a push",
                name.0,
                travel.get()
            ));
        }
        let reach = board.metres(written.reach_mm.get());
        let front = self.put(
            &board.form,
            Spot {
                what: "joystick",
                word: name,
                name: name.0,
                label: Label::or_name(&written.label, name),
                at: metres2(written.at_mm),
                turn: 0.0,
                size: Outline::Disc(written.diameter_mm),
                travel,
                press: board.press_share,
                release: board.release_share,
                margin: reach + DRAG_MARGIN,
            },
        )?;
        let joystick = joystick::Joystick {
            target: front.target,
            max_deflection: reach,
            dead_zone: written.dead_zone.get() as f32,
            curve: written.curve.get() as f32,
            axes,
            direction_keys: keys,
            push_action: press,
            pointer_speed_px_s: speed.map_or(0.0, |speed| speed.get() as f32),
        };
        self.controls.push(Control {
            faces: vec![front],
            kind: ControlKind::Joystick(joystick),
        });
        Ok(())
    }

    fn stick_axes(&self, written: &Joystick<'a>) -> Result<Option<[Axis; 2]>, DocumentError> {
        let Some((x, y)) = written.axes else {
            return Ok(None);
        };
        let axes = [self.axis(x)?, self.axis(y)?];
        let refuse = |word: Spanned, what: &str| {
            let message = format!("the joystick `{}` {what}", written.name.0);
            Err(self.document.error_at(word.0, message))
        };
        for (word, axis) in [x, y].into_iter().zip(axes) {
            if axis.is_trigger() {
                return refuse(word, "goes to both sides of 0, which a trigger cannot");
            }
        }
        match axes[0] == axes[1] {
            true => refuse(y, "has the same axis to the side and up, name two"),
            false => Ok(Some(axes)),
        }
    }

    fn sides(&mut self, sides: Option<Sides<'a>>) -> Result<Option<[KeyAction; 4]>, DocumentError> {
        let Some(Sides {
            up,
            down,
            left,
            right,
        }) = sides
        else {
            return Ok(None);
        };
        Ok(Some([
            self.action(up, None)?,
            self.action(down, None)?,
            self.action(left, None)?,
            self.action(right, None)?,
        ]))
    }
}
