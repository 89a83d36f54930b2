//! `ademan system-files`: files for the operating system, such as udev rules.

use std::borrow::Cow;
use std::env;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::files::{self, FileError};
use ademan::message::{escape_path, shell_word};
use ademan::setup::OWN_SETUP;
use clap::builder::PossibleValuesParser;

use crate::failure::Failure;

/// Print files for the operating system: udev rules for access to devices, a systemd unit, a launcher
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan system-files udev | sudo tee /etc/udev/rules.d/60-ademan.rules\n  ademan system-files unit --install"
)]
pub struct Args {
    /// The file
    #[arg(value_name = "FILE", default_value = ALL, value_parser = PossibleValuesParser::new(names()))]
    file: String,
    /// Write a file of your own, `unit` or `desktop`, to its folder; a file that exists is not overwritten
    #[arg(long)]
    install: bool,
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

/// The program in the files of the package.
const PACKAGED_PROGRAM: &str = "/usr/bin/ademan";

/// Prints one file, or all files with their paths, or installs one.
pub fn run(args: Args) -> Result<(), Failure> {
    let program = env::current_exe()?;
    if args.install {
        return install(&args.file, &program);
    }
    let mut out = io::stdout().lock();
    for file in FILES {
        let text = file.text_for(&program).unwrap_or(file.text.into());
        if args.file == ALL {
            writeln!(out, "##### {}: {}\n{text}", file.name, file.path)?;
        } else if args.file == file.name {
            out.write_all(text.as_bytes())?;
        }
    }
    Ok(())
}

impl SystemFile {
    /// Returns the text for a program at this path, which systemd needs to be absolute. `None` if a unit cannot name it.
    fn text_for(&self, program: &Path) -> Option<Cow<'static, str>> {
        match self.name {
            _ if program == Path::new(PACKAGED_PROGRAM) => Some(self.text.into()),
            "unit" => self.unit_for(program),
            "desktop" => Some(self.launcher_for(program)),
            _ => Some(self.text.into()),
        }
    }

    /// Returns the launcher of a program. A desktop hides a launcher whose program is not in its search path, as a program of `cargo
    /// build` is not.
    fn launcher_for(&self, program: &Path) -> Cow<'static, str> {
        let printable = |text: &&str| !text.contains(char::is_control);
        let Some(path) = program.to_str().filter(printable) else {
            return self.text.into();
        };
        let exec = format!("\nExec={} ", launcher_word(path));
        let try_exec = format!("\nTryExec={}\n", path.replace('\\', r"\\"));
        let text = self.text.replace("\nExec=ademan ", &exec);
        text.replace("\nTryExec=ademan\n", &try_exec).into()
    }

    /// Returns the unit of a program; `None` if a unit cannot name it.
    fn unit_for(&self, program: &Path) -> Option<Cow<'static, str>> {
        let path = program.to_str().filter(|path| is_unit_path(path))?;
        // Without the prefix, variables in the name of the process would be replaced; in the path they never are.
        let literal = if path.contains('$') { ":" } else { "" };
        let [start, stop] = ["", "-"].map(|prefix| unit_word(&format!("{prefix}{literal}{path}")));
        let executable = unit_word(path);
        let text = self.text;
        let text = text.replace(&format!("=-{PACKAGED_PROGRAM}"), &format!("={stop}"));
        let text = text.replace(&format!("={PACKAGED_PROGRAM}"), &format!("={start}"));
        let paths = format!("ExecPaths=/usr {executable} ");
        Some(text.replace("ExecPaths=/usr ", &paths).into())
    }
}

/// Returns `true` if systemd accepts the path of a program: it refuses quotes, backslashes and control characters.
fn is_unit_path(path: &str) -> bool {
    !path.contains(|it: char| matches!(it, '"' | '\'' | '\\') || it.is_control())
}

/// Returns a text as a word of a unit, in which `%` starts a specifier.
fn unit_word(text: &str) -> String {
    let escaped = text.replace('%', "%%");
    if escaped.contains(char::is_whitespace) {
        format!("\"{escaped}\"")
    } else {
        escaped
    }
}

