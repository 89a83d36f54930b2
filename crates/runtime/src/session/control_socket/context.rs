//! The session that a control socket serves.

use super::ProfileInfo;
use crate::session::command_channel::CommandSender;
use crate::session::focus::ActiveRule;
use crate::session::view::ViewHub;
use crate::session::write_failures::WriteFailures;

/// The session that a control socket serves.
pub struct ServerContext {
    /// Profiles of the setup, in order.
    pub profiles: Vec<ProfileInfo>,
    /// Channel to the session loop.
    pub commands: CommandSender,
    /// Views of the session, if it has any.
    pub views: Option<ViewHub>,
    /// Files that became incomplete.
    pub write_failures: WriteFailures,
    /// The rule for the application that has the focus.
    pub rule: ActiveRule,
}
