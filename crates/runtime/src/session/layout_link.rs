//! The link between the session loop and the layout manager.
//!
//! The loop forwards commands that need a layout to be built or written, and never waits for them. The manager hands built
//! layouts back and waits until the loop has activated them.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crossbeam_channel::{Receiver, Sender, bounded, select};

use super::layout_trial::{self, LayoutTrial, TrialRequest};
use super::reply::{ReplySender, RequestError};
use super::waker::Waker;
use crate::sim::LayoutFeed;
use ademan_core::command::Command;
use ademan_core::contact::board_pose::BoardPose;
use ademan_core::layout::Layout;
use ademan_core::pipeline::LayoutInstance;
use ademan_text::filter::Learned;

/// Maximum number of requests that wait for a busy layout manager: one for each client of the control socket.
const QUEUE_LENGTH: usize = 16;

/// Work for the layout manager.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LayoutOperation {
    /// Reads all layout files again, even unchanged ones.
    Reload,
    /// Multiplies the size of the boards by this factor. The boards keep their poses.
    Scale(f32),
    /// Writes the size of the boards and these poses, in the order of the layout, to the layout file.
    Save(Vec<BoardPose>),
    /// Writes what the text decoder has learned to its file.
    SaveLearned(Box<Learned>),
}

impl LayoutOperation {
    /// Returns the operation of a command, if it is one for the layout manager. The loop fills in the board poses and what was
    /// learned.
    pub(super) fn from_command(command: &Command) -> Option<Self> {
        match command {
            Command::Scale { factor } => Some(Self::Scale(*factor)),
            Command::Save => Some(Self::Save(Vec::new())),
            Command::SaveLearned => Some(Self::SaveLearned(Box::default())),
            Command::Reload => Some(Self::Reload),
            _ => None,
        }
    }
}

/// An operation, the layout that it concerns and the channel for its reply.
#[derive(Clone, Debug)]
pub(crate) struct LayoutRequest {
    /// The operation.
    pub operation: LayoutOperation,
    /// Index of the active profile.
    pub profile: usize,
    /// The number of layouts that the loop had replaced when it made the request.
    pub replaced: usize,
    /// Channel for the reply; `None` for a command of the layout itself, whose outcome the manager reports as a notice.
    pub reply: Option<ReplySender>,
    /// Disconnected once the request is handled, for a loop that waits.
    pub done: Option<Sender<()>>,
}

/// A layout that is ready to replace another one.
pub(super) struct LayoutSwap {
    /// The new layout.
    pub layout: Box<LayoutInstance>,
    /// Index of the profile whose layout it replaces.
    pub profile: usize,
    /// `true` if the boards keep their present poses instead of the poses of the file.
    pub keep_board_poses: bool,
    /// Receives the old layout after the swap, so that the loop does not free it.
    pub retired: Sender<Box<LayoutInstance>>,
}

/// The error of a call after the end of the session.
pub(crate) struct SessionEnded;

/// The layout manager's end of the link.
#[derive(Debug)]
pub struct LayoutLink {
    requests: Receiver<LayoutRequest>,
    trials: Receiver<TrialRequest>,
    swaps: Sender<LayoutSwap>,
    ended: Receiver<()>,
    waker: Waker,
    /// The simulated hands of the session.
    hands: LayoutFeed,
    active_profile: Arc<AtomicUsize>,
    replaced: Arc<AtomicUsize>,
    missed: Arc<AtomicUsize>,
}

impl LayoutLink {
    pub(super) fn new(waker: Waker) -> (Self, LoopLayoutLink) {
        let (request_sender, requests) = bounded(QUEUE_LENGTH);
        let (trial_sender, trials) = bounded(layout_trial::QUEUE_LENGTH);
        let (swaps, swap_receiver) = bounded(1);
        let (end, ended) = bounded(0);
        let active_profile = Arc::new(AtomicUsize::new(0));
        let replaced = Arc::new(AtomicUsize::new(0));
        let missed = Arc::new(AtomicUsize::new(0));
        let manager_end = Self {
            requests,
            trials,
            swaps,
            ended,
            waker,
            hands: LayoutFeed::default(),
            active_profile: Arc::clone(&active_profile),
            replaced: Arc::clone(&replaced),
            missed: Arc::clone(&missed),
        };
        let loop_end = LoopLayoutLink {
            requests: request_sender,
            trial: LayoutTrial::new(trial_sender),
            swaps: swap_receiver,
            active_profile,
            replaced,
            missed,
            _end: end,
        };
        (manager_end, loop_end)
    }

