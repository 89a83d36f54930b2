//! The session of Studio and its window.

use std::env;
use std::path::Path;

use ademan::capture::recording::Replay;
use ademan::command::Command;
use ademan::document::Document;
use ademan::files::OpenDocument;
use ademan::layout::Layout;
use ademan::output;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::{LoadedSetup, ReplaySettings, Setup};
use ademan::studio::headset::HeadsetLink;
use ademan::studio::playback::{OpenError, Player, Recording};
use ademan::studio::settings_file::SettingsFile;
use ademan::studio::texts::{self, Language};
use ademan::studio::{Overlay, StudioApp, StudioError, open_overlay, open_window};

use super::{Args, first, headset_link, mesa, source};
use crate::failure::Failure;
use crate::{panics, session, signals, stats, watchdog};

/// The outputs, unless a setup file names others: nothing is typed into other programs by surprise.
const NO_OUTPUT: &str = "none";

pub fn open(args: Args) -> Result<(), Failure> {
    mesa::draw_in_one_thread();
    if first::is_first(&args) {
        return first::open();
    }
    let mut options = live_options();
    let root = args.root;
    let is_overlay = args.overlay;
    let is_placed = args.place;
    let player = args.recording.as_deref();
    let player = player.map(|path| open_player(path, args.layout.as_deref()));
    let player = player.transpose()?;
    let (setup, refused) = load_or_edit(args, &mut options)?;
    root.check(output::has_effect(&setup.setup.output))?;
    session::prepare()?;
    let content = Content {
        player,
        arm: setup.arm_document().cloned(),
        refused,
        headset: headset_link(&setup)?,
    };
    let session = start(setup, options)?;
    texts::set_language(language());
    let shown = panics::contain(|| match is_overlay {
        true => show_overlay(&session, is_placed),
        false => show_window(&session, content),
    });
    end(shown, Some(session))
}

/// Returns the options of a session in its own time that follows its layout files.
pub(super) fn live_options() -> SessionOptions {
    SessionOptions {
        speed: Some(1.0),
        watch_layouts: true,
        report_status: true,
        ..SessionOptions::default()
    }
}

/// Starts a session that prints its notices, and waits until its outputs are open.
pub(super) fn start(
    setup: LoadedSetup,
    mut options: SessionOptions,
) -> Result<SessionHandle, Failure> {
    options.watchdog = Some(watchdog::program(Command::Pause)?);
    options.use_panic_keys = setup.setup.output != NO_OUTPUT;
    options.on_notice = Some(session::print_notices());
    let session = session::start(setup, options)?;
    session.wait_until_started();
    Ok(session)
}

/// Ends the session, if there is one, after its window. `shown` is `None` if the window has failed.
pub(super) fn end(
    shown: Option<Result<(), StudioError>>,
    session: Option<SessionHandle>,
) -> Result<(), Failure> {
    match (shown, &session) {
        (Some(Ok(())), Some(session)) => _ = session.commands().send(Command::Stop),
        // The error of the session says more.
        (Some(Ok(())), None) | (Some(Err(StudioError::Ended)), _) => {}
        (Some(Err(error)), _) => {
            let error = error.with_variables(|name| env::var(name).ok());
            return Err(Failure::wrong_use(error.to_string()));
        }
        (None, Some(_)) => {
            complain!("the window has failed; the session goes on, and Ctrl-C ends it");
        }
        (None, None) => complain!("the window has failed"),
    }
    session.map_or(Ok(()), |session| stats::report(session.join()?))
}

/// What the window shows beside the session.
struct Content {
    player: Option<Player>,
    arm: Option<Document>,
    /// A layout that the session cannot use: it is opened in the editor.
    refused: Option<String>,
    headset: Option<HeadsetLink>,
}

fn show_window(session: &SessionHandle, content: Content) -> Result<(), StudioError> {
    let mut app = match content.player {
        Some(player) => with_settings(StudioApp::new(session)?.with_player(player)),
        None => live_app(session)?,
    };
    app = app
        .with_arm(content.arm.as_ref())
        .with_headset(content.headset);
    let refused = content.refused.as_deref();
    if let Some(error) = refused.and_then(|name| app.edit(name).err()) {
        complain!("{error}");
    }
    open_window(app.into(), signals::is_stop_requested)
}

/// Returns the program for a session, with clicks and with the settings of this person.
pub(super) fn live_app(session: &SessionHandle) -> Result<StudioApp, StudioError> {
    Ok(with_settings(StudioApp::new(session)?.with_sound(session)))
}

fn with_settings(app: StudioApp) -> StudioApp {
    match SettingsFile::default_path() {
        Some(path) => app.with_settings(path),
        None => app,
    }
}

