//! How long keys stay down after something went wrong: the worst of many times, for each cause.
//!
//! The real program with a glove on a pseudo terminal holds H on a real X server, and a second client
//! asks the server until nothing is down. Each time it is another program; nothing of the last one is left. Goals
//! are bounds that a user would notice. `cargo bench --bench release` does it 200 times for each cause, which
//! takes some minutes, `-- 20` less often; as a test (`cargo test --bench release`) it is done once.

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("SKIPPED: an X server and a guardian are there on Linux");
}

#[cfg(target_os = "linux")]
#[path = "../tests/desktop/glove.rs"]
#[allow(dead_code)]
mod glove;
#[cfg(target_os = "linux")]
#[path = "../tests/desktop/held.rs"]
#[allow(dead_code, unused_imports)]
mod held;
#[cfg(target_os = "linux")]
#[path = "../tests/desktop/press.rs"]
#[allow(dead_code)]
mod press;
#[cfg(target_os = "linux")]
#[path = "../tests/desktop/program.rs"]
#[allow(dead_code)]
mod program;
#[cfg(target_os = "linux")]
#[path = "../tests/support/mod.rs"]
mod support;

#[cfg(target_os = "linux")]
fn main() {
    linux::main();
}

#[cfg(target_os = "linux")]
mod linux {
    use std::fs;
    use std::io::{BufRead, BufReader, Write};
    use std::os::unix::net::UnixStream;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::path::PathBuf;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::{self, JoinHandle};
    use std::time::{Duration, Instant};

    use ademan::capture::{Capture, CaptureError, Source};
    use ademan::device::Needs;
    use ademan::output::Desktop;
    use ademan::runtime::drive;
    use ademan::settings::Setup;
    use crossbeam_channel::never;
    use rustix::process::{Pid, Signal, kill_process};

    use crate::glove::Glove;
    use crate::held::Hand;
    use crate::press::{Posture, Press, code};
    use crate::program::Program;
    use crate::support::x11::{XServer, wait_up_to};

    /// Clients that ask without a pause while everything is to be let go of.
    const CLIENTS: usize = 12;

    /// So many postures before the key is down the finger is above it.
    const STROKE: usize = 40;

    /// What goes wrong.
    #[derive(Clone, Copy)]
    enum Cause {
        Silence,
        Unplugged,
        Sent(Signal),
        Pause,
        GuardianKilled,
    }

    /// What is measured: a name, a cause, whether the program is under load, and the goal in ms.
    const ROWS: &[(&str, Cause, bool, u32)] = &[
        (
            "the glove falls silent (stall limit 200 ms)",
            Cause::Silence,
            false,
            250,
        ),
        ("the cable is pulled", Cause::Unplugged, false, 50),
        ("SIGINT", Cause::Sent(Signal::INT), false, 50),
        ("SIGTERM", Cause::Sent(Signal::TERM), false, 50),
        ("SIGHUP", Cause::Sent(Signal::HUP), false, 50),
        ("SIGTSTP (Ctrl-Z)", Cause::Sent(Signal::TSTP), false, 50),
        ("SIGKILL", Cause::Sent(Signal::KILL), false, 100),
        (
            "SIGABRT (abort, out of memory)",
            Cause::Sent(Signal::ABORT),
            false,
            100,
        ),
        ("SIGSTOP", Cause::Sent(Signal::STOP), false, 300),
        ("the guardian is killed", Cause::GuardianKilled, false, 100),
        (
            "emergency stop: SIGUSR1",
            Cause::Sent(Signal::USR1),
            false,
            20,
        ),
        ("emergency stop: control socket", Cause::Pause, false, 20),
        (
            "emergency stop: SIGUSR1, under load",
            Cause::Sent(Signal::USR1),
            true,
            20,
        ),
        (
            "emergency stop: control socket, under load",
            Cause::Pause,
            true,
            20,
        ),
    ];

