//! Many hands at once: forward kinematics and contact for simulations and evaluations of layouts.
//!
//! A lane of a vector register holds one hand, so eight hands take the time of one or two. Fingers far from every key need no
//! further work; the other ones pass through the [`ContactTracker`] of their hand. All results of hands without noise are equal to the
//! results of [`ArmModel::forward`] and [`ContactTracker::update`], as the tests of this module show: the operations and their order are
//! the same. `examples/many_hands.rs` uses it.

mod block;
mod lane_arm;

use std::thread;

use crate::contact::Touch;
use crate::contact::surface::Scene;
use crate::estimate::JointAngles;
use crate::hand::{Dof, Finger};
use crate::kinematics::ArmModel;
use crate::time::Timestamp;
use block::{Block, LaneBoard};
pub use lane_arm::LaneTips;
use lane_arm::{LaneArm, LaneHands};

#[cfg(doc)]
use crate::contact::ContactTracker;

/// Number of hands that are computed at once.
pub const LANES: usize = 8;

/// The joint angles of eight hands at one time, in radians, in single precision. Angles that are not set are 0.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub struct LaneAngles {
    radians: [[f32; LANES]; Dof::COUNT],
}

impl LaneAngles {
    /// Sets the angles of the hand in a lane, 0 to 7.
    ///
    /// # Panics
    ///
    /// Panics if there is no such lane.
    pub fn set(&mut self, lane: usize, angles: &JointAngles) {
        for (all, radians) in self.radians.iter_mut().zip(angles.radians()) {
            all[lane] = *radians as f32;
        }
    }

    /// Returns one angle of all hands, for changes in place.
    pub fn dof_mut(&mut self, dof: Dof) -> &mut [f32; LANES] {
        &mut self.radians[dof.index()]
    }

    fn dof(&self, index: usize) -> &[f32; LANES] {
        &self.radians[index]
    }
}

/// A touch and the hand that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandTouch {
    /// The index of the hand.
    pub hand: usize,
    /// The touch.
    pub touch: Touch,
}

/// Hands of one arm model over the boards of one scene. Hand `i` is in lane `i % 8` of block `i / 8`.
pub struct HandBatch {
    arm: LaneArm,
    board: LaneBoard,
    blocks: Vec<Block>,
}

impl HandBatch {
    /// Creates `hands` hands, rounded up to whole blocks of eight.
    pub fn new(arm: &ArmModel, scene: &Scene, hands: usize) -> Self {
        let board = LaneBoard::new(scene, arm);
        let block = Block::new(&board);
        Self {
            arm: LaneArm::new(arm),
            blocks: vec![block; hands.div_ceil(LANES)],
            board,
        }
    }

    /// Returns the number of blocks of eight hands.
    pub fn block_count(&self) -> usize {
        self.blocks.len()
    }

    /// Computes the fingertips for each element of `angles`, which may belong to any hands.
    ///
    /// # Panics
    ///
    /// Panics if the slices differ in length.
    pub fn forward(&self, angles: &[LaneAngles], tips: &mut [LaneTips]) {
        assert_eq!(angles.len(), tips.len(), "one element for each");
        let mut hands = LaneHands::new();
        for (pose, pose_tips) in angles.iter().zip(tips) {
            self.arm.forward_into(pose, &mut hands);
            hands.copy_tips(pose_tips);
        }
    }

    /// Moves all hands through poses at `times` and returns their touches, by hand and time. `angles` has the angles of the first
    /// block at all times, then of the second block, and so on. The blocks are distributed over `threads` threads; the
    /// result does not depend on their number.
    ///
    /// The hands continue from the end of an earlier call.
    ///
    /// # Panics
    ///
    /// Panics if there are not as many elements in `angles` as times for each block.
    pub fn run(
        &mut self,
        times: &[Timestamp],
        angles: &[LaneAngles],
        threads: usize,
    ) -> Vec<HandTouch> {
        let expected = times.len() * self.blocks.len();
        assert_eq!(
            angles.len(),
            expected,
            "one element for each time and block"
        );
        if expected == 0 {
            return Vec::new();
        }
        let (arm, board) = (&self.arm, &self.board);
        let per_thread = self.blocks.len().div_ceil(threads.max(1));
        let parts = self.blocks.chunks_mut(per_thread);
        let parts = parts.zip(angles.chunks(per_thread * times.len()));
        let run_part = |(blocks, part_angles): (&mut [Block], &[LaneAngles])| {
            let mut touches = Vec::new();
            for (block, block_angles) in blocks.iter_mut().zip(part_angles.chunks(times.len())) {
                touches.push(block.run(arm, board, times, block_angles));
            }
            touches
        };
        let of_blocks: Vec<_> = thread::scope(|scope| {
            let handles: Vec<_> = parts
                .map(|part| scope.spawn(move || run_part(part)))
                .collect();
            let results = handles.into_iter().map(|thread| thread.join());
            results
                .flat_map(|part| part.expect("a block does not panic"))
                .collect()
        });
        by_hand(of_blocks)
    }
}

/// Sorts the touches of each block by hand. The touches of one hand keep their order.
fn by_hand(of_blocks: Vec<Vec<HandTouch>>) -> Vec<HandTouch> {
    let mut all = Vec::with_capacity(of_blocks.iter().map(Vec::len).sum());
    for (block, mut touches) in of_blocks.into_iter().enumerate() {
        touches.sort_by_key(|touch| touch.hand);
        all.extend(
            touches
                .into_iter()
                .map(|HandTouch { hand, touch }| HandTouch {
                    hand: block * LANES + hand,
                    touch,
                }),
        );
    }
    all
}

/// The number of values of one finger: x, y and z.
type TipLanes = [[f32; LANES]; 3];

/// The tips of all fingers.
type AllTips = [TipLanes; Finger::COUNT];

#[cfg(test)]
mod tests;
