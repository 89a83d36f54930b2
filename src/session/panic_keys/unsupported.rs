//! A stand-in where other keyboards cannot be read yet: on systems other than Linux.

use crate::device::KeyCode;

pub(super) fn watch(_: &[KeyCode], _: impl Fn() + Send + 'static) -> Result<(), String> {
    Err("other keyboards cannot be watched on this system".into())
}
