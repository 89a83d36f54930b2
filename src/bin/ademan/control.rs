//! The control socket of a run.

use std::path::{Path, PathBuf};

use ademan::session::Calls;
use ademan::session::control_socket::{self as control, ControlServer, ProfileInfo, ServerContext};
use ademan::session::reload::FileCalls;
use ademan::setup::LoadedSetup;

use crate::failure::Failure;
use crate::signals::Stopper;

/// Opens the socket that `--control` names, or the usual one; `None` for `off`, and where there is no
/// usual one.
pub fn open(place: Option<&Path>) -> Result<Option<ControlServer>, Failure> {
    let path: Option<PathBuf> = match place {
        Some(off) if off == "off" => None,
        Some(path) => Some(path.into()),
        None => control::default_path(),
    };
    Ok(path.map(|path| ControlServer::bind(&path)).transpose()?)
}

/// Who does what clients of a run ask for.
pub fn desk(
    assembly: &LoadedSetup,
    calls: Calls,
    files: Vec<FileCalls>,
    stopper: Stopper,
) -> ServerContext {
    ServerContext {
        profiles: assembly
            .profile_names()
            .zip(assembly.layouts())
            .map(|(name, layout)| ProfileInfo {
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
