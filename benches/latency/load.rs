//! What others do to a run meanwhile: clients of its control socket that never read, and one that pours.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use ademan::session::control_socket::{ControlServer, Notifier, ProfileInfo, ServerContext};
use ademan::session::{CommandReceiver, CommandSender, command_channel};
use tempfile::TempDir;

/// Clients that ask for news and never read them.
const DEAF: usize = 64;

/// Bytes that mean nothing, in a second: 100 Mbit.
const JUNK: usize = 12_500_000;

/// A control socket with all of them.
pub struct Load {
    pub notifier: Notifier,
    pub commands: Option<CommandReceiver>,
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
        control.serve(context(sender)).expect("it listens");
        let clients = (0..DEAF).map(|_| deaf(&path)).collect();
        let to = path.clone();
        thread::spawn(move || pour(&to));
        Self {
            notifier,
            commands: Some(commands),
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
    }
}

fn deaf(path: &Path) -> UnixStream {
    let mut client = UnixStream::connect(path).expect("the run listens");
    // Those that find no place are refused and cut off.
    let _ = client.write_all(b"{\"command\":\"subscribe\"}\n");
    client
}

/// Pours until nobody listens any more; whoever is cut off for it comes back.
fn pour(path: &Path) {
    let junk = [b'j'; 4096];
    let pause = Duration::from_secs_f64(junk.len() as f64 / JUNK as f64);
    let mut due = Instant::now();
    while let Ok(mut client) = UnixStream::connect(path) {
        while client.write_all(&junk).is_ok() {
            due = (due + pause).max(Instant::now() - Duration::from_millis(10));
            thread::sleep(due.saturating_duration_since(Instant::now()));
        }
    }
}
