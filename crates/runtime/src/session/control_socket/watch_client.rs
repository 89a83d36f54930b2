//! A client that receives views of a session, for `ademan watch` and similar programs.

use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;

use super::{Client, ControlError};
use crate::session::view::{View, ViewState, board_poses};
use ademan_core::layout::Layout;

/// A connection that receives views.
pub struct WatchClient {
    client: Client,
    layout: Option<Arc<Layout>>,
}

/// A line that this client understands.
#[derive(Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
enum Line {
    Layout {
        file: String,
        text: String,
    },
    View {
        #[serde(flatten)]
        state: Box<ViewState>,
        messages: Vec<String>,
        missed: u64,
    },
}

/// The response to the request.
#[derive(Deserialize)]
struct Response {
    ok: bool,
    #[serde(default)]
    error: String,
}

impl WatchClient {
    /// Connects to the session whose socket is at `path`, and asks for views.
    pub fn connect(path: &Path) -> Result<Self, ControlError> {
        let mut client = Client::connect(path)?;
        let response = client.request(r#"{"command":"watch"}"#)?;
        match serde_json::from_str(&response) {
            Ok(Response { ok: true, .. }) => Ok(Self {
                client,
                layout: None,
            }),
            Ok(Response { error, .. }) => Err(client.no_response(&error)),
            Err(error) => Err(client.no_response(&error.to_string())),
        }
    }

    /// Waits for the next view. Returns `None` when the session has ended or this client did not read for too long.
    pub fn next_view(&mut self) -> Result<Option<View>, ControlError> {
        while let Some(line) = self.client.next_notification()? {
            let invalid = |reason: String| {
                let reason = format!("a view of another version of this program: {reason}");
                self.client.no_response(&reason)
            };
            match serde_json::from_str(&line).map_err(|error| invalid(error.to_string()))? {
                Line::Layout { file, text } => {
                    let layout = Layout::parse(&text, &file);
                    let layout = layout.map_err(|error| invalid(error.to_string()))?;
                    self.layout = Some(Arc::new(layout));
                }
                Line::View {
                    state,
                    messages,
                    missed,
                } => {
                    let layout = self.layout.clone();
                    let layout = layout.ok_or_else(|| invalid("it names no layout".into()))?;
                    return Ok(Some(View {
                        boards: board_poses(&layout.scene),
                        layout,
                        state: Arc::new(*state),
                        messages: messages.into(),
                        missed,
                    }));
                }
            }
        }
        Ok(None)
    }
}
