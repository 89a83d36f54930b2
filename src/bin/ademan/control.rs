//! The control socket of a run.

use std::path::{Path, PathBuf};

use ademan::control::{self, Control, Desk, Profile};
use ademan::reload::FileCalls;
use ademan::runtime::Calls;
use ademan::settings::Assembly;

use crate::failure::Failure;
use crate::signals::Stopper;

/// Opens the socket that `--control` names, or the usual one; `None` for `off`, and where there is no
/// usual one.
pub fn open(place: Option<&Path>) -> Result<Option<Control>, Failure> {
    let path: Option<PathBuf> = match place {
        Some(off) if off == "off" => None,
        Some(path) => Some(path.into()),
        None => control::default_path(),
    };
    Ok(path.map(|path| Control::open(&path)).transpose()?)
}

/// Who does what clients of a run ask for.
pub fn desk(assembly: &Assembly, calls: Calls, files: Vec<FileCalls>, stopper: Stopper) -> Desk {
    Desk {
        profiles: assembly
            .profile_names()
            .zip(assembly.layouts())
            .map(|(name, layout)| Profile {
                name: name.to_owned(),
                file: layout.file.clone(),
            })
            .collect(),
        calls,
        files,
        // A second request to the bell would end the program at once.
        stop: Box::new(move || stopper.ask_once()),
    }
}
