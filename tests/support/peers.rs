//! Data that other programs wrote, which is not part of the project.

use std::path::{Path, PathBuf};

/// Returns the path of a file or folder in the folder `ADEMAN_PEERS` (default: `../shared/peers` beside the project). Prints SKIPPED
/// and returns `None` without it.
pub fn peer(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("ADEMAN_PEERS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/peers"),
        PathBuf::from,
    );
    let path = folder.join(name);
    if !path.exists() {
        println!("SKIPPED: there is no {}", path.display());
        return None;
    }
    Some(path)
}
