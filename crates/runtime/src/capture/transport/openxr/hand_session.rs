//! A session without graphics in which hands are located.

use std::io::{Error, Result};
use std::time::Instant;

use openxr::{
    ApplicationInfo, Entry, Event, EventDataBuffer, FormFactor, Hand, HandTracker, Headless,
    Instance, Posef, ReferenceSpaceType, Session, SessionState, Space, SpaceLocationFlags,
    SystemId, Time, Version, ViewConfigurationType, headless,
};

use super::session_state::{SessionMessage, SessionProgress};
use super::{TrackedHands, advice};
use crate::capture::connection::ConnectError;
use ademan_core::hand::{Joint, JointPositions, Side};
use ademan_core::message::escape_line;

/// Joints of a hand before the wrist: the palm, which no stage uses.
const BEFORE_WRIST: usize = 1;

/// Connects to the active runtime without starting a session, and returns the names of the runtime and the headset.
pub fn describe_runtime() -> std::result::Result<String, String> {
    let runtime = Runtime::open().map_err(ConnectError::into_reason)?;
    Ok(format!("{} with `{}`", runtime.name, runtime.headset))
}

/// A connection to the active runtime, whose headset tracks hands.
struct Runtime {
    instance: Instance,
    system: SystemId,
    /// Name and version, fit for messages.
    name: String,
    headset: String,
}

impl Runtime {
    fn open() -> std::result::Result<Self, ConnectError> {
        let entry = load_entry()?;
        let available = entry.enumerate_extensions().map_err(advice::no_runtime)?;
        advice::check_extensions(&available)?;
        let application = ApplicationInfo {
            application_name: "Ademan",
            application_version: 1,
            engine_name: "none",
            engine_version: 0,
            api_version: Version::new(1, 0, 0),
        };
        let extensions = advice::used_extensions(&available);
        let instance = entry
            .create_instance(&application, &extensions, &[], &())
            .map_err(advice::no_runtime)?;
        let properties = instance.properties().map_err(advice::no_runtime)?;
        let name = escape_line(&properties.runtime_name).into_owned();
        let system = instance
            .system(FormFactor::HEAD_MOUNTED_DISPLAY)
            .map_err(|error| advice::no_headset(&name, error))?;
        let headset = instance
            .system_properties(system)
            .map_err(|error| advice::no_headset(&name, error))?
            .system_name;
        let headset = escape_line(&headset).into_owned();
        if !instance.supports_hand_tracking(system).unwrap_or(false) {
            return Err(advice::no_hands(&name, &headset));
        }
        Ok(Self {
            instance,
            system,
            name,
            headset,
        })
    }
}

#[expect(unsafe_code, reason = "the library of another program is loaded")]
fn load_entry() -> std::result::Result<Entry, ConnectError> {
    // SAFETY: the loader that the system or the person has installed follows the specification.
    unsafe { Entry::load(&()) }.map_err(|error| advice::no_loader(&error))
}

/// A session in which both hands are located.
pub struct HandSession {
    /// Source URI, for messages.
    name: String,
    runtime: Runtime,
    session: Session<Headless>,
    space: Space,
    /// The tracker of each hand, by side.
    trackers: [HandTracker; Side::COUNT],
    progress: SessionProgress,
    is_running: bool,
}

impl HandSession {
    /// Starts a session with the active runtime. `name` is the source URI.
    pub fn open(name: &str) -> std::result::Result<Self, ConnectError> {
        let runtime = Runtime::open()?;
        let refused = |error| advice::no_session(&runtime.name, error);
        let session = create_session(&runtime.instance, runtime.system).map_err(refused)?;
        let space = |kind| session.create_reference_space(kind, Posef::IDENTITY);
        // The floor of the room does not move when the person looks elsewhere.
        let space = space(ReferenceSpaceType::STAGE)
            .or_else(|_| space(ReferenceSpaceType::LOCAL))
            .map_err(refused)?;
        let tracker = |hand| session.create_hand_tracker(hand).map_err(refused);
        let trackers = [tracker(Hand::LEFT)?, tracker(Hand::RIGHT)?];
        Ok(Self {
            name: name.to_owned(),
            session,
            space,
            trackers,
            progress: SessionProgress::new(Instant::now()),
            is_running: false,
            runtime,
        })
    }

