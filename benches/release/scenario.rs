//! A program whose glove holds H, until a failure.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::causes::Cause;
use crate::load::Load;
use crate::support::glove::Glove;
use crate::support::press::{Posture, Press};
use crate::support::program::Program;
use crate::support::x11::{wait_at_most, wait_for};
use crate::target::InputTarget;

/// Number of postures from above the key to its press.
const PRESS_POSTURES: usize = 40;

/// Longest time for the press on a busy machine.
const PRESS_TIMEOUT: Duration = Duration::from_secs(3);

/// A running program with a pressed key.
pub struct Scenario {
    program: Program,
    glove: Glove,
    control: PathBuf,
    load: Option<Load>,
    folder: tempfile::TempDir,
}

impl Scenario {
    /// Starts a program and waits until H is pressed.
    pub fn start(target: &InputTarget, press: &Press, is_loaded: bool) -> Self {
        loop {
            let mut scenario = Self::launch(target, press);
            scenario.load = is_loaded.then(|| Load::start(&scenario.control));
            scenario.glove.play(press_postures(press));
            // A busy machine may cause a stall; then the press is repeated.
            if wait_at_most(PRESS_TIMEOUT, || target.is_pressed()) {
                return scenario;
            }
            drop(scenario);
            assert!(wait_for(|| !target.is_pressed()), "the key stays pressed");
        }
    }

    fn launch(target: &InputTarget, press: &Press) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let port = folder.path().join("glove");
        let control = folder.path().join("control");
        let glove = Glove::plug_in(&port, press_postures(press)[0]);
        let source = format!("serial:{}", port.display());
        let socket = control.display().to_string();
        let output = target.output();
        let program = target.run(&[
            "run",
            "--armed",
            "--output",
            output,
            "--source",
            &source,
            "--control",
            &socket,
        ]);
        program.wait_for_line("armed", 1);
        target.observe();
        Self {
            program,
            glove,
            control,
            load: None,
            folder,
        }
    }

    /// Causes the failure and returns the release time of H.
    pub fn measure(mut self, target: &InputTarget, cause: Cause) -> Duration {
        let process = |number: u32| Pid::from_raw(number as i32).expect("a process id");
        let program = process(self.program.id());
        let watchdog = process(self.watchdog());
        let mut client = UnixStream::connect(&self.control).expect("the program listens");
        let start = Instant::now();
        match cause {
            Cause::Silence => self.glove.stop_sending(),
            Cause::Unplugged => self.glove.unplug(),
            Cause::Sent(signal) => kill_process(program, signal).expect("it runs"),
            Cause::Pause => client
                .write_all(b"{\"command\":\"pause\"}\n")
                .expect("the program reads"),
            Cause::SentToWatchdog(signal) => kill_process(watchdog, signal).expect("it runs"),
        }
        while !target.is_released() {
            assert!(
                start.elapsed() < Duration::from_secs(20),
                "a key stays pressed"
            );
        }
        let release_time = start.elapsed();
        self.load = None;
        let _ = kill_process(program, Signal::KILL);
        self.program.wait_for_exit();
        drop(self.folder);
        release_time
    }

    fn watchdog(&self) -> u32 {
        *self.program.children().first().expect("a watchdog")
    }
}

/// Returns the postures from above the key to its press.
fn press_postures(press: &Press) -> &[Posture] {
    &press.approach[press.approach.len() - PRESS_POSTURES..]
}
