//! The parts of a picture that have a size of their own, side by side as far as there is room.

use ademan::layout::Grid;

/// Columns between two parts.
const GAP: u16 = 2;

/// A board or a box in space.
pub struct Part {
    pub kind: PartKind,
    pub width: u16,
    pub height: u16,
    /// Position below the title, set by [`arrange`].
    pub x: u16,
    pub y: u16,
}

pub enum PartKind {
    /// A board: its index and its grid.
    Board(usize, Grid),
    /// The range of the pointer.
    Range,
    /// Targets in space: the index of their space.
    Space(usize),
}

impl PartKind {
    /// Returns the name of one that is left out.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Board(..) => "a board",
            Self::Range => "the pointer",
            Self::Space(_) => "targets in space",
        }
    }
}

impl Part {
    pub fn new(kind: PartKind, width: usize, height: usize) -> Self {
        let length = |length: usize| u16::try_from(length).unwrap_or(u16::MAX);
        Self {
            kind,
            width: length(width),
            height: length(height),
            x: 0,
            y: 0,
        }
    }
}

/// Arranges parts from left to right, and in further rows below. Returns `true` if all fit.
pub fn arrange(parts: &mut [Part], width: u16, height: u16) -> bool {
    let (mut x, mut y, mut row_height) = (0_u16, 0_u16, 0_u16);
    for part in parts {
        if x > 0 && x.saturating_add(part.width) > width {
            (x, y, row_height) = (0, y.saturating_add(row_height), 0);
        }
        (part.x, part.y) = (x, y);
        if part.width > width || y.saturating_add(part.height) > height {
            return false;
        }
        x = x.saturating_add(part.width).saturating_add(GAP);
        row_height = row_height.max(part.height);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_stand_side_by_side_as_far_as_there_is_room() {
        let sizes = [(30, 5), (30, 4), (20, 3)];
        let mut parts = sizes.map(|(width, height)| Part::new(PartKind::Range, width, height));
        assert!(arrange(&mut parts, 62, 8));
        let corners = parts.each_ref().map(|part| (part.x, part.y));
        assert_eq!(corners, [(0, 0), (32, 0), (0, 5)]);
        assert!(!arrange(&mut parts, 62, 7));
        assert!(!arrange(&mut parts, 29, 80));
        assert!(arrange(&mut parts, 30, 12));
    }
}
