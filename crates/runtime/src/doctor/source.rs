//! The check of a source, without reading from it.

use super::{CheckStatus, Finding};
use crate::setup::NamedSource;
use ademan_core::message::{escape, escape_line};
use ademan_core::pipeline::SourceRole;

/// Checks that a source can be opened, and states what it sends and may do. Returns `None` for a setup without a source.
///
/// A serial port is not opened, since that can restart the glove; the check of ports covers it.
pub fn check_source(source: &NamedSource) -> Option<Finding> {
    let uri = source.uri?;
    let mut finding = Finding {
        check: "source",
        status: CheckStatus::Ok,
        needed: true,
        text: escape(&uri.to_string()).into_owned(),
        commands: Vec::new(),
        next_step: String::new(),
    };
    match uri.probe() {
        Some(Ok(())) => {}
        None => finding.text += " (not opened by this check)",
        Some(Err(error)) => {
            let (reason, remedy) = error
                .rsplit_once("; ")
                .unwrap_or((&error, "check the path"));
            finding.status = CheckStatus::Missing;
            finding.text += &format!(" cannot be opened: {}", escape_line(reason));
            finding.next_step = escape_line(remedy).into_owned();
            return Some(finding);
        }
    }
    if let Some(protocol) = uri.protocol() {
        finding.text += &format!(": {}", protocol.summary);
    }
    if uri.is_remote() && source.permissions.role == SourceRole::Pointer {
        finding.text += "; it is on the network and only a pointer";
        finding.next_step = format!("it presses no keys: {} lets it type", source.remedy);
    }
    Some(finding)
}
