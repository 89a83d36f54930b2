//! A glove on a serial port, whose postures a test determines.

use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use ademan::capture::hc11::{Framing, encode};
use ademan::capture::open_loopback;
use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, unbounded};
use serialport::{SerialPort, TTYPort};
use tempfile::TempDir;

use super::press::{Posture, glove_format};
use super::process::lock_spawning;

/// Longest time for a movement on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Returns a pseudo-terminal: the end of a glove, and the end that a program opens.
pub fn pseudo_terminal() -> (TTYPort, TTYPort) {
    let _lock = lock_spawning();
    let (master, port) = TTYPort::pair().expect("a pseudo-terminal");
    // Clones are closed in child processes, which would otherwise keep the line open.
    let clone = |end: &TTYPort| end.try_clone_native().expect("a descriptor");
    let mut glove = clone(&master);
    glove.set_timeout(TIMEOUT).expect("a time-out");
    (glove, clone(&port))
}

/// A connected glove, which sends packets at the rate of its line. It repeats its last posture.
pub struct Glove {
    link: PathBuf,
    messages: Option<Sender<Message>>,
    player: Option<JoinHandle<()>>,
}

enum Message {
    /// Postures to send, and where to tell that the last one was sent.
    Play(Vec<Posture>, Sender<()>),
    StopSending,
    SendNoise,
}

impl Glove {
    /// Connects a glove. `link` is the name of its port until it is disconnected.
    pub fn plug_in(link: &Path, posture: Posture) -> Self {
        let loopback = {
            let _lock = lock_spawning();
            open_loopback(glove_format()).expect("a pseudo terminal")
        };
        let port = loopback.uri.serial_port().expect("a serial port");
        symlink(port, link).expect("a link to the port");
        let (messages, received) = unbounded();
        let player = thread::spawn(move || play(loopback.writer, &received, posture));
        Self {
            link: link.to_owned(),
            messages: Some(messages),
            player: Some(player),
        }
    }

    /// Connects a glove in a new folder. Returns the folder, the glove and the source of a run.
    pub fn in_new_folder(posture: Posture) -> (TempDir, Self, String) {
        let folder = tempfile::tempdir().expect("a folder");
        let port = folder.path().join("glove");
        let glove = Self::plug_in(&port, posture);
        let source = format!("serial:{}", port.display());
        (folder, glove, source)
    }

    /// Sends these postures, one per packet, and repeats the last.
    pub fn play(&self, postures: &[Posture]) {
        self.start_playing(postures);
    }

    /// Sends these postures as [`play`](Self::play) does, and waits until the last one was sent. A busy machine takes longer for
    /// them than their packets on a line.
    pub fn play_to_end(&self, postures: &[Posture]) {
        let sent = self.start_playing(postures);
        sent.recv_timeout(TIMEOUT).expect("all postures are sent");
    }

    fn start_playing(&self, postures: &[Posture]) -> Receiver<()> {
        let (sent, is_sent) = unbounded();
        self.send(Message::Play(postures.to_vec(), sent));
        is_sent
    }

    /// Stops sending, like a glove that is switched off while its adapter is connected.
    pub fn stop_sending(&self) {
        self.send(Message::StopSending);
    }

    /// Sends random bytes until the next posture.
    pub fn send_noise(&self) {
        self.send(Message::SendNoise);
    }

    /// Disconnects the glove, as dropping it does.
    pub fn unplug(&mut self) {
        let _ = std::fs::remove_file(&self.link);
        self.messages = None;
        if let Some(player) = self.player.take() {
            let _ = player.join();
        }
    }

    fn send(&self, message: Message) {
        let messages = self.messages.as_ref().expect("the glove is connected");
        messages.send(message).expect("the player runs");
    }
}

impl Drop for Glove {
    fn drop(&mut self) {
        self.unplug();
    }
}

fn play(mut line: Box<dyn Write + Send>, messages: &Receiver<Message>, posture: Posture) {
    let mut random = fastrand::Rng::with_seed(3);
    let mut postures = vec![posture];
    let mut end = None;
    let mut index = 0;
    let mut is_noise = false;
    let mut due = Instant::now();
    loop {
        match messages.recv_deadline(due) {
            Ok(Message::Play(new, sent)) => {
                (postures, end, index, is_noise) = (new, Some(sent), 0, false);
            }
            Ok(Message::StopSending) => postures.clear(),
            Ok(Message::SendNoise) => is_noise = true,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                if let Some(held) = postures.get(index) {
                    let mut packet = encode(Framing::Double06, held);
                    if is_noise {
                        random.fill(&mut packet);
                    }
                    // A program that has exited does not read.
                    let _ = line.write_all(&packet);
                    if index + 1 < postures.len() {
                        index += 1;
                    } else if let Some(sent) = end.take() {
                        let _ = sent.send(());
                    }
                }
                due = Instant::now() + glove_format().packet_period();
            }
        }
    }
}
