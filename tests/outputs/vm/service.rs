//! The unit of the package under systemd, whose processes are killed while a key is pressed on an X server.

use std::env;
use std::net::TcpListener;
use std::path::Path;
use std::time::Instant;

use super::machine::{Machine, TIMEOUT};
use crate::support::key_log::{Action, Input, KeyLog};
use crate::support::press::x11_code;
use crate::support::x11::wait_at_most;

/// Commands of systemd, as the user of the session.
const SYSTEMCTL: &str = "as-ana systemctl --user";

/// The log of the unit.
const LOG: &str = "/run/user/1000/ademan.log";

/// First TCP port of X servers: the port of display 0.
const X11_PORT: u16 = 6000;

/// The machine, and the log of all key events on its X server.
struct Session {
    machine: Machine,
    keys: KeyLog,
    start: Instant,
}

impl Session {
    fn start(folder: &Path) -> Self {
        let start = Instant::now();
        let display = free_display();
        let mut machine = Machine::with_systemd(folder, X11_PORT + display);
        machine.wait_for("an X server", |machine| {
            let sockets = machine.run("ls /tmp/.X11-unix/");
            sockets.starts_with("X0").then_some(())
        });
        Self {
            machine,
            keys: KeyLog::on_display(&format!("127.0.0.1:{display}")),
            start,
        }
    }

    /// Waits until the unit runs and its hand holds H.
    fn wait_for_press(&mut self, what: &str) {
        let is_pressed = || self.keys.pressed().contains(&Input::Key(x11_code("H")));
        if !wait_at_most(TIMEOUT, is_pressed) {
            let status = self.machine.run(&format!(
                "{SYSTEMCTL} status ademan; cat {LOG}; dmesg | tail -n 20"
            ));
            panic!("{what}: no press\n{status}");
        }
    }

    /// Executes a command that kills, and waits until all keys are released. Prints the time between them, which includes
    /// the start of the command.
    fn check_release(&mut self, what: &str, command: &str) {
        let before = self.keys.len();
        let start = Instant::now();
        let output = self.machine.run(command);
        if !wait_at_most(TIMEOUT, || self.keys.pressed().is_empty()) {
            let log = self.machine.run(&format!("cat {LOG}"));
            panic!(
                "{what}: {:?} stays pressed\n{output}{log}",
                self.keys.pressed()
            );
        }
        let events = self.keys.events();
        let release = events[before..]
            .iter()
            .find(|event| event.action == Action::Release);
        let time = release.expect("a release").time.duration_since(start);
        println!(
            "VM ok: {what}: released after {:.0} ms ({:.1} s)",
            time.as_secs_f64() * 1e3,
            self.start.elapsed().as_secs_f64()
        );
    }

    /// Waits until the log of the unit contains `part`, and empties it.
    fn wait_for_line(&mut self, part: &str) {
        self.machine.wait_for(part, |machine| {
            let found = machine.run(&format!("grep -c '{part}' {LOG}"));
            (found.trim() != "0").then_some(())
        });
        self.machine.run(&format!(": >{LOG}"));
    }

    /// Returns the process ids of the program and its watchdog.
    fn processes(&mut self) -> [String; 2] {
        let program = self
            .machine
            .run(&format!("{SYSTEMCTL} show -P MainPID ademan"));
        let program = program.trim().to_owned();
        let watchdog = self
            .machine
            .run(&format!("echo $(cat /proc/{program}/task/*/children)"));
        [program, watchdog.trim().to_owned()]
    }
}

/// Returns the number of a display whose TCP port is free.
fn free_display() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    listener.local_addr().expect("it is bound").port() - X11_PORT
}

#[test]
fn keys_are_released_when_systemd_kills_the_unit() {
    let folder =
        env::var_os("ADEMAN_VM").filter(|folder| Path::new(folder).join("initrd-systemd").exists());
    let Some(folder) = folder else {
        println!("SKIPPED: `tests/outputs/vm/run` starts this with a machine that has systemd");
        return;
    };
    let mut session = Session::start(Path::new(&folder));
    session.machine.run(&format!("{SYSTEMCTL} start ademan"));
    session.wait_for_press("started");
    let [program, watchdog] = session.processes();
    let group = session
        .machine
        .wait_for("a scope of the watchdog", |machine| {
            let group = machine.run(&format!("cat /proc/{watchdog}/cgroup"));
            group.contains(".scope").then_some(group)
        });
    let scope = format!("/app.slice/ademan-watchdog-{watchdog}.scope\n");
    assert!(group.ends_with(&scope), "{group}");
    let report = session.machine.run("as-ana ademan doctor");
    let found = "the watchdog of the running session has a systemd scope of its own";
    assert!(report.contains(found), "{report}");
    println!(
        "VM ok: the unit {program} presses H, its watchdog is in {}",
        scope.trim()
    );

    session.check_release(
        "systemctl kill -s KILL",
        &format!("{SYSTEMCTL} kill -s KILL ademan"),
    );
    session.wait_for_line("the program exited; released its keys (1)");
    session.wait_for_press("restarted by the unit");

    let restarted_group = session
        .machine
        .run(&format!("{SYSTEMCTL} show -P ControlGroup ademan"));
    let kill = format!(
        "echo 1 >/sys/fs/cgroup{}/cgroup.kill",
        restarted_group.trim()
    );
    session.check_release("control group killed", &kill);
    session.wait_for_line("the program exited; released its keys (1)");
    session.wait_for_press("restarted by the unit");

    let limit =
        |bytes: &str| format!("{SYSTEMCTL} set-property --runtime ademan MemoryMax={bytes}");
    session.check_release("out of memory", &limit("64K"));
    session.wait_for_line("the program exited; released its keys (1)");
    session.machine.run(&limit("infinity"));
    session.wait_for_press("restarted by the unit");

    let [restarted_program, restarted_watchdog] = session.processes();
    session.check_release(
        "program and watchdog killed",
        &format!("kill -KILL {restarted_watchdog} {restarted_program}"),
    );
    session.wait_for_line("released the keys of a killed run (1)");
    session.wait_for_press("restarted by the unit");

    let [_, last_watchdog] = session.processes();
    session.check_release("systemctl stop", &format!("{SYSTEMCTL} stop ademan"));
    session
        .machine
        .wait_for("the end of the watchdog", |machine| {
            machine
                .run(&format!("ls /proc | grep -x {last_watchdog}"))
                .is_empty()
                .then_some(())
        });
    let units = session
        .machine
        .run(&format!("{SYSTEMCTL} list-units --all 'ademan*'"));
    assert!(!units.contains("scope"), "{units}");
    println!("VM ok: no scope remains");
}
