//! From arguments to a setup that is ready to run.

use ademan::capture::{Paced, Source, SourceName};
use ademan::settings::{Assembly, Setup};

use crate::args::SetupArgs;
use crate::failure::Failure;

/// The setup of a file, or the default one, with the flags over it.
pub fn read(file: Option<&str>, flags: SetupArgs) -> Result<Setup, Failure> {
    let mut setup = match file {
        Some(path) => Setup::load(path)?,
        None => Setup::default(),
    };
    setup.source = flags.source.or(setup.source);
    setup.glove = flags.glove.unwrap_or(setup.glove);
    setup.layout = flags.layout.unwrap_or(setup.layout);
    Ok(setup)
}

/// The source that a setup names.
pub fn source_name(setup: &Setup) -> Result<SourceName, Failure> {
    setup.source.clone().ok_or_else(|| {
        Failure::wrong_use(
            "no source is given: name one with --source, such as serial:/dev/ttyUSB0, or try typist:hello",
        )
    })
}

/// Opens a source; one that is not live is played at its own pace.
pub fn open_at_its_pace(
    assembly: &Assembly,
    name: &SourceName,
) -> Result<Box<dyn Source>, Failure> {
    let source = assembly.open(name)?;
    if source.is_live() {
        return Ok(source);
    }
    Ok(Box::new(Paced::new(source, 1.0)))
}
