//! Overlaps of boards in space, where one touch presses keys of both.

use parry3d::math::{Pose, Vec3};

use super::model::{Board, Face, Layout};
use crate::contact::TargetId;
use crate::contact::surface::{Shape, Surface};
use crate::message::escape;

/// The depth by which boards may overlap, in metres: far above rounding errors, far below what a person can see.
const TOLERANCE: f32 = 1e-5;

/// The largest number of overlaps that are found: thousands of boards at one position have millions, which fill the memory.
const MAX_OVERLAPS: usize = 1_000;

/// Two boards at one position.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardOverlap<'a> {
    /// The numbers of the boards in the file, from 1.
    pub boards: (usize, usize),
    /// The names of the boards in messages.
    board_names: [String; 2],
    /// The names of the controls that overlap most, one of each board.
    pub names: (&'a str, &'a str),
    /// The targets of these controls.
    pub targets: (TargetId, TargetId),
    /// The depth of that overlap, in metres.
    pub depth: f32,
}

/// The space that the front of a control sweeps during a press.
struct Block<'a> {
    name: &'a str,
    target: TargetId,
    pose: Pose,
    half: Vec3,
    /// Corners of the box around it along the axes of the anchor.
    min: Vec3,
    max: Vec3,
}

impl Block<'_> {
    fn axes(&self) -> [Vec3; 3] {
        [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| self.pose.rotation * axis)
    }

    fn half_extent_along(&self, axis: Vec3) -> f32 {
        let [x, y, z] = self.axes().map(|own| own.dot(axis).abs());
        x * self.half.x + y * self.half.y + z * self.half.z
    }
}

impl Layout {
    /// Returns the name of a board in messages, or its number, from 1.
    fn board_name(&self, index: usize) -> String {
        let name = self.boards[index].name.as_ref();
        name.map_or_else(
            || (index + 1).to_string(),
            |name| format!("`{}`", escape(name)),
        )
    }

    /// Returns the pairs of boards that share space, at most 1000: boards with one anchor that the same hand can touch.
    pub fn board_overlaps(&self) -> Vec<BoardOverlap<'_>> {
        let surfaces = self.scene.surfaces();
        let boards: Vec<(&Surface, Vec<Block>)> = surfaces
            .iter()
            .zip(&self.boards)
            .map(|(surface, board)| (surface, self.blocks(surface, board)))
            .collect();
        let mut overlaps = Vec::new();
        for (index, (surface, blocks)) in boards.iter().enumerate() {
            for (other_index, (other_surface, other_blocks)) in
                boards.iter().enumerate().skip(index + 1)
            {
                let sides = surface.side().zip(other_surface.side());
                let share_hand = sides.is_none_or(|(one, other)| one == other);
                if surface.anchor() != other_surface.anchor() || !share_hand {
                    continue;
                }
                if let Some((depth, one, other)) = deepest(blocks, other_blocks) {
                    overlaps.push(BoardOverlap {
                        boards: (index + 1, other_index + 1),
                        board_names: [index, other_index].map(|it| self.board_name(it)),
                        names: (one.name, other.name),
                        targets: (one.target, other.target),
                        depth,
                    });
                }
                if overlaps.len() == MAX_OVERLAPS {
                    return overlaps;
                }
            }
        }
        overlaps
    }

    fn blocks(&self, surface: &Surface, board: &Board) -> Vec<Block<'_>> {
        let faces = self.faces(board);
        faces.filter_map(|face| self.block(surface, face)).collect()
    }

    fn block<'a>(&self, surface: &Surface, face: &'a Face) -> Option<Block<'a>> {
        let (_, target) = self.scene.target(face.target)?;
        let half = match target.shape {
            Shape::Box(half) => half.extend(target.travel / 2.0),
            Shape::Disc(radius) => Vec3::new(radius, radius, target.travel / 2.0),
        };
        let below = Pose::from_translation(Vec3::NEG_Z * half.z);
        let pose = surface.anchor_from_surface() * target.surface_from_target * below;
        let rotated = |axis: Vec3| (pose.rotation * axis).abs();
        let extent =
            rotated(Vec3::X) * half.x + rotated(Vec3::Y) * half.y + rotated(Vec3::Z) * half.z;
        Some(Block {
            name: &face.name,
            target: face.target,
            pose,
            half,
            min: pose.translation - extent,
            max: pose.translation + extent,
        })
    }
}

impl BoardOverlap<'_> {
    /// Returns the warning about it: what overlaps, by how much, and what to do.
    pub fn message(&self) -> String {
        let [first, second] = &self.board_names;
        let names = (escape(self.names.0), escape(self.names.1));
        format!(
            "boards {first} and {second} overlap by {:.1} mm at `{}` and `{}`, so that one touch presses both; move one of them",
            self.depth * 1e3,
            names.0,
            names.1
        )
    }
}

