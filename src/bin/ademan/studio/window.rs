//! The session of Studio and its window.

use std::env;
use std::path::Path;

use ademan::capture::recording::Replay;
use ademan::command::Command;
use ademan::document::{Document, FileKind};
use ademan::files::OpenDocument;
use ademan::layout::Layout;
use ademan::output;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::{LoadedSetup, ReplaySettings, Setup};
use ademan::studio::playback::{OpenError, Player, Recording};
use ademan::studio::settings_file::SettingsFile;
use ademan::studio::simulated::HandControl;
use ademan::studio::texts::{self, Language};
use ademan::studio::{
    Overlay, PictureFormats, StudioApp, StudioError, StudioStart, open_overlay, open_window,
};

use super::sessions::Sessions;
use super::{Args, attach, first, headset_link, mesa, source};
use crate::failure::Failure;
use crate::picture::convert;
use crate::setup_args::role_beside;
use crate::{panics, pause_signals, session, signals, stats, watchdog};

/// The outputs, unless a setup file or the person names others: nothing is typed into other programs by surprise.
pub(super) const NO_OUTPUT: &str = "none";

/// The formats of exported pictures.
pub(super) const PICTURES: PictureFormats = PictureFormats {
    png: convert::png,
    pdf: convert::pdf,
};

pub fn open(args: Args) -> Result<(), Failure> {
    mesa::draw_in_one_thread();
    if let Some(session) = attach::find(&args)? {
        return attach::open(session);
    }
    if first::is_first(&args) {
        return first::open(args.root);
    }
    let mut options = live_options();
    let root = args.root;
    let is_overlay = args.overlay;
    let is_placed = args.place;
    let player = args.recording.as_deref();
    let player = player.map(|path| open_player(path, args.layout.as_deref()));
    let player = player.transpose()?;
    let (loaded, refused) = load_or_edit(args, &mut options)?;
    let Loaded { base, setup, hand } = loaded;
    root.check(output::has_effect(&setup.setup.output))?;
    session::prepare()?;
    let arm = setup.arm_document().cloned();
    let headset = headset_link(&setup)?;
    let session = start(setup, options)?;
    texts::set_language(language());
    let sessions = Sessions::new(base, Some(session), root);
    let shown = panics::contain(|| {
        if is_overlay {
            return show_overlay(sessions.program(|it| Overlay::new(it, is_placed))?);
        }
        let is_replay = player.is_some();
        let app = sessions.program(|opened| match player {
            Some(player) => Ok(with_settings(StudioApp::new(opened)?.with_player(player))),
            None => live_app(opened, hand),
        })?;
        let app = app.with_arm(arm.as_ref()).with_headset(headset);
        show_window(app, (!is_replay).then_some(&sessions), refused.as_deref())
    });
    end(shown, sessions.take())
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

/// Starts a session as [`launch`] does, and waits until its outputs are open.
pub(super) fn start(setup: LoadedSetup, options: SessionOptions) -> Result<SessionHandle, Failure> {
    let session = launch(setup, options)?;
    session.wait_until_started();
    Ok(session)
}

/// Starts a session that prints its notices and that SIGUSR1 and Ctrl-Z pause.
pub(super) fn launch(
    setup: LoadedSetup,
    mut options: SessionOptions,
) -> Result<SessionHandle, Failure> {
    options.watchdog = Some(watchdog::program(Command::Pause)?);
    options.use_panic_keys = setup.setup.output != NO_OUTPUT;
    options.on_notice = Some(session::print_notices());
    let session = session::start(setup, options)?;
    // With any outputs: the session after a change may have others, and SIGUSR1 without a handler ends the window.
    pause_signals::install(session.commands().clone())?;
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
            complain!("the window has failed; the session continues, and Ctrl-C ends it");
        }
        (None, None) => complain!("the window has failed"),
    }
    session.map_or(Ok(()), |session| stats::report(session.join()?))
}

/// Shows the window. Without `sessions` it shows a recording, which has one layout. `refused` is a layout that the session cannot use: it
/// is opened in the editor.
fn show_window(
    mut app: StudioApp,
    sessions: Option<&Sessions>,
    refused: Option<&str>,
) -> Result<(), StudioError> {
    if let Some(error) = refused.and_then(|name| app.edit(name).err()) {
        complain!("{error}");
    }
    let content = match sessions {
        Some(sessions) => StudioStart::with_changes(app, |request| sessions.open(request)),
        None => app.into(),
    };
    open_window(content, signals::is_stop_requested)
}

/// Returns the program for a session, with clicks, the settings of this person, and the control of the simulated hand.
pub(super) fn live_app(
    session: &SessionHandle,
    hand: Option<HandControl>,
) -> Result<StudioApp, StudioError> {
    let app = StudioApp::new(session)?.with_pictures(PICTURES);
    let app = with_settings(app.with_sound(session));
    Ok(match hand {
        Some(hand) => app.with_hand(hand),
        None => app,
    })
}

