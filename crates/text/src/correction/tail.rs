//! The tail in which two texts differ.

/// Returns `true` for a character that ends a word.
pub fn ends_word(character: char) -> bool {
    !character.is_alphanumeric() && !matches!(character, '\'' | '_')
}

/// The tail of a text that has to be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The bytes that both texts start with.
    pub prefix: usize,
    /// The characters of the first text after them.
    pub removed: usize,
}

/// Returns where two texts differ, or `None` if they do not.
pub fn difference(shown: &str, target: &str) -> Option<Difference> {
    let pairs = shown.char_indices().zip(target.chars());
    let same = pairs.take_while(|((_, left), right)| left == right);
    let prefix = same
        .last()
        .map_or(0, |((start, letter), _)| start + letter.len_utf8());
    let removed = shown[prefix..].chars().count();
    (removed > 0 || target.len() > prefix).then_some(Difference { prefix, removed })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tail_starts_at_the_first_character_that_differs() {
        let found =
            |shown, target| difference(shown, target).map(|tail| (tail.prefix, tail.removed));
        assert_eq!(found("teh ", "the "), Some((1, 3)));
        assert_eq!(found("cómo", "cóma"), Some((4, 1)));
        assert_eq!(found("a", "ab"), Some((1, 0)));
        assert_eq!(found("ab", ""), Some((0, 2)));
        assert_eq!(found("ab", "ab"), None);
    }
}