    pub fn main() {
        let Some(server) = XServer::start() else {
            return;
        };
        let arguments: Vec<_> = std::env::args().skip(1).collect();
        let is_test = !arguments.iter().any(|argument| argument == "--bench");
        let given = arguments.iter().find_map(|argument| argument.parse().ok());
        let times = given.unwrap_or(if is_test { 1 } else { 200 });
        let press = Press::of("h");
        println!("nothing is down after, in ms, {times} times        median      worst   goal");
        for &(name, cause, is_loaded, goal) in ROWS {
            row(name, times, goal, || {
                Scene::hold(&server, &press, is_loaded).release_after(&server, cause)
            });
        }
        std::panic::set_hook(Box::new(|_| {}));
        for (name, place) in [
            ("a panic of the capture thread", Place::Source),
            ("a panic of the loop", Place::Loop),
        ] {
            row(name, times, 50, || panic_after(&server, &press, place));
        }
    }

    fn row(name: &str, times: usize, goal: u32, measure: impl FnMut() -> Duration) {
        let mut took: Vec<_> = std::iter::repeat_with(measure).take(times).collect();
        took.sort_unstable();
        let millis = |time: Duration| time.as_secs_f64() * 1e3;
        let (median, worst) = (millis(took[times / 2]), millis(took[times - 1]));
        println!("{name:46} {median:10.2} {worst:10.2} {goal:6}");
    }

    /// Where a panic is.
    #[derive(Clone, Copy, PartialEq)]
    enum Place {
        Source,
        Loop,
    }

    /// A hand whose thread panics when it is told to.
    struct Fused(Hand, Arc<AtomicBool>);

    impl Source for Fused {
        fn next(&mut self) -> Result<Capture, CaptureError> {
            assert!(!self.1.load(Ordering::Relaxed), "meant to happen");
            self.0.next()
        }

        fn name(&self) -> &str {
            self.0.name()
        }
    }

    /// The library in this process, with a panic in one of its threads while H is down.
    fn panic_after(server: &XServer, press: &Press, place: Place) -> Duration {
        let (in_source, in_loop) = (
            Arc::new(AtomicBool::new(false)),
            Arc::new(AtomicBool::new(false)),
        );
        let fuse = match place {
            Place::Source => in_source.clone(),
            Place::Loop => in_loop.clone(),
        };
        let source = Fused(Hand::that_holds(press, Duration::MAX), in_source);
        let mut sink =
            Desktop::open(Some(server.display()), &Needs::default()).expect("the server is there");
        let run = thread::spawn(move || {
            let assembly = Setup::default().assemble().expect("the default setup");
            let observe = &mut |_: &_| assert!(!in_loop.load(Ordering::Relaxed), "meant to happen");
            let outcome = catch_unwind(AssertUnwindSafe(|| {
                drive(
                    source,
                    &mut assembly.pipeline(),
                    &mut sink,
                    &never(),
                    observe,
                )
                .map(drop)
            }));
            // It is not its end that lets go.
            (outcome.is_err(), sink)
        });
        assert!(server.wait_for_keys(&[code("H")]));
        let start = Instant::now();
        fuse.store(true, Ordering::Relaxed);
        while !server.keys_down().is_empty() {
            assert!(start.elapsed() < Duration::from_secs(20), "keys stay down");
        }
        let took = start.elapsed();
        let (has_panicked, _sink) = run.join().expect("it was caught");
        assert_eq!(has_panicked, place == Place::Loop);
        took
    }

    /// The program with a glove that holds H.
    struct Scene {
        program: Program,
        glove: Glove,
        control: PathBuf,
        load: Option<Load>,
        folder: tempfile::TempDir,
    }

