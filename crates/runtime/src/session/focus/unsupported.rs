//! Systems on which the focus is not followed.

use std::io;

/// Nothing to cancel.
pub struct Cancel;

const REASON: &str =
    "this system does not tell which application has the focus; X11 and sway on Linux do";

pub fn watch(
    _: impl FnMut(&[String]) -> bool + Send + 'static,
    report: impl FnOnce(String) + Send + 'static,
) -> io::Result<Cancel> {
    report(REASON.into());
    Ok(Cancel)
}

pub fn probe() -> Result<(&'static str, Vec<String>), String> {
    Err(REASON.into())
}
