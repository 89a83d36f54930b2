//! The folder for the settings of all programs, as the conventions of the system define it.

use std::path::PathBuf;

use etcetera::BaseStrategy;

/// Returns the folder. `None` without a home folder.
pub fn base_folder() -> Option<PathBuf> {
    let strategy = etcetera::choose_base_strategy().ok()?;
    Some(strategy.config_dir())
}

/// Returns the folder for the state of all programs. `None` without a home folder.
pub fn state_folder() -> Option<PathBuf> {
    let strategy = etcetera::choose_base_strategy().ok()?;
    Some(strategy.state_dir().unwrap_or_else(|| strategy.cache_dir()))
}
