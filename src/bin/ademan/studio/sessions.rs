//! The session of the window, which is replaced by another one when the setup changes.

use std::cell::RefCell;

use ademan::capture::{self, SourceUri};
use ademan::command::Command;
use ademan::message::escape;
use ademan::output;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::{LoadedSetup, Setup, continued_outputs};
use ademan::studio::first_start::Answers;
use ademan::studio::setup_change::SetupChange;
use ademan::studio::simulated::HandControl;
use ademan::studio::{SessionRequest, StudioApp, StudioError};

use super::window::{NO_OUTPUT, launch, live_app, live_options};
use super::{first, headset_link, source};
use crate::failure::Failure;
use crate::root_args::RootArgs;

/// The setup of the window as it was named, and its session, unless that has not started or has ended.
pub struct Sessions {
    setup: RefCell<Setup>,
    running: RefCell<Option<SessionHandle>>,
    root: RootArgs,
}

impl Sessions {
    /// Creates the sessions of a setup, of which one may run.
    pub fn new(setup: Setup, running: Option<SessionHandle>, root: RootArgs) -> Self {
        Self {
            setup: RefCell::new(setup),
            running: RefCell::new(running),
            root,
        }
    }

    /// Creates what a window shows of the session.
    pub fn program<T>(
        &self,
        create: impl FnOnce(&SessionHandle) -> Result<T, StudioError>,
    ) -> Result<T, StudioError> {
        create(self.running.borrow().as_ref().ok_or(StudioError::Ended)?)
    }

    /// Returns the session, and leaves none.
    pub fn take(&self) -> Option<SessionHandle> {
        self.running.take()
    }

    /// Starts a session and returns the program for it, or the reason why there is none.
    pub fn open(&self, request: SessionRequest) -> Result<StudioApp, String> {
        let opened = match request {
            SessionRequest::First(answers) => self.open_first(answers),
            SessionRequest::Change(change, is_paused) => self.change(change, is_paused),
        };
        opened.map_err(|failure| failure.to_string())
    }

    fn open_first(&self, answers: &Answers) -> Result<StudioApp, Failure> {
        let (app, session) = first::begin(answers)?;
        let setup = Setup {
            output: NO_OUTPUT.into(),
            ..answers.setup.clone()
        };
        self.replace(setup, session);
        Ok(app)
    }

    /// Starts a session with a change of the setup. The present session goes on if a check finds that the change cannot be used;
    /// otherwise it ends, with everything released, before the other one starts. If that fails, a session on the setup before starts,
    /// which shows the reason.
    fn change(&self, change: &SetupChange, is_paused: bool) -> Result<StudioApp, Failure> {
        let before = self.setup.borrow().clone();
        let mut setup = change.apply(before.clone())?;
        setup.use_token_roles()?;
        let needs_resume = change.needs_resume(&setup);
        let next = Next::load(setup, &before.output)?;
        next.check_devices(&before)?;
        self.root.check(output::has_effect(&next.base.output))?;
        self.end_present();
        let failure = match self.begin(next, is_paused || needs_resume) {
            Ok(app) => return Ok(app),
            Err(failure) => failure,
        };
        let written = before.output.clone();
        let app = self.begin(Next::load(before, &written)?, is_paused)?;
        Ok(app.with_refusal(failure.to_string()))
    }

    /// Ends the session, if it has not ended, and releases everything.
    fn end_present(&self) {
        let Some(session) = self.take() else {
            return;
        };
        // A session that has ended receives nothing.
        let _ = session.commands().send(Command::Stop);
        if let Err(error) = session.join() {
            complain!("{error}");
        }
    }

    fn begin(&self, next: Next, is_paused: bool) -> Result<StudioApp, Failure> {
        let arm = next.loaded.arm_document().cloned();
        let headset = headset_link(&next.loaded)?;
        let session = launch(next.loaded, next.options)?;
        if is_paused {
            // Queued before the first reading, which arms the output of a setup with `arm_immediately`. A session that has ended
            // receives nothing.
            let _ = session.commands().send(Command::Pause);
        }
        if !session.wait_until_started() {
            session.join()?;
            return Err(Failure::job(StudioError::Ended.to_string()));
        }
        let app = live_app(&session, next.hand).map_err(|error| Failure::job(error.to_string()))?;
        self.replace(next.base, session);
        Ok(app.with_arm(arm.as_ref()).with_headset(headset))
    }

