//! Replacements of parts of a text, and their inverse.

use std::ops::Range;

/// A part of a text that is replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Replacement {
    /// The bytes that are replaced; empty for an insertion.
    range: Range<usize>,
    /// The bytes in their place.
    text: String,
}

/// Replacements in one text, none of which overlap.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Patch {
    replacements: Vec<Replacement>,
}

impl Patch {
    /// Adds a replacement. Insertions at one offset keep their order.
    pub fn replace(&mut self, range: Range<usize>, text: impl Into<String>) {
        let text = text.into();
        self.replacements.push(Replacement { range, text });
    }

    /// Returns `true` if nothing is replaced.
    pub fn is_empty(&self) -> bool {
        self.replacements.is_empty()
    }

    /// Returns the patch that changes `old` to `new`: one replacement, of what is between their common ends.
    pub fn between(old: &str, new: &str) -> Self {
        let mut patch = Self::default();
        if old == new {
            return patch;
        }
        let same = |(a, b): &(u8, u8)| a == b;
        let start = old.bytes().zip(new.bytes()).take_while(same).count();
        let start = old.floor_char_boundary(start);
        let (old_rest, new_rest) = (&old[start..], &new[start..]);
        let pairs = old_rest.bytes().rev().zip(new_rest.bytes().rev());
        let mut end = pairs.take_while(same).count();
        while !old_rest.is_char_boundary(old_rest.len() - end) {
            end -= 1;
        }
        patch.replace(start..old.len() - end, &new_rest[..new_rest.len() - end]);
        patch
    }

    /// Returns the patched text and the inverse patch. `None` if replacements overlap or lie outside the text.
    pub fn apply(&self, text: &str) -> Option<(String, Self)> {
        let mut ordered: Vec<&Replacement> = self.replacements.iter().collect();
        ordered.sort_by_key(|it| (it.range.start, it.range.end));
        let (mut patched, mut inverse) = (String::with_capacity(text.len()), Self::default());
        let mut end = 0;
        for Replacement { range, text: new } in ordered {
            patched.push_str(text.get(end..range.start)?);
            let start = patched.len();
            patched.push_str(new);
            inverse.replace(start..patched.len(), text.get(range.clone())?);
            end = range.end;
        }
        patched.push_str(text.get(end..)?);
        Some((patched, inverse))
    }

    /// Replaces deletions that overlap by one.
    pub(super) fn merge_deletions(&mut self) {
        let is_deletion = |it: &Replacement| it.text.is_empty();
        let (mut deletions, mut merged): (Vec<_>, Vec<_>) =
            self.replacements.drain(..).partition(is_deletion);
        deletions.sort_by_key(|it| it.range.start);
        let first = merged.len();
        for deletion in deletions {
            match merged[first..].last_mut() {
                Some(last) if deletion.range.start < last.range.end => {
                    last.range.end = last.range.end.max(deletion.range.end);
                }
                _ => merged.push(deletion),
            }
        }
        self.replacements = merged;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_restores_the_text() {
        let text = "one, two, three";
        let mut patch = Patch::default();
        patch.replace(5..8, "2");
        patch.replace(0..3, "first");
        patch.replace(15..15, ", ");
        patch.replace(15..15, "é");
        let (patched, inverse) = patch.apply(text).unwrap();
        assert_eq!(patched, "first, 2, three, é");
        assert_eq!(inverse.apply(&patched).unwrap().0, text);
    }

    #[test]
    fn replacements_that_overlap_or_lie_outside_are_refused() {
        for ranges in [[0..3, 2..4], [0..1, 5..9]] {
            let mut patch = Patch::default();
            for range in ranges {
                patch.replace(range, "x");
            }
            assert_eq!(patch.apply("abcdef"), None);
        }
    }

    #[test]
    fn the_patch_between_two_texts_is_short() {
        for (old, new) in [
            ("aéb", "aèb"),
            ("aa", "aaa"),
            ("", "x"),
            ("abc", ""),
            ("ß", "ß"),
        ] {
            let patch = Patch::between(old, new);
            let patched = patch.apply(old).unwrap();
            assert_eq!(patched.0, new);
            assert_eq!(patched.1.apply(new).unwrap().0, old);
        }
        assert_eq!(Patch::between("aéb", "aèb").replacements[0].range, 1..3);
    }

    #[test]
    fn overlapping_deletions_become_one() {
        let mut patch = Patch::default();
        patch.replace(1..3, "");
        patch.replace(2..5, "");
        patch.replace(5..6, "x");
        patch.merge_deletions();
        assert_eq!(patch.apply("abcdefg").unwrap().0, "axg");
    }
}
