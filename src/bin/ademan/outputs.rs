//! `ademan outputs`: the kinds of output.

use ademan::output::{BACKENDS, Backend};

use crate::failure::Failure;
pub use crate::list::ListArgs as Args;
use crate::list::Row;

pub fn run(args: Args) -> Result<(), Failure> {
    let rows: Vec<Row> = BACKENDS.iter().map(|backend| row(backend)).collect();
    args.print(&rows)
}

fn row(backend: &Backend) -> Row {
    let argument = backend.argument.map(|argument| {
        if backend.is_argument_required {
            format!(":{argument}")
        } else {
            format!("[:{argument}]")
        }
    });
    let name = format!("{}{}", backend.name, argument.unwrap_or_default());
    let shortest = if backend.is_argument_required {
        &name
    } else {
        backend.name
    };
    Row {
        example: Some(format!("ademan run my-setup.ron --output {shortest}")),
        name,
        summary: backend.summary.into(),
    }
}