/// Returns a text as a word of `Exec` in a desktop entry, in which `%` starts a field code. A quoted word is escaped twice: as a word,
/// and as a value.
fn launcher_word(text: &str) -> String {
    const RESERVED: &str = " \"'\\><~|&;$*?#()`";
    let escaped = text.replace('%', "%%");
    if !escaped.contains(|it: char| RESERVED.contains(it)) {
        return escaped;
    }
    let mut quoted = String::new();
    for character in escaped.chars() {
        if "\"`$\\".contains(character) {
            quoted.push('\\');
        }
        quoted.push(character);
    }
    format!("\"{}\"", quoted.replace('\\', r"\\"))
}

/// Writes a file to its place in the home folder.
fn install(name: &str, program: &Path) -> Result<(), Failure> {
    let file = FILES.iter().find(|file| file.name == name);
    let Some((found, variable)) = file.and_then(|file| Some((file, own_variable(file)?))) else {
        return Err(Failure::wrong_use(format!(
            "only `unit` and `desktop` have a place in your home folder, not `{name}`; the help shows how to install the others with sudo"
        )));
    };
    let path = own_path(found, variable).ok_or_else(|| {
        Failure::wrong_use("there is no home folder; set HOME to the path of yours")
    })?;
    let cannot_write =
        |error: FileError| Failure::job(format!("cannot write {}: {error}", escape_path(&path)));
    let text = found.text_for(program).ok_or_else(|| {
        Failure::wrong_use(format!(
            "a unit cannot name the program {}: systemd accepts no quotes, backslashes and control characters in a path; move the program",
            escape_path(program)
        ))
    })?;
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| cannot_write(error.into()))?;
    }
    files::write_new(&path, text.as_bytes()).map_err(cannot_write)?;
    let mut out = io::stdout().lock();
    writeln!(out, "wrote {}", escape_path(&path))?;
    if found.name == "unit" {
        let setup = match new_setup() {
            Some(command) => format!("{command}, then "),
            None => String::new(),
        };
        writeln!(out, "next: {setup}systemctl --user enable --now ademan")?;
    }
    Ok(())
}

/// Returns the command that creates the setup of the unit, unless there is one.
fn new_setup() -> Option<String> {
    let folder = files::config_folder().filter(|_| files::in_config_folder(OWN_SETUP).is_none())?;
    let [shown, setup] = [folder.clone(), folder.join(OWN_SETUP)].map(|path| {
        let path = path.to_string_lossy();
        shell_word(&path).into_owned()
    });
    Some(format!("mkdir -p {shown} && ademan setup new {setup}"))
}

/// Returns the variable that names the folder of a file of a person; `None` for a file of the system.
fn own_variable(file: &SystemFile) -> Option<&'static str> {
    match file.name {
        "unit" => Some("XDG_CONFIG_HOME"),
        "desktop" => Some("XDG_DATA_HOME"),
        _ => None,
    }
}

/// Returns the path of a file in the folder that the variable names, or in the home folder; `None` without either.
fn own_path(file: &SystemFile, variable: &str) -> Option<PathBuf> {
    let absolute = |folder: &PathBuf| folder.is_absolute();
    let inside = file.path.strip_prefix("~/")?;
    let given = env::var_os(variable).map(PathBuf::from);
    Some(match given.filter(absolute) {
        // `.config/` and `.local/share/` are the defaults of the variables.
        Some(folder) => {
            let inside_folder = inside
                .strip_prefix(".config/")
                .or(inside.strip_prefix(".local/share/"));
            folder.join(inside_folder?)
        }
        None => env::home_dir().filter(absolute)?.join(inside),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_launcher_names_a_program_with_any_letters() {
        let launcher = FILES.iter().find(|file| file.name == "desktop");
        let launcher = launcher.expect("there is a launcher");
        for (program, exec, try_exec) in [
            ("/usr/bin/ademan", "ademan", "ademan"),
            ("/opt/niño/ademan", "/opt/niño/ademan", "/opt/niño/ademan"),
            ("/opt/5%/ademan", "/opt/5%%/ademan", "/opt/5%/ademan"),
            (
                "/my files/ademan",
                "\"/my files/ademan\"",
                "/my files/ademan",
            ),
            ("/a$b/ademan", r#""/a\\$b/ademan""#, "/a$b/ademan"),
            (r"/a\b/ademan", r#""/a\\\\b/ademan""#, r"/a\\b/ademan"),
        ] {
            let text = launcher.text_for(Path::new(program)).expect("a launcher");
            for line in [format!("Exec={exec} demo"), format!("TryExec={try_exec}")] {
                assert!(text.lines().any(|it| it == line), "{line}: {text}");
            }
        }
    }
}
