//! `ademan script`: creates scripts for a simulated hand.

use std::path::PathBuf;

use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::message::shell_word;
use ademan::setup::{OtherHand, Setup};

use crate::demo::script;
use crate::failure::Failure;
use crate::{complete, layout_check, new_file};

/// Create scripts for a simulated hand
#[derive(clap::Subcommand)]
#[command(after_help = "Example: ademan script new mine --from media")]
pub enum Args {
    /// Create a script for a layout: a copy of the one that the demo plays, or a tour that uses each control once
    #[command(
        after_help = "Examples:\n  ademan script new mine --from media\n  ademan script new tour --from my-mixer.ron"
    )]
    New {
        /// File to create (.txt is added), or `-` for the standard output; an existing file is not overwritten
        file: PathBuf,
        /// Layout: the name of one that comes with the program, or a file
        #[arg(long, value_name = "LAYOUT", add = complete::layout())]
        from: String,
    },
}

pub fn run(args: Args) -> Result<(), Failure> {
    let Args::New { file, from } = args;
    let path = new_file::with_extension(&file, "txt");
    let next = format!("ademan demo --layout {} --script FILE", shell_word(&from));
    match script::for_layout(&from) {
        Some(text) => {
            let original = format!("a copy of examples/scripts/{from}.txt");
            new_file::create(&path, text, &original, &next)
        }
        None => {
            let original = format!("a tour of {from}");
            new_file::create(&path, &tour(&from)?, &original, &next)
        }
    }
}

/// Returns a script that uses each control of a layout once, as far as the hands of the demo can.
fn tour(layout: &str) -> Result<String, Failure> {
    let loaded = Layout::load(layout)?;
    let mut setup = Setup {
        layout: layout.to_owned(),
        allow_system_keys: true,
        other_hand: loaded.uses_hand(Side::Left).then(OtherHand::default),
        ..Setup::default()
    };
    layout_check::assume_profiles(&mut setup, &loaded);
    Ok(setup.load_files()?.tour())
}
