//! Shells with the scripts of `clap_complete`, and candidates that a shell can insert.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;

use ademan::message::is_escaped;
use clap::Command;
use clap_complete::engine::{self, CompletionCandidate};
use clap_complete::env::{self, EnvCompleter};

/// The end of the script for zsh, which loads it as a function when Tab is pressed for the first time.
const ZSH_AUTOLOAD: &str = r#"[[ $funcstack[1] == _ademan ]] && _clap_dynamic_completer_ademan "$@"
"#;

pub const ELVISH: Shell = Shell {
    script: &env::Elvish,
    edit: |script| script,
    line: |value, _| value.to_owned(),
    separator: "\n",
};

/// Fish quotes what it inserts, and passes the current word as it is written.
pub const FISH: Shell = Shell {
    script: &env::Fish,
    edit: |script| {
        const WORD: &str = "(commandline --current-token)";
        script.replace(
            WORD,
            "(string unescape -- (commandline --current-token); or commandline --current-token)",
        )
    },
    line: |value, help| with_help(value, '\t', help),
    separator: "\n",
};

/// PowerShell inserts candidates as they are.
pub const POWERSHELL: Shell = Shell {
    script: &env::Powershell,
    edit: |script| script,
    line: |value, help| {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "_./\\:=+-".contains(c);
        let value = if value.chars().all(is_plain) {
            value.to_owned()
        } else {
            format!("'{}'", value.replace('\'', "''"))
        };
        with_help(&value, '\t', help)
    },
    separator: "\n",
};

/// Zsh quotes what it inserts, and passes the words as they are written.
pub const ZSH: Shell = Shell {
    script: &env::Zsh,
    edit: |script| script.replace("${words[@]}", "${(@Q)words}") + ZSH_AUTOLOAD,
    line: |value, help| {
        let value = value.replace('\\', r"\\").replace(':', r"\:");
        with_help(&value, ':', help.map(|help| help.replace('\\', r"\\")))
    },
    separator: "\n",
};

/// A shell with a script of `clap_complete`.
pub struct Shell {
    script: &'static dyn EnvCompleter,
    /// Changes the script.
    edit: fn(String) -> String,
    /// Formats a candidate and the first line of its help.
    line: fn(&str, Option<String>) -> String,
    separator: &'static str,
}

/// Returns the candidates for the last word that a shell can show and insert: texts of visible characters.
pub fn candidates(
    command: &mut Command,
    words: Vec<OsString>,
    folder: Option<&Path>,
) -> io::Result<Vec<(String, CompletionCandidate)>> {
    let last = words.len().saturating_sub(1);
    let candidates = engine::complete(command, words, last, folder)?.into_iter();
    let visible = candidates.filter_map(|candidate| {
        let value = candidate.get_value().to_str()?.to_owned();
        (!value.contains(is_escaped)).then_some((value, candidate))
    });
    Ok(visible.collect())
}

fn with_help(value: &str, separator: char, help: Option<String>) -> String {
    help.map_or(value.to_owned(), |help| format!("{value}{separator}{help}"))
}

impl EnvCompleter for Shell {
    fn name(&self) -> &'static str {
        self.script.name()
    }

    fn is(&self, name: &str) -> bool {
        self.script.is(name)
    }

    fn write_registration(
        &self,
        variable: &str,
        name: &str,
        program: &str,
        completer: &str,
        script: &mut dyn Write,
    ) -> io::Result<()> {
        let mut text = Vec::new();
        let registration = self.script;
        registration.write_registration(variable, name, program, completer, &mut text)?;
        let text = String::from_utf8(text).map_err(io::Error::other)?;
        script.write_all((self.edit)(text).as_bytes())
    }

    fn write_complete(
        &self,
        command: &mut Command,
        mut words: Vec<OsString>,
        folder: Option<&Path>,
        answer: &mut dyn Write,
    ) -> io::Result<()> {
        // Some shells leave out an empty current word, and name its index.
        let index = std::env::var("_CLAP_COMPLETE_INDEX").ok();
        if index.and_then(|index| index.parse().ok()) == Some(words.len()) {
            words.push(OsString::new());
        }
        let lines = candidates(command, words, folder)?;
        let lines = lines.iter().map(|(value, candidate)| {
            let help = candidate.get_help().map(ToString::to_string);
            let help = help.and_then(|help| help.lines().next().map(str::to_owned));
            (self.line)(value, help)
        });
        answer.write_all(lines.collect::<Vec<_>>().join(self.separator).as_bytes())
    }
}
