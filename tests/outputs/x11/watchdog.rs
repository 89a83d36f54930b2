//! Release by the watchdog, when the program is killed, stopped or broken.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use super::ends::{Typing, held_keys};
use super::lost_watchdog::copied;
use super::{hold, wait_for_release};
use crate::support::binary::{NO_FOLDER, ademan};
use crate::support::glove::Glove;
use crate::support::key_log::KeyLog;
use crate::support::press::Press;
use crate::support::process::{Process, signal};
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_at_most, wait_for};

impl Typing {
    /// Returns the process id of the watchdog.
    pub fn watchdog(&self) -> u32 {
        let mut found = None;
        let is_running = || {
            found = self
                .program
                .children()
                .into_iter()
                .find(|child| is_alive(*child));
            found.is_some()
        };
        assert!(wait_for(is_running), "no watchdog");
        found.expect("a watchdog")
    }

    /// Returns `true` if the keys stay pressed after `action`. They are pressed again if a busy machine has released them.
    fn stays_pressed_after(&self, action: impl Fn()) -> bool {
        wait_for(|| {
            action();
            std::thread::sleep(Duration::from_millis(200));
            let is_pressed = self.server.pressed_keys() == held_keys();
            if !is_pressed {
                let press = Press::for_text("H");
                hold(
                    &self.server,
                    &self.program,
                    &self.glove,
                    &press,
                    &held_keys(),
                );
            }
            is_pressed
        })
    }

    /// Ends the program by a signal that it cannot handle.
    fn check_release_after(mut self, signal: &str) {
        let log = self.log();
        let start = Instant::now();
        self.program.signal(&[signal]);
        wait_for_release(&self.server, start, signal);
        assert_eq!(
            self.program.wait_for_exit().code(),
            None,
            "killed by a signal"
        );
        self.program.wait_for_line("released its keys (2)", 1);
        assert_eq!(self.server.pressed_keys(), [0; 0]);
        log.assert_no_press();
    }
}

/// Writes the default layout with a text instead of the key H. No keymap has its characters.
fn layout_with_text(folder: &Path) -> PathBuf {
    let path = folder.join("text.ron");
    let board = include_str!("../../../layouts/keyboards/qwerty-flat.ron");
    let row = "(at_mm: (-90.25, 0), keys: \"A S D F G H J K L Semicolon Quote Backslash\")";
    let rows = "(at_mm: (-90.25, 0), keys: \"A S D F G\"), (at_mm: (23.75, 0), keys: \"J K L\")";
    // A text with more different characters than the keymap has unused keys would be dropped.
    let text: String = (0..4).flat_map(|_| ('ἀ'..).take(8)).collect();
    let key = format!("keys: [(action: Text(\"{text}\"), at_mm: (4.75, 0)),");
    let layout = board.replace(row, rows).replace("keys: [", &key);
    assert!(layout.contains(rows) && layout.contains(&key));
    fs::write(&path, layout).expect("space on the disk");
    path
}

#[test]
fn no_key_stays_pressed_after_a_kill_while_a_character_is_typed() {
    let Some(server) = XServer::start() else {
        return;
    };
    let log = KeyLog::start(&server);
    let press = Press::for_text("h");
    for round in 0..8 {
        let (folder, glove, source) = Glove::in_new_folder(press.clear());
        let layout = layout_with_text(folder.path()).display().to_string();
        let run = [
            "run", "--output", "desktop", "--source", &source, "--layout", &layout,
        ];
        let mut program = Program::start(&server, run);
        program.wait_for_line("armed", 1);
        let before = log.len();
        // A busy machine may cause a stall or drop the text; then the press is repeated.
        let arrives = || {
            glove.play(&press.approach);
            wait_at_most(Duration::from_secs(5), || log.presses_after(before) > 0)
        };
        assert!(
            wait_for(arrives),
            "no key arrives: {:#?}",
            program.stderr_lines()
        );
        program.signal(&["KILL"]);
        let code = program.wait_for_exit().code();
        assert_eq!(code, None, "{:#?}", program.stderr_lines());
        assert!(
            server.wait_for_keys(&[]),
            "{round}: {:?}",
            server.pressed_keys()
        );
        // The server may still execute requests.
        std::thread::sleep(Duration::from_millis(200));
        assert_eq!(server.pressed_keys(), [0; 0], "{round}");
        assert!(log.pressed().is_empty(), "{round}: {:?}", log.pressed());
    }
}

