//! `ademan outputs`: the kinds of output.

use ademan::output::{BACKENDS, Backend};

use crate::failure::Failure;
use crate::list::{ListArgs, Row};

/// List the outputs
#[derive(clap::Args)]
#[command(after_help = "Example: ademan outputs --json")]
pub struct Args {
    #[command(flatten)]
    list: ListArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let rows: Vec<Row> = BACKENDS.iter().map(|backend| row(backend)).collect();
    args.list.print(&rows)
}

fn row(backend: &Backend) -> Row {
    let argument = backend
        .argument
        .map(|argument| match backend.is_argument_required {
            true => format!(":{argument}"),
            false => format!("[:{argument}]"),
        });
    Row {
        name: format!("{}{}", backend.name, argument.unwrap_or_default()),
        summary: backend.summary.into(),
        example: Some(format!("ademan run my-setup.ron --output {}", backend.name)),
    }
}
