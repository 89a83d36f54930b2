//! Shared parts of the tests of this crate.
#![allow(dead_code, reason = "each test program uses a part")]

use std::path::PathBuf;

/// Returns the path of material that is not part of the project: below `ADEMAN_SHARED`, or `shared` beside the project. Prints SKIPPED
/// if it is absent.
pub fn shared(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("ADEMAN_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let path = folder.join(path);
    if path.exists() {
        return Some(path);
    }
    println!("SKIPPED: there is no {}", path.display());
    None
}

pub mod arguments;
pub mod phrases;
pub mod session;
pub mod simulated;
pub mod baselines;
pub mod field;
pub mod latin_ime;
pub mod statistics;
pub mod swipes;
