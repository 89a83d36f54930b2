//! `ademan layout`: creates, checks, lists and draws layouts.

use std::path::{Path, PathBuf};

use ademan::document::Document;
use ademan::files::Load;
use ademan::layout::{Layout, mirror_layout};
use ademan::layout_link::LOCAL_PAGE;
use ademan::setup::ArmSetup;

use crate::failure::Failure;
use crate::{complete, field_list, key_list, layout_check, layouts, link, new_file, picture};

/// Create, check, list and draw layouts
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan layout new my-board --from qwerty-arc\n  ademan layout check my-board.ron"
)]
pub enum Args {
    /// Create a layout as a copy of another one
    #[command(
        after_help = "Examples:\n  ademan layout new my-board --from qwerty-arc\n  ademan layout new my-left-board --from qwerty-arc --mirror"
    )]
    New {
        /// File to create (.ron is added), or `-` for the standard output; an existing file is not overwritten
        file: PathBuf,
        /// Layout to copy: the name of one that comes with the program, or a file
        #[arg(long, default_value = "qwerty-flat", add = complete::layout())]
        from: String,
        /// Mirror the positions for the other hand: a layout for the right hand becomes one for the left hand. Keys keep
        /// their order, and fingers their keys
        #[arg(long)]
        mirror: bool,
    },
    /// Check files, report errors with line and column, and list keys out of reach of a hand
    #[command(
        after_help = "Examples:\n  ademan layout check my-board.ron\n  ademan layout check *.ron --json\n  ademan layout check my-board.ron --hand 189,262\n  ademan layout check my-board.ron --person left-small\n  ademan layout check my-board.ron --setup my-setup.ron"
    )]
    Check {
        /// Layout files, or names of layouts that come with the program
        #[arg(required = true, add = complete::layout())]
        files: Vec<String>,
        /// The hand that has to reach the keys, by its hand and forearm length in mm. The default is the hand that the
        /// layouts of the program are drawn for
        #[arg(long, value_name = "HAND,FOREARM", value_parser = layout_check::hand)]
        hand: Option<ArmSetup>,
        /// The person who has to reach the keys: the name of one that comes with the program, or a file
        #[arg(long, value_name = "FILE", add = complete::person(), conflicts_with = "hand")]
        person: Option<String>,
        /// The setup file whose hands and gloves have to reach the keys
        #[arg(long, value_name = "SETUP.ron", conflicts_with = "hand")]
        setup: Option<String>,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// List the layouts that come with the program, and the ones in the configuration folder
    #[command(after_help = "Example: ademan layout list")]
    List(layouts::Args),
    /// Print the link that opens a layout in the page of `ademan serve`, with the layout in it
    #[command(
        after_help = "Examples:\n  ademan layout share my-board.ron\n  ademan layout share my-board.ron --page https://example.org/ademan/"
    )]
    Share {
        /// A layout file, or the name of a layout that comes with the program
        #[arg(add = complete::layout())]
        file: String,
        /// Address of the page
        #[arg(long, value_name = "URL", default_value = LOCAL_PAGE)]
        page: String,
    },
    /// List the names of keys, with aliases and codes
    #[command(
        after_help = "Examples:\n  ademan layout keys\n  ademan layout keys vol\n  ademan layout keys ';'"
    )]
    Keys(key_list::Args),
    /// List the fields of layout files, with defaults and valid values
    #[command(
        after_help = "Examples:\n  ademan layout fields\n  ademan layout fields slider\n  ademan layout fields dead_zone"
    )]
    Fields(field_list::Args),
    /// Draw a layout in the terminal, or as a picture
    #[command(after_help = picture::EXAMPLES)]
    Show(picture::Args),
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args {
        Args::New { file, from, mirror } => new(&file, &from, mirror),
        Args::Check {
            files,
            hand,
            person,
            setup,
            json,
        } => layout_check::check(&looked_at(files)?, hand, person, setup.as_deref(), json),
        Args::Share { file, page } => link::print(&file, &page),
        Args::List(args) => layouts::run(args),
        Args::Keys(args) => key_list::print(&args),
        Args::Fields(args) => field_list::print(&args),
        Args::Show(mut args) => {
            args.file = link::looked_at(args.file)?;
            picture::show(&args)
        }
    }
}

/// Returns the names of layouts, with files in place of links.
fn looked_at(names: Vec<String>) -> Result<Vec<String>, Failure> {
    names.into_iter().map(link::looked_at).collect()
}

/// Copies a layout under the name of the new file, for the other hand if it is mirrored.
fn new(file: &Path, from: &str, is_mirrored: bool) -> Result<(), Failure> {
    let path = new_file::with_extension(file, "ron");
    let original = Layout::load(&link::looked_at(from.to_owned())?)?;
    let (text, origin) = if is_mirrored {
        let document = Document::new(original.file.as_str(), original.text.as_str());
        let origin = format!("a copy of {} for the other hand", original.file);
        (mirror_layout(&document)?, origin)
    } else {
        (original.text, format!("a copy of {}", original.file))
    };
    let text = new_file::renamed(&text, &original.name, &path);
    let next = "ademan layout check FILE && ademan demo --layout FILE";
    new_file::create(&path, &text, &origin, next)
}
