//! The state of a session on the desktop: notifications, and an icon with a menu in the tray.
//!
//! A thread of its own talks to the bus. The session loop sends it the newest state and does not wait for it.

#[cfg(all(feature = "tray", target_os = "linux"))]
mod linux;
#[cfg(all(feature = "tray", target_os = "linux"))]
use linux as platform;
#[cfg(not(all(feature = "tray", target_os = "linux")))]
mod unsupported;
#[cfg(not(all(feature = "tray", target_os = "linux")))]
use unsupported as platform;

use std::io;
use std::time::Instant;

use super::command_channel::CommandSender;
use super::latest::LatestSender;
use super::notice::Notice;
use super::notice_thread::NoticeSender;
use super::observer::Observer;
use super::options::SessionOptions;
use crate::setup::LoadedSetup;
use ademan_core::command::CommandOrigin;
use ademan_core::hand::Side;
use ademan_core::pipeline::{Pipeline, PipelineState};
use ademan_core::snapshot::StepView;

/// The state of a session on the desktop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    not(all(feature = "tray", target_os = "linux")),
    allow(dead_code, reason = "nothing reads it")
)]
pub(super) struct TrayState {
    pub state: PipelineState,
    /// Origin of a requested pause.
    pub paused_by: Option<CommandOrigin>,
    /// Hands that are not tracked, by side.
    pub lost_hands: [bool; Side::COUNT],
    /// Index of the active profile.
    pub profile: usize,
}

impl TrayState {
    /// The state before the first reading.
    const STARTING: Self = Self {
        state: PipelineState::Starting,
        paused_by: None,
        lost_hands: [false; Side::COUNT],
        profile: 0,
    };
}

/// The parts of the desktop in which a session shows its state.
pub(super) struct TraySettings {
    /// `true` if the session shows an icon with a menu.
    pub has_icon: bool,
    /// `true` if the session shows notifications.
    pub notifies: bool,
    /// Names of the profiles, in order.
    pub profiles: Vec<String>,
}

/// The session loop's end of the thread. The thread ends when this is dropped.
pub(super) struct Tray {
    states: LatestSender<TrayState>,
    last: TrayState,
}

impl Tray {
    /// Starts the thread if the options ask for an icon or notifications. It sends each reason why something is not shown once.
    pub fn start(
        options: &SessionOptions,
        setup: &LoadedSetup,
        commands: CommandSender,
        notices: NoticeSender,
    ) -> io::Result<Option<Self>> {
        if !options.tray && !options.notify {
            return Ok(None);
        }
        let settings = TraySettings {
            has_icon: options.tray,
            notifies: options.notify,
            profiles: setup.profile_names().map(str::to_owned).collect(),
        };
        let report = move |reason| notices.send(Notice::DesktopFailed(reason));
        let (states, received) = LatestSender::new();
        platform::start(settings, commands, received, report)?;
        Ok(Some(Self {
            states,
            last: TrayState::STARTING,
        }))
    }
}

/// Passes the state on if it has changed.
impl Observer for Tray {
    fn observe(&mut self, step: &StepView, _: Instant, pipeline: &Pipeline) {
        let state = TrayState {
            state: step.state,
            paused_by: step.paused_by,
            lost_hands: step.lost_hands,
            profile: pipeline.active_profile(),
        };
        if self.last != state {
            self.last = state;
            self.states.send(state);
        }
    }
}
