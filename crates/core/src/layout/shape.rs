//! Shapes: meshes that hang on a joint of the hand and move with a value.
//!
//! Only the reference and the motion are here. The mesh is read by the program that draws it, from the folder of the layout.

use glam::{Quat, Vec3};
use serde::Deserialize;

use super::quantity::{Factor, MeshTurn, MeshUnit, Offset, metres};
use crate::document::{Document, DocumentError, Spanned, schema};
use crate::hand::Joint;
use crate::names::UnknownName;

/// The largest number of movements of a shape.
const MAX_MOVES: usize = 4;

/// The longest name of a file, in bytes.
const MAX_FILE_BYTES: usize = 128;

/// The formats of meshes, by the end of the name of their file.
const FORMATS: [&str; 3] = ["obj", "gltf", "glb"];

schema! {
    /// A mesh on a joint of the hand, which moves with a value.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Shape", deny_unknown_fields)]
    pub(in crate::layout) struct ShapeSchema<'a> {
        /// File in the folder of this one: `.obj`, `.gltf` or `.glb`.
        #[serde(borrow)]
        file: Spanned<'a>,
        /// Joint that carries it, such as `"middle-finger-phalanx-proximal"`.
        #[serde(borrow)]
        joint: Spanned<'a>,
        /// Position of its origin from the joint: along the bone to the fingertips, out of the palm, towards the thumb.
        #[serde(default)]
        at_mm: (Offset, Offset, Offset),
        /// Length of a unit of the file.
        #[serde(default)]
        unit_mm: MeshUnit,
        /// Up to 4 movements from value 0 to value 1, one after the other.
        #[serde(default)]
        moves: Vec<MoveSchema>,
    }
}

schema! {
    /// A movement of a mesh from value 0 to value 1, along the axes of `at_mm`.
    #[derive(Clone, Copy, Debug, Deserialize)]
    #[serde(rename = "Move", deny_unknown_fields)]
    enum MoveSchema {
        /// Moves it.
        Slide {
            /// The way.
            by_mm: (Offset, Offset, Offset),
        },
        /// Turns it about an axis through its origin, counter-clockwise seen from the end of the axis.
        Rotate {
            /// Direction of the axis.
            axis: (Offset, Offset, Offset),
            /// Angle.
            by_deg: MeshTurn,
        },
        /// Stretches it from its origin.
        Scale {
            /// Factors along the three axes at value 0.
            from: (Factor, Factor, Factor),
            /// Factors at value 1.
            to: (Factor, Factor, Factor),
        },
    }
}

/// A mesh on a joint of the hand, which moves with a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The name of the file: relative to the folder of the layout and inside it.
    pub file: String,
    /// The joint that carries it.
    pub joint: Joint,
    /// The position of its origin in the frame of the joint, in metres.
    pub offset: Vec3,
    /// The length of a unit of the file, in metres.
    pub unit: f32,
    /// The movements, in the order in which they apply.
    pub moves: Vec<ShapeMove>,
}

/// A movement of a mesh from value 0 to value 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeMove {
    /// A displacement, in metres.
    Slide(Vec3),
    /// A turn about a unit vector, in radians.
    Rotate(Vec3, f32),
    /// Factors along the axes at value 0 and at value 1.
    Scale(Vec3, Vec3),
}

impl Shape {
    /// Returns a point of the file in the frame of the joint of a right hand, at a value, −1..=1. In metres: X along the bone to the
    /// fingertips, Y out of the palm, Z towards the thumb. For a left hand, Z is reversed.
    pub fn place(&self, point: Vec3, value: f32) -> Vec3 {
        let moved = self
            .moves
            .iter()
            .fold(point * self.unit, |point, it| match *it {
                ShapeMove::Slide(way) => point + way * value,
                ShapeMove::Rotate(axis, angle) => {
                    Quat::from_axis_angle(axis, angle * value) * point
                }
                // A negative value would turn the mesh inside out.
                ShapeMove::Scale(from, to) => point * from.lerp(to, value.max(0.0)),
            });
        moved + self.offset
    }
}

impl ShapeSchema<'_> {
    /// Returns the checked shape.
    pub(in crate::layout) fn build(&self, document: &Document) -> Result<Shape, DocumentError> {
        let file = self.file.text;
        check_file(file).map_err(|message| document.error_at(file, message))?;
        let joint = self.joint.text;
        let checked = joint.parse();
        let checked = checked.map_err(|error: UnknownName| document.error_at(joint, error))?;
        if self.moves.len() > MAX_MOVES {
            let message = format!("a shape has at most {MAX_MOVES} moves");
            return Err(document.error_at(file, message));
        }
        let moves = self.moves.iter().map(|it| it.check());
        let moves: Result<_, _> = moves.collect();
        Ok(Shape {
            file: file.to_owned(),
            joint: checked,
            offset: position(self.at_mm),
            unit: metres(self.unit_mm.get()),
            moves: moves.map_err(|message: String| document.error_at(file, message))?,
        })
    }
}

