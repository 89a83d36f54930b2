//! Presses that a compositor has not executed, and keys that the watchdog has released, while the layout holds a lock; the
//! end of the compositor while nothing is pressed.

use std::time::Instant;

use tempfile::TempDir;

use super::compositor::Compositor;
use super::ends::GloveRun;
use super::window::Window;
use crate::support::press::Press;
use crate::support::x11::wait_for;
use crate::x11::output_stalls::{arguments, lock_and_hold, play_and_settle, release_and_press};
use crate::x11::{is_late, start_until};

/// A run whose key G locks Control, and a window that receives its keys.
struct Locking {
    window: Window,
    run: GloveRun,
    h: Press,
    compositor: Compositor,
    _folder: TempDir,
}

impl Locking {
    fn start() -> Option<Self> {
        let compositor = Compositor::sway()?;
        let window = Window::open(&compositor)?;
        let h = Press::for_text("h");
        let folder = tempfile::tempdir().expect("a folder");
        let arguments = arguments(folder.path());
        let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
        let run = GloveRun::start(&compositor, &h, &arguments);
        Some(Self {
            window,
            run,
            h,
            compositor,
            _folder: folder,
        })
    }

    /// Starts a run that has locked Control and holds H.
    fn start_holding() -> Option<Self> {
        start_until(Self::start, Self::hold)
    }

    /// Locks Control and holds H. Returns `false` if a busy machine has delayed the run before.
    fn hold(&self) -> bool {
        self.run.glove.play(&lock_and_hold(&self.h));
        let mut has_pressed = false;
        let is_over = wait_for(|| {
            has_pressed = self.presses() == 1;
            has_pressed || is_late(&self.run.program)
        });
        assert!(is_over, "{:#?}", self.window.events());
        has_pressed
    }

    /// Returns the number of presses of H so far, with Control or without it.
    fn presses(&self) -> usize {
        let events = self.window.events();
        let is_press = |event: &&String| event.starts_with("down h") || event.starts_with("down H");
        events.iter().filter(is_press).count()
    }

    /// Releases and presses H without a pause, and checks that no press arrives.
    fn check_that_no_press_arrives(&self) {
        let (armed, before) = (self.run.program.count_lines("armed"), self.presses());
        play_and_settle(&self.run.glove, &release_and_press(&self.h));
        // A machine that delays the packets may let the hand be clear for long enough.
        let is_armed = self.run.program.count_lines("armed") > armed;
        assert!(
            self.presses() == before || is_armed,
            "{:#?}, {:#?}",
            self.window.events(),
            self.run.program.stderr_lines()
        );
    }
}

#[test]
fn no_bare_key_follows_a_lock_that_the_compositor_has_not_executed() {
    let Some(locking) = Locking::start() else {
        return;
    };
    locking.compositor.stop();
    play_and_settle(&locking.run.glove, &lock_and_hold(&locking.h));
    locking.compositor.resume();
    locking.run.program.wait_for_line("dropped", 1);
    locking.check_that_no_press_arrives();
}

#[test]
fn no_bare_key_follows_a_lock_that_the_watchdog_has_released_on_a_compositor() {
    let Some(locking) = Locking::start_holding() else {
        return;
    };
    let before = locking.window.events().len();
    locking.run.program.signal(&["STOP"]);
    let is_released = || {
        let events = locking.window.events();
        events[before..]
            .iter()
            .any(|event| event.starts_with("up Control"))
    };
    assert!(wait_for(is_released), "{:#?}", locking.window.events());
    locking.run.program.signal(&["CONT"]);
    locking.check_that_no_press_arrives();
    assert_eq!(locking.run.program.count_lines("stalled"), 0);
}

#[test]
fn the_death_of_the_compositor_while_nothing_is_pressed_ends_the_run() {
    let Some(mut locking) = Locking::start() else {
        return;
    };
    let start = Instant::now();
    locking.compositor.kill();
    assert_eq!(locking.run.program.wait_for_exit().code(), Some(1));
    println!("ended {:.1?} after the compositor", start.elapsed());
    let lines = locking.run.program.stderr_lines();
    let is_reported = |line: &String| line.contains("the connection to the compositor failed");
    assert!(lines.iter().any(is_reported), "{lines:#?}");
}
