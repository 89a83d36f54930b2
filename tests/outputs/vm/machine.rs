//! A machine in QEMU: its shell, the cable of its glove, and its log.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::support::process::Process;

/// How long anything in a machine without hardware support may take on a busy one.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// How often a machine is asked whether something has come about.
const INTERVAL: Duration = Duration::from_millis(100);

/// The processor is emulated in any case: where `/dev/kvm` is, it need not work.
const MACHINE: &str = "-accel tcg -machine q35 -m 512 -smp 2 -nodefaults -no-user-config -no-reboot -display none \
                       -device qemu-xhci";

/// A machine that runs until this is dropped.
pub struct Machine {
    shell: Lines,
    monitor: Lines,
    /// What QEMU has told that nobody asked for.
    told: Vec<Value>,
    folder: PathBuf,
    line: UnixStream,
    _process: Process,
    _sockets: TempDir,
}

impl Machine {
    /// Starts one on `vmlinuz` and `initrd` in this folder, in which the log of its kernel will be.
    pub fn start(folder: &Path) -> Self {
        let sockets = tempfile::tempdir().expect("a folder");
        let socket = |name: &str| sockets.path().join(name);
        let chardev = |name: &str| {
            let path = socket(name).display().to_string();
            format!("socket,id={name},path={path},server=on,wait=off")
        };
        let mut command = Command::new("qemu-system-x86_64");
        command.args(MACHINE.split_whitespace());
        command
            .arg("-kernel")
            .arg(folder.join("vmlinuz"))
            .arg("-initrd")
            .arg(folder.join("initrd"));
        command.args(["-append", "console=ttyS0 quiet panic=-1"]);
        let log = folder.join("console.log");
        command.args(["-serial", &format!("file:{}", log.display())]);
        command.args(["-chardev", &chardev("shell"), "-serial", "chardev:shell"]);
        command.args(["-chardev", &chardev("glove")]);
        command.args([
            "-chardev",
            &chardev("monitor"),
            "-mon",
            "chardev=monitor,mode=control",
        ]);
        command.stdin(Stdio::null());
        let mut process = Process::start(&mut command).expect("QEMU starts");
        let mut connect = |name: &str| connect(&socket(name), &mut process);
        let mut machine = Self {
            shell: Lines::of(connect("shell")),
            monitor: Lines::of(connect("monitor")),
            told: Vec::new(),
            folder: folder.to_owned(),
            line: connect("glove"),
            _process: process,
            _sockets: sockets,
        };
        machine.order(json!({ "execute": "qmp_capabilities" }));
        while machine.shell.next() != "ready" {}
        machine
    }

    /// The far end of the glove's line.
    pub fn line(&self) -> UnixStream {
        self.line.try_clone().expect("a second handle")
    }

    /// Does a line of shell commands in the machine and gives what they print.
    pub fn run(&mut self, commands: &str) -> String {
        assert!(!commands.contains('\n'), "one line: {commands}");
        self.shell.send(commands);
        let mut printed = String::new();
        loop {
            match self.shell.next() {
                line if line == "did that" => return printed,
                line => printed.extend([line.as_str(), "\n"]),
            }
        }
    }

    /// Asks `look` until it finds something; panics with what the program and the kernel said when it does not.
    pub fn wait_for<T>(&mut self, what: &str, mut look: impl FnMut(&mut Self) -> Option<T>) -> T {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            if let Some(found) = look(self) {
                return found;
            }
            thread::sleep(INTERVAL);
        }
        let said = self.run("tail -n 40 /tmp/*.log; dmesg | tail -n 20");
        panic!("{what}: that did not come about\n{said}");
    }

    /// Plugs in a USB serial adapter with this serial number: that of the glove, or any other with nothing behind it.
    pub fn plug_in(&mut self, adapter: &str) {
        let chardev = match adapter {
            "glove" => adapter.to_owned(),
            other => {
                let backend = json!({ "type": "null", "data": {} });
                let chardev = format!("behind-{other}");
                self.order(json!({
                    "execute": "chardev-add",
                    "arguments": { "id": chardev, "backend": backend },
                }));
                chardev
            }
        };
        let device = json!({
            "driver": "usb-serial", "id": adapter, "serial": adapter, "chardev": chardev, "always-plugged": true,
        });
        self.order(json!({ "execute": "device_add", "arguments": device }));
    }

    /// Presses these keys on the machine's own keyboard, all at once, and lets go of them.
    pub fn press(&mut self, keys: &[&str]) {
        let key = |name: &&str| json!({ "type": "qcode", "data": name });
        let keys: Vec<_> = keys.iter().map(key).collect();
        self.order(json!({ "execute": "send-key", "arguments": { "keys": keys } }));
    }

    /// Pulls the cable of an adapter.
    pub fn unplug(&mut self, adapter: &str) {
        self.told.clear();
        self.order(json!({ "execute": "device_del", "arguments": { "id": adapter } }));
        let is_gone =
            |told: &Value| told["event"] == "DEVICE_DELETED" && told["data"]["device"] == *adapter;
        while !self.told.iter().any(is_gone) {
            let told = self.hear();
            self.told.push(told);
        }
    }

    /// Copies a file of the machine, or several to one, into the folder that it was started from, and gives the text.
    pub fn keep(&mut self, path: &str) -> String {
        let text = self.run(&format!("cat {path}"));
        let name = path.rsplit('/').next().unwrap_or(path).replace('*', "all");
        fs::write(self.folder.join(name), &text).expect("the folder can be written");
        text
    }

    /// Gives QEMU an order, and waits until it is done.
    fn order(&mut self, order: Value) {
        self.monitor.send(&order.to_string());
        loop {
            let told = self.hear();
            assert!(told.get("error").is_none(), "{order}: {told}");
            match told.get("return") {
                Some(_) => return,
                None => self.told.push(told),
            }
        }
    }

    fn hear(&mut self) -> Value {
        serde_json::from_str(&self.monitor.next()).expect("the monitor speaks JSON")
    }
}

/// Lines to and from a socket of QEMU.
struct Lines(BufReader<UnixStream>);

impl Lines {
    fn of(stream: UnixStream) -> Self {
        let limit = stream.set_read_timeout(Some(PATIENCE));
        limit.expect("a socket has a limit");
        Self(BufReader::new(stream))
    }

    fn send(&mut self, line: &str) {
        let sent = self.0.get_mut().write_all(format!("{line}\n").as_bytes());
        sent.expect("the machine runs");
    }

    fn next(&mut self) -> String {
        let mut line = Vec::new();
        let read = self.0.read_until(b'\n', &mut line);
        assert!(
            read.expect("the machine answers") > 0,
            "the machine has ended"
        );
        String::from_utf8_lossy(&line).trim_end().to_owned()
    }
}

/// Connects to a socket that QEMU is about to make.
fn connect(socket: &Path, qemu: &mut Process) -> UnixStream {
    let start = Instant::now();
    loop {
        match UnixStream::connect(socket) {
            Ok(stream) => return stream,
            Err(error) if start.elapsed() > PATIENCE => panic!("QEMU makes no socket: {error}"),
            Err(_) => thread::sleep(INTERVAL),
        }
        let ended = qemu.0.try_wait().expect("it is a child");
        assert!(ended.is_none(), "QEMU has ended");
    }
}
