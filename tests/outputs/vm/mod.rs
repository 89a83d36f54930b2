//! The program in a virtual machine with a stock Linux kernel: bytes from a USB serial adapter become events of uinput
//! devices, which udev and libinput, and with it Wayland and X11, recognize.
//!
//! `tests/outputs/vm/run` builds the machine and starts these tests; otherwise they are skipped.
mod devices;
mod doctor;
mod glove;
mod killed;
mod machine;
mod service;
mod typing;
mod witness;

use std::env;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use glove::{Glove, HandMotion};
use machine::Machine;
use witness::{Evtest, Libinput};

/// The machine with the programs that observe it.
struct Scene {
    machine: Machine,
    glove: Glove,
    libinput: Libinput,
    evtests: usize,
    start: Instant,
}

impl Scene {
    fn of(folder: &Path) -> Self {
        let start = Instant::now();
        let mut machine = Machine::start(folder);
        let libinput = Libinput::start(&mut machine);
        Self {
            glove: Glove::new(machine.line()),
            machine,
            libinput,
            evtests: 0,
            start,
        }
    }

    /// Starts the program after the adapter of the glove is connected.
    fn start_program(&mut self, layout: &str) {
        self.launch(layout, "/tmp/ademan.log");
        self.wait_for_line("listening to", 1);
    }

    /// Starts the program with its output in this file.
    fn launch(&mut self, layout: &str, log: &str) {
        self.libinput.forget(&mut self.machine);
        self.machine.wait_for("a serial port", |machine| {
            machine
                .run("ls /dev/ttyUSB0")
                .starts_with('/')
                .then_some(())
        });
        // A busy machine must not cause a stall.
        let setup = format!(
            "Setup(source: \"serial:/dev/ttyUSB0\", output: \"uinput\", layout: \"{layout}\", stall_timeout_ms: 10000, \
             panic_keys: [\"ControlLeft\", \"ControlRight\"])"
        );
        self.machine.run(&format!("echo '{setup}' >/tmp/setup.ron"));
        self.machine.run(&format!(
            "ademan run --allow-root /tmp/setup.ron --control /tmp/control >{log} 2>&1 & echo $! >/tmp/ademan.pid"
        ));
    }

    /// Ends the program with SIGINT.
    fn end_program(&mut self) {
        self.glove.stop_sending();
        self.machine.run("killall -INT ademan");
        self.machine.wait_for("the end of the program", |machine| {
            machine.run("pidof ademan").is_empty().then_some(())
        });
    }

    fn evtest(&mut self, device: &str) -> Evtest {
        self.evtests += 1;
        Evtest::start(&mut self.machine, device, self.evtests)
    }

    fn wait_for_line(&mut self, part: &str, count: usize) {
        let command = format!("grep -c '{part}' /tmp/ademan.log");
        self.machine
            .wait_for(&format!("a line with `{part}`"), |machine| {
                let lines: usize = machine.run(&command).trim().parse().unwrap_or(0);
                (lines >= count).then_some(())
            });
    }

    /// Keeps the hand clear of all keys until the program is armed for the `count`th time.
    fn arm(&mut self, motion: &HandMotion, count: usize) {
        self.glove.play(motion.clear());
        self.wait_for_line("armed", count);
    }

    fn report(&self, what: &str) {
        println!(
            "VM ok: {what} ({:.1} s)",
            self.start.elapsed().as_secs_f64()
        );
    }
}

#[test]
fn kernel_and_libinput_receive_the_events() {
    let Some(folder) = env::var_os("ADEMAN_VM") else {
        println!("SKIPPED: `tests/outputs/vm/run` starts this with a machine");
        return;
    };
    let mut scene = Scene::of(Path::new(&folder));
    scene.report("the kernel runs");
    typing::all(&mut scene);
    killed::all(&mut scene);
    devices::all(&mut scene);
    doctor::all(&mut scene);
    for log in ["/tmp/ademan.log", "/tmp/evtest-*.log"] {
        scene.machine.keep(log);
    }
    println!("log of libinput:");
    Libinput::log(&mut scene.machine)
        .iter()
        .for_each(|line| println!("{line}"));
}

#[test]
fn release_times() {
    let printed = benchmark(
        "ADEMAN_PROGRAM=/bin/ademan vm-release --bench uinput",
        "release",
    );
    assert!(
        printed.is_none_or(|lines| lines == 18),
        "a title and a row per cause: {printed:?}"
    );
}

#[test]
fn latency_to_a_reader() {
    let printed = benchmark("vm-latency --bench uinput", "latency");
    assert!(
        printed.is_none_or(|lines| lines == 9),
        "a title, and a row per program and pace: {printed:?}"
    );
}

/// Prints what a benchmark prints in the machine, and returns the number of lines. Returns `None` without a machine for it.
fn benchmark(command: &str, name: &str) -> Option<usize> {
    let (Some(folder), Ok(times)) = (env::var_os("ADEMAN_VM"), env::var("ADEMAN_VM_TIMES")) else {
        println!("SKIPPED: `tests/outputs/vm/run {name}` starts this with a machine");
        return None;
    };
    let mut machine = Machine::start(Path::new(&folder));
    machine.run(&format!(
        "({command} {times}; echo over) >/tmp/{name}.log 2>&1 &"
    ));
    let mut printed = 0;
    loop {
        let log = machine.run(&format!("cat /tmp/{name}.log"));
        let lines: Vec<_> = log.lines().collect();
        // The serial port of a busy machine may lose a command; the log only grows.
        for line in lines.iter().skip(printed) {
            println!("{line}");
        }
        printed = printed.max(lines.len());
        if lines.last() == Some(&"over") {
            return Some(printed - 1);
        }
        thread::sleep(Duration::from_secs(1));
    }
}
