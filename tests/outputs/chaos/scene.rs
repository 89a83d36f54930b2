//! The surroundings of the program, and the attacks on them and on it.

use std::fs::{self, Permissions};
use std::io::Write;
use std::net::Shutdown;
use std::os::unix::fs::{PermissionsExt, chown};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::Duration;

use rustix::process::Signal;
use tempfile::TempDir;

use super::attack::Attack;
use super::subject::{Subject, layout, port, request, send};
use super::viewers::Viewers;
use crate::support::glove::Glove;
use crate::support::press::{Posture, Press, typing};
use crate::support::process::Process;
use crate::support::run::shipped;
use crate::support::x11::XServer;

/// The number of clients that the control socket accepts.
const CLIENTS: usize = 16;

/// Packets of a hand that is clear of all keys, for longer than a run needs to be armed.
const CLEAR_PACKETS: usize = 70;

pub struct Scene {
    pub server: XServer,
    pub subject: Subject,
    folder: TempDir,
    glove: Option<Glove>,
    hand: Hand,
    layout: String,
    saves: usize,
    /// The watchdogs that received the last signal.
    pub signalled_watchdogs: Vec<u32>,
    clients: Vec<UnixStream>,
    viewers: Option<Viewers>,
    keymaps: Vec<Process>,
}

/// The movements of the hand.
struct Hand {
    clear: Posture,
    /// Clear of all keys until the run is armed, then holding a key.
    arm_and_hold: Vec<Posture>,
    /// Clear of all keys until the run is armed, then typing for longer than an episode.
    arm_and_type: Vec<Posture>,
}

impl Scene {
    pub fn new(server: XServer) -> Self {
        let press = Press::for_text("h");
        let clear = vec![press.clear(); CLEAR_PACKETS];
        let typing = typing("the quick brown fox jumps over the lazy dog");
        let hand = Hand {
            clear: press.clear(),
            arm_and_hold: [clear.clone(), press.approach].concat(),
            arm_and_type: [clear, typing].concat(),
        };
        let folder = tempfile::tempdir().expect("a folder");
        let text = shipped("qwerty-flat");
        fs::write(layout(folder.path()), &text).expect("space on the disk");
        let glove = Glove::plug_in(&port(folder.path()), hand.clear);
        Self {
            subject: Subject::start(&server, folder.path()),
            server,
            glove: Some(glove),
            folder,
            hand,
            layout: text,
            saves: 0,
            signalled_watchdogs: Vec::new(),
            clients: Vec::new(),
            viewers: None,
            keymaps: Vec::new(),
        }
    }

    /// Starts the program again.
    pub fn restart_program(&mut self) {
        self.subject = Subject::start(&self.server, self.folder.path());
    }

    /// Returns the path of the control socket.
    pub fn socket(&self) -> &Path {
        self.subject.socket()
    }

    /// Resumes a paused run and arms it. Then the hand types or holds a key.
    pub fn start_pressing(&self, is_typing: bool) {
        // A program that is starting does not listen yet; the caller repeats this.
        let _ = request(self.socket(), "resume");
        self.play(if is_typing {
            &self.hand.arm_and_type
        } else {
            &self.hand.arm_and_hold
        });
    }

    /// Lifts the hand off all keys.
    pub fn lift_hand(&self) {
        self.play(&[self.hand.clear]);
    }

    fn play(&self, postures: &[Posture]) {
        if let Some(glove) = &self.glove {
            glove.play(postures);
        }
    }

    /// Starts an attack.
    pub fn begin(&mut self, attack: Attack) {
        match attack {
            Attack::GrabServer => self.server.grab(),
            Attack::FreezeServer | Attack::DropPresses => self.server.freeze(),
            Attack::ChangeKeymap => self.start_keymap(["br", "jp", "ru", "de"][self.saves % 4]),
            Attack::BlockStderr => self.subject.stderr.block(),
            Attack::BlockStdout => self.subject.stdout.block(),
            Attack::StopProgram => self.subject.signal(Signal::STOP),
            Attack::KillProgram => self.subject.signal(Signal::KILL),
            Attack::TerminateProgram => self.subject.signal(Signal::TERM),
            Attack::StopWatchdog => self.signal_watchdogs(Signal::STOP),
            Attack::KillWatchdog => self.signal_watchdogs(Signal::KILL),
            Attack::UnplugGlove => self.glove = None,
            Attack::SendJunk => self.glove.iter().for_each(Glove::send_noise),
            Attack::SaveLayout => self.save_layout(),
            Attack::SaveInvalidLayout => {
                let (half, _) = self.layout.split_at(self.layout.len() / 2);
                fs::write(layout(self.folder.path()), half).expect("space on the disk");
            }
            Attack::SaveForeignLayout => self.save_foreign_layout(),
            // The caller sends the command, because it waits for the response.
            Attack::PauseByCommand => {}
            Attack::PauseBySignal => {
                self.signal_watchdogs(Signal::USR1);
                self.subject.signal(Signal::USR1);
            }
            Attack::ConnectSilentClients => {
                let connect = || UnixStream::connect(self.socket()).ok();
                self.clients = (0..CLIENTS).filter_map(|_| connect()).collect();
            }
            Attack::ConnectFloodingClient => self.flood(),
            Attack::FloodFrames => self.viewers = Some(Viewers::flood(self.subject.share())),
        }
    }

