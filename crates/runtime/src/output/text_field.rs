//! The text fields of other programs.

#[cfg(all(target_os = "linux", feature = "ime"))]
use std::sync::atomic::{AtomicU64, Ordering};

#[cfg(all(target_os = "linux", feature = "ime"))]
use super::sentence::SharedPlace;

/// The text field of a program that has the focus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextField {
    /// A number that changes with each field that gets the focus, and when the text of a field was changed by other means.
    pub generation: u32,
    /// The text that it takes.
    pub kind: FieldKind,
}

/// The text that a field takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldKind {
    /// Not known: keys.
    #[default]
    Unknown,
    /// Text.
    Text,
    /// Exactly what is typed: a password, a number, an address, a command.
    Literal,
}

/// The bytes of the longest piece of text for a field.
#[cfg(all(target_os = "linux", feature = "ime"))]
pub(super) const MAX_TEXT: usize = 64;

/// A piece of text for a field.
#[cfg(all(target_os = "linux", feature = "ime"))]
pub(super) type Text = arrayvec::ArrayString<MAX_TEXT>;

/// The field that has the focus, which the thread of an input method reports to the loop.
#[cfg(all(target_os = "linux", feature = "ime"))]
#[derive(Debug, Default)]
pub(super) struct FocusedField {
    /// The generation of the field in the upper 32 bits, its kind in the lower ones.
    both: AtomicU64,
    /// The place of the cursor in its text.
    pub place: SharedPlace,
}

#[cfg(all(target_os = "linux", feature = "ime"))]
impl FocusedField {
    /// Returns the field.
    pub(super) fn get(&self) -> TextField {
        let both = self.both.load(Ordering::Acquire);
        TextField {
            generation: (both >> 32) as u32,
            kind: match both as u32 {
                0 => FieldKind::Unknown,
                1 => FieldKind::Text,
                _ => FieldKind::Literal,
            },
        }
    }

    /// Reports that a field of this kind has the focus from now on.
    pub(super) fn enter(&self, kind: FieldKind) {
        let next = self.get().generation.wrapping_add(1);
        let both = u64::from(next) << 32 | kind as u64;
        self.both.store(both, Ordering::Release);
    }
}