    /// Returns the name of the runtime.
    pub fn runtime(&self) -> &str {
        &self.runtime.name
    }

    /// Returns the rate of the display in hertz, if the runtime states it.
    pub fn display_rate_hz(&self) -> Option<u32> {
        let extensions = self.runtime.instance.exts();
        extensions.fb_display_refresh_rate.as_ref()?;
        let rate = self.session.get_display_refresh_rate().ok()?;
        Some(rate.round() as u32)
    }

    /// Returns the hands now. An error ends the session.
    pub fn locate(&mut self) -> Result<TrackedHands> {
        self.handle_events()?;
        let now = self.runtime.instance.now().map_err(lost)?;
        let mut tracked = TrackedHands {
            time_us: u64::try_from(now.as_nanos() / 1000).unwrap_or_default(),
            ..TrackedHands::default()
        };
        if self.is_running {
            for &side in Side::ALL {
                tracked.hands[side.index()] = self.locate_hand(side, now)?;
            }
        }
        let has_hand = tracked.hands.iter().any(Option::is_some);
        let message = self.progress.locate(Instant::now(), has_hand);
        self.report(message);
        Ok(tracked)
    }

    /// Returns the measured joints of a hand, or `None` if there are none.
    fn locate_hand(&self, side: Side, time: Time) -> Result<Option<JointPositions>> {
        let tracker = &self.trackers[side.index()];
        let joints = self.space.locate_hand_joints(tracker, time).map_err(lost)?;
        let Some(joints) = joints else {
            return Ok(None);
        };
        // A position that is valid and not tracked is a guess, or an old one.
        let measured = SpaceLocationFlags::POSITION_VALID | SpaceLocationFlags::POSITION_TRACKED;
        let mut positions = JointPositions::default();
        let named = &Joint::ALL[Joint::Wrist.index()..];
        for (&joint, location) in named.iter().zip(&joints[BEFORE_WRIST..]) {
            let at = location.pose.position;
            let at = [at.x, at.y, at.z].map(f64::from);
            let is_measured = location.location_flags.contains(measured);
            if is_measured && at.iter().all(|axis| axis.is_finite()) {
                positions.set(joint, at.into());
            }
        }
        Ok(Some(positions).filter(|positions| !positions.is_empty()))
    }

    fn handle_events(&mut self) -> Result<()> {
        let mut buffer = EventDataBuffer::new();
        loop {
            let event = self.runtime.instance.poll_event(&mut buffer);
            let state = match event.map_err(lost)? {
                None => return Ok(()),
                Some(Event::SessionStateChanged(change)) => change.state(),
                Some(Event::InstanceLossPending(_)) => {
                    return Err(Error::other("the OpenXR runtime is about to end"));
                }
                Some(_) => continue,
            };
            let message = self.progress.change(state);
            match state {
                SessionState::READY => {
                    let views = ViewConfigurationType::PRIMARY_STEREO;
                    self.session.begin(views).map_err(lost)?;
                    self.is_running = true;
                }
                SessionState::STOPPING => {
                    self.is_running = false;
                    self.session.end().map_err(lost)?;
                }
                SessionState::EXITING => {
                    return Err(Error::other("the OpenXR runtime has ended the session"));
                }
                SessionState::LOSS_PENDING => {
                    return Err(Error::other(
                        "the OpenXR runtime is about to lose the headset",
                    ));
                }
                _ => {}
            }
            self.report(message);
        }
    }

    fn report(&self, message: Option<SessionMessage>) {
        let name = &self.name;
        match message {
            Some(message) if message.is_warning() => {
                tracing::warn!(source = name, "{name}: {}", message.text());
            }
            Some(message) => tracing::info!(source = name, "{name}: {}", message.text()),
            None => {}
        }
    }
}

#[expect(unsafe_code, reason = "a session could have graphics")]
fn create_session(instance: &Instance, system: SystemId) -> openxr::Result<Session<Headless>> {
    let info = headless::SessionCreateInfo {};
    // SAFETY: a session without graphics has no requirements of a graphics library.
    let (session, _, _) = unsafe { instance.create_session::<Headless>(system, &info) }?;
    Ok(session)
}

fn lost(error: openxr::sys::Result) -> Error {
    Error::other(format!("the OpenXR runtime has failed ({error:?})"))
}
