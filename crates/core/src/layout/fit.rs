//! The fit of a layout to a hand: boards and volumes of a file are placed for the design hand, and move and grow with
//! another one.

use parry3d::math::Vec3;
use serde::{Deserialize, Serialize};

use super::schema::{AnchorSchema, FitSchema, PoseSchema};
use crate::document::{Document, DocumentError};
use crate::hand::Side;
use crate::kinematics::{ArmModel, HandReach};

/// The arm for which the shipped layouts are drawn. A layout for this arm has the positions and sizes of its file.
const DESIGN_ARM: &str = "unam";

/// The smallest factor for sizes: keys of half the size are too small for any finger.
const MIN_SCALE: f32 = 0.5;
/// The largest factor for sizes, for an arm file with a mistake.
const MAX_SCALE: f32 = 1.5;

/// The largest difference that is accepted from another process, in metres.
const MAX_DIFFERENCE: f32 = 100.0;

/// The fit of a layout to the hands of a setup. A process that draws the layout of another one needs it beside the text.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The hand of everything that is not reserved for one hand.
    first: Side,
    right: HandFit,
    left: HandFit,
}

/// The difference between a hand and the design hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "FitNumbers", into = "FitNumbers")]
struct HandFit {
    /// The difference of [`HandReach::from_elbow`].
    from_elbow: Vec3,
    /// The difference of [`HandReach::from_wrist`].
    from_wrist: Vec3,
    /// The factor for sizes.
    scale: f32,
    /// The differences of [`HandReach::half_bent`].
    fingertips: [Vec3; 5],
}

/// The numbers of a [`HandFit`], field by field: two differences, the factor, and the differences of the fingertips.
type FitNumbers = [f32; 22];

/// The index of the factor in [`FitNumbers`].
const SCALE_INDEX: usize = 6;

/// The fit of one board or volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PoseFit {
    /// Displacement in metres: to the right of the bearing, up, towards the wearer.
    pub shift: Vec3,
    /// Factor for sizes and for distances on the board.
    pub scale: f32,
    /// Displacement of the fingertips relative to the board, in its frame, thumb first; `None` unless the board moves
    /// with the wrist.
    pub fingertips: Option<[Vec3; 5]>,
}

impl Default for Fit {
    /// The fit to the design hand.
    fn default() -> Self {
        Self {
            first: Side::Right,
            right: HandFit::DESIGN,
            left: HandFit::DESIGN,
        }
    }
}

impl Fit {
    /// Returns the fit to the hand of `arm`, and to the hand of `other` if the setup has two hands.
    ///
    /// A model without an elbow, a wrist or an index fingertip has the fit of the design hand.
    pub fn new(arm: &ArmModel, other: Option<&ArmModel>) -> Result<Self, DocumentError> {
        let design = ArmModel::parse(&Document::shipped(DESIGN_ARM)?)?;
        let fit = |side: Side| {
            let other = other.filter(|other| other.side() == side);
            let own = other.unwrap_or(arm).clone().for_side(side);
            let design = design.clone().for_side(side);
            HandFit::between(design.reach(), own.reach())
        };
        Ok(Self {
            first: arm.side(),
            right: fit(Side::Right),
            left: fit(Side::Left),
        })
    }

    /// Returns the position, relative to the elbow and in metres, at which the first hand finds a point for the design
    /// hand. Targets in space with the anchor `elbow` move in the same way.
    pub fn position_from_elbow(&self, point: Vec3) -> Vec3 {
        let hand = self.hand(self.first);
        let fit = PoseFit {
            shift: hand.from_elbow,
            ..PoseFit::NONE
        };
        point + fit.shift_at(point)
    }

    /// Returns the fit of a board or volume that is reserved for a hand, if any.
    pub(super) fn of(&self, pose: &PoseSchema, side: Option<Side>) -> PoseFit {
        let hand = self.hand(side.unwrap_or(self.first));
        let hand = match pose.fit {
            FitSchema::Hand => hand,
            FitSchema::Off => &HandFit::DESIGN,
        };
        let (sin, cos) = (pose.tilt_deg.get().to_radians() as f32).sin_cos();
        // From right, up, towards the wearer to the board's right, away, out of the board.
        let in_board = |shift: Vec3| {
            let (up, away) = (shift.y, -shift.z);
            Vec3::new(shift.x, away * cos + up * sin, up * cos - away * sin)
        };
        match pose.anchor {
            AnchorSchema::World
            | AnchorSchema::Start
            | AnchorSchema::Other
            | AnchorSchema::Shoulder
            | AnchorSchema::Head
            | AnchorSchema::Hip => PoseFit::NONE,
            AnchorSchema::Elbow => PoseFit {
                shift: hand.from_elbow,
                scale: hand.scale,
                fingertips: None,
            },
            AnchorSchema::Wrist => PoseFit {
                shift: hand.from_wrist,
                scale: hand.scale,
                fingertips: Some(hand.fingertips.map(|tip| in_board(tip - hand.from_wrist))),
            },
        }
    }

    fn hand(&self, side: Side) -> &HandFit {
        match side {
            Side::Right => &self.right,
            Side::Left => &self.left,
        }
    }
}

impl HandFit {
    const DESIGN: Self = Self {
        from_elbow: Vec3::ZERO,
        from_wrist: Vec3::ZERO,
        scale: 1.0,
        fingertips: [Vec3::ZERO; 5],
    };

