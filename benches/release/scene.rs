//! The program with a glove that holds H, until something goes wrong.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::causes::Cause;
use crate::load::Load;
use crate::place::Place;
use crate::support::glove::Glove;
use crate::support::press::{Posture, Press};
use crate::support::program::Program;
use crate::support::x11::{wait_at_most, wait_for};

/// So many postures before the key is down the finger is above it.
const STROKE: usize = 40;

/// How long the stroke may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(3);

pub struct Scene {
    program: Program,
    glove: Glove,
    control: PathBuf,
    load: Option<Load>,
    folder: tempfile::TempDir,
}

impl Scene {
    /// Starts a program and waits until H is down.
    pub fn hold(place: &Place, press: &Press, is_loaded: bool) -> Self {
        loop {
            let mut scene = Self::start(place, press);
            scene.load = is_loaded.then(|| Load::start(&scene.control));
            scene.glove.play(stroke(press));
            // A machine that holds this up for 200 ms on the way makes a stall of it.
            if wait_at_most(PATIENCE, || place.holds()) {
                return scene;
            }
            drop(scene);
            assert!(wait_for(|| !place.holds()), "it stays down");
        }
    }

    fn start(place: &Place, press: &Press) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let port = folder.path().join("glove");
        let control = folder.path().join("control");
        let glove = Glove::plug_in(&port, stroke(press)[0]);
        let source = format!("serial:{}", port.display());
        let socket = control.display().to_string();
        let output = place.output();
        let program = place.run(&[
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
        place.watch();
        Self {
            program,
            glove,
            control,
            load: None,
            folder,
        }
    }

    /// Lets it happen; how long H stays down.
    pub fn release_after(mut self, place: &Place, cause: Cause) -> Duration {
        let process = |number: u32| Pid::from_raw(number as i32).expect("a process");
        let program = process(self.program.id());
        let guardian = process(self.guardian());
        let mut client = UnixStream::connect(&self.control).expect("the run listens");
        let start = Instant::now();
        match cause {
            Cause::Silence => self.glove.stop_sending(),
            Cause::Unplugged => self.glove.unplug(),
            Cause::Sent(signal) => kill_process(program, signal).expect("it runs"),
            Cause::Pause => client
                .write_all(b"{\"ask\":\"pause\"}\n")
                .expect("it reads"),
            Cause::GuardianKilled => kill_process(guardian, Signal::KILL).expect("it runs"),
        }
        while !place.is_free() {
            assert!(start.elapsed() < Duration::from_secs(20), "keys stay down");
        }
        let took = start.elapsed();
        self.load = None;
        let _ = kill_process(program, Signal::KILL);
        self.program.wait_for_exit();
        drop(self.folder);
        took
    }

    fn guardian(&self) -> u32 {
        *self.program.children().first().expect("it has a guardian")
    }
}

/// From above the key until it is down.
fn stroke(press: &Press) -> &[Posture] {
    &press.approach[press.approach.len() - STROKE..]
}