    /// Sets the feed that notifies simulated hands of layouts that become active.
    #[must_use]
    pub(super) fn with_hands(self, hands: LayoutFeed) -> Self {
        Self { hands, ..self }
    }

    /// Returns the channel of requests of the loop; disconnected when the session has ended.
    pub(crate) fn requests(&self) -> &Receiver<LayoutRequest> {
        &self.requests
    }

    /// Returns the channel of layouts to try. It is not disconnected before the channel of requests.
    pub(super) fn trials(&self) -> &Receiver<TrialRequest> {
        &self.trials
    }

    /// Returns `true` if the loop has replaced a layout since it made the request: its board poses may belong to
    /// another layout.
    pub(super) fn is_outdated(&self, request: &LayoutRequest) -> bool {
        request.replaced != self.replaced.load(Ordering::Relaxed)
    }

    /// Returns the number of requests without a channel for a reply that found no room since the last call.
    pub(super) fn take_missed(&self) -> usize {
        self.missed.swap(0, Ordering::Relaxed)
    }

    /// Activates a layout, waits until the loop uses it, and frees the old one. Simulated hands lift first and follow.
    pub(crate) fn activate(
        &self,
        layout: LayoutInstance,
        profile: usize,
        keep_board_poses: bool,
    ) -> Result<(), SessionEnded> {
        self.activate_as(layout, profile, keep_board_poses, None)
    }

    /// Activates a layout with the text of another file, as [`activate`](Self::activate) does. Simulated hands name that file in
    /// their messages.
    pub(crate) fn activate_text_of(
        &self,
        file: &str,
        layout: LayoutInstance,
        profile: usize,
    ) -> Result<(), SessionEnded> {
        self.activate_as(layout, profile, false, Some(file))
    }

    fn activate_as(
        &self,
        layout: LayoutInstance,
        profile: usize,
        keep_board_poses: bool,
        file: Option<&str>,
    ) -> Result<(), SessionEnded> {
        let is_active = || profile == self.active_profile.load(Ordering::Relaxed);
        let change = is_active().then(|| self.hands.begin_change());
        let layout_of_hands = layout.layout().cloned();
        let (retired, old) = bounded(1);
        let swap = LayoutSwap {
            layout: Box::new(layout),
            profile,
            keep_board_poses,
            retired,
        };
        select! {
            send(self.swaps, swap) -> sent => sent.map_err(|_| SessionEnded)?,
            recv(self.ended) -> _ => return Err(SessionEnded),
        }
        self.waker.wake();
        let old = select! {
            recv(old) -> received => received.map_err(|_| SessionEnded)?,
            recv(self.ended) -> _ => return Err(SessionEnded),
        };
        // The loop may have changed its profile before the swap.
        if let Some(mut layout_of_hands) = layout_of_hands.filter(|_| is_active()) {
            if keep_board_poses {
                copy_board_poses(&old, Arc::make_mut(&mut layout_of_hands));
            }
            if let Some(file) = file.filter(|file| *file != layout_of_hands.file) {
                file.clone_into(&mut Arc::make_mut(&mut layout_of_hands).file);
            }
            let change = change.unwrap_or_else(|| self.hands.begin_change());
            change.activate(layout_of_hands);
        }
        Ok(())
    }
}

/// Copies the board poses of a layout to another one if both have the same number of boards, as the loop does.
fn copy_board_poses(old: &LayoutInstance, layout: &mut Layout) {
    let old = old.scene().surfaces();
    if old.len() == layout.scene.surfaces().len() {
        for (index, surface) in old.iter().enumerate() {
            let pose = surface.anchor_from_surface();
            layout.scene.set_surface_pose(index, pose);
        }
    }
}

/// The loop's end of the link. Dropping it ends the layout manager.
#[derive(Debug)]
pub(super) struct LoopLayoutLink {
    requests: Sender<LayoutRequest>,
    trial: LayoutTrial,
    swaps: Receiver<LayoutSwap>,
    active_profile: Arc<AtomicUsize>,
    replaced: Arc<AtomicUsize>,
    missed: Arc<AtomicUsize>,
    _end: Sender<()>,
}