    /// Ends an attack.
    pub fn end(&mut self, attack: Attack) {
        match attack {
            Attack::GrabServer => self.server.ungrab(),
            Attack::FreezeServer | Attack::DropPresses => self.server.thaw(),
            Attack::ChangeKeymap => self.restore_keymap(),
            Attack::BlockStderr => self.subject.stderr.unblock(),
            Attack::BlockStdout => self.subject.stdout.unblock(),
            Attack::StopProgram => self.subject.signal(Signal::CONT),
            Attack::StopWatchdog => {
                for watchdog in &self.signalled_watchdogs {
                    send(*watchdog, Signal::CONT);
                }
            }
            Attack::UnplugGlove => {
                let glove = Glove::plug_in(&port(self.folder.path()), self.hand.clear);
                self.glove = Some(glove);
            }
            Attack::SaveInvalidLayout => self.save_layout(),
            Attack::SaveForeignLayout => {
                fs::remove_file(layout(self.folder.path())).expect("it was saved");
                self.save_layout();
            }
            Attack::FloodFrames => self.viewers = None,
            Attack::ConnectSilentClients | Attack::ConnectFloodingClient => {
                for client in self.clients.drain(..) {
                    let _ = client.shutdown(Shutdown::Both);
                }
            }
            // The next movement of the hand ends the junk, and what was killed is started again.
            _ => {}
        }
    }

    fn signal_watchdogs(&mut self, signal: Signal) {
        self.signalled_watchdogs = self.subject.watchdogs();
        for watchdog in &self.signalled_watchdogs {
            send(*watchdog, signal);
        }
    }

    /// Saves a valid layout that differs from all before it.
    fn save_layout(&mut self) {
        self.saves += 1;
        let text = format!("{}// {}\n", self.layout, self.saves);
        fs::write(layout(self.folder.path()), text).expect("space on the disk");
    }

    /// Replaces the layout file by a valid file that another user may change.
    fn save_foreign_layout(&mut self) {
        /// `nobody` of Debian.
        const OTHER_USER: u32 = 65_534;
        let path = layout(self.folder.path());
        fs::remove_file(&path).expect("it was saved");
        self.save_layout();
        if chown(&path, Some(OTHER_USER), Some(OTHER_USER)).is_err() {
            let mode = Permissions::from_mode(0o666);
            fs::set_permissions(&path, mode).expect("a file of this user");
        }
    }

    /// Starts to replace the keymap. The X server may not respond yet.
    fn start_keymap(&mut self, name: &str) {
        let mut command = Command::new("setxkbmap");
        command.arg(name).env("DISPLAY", self.server.display());
        let process = Process::start(&mut command).expect("setxkbmap is installed");
        self.keymaps.push(process);
    }

    /// Restores the keymap after all changes of it.
    fn restore_keymap(&mut self) {
        for mut process in std::mem::take(&mut self.keymaps) {
            process.0.wait().expect("a child process");
        }
        self.start_keymap("us");
        let mut process = self.keymaps.pop().expect("it was started");
        process.0.wait().expect("a child process");
    }

    /// Connects a client that sends requests until it is disconnected.
    fn flood(&mut self) {
        let Ok(client) = UnixStream::connect(self.socket()) else {
            return;
        };
        let mut stream = client.try_clone().expect("a duplicate");
        let timeout = stream.set_write_timeout(Some(Duration::from_secs(1)));
        timeout.expect("a time-out");
        thread::spawn(move || while stream.write_all(b"{\"command\":\"state\"}\n").is_ok() {});
        self.clients.push(client);
    }
}
