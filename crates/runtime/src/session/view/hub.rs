//! The thread that passes views to viewers, and the channels between them, which hold the newest view only.

use std::collections::VecDeque;
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use crossbeam_channel::TryRecvError::Disconnected;
use crossbeam_channel::{Receiver, Sender, bounded, select};

use super::hand::ViewHand;
use super::publisher::{Published, SessionNames, ViewPublisher};
use super::{MAX_MESSAGES, View, ViewState, board_poses};
use crate::capture::HeadsetStatus;
use crate::session::latest::LatestSender;
use ademan_core::layout::Layout;

/// Notices that wait for the thread.
const QUEUED_MESSAGES: usize = 64;

/// Views of a session that pass to any number of viewers. Clones are of the same session.
#[derive(Clone)]
pub struct ViewHub {
    shared: Arc<Shared>,
    messages: Sender<String>,
}

struct Shared {
    /// Locked by the thread, by new viewers and by headsets that come and go, never by the session loop.
    list: Mutex<ViewerList>,
    /// Number of viewers, for the session loop.
    count: Arc<AtomicUsize>,
}

struct ViewerList {
    /// `None` once the session has ended.
    view: Option<View>,
    viewers: Vec<ViewerSlot>,
}

impl ViewHub {
    /// Starts the thread, and returns the session loop's end too.
    pub(in crate::session) fn start(
        names: SessionNames,
        layout: Arc<Layout>,
    ) -> io::Result<(Self, ViewPublisher)> {
        let profile = names.profiles.first().map_or("", String::as_str);
        let state = ViewState {
            name: names.session.clone(),
            process: names.process,
            ..ViewState::starting(profile, &names.source, &names.output)
        };
        let view = View {
            layout: Arc::clone(&layout),
            boards: board_poses(&layout.scene),
            state: Arc::new(state),
            messages: Arc::default(),
            missed: 0,
        };
        let count = Arc::new(AtomicUsize::new(0));
        let shared = Arc::new(Shared {
            list: Mutex::new(ViewerList {
                view: Some(view),
                viewers: Vec::new(),
            }),
            count: Arc::clone(&count),
        });
        let (publisher, views) = LatestSender::new();
        let (messages, queue) = bounded(QUEUED_MESSAGES);
        let publisher = ViewPublisher::new(publisher, count, names, layout);
        let hub = Self {
            shared: Arc::clone(&shared),
            messages,
        };
        let thread = thread::Builder::new().name("views".into());
        thread.spawn(move || shared.run(&views, &queue))?;
        Ok((hub, publisher))
    }

    /// Adds a viewer. It receives the present view at once.
    pub fn add_viewer(&self) -> Viewer {
        let (slot, viewer) = viewer();
        let mut list = self.shared.lock();
        // A slot that is dropped here tells the viewer that the session has ended.
        if let Some(view) = list.view.clone() {
            list.viewers.push(slot);
            self.shared
                .count
                .store(list.viewers.len(), Ordering::Relaxed);
            list.send(&view);
        }
        viewer
    }

    /// Shows which headset is connected. Does not wait.
    pub(in crate::session) fn show_headset(&self, headset: HeadsetStatus) {
        self.shared
            .show(|view| Arc::make_mut(&mut view.state).headset = Some(headset));
    }

    /// Returns which headset is connected; `None` for a session whose source waits for none, or that has ended.
    pub(in crate::session) fn headset(&self) -> Option<HeadsetStatus> {
        let list = self.shared.lock();
        list.view.as_ref()?.state.headset.clone()
    }

    /// Adds a notice to the views. Does not wait.
    pub(in crate::session) fn show_message(&self, message: String) {
        // A notice is lost for viewers only if 64 wait for this thread, which does nothing that takes long.
        let _ = self.messages.try_send(message);
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, ViewerList> {
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Passes views and notices on until the session loop ends.
    fn run(&self, views: &Receiver<Published>, messages: &Receiver<String>) {
        let mut latest = VecDeque::new();
        loop {
            select! {
                recv(views) -> view => match view {
                    Ok(Published { layout, boards, poses, state }) => self.show(|shown| {
                        shown.layout = layout;
                        shown.boards = boards;
                        let hands = poses.iter().flatten().map(ViewHand::from).collect();
                        // The session loop does not know it.
                        let headset = shown.state.headset.clone();
                        shown.state = Arc::new(ViewState { headset, hands, ..state });
                    }),
                    Err(_) => break,
                },
                recv(messages) -> message => {
                    let Ok(message) = message else {
                        break;
                    };
                    if latest.len() == MAX_MESSAGES {
                        latest.pop_front();
                    }
                    latest.push_back(message);
                    self.show(|view| view.messages = latest.iter().cloned().collect());
                }
            }
        }
        let mut list = self.lock();
        list.view = None;
        list.viewers.clear();
    }

    fn show(&self, change: impl FnOnce(&mut View)) {
        let mut list = self.lock();
        let Some(mut view) = list.view.take() else {
            return;
        };
        change(&mut view);
        list.send(&view);
        list.view = Some(view);
        self.count.store(list.viewers.len(), Ordering::Relaxed);
    }
}

impl ViewerList {
    /// Sends a view to all viewers, and removes those that are gone.
    fn send(&mut self, view: &View) {
        self.viewers.retain_mut(|viewer| viewer.send(view));
    }
}

/// The sending end of the channel of a viewer.
pub(in crate::session) struct ViewerSlot {
    sender: Sender<View>,
    /// Takes the view back that the viewer has not received yet.
    oldest: Receiver<View>,
    /// Disconnected when the viewer is gone.
    is_gone: Receiver<()>,
    missed: u64,
}

/// The receiving end of the views of a session.
pub struct Viewer {
    views: Receiver<View>,
    _presence: Sender<()>,
}

/// Creates the channel of a viewer.
pub(in crate::session) fn viewer() -> (ViewerSlot, Viewer) {
    let (sender, views) = bounded(1);
    let (presence, is_gone) = bounded(0);
    let slot = ViewerSlot {
        sender,
        oldest: views.clone(),
        is_gone,
        missed: 0,
    };
    let viewer = Viewer {
        views,
        _presence: presence,
    };
    (slot, viewer)
}

impl Viewer {
    /// Returns the views; the channel is disconnected when the session has ended.
    pub fn views(&self) -> &Receiver<View> {
        &self.views
    }
}

impl From<Receiver<View>> for Viewer {
    /// Creates a viewer of views from elsewhere.
    fn from(views: Receiver<View>) -> Self {
        Self {
            views,
            _presence: bounded(0).0,
        }
    }
}

impl ViewerSlot {
    /// Replaces a view that was not received yet. Returns `false` if the viewer is gone.
    pub(in crate::session) fn send(&mut self, view: &View) -> bool {
        if self.is_gone.try_recv() == Err(Disconnected) {
            return false;
        }
        self.missed += u64::from(self.oldest.try_recv().is_ok());
        let view = View {
            missed: view.missed + self.missed,
            ..view.clone()
        };
        // Only this slot sends, so there is room.
        let _ = self.sender.try_send(view);
        true
    }
}
