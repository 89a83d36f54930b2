//! `ademan schema`: the JSON Schema of each file format, and files in the JSON form that it describes.

use ademan::document::{Document, FileKind, Table, json_form, json_schema};
use ademan::files::OpenDocument;
use ademan::layout::{arm_field_tables, field_tables, glove_field_tables, person_field_tables};
use ademan::setup::{setup_field_tables, setup_json_schema};
use ademan::text::learned_field_tables;
use serde_json::Value;

use crate::failure::Failure;
use crate::list::print_json;

/// Print the JSON Schema of a file format, or a file as JSON, for editors and programs
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan schema layout > layout.schema.json\n  ademan schema layout my-board.ron > my-board.json"
)]
pub struct Args {
    /// The format
    format: FileFormat,
    /// A file of the format, or the name of one that comes with the program: prints it in the JSON form that the schema describes
    file: Option<String>,
}

/// A format of files in RON.
#[derive(Clone, Copy, clap::ValueEnum)]
enum FileFormat {
    /// Boards with keys and controls, pointers, triggers
    Layout,
    /// The joint angles that the channels of a glove measure
    Glove,
    /// The links of an arm model
    Arm,
    /// The sources, hands, outputs and limits of a session
    Setup,
    /// The size of the hands, and the movements of the simulated person
    Person,
    /// The taps and words of a person that the text decoder has learned, as `ademan ctl save-learned` writes it
    Learned,
}

impl FileFormat {
    fn tables(self) -> Vec<Table> {
        match self {
            Self::Layout => field_tables(),
            Self::Glove => glove_field_tables(),
            Self::Arm => arm_field_tables(),
            Self::Setup => setup_field_tables(),
            Self::Person => person_field_tables(),
            Self::Learned => learned_field_tables(),
        }
    }

    fn kind(self) -> FileKind {
        match self {
            Self::Layout => FileKind::Layout,
            Self::Glove => FileKind::Glove,
            Self::Arm => FileKind::Arm,
            Self::Setup => FileKind::Setup,
            Self::Person => FileKind::Person,
            Self::Learned => FileKind::Learned,
        }
    }

    fn schema(self) -> Value {
        match self {
            Self::Setup => setup_json_schema(),
            Self::Layout | Self::Glove | Self::Arm | Self::Person | Self::Learned => {
                json_schema(&self.tables())
            }
        }
    }
}

pub fn run(args: Args) -> Result<(), Failure> {
    let value = match &args.file {
        None => args.format.schema(),
        Some(file) => {
            let document = Document::open_kind(args.format.kind(), file)?;
            let form = json_form(&document.text, &args.format.tables());
            form.ok_or_else(|| {
                let message = "the brackets are not balanced, so that the file cannot be converted";
                document.error_at(&document.text, message)
            })?
        }
    };
    print_json(&value)
}
