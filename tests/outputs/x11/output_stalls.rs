//! Presses that a display has not executed, and keys that the watchdog has released, while the layout holds a lock.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use tempfile::TempDir;

use super::{hold, is_pressing, start_until};
use crate::support::glove::Glove;
use crate::support::key_log::KeyLog;
use crate::support::press::{Posture, Press, x11_code};
use crate::support::program::Program;
use crate::support::x11::XServer;

/// Number of postures between a pressed key and one that is released. The hand is clear of all keys for less than the
/// 300 ms after which output is armed.
const WIGGLE: usize = 16;

/// A run whose key G locks Control.
struct Locking {
    server: XServer,
    log: KeyLog,
    program: Program,
    glove: Glove,
    h: Press,
    _folder: TempDir,
}

/// Writes the default layout with a lock of Control instead of the key G.
fn layout_with_lock(folder: &Path) -> PathBuf {
    let path = folder.join("lock.ron");
    let board = include_str!("../../../layouts/keyboards/qwerty-flat.ron");
    let row = "(at_mm: (-90.25, 0), keys: \"A S D F G H J K L Semicolon Quote Backslash\")";
    let rows = "(at_mm: (-90.25, 0), keys: \"A S D F\"), (at_mm: (4.75, 0), keys: \"H J K L\")";
    let lock = "keys: [(action: Key(\"ControlLeft\"), latch: Lock, at_mm: (-14.25, 0)),";
    let layout = board.replace(row, rows).replace("keys: [", lock);
    assert!(layout.contains(rows) && layout.contains(lock));
    fs::write(&path, layout).expect("space on the disk");
    path
}

/// Returns the arguments of a run with that layout, which does not stall if it is stopped for less than 5 s.
pub fn arguments(folder: &Path) -> [String; 3] {
    let setup = folder.join("setup.ron");
    fs::write(&setup, "(stall_timeout_ms: 5000)").expect("space on the disk");
    let layout = layout_with_lock(folder);
    let [setup, layout] = [setup, layout].map(|path| path.display().to_string());
    [setup, "--layout".into(), layout]
}

/// Returns the movement that locks Control and then holds H.
pub fn lock_and_hold(h: &Press) -> Vec<Posture> {
    let g = Press::for_text("g");
    [&g.approach[..], &g.lift, &h.approach].concat()
}

/// Returns the movement of a finger that holds H to release it, and to press it again without a pause.
pub fn release_and_press(h: &Press) -> Vec<Posture> {
    let near = &h.approach[h.approach.len() - WIGGLE..];
    let up: Vec<_> = near.iter().rev().copied().collect();
    [&up[..], near].concat()
}

/// Plays a movement, and waits until the receiver of a key has it.
pub fn play_and_settle(glove: &Glove, movement: &[Posture]) {
    glove.play_to_end(movement);
    sleep(Duration::from_millis(500));
}

impl Locking {
    fn start() -> Option<Self> {
        let server = XServer::start()?;
        let log = KeyLog::start(&server);
        let h = Press::for_text("h");
        let (folder, glove, source) = Glove::in_new_folder(h.clear());
        let run = ["run", "--output", "desktop", "--source", &source].map(String::from);
        let run = run.into_iter().chain(arguments(folder.path()));
        let program = Program::start(&server, run);
        program.wait_for_line("armed", 1);
        Some(Self {
            server,
            log,
            program,
            glove,
            h,
            _folder: folder,
        })
    }

    /// Starts a run that has locked Control and holds H.
    fn start_holding() -> Option<Self> {
        let mut held = [x11_code("ControlLeft"), x11_code("H")];
        held.sort_unstable();
        start_until(Self::start, |run| {
            run.glove.play(&lock_and_hold(&run.h));
            is_pressing(&run.server, &run.program, &held)
        })
    }

    /// Releases and presses H without a pause, and checks that no press arrives.
    fn check_that_no_press_arrives(&self, what: &str) {
        let (armed, before) = (self.program.count_lines("armed"), self.log.len());
        play_and_settle(&self.glove, &release_and_press(&self.h));
        // A machine that delays the packets may let the hand be clear for long enough.
        let is_armed = self.program.count_lines("armed") > armed;
        let presses = self.log.presses_after(before);
        assert!(
            presses == 0 || is_armed,
            "{what}: {:?}, {:#?}",
            self.log.events(),
            self.program.stderr_lines()
        );
    }

    /// Checks that the run is armed when the hand is clear of all keys, and that nothing is locked then.
    fn check_end(mut self) {
        let armed = self.program.count_lines("armed");
        self.glove.play(&self.h.lift);
        self.program.wait_for_line("armed", armed + 1);
        hold(
            &self.server,
            &self.program,
            &self.glove,
            &self.h,
            &[x11_code("H")],
        );
        self.program.signal(&["TERM"]);
        assert_eq!(self.program.wait_for_exit().code(), Some(0));
        assert_eq!(self.server.pressed_keys(), [0; 0]);
    }
}

#[test]
fn no_bare_key_follows_a_lock_that_the_server_has_not_executed() {
    let Some(run) = Locking::start() else {
        return;
    };
    run.server.freeze();
    play_and_settle(&run.glove, &lock_and_hold(&run.h));
    run.server.thaw();
    run.program.wait_for_line("dropped", 1);
    run.check_that_no_press_arrives("the server hung");
    run.check_end();
}

#[test]
fn no_bare_key_follows_a_lock_that_the_watchdog_has_released() {
    let Some(run) = Locking::start_holding() else {
        return;
    };
    run.program.signal(&["STOP"]);
    assert!(run.server.wait_for_keys(&[]), "the watchdog releases both");
    run.program.signal(&["CONT"]);
    // The finger is still on the key, which keeps the run from being armed.
    sleep(Duration::from_millis(500));
    assert_eq!(run.program.count_lines("armed"), 1);
    run.check_that_no_press_arrives("the program was stopped");
    assert_eq!(run.program.count_lines("stalled"), 0);
    run.check_end();
}
