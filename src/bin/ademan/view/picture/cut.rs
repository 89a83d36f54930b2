//! Texts that are cut to the width of the window.

use std::borrow::Cow;

/// Returns the beginning of a text that fits into this many columns, and `…` if it is cut.
pub fn cut(text: &str, width: u16) -> Cow<'_, str> {
    let width = usize::from(width);
    if text.chars().count() <= width {
        return Cow::Borrowed(text);
    }
    let mut cut: String = text.chars().take(width.saturating_sub(1)).collect();
    cut.push('…');
    Cow::Owned(cut)
}