pub(super) fn with_settings(app: StudioApp) -> StudioApp {
    match SettingsFile::default_path() {
        Some(path) => app.with_settings(path),
        None => app,
    }
}

fn show_overlay(mut overlay: Overlay) -> Result<(), StudioError> {
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

/// A setup, and the control of the simulated hand that is its source.
struct Loaded {
    /// The setup before its files were loaded.
    base: Setup,
    setup: LoadedSetup,
    hand: Option<HandControl>,
}

/// Loads the setup. If its layout is a file with faults, the session has the default layout, and the name of the file is returned.
fn load_or_edit(
    args: Args,
    options: &mut SessionOptions,
) -> Result<(Loaded, Option<String>), Failure> {
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
    let is_refused = Document::open_kind(FileKind::Layout, &layout)
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
fn load(args: Args, options: &mut SessionOptions) -> Result<Loaded, Failure> {
    if let Some(path) = &args.recording {
        let replay = Replay::open(path)?;
        let settings = ReplaySettings {
            glove: args.glove.as_deref(),
            layout: args.layout.as_deref(),
            person: None,
            permissions: None,
        };
        let mut setup = LoadedSetup::from_recording(replay.setup(), &settings)?;
        setup.setup.output = NO_OUTPUT.into();
        options.source = Some(Box::new(source::NoReadings));
        let base = setup.setup.clone();
        return Ok(Loaded {
            base,
            setup,
            hand: None,
        });
    }
    let mut setup = match &args.setup {
        Some(path) => Setup::load(path)?,
        None => Setup {
            output: NO_OUTPUT.into(),
            ..Setup::default()
        },
    };
    setup.role = role_beside(args.source.as_ref(), setup.source.as_ref(), setup.role);
    setup.source = args.source.or(setup.source);
    setup.role = args.role.or(setup.role);
    setup.glove = args.glove.or(setup.glove);
    setup.person = args.person.or(setup.person);
    setup.layout = args.layout.unwrap_or(setup.layout);
    if args.place {
        setup.output = NO_OUTPUT.into();
    }
    setup.use_token_roles()?;
    let base = setup.clone();
    let (setup, hand) = source::load(setup, options)?;
    Ok(Loaded { base, setup, hand })
}

#[cfg(test)]
mod tests {
    use ademan::hand::Side;
    use ademan::pipeline::SourceRole;
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct CommandLine {
        #[command(flatten)]
        args: Args,
    }

    /// Loads the setup of these arguments. The options name a source if a simulated hand is the source.
    fn load_arguments(arguments: &[&str]) -> (Loaded, SessionOptions) {
        let line = CommandLine::try_parse_from(["studio"].iter().chain(arguments));
        let mut options = SessionOptions::default();
        let loaded = load(line.expect("known flags").args, &mut options);
        (loaded.expect("a setup"), options)
    }

    #[test]
    fn the_person_of_the_command_line_has_the_simulated_hand_and_the_reach() {
        let load = |arguments: &[&str]| load_arguments(arguments).0.setup;
        let small = load(&["--layout", "chords-bend", "--person", "left-small"]);
        assert_eq!(small.arm.side(), Side::Left);
        assert_eq!(small.simulated_person.side, Some(Side::Left));
        let reach = |setup: &LoadedSetup| setup.arm.reach().expect("a reach").length;
        let usual = load(&["--layout", "chords-bend"]);
        assert!(reach(&small) < reach(&usual));
    }

    #[test]
    fn a_layout_for_two_hands_is_played_by_two() {
        let (loaded, _) = load_arguments(&["--layout", "qwerty-two-flat"]);
        let other = loaded.setup.other_hand.expect("a second hand");
        assert_eq!(other.arm.side(), Side::Left);
        assert!(loaded.hand.is_some());
    }

    #[test]
    fn a_role_of_the_setup_is_not_for_another_source_on_the_network() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("setup.ron");
        let text = "Setup(source: \"tcp:192.168.1.7:4001\", role: Both)";
        std::fs::write(&path, text).expect("a write");
        let role_of = |source: &str| {
            let path = path.to_str().expect("a path");
            load_arguments(&[path, "--source", source]).0.base.role
        };
        assert_eq!(role_of("tcp:192.168.1.8:4001"), None);
        assert_eq!(role_of("tcp:192.168.1.7:4001"), Some(SourceRole::Both));
        let stated = ["--source", "tcp:192.168.1.8:4001", "--role", "both"];
        let (loaded, _) = load_arguments(&stated);
        assert_eq!(loaded.base.role, Some(SourceRole::Both));
    }

    #[test]
    fn the_glove_of_the_command_line_replaces_that_of_the_setup() {
        let (loaded, options) = load_arguments(&["--glove", "lucidgloves-left"]);
        let glove = loaded.setup.glove.expect("the glove");
        assert_eq!((glove.side, glove.map.full_scale()), (Side::Left, 4095));
        assert!(options.source.is_some(), "a simulated hand wears it");
    }
}
