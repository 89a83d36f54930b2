//! `ademan completions`: scripts that make a shell ask this program for completions, and the answers.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;

use clap::CommandFactory;
use clap::builder::PossibleValuesParser;
use clap_complete::CompleteEnv;
use clap_complete::env::{self, EnvCompleter, Shells};

use crate::Cli;
use crate::failure::Failure;

/// The environment variable in which a shell asks for completions.
const VARIABLE: &str = "_ADEMAN_COMPLETE";

const PROGRAM: &str = "ademan";

const SHELLS: Shells<'static> =
    Shells(&[&Bash, &env::Elvish, &env::Fish, &env::Powershell, &env::Zsh]);

/// The end of the script for zsh, which loads it as a function when Tab is pressed for the first time.
const ZSH_AUTOLOAD: &str = r#"[[ $funcstack[1] == _ademan ]] && _clap_dynamic_completer_ademan "$@"
"#;

/// Print a completion script for a shell
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan completions bash > ~/.local/share/bash-completion/completions/ademan\n  ademan completions zsh > ~/.zfunc/_ademan\n  ademan completions fish > ~/.config/fish/completions/ademan.fish"
)]
pub struct Args {
    /// The shell
    #[arg(value_parser = PossibleValuesParser::new(SHELLS.names()))]
    shell: String,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let shell = SHELLS.completer(&args.shell);
    let shell = shell.expect("the parser accepts only names of shells");
    let mut script = Vec::new();
    shell.write_registration(VARIABLE, PROGRAM, PROGRAM, PROGRAM, &mut script)?;
    if args.shell == env::Zsh.name() {
        script.extend_from_slice(ZSH_AUTOLOAD.as_bytes());
    }
    io::stdout().write_all(&script)?;
    Ok(())
}

/// Answers a shell that asks for completions, and ends the program then.
pub fn answer() {
    CompleteEnv::with_factory(Cli::command)
        .var(VARIABLE)
        .bin(PROGRAM)
        .completer(PROGRAM)
        .shells(SHELLS)
        .complete();
}

/// Bash, which splits words at colons: `serial:/dev/ttyUSB0` reaches a completion function in three parts.
struct Bash;

/// Splits the line at blanks only, and returns what follows the last colon of a word, as Bash replaces only that.
const BASH_SCRIPT: &str = r#"_ademan() {
    local line=${COMP_LINE:0:COMP_POINT} words candidate current kept=""
    read -r -a words <<<"$line"
    [[ $line == *[[:space:]] ]] && words+=("")
    current=${words[-1]}
    [[ $COMP_WORDBREAKS == *:* && $current == *:* ]] && kept=${current%"${current##*:}"}
    COMPREPLY=()
    while IFS= read -r candidate; do
        [[ -n $candidate ]] && COMPREPLY+=("${candidate#"$kept"}")
    done < <(VARIABLE=bash _CLAP_IFS=$'\n' _CLAP_COMPLETE_INDEX=$((${#words[@]} - 1)) ademan -- "${words[@]}" 2>/dev/null; echo)
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
        script.write_all(BASH_SCRIPT.replace("VARIABLE", variable).as_bytes())
    }

    fn write_complete(
        &self,
        command: &mut clap::Command,
        arguments: Vec<OsString>,
        folder: Option<&Path>,
        answer: &mut dyn Write,
    ) -> io::Result<()> {
        env::Bash.write_complete(command, arguments, folder, answer)
    }
}