    fn replace(&self, setup: Setup, session: SessionHandle) {
        *self.setup.borrow_mut() = setup;
        *self.running.borrow_mut() = Some(session);
    }
}

/// A setup whose files are loaded, for the next session.
struct Next {
    /// The setup before its files were loaded.
    base: Setup,
    loaded: LoadedSetup,
    options: SessionOptions,
    hand: Option<HandControl>,
}

impl Next {
    /// Loads the files of a setup. `written` are the outputs of the session before, whose transcripts exist.
    fn load(base: Setup, written: &str) -> Result<Self, Failure> {
        let mut options = live_options();
        let setup = Setup {
            output: continued_outputs(&base.output, written),
            ..base.clone()
        };
        let (loaded, hand) = source::load(setup, &mut options)?;
        Ok(Self {
            base,
            loaded,
            options,
            hand,
        })
    }

    /// Checks the outputs, and the sources that the session `before` does not read: it would be in the way of a check of its own.
    fn check_devices(&self, before: &Setup) -> Result<(), Failure> {
        output::check(
            &self.loaded.setup.output,
            &self.loaded.required_capabilities(),
        )?;
        let is_used = |uri: &&SourceUri| before.source_uris().any(|used| is_same_device(used, uri));
        let new = self.base.source_uris().filter(|uri| !is_used(uri));
        for uri in new {
            check_source(uri)?;
        }
        Ok(())
    }
}

/// Returns `true` if two sources read from one device or address.
fn is_same_device(one: &SourceUri, other: &SourceUri) -> bool {
    match (one, other) {
        (SourceUri::Stream(one), SourceUri::Stream(other)) => one.address == other.address,
        _ => one == other,
    }
}

