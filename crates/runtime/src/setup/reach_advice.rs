//! Advice about targets out of reach.

use crate::sim::Miss;
use ademan_core::document::shipped_layouts;
use ademan_core::hand::Side;
use ademan_core::message::{escape_line, shell_word};

/// The most layouts that are named.
const MAX_LAYOUTS: usize = 4;

/// The direction in which a target is out of reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Far,
    Near,
    High,
    Low,
    Right,
    Left,
}

impl Direction {
    const ALL: [Self; 6] = [
        Self::Far,
        Self::Near,
        Self::High,
        Self::Low,
        Self::Right,
        Self::Left,
    ];

    fn of(miss: &Miss) -> Self {
        let (outward, up, right) = (miss.outward, miss.up, miss.right);
        let largest = outward.abs().max(up.abs()).max(right.abs());
        if outward.abs() >= largest {
            [Self::Near, Self::Far][usize::from(outward > 0.0)]
        } else if up.abs() >= largest {
            [Self::Low, Self::High][usize::from(up > 0.0)]
        } else {
            [Self::Left, Self::Right][usize::from(right > 0.0)]
        }
    }

    fn opposite(self) -> Self {
        match self {
            Self::Far => Self::Near,
            Self::Near => Self::Far,
            Self::High => Self::Low,
            Self::Low => Self::High,
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }

    /// Returns the way back into reach.
    fn step(self) -> &'static str {
        match self {
            Self::Far => "nearer",
            Self::Near => "away",
            Self::High => "down",
            Self::Low => "up",
            Self::Right => "to the left",
            Self::Left => "to the right",
        }
    }

    fn advice(self) -> &'static str {
        match self {
            Self::Far => "move the board nearer or make it smaller",
            Self::Near => "the board is too near: move it away",
            Self::High => "the board is too high: move it down",
            Self::Low => "the board is too low: move it up",
            Self::Right => "the board is too far to the right: move it to the left",
            Self::Left => "the board is too far to the left: move it to the right",
        }
    }
}

/// Returns the direction in which a target comes within reach.
pub(super) fn step(miss: &Miss) -> &'static str {
    Direction::of(miss).step()
}

/// Returns the step against the most frequent direction of the misses. `fits` states that all targets are within reach after a move
/// of the boards, so that none is too large.
pub(super) fn by_direction<'a>(misses: impl Iterator<Item = &'a Miss>, fits: bool) -> String {
    let mut counts = [0; Direction::ALL.len()];
    let mut is_placed = false;
    for miss in misses.filter(|miss| miss.distance.is_finite()) {
        counts[Direction::of(miss) as usize] += 1;
        is_placed = true;
    }
    if !is_placed {
        return "add the hand for which the board is reserved, `other_hand`, to the setup".into();
    }
    let count = |direction: Direction| counts[direction as usize];
    let mut main = Direction::Far;
    for direction in Direction::ALL {
        if count(direction) > count(main) {
            main = direction;
        }
    }
    match count(main.opposite()) {
        1.. if !fits => "the board is larger than the reach: make it smaller".into(),
        _ => main.advice().into(),
    }
}

/// Returns the advice for a glove that measures no arm, which reaches everything on these shipped layouts.
pub(super) fn without_arm(layouts: &[&str]) -> String {
    let names = layouts.iter().take(MAX_LAYOUTS);
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    let remedy = if names.is_empty() {
        "choose a layout whose keys are below the fingers".to_owned()
    } else {
        format!(
            "use a layout below the fingers, such as {}",
            names.join(", ")
        )
    };
    format!(
        "this glove measures no arm, so the hand stays at one place: {remedy}, or add a source for the arm, `arm_source`"
    )
}

/// Returns the advice for a layout that only the other hand reaches.
pub(super) fn mirror(file: &str, side: Side) -> String {
    let path = |name: &str| format!("/{name}.ron");
    let is_shipped = |name: &&str| file.starts_with("layouts/") && file.ends_with(&path(name));
    let from = shell_word(shipped_layouts().find(is_shipped).unwrap_or(file));
    escape_line(&format!(
        "the layout is for the {} hand: `ademan layout new NAME --from {from} --mirror` copies it for the {side} hand",
        side.opposite()
    ))
    .into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn miss(outward: f32, up: f32, right: f32) -> Miss {
        Miss {
            distance: 0.1,
            outward,
            up,
            right,
        }
    }

    #[test]
    fn the_advice_follows_the_largest_part_of_most_misses() {
        for (misses, advice) in [
            (vec![miss(0.1, 0.02, 0.0)], "nearer"),
            (vec![miss(-0.1, 0.02, 0.0)], "too near"),
            (vec![miss(0.0, 0.1, 0.02)], "too high"),
            (vec![miss(0.0, -0.1, 0.02)], "too low"),
            (
                vec![
                    miss(0.01, 0.0, 0.1),
                    miss(0.1, 0.0, 0.0),
                    miss(0.0, 0.0, 0.1),
                ],
                "to the left",
            ),
            (vec![miss(0.01, 0.0, -0.1)], "to the right"),
            (
                vec![miss(0.1, 0.0, 0.0), miss(-0.1, 0.0, 0.0)],
                "make it smaller",
            ),
        ] {
            let found = by_direction(misses.iter(), false);
            assert!(found.contains(advice), "{found}");
        }
    }

    #[test]
    fn a_board_that_fits_after_a_move_is_not_said_to_be_too_large() {
        let misses = [
            miss(-0.1, 0.0, 0.0),
            miss(-0.1, 0.0, 0.0),
            miss(0.1, 0.0, 0.0),
        ];
        let found = by_direction(misses.iter(), true);
        assert_eq!(found, "the board is too near: move it away");
    }
}
