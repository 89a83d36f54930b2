//! The program on a kernel of its own: what goes in through a USB serial adapter comes out of the kernel's devices,
//! and `libinput`, through which Wayland and X11 hear of devices, takes them for what they are.
//!
//! `tests/outputs/vm/run` makes the machine and starts this; by itself it says that it is skipped.
mod devices;
mod doctor;
mod glove;
mod machine;
mod typing;
mod witness;

use std::env;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use glove::{Deed, Glove};
use machine::Machine;
use witness::{Evtest, Libinput};

/// What happens in the machine, and who sees it.
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
            glove: Glove::on(machine.line()),
            machine,
            libinput,
            evtests: 0,
            start,
        }
    }

    /// Starts the program, which finds the glove's adapter plugged in.
    fn start_program(&mut self, layout: &str) {
        self.libinput.forget(&mut self.machine);
        self.machine.wait_for("a serial port", |machine| {
            machine
                .run("ls /dev/ttyUSB0")
                .starts_with('/')
                .then_some(())
        });
        // A machine that holds the hand up for a moment shall not end a press.
        let setup = format!(
            "Setup(source: \"serial:/dev/ttyUSB0\", output: \"uinput\", layout: \"{layout}\", stall_timeout_ms: 10000, \
             panic_keys: [\"ControlLeft\", \"ControlRight\"])"
        );
        self.machine.run(&format!("echo '{setup}' >/tmp/setup.ron"));
        self.machine.run(
            "ademan run --allow-root /tmp/setup.ron --control /tmp/control >/tmp/ademan.log 2>&1 & echo $! >/tmp/ademan.pid",
        );
        self.wait_until_said("listening to", 1);
    }

    /// Ends the program as Ctrl-C does.
    fn end_program(&mut self) {
        self.glove.stop_sending();
        self.machine.run("killall -INT ademan");
        self.machine.wait_for("the end of the program", |machine| {
            machine.run("pidof ademan").is_empty().then_some(())
        });
    }

    fn evtest(&mut self, device: &str) -> Evtest {
        self.evtests += 1;
        Evtest::on(&mut self.machine, device, self.evtests)
    }

    fn wait_until_said(&mut self, part: &str, times: usize) {
        let count = format!("grep -c '{part}' /tmp/ademan.log");
        self.machine
            .wait_for(&format!("the program says `{part}`"), |machine| {
                let said: usize = machine.run(&count).trim().parse().unwrap_or(0);
                (said >= times).then_some(())
            });
    }

    /// Holds the hand off all keys until the program has armed itself, for the `times`th time.
    fn arm(&mut self, deed: &Deed, times: usize) {
        self.glove.play(deed.off());
        self.wait_until_said("armed", times);
    }

    fn report(&self, what: &str) {
        println!(
            "VM ok: {what} ({:.1} s)",
            self.start.elapsed().as_secs_f64()
        );
    }
}

#[test]
fn a_kernel_and_libinput_hear_the_hand() {
    let Some(folder) = env::var_os("ADEMAN_VM") else {
        println!("SKIPPED: `tests/outputs/vm/run` starts this with a machine");
        return;
    };
    let mut scene = Scene::of(Path::new(&folder));
    scene.report("the kernel runs");
    typing::all(&mut scene);
    devices::all(&mut scene);
    doctor::all(&mut scene);
    for log in ["/tmp/ademan.log", "/tmp/evtest-*.log"] {
        scene.machine.keep(log);
    }
    println!("what libinput said:");
    Libinput::log(&mut scene.machine)
        .iter()
        .for_each(|line| println!("{line}"));
}

#[test]
fn how_long_keys_stay_down() {
    let (Some(folder), Ok(times)) = (env::var_os("ADEMAN_VM"), env::var("ADEMAN_VM_TIMES")) else {
        println!("SKIPPED: `tests/outputs/vm/run release` starts this with a machine");
        return;
    };
    let mut machine = Machine::start(Path::new(&folder));
    let bench = "ADEMAN_PROGRAM=/bin/ademan vm-release --bench uinput";
    machine.run(&format!(
        "({bench} {times}; echo over) >/tmp/release.log 2>&1 &"
    ));
    let mut told = 0;
    loop {
        let log = machine.run("cat /tmp/release.log");
        let lines: Vec<_> = log.lines().collect();
        // The serial port of a machine that is that busy may lose what it is asked; the log only grows.
        for line in lines.iter().skip(told) {
            println!("{line}");
        }
        told = told.max(lines.len());
        if lines.last() == Some(&"over") {
            break;
        }
        thread::sleep(Duration::from_secs(1));
    }
    assert_eq!(told, 19, "a title and a row for each cause");
}