/// Checks that a source can be opened. One that cannot be checked without an effect counts as present; a serial port is opened.
fn check_source(uri: &SourceUri) -> Result<(), Failure> {
    if uri.serial_port().is_some() {
        return Ok(capture::open(uri).map(drop)?);
    }
    match uri.probe() {
        Some(Err(reason)) => Err(Failure::wrong_use(format!(
            "cannot open `{}`: {reason}",
            escape(&uri.to_string())
        ))),
        Some(Ok(())) | None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use ademan::pipeline::PipelineState;

    use super::*;

    /// Starts the session of a window with the simulated hand.
    fn sessions() -> Sessions {
        sessions_of(Setup::default())
    }

    /// Starts the session of a window with the simulated hand and the rest of a setup.
    fn sessions_of(setup: Setup) -> Sessions {
        let sessions = Sessions::new(Setup::default(), None, RootArgs::default());
        let setup = Setup {
            output: NO_OUTPUT.into(),
            layout: "numpad".into(),
            ..setup
        };
        let next = Next::load(setup, "").expect("a setup that comes with the program");
        sessions.begin(next, false).expect("a session");
        sessions
    }

    /// Returns `true` if the session runs.
    fn is_running(sessions: &Sessions) -> bool {
        let view = sessions.program(|session| Ok(session.add_viewer().views().recv().is_ok()));
        view.is_ok_and(|has_view| has_view)
    }

    fn other(uri: &str) -> SetupChange {
        SetupChange::Source(Some(uri.parse().expect("a source")))
    }

    /// The environment variable that makes a test send itself a signal. Other tests of this program replace the session that it pauses.
    #[cfg(unix)]
    const IS_SIGNALLED: &str = "ADEMAN_TEST_SIGNALLED";

    #[cfg(unix)]
    const SIGNAL_TEST: &str =
        "studio::sessions::tests::sigusr1_pauses_the_session_of_the_window_also_after_a_change";

    #[cfg(unix)]
    #[test]
    fn sigusr1_pauses_the_session_of_the_window_also_after_a_change() {
        use ademan::command::CommandOrigin;
        use nix::sys::signal::{Signal, raise};

        if std::env::var_os(IS_SIGNALLED).is_none() {
            let program = std::env::current_exe().expect("its path");
            let mut test = std::process::Command::new(program);
            test.args(["--exact", SIGNAL_TEST]).env(IS_SIGNALLED, "1");
            let ended = test.output().expect("this program");
            let printed = String::from_utf8_lossy(&ended.stdout);
            assert!(ended.status.success(), "{}: {printed}", ended.status);
            assert!(printed.contains("1 passed"), "{printed}");
            return;
        }
        let sessions = sessions();
        for change in [None, Some(other("typist:8462"))] {
            if let Some(change) = &change {
                sessions.change(change, false).expect("another session");
            }
            let viewer = sessions.program(|session| Ok(session.add_viewer()));
            let viewer = viewer.expect("a session");
            raise(Signal::SIGUSR1).expect("a signal");
            let mut views = viewer.views().iter();
            let by_signal = Some(CommandOrigin::Signal);
            let is_paused = views.any(|view| view.state.paused_by == by_signal);
            assert!(is_paused, "after {change:?}");
        }
    }

    #[test]
    fn a_change_that_cannot_be_used_says_why_and_leaves_the_session() {
        let sessions = sessions();
        let before = sessions.setup.borrow().clone();
        let first = sessions.program(|session| Ok(session.commands().clone()));
        let first = first.expect("a session");
        for (change, reason) in [
            (other("serial:/dev/no-such-port"), "/dev/no-such-port"),
            (other("recording:no/such.mcap"), "no/such.mcap"),
            (other("file:no/such/file"), "no/such/file"),
            (SetupChange::Output("paper".into()), "paper"),
            (SetupChange::Output("osc:127.0.0.1:9".into()), "osc"),
            (
                SetupChange::Glove(Some("no/such.ron".into())),
                "no/such.ron",
            ),
            (SetupChange::File("no/such.ron".into()), "no/such.ron"),
        ] {
            let refused = sessions.change(&change, false);
            let message = refused.err().expect("it cannot be used").to_string();
            assert!(message.contains(reason), "{message}");
            assert_eq!(*sessions.setup.borrow(), before, "{change:?}");
            first.send(Command::State).expect("the first session runs");
        }
    }

    #[test]
    fn what_fails_only_when_it_is_opened_leads_back_to_the_setup_before() {
        let sessions = sessions();
        let before = sessions.setup.borrow().clone();
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("missing/events");
        let output = SetupChange::Output(format!("transcript:{}", file.display()));
        sessions.change(&output, false).expect("the session before");
        assert_eq!(*sessions.setup.borrow(), before);
        assert!(is_running(&sessions));
    }

    #[test]
    fn a_transcript_goes_on_in_a_file_beside_it() {
        let sessions = sessions();
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("events");
        let output = SetupChange::Output(format!("transcript:{}", file.display()));
        sessions.change(&output, false).expect("a transcript");
        let app = sessions.change(&other("typist:8462"), false);
        app.expect("another session");
        assert_eq!(sessions.setup.borrow().source, "typist:8462".parse().ok());
        for name in ["events", "events.2"] {
            assert!(folder.path().join(name).is_file(), "{name}");
        }
    }

    #[test]
    fn a_session_that_starts_paused_is_never_armed_before() {
        let sessions = sessions_of(Setup {
            arm_immediately: true,
            ..Setup::default()
        });
        let change = SetupChange::Layout("numpad".into());
        sessions.change(&change, true).expect("another session");
        let viewer = sessions.program(|session| Ok(session.add_viewer()));
        let viewer = viewer.expect("a session");
        let mut views = viewer.views().iter();
        let first = views.find(|view| view.state.state != PipelineState::Starting);
        let view = first.expect("a view of the running session");
        assert_eq!(view.state.state, PipelineState::Paused);
        assert!(view.state.paused_by.is_some());
        let is_armed = |notice: &String| notice.starts_with("armed");
        assert!(!view.messages.iter().any(is_armed), "{:?}", view.messages);
    }

    #[test]
    fn another_source_replaces_the_session() {
        let sessions = sessions();
        let first = sessions.program(|session| Ok(session.commands().clone()));
        let change = other("typist:8462");
        sessions.change(&change, false).expect("another session");
        assert_eq!(sessions.setup.borrow().source, "typist:8462".parse().ok());
        let first = first.expect("the first session");
        assert!(first.send(Command::State).is_err(), "it has ended");
    }
}
