//! Builds without a bus.

use std::io;

use crossbeam_channel::Receiver;

use super::{TraySettings, TrayState};
use crate::session::command_channel::CommandSender;

/// Reports that there is neither icon nor notification.
pub fn start(
    settings: TraySettings,
    commands: CommandSender,
    states: Receiver<TrayState>,
    report: impl Fn(String),
) -> io::Result<()> {
    drop((commands, states, settings.profiles));
    let reason = if cfg!(target_os = "linux") {
        "this program was built without them; build it with `--features tray`"
    } else {
        "they need Linux"
    };
    if settings.has_icon || settings.notifies {
        report(format!("neither tray nor notifications: {reason}"));
    }
    Ok(())
}
