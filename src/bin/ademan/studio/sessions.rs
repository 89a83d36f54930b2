//! The session of the window, which is replaced by another one on another layout.

use std::cell::RefCell;

use ademan::command::Command;
use ademan::session::SessionHandle;
use ademan::setup::Setup;
use ademan::studio::first_start::Answers;
use ademan::studio::{SessionRequest, StudioApp, StudioError};

use super::window::{NO_OUTPUT, live_app, live_options, start};
use super::{first, headset_link, source};
use crate::failure::Failure;

/// The setup of the window as it was named, and its session, unless that has not started or has ended.
pub struct Sessions {
    setup: RefCell<Setup>,
    running: RefCell<Option<SessionHandle>>,
}

impl Sessions {
    /// Creates the sessions of a setup, of which one may run.
    pub fn new(setup: Setup, running: Option<SessionHandle>) -> Self {
        Self {
            setup: RefCell::new(setup),
            running: RefCell::new(running),
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
            SessionRequest::Layout(layout, is_paused) => self.open_layout(layout, is_paused),
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

    /// Starts a session on another layout. The present session goes on if the layout cannot be used; otherwise it ends, with everything
    /// released, before the other one starts.
    fn open_layout(&self, layout: &str, is_paused: bool) -> Result<StudioApp, Failure> {
        let setup = Setup {
            layout: layout.to_owned(),
            ..self.setup.borrow().clone()
        };
        let mut options = live_options();
        let (loaded, hand) = source::load(setup.clone(), &mut options)?;
        let arm = loaded.arm_document().cloned();
        let headset = headset_link(&loaded)?;
        if let Some(session) = self.take() {
            // A session that has ended receives nothing.
            let _ = session.commands().send(Command::Stop);
            session.join()?;
        }
        let session = start(loaded, options)?;
        if is_paused {
            // Before it is armed, which takes a hand that is clear of every key.
            let _ = session.commands().send(Command::Pause);
        }
        let app = live_app(&session, hand).map_err(|error| Failure::job(error.to_string()))?;
        self.replace(setup, session);
        Ok(app.with_arm(arm.as_ref()).with_headset(headset))
    }

    fn replace(&self, setup: Setup, session: SessionHandle) {
        *self.setup.borrow_mut() = setup;
        *self.running.borrow_mut() = Some(session);
    }
}