    fn between(design: Option<HandReach>, own: Option<HandReach>) -> Self {
        let (Some(design), Some(own)) = (design, own) else {
            return Self::DESIGN;
        };
        Self {
            from_elbow: own.from_elbow - design.from_elbow,
            from_wrist: own.from_wrist - design.from_wrist,
            scale: scale(own.length / design.length),
            fingertips: std::array::from_fn(|finger| {
                own.half_bent[finger] - design.half_bent[finger]
            }),
        }
    }
}

impl From<HandFit> for FitNumbers {
    fn from(fit: HandFit) -> Self {
        let mut numbers = [0.0; 22];
        let differences = [fit.from_elbow, fit.from_wrist].into_iter();
        for (index, difference) in differences.chain(fit.fingertips).enumerate() {
            let start = 3 * index;
            let start = start + usize::from(start >= SCALE_INDEX);
            numbers[start..start + 3].copy_from_slice(&difference.to_array());
        }
        numbers[SCALE_INDEX] = fit.scale;
        numbers
    }
}

impl TryFrom<FitNumbers> for HandFit {
    type Error = &'static str;

    fn try_from(numbers: FitNumbers) -> Result<Self, Self::Error> {
        let scale = numbers[SCALE_INDEX];
        let is_near = numbers.iter().all(|it| it.abs() <= MAX_DIFFERENCE);
        if !is_near || !(MIN_SCALE..=MAX_SCALE).contains(&scale) {
            return Err("the fit of a layout is out of range");
        }
        let at = |index: usize| Vec3::new(numbers[index], numbers[index + 1], numbers[index + 2]);
        Ok(Self {
            from_elbow: at(0),
            from_wrist: at(3),
            scale,
            fingertips: std::array::from_fn(|finger| at(SCALE_INDEX + 1 + 3 * finger)),
        })
    }
}

impl PoseFit {
    /// The fit to the design hand.
    pub const NONE: Self = Self {
        shift: Vec3::ZERO,
        scale: 1.0,
        fingertips: None,
    };

    /// Returns the displacement of a point (metres, relative to the anchor) that moves with the reach: away from the
    /// anchor in its own direction.
    pub fn shift_at(&self, point: Vec3) -> Vec3 {
        let horizontal = Vec3::new(point.x, 0.0, point.z);
        let forward = horizontal.normalize_or(Vec3::NEG_Z);
        let right = forward.cross(Vec3::Y);
        right * self.shift.x + Vec3::Y * self.shift.y - forward * self.shift.z
    }
}

/// Returns the factor for sizes of a hand by the ratio of its length to the length of the design hand.
///
/// A short finger needs keys that are nearer to each other, in proportion to its length. A long finger reaches them in
/// any case, and its keys grow half as much: the keys of keyboards for all adults are 19 mm apart.
fn scale(ratio: f32) -> f32 {
    if ratio < 1.0 {
        ratio.max(MIN_SCALE)
    } else {
        (1.0 + (ratio - 1.0) / 2.0).min(MAX_SCALE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::BoneLengths;

    fn arm(side: Side, hand: f64, forearm: f64) -> ArmModel {
        let bones = BoneLengths::from_hand_and_forearm(hand, forearm).unwrap();
        ArmModel::anthropometric(side, &bones).unwrap()
    }

    #[test]
    fn the_design_hand_changes_nothing() {
        for side in [Side::Right, Side::Left] {
            let arm = ArmModel::parse(&Document::shipped(DESIGN_ARM).unwrap())
                .unwrap()
                .for_side(side);
            let fit = Fit::new(&arm, None).unwrap();
            let expected = Fit {
                first: side,
                ..Fit::default()
            };
            assert_eq!(fit, expected);
        }
    }

    #[test]
    fn each_hand_of_two_has_its_own_fit() {
        let (small, large) = (arm(Side::Right, 0.16, 0.2), arm(Side::Left, 0.2, 0.27));
        let fit = Fit::new(&small, Some(&large)).unwrap();
        assert!(fit.right.scale < fit.left.scale);
        assert!(fit.right.from_elbow.z > 0.0 && fit.left.from_elbow.z < 0.0);
    }

    #[test]
    fn a_fit_is_the_same_in_another_process_and_one_out_of_range_is_refused() {
        let (small, large) = (arm(Side::Right, 0.16, 0.2), arm(Side::Left, 0.2, 0.27));
        let fit = Fit::new(&small, Some(&large)).unwrap();
        let text = serde_json::to_string(&fit).unwrap();
        assert_eq!(serde_json::from_str::<Fit>(&text).unwrap(), fit);
        let numbers = FitNumbers::from(fit.right);
        for (index, number) in [(SCALE_INDEX, 0.0), (SCALE_INDEX, 2.0), (0, f32::NAN)] {
            let mut changed = numbers;
            changed[index] = number;
            assert!(HandFit::try_from(changed).is_err(), "{index}: {number}");
        }
    }

    #[test]
    fn a_point_beside_the_elbow_moves_away_from_it() {
        let fit = PoseFit {
            shift: Vec3::new(0.0, -0.01, -0.05),
            ..PoseFit::NONE
        };
        let moved = fit.shift_at(Vec3::new(0.2, 0.3, 0.0));
        assert!(
            moved.distance(Vec3::new(0.05, -0.01, 0.0)) < 1e-6,
            "{moved}"
        );
        assert_eq!(fit.shift_at(Vec3::ZERO), Vec3::new(0.0, -0.01, -0.05));
    }
}
