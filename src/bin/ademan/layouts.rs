//! `ademan layouts` and `ademan layout list`: the layouts that can be named.

use ademan::document::FileKind;
use ademan::layout::Layout;

use crate::failure::Failure;
pub use crate::list::ListArgs as Args;
use crate::list::{Row, documents, invalid};

/// Lists the layouts that come with the program, then the layouts in the configuration folder.
pub fn run(args: Args) -> Result<(), Failure> {
    let rows = documents(FileKind::Layout).map(|(name, document)| {
        let layout = document.and_then(Layout::from_document);
        Row {
            summary: layout.map_or_else(|error| invalid(&error), |layout| layout.description),
            name,
            example: None,
        }
    });
    args.print(&rows.collect::<Vec<Row>>())
}