/// Makes a command use an X server.
fn on_display(mut command: Command, server: &XServer) -> Command {
    command
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("XDG_RUNTIME_DIR");
    command
}

/// Returns `true` if the process exists and has not exited.
pub fn is_alive(process: u32) -> bool {
    let state = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    !state.is_empty() && !state.contains(") Z")
}

#[test]
fn all_keys_are_released_after_a_kill() {
    let Some(typing) = Typing::start() else {
        return;
    };
    let watchdog = typing.watchdog();
    typing.check_release_after("KILL");
    assert!(wait_for(|| !is_alive(watchdog)), "the watchdog still runs");
}

#[test]
fn all_keys_are_released_after_an_abort() {
    if let Some(typing) = Typing::start() {
        typing.check_release_after("ABRT");
    }
}

#[test]
fn all_keys_are_released_after_a_crash() {
    if let Some(typing) = Typing::start() {
        typing.check_release_after("ILL");
    }
}

#[test]
fn all_keys_are_released_while_the_program_is_stopped_and_it_must_be_armed_again() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let start = Instant::now();
    typing.program.signal(&["STOP"]);
    wait_for_release(&typing.server, start, "STOP");
    typing.program.wait_for_line("does not respond", 1);
    let log = KeyLog::start(&typing.server);
    std::thread::sleep(Duration::from_secs(1));
    typing.program.signal(&["CONT"]);
    typing.program.wait_for_line("stalled", 1);
    // The finger on the key keeps the run from being armed.
    std::thread::sleep(Duration::from_millis(700));
    assert_eq!(log.events(), []);
    let press = Press::for_text("H");
    typing.glove.play(&press.lift);
    typing.program.wait_for_line("armed", 2);
    hold(
        &typing.server,
        &typing.program,
        &typing.glove,
        &press,
        &held_keys(),
    );
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
    assert_eq!(typing.server.pressed_keys(), [0; 0]);
}

#[test]
fn ctrl_z_releases_keys_before_the_stop_and_the_hand_must_leave_them_after_it() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    // A busy machine may have missed heartbeats before.
    let missed = typing.program.count_lines("does not respond");
    let log = typing.log();
    let start = Instant::now();
    typing.program.signal(&["TSTP"]);
    wait_for_release(&typing.server, start, "TSTP");
    let stat = format!("/proc/{}/stat", typing.program.id());
    let is_stopped = || {
        fs::read_to_string(&stat)
            .expect("the program exists")
            .contains(") T ")
    };
    assert!(wait_for(is_stopped), "the program does not stop");
    assert_eq!(typing.program.count_lines("does not respond"), missed);
    typing.program.signal(&["CONT"]);
    // The finger on the key keeps the run from being armed.
    std::thread::sleep(Duration::from_millis(700));
    log.assert_no_press();
    typing.glove.play(&Press::for_text("H").lift);
    typing.program.wait_for_line("armed", 2);
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
}

#[test]
fn sigusr1_pauses_until_a_resume() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let log = typing.log();
    let start = Instant::now();
    typing.program.signal(&["USR1"]);
    wait_for_release(&typing.server, start, "USR1");
    typing.program.wait_for_line("paused by a signal", 1);
    // A busy machine may have stalled before, and armed again.
    let armed = typing.program.count_lines("armed");
    let press = Press::for_text("H");
    typing.glove.play_to_end(&press.lift);
    std::thread::sleep(Duration::from_millis(800));
    typing.glove.play_to_end(&press.approach);
    std::thread::sleep(Duration::from_millis(200));
    log.assert_no_press();
    assert_eq!(typing.program.count_lines("armed"), armed);
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
}

/// Signals that end or stop a process which does not handle them, without those that the kernel reserves.
const SIGNALS: &str = "HUP INT QUIT ILL TRAP ABRT BUS FPE USR1 SEGV USR2 PIPE ALRM TERM STKFLT TSTP TTIN TTOU XCPU \
                       XFSZ VTALRM PROF IO PWR SYS RTMIN";

#[test]
fn no_signal_but_kill_and_stop_ends_or_stops_the_watchdog() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let watchdog = typing.watchdog();
    let is_pressed = typing.stays_pressed_after(|| {
        for name in SIGNALS.split_whitespace() {
            signal(name, watchdog);
        }
    });
    assert!(is_pressed, "{:#?}", typing.program.stderr_lines());
    assert!(is_alive(watchdog));
    typing.program.signal(&["KILL"]);
    assert!(typing.server.wait_for_keys(&[]));
    assert_eq!(typing.program.wait_for_exit().code(), None);
}

