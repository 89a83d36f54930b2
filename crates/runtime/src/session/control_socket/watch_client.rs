//! A client that receives views of a session, for `ademan watch` and similar programs.

use std::io;
use std::path::Path;
use std::sync::Arc;
use std::thread;

use parry3d::math::Pose;
use serde::Deserialize;

use super::{Client, ControlError};
use crate::session::view::{
    PoseNumbers, View, ViewState, Viewer, ViewerSlot, board_poses, pose_from, viewer,
};
use ademan_core::contact::surface::Scene;
use ademan_core::document::Document;
use ademan_core::layout::{Fit, Layout};

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
        /// The hands of the session; the design hand if it names none.
        #[serde(default)]
        fit: Fit,
    },
    View {
        #[serde(flatten)]
        state: Box<ViewState>,
        #[serde(default)]
        boards: Vec<PoseNumbers>,
        messages: Vec<String>,
        missed: u64,
    },
}

impl WatchClient {
    /// Connects to the session whose socket is at `path`, and asks for views.
    pub fn connect(path: &Path) -> Result<Self, ControlError> {
        let mut client = Client::connect(path)?;
        client.confirm(r#"{"command":"watch"}"#)?;
        Ok(Self {
            client,
            layout: None,
        })
    }

    /// Waits for the next view. Returns `None` when the session has ended or this client did not read for too long.
    pub fn next_view(&mut self) -> Result<Option<View>, ControlError> {
        while let Some(line) = self.client.next_notification()? {
            let invalid = |reason: String| {
                let reason = format!("a view of another version of this program: {reason}");
                self.client.no_response(&reason)
            };
            match serde_json::from_str(&line).map_err(|error| invalid(error.to_string()))? {
                Line::Layout { file, text, fit } => {
                    let layout = Layout::for_hands(Document::new(file, text), fit);
                    let layout = layout.map_err(|error| invalid(error.to_string()))?;
                    self.layout = Some(Arc::new(layout));
                }
                Line::View {
                    state,
                    boards,
                    messages,
                    missed,
                } => {
                    let layout = self.layout.clone();
                    let layout = layout.ok_or_else(|| invalid("it names no layout".into()))?;
                    return Ok(Some(View {
                        boards: moved_boards(&layout.scene, &boards),
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

    /// Receives views on a thread of its own until the session ends. The viewer holds the newest view only, so that the thread always reads
    /// and the session never disconnects it; a program that was stopped for a few seconds is disconnected, and connects again.
    pub fn into_viewer(self, path: &Path) -> io::Result<Viewer> {
        let (mut slot, viewer) = viewer();
        let path = path.to_owned();
        let thread = thread::Builder::new().name("watch".into());
        thread.spawn(move || {
            let mut client = self;
            while client.forward(&mut slot) {
                match Self::connect(&path) {
                    Ok(next) => client = next,
                    Err(_) => return,
                }
            }
        })?;
        Ok(viewer)
    }

    /// Forwards views until the connection ends. Returns `true` if another connection may have more.
    fn forward(mut self, viewer: &mut ViewerSlot) -> bool {
        let mut has_view = false;
        loop {
            match self.next_view() {
                Ok(Some(view)) if viewer.send(&view) => has_view = true,
                Ok(Some(_)) => return false,
                Ok(None) => return has_view,
                Err(error) => {
                    tracing::warn!("{error}");
                    return has_view;
                }
            }
        }
    }
}

/// Returns the present pose of each board of a scene, or the pose in its layout if the session names none.
fn moved_boards(scene: &Scene, moved: &[PoseNumbers]) -> Arc<[Pose]> {
    let moved = moved.iter().map(|numbers| pose_from(*numbers));
    let moved: Option<Arc<[Pose]>> = moved.collect();
    let is_complete = |boards: &Arc<[Pose]>| boards.len() == scene.surfaces().len();
    moved
        .filter(is_complete)
        .unwrap_or_else(|| board_poses(scene))
}
