//! A message bus of its own.

use std::fs;
#[cfg(feature = "tray")]
use std::fs::Permissions;
use std::io::ErrorKind;
#[cfg(feature = "tray")]
use std::os::unix::fs::PermissionsExt;
#[cfg(any(feature = "studio", feature = "tray"))]
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::support::process::Process;
use crate::support::x11::wait_for;

/// The Python that Debian's packages of GLib and GTK are for.
pub const PYTHON: &str = "/usr/bin/python3";

/// A `dbus-daemon` that starts no services.
pub struct Bus {
    folder: TempDir,
    #[cfg_attr(
        not(feature = "tray"),
        expect(dead_code, reason = "its drop ends the daemon")
    )]
    daemon: Process,
}

impl Bus {
    /// Starts a bus. Returns `None` with a message if the daemon is not installed.
    pub fn start() -> Option<Self> {
        Self::start_with_names(&["*"])
    }

    /// As [`start`](Self::start), but programs may own only these names.
    pub fn start_with_names(names: &[&str]) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let socket = folder.path().join("bus");
        let owned: String = names
            .iter()
            .map(|name| format!("<allow own=\"{name}\"/>"))
            .collect();
        let configuration = format!(
            "<busconfig><type>session</type><listen>unix:path={}</listen><auth>EXTERNAL</auth>\
             <policy context=\"default\"><allow user=\"*\"/><allow send_destination=\"*\" eavesdrop=\"true\"/><allow eavesdrop=\"true\"/>{owned}</policy></busconfig>",
            socket.display()
        );
        let file = folder.path().join("bus.conf");
        fs::write(&file, configuration).expect("space on the disk");
        let mut command = Command::new("dbus-daemon");
        command
            .arg("--nofork")
            .arg(format!("--config-file={}", file.display()))
            .stderr(Stdio::null());
        let daemon = match Process::start(&mut command) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                println!("SKIPPED: dbus-daemon is not installed");
                return None;
            }
            started => started.expect("the daemon starts"),
        };
        assert!(wait_for(|| socket.exists()), "the daemon listens");
        Some(Self { folder, daemon })
    }

    pub fn address(&self) -> String {
        format!("unix:path={}/bus", self.folder.path().display())
    }

    /// Starts a script of the tests on the bus, with pipes as its standard input and output. Returns `None` with a message if Python
    /// has no GLib.
    #[cfg(any(feature = "studio", feature = "tray"))]
    pub fn start_script(&self, path: &str) -> Option<Process> {
        let gi = Command::new(PYTHON).args(["-c", "import gi"]).output();
        if !gi.is_ok_and(|output| output.status.success()) {
            println!("SKIPPED: python3-gi is not installed");
            return None;
        }
        let mut command = Command::new(PYTHON);
        command
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(path))
            .env("DBUS_SESSION_BUS_ADDRESS", self.address())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        Some(Process::start(&mut command).expect("Python starts"))
    }

    /// Lets other users connect.
    #[cfg(feature = "tray")]
    pub fn open_to_all(&self) {
        let folder = self.folder.path();
        fs::set_permissions(folder, Permissions::from_mode(0o755)).expect("an own folder");
        fs::set_permissions(folder.join("bus"), Permissions::from_mode(0o777)).expect("own");
    }

    #[cfg(feature = "tray")]
    pub fn kill(&mut self) {
        self.daemon.0.kill().expect("the daemon runs");
        self.daemon.0.wait().expect("the daemon exits");
    }
}