/// Returns the session id of a process.
fn session(process: u32) -> String {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).expect("it runs");
    // The name is in parentheses; the session is the 6th field, the 4th after it.
    let (_, rest) = stat.rsplit_once(") ").expect("a name");
    rest.split(' ').nth(3).expect("a session").to_owned()
}

#[test]
fn the_watchdog_leads_a_session_of_its_own_so_that_no_signal_of_the_terminal_reaches_it() {
    let Some(typing) = Typing::start() else {
        return;
    };
    let watchdog = typing.watchdog();
    assert_ne!(session(typing.program.id()), session(watchdog));
    assert_eq!(session(watchdog), watchdog.to_string());
}

#[test]
fn signals_without_a_use_have_no_effect() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let is_pressed = typing.stays_pressed_after(|| {
        for name in "USR2 ALRM VTALRM PROF IO PWR STKFLT RTMIN".split(' ') {
            signal(name, typing.program.id());
        }
    });
    assert!(is_pressed, "{:#?}", typing.program.stderr_lines());
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
}

#[test]
fn sigusr1_to_all_processes_is_an_emergency_stop_as_often_as_it_is_sent() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let watchdog = typing.watchdog();
    let log = typing.log();
    let start = Instant::now();
    for _ in 0..3 {
        signal("USR1", typing.program.id());
        signal("USR1", watchdog);
    }
    wait_for_release(&typing.server, start, "USR1 to both");
    typing.program.wait_for_line("paused by a signal", 1);
    std::thread::sleep(Duration::from_millis(200));
    assert!(is_alive(watchdog) && typing.program.is_running());
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
    log.assert_no_press();
}

#[test]
fn a_kill_of_all_processes_with_the_name_of_the_program_leaves_the_watchdog() {
    let Some(server) = XServer::start() else {
        return;
    };
    let press = Press::for_text("H");
    let (folder, glove, source) = Glove::in_new_folder(press.clear());
    // A name that no other process has.
    let name = format!("ademan-{}", std::process::id());
    let file = folder.path().join(&name);
    let command = copied(&file, &["run", "--output", "desktop", "--source", &source]);
    let mut program = Program::from_command(on_display(command, &server));
    program.wait_for_line("armed", 1);
    hold(&server, &program, &glove, &press, &held_keys());
    let [watchdog] = program.children()[..] else {
        panic!("one child: {:?}", program.children());
    };
    for entry in ["comm", "cmdline"] {
        let text = fs::read_to_string(format!("/proc/{watchdog}/{entry}")).expect("it runs");
        assert!(!text.contains("ademan"), "{entry}: {text:?}");
    }
    let mut pkill = Command::new("pkill");
    let killed = Process::start(pkill.args(["-KILL", "-f", &name]));
    match killed {
        Ok(mut started) => _ = started.0.wait().expect("pkill exits"),
        Err(error) => {
            println!("SKIPPED: pkill: {error}");
            program.signal(&["KILL"]);
        }
    }
    assert_eq!(program.wait_for_exit().code(), None);
    assert!(server.wait_for_keys(&[]), "{:?}", server.pressed_keys());
}

#[test]
fn signals_that_the_parent_has_blocked_stop_the_typing_and_the_program() {
    let Some(server) = XServer::start() else {
        return;
    };
    let press = Press::for_text("H");
    let (_folder, glove, source) = Glove::in_new_folder(press.clear());
    let run = ademan(["run", "--output", "desktop", "--source", &source]);
    let mut blocked = Command::new("env");
    blocked
        .arg("--block-signal=USR1,INT,TERM,HUP,TSTP")
        .env("XDG_CONFIG_HOME", NO_FOLDER)
        .arg(run.get_program())
        .args(run.get_args());
    let mut program = Program::from_command(on_display(blocked, &server));
    let is_started = || program.count_lines("armed") > 0 || program.count_lines("block-signal") > 0;
    assert!(wait_for(is_started), "{:#?}", program.stderr_lines());
    if program.count_lines("block-signal") > 0 {
        println!("SKIPPED: this `env` cannot block signals");
        return;
    }
    hold(&server, &program, &glove, &press, &held_keys());
    let start = Instant::now();
    program.signal(&["USR1"]);
    wait_for_release(&server, start, "USR1, blocked by the parent");
    program.wait_for_line("paused by a signal", 1);
    program.signal(&["TERM"]);
    assert_eq!(program.wait_for_exit().code(), Some(0));
}
