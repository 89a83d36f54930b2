//! Boards under a hand that is held open: as they lie under the hand for which they are drawn.

use ademan_core::calibrate::positions::{
    PositionError, measure_lengths, measure_palm, typing_palm,
};
use ademan_core::contact::board_pose::BoardPose;
use ademan_core::contact::surface::{Anchor, Surface};
use ademan_core::document::DocumentError;
use ademan_core::hand::{Joint, JointPositions, Side};
use ademan_core::kinematics::{ArmModel, BoneLengths};
use ademan_core::layout::{Fit, Layout};
use glam::{Quat, Vec3};
use parry3d::math::Pose;

/// Length of the forearm as a multiple of the hand length, as `measure_lengths` assumes it.
const FOREARM: f64 = 0.25 / 0.18;

/// The height of the index fingertip of a typing hand above the middle of its board, in metres: as the layout has it, within these
/// limits. It is low because cameras show less of a movement towards them than there is.
const HEIGHTS: (f32, f32) = (0.008, 0.015);

/// The place of boards under measured hands, and their scale.
///
/// The palm of a hand that types has a pose over its board: the index finger is above the middle. The board keeps this pose relative to the
/// measured palm, so it lies under a hand that is held flat, and stands before a hand that is held up.
#[derive(Clone, Debug)]
pub struct BoardsUnderHand {
    fit: Fit,
    /// The hands by side; `None` for a hand that is not seen.
    hands: [Option<TypingHand>; Side::COUNT],
}

/// A measured palm, and a hand of the same size that types with its forearm straight forward.
#[derive(Clone, Copy, Debug)]
struct TypingHand {
    world_from_palm: Pose,
    elbow_from_palm: Pose,
    /// The index fingertip relative to the elbow.
    fingertip: Vec3,
}

impl BoardsUnderHand {
    /// Measures hands in readings while they are held open and still, by side; a hand without readings is not placed.
    ///
    /// # Errors
    /// Fails if no hand is seen, or if its length is unsteady or not human.
    pub fn measure(readings: [&[JointPositions]; Side::COUNT]) -> Result<Self, PositionError> {
        let seen = readings.iter().max_by_key(|it| it.len());
        let hand = measure_lengths(seen.copied().unwrap_or_default())?.hand;
        let hand = hand.unwrap_or(0.18);
        let not_human = |reason: String| PositionError::NotHuman { reason };
        let bones = BoneLengths::from_hand_and_forearm(hand, hand * FOREARM).map_err(not_human)?;
        let arm = |side| {
            ArmModel::anthropometric(side, &bones).map_err(|error| not_human(error.to_string()))
        };
        let (right, left) = (arm(Side::Right)?, arm(Side::Left)?);
        let fit = Fit::new(&right, Some(&left));
        let fit = fit.map_err(|error: DocumentError| not_human(error.to_string()))?;
        let mut hands = [None; Side::COUNT];
        for own in [&right, &left] {
            let side = own.side();
            hands[side.index()] = TypingHand::new(readings[side.index()], own);
        }
        Ok(Self { fit, hands })
    }

    /// Returns the fit of layouts to the measured hands.
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// Moves the boards of a layout under the hands. Boards at the wrist stay there, and those at the start wait for an open hand by
    /// themselves. A board for a hand that was not measured, or for both, lies under the other one.
    pub fn place(&self, layout: &mut Layout) {
        let [right, left] = [Side::Right, Side::Left].map(|side| self.hands[side.index()]);
        for owner in [None, Some(Side::Right), Some(Side::Left)] {
            let own = owner.and_then(|side| self.hands[side.index()]);
            let Some(hand) = own.or(right).or(left) else {
                continue;
            };
            let movable = |surface: &&Surface| {
                let moves = matches!(
                    surface.anchor(),
                    Anchor::World | Anchor::Joint(Joint::Elbow)
                );
                moves && surface.side() == owner
            };
            let boards = layout.scene.surfaces().iter().filter(movable);
            let Some(main) = boards.max_by_key(|board| board.targets().count()) else {
                continue;
            };
            let world_from_anchor = hand.world_from_anchor(main);
            for index in 0..layout.scene.surfaces().len() {
                let surface = &layout.scene.surfaces()[index];
                if movable(&surface) {
                    let pose = world_from_anchor * surface.anchor_from_surface();
                    layout.scene.place_in_world(index, pose);
                }
            }
        }
    }
}

impl TypingHand {
    fn new(readings: &[JointPositions], arm: &ArmModel) -> Option<Self> {
        Some(Self {
            world_from_palm: measure_palm(readings, arm.side())?,
            elbow_from_palm: typing_palm(arm)?,
            fingertip: arm.reach()?.from_elbow,
        })
    }

