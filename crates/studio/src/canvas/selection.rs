//! The selected items of a board.

use std::collections::BTreeSet;

use super::{Bounds, Item, ItemShape};

/// Indices of the selected items, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection(BTreeSet<usize>);

impl Selection {
    /// Selects these items only.
    pub fn set(&mut self, indices: impl IntoIterator<Item = usize>) {
        self.0 = indices.into_iter().collect();
    }

    /// Adds items.
    pub fn extend(&mut self, indices: impl IntoIterator<Item = usize>) {
        self.0.extend(indices);
    }

    /// Selects an item, or deselects it if it is selected.
    pub fn toggle(&mut self, index: usize) {
        if !self.0.remove(&index) {
            self.0.insert(index);
        }
    }

    /// Deselects everything.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Drops the indices from `count` on.
    pub fn truncate(&mut self, count: usize) {
        self.0.retain(|index| *index < count);
    }

    /// Returns `true` if an item is selected.
    pub fn contains(&self, index: usize) -> bool {
        self.0.contains(&index)
    }

    /// Returns `true` if nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the number of selected items.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the item if exactly one is selected.
    pub fn single(&self) -> Option<usize> {
        let first = self.0.first().copied();
        first.filter(|_| self.0.len() == 1)
    }

    /// Iterates over the indices in order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter().copied()
    }

    /// Returns the outlines of the selected items with their indices.
    pub fn shapes(&self, items: &[Item]) -> Vec<(usize, ItemShape)> {
        let shape = |index: usize| Some((index, items.get(index)?.shape));
        self.iter().filter_map(shape).collect()
    }
}

/// Returns the indices of the items that a rectangle touches.
pub fn items_in(items: &[Item], band: Bounds) -> impl Iterator<Item = usize> + '_ {
    let touches = move |item: &Item| item.shape.bounds().touches(band);
    let indexed = items.iter().enumerate();
    indexed.filter_map(move |(index, item)| touches(item).then_some(index))
}

#[cfg(test)]
mod tests {
    use parry3d::math::Vec2;

    use super::super::tests::square;
    use super::*;

    #[test]
    fn a_rubber_band_touches_what_it_crosses_in_any_direction() {
        let items = [square(0.0, 0.0), square(19.0, 0.0), square(38.0, 0.0)];
        let (a, b) = (Vec2::new(5.0, 20.0), Vec2::new(15.0, -20.0));
        for band in [Bounds::between(a, b), Bounds::between(b, a)] {
            assert_eq!(items_in(&items, band).collect::<Vec<_>>(), [0, 1]);
        }
    }

    #[test]
    fn a_second_toggle_deselects() {
        let mut selection = Selection::default();
        selection.extend([3, 1]);
        selection.toggle(3);
        assert_eq!(selection.single(), Some(1));
        selection.toggle(4);
        assert_eq!((selection.single(), selection.len()), (None, 2));
        selection.truncate(4);
        assert_eq!(selection.iter().collect::<Vec<_>>(), [1]);
    }
}
