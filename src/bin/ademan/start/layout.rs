//! The layout that a sensor can use.

use std::io::{self, Write};

use ademan::files::Load;
use ademan::layout::Layout;
use ademan::setup::Setup;

use super::question::Questions;
use crate::failure::Failure;

/// Chooses the layout of a setup: the given one, or the answer to a proposal.
pub fn choose(
    given: Option<&str>,
    setup: &Setup,
    questions: &Questions,
) -> Result<String, Failure> {
    if let Some(name) = given {
        Layout::load(name)?;
        return Ok(name.to_owned());
    }
    let proposal = setup.proposed_layout()?;
    let layout = questions.ask("layout, or the file of one", proposal, |name| {
        let loaded = Layout::load(name).map(|_| name.to_owned());
        loaded.map_err(|error| error.to_string())
    })?;
    writeln!(io::stdout(), "layout: {layout}")?;
    Ok(layout)
}
