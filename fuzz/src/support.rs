//! The modules of `tests/support` that the targets use.

#[path = "../../tests/support/checked.rs"]
pub mod checked;
#[path = "../../tests/support/oracle/mod.rs"]
pub mod oracle;
