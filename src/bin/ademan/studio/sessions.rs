//! The session of the window, which is replaced by another one when the setup changes.

use std::cell::RefCell;
use std::time::Duration;

use ademan::command::Command;
use ademan::output;
use ademan::session::panic_keys::PanicKeysWatch;
use ademan::session::{CommandSender, Reply, SessionHandle};
use ademan::setup::Setup;
use ademan::studio::first_start::Answers;
use ademan::studio::setup_change::SetupChange;
use ademan::studio::{SessionRequest, StudioApp, StudioError};

use super::first;
use super::next_session::{CANCELLED, Next, Pending, watch_panic_keys};
use super::window::{NO_OUTPUT, live_app};
use crate::failure::Failure;
use crate::root_args::RootArgs;

/// Time for which the window waits for a session that starts: as long as a compositor usually takes.
const START_TIMEOUT: Duration = Duration::from_millis(300);

/// Time for which each picture waits after that.
const PICTURE_TIMEOUT: Duration = Duration::from_millis(10);

/// The setup of the window as it was named, and its session, unless that has not started or has ended.
pub struct Sessions {
    setup: RefCell<Setup>,
    running: RefCell<Option<SessionHandle>>,
    /// The next session, while none runs.
    pending: RefCell<Option<Pending>>,
    /// Notes panic keys from the end of one session until another one runs.
    panic_keys: RefCell<Option<PanicKeysWatch>>,
    root: RootArgs,
}

