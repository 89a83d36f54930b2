//! A stand-in where other keyboards cannot be read yet: on systems other than Linux.

use super::Chord;

pub(super) fn watch(chord: Chord, _: impl Fn() + Send + 'static) -> Result<(), String> {
    Err(format!(
        "{} keys cannot be watched on this system",
        chord.keys.len()
    ))
}
