//! The stand-in on operating systems that have no watchdog yet.

/// Returns an error.
pub fn run(_: impl Fn(&str)) -> Result<(), String> {
    Err("the watchdog needs Linux".into())
}

/// Releases nothing: there are no records of pressed keys.
pub fn release_abandoned_keys() -> Result<usize, String> {
    Ok(0)
}