impl Sessions {
    /// Creates the sessions of a setup, of which one may run.
    pub fn new(setup: Setup, running: Option<SessionHandle>, root: RootArgs) -> Self {
        Self {
            setup: RefCell::new(setup),
            running: RefCell::new(running),
            pending: RefCell::default(),
            panic_keys: RefCell::default(),
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

    /// Returns the session, and leaves none. One whose outputs are not open is stopped.
    pub fn take(&self) -> Option<SessionHandle> {
        let Some(Pending { session, .. }) = self.pending.take() else {
            return self.running.take();
        };
        if session.wait_for_start(Duration::ZERO).is_some() {
            return Some(session);
        }
        session.abandon();
        None
    }

    /// Starts a session and returns the program for it, or the reason why there is none. `None` while its source or its outputs are not
    /// open.
    pub fn open(&self, request: SessionRequest) -> Result<Option<StudioApp>, String> {
        let opened = match request {
            SessionRequest::First(answers) => self.open_first(answers).map(Some),
            SessionRequest::Change(change, is_paused) => self.change(change, is_paused),
            SessionRequest::Wait => self.go_on(),
            SessionRequest::Cancel => self.cancel(),
        };
        opened.map_err(|failure| failure.to_string())
    }

    fn open_first(&self, answers: &Answers) -> Result<StudioApp, Failure> {
        let named = first::with_layout_file(answers)?;
        let (app, session) = first::begin(&named)?;
        let setup = Setup {
            output: NO_OUTPUT.into(),
            ..named.setup
        };
        self.replace(setup, session);
        Ok(app)
    }

    /// Starts a session with a change of the setup. The present session continues if a check finds that the change cannot be used;
    /// otherwise it ends, with everything released, before the other one starts. If that fails, a session on the setup before starts,
    /// which shows the reason.
    fn change(&self, change: &SetupChange, is_paused: bool) -> Result<Option<StudioApp>, Failure> {
        let before = self.setup.borrow().clone();
        let mut setup = change.apply(before.clone())?;
        setup.use_token_roles()?;
        let needs_resume = change.needs_resume(&setup);
        let next = Next::load(setup, &before.output)?;
        next.check_devices(&before)?;
        self.root.check(output::has_effect(&next.base.output))?;
        // The checks take time, in which the session may have been paused.
        let was_paused = is_paused || self.is_paused();
        *self.panic_keys.borrow_mut() = watch_panic_keys(&before);
        let ended = self.end_present();
        let is_paused_now = || was_paused || is_pause_requested(ended.as_ref());
        let launched = Pending::launch(next, || is_paused_now() || needs_resume);
        let back = (before, is_paused_now());
        match launched {
            Ok(pending) => {
                let back = Some(back);
                self.wait(Pending { back, ..pending }, START_TIMEOUT)
            }
            Err(failure) => self.go_back(back, ended.as_ref(), failure.to_string()),
        }
    }

    /// Returns `true` if the session runs and is paused.
    fn is_paused(&self) -> bool {
        let running = self.running.borrow();
        running.as_ref().is_some_and(|session| {
            let reply = session.commands().request(Command::State);
            matches!(reply, Ok(Reply::State(status)) if status.paused_by.is_some())
        })
    }

    /// Returns the program for the pending session once that has started.
    fn go_on(&self) -> Result<Option<StudioApp>, Failure> {
        match self.pending.take() {
            Some(pending) => self.wait(pending, PICTURE_TIMEOUT),
            None => Err(Failure::job(StudioError::Ended.to_string())),
        }
    }

    /// Stops the pending session. A session on the previous setup starts after it has ended, because only one of them can open a serial
    /// port.
    /// A session that has returned to the previous setup already continues.
    fn cancel(&self) -> Result<Option<StudioApp>, Failure> {
        let Some(mut pending) = self.pending.take() else {
            return Err(Failure::job(CANCELLED));
        };
        if pending.back.is_some() {
            pending.is_cancelled = true;
            // A session that has ended receives nothing.
            let _ = pending.session.commands().send(Command::Stop);
        }
        self.wait(pending, PICTURE_TIMEOUT)
    }

    /// Starts a session on the setup before, which shows why the change does not apply. Panic keys and signals may have paused the session
    /// that has `ended`.
    fn go_back(
        &self,
        (before, is_paused): (Setup, bool),
        ended: Option<&CommandSender>,
        reason: String,
    ) -> Result<Option<StudioApp>, Failure> {
        let written = before.output.clone();
        let next = Next::load(before, &written)?;
        let pending = Pending::launch(next, || is_paused || is_pause_requested(ended))?;
        let refusal = Some(reason);
        self.wait(Pending { refusal, ..pending }, START_TIMEOUT)
    }

    /// Waits for a session for at most `timeout`, and returns the program for it if it has started.
    fn wait(&self, mut pending: Pending, timeout: Duration) -> Result<Option<StudioApp>, Failure> {
        let Some(has_started) = pending.session.wait_for_start(timeout) else {
            *self.pending.borrow_mut() = Some(pending);
            return Ok(None);
        };
        let back = pending.back.take();
        let commands = pending.session.commands().clone();
        let shown = if has_started && !pending.is_cancelled {
            self.show(pending)
        } else {
            Err(pending.reason_of_end())
        };
        match (shown, back) {
            (Ok(app), _) => Ok(Some(app)),
            (Err(failure), Some(back)) => self.go_back(back, Some(&commands), failure.to_string()),
            (Err(failure), None) => Err(failure),
        }
    }

    /// Returns the program for a session that has started.
    fn show(&self, pending: Pending) -> Result<StudioApp, Failure> {
        let Pending { session, next, .. } = pending;
        let app = live_app(&session, next.hand).map_err(|error| Failure::job(error.to_string()))?;
        self.replace(next.base, session);
        // The session watches its own.
        *self.panic_keys.borrow_mut() = None;
        let app = app.with_arm(next.arm.as_ref()).with_headset(next.headset);
        Ok(match pending.refusal {
            Some(reason) => app.with_refusal(reason),
            None => app,
        })
    }

    /// Ends the session, if it has not ended, and releases everything. Returns its commands, which note a pause that comes too late.
    fn end_present(&self) -> Option<CommandSender> {
        let session = self.take()?;
        let commands = session.commands().clone();
        // A session that has ended receives nothing.
        let _ = commands.send(Command::Stop);
        if let Err(error) = session.join() {
            complain!("{error}");
        }
        Some(commands)
    }

    fn replace(&self, setup: Setup, session: SessionHandle) {
        *self.setup.borrow_mut() = setup;
        *self.running.borrow_mut() = Some(session);
    }
}

/// Returns `true` if panic keys or a signal have asked a session to pause, also after its end.
fn is_pause_requested(ended: Option<&CommandSender>) -> bool {
    ended.is_some_and(CommandSender::is_pause_requested)
}

#[cfg(test)]
mod tests {
    use ademan::command::CommandOrigin;
    use ademan::pipeline::PipelineState;
    use ademan::session::view::View;

    use super::*;

    const LONGEST_WAIT: Duration = Duration::from_secs(60);

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
        let pending = Pending::launch(next, || false).expect("a session");
        started(&sessions, sessions.wait(pending, START_TIMEOUT)).expect("a session that runs");
        sessions
    }

    /// Waits until a session has started, and returns the program for it.
    fn started(
        sessions: &Sessions,
        opened: Result<Option<StudioApp>, Failure>,
    ) -> Result<StudioApp, Failure> {
        let mut latest = opened;
        let start = std::time::Instant::now();
        loop {
            match latest? {
                Some(app) => return Ok(app),
                None => latest = sessions.go_on(),
            }
            assert!(start.elapsed() < LONGEST_WAIT, "it does not start");
        }
    }

    /// Changes the setup, and waits until the session has started.
    fn changed(
        sessions: &Sessions,
        change: &SetupChange,
        is_paused: bool,
    ) -> Result<StudioApp, Failure> {
        started(sessions, sessions.change(change, is_paused))
    }

    /// Returns `true` if the session runs.
    fn is_running(sessions: &Sessions) -> bool {
        let viewer = sessions.program(|session| Ok(session.add_viewer()));
        viewer.is_ok_and(|found| found.views().recv_timeout(LONGEST_WAIT).is_ok())
    }

    /// Returns the first view of the session after its start.
    fn first_view(sessions: &Sessions) -> View {
        let viewer = sessions.program(|session| Ok(session.add_viewer()));
        let viewer = viewer.expect("a session");
        let mut views = std::iter::from_fn(|| viewer.views().recv_timeout(LONGEST_WAIT).ok());
        let first = views.find(|view| view.state.state != PipelineState::Starting);
        first.expect("a view of the running session")
    }

    fn other(uri: &str) -> SetupChange {
        SetupChange::Source(Some(uri.parse().expect("a source")))
    }

    #[cfg(unix)]
    const SIGNAL_TEST: &str =
        "studio::sessions::tests::sigusr1_pauses_the_session_of_the_window_also_after_a_change";

    #[cfg(unix)]
    #[test]
    fn sigusr1_pauses_the_session_of_the_window_also_after_a_change() {
        use nix::sys::signal::{Signal, raise};

        // Other tests replace the session that the signal pauses.
        if !crate::own_process::has_own_process(SIGNAL_TEST) {
            return;
        }
        let sessions = sessions();
        for change in [None, Some(other("typist:8462"))] {
            if let Some(change) = &change {
                let commands = sessions.program(|session| Ok(session.commands().clone()));
                let commands = commands.expect("a session");
                commands.send(Command::Resume).expect("it runs");
                changed(&sessions, change, false).expect("another session");
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
            let refused = changed(&sessions, &change, false);
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
        changed(&sessions, &output, false).expect("the session before");
        assert_eq!(*sessions.setup.borrow(), before);
        assert!(is_running(&sessions));
    }

    #[test]
    fn a_transcript_goes_on_in_a_file_beside_it() {
        let sessions = sessions();
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("events");
        let output = SetupChange::Output(format!("transcript:{}", file.display()));
        changed(&sessions, &output, false).expect("a transcript");
        let app = changed(&sessions, &other("typist:8462"), false);
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
        changed(&sessions, &change, true).expect("another session");
        let view = first_view(&sessions);
        assert_eq!(view.state.state, PipelineState::Paused);
        assert!(view.state.paused_by.is_some());
        let is_armed = |notice: &String| notice.starts_with("armed");
        assert!(!view.messages.iter().any(is_armed), "{:?}", view.messages);
    }

    #[test]
    fn a_pause_that_the_window_does_not_show_yet_is_for_the_next_session() {
        let sessions = sessions();
        let commands = sessions.program(|session| Ok(session.commands().clone()));
        let commands = commands.expect("a session");
        commands.send(Command::Pause).expect("it runs");
        let change = SetupChange::Layout("arrows".into());
        changed(&sessions, &change, false).expect("another session");
        assert_eq!(first_view(&sessions).state.state, PipelineState::Paused);
    }

    #[test]
    fn a_signal_after_the_end_of_a_session_pauses_the_next_one() {
        let sessions = sessions();
        let before = sessions.setup.borrow().clone();
        let ended = sessions.end_present().expect("a session");
        let signal = ended.with_origin(CommandOrigin::Signal);
        assert!(signal.send(Command::Pause).is_err(), "no session runs");
        let opened = sessions.go_back((before, false), Some(&ended), "a reason".into());
        started(&sessions, opened).expect("the session before");
        assert_eq!(first_view(&sessions).state.state, PipelineState::Paused);
    }

    #[test]
    fn another_source_replaces_the_session() {
        let sessions = sessions();
        let first = sessions.program(|session| Ok(session.commands().clone()));
        let change = other("typist:8462");
        changed(&sessions, &change, false).expect("another session");
        assert_eq!(sessions.setup.borrow().source, "typist:8462".parse().ok());
        let first = first.expect("the first session");
        assert!(first.send(Command::State).is_err(), "it has ended");
    }

    /// Returns a session that is about to replace the one of the window, which has ended. `back` is the setup before, unless it is on
    /// that one already.
    fn pending(sessions: &Sessions, back: Option<Setup>) -> Pending {
        sessions.end_present();
        let setup = Setup {
            layout: "arrows".into(),
            ..sessions.setup.borrow().clone()
        };
        let next = Next::load(setup, "").expect("a setup");
        let launched = Pending::launch(next, || false).expect("a session");
        Pending {
            back: back.map(|before| (before, false)),
            ..launched
        }
    }

    #[test]
    fn a_change_that_is_cancelled_ends_before_the_session_that_it_leads_back_to() {
        let sessions = sessions();
        let before = sessions.setup.borrow().clone();
        let pending = pending(&sessions, Some(before.clone()));
        let cancelled = pending.session.commands().clone();
        *sessions.pending.borrow_mut() = Some(pending);
        started(&sessions, sessions.cancel()).expect("the session before");
        let sent = cancelled.send(Command::State);
        assert!(sent.is_err(), "its source is free");
        assert_eq!(*sessions.setup.borrow(), before);
        let state = first_view(&sessions).state;
        assert!(state.paused_by.is_none(), "{state:?}");
        assert!(sessions.cancel().is_err(), "nothing is pending");
        assert!(is_running(&sessions));
    }

    #[test]
    fn a_pause_of_a_signal_stays_after_a_change_that_is_cancelled() {
        let sessions = sessions();
        let before = sessions.setup.borrow().clone();
        let pending = pending(&sessions, Some(before));
        let commands = pending.session.commands();
        let signal = commands.with_origin(CommandOrigin::Signal);
        signal.send(Command::Pause).expect("a session");
        *sessions.pending.borrow_mut() = Some(pending);
        started(&sessions, sessions.cancel()).expect("the session before");
        assert_eq!(first_view(&sessions).state.state, PipelineState::Paused);
    }

    #[test]
    fn a_session_on_the_setup_before_is_not_cancelled() {
        let sessions = sessions();
        let pending = pending(&sessions, None);
        let kept = pending.session.commands().clone();
        *sessions.pending.borrow_mut() = Some(pending);
        started(&sessions, sessions.cancel()).expect("the session goes on");
        kept.send(Command::State).expect("it runs");
        assert_eq!(sessions.setup.borrow().layout, "arrows");
    }
}
