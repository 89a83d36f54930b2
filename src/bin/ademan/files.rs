//! `ademan setup`: the files that a system wants of a program like this one.

use std::io::{self, Write};

use crate::failure::Failure;

/// A file, by the name that it is asked for with.
struct File {
    name: &'static str,
    /// Where a user who installs by hand puts it.
    place: &'static str,
    text: &'static str,
}

macro_rules! packaged {
    ($file:literal) => {
        include_str!(concat!("../../../packaging/", $file))
    };
}

const FILES: [File; 5] = [
    File {
        name: "udev",
        place: "/etc/udev/rules.d/60-ademan.rules",
        text: packaged!("60-ademan.rules"),
    },
    File {
        name: "udev-uaccess",
        place: "/etc/udev/rules.d/60-ademan.rules, instead of the one above",
        text: packaged!("60-ademan-uaccess.rules"),
    },
    File {
        name: "modules",
        place: "/etc/modules-load.d/ademan.conf",
        text: packaged!("modules-load.conf"),
    },
    File {
        name: "unit",
        place: "~/.config/systemd/user/ademan.service",
        text: packaged!("ademan.service"),
    },
    File {
        name: "desktop",
        place: "~/.local/share/applications/ademan.desktop",
        text: packaged!("ademan.desktop"),
    },
];

const ALL: &str = "all";

/// The names of the files, and that of all.
pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|file| file.name).chain([ALL])
}

/// Prints a file as it is, or all with the place of each.
pub fn print(name: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    for file in FILES {
        if name == ALL {
            writeln!(out, "##### {}: {}\n{}", file.name, file.place, file.text)?;
        } else if name == file.name {
            out.write_all(file.text.as_bytes())?;
        }
    }
    Ok(())
}
