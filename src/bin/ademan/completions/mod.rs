//! `ademan completions`: scripts that make a shell ask this program for completions, and the answers.

mod bash;
mod bash_line;
mod shells;

use std::io::{self, Write};
use std::process;

use ademan::message::escape;
use clap::CommandFactory;
use clap::builder::PossibleValuesParser;
use clap_complete::CompleteEnv;
use clap_complete::env::Shells;

use crate::Cli;
use crate::failure::Failure;

/// The environment variable in which a shell asks for completions.
const VARIABLE: &str = "_ADEMAN_COMPLETE";

const PROGRAM: &str = "ademan";

const SHELLS: Shells<'static> = Shells(&[
    &bash::Bash,
    &shells::ELVISH,
    &shells::FISH,
    &shells::POWERSHELL,
    &shells::ZSH,
]);

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
    io::stdout().write_all(&script)?;
    Ok(())
}

/// Answers a shell that asks for completions, and ends the program then.
pub fn answer() {
    let folder = std::env::current_dir().ok();
    let answered = CompleteEnv::with_factory(Cli::command)
        .var(VARIABLE)
        .bin(PROGRAM)
        .completer(PROGRAM)
        .shells(SHELLS)
        .try_complete(std::env::args_os(), folder.as_deref());
    match answered {
        Ok(false) => {}
        Ok(true) => process::exit(0),
        Err(error) => {
            complain!("{}", escape(&error.to_string()));
            process::exit(error.exit_code());
        }
    }
}