fn show_overlay(session: &SessionHandle, is_placed: bool) -> Result<(), StudioError> {
    let mut overlay = Overlay::new(session, is_placed)?;
    let path = SettingsFile::default_path();
    if let Some(error) = path.and_then(|path| overlay.restore(path)) {
        complain!("{error}");
    }
    if let Some(limitation) = overlay.limitation() {
        say!("{limitation}");
    }
    open_overlay(overlay, signals::is_stop_requested)
}

/// Returns the language of messages, as the environment names it.
pub(super) fn language() -> Language {
    let set = |name| env::var(name).ok().filter(|value| !value.is_empty());
    let locale = ["LC_ALL", "LC_MESSAGES", "LANG"].into_iter().find_map(set);
    Language::from_locale(&locale.unwrap_or_default())
}

/// Opens a recording, which the window shows in place of its session.
fn open_player(path: &Path, layout: Option<&str>) -> Result<Player, Failure> {
    let player = Recording::open(path, layout).and_then(Player::open);
    player.map_err(|error| match error {
        OpenError::Capture(error) => error.into(),
        OpenError::Setup(error) => error.into(),
        OpenError::Thread(_) => Failure::wrong_use(error.to_string()),
    })
}

/// Loads the setup. If its layout is a file with faults, the session has the default layout, and the name of the file is returned.
fn load_or_edit(
    args: Args,
    options: &mut SessionOptions,
) -> Result<(LoadedSetup, Option<String>), Failure> {
    let is_edited = args.recording.is_none() && !args.overlay;
    let layout = args.layout.clone();
    let retry = Args {
        layout: Some(Setup::default().layout),
        ..args.clone()
    };
    let error = match load(args, options) {
        Ok(setup) => return Ok((setup, None)),
        Err(error) => error,
    };
    let layout = match (layout, &retry.setup) {
        (Some(layout), _) => layout,
        (None, Some(path)) => Setup::load(path)?.layout,
        (None, None) => return Err(error),
    };
    let is_refused = Document::open(&layout)
        .is_ok_and(|document| document.path.is_some() && Layout::from_document(document).is_err());
    if !is_edited || !is_refused {
        return Err(error);
    }
    complain!(
        "{error}\nthe window opens it in the editor; the session has another layout until it can be used"
    );
    Ok((load(retry, options)?, Some(layout)))
}

/// Loads the setup, with a simulated hand as the source where it has none.
fn load(args: Args, options: &mut SessionOptions) -> Result<LoadedSetup, Failure> {
    if let Some(path) = &args.recording {
        let replay = Replay::open(path)?;
        let settings = ReplaySettings {
            glove: args.glove.as_deref(),
            layout: args.layout.as_deref(),
            permissions: None,
        };
        let mut setup = LoadedSetup::from_recording(replay.setup(), &settings)?;
        setup.setup.output = NO_OUTPUT.into();
        options.source = Some(Box::new(source::NoReadings));
        return Ok(setup);
    }
    let mut setup = match &args.setup {
        Some(path) => Setup::load(path)?,
        None => Setup {
            output: NO_OUTPUT.into(),
            ..Setup::default()
        },
    };
    setup.source = args.source.or(setup.source);
    setup.glove = args.glove.or(setup.glove);
    setup.person = args.person.or(setup.person);
    setup.layout = args.layout.unwrap_or(setup.layout);
    if args.place {
        setup.output = NO_OUTPUT.into();
    }
    setup.use_token_roles()?;
    let setup = setup.load_files()?;
    if setup.setup.source.is_none() {
        options.source = Some(Box::new(source::simulated_hand(&setup)?));
    }
    Ok(setup)
}

#[cfg(test)]
mod tests {
    use ademan::hand::Side;
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct CommandLine {
        #[command(flatten)]
        args: Args,
    }

    #[test]
    fn the_person_of_the_command_line_has_the_simulated_hand_and_the_reach() {
        let load = |line: &[&str]| {
            let line = CommandLine::try_parse_from(line).expect("the flag is known");
            let mut options = SessionOptions::default();
            load(line.args, &mut options).expect("a person that comes with the program")
        };
        let small = load(&[
            "studio",
            "--layout",
            "chords-bend",
            "--person",
            "left-small",
        ]);
        assert_eq!(small.arm.side(), Side::Left);
        assert_eq!(small.simulated_person.side, Some(Side::Left));
        let reach = |setup: &LoadedSetup| setup.arm.reach().expect("a reach").length;
        let usual = load(&["studio", "--layout", "chords-bend"]);
        assert!(reach(&small) < reach(&usual));
    }

    #[test]
    fn the_glove_of_the_command_line_replaces_that_of_the_setup() {
        let line = ["studio", "--glove", "lucidgloves-left"];
        let line = CommandLine::try_parse_from(line).expect("the flag is known");
        let mut options = SessionOptions::default();
        let setup = load(line.args, &mut options).expect("a glove that comes with the program");
        let glove = setup.glove.expect("the glove");
        assert_eq!((glove.side, glove.map.full_scale()), (Side::Left, 4095));
        assert!(options.source.is_some(), "a simulated hand wears it");
    }
}
