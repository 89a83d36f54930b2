//! The first start: pages that ask for the source, the hand and the layout, and the session that they lead to.

use std::fs;
use std::path::Path;

use ademan::files;
use ademan::message::escape_path;
use ademan::session::SessionHandle;
use ademan::setup::{MirroredLayout, OWN_SETUP, Setup};
use ademan::studio::first_start::{Answers, FirstStart, Search};
use ademan::studio::settings_file::SettingsFile;
use ademan::studio::{StudioApp, StudioStart, open_window, texts};

use super::sessions::Sessions;
use super::window::{NO_OUTPUT, end, language, live_app, live_options, start};
use super::{Args, source};
use crate::failure::Failure;
use crate::root_args::RootArgs;
use crate::start::layout::Chosen;
use crate::{panics, pause_signals, session, signals};

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
    // SIGUSR1 to all programs of this name does not end the window.
    pause_signals::install_without_session()?;
    texts::set_language(language());
    let sessions = Sessions::new(Setup::default(), None, root);
    let shown = panics::contain(|| {
        let first = FirstStart::new(Search::of_this_machine());
        let content = StudioStart::first(first, |request| sessions.open(request));
        open_window(content, signals::is_stop_requested)
    });
    end(shown, sessions.take())
}

/// Returns the answers with the file of a mirrored layout, which is written.
pub(super) fn with_layout_file(answers: &Answers) -> Result<Answers, Failure> {
    let mut named = answers.clone();
    if let Some(mirrored) = named.mirrored.take() {
        let folder = files::config_folder().ok_or_else(|| {
            Failure::wrong_use(
                "this system has no configuration folder for the mirrored layout; choose another layout",
            )
        })?;
        named.setup.layout = write_layout(&mirrored, &folder)?;
    }
    Ok(named)
}

/// Writes a mirrored layout to a folder, unless its file is there, and returns the path.
fn write_layout(mirrored: &MirroredLayout, folder: &Path) -> Result<String, Failure> {
    fs::create_dir_all(folder).map_err(|error| {
        let shown = escape_path(folder);
        Failure::wrong_use(format!(
            "cannot create {shown}: {error}; choose another layout"
        ))
    })?;
    let layout = Chosen::mirrored(mirrored, &folder.join(OWN_SETUP))?;
    layout.write()?;
    Ok(layout.name)
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
        let shown = escape_path(&path);
        Failure::wrong_use(match error {
            files::FileError::Exists => format!(
                "{shown} was written since this window opened, and is not replaced; do not keep the setup, or start again to use that one"
            ),
            error => format!(
                "cannot write {shown}: {error}; change its permissions, or do not keep the setup"
            ),
        })
    })?;
    say!(
        "wrote {}; next time: ademan run --output desktop",
        escape_path(&path)
    );
    Ok(())
}

fn write(setup: &Setup, folder: &Path, path: &Path) -> Result<(), files::FileError> {
    fs::create_dir_all(folder)?;
    files::write_new(path, setup.first_text(path).as_bytes())
}

#[cfg(test)]
mod tests {
    use ademan::files::Load;
    use ademan::hand::Side;
    use ademan::layout::Layout;

    use super::*;

    #[test]
    fn a_setup_that_another_program_has_written_is_not_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let config = folder.path().join("ademan");
        let (path, setup) = (config.join(OWN_SETUP), Setup::default());
        write(&setup, &config, &path).expect("a file");
        fs::write(&path, "Setup()").expect("a write");
        let refused = write(&setup, &config, &path);
        assert!(matches!(refused, Err(files::FileError::Exists)));
        assert_eq!(fs::read_to_string(&path).expect("text"), "Setup()");
    }

    #[test]
    fn a_mirrored_layout_is_written_once_beside_the_setup() {
        let folder = tempfile::tempdir().expect("a folder");
        let config = folder.path().join("ademan");
        let source = "serial:/dev/ttyUSB0".parse().ok();
        let setup = Setup::for_hand(source, Side::Left, None);
        let mirrored = setup.mirrored_layout().expect("layouts").expect("one");
        let written = write_layout(&mirrored, &config).expect("a file");
        assert_eq!(Path::new(&written), config.join("qwerty-flat-left.ron"));
        let layout = Layout::load(&written).expect("a layout");
        assert_eq!(layout.name, "qwerty-flat-left");
        let edited = format!("// mine\n{}", fs::read_to_string(&written).expect("text"));
        fs::write(&written, &edited).expect("a write");
        let again = write_layout(&mirrored, &config).expect("the file");
        assert_eq!(again, written);
        assert_eq!(fs::read_to_string(&again).expect("text"), edited);
    }
}
