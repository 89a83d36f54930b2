//! The check of a source, without reading from it.

use std::path::Path;

use super::{CheckStatus, Finding};
use crate::capture::{CaptureError, SourceUri};
use crate::setup::{LoadedSetup, NamedSource, SetupError};
use ademan_core::message::{escape, escape_line};
use ademan_core::pipeline::SourceRole;

/// Checks that a source of a setup can be opened, and states what it sends and may do. Returns `None` for a setup without a source, and
/// for a serial port that is absent.
///
/// A serial port is not opened, since that can restart the glove; the check of ports covers it. A recording and a simulated hand are
/// opened: that has no effect on a device.
pub fn check_source(setup: &LoadedSetup, source: &NamedSource) -> Option<Finding> {
    let uri = source.uri?;
    let mut finding = Finding {
        check: "source",
        status: CheckStatus::Ok,
        needed: true,
        text: escape(&uri.to_string()).into_owned(),
        commands: Vec::new(),
        next_step: String::new(),
    };
    let role = source.role_with_token();
    let probed = match (uri, &role) {
        (_, Err(error)) => Some(Err(reason(error))),
        (SourceUri::Stream(_), _) => uri.probe(),
        _ => {
            let opened = setup.open_source_alone(uri).map(drop);
            Some(opened.map_err(|error| reason(&error)))
        }
    };
    match probed {
        Some(Ok(())) => {}
        None if uri
            .serial_port()
            .is_some_and(|port| !Path::new(port).exists()) =>
        {
            return None;
        }
        None => finding.text += " (not opened by this check)",
        Some(Err(error)) => {
            let (reason, remedy) = error.rsplit_once("; ").unwrap_or((&error, remedy_of(uri)));
            finding.status = CheckStatus::Missing;
            finding.text += &format!(" cannot be opened: {}", escape_line(reason));
            finding.next_step = escape_line(remedy).into_owned();
            return Some(finding);
        }
    }
    if let Some(protocol) = uri.protocol() {
        finding.text += &format!(": {}", protocol.summary);
    }
    if uri.is_remote() && role.is_ok_and(|role| role == SourceRole::Pointer) {
        finding.text += "; it is on the network and only a pointer";
        finding.next_step = format!("it presses no keys: {} lets it type", source.remedy);
    }
    Some(finding)
}

/// Returns the first line of the reason why a source cannot be opened.
fn reason(error: &SetupError) -> String {
    let text = match error {
        SetupError::Capture(
            CaptureError::Open { reason, .. } | CaptureError::Malformed { reason, .. },
        ) => reason.clone(),
        other => other.to_string(),
    };
    text.lines().next().unwrap_or_default().to_owned()
}

/// Returns the remedy for a source whose error states none.
fn remedy_of(uri: &SourceUri) -> &'static str {
    match uri {
        SourceUri::Typist { .. } => "change the text",
        SourceUri::Script { .. } => "change the script",
        SourceUri::Stream(_) | SourceUri::Recording { .. } => "check the path",
    }
}