/// Returns the deepest overlap of two blocks, one of each board.
fn deepest<'b, 'a>(
    one: &'b [Block<'a>],
    other: &'b [Block<'a>],
) -> Option<(f32, &'b Block<'a>, &'b Block<'a>)> {
    let bounds = |blocks: &[Block]| {
        let min = blocks.iter().map(|block| block.min).reduce(Vec3::min)?;
        let max = blocks.iter().map(|block| block.max).reduce(Vec3::max)?;
        Some((min, max))
    };
    let (min, max) = bounds(other)?;
    let mut deepest: Option<(f32, &Block, &Block)> = None;
    for block in one.iter().filter(|block| is_touching(block, min, max)) {
        for found in other
            .iter()
            .filter(|found| is_touching(block, found.min, found.max))
        {
            let depth = depth(block, found);
            if depth > deepest.map_or(TOLERANCE, |(largest, _, _)| largest) {
                deepest = Some((depth, block, found));
            }
        }
    }
    deepest
}

fn is_touching(block: &Block, min: Vec3, max: Vec3) -> bool {
    block.min.cmple(max).all() && min.cmple(block.max).all()
}

/// Returns the distance by which one block has to move so that they only touch, in metres; 0 or negative if they share no space.
///
/// Separating axis theorem: the axes of both blocks, and those across an edge of each.
fn depth(one: &Block, other: &Block) -> f32 {
    let (axes, other_axes) = (one.axes(), other.axes());
    let offset = other.pose.translation - one.pose.translation;
    let across = axes
        .iter()
        .flat_map(|axis| other_axes.map(|edge| axis.cross(edge)));
    let all = axes.iter().copied().chain(other_axes).chain(across);
    // The product of parallel edges is not an axis.
    let depths = all.filter_map(Vec3::try_normalize).map(|axis| {
        one.half_extent_along(axis) + other.half_extent_along(axis) - offset.dot(axis).abs()
    });
    depths.fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two boards with a key of 20 mm each and a travel of 4 mm, the second with these fields of its pose.
    fn overlaps(second: &str) -> Vec<((usize, usize), f32)> {
        let board = |pose: &str, key: &str| {
            format!(
                "({pose}, size_mm: Box(20, 20), travel_mm: 4, rows: [(at_mm: (0, 0), keys: \"{key}\")]),"
            )
        };
        let text = format!(
            "Layout(name: \"a\", boards: [{}{}])",
            board("pose: (anchor: elbow, forward_mm: 300)", "A"),
            board(second, "B")
        );
        let layout = Layout::parse(&text, "a.ron").unwrap();
        let overlaps = layout.board_overlaps();
        assert!(overlaps.iter().all(|overlap| overlap.names == ("A", "B")));
        let depth_mm = |overlap: &BoardOverlap| (overlap.depth * 1e4).round() / 10.0;
        overlaps
            .iter()
            .map(|overlap| (overlap.boards, depth_mm(overlap)))
            .collect()
    }

    #[test]
    fn boards_overlap_by_the_shortest_way_out() {
        let pose =
            |fields: &str| overlaps(&format!("pose: (anchor: elbow, forward_mm: 300, {fields})"));
        assert_eq!(pose("height_mm: 0"), [((1, 2), 4.0)]);
        assert_eq!(pose("height_mm: 3"), [((1, 2), 1.0)]);
        assert_eq!(pose("right_mm: 17"), [((1, 2), 3.0)]);
        assert_eq!(pose("right_mm: 21"), []);
        assert_eq!(pose("height_mm: 5"), []);
    }

    #[test]
    fn a_message_has_the_names_of_boards_or_their_numbers() {
        let text = "Layout(name: \"a\", boards: [\
            (name: \"Pad\", pose: (anchor: elbow), keys: [(code: \"A\", at_mm: (0, 0))]),\
            (pose: (anchor: elbow), keys: [(code: \"B\", at_mm: (0, 0))])])";
        let layout = Layout::parse(text, "a.ron").unwrap();
        let overlaps = layout.board_overlaps();
        let message = overlaps[0].message();
        assert!(
            message.starts_with("boards `Pad` and 2 overlap by"),
            "{message}"
        );
    }

    #[test]
    fn boards_with_other_anchors_and_for_other_hands_do_not_overlap() {
        assert_eq!(overlaps("pose: (anchor: world, forward_mm: 300)"), []);
        let left = "hand: \"left\", pose: (anchor: elbow, forward_mm: 300)";
        assert_eq!(
            overlaps(left),
            [((1, 2), 4.0)],
            "the first board has no side"
        );
    }

    #[test]
    fn no_more_than_a_thousand_overlaps_are_found() {
        let board = |index: usize| {
            let key = format!("(code: \"A\", name: \"k{index}\", at_mm: (0, 0))");
            format!("(pose: (anchor: elbow), keys: [{key}])")
        };
        let boards: Vec<String> = (0..50).map(board).collect();
        let text = format!("Layout(name: \"a\", boards: [{}])", boards.join(","));
        let layout = Layout::parse(&text, "a.ron").unwrap();
        assert_eq!(layout.board_overlaps().len(), MAX_OVERLAPS);
    }

    #[test]
    fn no_boards_of_a_shipped_layout_overlap() {
        for (name, layout) in Layout::shipped().unwrap() {
            assert_eq!(layout.board_overlaps(), [], "{name}");
        }
    }
}
