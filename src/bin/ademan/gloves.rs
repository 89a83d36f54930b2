//! `ademan gloves`: the glove files that come with the program.

use ademan::capture::protocol::lucidgloves;
use ademan::document::FileKind;
use ademan::layout::Glove;
use ademan::message::shell_word;

use crate::failure::Failure;
pub use crate::list::ListArgs as Args;
use crate::list::{Row, documents, invalid};

/// The source of a glove with the default protocol.
const SERIAL: &str = "serial:/dev/ttyUSB0";

pub fn run(args: Args) -> Result<(), Failure> {
    let rows = documents(FileKind::Glove).map(|(name, document)| {
        let glove = document.and_then(|document| Glove::parse(&document));
        let source = glove.as_ref().map_or(SERIAL, source);
        let example = format!("ademan run --source {source} --glove {}", shell_word(&name));
        Row {
            summary: glove.map_or_else(|error| invalid(&error), |it| it.name),
            example: Some(example),
            name,
        }
    });
    args.print(&rows.collect::<Vec<Row>>())
}

/// Returns an example of the source of a glove, as a word for a shell.
pub fn source(glove: &Glove) -> &'static str {
    if glove.map.full_scale() == lucidgloves::FULL_SCALE {
        "'serial:/dev/ttyUSB0?protocol=lucidgloves'"
    } else {
        SERIAL
    }
}