impl LoopLayoutLink {
    /// Forwards a request without waiting. Fails if the queue is full. A request that fails and has no channel for a reply is
    /// counted: the manager reports it after its next request.
    pub fn forward(&self, request: LayoutRequest) -> Result<(), RequestError> {
        self.requests.try_send(request).map_err(|error| {
            if error.into_inner().reply.is_none() {
                self.missed.fetch_add(1, Ordering::Relaxed);
            }
            RequestError::QueueFull
        })
    }

    /// Stores the index of the active profile: hands do not follow a change of another profile.
    pub fn set_active_profile(&self, profile: usize) {
        self.active_profile.store(profile, Ordering::Relaxed);
    }

    /// Counts a layout that was replaced by one with other board poses. The channel that receives the old layout orders this before
    /// the next request that the manager handles.
    pub fn count_replaced(&self) {
        self.replaced.fetch_add(1, Ordering::Relaxed);
    }

    /// Returns the number of layouts that were replaced.
    pub fn replaced(&self) -> usize {
        self.replaced.load(Ordering::Relaxed)
    }

    /// Returns the sending end for layouts to try.
    pub fn trial(&self) -> &LayoutTrial {
        &self.trial
    }

    /// Returns the channel of layouts that are ready.
    pub fn swaps(&self) -> &Receiver<LayoutSwap> {
        &self.swaps
    }

    /// Returns the next layout, if one is ready.
    pub fn try_swap(&self) -> Option<LayoutSwap> {
        self.swaps.try_recv().ok()
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use crossbeam_channel::unbounded;

    use super::*;
    use crate::capture::{Hc11Format, Source};
    use crate::setup::Setup;
    use crate::sim::HandTask;

    /// Longest wait on a busy machine.
    const TIMEOUT: std::time::Duration = std::time::Duration::from_secs(60);

    #[test]
    fn hands_follow_a_layout_whose_profile_became_active_before_the_swap() {
        let setup = Setup::default().load_files().unwrap();
        // A change waits for a hand that does not move.
        let _hand = setup.typist("a", &Hc11Format::default(), 0.0, 0).unwrap();
        let (link, loop_end) = LayoutLink::new(Waker::default());
        let link = link.with_hands(setup.layout_feed.clone());
        loop_end.set_active_profile(1);
        let instance = LayoutInstance::from_layout(&setup.layout);
        let activation = thread::spawn(move || link.activate(instance, 0, false));
        let swap = loop_end.swaps().recv_timeout(TIMEOUT).unwrap();
        loop_end.set_active_profile(0);
        swap.retired.send(swap.layout).unwrap();
        let mut is_followed = false;
        let start = std::time::Instant::now();
        while !activation.is_finished() {
            assert!(start.elapsed() < TIMEOUT, "the activation does not end");
            is_followed |= setup.layout_feed.is_changing();
            thread::yield_now();
        }
        assert!(activation.join().unwrap().is_ok());
        assert!(is_followed);
    }

    #[test]
    fn a_hand_names_the_file_whose_text_is_tried() {
        let setup = Setup::default().load_files().unwrap();
        let task = HandTask::text("q".to_owned());
        let mut hand = setup.live_hand(task, &Hc11Format::default()).unwrap();
        let (said, messages) = unbounded();
        let receive = move |message| said.send(message).unwrap();
        setup.layout_feed.set_receiver(receive);
        let (link, loop_end) = LayoutLink::new(Waker::default());
        let link = link.with_hands(setup.layout_feed.clone());
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, \
                    height_mm: -45), rows: [(at_mm: (0, 0), keys: \"A\")])])";
        let layout = Layout::parse(text, "session.ron").unwrap();
        let instance = LayoutInstance::from_layout(&layout);
        let activation = thread::spawn(move || link.activate_text_of("edited.ron", instance, 0));
        let swap = loop_end.swaps().recv_timeout(TIMEOUT).unwrap();
        let active = swap.layout.layout().map(|it| it.file.clone());
        assert_eq!(active.as_deref(), Some("session.ron"));
        swap.retired.send(swap.layout).unwrap();
        assert!(activation.join().unwrap().is_ok());
        for _ in 0..1000 {
            hand.next().unwrap();
        }
        let all: Vec<String> = messages.try_iter().collect();
        assert_eq!(
            all,
            [
                "edited.ron: the simulated hand leaves out a character: no key of the layout types it"
            ]
        );
    }
}
