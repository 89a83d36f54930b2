//! Sessions of the subcommands.

use ademan::command::Command;
use ademan::session::{NoticeReceiver, Session, SessionHandle, SessionOptions};
use ademan::setup::LoadedSetup;

use crate::failure::Failure;
use crate::{messages, signals};

/// Prepares the process for a session: nothing that it prints delays a release, and signals end it in an orderly way.
pub fn prepare() -> Result<(), Failure> {
    messages::start()?;
    signals::install()
}

/// Returns a receiver that prints notices.
pub fn print_notices() -> NoticeReceiver {
    Box::new(|notice| messages::print_notice(&notice))
}

/// Starts a session that SIGINT, SIGTERM and SIGHUP stop.
pub fn start(setup: LoadedSetup, options: SessionOptions) -> Result<SessionHandle, Failure> {
    let session = Session::start(setup, options)?;
    let commands = session.commands().clone();
    signals::on_stop(move || _ = commands.send(Command::Stop));
    Ok(session)
}
