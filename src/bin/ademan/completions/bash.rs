//! Bash, which passes the line as it is written and inserts candidates as they are.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;

use clap::Command;
use clap_complete::env::{self, EnvCompleter};

use super::bash_line::BashLine;
use super::shells;

/// The environment variable with the characters at which Bash splits words, `COMP_WORDBREAKS`.
const BREAKS: &str = "_ADEMAN_BREAKS";

pub struct Bash;

/// Passes the line up to the cursor, as its words are split and quoted.
const SCRIPT: &str = r#"_ademan() {
    local candidate
    COMPREPLY=()
    while IFS= read -r candidate; do
        [[ -n $candidate ]] && COMPREPLY+=("$candidate")
    done < <(VARIABLE=bash BREAKS=$COMP_WORDBREAKS ademan -- "${COMP_LINE:0:COMP_POINT}" 2>/dev/null; echo)
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[:/] ]]; then
        compopt -o nospace 2>/dev/null
    fi
}
complete -o nosort -F _ademan ademan
"#;

impl EnvCompleter for Bash {
    fn name(&self) -> &'static str {
        env::Bash.name()
    }

    fn is(&self, name: &str) -> bool {
        env::Bash.is(name)
    }

    fn write_registration(
        &self,
        variable: &str,
        _: &str,
        _: &str,
        _: &str,
        script: &mut dyn Write,
    ) -> io::Result<()> {
        let text = SCRIPT.replace("VARIABLE", variable);
        script.write_all(text.replace("BREAKS=", &format!("{BREAKS}=")).as_bytes())
    }

    /// Writes what replaces the current word from its last break on, one candidate per line.
    fn write_complete(
        &self,
        command: &mut Command,
        line: Vec<OsString>,
        folder: Option<&Path>,
        answer: &mut dyn Write,
    ) -> io::Result<()> {
        // Scripts of earlier versions pass its words, split at blanks, and remove what precedes a colon.
        let line = line.join(" ".as_ref());
        let breaks = std::env::var(BREAKS).unwrap_or_default();
        let Some(line) = BashLine::new(&line.to_string_lossy(), &breaks) else {
            return Ok(());
        };
        let words = line.words.iter().map(OsString::from).collect();
        for (value, _) in shells::candidates(command, words, folder)? {
            if let Some(inserted) = line.inserted(&value) {
                writeln!(answer, "{inserted}")?;
            }
        }
        Ok(())
    }
}
