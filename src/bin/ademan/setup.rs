//! From arguments to a setup that is ready to run.

use ademan::capture::{BackOff, CaptureError, PacedSource, Source, SourceUri};
use ademan::pipeline::SourceRole;
use ademan::setup::{LoadedSetup, Setup, SetupError};
use crossbeam_channel::Receiver;

use crate::args::SetupArgs;
use crate::failure::Failure;

/// The setup of a file, or the default one, with the flags over it.
pub fn read(file: Option<&str>, flags: SetupArgs) -> Result<Setup, Failure> {
    let mut setup = match file {
        Some(path) => Setup::load(path)?,
        None => Setup::default(),
    };
    setup.source = flags.source.or(setup.source);
    setup.role = flags.role.or(setup.role);
    setup.glove = flags.glove.unwrap_or(setup.glove);
    setup.layout = flags.layout.unwrap_or(setup.layout);
    Ok(setup)
}

/// The source that a setup names.
pub fn source_name(setup: &Setup) -> Result<SourceUri, Failure> {
    setup.source.clone().ok_or_else(|| {
        Failure::wrong_use(
            "no source is given: name one with --source, such as serial:/dev/ttyUSB0, or try typist:hello",
        )
    })
}

/// Says of each source on the network that no keys come of it, where the layouts have some, and what changes that.
pub fn tell_pointers(assembly: &LoadedSetup) {
    if !assembly.required_capabilities().include_typing() {
        return;
    }
    for (place, (source, rights)) in assembly.sources().enumerate() {
        let Some(source) = source.filter(|source| source.is_remote()) else {
            continue;
        };
        let flag = if place == 0 { " or `--role both`" } else { "" };
        if rights.role == SourceRole::Pointer {
            say!(
                "{source} is on the network and only a pointer: it presses no keys of the layout; `role: Both` next to \
                 this source in the setup{flag} lets it type"
            );
        }
    }
}

/// Opens a source; one that is not live is played at its own pace.
pub fn open_at_its_pace(
    assembly: &LoadedSetup,
    name: &SourceUri,
) -> Result<Box<dyn Source>, SetupError> {
    let source = assembly.open_source(name)?;
    if source.is_live() {
        return Ok(source);
    }
    Ok(Box::new(PacedSource::new(source, 1.0)))
}

/// As [`open_at_its_pace`], but a device that does not open is looked for until it does: said once for
/// each reason. `None` when the end is asked for before that.
pub fn wait_for(
    assembly: &LoadedSetup,
    name: &SourceUri,
    stop: &Receiver<()>,
) -> Result<Option<Box<dyn Source>>, SetupError> {
    let mut told = String::new();
    let mut back_off = BackOff::default();
    loop {
        let reason = match open_at_its_pace(assembly, name) {
            Err(SetupError::Capture(error @ CaptureError::Open { .. })) if is_device(name) => {
                error.to_string()
            }
            opened => {
                if !told.is_empty() && opened.is_ok() {
                    say!("found {name}");
                }
                return opened.map(Some);
            }
        };
        if reason != told {
            say!("waiting: {reason}; Ctrl-C ends");
            told = reason;
        }
        if stop.recv_timeout(back_off.next_interval()).is_ok() {
            return Ok(None);
        }
    }
}

/// Whether it is something that can be plugged in later.
fn is_device(name: &SourceUri) -> bool {
    name.is_device()
}