    impl Scene {
        fn hold(server: &XServer, press: &Press, is_loaded: bool) -> Self {
            loop {
                let mut scene = Self::start(server, press);
                scene.load = is_loaded.then(|| Load::start(&scene.control));
                scene.glove.play(stroke(press));
                let held = [code("H")];
                // A machine that holds this up for 200 ms on the way makes a stall of it.
                if wait_up_to(Duration::from_secs(3), || server.keys_down() == held) {
                    return scene;
                }
                drop(scene);
                assert!(
                    server.wait_for_keys(&[]),
                    "{:?} stay down",
                    server.keys_down()
                );
            }
        }

        fn start(server: &XServer, press: &Press) -> Self {
            let folder = tempfile::tempdir().expect("a folder");
            let port = folder.path().join("glove");
            let control = folder.path().join("control");
            let before = press.approach[press.approach.len() - STROKE];
            let glove = Glove::plug_in(&port, before);
            let source = format!("serial:{}", port.display());
            let socket = control.display().to_string();
            let arguments = [
                "run",
                "--armed",
                "--output",
                "desktop",
                "--source",
                &source,
                "--control",
                &socket,
            ];
            let program = Program::start(server, arguments);
            program.wait_until_it_says("armed", 1);
            Self {
                program,
                glove,
                control,
                load: None,
                folder,
            }
        }

        fn release_after(mut self, server: &XServer, cause: Cause) -> Duration {
            let process = |number: u32| Pid::from_raw(number as i32).expect("a process");
            let program = process(self.program.id());
            let guardian = process(self.guardian());
            let mut client = UnixStream::connect(&self.control).expect("the run listens");
            let start = Instant::now();
            match cause {
                Cause::Silence => self.glove.fall_silent(),
                Cause::Unplugged => self.glove.unplug(),
                Cause::Sent(signal) => kill_process(program, signal).expect("it runs"),
                Cause::Pause => client
                    .write_all(b"{\"ask\":\"pause\"}\n")
                    .expect("it reads"),
                Cause::GuardianKilled => kill_process(guardian, Signal::KILL).expect("it runs"),
            }
            while !server.keys_down().is_empty() {
                assert!(start.elapsed() < Duration::from_secs(20), "keys stay down");
            }
            let took = start.elapsed();
            self.load = None;
            let _ = kill_process(program, Signal::KILL);
            self.program.status();
            drop(self.folder);
            took
        }

        fn guardian(&self) -> u32 {
            let threads = fs::read_dir(format!("/proc/{}/task", self.program.id()));
            let of_thread = |thread: fs::DirEntry| {
                fs::read_to_string(thread.path().join("children")).unwrap_or_default()
            };
            let children: String = threads.expect("it runs").flatten().map(of_thread).collect();
            let first = children
                .split_whitespace()
                .next()
                .expect("it has a guardian");
            first.parse().expect("a number")
        }
    }

    /// From above the key until it is down.
    fn stroke(press: &Press) -> &[Posture] {
        &press.approach[press.approach.len() - STROKE..]
    }

    /// Clients of the control socket that ask how the run is, again and again.
    struct Load {
        is_over: Arc<AtomicBool>,
        clients: Vec<JoinHandle<()>>,
    }

    impl Load {
        fn start(control: &PathBuf) -> Self {
            let is_over = Arc::new(AtomicBool::new(false));
            let client = |_| {
                let stream = UnixStream::connect(control).expect("the run listens");
                let is_over = is_over.clone();
                thread::spawn(move || {
                    let mut answers = BufReader::new(stream);
                    let mut line = String::new();
                    while !is_over.load(Ordering::Relaxed) {
                        let asked = answers.get_mut().write_all(b"{\"ask\":\"state\"}\n");
                        line.clear();
                        if asked.is_err() || !matches!(answers.read_line(&mut line), Ok(1..)) {
                            return;
                        }
                    }
                })
            };
            Self {
                clients: (0..CLIENTS).map(client).collect(),
                is_over,
            }
        }
    }

    impl Drop for Load {
        fn drop(&mut self) {
            self.is_over.store(true, Ordering::Relaxed);
            for client in self.clients.drain(..) {
                let _ = client.join();
            }
        }
    }
}
