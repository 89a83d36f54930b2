//! Load on the control socket: clients that never read, and one that sends noise.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use ademan::session::control_socket::{ControlServer, Notifier, ProfileInfo, ServerContext};
use ademan::session::{CommandReceiver, CommandSender, command_channel};
use tempfile::TempDir;

/// Number of clients that subscribe and never read.
const SUBSCRIBERS: usize = 64;

/// Noise in bytes per second: 100 Mbit/s.
const NOISE: usize = 12_500_000;

/// A control socket with its clients.
pub struct Load {
    pub notifier: Notifier,
    /// Keeps the command channel of the clients open.
    _commands: CommandReceiver,
    _control: ControlServer,
    _clients: Vec<UnixStream>,
    _folder: TempDir,
}

impl Load {
    pub fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("control");
        let (sender, commands) = command_channel();
        let mut control = ControlServer::bind(&path).expect("a socket");
        let notifier = control.notifier();
        control.serve(context(sender)).expect("the server starts");
        let clients = (0..SUBSCRIBERS).map(|_| subscribe(&path)).collect();
        let noise_path = path.clone();
        thread::spawn(move || send_noise(&noise_path));
        Self {
            notifier,
            _commands: commands,
            _control: control,
            _clients: clients,
            _folder: folder,
        }
    }
}

fn context(commands: CommandSender) -> ServerContext {
    ServerContext {
        profiles: vec![ProfileInfo {
            name: "main".into(),
            file: "qwerty-flat".into(),
        }],
        commands,
        views: None,
        write_failures: Default::default(),
        rule: Default::default(),
    }
}

fn subscribe(path: &Path) -> UnixStream {
    let mut client = UnixStream::connect(path).expect("the server listens");
    // Clients beyond the limit are rejected.
    let _ = client.write_all(b"{\"command\":\"subscribe\"}\n");
    client
}

/// Sends noise until the server closes. Reconnects when the server disconnects it.
fn send_noise(path: &Path) {
    let noise = [b'j'; 4096];
    let pause = Duration::from_secs_f64(noise.len() as f64 / NOISE as f64);
    let mut due = Instant::now();
    while let Ok(mut client) = UnixStream::connect(path) {
        while client.write_all(&noise).is_ok() {
            due = (due + pause).max(Instant::now() - Duration::from_millis(10));
            thread::sleep(due.saturating_duration_since(Instant::now()));
        }
    }
}
