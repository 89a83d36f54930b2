//! The first start: pages that ask for the source, the hand and the layout, and the session that they lead to.

use std::fs;
use std::path::Path;

use ademan::files;
use ademan::message::escape_path;
use ademan::session::SessionHandle;
use ademan::setup::{OWN_SETUP, Setup};
use ademan::studio::first_start::{Answers, FirstStart, Search};
use ademan::studio::settings_file::SettingsFile;
use ademan::studio::{StudioApp, StudioStart, open_window, texts};

use super::sessions::Sessions;
use super::window::{NO_OUTPUT, end, language, live_app, live_options, start};
use super::{Args, source};
use crate::failure::Failure;
use crate::root_args::RootArgs;
use crate::{panics, session, signals};

/// Returns `true` if nothing says what to show: no argument, no setup of this person, and no settings of an earlier start.
pub fn is_first(args: &Args) -> bool {
    let settings = SettingsFile::default_path();
    (args.is_plain() || args.attach.is_some())
        && settings.is_some_and(|path| !path.exists())
        && files::in_config_folder(OWN_SETUP).is_none()
}

/// Shows the pages, and then the session, in one window.
pub fn open(root: RootArgs) -> Result<(), Failure> {
    session::prepare()?;
    texts::set_language(language());
    let sessions = Sessions::new(Setup::default(), None, root);
    let shown = panics::contain(|| {
        let first = FirstStart::new(Search::of_this_machine());
        let content = StudioStart::first(first, |request| sessions.open(request));
        open_window(content, signals::is_stop_requested)
    });
    end(shown, sessions.take())
}

/// Writes the setup, and starts the session of the answers.
pub(super) fn begin(answers: &Answers) -> Result<(StudioApp, SessionHandle), Failure> {
    let setup = Setup {
        output: NO_OUTPUT.into(),
        ..answers.setup.clone()
    };
    let mut options = live_options();
    let (setup, hand) = source::load(setup, &mut options)?;
    let session = start(setup, options)?;
    let app = live_app(&session, hand).map_err(|error| Failure::job(error.to_string()))?;
    if answers.is_kept {
        keep(&answers.setup)?;
    }
    Ok((app, session))
}

/// Writes the setup of every run without another one.
fn keep(setup: &Setup) -> Result<(), Failure> {
    let Some(folder) = files::config_folder() else {
        return Ok(());
    };
    let path = folder.join(OWN_SETUP);
    write(setup, &folder, &path).map_err(|error| {
        let path = escape_path(&path);
        Failure::wrong_use(format!(
            "cannot write {path}: {error}; change its permissions, or do not keep the setup"
        ))
    })?;
    say!(
        "wrote {}; next time: ademan run --output desktop",
        escape_path(&path)
    );
    Ok(())
}

fn write(setup: &Setup, folder: &Path, path: &Path) -> Result<(), files::FileError> {
    fs::create_dir_all(folder)?;
    files::replace(path, setup.first_text(path).as_bytes())
}
