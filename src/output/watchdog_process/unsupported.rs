//! The stand-in on operating systems that have no watchdog yet.

/// Returns an error.
pub fn run(_: impl Fn(&str)) -> Result<(), String> {
    Err("the watchdog needs Linux".into())
}

/// The result of [`release_abandoned_keys`].
#[derive(Debug, Default)]
pub struct AbandonedRelease {
    /// The number of released keys.
    pub released: usize,
    /// One line for each record whose keys were not released.
    pub skipped: Vec<String>,
}

/// Releases nothing: there are no records of pressed keys.
pub fn release_abandoned_keys() -> Result<AbandonedRelease, String> {
    Ok(AbandonedRelease::default())
}
