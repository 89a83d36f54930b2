//! The part of `tests/support` that the targets use.

#[path = "../../tests/support/checked.rs"]
pub mod checked;
