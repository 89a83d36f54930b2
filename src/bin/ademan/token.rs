//! `ademan token`: the tokens with which other machines connect to this one.

use std::io::{self, Write};

use ademan::message::escape_path;
use ademan::network::{TokenRole, network_folder, tokens};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::failure::Failure;

/// Manage the tokens with which programs on other machines connect to this one
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan token new desk --role type\n  ademan token list\n  ademan token revoke desk\n\nThe file of a token belongs on the machine that connects, whose source names it: 'tcp+tls:192.168.1.7:10002?protocol=text-line&token_file=desk.token'. This machine shares with `--share text-line+tls:192.168.1.7:10002`. Tokens and the certificate of this machine are in the folder `network` of the configuration folder: ~/.config/ademan, on Windows %APPDATA%\\ademan."
)]
pub enum Args {
    /// Make a token, and the file that its client needs
    #[command(after_help = "Example: ademan token new desk --role type")]
    New {
        /// Name of the token: letters, digits, `-` and `_`
        name: String,
        /// Permission of the client
        #[arg(long, value_parser = role())]
        role: TokenRole,
    },
    /// List names and roles
    #[command(after_help = "Example: ademan token list")]
    List,
    /// Remove a token; a running session disconnects its clients within a second
    #[command(after_help = "Example: ademan token revoke desk")]
    Revoke {
        /// Name of the token
        name: String,
    },
}

pub fn run(args: Args) -> Result<(), Failure> {
    let folder = network_folder()?;
    let mut out = io::stdout().lock();
    match args {
        Args::New { name, role } => {
            let path = tokens::create(&folder, &name, role)?;
            writeln!(out, "wrote {}", escape_path(&path))?;
            writeln!(
                out,
                "move this file to the machine that connects, into the folder `network` of its configuration folder (~/.config/ademan, on Windows %APPDATA%\\ademan), and keep no copy: it is a password"
            )?;
        }
        Args::List => {
            let entries = tokens::list(&folder)?;
            if entries.is_empty() {
                say!("no tokens yet; `ademan token new desk --role see` makes one");
            }
            for entry in entries {
                writeln!(
                    out,
                    "{:<32}  {:<5}  {}",
                    entry.name,
                    entry.role,
                    entry.role.summary()
                )?;
            }
        }
        Args::Revoke { name } => {
            tokens::revoke(&folder, &name)?;
            writeln!(out, "revoked {name}")?;
        }
    }
    Ok(())
}

fn role() -> impl TypedValueParser<Value = TokenRole> {
    let values = TokenRole::ALL.iter();
    let values = values.map(|role| PossibleValue::new(role.name()).help(role.summary()));
    PossibleValuesParser::new(values).map(|name| {
        name.parse()
            .expect("the parser accepts only names of roles")
    })
}