    /// Returns the frame of the anchor of a board that is under the measured hand as under one that types.
    fn world_from_anchor(&self, board: &Surface) -> Pose {
        let own = board.anchor_from_surface();
        // The forearm points where the board lies.
        let bearing = BoardPose::from_pose(&own).bearing;
        let turn = Pose::from_parts(Vec3::ZERO, Quat::from_rotation_y(-bearing));
        let normal = own.rotation * Vec3::Z;
        let offset = own.transform_point(board.center()) - turn.transform_point(self.fingertip);
        let height = (-offset.dot(normal)).clamp(HEIGHTS.0, HEIGHTS.1);
        let across = offset - normal * offset.dot(normal);
        let lift = normal * (height + offset.dot(normal));
        let typing = Pose::from_parts(across + lift, Quat::IDENTITY) * turn * self.elbow_from_palm;
        self.world_from_palm * typing.inverse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::document::Document;
    use ademan_core::estimate::{Estimate, JointAngles};
    use ademan_core::hand::Dof;
    use ademan_core::kinematics::typing_angle;
    use ademan_core::time::Timestamp;

    /// Readings of a hand in the typing posture, with its elbow at a pose in the world.
    fn typing(hand: f64, side: Side, world_from_elbow: Pose) -> Vec<JointPositions> {
        let bones = BoneLengths::from_hand_and_forearm(hand, hand * FOREARM).unwrap();
        let arm = ArmModel::anthropometric(side, &bones).unwrap();
        let mut angles = JointAngles::default();
        for &dof in Dof::ALL {
            angles.set(dof, typing_angle(dof));
        }
        angles.set(Dof::ElbowFlexion, 0.0);
        let pose = arm.forward(&Estimate::new(Timestamp(0), angles));
        let elbow = pose.position(Joint::Elbow).unwrap();
        let mut positions = JointPositions::default();
        for (joint, own) in pose.known().filter(|(joint, _)| *joint != Joint::Elbow) {
            let world = world_from_elbow * (own.translation - elbow);
            positions.set(joint, world.as_dvec3());
        }
        vec![positions; 30]
    }

    /// Places a layout under a right and a left hand.
    fn place(layout: &str, [right, left]: [&[JointPositions]; 2]) -> Layout {
        let mut readings = [left; 2];
        readings[Side::Right.index()] = right;
        let place = BoardsUnderHand::measure(readings).unwrap();
        let document = Document::shipped(layout).unwrap();
        let mut placed = Layout::for_hands(document, place.fit()).unwrap();
        place.place(&mut placed);
        placed
    }

    /// A hand that is turned and held up in front of the person.
    fn turned() -> Pose {
        let rotation = Quat::from_rotation_y(-0.4) * Quat::from_rotation_x(1.1);
        Pose::from_parts(Vec3::new(0.1, -0.2, -0.3), rotation)
    }

    #[test]
    fn the_middle_of_a_board_is_below_the_index_finger_of_a_hand_that_types() {
        for (hand, name) in [(0.16, "qwerty-flat"), (0.18, "qwerty-arc"), (0.2, "numpad")] {
            let readings = typing(hand, Side::Right, turned());
            let layout = place(name, [&readings, &[]]);
            let tip = readings[0]
                .get(Joint::IndexTip)
                .expect("it is known")
                .as_vec3();
            let board = layout.scene.surfaces().iter();
            let board = board
                .max_by_key(|it| it.targets().count())
                .expect("a board");
            assert_eq!(board.anchor(), Anchor::World);
            let offset = board.anchor_from_surface().inverse_transform_point(tip) - board.center();
            // The length of the hand is measured to 3 %, and the end of a finger is beyond the center of its tip.
            assert!(offset.truncate().length() < 0.012, "{name}: {offset}");
            assert!((0.002..0.025).contains(&offset.z), "{name}: {offset}");
        }
    }

    #[test]
    fn a_larger_hand_has_larger_keys() {
        let width = |hand: f64| {
            let readings = typing(hand, Side::Right, Pose::IDENTITY);
            let layout = place("qwerty-flat", [&readings, &[]]);
            let surface = &layout.scene.surfaces()[0];
            let x = surface
                .targets()
                .map(|(_, it)| it.surface_from_target.translation.x);
            x.fold(f32::MIN, f32::max)
        };
        let ratio = width(0.2) / width(0.16);
        assert!((1.1..1.3).contains(&ratio), "{ratio}");
    }

    #[test]
    fn each_hand_has_its_own_board_and_one_alone_has_both() {
        let left = Pose::from_parts(Vec3::X * -0.4, Quat::IDENTITY);
        let (one, other) = (
            typing(0.18, Side::Right, turned()),
            typing(0.18, Side::Left, left),
        );
        let both = place("qwerty-two-flat", [&one, &other]);
        let alone = place("qwerty-two-flat", [&one, &[]]);
        let mut differ = 0;
        for (beside, lone) in both.scene.surfaces().iter().zip(alone.scene.surfaces()) {
            let distance = (beside.anchor_from_surface().translation)
                .distance(lone.anchor_from_surface().translation);
            match beside.side() {
                Some(Side::Left) => differ += usize::from(distance > 0.1),
                _ => assert!(distance < 1e-6),
            }
        }
        assert!(differ > 0);
    }

    #[test]
    fn a_hand_that_is_not_seen_places_nothing() {
        let error = BoardsUnderHand::measure([&[], &[]]).unwrap_err();
        assert!(matches!(error, PositionError::NotSeen { .. }), "{error}");
    }
}
