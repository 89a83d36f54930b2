//! A virtual machine in QEMU: its shell, the line of its glove, and its log.

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

/// Longest time for anything in an emulated machine on a busy host.
pub const TIMEOUT: Duration = Duration::from_secs(60);

/// Polling interval.
const INTERVAL: Duration = Duration::from_millis(100);

/// The processor is always emulated: `/dev/kvm` may exist and not work.
const MACHINE: &str = "-accel tcg -machine q35 -m 768 -smp 2 -nodefaults -no-user-config -no-reboot -display none \
                       -device qemu-xhci";

/// A virtual machine that runs until this is dropped.
pub struct Machine {
    shell: Lines,
    monitor: Lines,
    /// Events from QEMU that no command has consumed.
    events: Vec<Value>,
    folder: PathBuf,
    line: UnixStream,
    _process: Process,
    _sockets: TempDir,
}

impl Machine {
    /// Starts a machine with `vmlinuz` and `initrd` of this folder. The kernel log is written to it.
    pub fn start(folder: &Path) -> Self {
        Self::boot(folder, "initrd", "", &[])
    }

    /// Starts a machine with systemd: `initrd-systemd`. Its X server is reached at this port of the host.
    pub fn with_systemd(folder: &Path, port: u16) -> Self {
        let init =
            "rdinit=/init-systemd systemd.unit=machine.target systemd.unified_cgroup_hierarchy=1";
        let network =
            format!("user,id=net,restrict=on,hostfwd=tcp:127.0.0.1:{port}-10.0.2.15:6000");
        let devices = ["-netdev", &network, "-device", "e1000,netdev=net"];
        Self::boot(folder, "initrd-systemd", init, &devices)
    }

    fn boot(folder: &Path, image: &str, parameters: &str, devices: &[&str]) -> Self {
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
            .arg(folder.join(image))
            .args(devices);
        let parameters = format!("console=ttyS0 quiet panic=-1 {parameters}");
        command.args(["-append", parameters.trim_end()]);
        let log = folder.join(format!("console-{image}.log"));
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
            events: Vec::new(),
            folder: folder.to_owned(),
            line: connect("glove"),
            _process: process,
            _sockets: sockets,
        };
        machine.execute(json!({ "execute": "qmp_capabilities" }));
        while machine.shell.next() != "ready" {}
        machine
    }

    /// Returns the far end of the glove's line.
    pub fn line(&self) -> UnixStream {
        self.line.try_clone().expect("a duplicate")
    }

    /// Runs a line of shell commands in the machine and returns their output.
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

    /// Polls `look` until it returns a value. Panics with the logs of the program and the kernel after the time-out.
    pub fn wait_for<T>(&mut self, what: &str, mut look: impl FnMut(&mut Self) -> Option<T>) -> T {
        let start = Instant::now();
        while start.elapsed() < TIMEOUT {
            if let Some(found) = look(self) {
                return found;
            }
            thread::sleep(INTERVAL);
        }
        let logs = self.run("tail -n 40 /tmp/*.log; dmesg | tail -n 20");
        panic!("time-out: {what}\n{logs}");
    }

    /// Connects a USB serial adapter with this serial number: `glove`, or another one without a device behind it.
    pub fn plug_in(&mut self, adapter: &str) {
        let chardev = match adapter {
            "glove" => adapter.to_owned(),
            other => {
                let backend = json!({ "type": "null", "data": {} });
                let chardev = format!("behind-{other}");
                self.execute(json!({
                    "execute": "chardev-add",
                    "arguments": { "id": chardev, "backend": backend },
                }));
                chardev
            }
        };
        let device = json!({
            "driver": "usb-serial", "id": adapter, "serial": adapter, "chardev": chardev, "always-plugged": true,
        });
        self.execute(json!({ "execute": "device_add", "arguments": device }));
    }

    /// Presses these keys on the keyboard of the machine, all at once, and releases them.
    pub fn press(&mut self, keys: &[&str]) {
        let key = |name: &&str| json!({ "type": "qcode", "data": name });
        let keys: Vec<_> = keys.iter().map(key).collect();
        self.execute(json!({ "execute": "send-key", "arguments": { "keys": keys } }));
    }

    /// Disconnects an adapter.
    pub fn unplug(&mut self, adapter: &str) {
        self.events.clear();
        self.execute(json!({ "execute": "device_del", "arguments": { "id": adapter } }));
        let is_gone = |message: &Value| {
            message["event"] == "DEVICE_DELETED" && message["data"]["device"] == *adapter
        };
        while !self.events.iter().any(is_gone) {
            let message = self.receive();
            self.events.push(message);
        }
    }

    /// Copies a file of the machine, or several into one, to the folder of its kernel, and returns the text.
    pub fn keep(&mut self, path: &str) -> String {
        let text = self.run(&format!("cat {path}"));
        let name = path.rsplit('/').next().unwrap_or(path).replace('*', "all");
        fs::write(self.folder.join(name), &text).expect("the folder can be written");
        text
    }

    /// Executes a QMP command.
    fn execute(&mut self, command: Value) {
        self.monitor.send(&command.to_string());
        loop {
            let message = self.receive();
            assert!(message.get("error").is_none(), "{command}: {message}");
            match message.get("return") {
                Some(_) => return,
                None => self.events.push(message),
            }
        }
    }

    fn receive(&mut self) -> Value {
        serde_json::from_str(&self.monitor.next()).expect("QMP is JSON")
    }
}

/// A connection to a socket of QEMU, line by line.
struct Lines(BufReader<UnixStream>);

impl Lines {
    fn of(stream: UnixStream) -> Self {
        let result = stream.set_read_timeout(Some(TIMEOUT));
        result.expect("a read time-out");
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
            read.expect("the machine replies") > 0,
            "the machine has exited"
        );
        String::from_utf8_lossy(&line).trim_end().to_owned()
    }
}

/// Connects to a socket that QEMU creates.
fn connect(socket: &Path, qemu: &mut Process) -> UnixStream {
    let start = Instant::now();
    loop {
        match UnixStream::connect(socket) {
            Ok(stream) => return stream,
            Err(error) if start.elapsed() > TIMEOUT => panic!("QEMU creates no socket: {error}"),
            Err(_) => thread::sleep(INTERVAL),
        }
        let ended = qemu.0.try_wait().expect("a child process");
        assert!(ended.is_none(), "QEMU has exited");
    }
}