impl MoveSchema {
    fn check(&self) -> Result<ShapeMove, String> {
        let factors = |(x, y, z): (Factor, Factor, Factor)| {
            Vec3::new(x.get() as f32, y.get() as f32, z.get() as f32)
        };
        Ok(match *self {
            Self::Slide { by_mm } => ShapeMove::Slide(position(by_mm)),
            Self::Rotate { axis, by_deg } => {
                let axis = position(axis).try_normalize();
                let axis =
                    axis.ok_or("the axis of `Rotate` needs a direction, such as (1, 0, 0)")?;
                ShapeMove::Rotate(axis, by_deg.get().to_radians() as f32)
            }
            Self::Scale { from, to } => ShapeMove::Scale(factors(from), factors(to)),
        })
    }
}

fn position((x, y, z): (Offset, Offset, Offset)) -> Vec3 {
    Vec3::new(metres(x.get()), metres(y.get()), metres(z.get()))
}

/// Checks that a name cannot leave the folder of the layout, on any system.
fn check_file(file: &str) -> Result<(), String> {
    if file.len() > MAX_FILE_BYTES {
        return Err(format!(
            "the name of a mesh has at most {MAX_FILE_BYTES} bytes"
        ));
    }
    let parts = || file.split('/');
    let is_inside = parts().all(|part| !part.is_empty() && part != "." && part != "..")
        && !file.contains(['\\', ':', '\0']);
    if !is_inside {
        return Err(
            "a mesh lies in the folder of this file or below it: write its name with `/` between folders, without `..`, drive or `\\`"
                .into(),
        );
    }
    let end = file.rsplit_once('.').map_or("", |(_, end)| end);
    if FORMATS
        .iter()
        .any(|format| end.eq_ignore_ascii_case(format))
    {
        Ok(())
    } else {
        Err("a mesh is a file in `.obj`, `.gltf` or `.glb`".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_leave_the_folder_are_rejected() {
        for file in ["claw.obj", "meshes/claw.GLB", "a b/ñ.gltf"] {
            assert_eq!(check_file(file), Ok(()), "{file}");
        }
        for file in [
            "../claw.obj",
            "a/../../claw.obj",
            "/etc/claw.obj",
            "C:claw.obj",
            "a\\claw.obj",
            "a//claw.obj",
            "./claw.obj",
            "claw.stl",
            "claw",
            "obj",
            "",
            "a\0.obj",
        ] {
            assert!(check_file(file).is_err(), "{file}");
        }
        assert!(check_file(&format!("{}.obj", "a".repeat(200))).is_err());
    }

    fn shape(moves: Vec<ShapeMove>) -> Shape {
        Shape {
            file: "a.obj".into(),
            joint: Joint::Wrist,
            offset: Vec3::new(0.0, 0.01, 0.0),
            unit: 1e-3,
            moves,
        }
    }

    #[track_caller]
    fn assert_near(found: Vec3, expected: [f32; 3]) {
        assert!(found.distance(Vec3::from_array(expected)) < 1e-6, "{found}");
    }

    #[test]
    fn a_shape_slides_turns_and_grows_with_the_value() {
        let point = Vec3::new(10.0, 0.0, -20.0);
        assert_near(shape(Vec::new()).place(point, 0.7), [0.01, 0.01, -0.02]);
        let slide = shape(vec![ShapeMove::Slide(Vec3::new(0.0, 0.0, -0.1))]);
        assert_near(slide.place(point, 0.0), [0.01, 0.01, -0.02]);
        assert_near(slide.place(point, 0.5), [0.01, 0.01, -0.07]);
        // A quarter of a turn about Y takes X to −Z and −Z to −X.
        let turn = shape(vec![ShapeMove::Rotate(
            Vec3::Y,
            std::f32::consts::FRAC_PI_2,
        )]);
        assert_near(turn.place(point, 1.0), [-0.02, 0.01, -0.01]);
        let scale = shape(vec![ShapeMove::Scale(Vec3::ZERO, Vec3::new(1.0, 1.0, 2.0))]);
        assert_near(scale.place(point, 0.5), [0.005, 0.01, -0.02]);
        assert_near(scale.place(point, -1.0), [0.0, 0.01, 0.0]);
    }

    #[test]
    fn moves_apply_in_their_order() {
        let (slide, turn) = (
            ShapeMove::Slide(Vec3::X * 0.1),
            ShapeMove::Rotate(Vec3::Z, std::f32::consts::FRAC_PI_2),
        );
        assert_near(
            shape(vec![slide, turn]).place(Vec3::ZERO, 1.0),
            [0.0, 0.11, 0.0],
        );
        assert_near(
            shape(vec![turn, slide]).place(Vec3::ZERO, 1.0),
            [0.1, 0.01, 0.0],
        );
    }
}
