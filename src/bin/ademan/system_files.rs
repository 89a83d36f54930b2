//! `ademan system-files`: files for the operating system, such as udev rules.

use std::io::{self, Write};

use clap::builder::PossibleValuesParser;

use crate::failure::Failure;

/// Print files for the operating system: udev rules for access to devices, a systemd unit, a launcher
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan system-files udev | sudo tee /etc/udev/rules.d/60-ademan.rules\n  ademan system-files unit > ~/.config/systemd/user/ademan.service"
)]
pub struct Args {
    /// The file
    #[arg(value_name = "FILE", default_value = ALL, value_parser = PossibleValuesParser::new(names()))]
    file: String,
}

/// A file and the path where a user installs it by hand.
struct SystemFile {
    name: &'static str,
    path: &'static str,
    text: &'static str,
}

macro_rules! packaged {
    ($file:literal) => {
        include_str!(concat!("../../../packaging/", $file))
    };
}

const FILES: [SystemFile; 5] = [
    SystemFile {
        name: "udev",
        path: "/etc/udev/rules.d/60-ademan.rules",
        text: packaged!("60-ademan.rules"),
    },
    SystemFile {
        name: "udev-uaccess",
        path: "/etc/udev/rules.d/60-ademan.rules, instead of the one above",
        text: packaged!("60-ademan-uaccess.rules"),
    },
    SystemFile {
        name: "modules",
        path: "/etc/modules-load.d/ademan.conf",
        text: packaged!("modules-load.conf"),
    },
    SystemFile {
        name: "unit",
        path: "~/.config/systemd/user/ademan.service",
        text: packaged!("ademan.service"),
    },
    SystemFile {
        name: "desktop",
        path: "~/.local/share/applications/ademan.desktop",
        text: packaged!("ademan.desktop"),
    },
];

const ALL: &str = "all";

fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|file| file.name).chain([ALL])
}

/// Prints one file, or all files with their paths.
pub fn run(args: Args) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    for file in FILES {
        if args.file == ALL {
            writeln!(out, "##### {}: {}\n{}", file.name, file.path, file.text)?;
        } else if args.file == file.name {
            out.write_all(file.text.as_bytes())?;
        }
    }
    Ok(())
}
