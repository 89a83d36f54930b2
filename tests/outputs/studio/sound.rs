//! The clicks of Studio on a real sound server.

use std::fs;
use std::path::Path;
use std::process::Command;

use ademan::sound::click::Click;

use super::safety::{Session, TRANSCRIPT};
use super::{end, is_typing, studio};
use crate::sound::server::{SoundServer, address};
use crate::support::process::signal;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_for};

/// Makes Studio use a sound server, with these settings.
fn connect(studio: &mut Command, folder: &Path, settings: &str) {
    let config = folder.join("ademan");
    fs::create_dir_all(&config).expect("a folder");
    fs::write(config.join("studio.ron"), settings).expect("a file");
    studio
        .env("XDG_CONFIG_HOME", folder)
        .env("PULSE_SERVER", address(folder));
}

const SILENT: &str = "(has_seen_tour: true)";
const CLICKS: &str = "(has_seen_tour: true, sound: (is_on: true, volume: 1.0))";

#[test]
fn a_typing_hand_is_heard_once_clicks_are_turned_on() {
    let (Some(server), Some(sound)) = (XServer::start(), SoundServer::start()) else {
        return;
    };
    let start = |settings| {
        // Capitals, which need Shift.
        let source = format!("typist:{}", "Hh".repeat(200));
        let mut command = studio(&server, &["--source", &source]);
        connect(&mut command, sound.folder.path(), settings);
        Program::from_command(command)
    };
    let silent = start(SILENT);
    assert!(is_typing(&server), "{:#?}", silent.stderr_lines());
    end(silent);
    assert!(sound.recording().iter().all(|it| *it == 0), "off at first");

    let program = start(CLICKS);
    for click in [Click::Key, Click::Modifier] {
        let is_heard = wait_for(|| sound.count(click) >= 2);
        assert!(is_heard, "{click}: {:#?}", program.stderr_lines());
    }
    assert_eq!(sound.count(Click::Suppressed), 0);
}

#[test]
fn typing_goes_on_while_the_sound_server_hangs_and_after_it_is_gone() {
    let Some(mut sound) = SoundServer::start() else {
        return;
    };
    let folder = sound.folder.path().to_path_buf();
    let use_sound = |command: &mut Command| connect(command, &folder, CLICKS);
    let Some(session) = Session::start_with(TRANSCRIPT, use_sound) else {
        return;
    };
    assert!(wait_for(|| sound.count(Click::Key) >= 1));
    signal("STOP", sound.server.0.id());
    (0..5).for_each(|_| session.wait_for_typing());
    sound.server.0.kill().expect("the server runs");
    (0..5).for_each(|_| session.wait_for_typing());
    session.program.signal(&["TERM"]);
    // On a busy machine the window takes longer to close than an orderly end may.
    session.check_end(&[0, 130]);
}
